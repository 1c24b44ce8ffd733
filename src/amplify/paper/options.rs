//! How terrain is described by patches.

use super::super::MOST_FACTOR;
use crate::dictionary::{PatchLayout, PatchShape};
use crate::error::{Error, Result};

/// Most cells along a patch's side.
const MOST_SIDE: usize = 64;
/// Most patches of the exemplars, whatever is wanted.
const MOST_PATCHES: usize = 1 << 20;
/// Most atoms that are learned.
const MOST_LEARNED: usize = 1 << 14;
/// Most atoms of a patch.
const MOST_SPARSITY: usize = 64;

/// How terrain is described by patches (paper 001, sections 4.2 to 4.4 and 5.3).
#[derive(Clone, Debug, PartialEq)]
pub struct PatchModel {
    /// Side of a patch in cells of the input: twice the paper's radius R.
    pub side: usize,
    /// From one patch of the input to the next in its cells; half a side where there is none.
    pub step: Option<usize>,
    /// Most atoms of a patch, the paper's s.
    pub sparsity: usize,
    /// Whether a landform may also stand for what it is when turned upside down.
    pub signed: bool,
    /// Atoms to learn from all patches of the exemplars (the paper's N, its problem 2); all of them where there is none.
    pub atoms: Option<usize>,
    /// Most patches of the exemplars that a step takes: further ones are left out, evenly. Where there is none, as many as
    /// the largest of the paper's dictionaries has, and fewer where a few atoms are learned of them.
    pub patches: Option<usize>,
    /// Factor of each of several steps; all in one step where there is none.
    pub by: Option<usize>,
    /// Seed that the first of learned atoms are drawn by.
    pub seed: u64,
}

impl Default for PatchModel {
    /// With four times finer cells a patch has about the 10³ values that the paper recommends.
    fn default() -> Self {
        Self { side: 8, step: None, sparsity: 1, signed: true, atoms: None, patches: None, by: None, seed: 1 }
    }
}

impl PatchModel {
    /// The factors of the steps that make up a factor.
    ///
    /// # Errors
    /// A usage error for a factor below 2, above [`MOST_FACTOR`] or not made up of such steps, and for anything in the
    /// model that cannot be.
    pub fn steps(&self, factor: usize) -> Result<Vec<usize>> {
        if !(2..=MOST_FACTOR).contains(&factor) {
            return Err(Error::usage(format!("--factor {factor}: expected 2 to {MOST_FACTOR}")));
        }
        let by = self.by.unwrap_or(factor);
        let mut steps = vec![];
        let mut left = factor;
        while by > 1 && left > 1 && left.is_multiple_of(by) {
            steps.push(by);
            left /= by;
        }
        if left != 1 {
            return Err(Error::usage(format!("--by {by}: a factor of {factor} is not made up of steps of {by}")));
        }
        let within = |name: &str, value: usize, [least, most]: [usize; 2]| match (least..=most).contains(&value) {
            true => Ok(()),
            false => Err(Error::usage(format!("--{name} {value}: expected {least} to {most}"))),
        };
        within("patch", self.side, [3, MOST_SIDE])?;
        within("sparsity", self.sparsity, [1, MOST_SPARSITY])?;
        within("atoms", self.atoms.unwrap_or(1), [1, MOST_LEARNED])?;
        within("patches", self.patches.unwrap_or(1), [1, MOST_PATCHES])?;
        if !self.signed && self.sparsity > 1 {
            return Err(Error::usage("--unsigned: it is for --sparsity 1 only"));
        }
        self.spacing()?;
        Ok(steps)
    }

    /// From one patch of the input to the next in its cells.
    ///
    /// # Errors
    /// When discs would leave gaps.
    pub fn spacing(&self) -> Result<usize> {
        let one = PatchLayout::new(self.side, self.side, PatchShape::new(self.side)?, self.step);
        Ok(one.map_err(|error| Error::usage(format!("--step: {}", error.message())))?.step())
    }
}
