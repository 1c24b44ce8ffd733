//! Makes a finer plane keep the means of the coarse one (Irani and Peleg 1991, doi:10.1016/1049-9652(91)90045-L).
//!
//! Back-projection adds the enlarged difference between a coarse plane and the fine one's means, again and again. What
//! the turns sum up to is known beforehand: with A for enlarging and averaging again, the sum of (1 - A)^n over all n
//! is A's inverse. A is a product of the same short filter along rows and columns, so its inverse is too, and is cut
//! where it is next to nothing: one turn with a filter in the place of many.

use super::bicubic::{Bicubic, MARGIN};
use super::plane::Plane;
use crate::linalg::vectorised;

/// Cells at each side of the middle where the inverse is cut; what is left of a difference is below a 15,000th.
const REACH: usize = 6;
/// Turns that the inverse is summed from, and cells at each side while it is.
const TURNS: usize = 60;
const ROOM: usize = 2 * TURNS;

/// Cells at each side of a coarse plane that are needed beyond those whose fine cells are corrected.
pub(super) const CORRECTION_MARGIN: usize = REACH + MARGIN;

/// Corrects fine planes.
#[derive(Clone, Debug)]
pub(super) struct BackProjection {
    bicubic: Bicubic,
    /// Half of the inverse's taps, from the middle one.
    inverse: [f64; REACH + 1],
}

impl BackProjection {
    /// For a factor.
    pub(super) fn new(factor: usize) -> Self {
        let bicubic = Bicubic::new(factor);
        let filter = bicubic.there_and_back();
        let (mut sum, mut left) = (vec![0.0; 2 * ROOM + 5], vec![0.0; 2 * ROOM + 5]);
        left[ROOM + 2] = 1.0;
        for _ in 0..TURNS {
            sum.iter_mut().zip(&left).for_each(|(sum, left)| *sum += left);
            let filtered: Vec<f64> =
                left.windows(5).map(|cells| cells.iter().zip(filter).map(|(cell, tap)| cell * tap).sum()).collect();
            left[2..2 * ROOM + 3].iter_mut().zip(filtered).for_each(|(left, filtered)| *left -= filtered);
        }
        let mut inverse = [0.0; REACH + 1];
        inverse.copy_from_slice(&sum[ROOM + 2..][..=REACH]);
        // A plain difference in height is taken away whole.
        inverse[0] = 1.0 - 2.0 * inverse[1..].iter().sum::<f64>();
        Self { bicubic, inverse }
    }

    /// The fine plane of `coarse`'s cells, corrected, of all but [`CORRECTION_MARGIN`] coarse cells at each side.
    /// Differences count only in the cells that are `known`.
    ///
    /// # Panics
    /// When the planes do not fit each other, or are smaller than the margins.
    #[must_use]
    pub(super) fn corrected(&self, fine: &Plane, coarse: &Plane, known: &[bool]) -> Plane {
        let factor = self.bicubic.factor();
        let mut difference = fine.averaged(factor);
        assert_eq!((difference.rows(), difference.cols()), (coarse.rows(), coarse.cols()), "planes that fit");
        for ((own, wanted), &known) in difference.heights_mut().iter_mut().zip(coarse.heights_m()).zip(known) {
            *own = if known { wanted - *own } else { 0.0 };
        }
        let more = self.bicubic.enlarged(&self.inverted(&difference));
        let mut out = fine.trimmed(CORRECTION_MARGIN * factor);
        out.heights_mut().iter_mut().zip(more.heights_m()).for_each(|(height, more)| *height += more);
        out
    }

