//! How high the ground between the ridges may be.

use super::crest::Crest;
use super::form::Graded;
use super::membrane::stretch;
use super::skeleton::Skeleton;

/// Cells of the raster along a side of those on which the ceiling is told.
const STEP: usize = 2;

/// As high as the peaks of the ridges beside, in metres: stretched between the ridges, and nowhere higher than the peak of
/// the nearest. Ground that is higher would be what these peaks are to be. Told on larger cells, where the lowest of
/// several peaks counts.
pub(super) struct Ceiling {
    cols: usize,
    z_m: Vec<f32>,
}

impl Ceiling {
    /// The ceiling over the ground between the ridges of a crest.
    pub(super) fn of(crest: &Crest, skeleton: &Skeleton) -> Self {
        let size = skeleton.size.map(|count| count.div_ceil(STEP));
        let cell_m = skeleton.cell_m.map(|side| side * STEP as f64);
        let mut tops_m = vec![f32::INFINITY; size[0] * size[1]];
        for cell in (0..crest.z_m.len()).filter(|&cell| crest.is(cell)) {
            let peak = crest.peak(skeleton, cell).map(|peak| skeleton.peaks[peak as usize].elevation_m as f32);
            let top = &mut tops_m[cell / crest.cols / STEP * size[1] + cell % crest.cols / STEP];
            *top = top.min(peak.unwrap_or(crest.z_m[cell]));
        }
        let is_crest: Vec<bool> = tops_m.iter().map(|top_m| top_m.is_finite()).collect();
        let (nearest_m, stretched_m) = rayon::join(
            || nearest(&tops_m, &is_crest, size, cell_m),
            || {
                let mut z_m = tops_m.clone();
                stretch(&mut z_m, &is_crest, size, cell_m, &Graded::even(0.0));
                z_m
            },
        );
        let z_m = stretched_m.iter().zip(&nearest_m).map(|(stretched, nearest)| stretched.min(*nearest)).collect();
        Self { cols: size[1], z_m }
    }

    /// The elevation in metres over the cell of a row and a column.
    #[inline]
    pub(super) fn at(&self, row: usize, col: usize) -> f32 {
        self.z_m[row / STEP * self.cols + col / STEP]
    }
}

/// The value of the nearest cell that is marked, from cell to cell.
///
/// # Complexity
/// O(n).
pub(super) fn nearest(values: &[f32], is_marked: &[bool], [rows, cols]: [usize; 2], cell_m: [f64; 2]) -> Vec<f32> {
    let [width_m, height_m] = cell_m.map(|side| side as f32);
    let slant_m = (width_m * width_m + height_m * height_m).sqrt();
    let marked = |(&value, &is_marked): (&f32, &bool)| if is_marked { (0.0, value) } else { (f32::INFINITY, value) };
    let mut best: Vec<(f32, f32)> = values.iter().zip(is_marked).map(marked).collect();
    let mut take = |cell: usize, from: usize, step_m: f32| {
        let (far_m, value) = best[from];
        if far_m + step_m < best[cell].0 {
            best[cell] = (far_m + step_m, value);
        }
    };
    for row in 0..rows {
        for col in 0..cols {
            let cell = row * cols + col;
            if row > 0 {
                take(cell, cell - cols, height_m);
                if col > 0 {
                    take(cell, cell - cols - 1, slant_m);
                }
                if col + 1 < cols {
                    take(cell, cell - cols + 1, slant_m);
                }
            }
            if col > 0 {
                take(cell, cell - 1, width_m);
            }
        }
        (0..cols.saturating_sub(1)).rev().for_each(|col| take(row * cols + col, row * cols + col + 1, width_m));
    }
    for row in (0..rows).rev() {
        for col in (0..cols).rev() {
            let cell = row * cols + col;
            if row + 1 < rows {
                take(cell, cell + cols, height_m);
                if col > 0 {
                    take(cell, cell + cols - 1, slant_m);
                }
                if col + 1 < cols {
                    take(cell, cell + cols + 1, slant_m);
                }
            }
            if col + 1 < cols {
                take(cell, cell + 1, width_m);
            }
        }
        (1..cols).for_each(|col| take(row * cols + col, row * cols + col - 1, width_m));
    }
    best.into_iter().map(|(_, value)| value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn the_nearest_mark() {
        let mut rng = Rng::new(5);
        for _ in 0..200 {
            let size = [1 + rng.below(9) as usize, 1 + rng.below(9) as usize];
            let cell_m = [10.0, 10.0 + rng.below(3) as f64 * 7.0];
            let count = size[0] * size[1];
            let is_marked: Vec<bool> = (0..count).map(|_| rng.below(6) == 0).collect();
            // Each cell's value is its number, so that one sees which was found.
            let values: Vec<f32> = (0..count).map(|cell| cell as f32).collect();
            let found = nearest(&values, &is_marked, size, cell_m);
            let far_m = |a: usize, b: usize| {
                let [down, right] = [(a / size[1]).abs_diff(b / size[1]), (a % size[1]).abs_diff(b % size[1])];
                let slant = down.min(right);
                slant as f64 * cell_m[0].hypot(cell_m[1])
                    + (right - slant) as f64 * cell_m[0]
                    + (down - slant) as f64 * cell_m[1]
            };
            for cell in 0..count {
                let marks = (0..count).filter(|&mark| is_marked[mark]);
                match marks.map(|mark| far_m(cell, mark)).reduce(f64::min) {
                    Some(least_m) => {
                        let own = found[cell] as usize;
                        assert!(
                            is_marked[own] && (far_m(cell, own) - least_m).abs() < 1e-3,
                            "{cell} of {size:?}: {own}"
                        );
                    }
                    None => assert_eq!(found[cell], values[cell], "nothing is marked"),
                }
            }
        }
    }
}
