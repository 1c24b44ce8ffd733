//! What makes planes finer.

use crate::amplify::{Cascade, FILL_REACH, Paper, Plane};

/// A way to make planes finer that has learned from exemplars.
pub(super) enum Method {
    /// Steps of regressions, with texture or without.
    Cascade(Cascade),
    /// Patches of the exemplars as they are.
    Paper(Paper),
}

impl Method {
    /// How many times finer planes become.
    pub(super) fn factor(&self) -> usize {
        match self {
            Self::Cascade(cascade) => cascade.factor(),
            Self::Paper(paper) => paper.factor(),
        }
    }

    /// Cells at each side of a plane that are needed beyond those that are made finer.
    pub(super) fn reach(&self) -> usize {
        match self {
            Self::Cascade(cascade) => cascade.reach(),
            Self::Paper(paper) => paper.reach(),
        }
    }

    /// How many cells into a void heights are made: whatever sways a cell with data.
    pub(super) fn fill_reach(&self) -> usize {
        match self {
            Self::Cascade(_) => FILL_REACH,
            Self::Paper(paper) => paper.reach(),
        }
    }

    /// Bytes of memory that it takes.
    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Cascade(cascade) => cascade.bytes(),
            Self::Paper(paper) => paper.bytes(),
        }
    }

    /// Most rows of input cells of a strip, where tiles have so many: a multiple of `unit`. More would make nothing
    /// faster.
    pub(super) fn strip_rows(&self, tile: usize, unit: usize) -> usize {
        match self {
            Self::Cascade(_) => 4 * tile.div_ceil(unit) * unit,
            // It makes no fine cells beyond a tile's own, so low tiles cost little.
            Self::Paper(_) => (tile / 4).max(1).div_ceil(unit) * unit,
        }
    }

    /// The finer plane of all but the reach at each side; see [`Cascade::amplified`] and [`Paper::amplified`].
    pub(super) fn amplified(&self, plane: Plane, known: Vec<bool>, corner: [i64; 2], seed: u64) -> Plane {
        match self {
            Self::Cascade(cascade) => cascade.amplified(plane, known, corner, seed),
            Self::Paper(paper) => paper.amplified(plane, corner),
        }
    }
}