    /// The inverse filter along columns and rows; takes [`REACH`] cells at each side.
    fn inverted(&self, plane: &Plane) -> Plane {
        let (rows, cols) = (plane.rows() - 2 * REACH, plane.cols() - 2 * REACH);
        let mut heights = vec![0.0; rows * cols];
        let mut line = vec![0.0; plane.cols()];
        for (row, out) in heights.chunks_exact_mut(cols.max(1)).enumerate() {
            vectorised(|| {
                let middle = row + REACH;
                line.iter_mut().zip(plane.row(middle)).for_each(|(sum, cell)| *sum = self.inverse[0] * cell);
                for (k, tap) in (1..).zip(&self.inverse[1..]) {
                    let pairs = plane.row(middle - k).iter().zip(plane.row(middle + k));
                    line.iter_mut().zip(pairs).for_each(|(sum, (a, b))| *sum += tap * (a + b));
                }
                out.iter_mut().zip(&line[REACH..]).for_each(|(sum, cell)| *sum = self.inverse[0] * cell);
                for (k, tap) in (1..).zip(&self.inverse[1..]) {
                    let pairs = line[REACH - k..].iter().zip(&line[REACH + k..]);
                    out.iter_mut().zip(pairs).for_each(|(sum, (a, b))| *sum += tap * (a + b));
                }
            });
        }
        Plane::new(rows, cols, heights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::amplify::extend::extended;
    use proptest::prelude::*;

    /// A coarse plane with a margin, as if it went on beyond its edges.
    fn wide(rows: usize, cols: usize, heights: &[f64], margin: usize) -> Plane {
        let whole = Plane::new(rows, cols, heights[..rows * cols].to_vec());
        let wanted = [-(margin as i64), -(margin as i64), (rows + 2 * margin) as i64, (cols + 2 * margin) as i64];
        extended(&whole, [0, 0], [rows, cols], wanted)
    }

    proptest! {
        #[test]
        fn means_are_kept_and_turns_come_to_the_same(
            factor in 2usize..8,
            rows in 1usize..7,
            cols in 1usize..7,
            heights in prop::collection::vec(0.0f64..100.0, 36),
        ) {
            // Far enough that what turns lose at the edges does not come in.
            let far = 40;
            let bicubic = Bicubic::new(factor);
            let coarse = wide(rows, cols, &heights, far);
            let mut slow = bicubic.enlarged(&coarse);
            let mut left = coarse.trimmed(MARGIN);
            for _ in 0..15 {
                let means = slow.averaged(factor);
                let heights = left.heights_m().iter().zip(means.heights_m()).map(|(a, b)| a - b).collect();
                let more = bicubic.enlarged(&Plane::new(left.rows(), left.cols(), heights));
                left = left.trimmed(MARGIN);
                let mut next = slow.trimmed(MARGIN * factor);
                next.heights_mut().iter_mut().zip(more.heights_m()).for_each(|(height, more)| *height += more);
                slow = next;
            }
            let slow = slow.trimmed((far - MARGIN - 15 * MARGIN) * factor);

            let coarse = wide(rows, cols, &heights, MARGIN + CORRECTION_MARGIN);
            let fine = bicubic.enlarged(&coarse);
            let within = coarse.trimmed(MARGIN);
            let known = vec![true; within.heights_m().len()];
            let quick = BackProjection::new(factor).corrected(&fine, &within, &known);
            prop_assert_eq!((quick.rows(), quick.cols()), (rows * factor, cols * factor));
            for (mean, &height) in quick.averaged(factor).heights_m().iter().zip(&heights[..rows * cols]) {
                prop_assert!((mean - height).abs() < 0.02, "{} is the mean of {}", mean, height);
            }
            for (a, b) in quick.heights_m().iter().zip(slow.heights_m()) {
                prop_assert!((a - b).abs() < 0.05, "{} and {}", a, b);
            }
        }
    }

    #[test]
    fn unknown_cells_pull_at_nothing() {
        let coarse = wide(1, 1, &[10.0], CORRECTION_MARGIN);
        let fine = Plane::new(34, 34, vec![3.0; 34 * 34]);
        let mut known = vec![false; 17 * 17];
        let kept = BackProjection::new(2).corrected(&fine, &coarse, &known);
        assert_eq!(kept.heights_m(), [3.0; 4]);
        known.fill(true);
        let moved = BackProjection::new(2).corrected(&fine, &coarse, &known);
        assert!(moved.heights_m().iter().all(|height| (height - 10.0).abs() < 1e-9), "{moved:?}");
    }
}
