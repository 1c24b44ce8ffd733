//! One step of amplification: a plane some times finer, with what an exemplar has taught.

use super::anchors::{Anchors, BRANCHES};
use super::back_projection::{BackProjection, CORRECTION_MARGIN};
use super::bicubic::{Bicubic, MARGIN};
use super::extend::widened;
use super::features::{DIMS, Features, INPUTS, Patches, RADIUS};
use super::network::{NETWORK_ESTIMATE_MARGIN, Network};
use super::orientation::{Offsets, Ways};
use super::plane::Plane;
use crate::linalg::vectorised;

/// Coarse cells at each side of a patch's middle whose fine cells are estimated from the patch.
pub(super) const HALF: usize = 1;
/// Coarse cells at each side of a plane of which patches say nothing.
const PATCH_MARGIN: usize = RADIUS + HALF;
/// Coarse cells at each side of a plane of which nothing is estimated.
pub(super) const ESTIMATE_MARGIN: usize =
    if PATCH_MARGIN > NETWORK_ESTIMATE_MARGIN { PATCH_MARGIN } else { NETWORK_ESTIMATE_MARGIN };
/// Coarse cells at each side that are needed beyond those that are made finer.
pub(super) const STEP_REACH: usize = ESTIMATE_MARGIN + CORRECTION_MARGIN;

/// Factors that there are steps of.
pub(super) const STEP_FACTORS: [usize; 4] = [7, 5, 3, 2];

/// What was learned for one factor at one scale.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) factor: usize,
    pub(super) is_square: bool,
    pub(super) features: Features,
    pub(super) anchors: Anchors,
    pub(super) estimator: Estimator,
}

/// What says how high fine cells are above the bicubic heights.
#[derive(Clone, Debug)]
pub(super) enum Estimator {
    /// For each anchor and each feature of a patch in standing position, its part in the fine cells' heights.
    Regressions(Vec<f32>),
    /// Nearer to the truth, in more time.
    Network(Network),
}

impl Estimator {
    /// Numbers that were learned.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Regressions(numbers) => numbers.len(),
            Self::Network(network) => network.len(),
        }
    }
}

/// Which patches an estimate is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Taken {
    /// One around each cell.
    All,
    /// Those around the cells whose row and column are an even number together: half the work.
    Even,
    /// The others.
    Odd,
}

impl Taken {
    /// Half of the patches, the same wherever a plane is cut out of its raster: its first cell lies in that row and column.
    pub(super) fn half(corner: [i64; 2]) -> Self {
        if (corner[0] + corner[1]) % 2 == 0 { Self::Even } else { Self::Odd }
    }

    /// Those of some columns in a row that have their middle there.
    #[inline(always)]
    fn columns(self, row: usize, cols: std::ops::Range<usize>) -> impl Iterator<Item = usize> {
        let (skipped, step) = match self {
            Self::All => (0, 1),
            Self::Even => ((row + cols.start) % 2, 2),
            Self::Odd => ((row + cols.start + 1) % 2, 2),
        };
        cols.skip(skipped).step_by(step)
    }

    /// How many patches say something of a coarse cell with such a sum of row and column.
    fn overlaps(self, sum: usize) -> f64 {
        match (self, sum % 2) {
            (Self::All, _) => 9.0,
            (Self::Even, 0) | (Self::Odd, 1) => 5.0,
            _ => 4.0,
        }
    }
}

/// Side in fine cells of what is estimated from one patch.
pub(super) fn detail_side(factor: usize) -> usize {
    (2 * HALF + 1) * factor
}

impl Step {
    /// Kinds of patches: few, so that each has many samples.
    pub(super) const KINDS: usize = BRANCHES;

    /// Numbers that were learned.
    pub(super) fn len(&self) -> usize {
        (INPUTS + (1 + BRANCHES) * BRANCHES) * DIMS + self.estimator.len()
    }

    /// The finer plane of all but [`STEP_REACH`] coarse cells at each side. Its means are the coarse heights where these
    /// are `known`.
    ///
    /// # Panics
    /// When the plane is not larger than its margins.
    pub(super) fn applied(&self, coarse: &Plane, known: &[bool]) -> Plane {
        let fine = self.estimated(coarse, 1.0, Taken::All);
        let known = trimmed_mask(known, coarse.cols(), ESTIMATE_MARGIN);
        BackProjection::new(self.factor).corrected(&fine, &coarse.trimmed(ESTIMATE_MARGIN), &known)
    }

    /// The finer plane of a whole raster, which goes on beyond its edges.
    pub(super) fn applied_whole(&self, coarse: &Plane, known: &[bool]) -> Plane {
        let (wide, known) = widened(coarse, known, STEP_REACH);
        self.applied(&wide, &known)
    }

