//! Amplification as paper 001 writes it (section 5.3, figures 9 and 10), without what came after it.
//!
//! Every patch of an exemplar is an atom twice: with the exemplar's own cells, and with cells as large as the input's.
//! A patch of the input is described by coarse atoms, mostly by one; the same fine atoms, as large as the coarse ones
//! were taken, stand in its place, and patches are blended by their weights. Fine atoms are not kept: each is a window of
//! its exemplar, shifted and scaled.

mod blend;
mod options;
mod pairs;
#[cfg(test)]
mod tests;

pub use options::PatchModel;
pub(super) use pairs::{Source, most_patches};

use super::plane::Plane;
use crate::error::Result;
use crate::watch::Watch;
use blend::Blending;
use pairs::Pairs;

/// Makes planes finer with the patches of exemplars.
#[derive(Clone, Debug)]
pub struct Paper {
    steps: Vec<Blending>,
    model: PatchModel,
}

/// What [`Paper`] is made of, and can be made of again.
pub(super) struct Kept<'a> {
    pub(super) model: &'a PatchModel,
    /// Exemplars in the cells that are made.
    pub(super) sources: &'a [Source],
    /// Numbers of the patches that learning chose, for each step from the last to the first; nothing where it takes
    /// all.
    pub(super) chosen: Vec<Option<&'a [u32]>>,
}

impl Paper {
    /// Takes the patches of exemplars (heights in metres, NaN for voids) whose cells are as large as those that are to be
    /// made, or learns from them which to take.
    ///
    /// # Errors
    /// As [`PatchModel::steps`]; exemplars in which no patch has relief and no voids, or none is as large as a patch; a
    /// cancelled job.
    pub fn learn(exemplars: Vec<Plane>, factor: usize, model: &PatchModel, watch: &Watch) -> Result<Self> {
        let sources = exemplars.into_iter().map(|plane| Source::of(&plane)).collect();
        Self::of(sources, factor, model, vec![], watch)
    }

    /// As [`Paper::learn`], of exemplars as they are kept; with what learning chose before where there is any, for each
    /// step from the last to the first.
    ///
    /// # Errors
    /// As [`Paper::learn`], and when what was chosen is not there.
    pub(super) fn of(
        mut sources: Vec<Source>,
        factor: usize,
        model: &PatchModel,
        chosen: Vec<Vec<u32>>,
        watch: &Watch,
    ) -> Result<Self> {
        let factors = model.steps(factor)?;
        let mut chosen = chosen.into_iter();
        // The finest first, as each scale is made of the one before it.
        let mut steps = vec![];
        for (number, &factor) in factors.iter().rev().enumerate() {
            let coarser = match number + 1 < factors.len() {
                true => sources.iter().map(|source| source.averaged(factor)).collect(),
                false => vec![],
            };
            watch.check()?;
            steps.push(Blending::new(Pairs::new(sources, factor, model, chosen.next(), watch)?, model)?);
            sources = coarser;
        }
        steps.reverse();
        Ok(Self { steps, model: model.clone() })
    }

    /// What it is made of.
    pub(super) fn kept(&self) -> Kept<'_> {
        let pairs = || self.steps.iter().rev().map(Blending::pairs);
        Kept {
            model: &self.model,
            sources: pairs().next().map_or(&[], Pairs::sources),
            chosen: pairs().map(Pairs::chosen).collect(),
        }
    }

    /// How terrain is described by patches.
    pub fn model(&self) -> &PatchModel {
        &self.model
    }

    /// How many times finer planes become.
    pub fn factor(&self) -> usize {
        self.steps.iter().map(Blending::factor).product()
    }

    /// How many times finer each step makes planes, in their order.
    pub fn factors(&self) -> Vec<usize> {
        self.steps.iter().map(Blending::factor).collect()
    }

    /// Pairs of a coarse and a fine atom, for each step.
    pub fn atoms(&self) -> Vec<usize> {
        self.steps.iter().map(Blending::atoms).collect()
    }

    /// Bytes of memory that exemplars and atoms take.
    pub fn bytes(&self) -> usize {
        self.steps.iter().map(Blending::bytes).sum()
    }

    /// Cells at each side of a plane that are needed beyond those that are made finer.
    pub fn reach(&self) -> usize {
        self.margins()[0]
    }

    /// Margins before each step and after the last.
    fn margins(&self) -> Vec<usize> {
        let mut margins: Vec<usize> = vec![0];
        for step in self.steps.iter().rev() {
            margins.push(margins[margins.len() - 1].div_ceil(step.factor()) + step.reach());
        }
        margins.reverse();
        margins
    }

    /// The finer plane of all but [`Paper::reach`] cells at each side, in the plane's own unit. `corner` is row and column
    /// of the plane's first cell in its raster; margins may begin before it.
    ///
    /// Each fine cell depends on what lies within the reach alone, and comes out the same however planes are cut.
    ///
    /// # Panics
    /// When the plane is not larger than its margins.
    pub fn amplified(&self, mut plane: Plane, mut corner: [i64; 2]) -> Plane {
        let margins = self.margins();
        for (step, pair) in self.steps.iter().zip(margins.windows(2)) {
            let fine = step.applied(&plane, corner);
            // A margin may be a little wider than the next step needs.
            let excess = (pair[0] - step.reach()) * step.factor() - pair[1];
            corner = corner.map(|at| (at + step.reach() as i64) * step.factor() as i64 + excess as i64);
            plane = if excess > 0 { fine.trimmed(excess) } else { fine };
        }
        plane
    }
}
