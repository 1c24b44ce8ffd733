//! What makes planes finer.

use super::mode::Mode;
use crate::amplify::keep::{Cursor, Kind};
use crate::amplify::{Cascade, FILL_REACH, Paper, PatchModel, Plane};
use crate::error::Result;
use crate::watch::Watch;

/// A way to make planes finer that has learned from exemplars.
#[derive(Clone, Debug)]
pub(super) enum Method {
    /// Steps: networks, or regressions and texture.
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

    /// How many times finer each step makes planes, in their order.
    pub(super) fn factors(&self) -> Vec<usize> {
        match self {
            Self::Cascade(cascade) => cascade.factors(),
            Self::Paper(paper) => paper.factors(),
        }
    }

    /// Steps for whose own scale the exemplars were too small.
    pub(super) fn borrowed_steps(&self) -> usize {
        match self {
            Self::Cascade(cascade) => cascade.borrowed_steps(),
            Self::Paper(_) => 0,
        }
    }

    /// Pairs of atoms of each step, where there are any.
    pub(super) fn atoms(&self) -> Vec<usize> {
        match self {
            Self::Cascade(_) => vec![],
            Self::Paper(paper) => paper.atoms(),
        }
    }

    /// How terrain is described by patches of exemplars, where it is.
    pub(super) fn model(&self) -> Option<&PatchModel> {
        match self {
            Self::Cascade(_) => None,
            Self::Paper(paper) => Some(paper.model()),
        }
    }

    /// Whether patches are turned, so that it matters whether cells are as wide as high.
    pub(super) fn turns_patches(&self) -> bool {
        matches!(self, Self::Cascade(_))
    }

    /// Whether a mode makes terrain so.
    pub(super) fn suits(&self, mode: Mode) -> bool {
        match self {
            Self::Cascade(cascade) => match cascade.is_textured() {
                true => mode == Mode::Realistic,
                false => mode == Mode::Accurate,
            },
            Self::Paper(_) => mode == Mode::Paper,
        }
    }

    /// What stands for it in a file.
    pub(super) fn kind(&self) -> Kind {
        match self {
            Self::Cascade(cascade) => cascade.kind(),
            Self::Paper(_) => Kind::Patches,
        }
    }

    /// What was learned, as bytes.
    ///
    /// # Errors
    /// When a number has no room there.
    pub(super) fn put(&self, out: &mut Vec<u8>) -> Result<()> {
        match self {
            Self::Cascade(cascade) => cascade.put(out),
            Self::Paper(paper) => paper.put(out),
        }
    }

    /// Takes what was learned for a factor with a seed.
    ///
    /// # Errors
    /// When the bytes are not of that kind, or there is no room for it; a cancelled job.
    pub(super) fn take(cursor: &mut Cursor<'_>, kind: Kind, factor: usize, seed: u64, watch: &Watch) -> Result<Self> {
        match kind {
            Kind::Networks | Kind::Steps => Cascade::take(cursor, kind, factor).map(Self::Cascade),
            Kind::Patches => Paper::take(cursor, factor, seed, watch).map(Self::Paper),
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
