//! What was learned from exemplars: of use for any input with cells of one size.

mod agreement;
mod file;
#[cfg(test)]
mod tests;

use super::cell_size::CellSize;
use super::exemplar::{self, Record};
use super::likeness::remark;
use super::method::Method;
use super::mode::Mode;
use crate::amplify::PatchModel;
use std::path::Path;

pub use agreement::Said;
pub use file::{describe, is_learned};

/// What was learned.
#[derive(Clone, Debug)]
pub(super) struct Learned {
    pub(super) mode: Mode,
    /// The cells that are made.
    pub(super) cell: CellSize,
    /// Seed of what was drawn while learning.
    pub(super) seed: u64,
    pub(super) exemplars: Vec<Record>,
    pub(super) method: Method,
}

/// What is known of what was learned.
#[derive(Clone, Debug)]
pub struct LearnedSummary {
    /// What the result will be.
    pub mode: Mode,
    /// How many times finer cells become.
    pub factor: usize,
    /// Metres from one column and from one row to the next of the cells that are made.
    pub cell_m: [f64; 2],
    /// Seed of what was drawn while learning; nothing where nothing is.
    pub seed: Option<u64>,
    /// How many times finer each step makes them, in their order.
    pub steps: Vec<usize>,
    /// Steps for whose own scale the exemplars were too small.
    pub borrowed_steps: usize,
    /// Pairs of atoms of each step in [`Mode::Paper`].
    pub atoms: Vec<usize>,
    /// How terrain is described by patches in [`Mode::Paper`].
    pub model: Option<PatchModel>,
    /// What it was learned from.
    pub exemplars: Vec<ExemplarSummary>,
    /// Bytes of the file.
    pub bytes: u64,
}

/// What is known of an exemplar.
#[derive(Clone, Debug, PartialEq)]
pub struct ExemplarSummary {
    /// The file's name without its folder.
    pub name: String,
    /// Rows and columns.
    pub size: [usize; 2],
    /// Metres from one column and from one row to the next.
    pub cell_m: [f64; 2],
    /// The median slope in degrees, in cells of the size that the input has; nothing where there is none.
    pub median_slope_deg: Option<f64>,
}

impl Learned {
    /// What is known of it, of a file of so many bytes.
    pub(super) fn summary(&self, bytes: u64) -> LearnedSummary {
        let exemplar = |record: &Record| ExemplarSummary {
            name: record.name.clone(),
            size: record.size,
            cell_m: [record.cell.across_m, record.cell.down_m],
            median_slope_deg: record.slope.map(|slope| slope.atan().to_degrees()),
        };
        LearnedSummary {
            mode: self.mode,
            factor: self.method.factor(),
            cell_m: [self.cell.across_m, self.cell.down_m],
            seed: self.mode.draws_in_learning().then_some(self.seed),
            steps: self.method.factors(),
            borrowed_steps: self.method.borrowed_steps(),
            atoms: self.method.atoms(),
            model: self.method.model().cloned(),
            exemplars: self.exemplars.iter().map(exemplar).collect(),
            bytes,
        }
    }

    /// Names of what it was learned from.
    pub(super) fn names(&self) -> String {
        let names: Vec<&str> = self.exemplars.iter().map(|record| record.name.as_str()).collect();
        names.join(", ")
    }

    /// What to say where what is kept in a file is not for such cells, or not for terrain with such a median slope.
    pub(super) fn remarks(&self, path: &Path, made: CellSize, slope: Option<f64>) -> Vec<String> {
        let mut remarks = vec![];
        let file = exemplar::name(path);
        if !self.cell.is_like(made) {
            let turns = match self.cell.is_square() && !made.is_square() && self.method.turns_patches() {
                true => ", as wide as high",
                false => "",
            };
            remarks.push(format!(
                "{file} was learned for cells of {}{turns}, and those that are made are of {made}: detail comes out in \
                 another size; learn again with --cell {}",
                self.cell,
                made.option()
            ));
        }
        for record in &self.exemplars {
            if let Some(text) = remark(slope, record.slope) {
                remarks.push(format!("{file}, exemplar {}: {text}", record.name));
            }
        }
        remarks
    }
}
