//! How steep a range is, and how high above and below the mean around.

use super::ground::Ground;
use rayon::prelude::*;

/// How steep a range is, and how high above and below the mean around.
#[derive(Clone, Debug, PartialEq)]
pub struct Likeness {
    /// Side in metres of the cells on which it was measured.
    pub cell_m: f64,
    /// Quantiles of its slopes in degrees, evenly spaced, from the least to the greatest.
    pub slopes: Vec<f64>,
    /// Quantiles of its elevations above the mean of blocks of 5 km, in metres, evenly spaced.
    pub reliefs_m: Vec<f64>,
}

/// Quantiles that are compared.
pub(super) const QUANTILES: usize = 101;
/// Side in metres of the blocks above whose means elevations are told.
const BLOCK_M: f64 = 5000.0;

impl Likeness {
    /// That of a raster of elevations in metres, voids being NaN, on the means of square cells of `side_m` metres
    /// where its own are smaller.
    pub fn of<T: Copy + Into<f64> + Sync>(z_m: &[T], size: [usize; 2], cell_m: [f64; 2], side_m: f64) -> Self {
        let own_m = cell_m[0].min(cell_m[1]);
        if side_m <= own_m * 1.001 {
            let z_m: Vec<f64> = z_m.par_iter().map(|&z| z.into()).collect();
            return Self::on(&z_m, size, cell_m);
        }
        let (means, size) = averaged(z_m, size, cell_m, side_m);
        Self::on(&means, size, [side_m; 2])
    }

    fn on(z_m: &[f64], [rows, cols]: [usize; 2], [width_m, height_m]: [f64; 2]) -> Self {
        let inside = 1..rows.saturating_sub(1).max(1);
        let slopes: Vec<f64> = inside
            .into_par_iter()
            .flat_map_iter(|row| {
                (1..cols.saturating_sub(1)).map(move |col| {
                    let at = |row: usize, col: usize| z_m[row * cols + col];
                    let x = (at(row, col + 1) - at(row, col - 1)) / (2.0 * width_m);
                    let y = (at(row + 1, col) - at(row - 1, col)) / (2.0 * height_m);
                    (x * x + y * y).sqrt()
                })
            })
            .filter(|slope| slope.is_finite())
            .collect();
        let steep = |slope: f64| slope.atan().to_degrees();
        let reliefs_m = reliefs_m(z_m, [rows, cols], [width_m, height_m]);
        Self {
            cell_m: width_m.min(height_m),
            slopes: quantiles(slopes).into_iter().map(steep).collect(),
            reliefs_m: quantiles(reliefs_m),
        }
    }

    /// Mean distance in degrees between the slopes of two ranges, from the least to the greatest.
    pub fn distance(&self, other: &Self) -> f64 {
        let sum: f64 = self.slopes.iter().zip(&other.slopes).map(|(a, b)| (a - b).abs()).sum();
        sum / self.slopes.len().min(other.slopes.len()).max(1) as f64
    }
}

/// Elevations above the mean of the block around, voids left out.
fn reliefs_m(z_m: &[f64], [rows, cols]: [usize; 2], [width_m, height_m]: [f64; 2]) -> Vec<f64> {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "no more than there are cells")]
    let blocks =
        |count: usize, cell_m: f64| ((count as f64 * cell_m / BLOCK_M).round() as usize).clamp(1, count.max(1));
    let size = [blocks(rows, height_m), blocks(cols, width_m)];
    let as_f32: Vec<f32> = z_m.iter().map(|&z| z as f32).collect();
    let means = Ground::of(&as_f32, [rows, cols], size).z_m;
    let mean = |cell: usize| means[cell / cols * size[0] / rows * size[1] + cell % cols * size[1] / cols];
    let known = z_m.iter().enumerate().filter(|(_, z)| z.is_finite());
    known.map(|(cell, z)| z - f64::from(mean(cell))).collect()
}