    /// Bicubic heights and so many times the estimated detail, of all but [`ESTIMATE_MARGIN`] coarse cells at each side.
    pub(super) fn estimated(&self, coarse: &Plane, times: f64, patches: Taken) -> Plane {
        let (fine, margin) = match &self.estimator {
            Estimator::Regressions(regressors) => (self.regressed(regressors, coarse, times, patches), PATCH_MARGIN),
            Estimator::Network(network) => (network.estimated(coarse, times), NETWORK_ESTIMATE_MARGIN),
        };
        fine.trimmed((ESTIMATE_MARGIN - margin) * self.factor)
    }

    /// Bicubic heights and so many times the detail that patches say, of all but [`PATCH_MARGIN`] coarse cells at each
    /// side.
    fn regressed(&self, regressors: &[f32], coarse: &Plane, times: f64, patches: Taken) -> Plane {
        let mut fine = Bicubic::new(self.factor).enlarged(coarse).trimmed((PATCH_MARGIN - MARGIN) * self.factor);
        let detail = match self.factor {
            2 => self.detail::<36>(regressors, coarse, patches),
            3 => self.detail::<81>(regressors, coarse, patches),
            5 => self.detail::<225>(regressors, coarse, patches),
            7 => self.detail::<441>(regressors, coarse, patches),
            other => unreachable!("there are no steps of {other}"),
        };
        let cols = fine.cols();
        let lines = fine.heights_mut().chunks_exact_mut(cols.max(1)).zip(detail.chunks_exact(cols.max(1)));
        for (line, (heights, sums)) in lines.enumerate() {
            // Even and odd columns of coarse cells in turn.
            let parts =
                [0, 1].map(|col| times / patches.overlaps(line / self.factor + PATCH_MARGIN + col + PATCH_MARGIN));
            let cells = heights.chunks_exact_mut(self.factor).zip(sums.chunks_exact(self.factor));
            for ((heights, sums), part) in cells.zip(parts.into_iter().cycle()) {
                heights.iter_mut().zip(sums).for_each(|(height, sum)| *height += f64::from(*sum) * part);
            }
        }
        fine
    }

    /// Number of the kind of patch that heights around a cell are: one of [`Step::KINDS`].
    #[inline(always)]
    pub(super) fn kind(&self, patch: &[f32; INPUTS]) -> usize {
        self.anchors.branch(&self.features.of(patch))
    }

    /// Sums of what all patches say of the fine cells, of all but `RADIUS + HALF` coarse cells at each side. `CELLS` is
    /// how many fine cells a patch speaks of.
    ///
    /// Each fine cell takes its terms row by row of the patches, wherever the plane is cut.
    fn detail<const CELLS: usize>(&self, regressors: &[f32], coarse: &Plane, taken: Taken) -> Vec<f32> {
        let factor = self.factor;
        let [rows, cols] = [coarse.rows(), coarse.cols()].map(|side| side - 2 * RADIUS);
        // Beside the patches' middles what they say of the cells around them.
        let [high, wide] = [rows, cols].map(|side| (side + 2 * HALF) * factor);
        let mut sums = vec![0.0f32; high * wide];
        let places = Ways::new(detail_side(factor)).offsets(wide);
        let patches = Patches::new(coarse, self.is_square);
        for row in 0..rows {
            let middles = taken.columns(row + RADIUS, RADIUS..RADIUS + cols);
            vectorised(|| {
                self.add_row::<CELLS>(
                    regressors,
                    &patches,
                    row + RADIUS,
                    middles,
                    &places,
                    &mut sums[row * factor * wide..],
                )
            });
        }
        let cut = 2 * HALF * factor;
        let inner = sums.chunks_exact(wide).take(high - cut).skip(cut);
        inner.flat_map(|line| line[cut..wide - cut].iter().copied()).collect()
    }

    #[inline(always)]
    fn add_row<const CELLS: usize>(
        &self,
        regressors: &[f32],
        patches: &Patches<'_>,
        row: usize,
        middles: impl Iterator<Item = usize>,
        places: &Offsets,
        sums: &mut [f32],
    ) {
        let mut patch = [0.0; INPUTS];
        for col in middles {
            let way = patches.take(row, col, &mut patch);
            let features = self.features.of(&patch);
            let anchor = self.anchors.of(&features);
            let mut detail = [0.0f32; CELLS];
            let regressor = &regressors[anchor * DIMS * CELLS..][..DIMS * CELLS];
            for (parts, feature) in regressor.as_chunks::<CELLS>().0.iter().zip(features) {
                for (height, part) in detail.iter_mut().zip(parts) {
                    *height += feature * part;
                }
            }
            let square = &mut sums[(col - RADIUS) * self.factor..];
            for (height, &cell) in detail.iter().zip(places.of(way)) {
                square[cell] += height;
            }
        }
    }
}

/// A mask without so many cells at each side.
pub(super) fn trimmed_mask(mask: &[bool], cols: usize, margin: usize) -> Vec<bool> {
    let rows = mask.len() / cols;
    let lines = mask.chunks_exact(cols).take(rows - margin).skip(margin);
    lines.flat_map(|line| line[margin..cols - margin].iter().copied()).collect()
}
