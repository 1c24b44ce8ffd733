//! One step of amplification: a plane some times finer, with what an exemplar has taught.

use super::anchors::Anchors;
use super::back_projection::{BackProjection, CORRECTION_MARGIN};
use super::bicubic::{Bicubic, MARGIN};
use super::features::{DIMS, Features, INPUTS, Patches, RADIUS};
use super::orientation::{Offsets, Ways};
use super::plane::Plane;
use crate::linalg::vectorised;

/// Coarse cells at each side of a patch's middle whose fine cells are estimated from the patch.
pub(super) const HALF: usize = 1;
/// Patches that say something of a fine cell.
const OVERLAPS: f64 = ((2 * HALF + 1) * (2 * HALF + 1)) as f64;
/// Coarse cells at each side that are needed beyond those that are made finer.
pub(super) const STEP_REACH: usize = RADIUS + HALF + CORRECTION_MARGIN;

/// Factors that there are steps of.
pub(super) const STEP_FACTORS: [usize; 4] = [7, 5, 3, 2];

/// What was learned for one factor at one scale.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) factor: usize,
    pub(super) is_square: bool,
    pub(super) features: Features,
    pub(super) anchors: Anchors,
    /// For each anchor and each feature of a patch in standing position, its part in the fine cells' heights above
    /// the bicubic ones.
    pub(super) regressors: Vec<f32>,
}

/// Side in fine cells of what is estimated from one patch.
pub(super) fn detail_side(factor: usize) -> usize {
    (2 * HALF + 1) * factor
}

impl Step {
    /// The finer plane of all but [`STEP_REACH`] coarse cells at each side. Its means are the coarse heights where these
    /// are `known`.
    ///
    /// # Panics
    /// When the plane is not larger than its margins.
    pub(super) fn applied(&self, coarse: &Plane, known: &[bool]) -> Plane {
        let margin = RADIUS + HALF;
        let mut fine = Bicubic::new(self.factor).enlarged(coarse).trimmed((margin - MARGIN) * self.factor);
        let detail = match self.factor {
            2 => self.detail::<36>(coarse),
            3 => self.detail::<81>(coarse),
            5 => self.detail::<225>(coarse),
            7 => self.detail::<441>(coarse),
            other => unreachable!("there are no steps of {other}"),
        };
        fine.heights_mut().iter_mut().zip(detail).for_each(|(height, sum)| *height += f64::from(sum) / OVERLAPS);
        let known = trimmed_mask(known, coarse.cols(), margin);
        BackProjection::new(self.factor).corrected(&fine, &coarse.trimmed(margin), &known)
    }

    /// Sums of what all patches say of the fine cells, of all but `RADIUS + HALF` coarse cells at each side. `CELLS` is
    /// how many fine cells a patch speaks of.
    ///
    /// Each fine cell takes its terms row by row of the patches, wherever the plane is cut.
    fn detail<const CELLS: usize>(&self, coarse: &Plane) -> Vec<f32> {
        let factor = self.factor;
        let [rows, cols] = [coarse.rows(), coarse.cols()].map(|side| side - 2 * RADIUS);
        // Beside the patches' middles what they say of the cells around them.
        let [high, wide] = [rows, cols].map(|side| (side + 2 * HALF) * factor);
        let mut sums = vec![0.0f32; high * wide];
        let places = Ways::new(detail_side(factor)).offsets(wide);
        let patches = Patches::new(coarse, self.is_square);
        for row in 0..rows {
            vectorised(|| self.add_row::<CELLS>(&patches, row, cols, &places, &mut sums[row * factor * wide..]));
        }
        let cut = 2 * HALF * factor;
        let inner = sums.chunks_exact(wide).take(high - cut).skip(cut);
        inner.flat_map(|line| line[cut..wide - cut].iter().copied()).collect()
    }

    #[inline(always)]
    fn add_row<const CELLS: usize>(
        &self,
        patches: &Patches<'_>,
        row: usize,
        cols: usize,
        places: &Offsets,
        sums: &mut [f32],
    ) {
        let mut patch = [0.0; INPUTS];
        for col in 0..cols {
            let way = patches.take(row + RADIUS, col + RADIUS, &mut patch);
            let features = self.features.of(&patch);
            let anchor = self.anchors.of(&features);
            let mut detail = [0.0f32; CELLS];
            let regressor = &self.regressors[anchor * DIMS * CELLS..][..DIMS * CELLS];
            for (parts, feature) in regressor.as_chunks::<CELLS>().0.iter().zip(features) {
                for (height, part) in detail.iter_mut().zip(parts) {
                    *height += feature * part;
                }
            }
            let square = &mut sums[col * self.factor..];
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