/// Quantiles, evenly spaced, from the least to the greatest; none of nothing.
fn quantiles(mut values: Vec<f64>) -> Vec<f64> {
    values.par_sort_unstable_by(f64::total_cmp);
    let quantile = |i: usize| values[i * (values.len() - 1) / (QUANTILES - 1)];
    if values.is_empty() { vec![] } else { (0..QUANTILES).map(quantile).collect() }
}

/// Means of square cells of `side_m` metres, parts of cells counting as such, and the number of rows and columns; NaN
/// where a void has a part. What is left over at the last row and column is left out.
fn averaged<T: Copy + Into<f64> + Sync>(
    z_m: &[T],
    [rows, cols]: [usize; 2],
    [width_m, height_m]: [f64; 2],
    side_m: f64,
) -> (Vec<f64>, [usize; 2]) {
    let along = |count: usize, cell_m: f64| -> Vec<Vec<(usize, f64)>> {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "no more than there are cells")]
        let blocks = (count as f64 * cell_m / side_m + 1e-6) as usize;
        (0..blocks).map(|block| parts(block, side_m / cell_m, count)).collect()
    };
    let [downs, rights] = [along(rows, height_m), along(cols, width_m)];
    let size = [downs.len(), rights.len()];
    let mean = |down: &[(usize, f64)], right: &[(usize, f64)]| {
        let line = |row: usize| -> f64 { right.iter().map(|&(col, part)| part * z_m[row * cols + col].into()).sum() };
        down.iter().map(|&(row, part)| part * line(row)).sum::<f64>()
    };
    let means = downs.par_iter().flat_map_iter(|down| rights.iter().map(move |right| mean(down, right))).collect();
    (means, size)
}

/// The cells in a block of `ratio` cells, each with its share.
fn parts(block: usize, ratio: f64, count: usize) -> Vec<(usize, f64)> {
    let [from, to] = [block, block + 1].map(|edge| (edge as f64 * ratio).min(count as f64));
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cells of the raster")]
    let cells = from as usize..(to.ceil() as usize).min(count);
    let share = |cell: usize| ((cell as f64 + 1.0).min(to) - (cell as f64).max(from)) / (to - from);
    cells.map(|cell| (cell, share(cell))).filter(|(_, share)| *share > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_of_parts() {
        let z: Vec<f32> = (0..25).map(|i| (i % 5) as f32).collect();
        // Blocks of one and a half cells: 0, 0, half of 1; half of 1, 2; ...
        let (means, size) = averaged(&z, [5, 5], [10.0, 10.0], 15.0);
        assert_eq!(size, [3, 3]);
        for (mean, wanted) in means.iter().zip([1.0 / 3.0, 5.0 / 3.0, 10.0 / 3.0].into_iter().cycle()) {
            assert!((mean - wanted).abs() < 1e-12, "{mean} for {wanted}");
        }
        // Two cells a block, and one cell that is left over.
        let (means, size) = averaged(&z, [5, 5], [10.0, 10.0], 20.0);
        assert_eq!((means, size), (vec![0.5, 2.5, 0.5, 2.5], [2, 2]));
    }

    #[test]
    fn slopes_of_a_ramp() {
        let z: Vec<f32> = (0..400).map(|i| (i % 20) as f32 * 10.0).collect();
        for side_m in [5.0, 10.0, 25.0] {
            let likeness = Likeness::of(&z, [20, 20], [10.0, 10.0], side_m);
            assert_eq!(likeness.slopes.len(), QUANTILES);
            assert!(likeness.slopes.iter().all(|slope| (slope - 45.0).abs() < 1e-9), "{side_m}");
        }
        assert!(Likeness::of(&z[..20], [1, 20], [10.0, 10.0], 10.0).slopes.is_empty(), "one row has no slopes");
        let ramps = [1.0, 2.0].map(|rise| {
            let z: Vec<f64> = (0..100).map(|i| f64::from(i / 10) * rise).collect();
            Likeness::of(&z, [10, 10], [1.0, 1.0], 1.0)
        });
        assert!((ramps[0].distance(&ramps[1]) - (2.0_f64.atan().to_degrees() - 45.0)).abs() < 1e-9);
    }
}
