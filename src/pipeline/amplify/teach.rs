//! Learning from exemplars.

use super::cell_size::CellSize;
use super::exemplar::{self, Wanted};
use super::learned::Learned;
use super::method::Method;
use super::mode::Mode;
use crate::amplify::{Cascade, Paper, PatchModel, check_factor};
use crate::error::{ErrorKind, Result};
use crate::watch::Watch;
use std::path::PathBuf;

/// What is to be learned, and of what.
#[derive(Clone, Debug)]
pub struct Teaching {
    /// DEMs to learn from.
    pub exemplars: Vec<PathBuf>,
    /// How many times finer the cells become.
    pub factor: usize,
    /// What the result is to be.
    pub mode: Mode,
    /// How terrain is described by patches in [`Mode::Paper`]; its seed is not looked at.
    pub model: PatchModel,
    /// Seed of what is drawn while learning: in [`Mode::Accurate`] the patches of large exemplars that are learned from,
    /// in [`Mode::Paper`] the atoms that learning begins with. In [`Mode::Realistic`] nothing is.
    pub seed: u64,
}

/// The cells that are learned for, and what is known of the terrain that they are made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    /// Cells of the input.
    pub(super) input: CellSize,
    /// Cells that are made.
    pub(super) made: CellSize,
    /// The input's median slope.
    pub(super) slope: Option<f64>,
    /// Bytes of memory that may be used; what is free unless given.
    pub(super) memory: Option<u64>,
}

impl Teaching {
    /// Looks whether anything can be learned so.
    ///
    /// # Errors
    /// A usage error for a factor or a model that cannot be.
    pub(super) fn check(&self) -> Result<()> {
        match self.mode {
            Mode::Accurate | Mode::Realistic => check_factor(self.factor),
            Mode::Paper => self.model.steps(self.factor).map(drop),
        }
    }

    /// What the exemplars teach.
    ///
    /// # Errors
    /// As [`Teaching::check`]; exemplars that cannot be read or teach nothing; a cancelled job.
    pub(super) fn learn(&self, aim: &Aim, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<Learned> {
        let wanted = Wanted {
            input: aim.input,
            factor: self.factor,
            made: aim.made,
            slope: aim.slope,
            bytes_per_cell: self.mode.bytes_per_exemplar_cell(),
            memory: aim.memory,
        };
        let (mut exemplars, mut records) = (vec![], vec![]);
        for path in &self.exemplars {
            let (planes, record) = exemplar::read(path, &wanted, watch, warn)?;
            exemplars.extend(planes);
            records.push(record);
        }
        let is_square = aim.input.is_square();
        let factor = self.factor;
        let method = match self.mode {
            Mode::Accurate => Cascade::learn(&exemplars, factor, is_square, self.seed, watch).map(Method::Cascade),
            Mode::Realistic => Cascade::learn_textured(&exemplars, factor, is_square, watch).map(Method::Cascade),
            Mode::Paper => {
                let model = PatchModel { seed: self.seed, ..self.model.clone() };
                Paper::learn(exemplars, factor, &model, watch).map(Method::Paper)
            }
        };
        let method = method.map_err(|error| match self.exemplars.first() {
            Some(path) if error.kind() == ErrorKind::Input => error.at_path(path),
            _ => error,
        })?;
        if method.borrowed_steps() > 0 {
            warn(&format!(
                "the exemplars are too small for {} of the coarsest steps; what finer ones have learned is taken there",
                method.borrowed_steps()
            ));
        }
        Ok(Learned { mode: self.mode, cell: aim.made, seed: self.seed, exemplars: records, method })
    }
}
