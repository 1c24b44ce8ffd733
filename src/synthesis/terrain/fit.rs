//! Slopes and plains chosen so that the terrain is as steep, and as high, as a real range.

use super::ground::Ground;
use super::raise::{TerrainOptions, raise_once};
use super::skeleton::{Skeleton, Spot};
use crate::erosion::Relief;
use crate::error::Result;
use crate::watch::Watch;

/// How steep a range is.
#[derive(Clone, Debug, PartialEq)]
pub struct Likeness {
    /// Side in metres of the cells on which it was measured.
    pub cell_m: f64,
    /// Quantiles of its slopes in degrees, evenly spaced, from the least to the greatest.
    pub slopes: Vec<f64>,
}

/// Quantiles that are compared.
const QUANTILES: usize = 101;
/// Side in cells of the part of the terrain on which options are tried.
const WINDOW: usize = 800;
/// A difference of so many degrees of slope counts as much ...
const SLOPE: f64 = 1.5;
/// ... as one of so many metres of mean elevation.
const MEAN_M: f64 = 60.0;

impl Likeness {
    /// The slopes of a raster of elevations in metres, voids being NaN.
    pub fn of<T: Copy + Into<f64>>(z_m: &[T], [rows, cols]: [usize; 2], [width_m, height_m]: [f64; 2]) -> Self {
        let mut slopes = vec![];
        for row in 1..rows.saturating_sub(1) {
            for col in 1..cols.saturating_sub(1) {
                let at = |row: usize, col: usize| -> f64 { z_m[row * cols + col].into() };
                let x = (at(row, col + 1) - at(row, col - 1)) / (2.0 * width_m);
                let y = (at(row + 1, col) - at(row - 1, col)) / (2.0 * height_m);
                let slope = (x * x + y * y).sqrt();
                if slope.is_finite() {
                    slopes.push(slope);
                }
            }
        }
        slopes.sort_unstable_by(f64::total_cmp);
        let quantile = |i: usize| slopes[i * (slopes.len() - 1) / (QUANTILES - 1)].atan().to_degrees();
        let slopes = if slopes.is_empty() { vec![] } else { (0..QUANTILES).map(quantile).collect() };
        Self { cell_m: width_m.min(height_m), slopes }
    }

    /// Mean distance in degrees between the slopes of two ranges, from the least to the greatest.
    pub fn distance(&self, other: &Self) -> f64 {
        let sum: f64 = self.slopes.iter().zip(&other.slopes).map(|(a, b)| (a - b).abs()).sum();
        sum / self.slopes.len().min(other.slopes.len()).max(1) as f64
    }
}

/// Options with the slope and the roughness, and where the ground is known the depth of plains, with which the middle of
/// the terrain comes out most like a range.
///
/// # Errors
/// As [`raise`](super::raise()).
pub fn fit(skeleton: &Skeleton, options: &TerrainOptions, like: &Likeness, watch: &Watch) -> Result<TerrainOptions> {
    let Some(steep) = like.slopes.get(3 * QUANTILES / 4).map(|slope| slope.to_radians().tan()) else {
        return Ok(options.clone());
    };
    let (part, ground) = middle(skeleton, options.ground.as_ref());
    let trial = |shape: Shape| -> Result<f64> {
        let tried = TerrainOptions { ground: ground.clone(), ..shape.on(options) };
        difference(&raise_once(&part, &tried, watch)?.relief, like, ground.as_ref())
    };
    let mut best = Shape { slope: 0.8 * steep, depth: options.depth, roughness: options.roughness };
    let mut least = trial(best)?;
    let mut step = 1.3;
    for _ in 0..ROUNDS {
        let was = least;
        for change in CHANGES.iter().filter(|change| ground.is_some() || change[1] == 0) {
            let tried = best.changed(*change, step);
            let found = trial(tried)?;
            if found < least {
                (least, best) = (found, tried);
            }
        }
        if least == was {
            step = 1.0 + (step - 1.0) / 2.0;
        }
    }
    Ok(best.on(options))
}

/// What is chosen.
#[derive(Clone, Copy)]
struct Shape {
    slope: f64,
    depth: f64,
    roughness: f64,
}

/// Which of slope, depth and roughness is made larger, and which smaller.
const CHANGES: [[i32; 3]; 8] =
    [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1], [1, -1, 0], [-1, 1, 0]];

impl Shape {
    fn changed(self, change: [i32; 3], step: f64) -> Self {
        let by = |value: f64, change: i32| match change {
            1 => value * step,
            -1 => value / step,
            _ => value,
        };
        Self {
            slope: by(self.slope, change[0]),
            depth: by(self.depth, change[1]),
            roughness: by(self.roughness, change[2]).min(1.0),
        }
    }

    /// The options with this shape, in thousandths: the last bits of a tangent may differ from machine to machine.
    fn on(self, options: &TerrainOptions) -> TerrainOptions {
        let rounded = |value: f64| (value * 1000.0).round() / 1000.0;
        TerrainOptions {
            slope: rounded(self.slope.clamp(0.01, 3.0)),
            depth: rounded(self.depth),
            roughness: rounded(self.roughness),
            ..options.clone()
        }
    }
}

/// Rounds of looking around for better options.
const ROUNDS: usize = 4;
/// Blocks of the ground whose mean is compared, in each direction.
const BLOCK: usize = 5;

/// How unlike a terrain is.
fn difference(relief: &Relief, like: &Likeness, ground: Option<&Ground>) -> Result<f64> {
    let (means, size, cell_m) = averaged(relief, like.cell_m);
    let slope = Likeness::of(&means, size, cell_m).distance(like) / SLOPE;
    let mean = ground.map_or(0.0, |ground| {
        let sum = |z: &[f32]| z.iter().map(|&z| f64::from(z)).sum::<f64>() / z.len().max(1) as f64;
        let of_all = (sum(&means) - sum(&ground.z_m)).abs();
        // Here too high and there too low is not as it should be, either.
        let blocks = ground.size.map(|count| count.div_ceil(BLOCK));
        let [own, wanted] = [Ground::of(&means, size, blocks), Ground::of(&ground.z_m, ground.size, blocks)];
        let apart: f64 = own.z_m.iter().zip(&wanted.z_m).map(|(a, b)| f64::from((a - b).abs())).sum();
        (of_all + apart / own.z_m.len() as f64) / (2.0 * MEAN_M)
    });
    Ok(slope + mean)
}

/// Means of blocks about as large as cells of a size in metres; their size, and that of the raster of blocks.
fn averaged(relief: &Relief, cell_m: f64) -> (Vec<f32>, [usize; 2], [f64; 2]) {
    let own_m = relief.cell_m().map(f64::from);
    let count = own_m.map(|own_m| ((cell_m / own_m).round() as usize).max(1));
    let size = [relief.rows() / count[1], relief.cols() / count[0]];
    let mut means = Vec::with_capacity(size[0] * size[1]);
    for row in 0..size[0] {
        for col in 0..size[1] {
            let rows = row * count[1]..(row + 1) * count[1];
            let sum: f32 = rows.flat_map(|row| &relief.z_m()[row * relief.cols() + col * count[0]..][..count[0]]).sum();
            means.push(sum / (count[0] * count[1]) as f32);
        }
    }
    (means, size, [own_m[0] * count[0] as f64, own_m[1] * count[1] as f64])
}

/// The middle of a skeleton and of its ground.
fn middle(skeleton: &Skeleton, ground: Option<&Ground>) -> (Skeleton, Option<Ground>) {
    let size = skeleton.size.map(|count| count.min(WINDOW));
    let first = [0, 1].map(|k| (skeleton.size[k] - size[k]) / 2);
    let ground = ground.map(|ground| ground.part(skeleton.size, first, size));
    let mut part = Skeleton { size, ..skeleton.clone() };
    let is_inside = |spot: &Spot| {
        (first[0]..first[0] + size[0]).contains(&spot.row) && (first[1]..first[1] + size[1]).contains(&spot.col)
    };
    // Ridges that leave the window end there: a peak or saddle outside of it is none.
    let moved = |spots: &[Spot]| -> (Vec<Spot>, Vec<Option<u32>>) {
        let mut kept = vec![];
        let numbers = spots
            .iter()
            .map(|spot| {
                is_inside(spot).then(|| {
                    kept.push(Spot { row: spot.row - first[0], col: spot.col - first[1], ..*spot });
                    kept.len() as u32 - 1
                })
            })
            .collect();
        (kept, numbers)
    };
    let (peaks, peak_numbers) = moved(&skeleton.peaks);
    let (saddles, saddle_numbers) = moved(&skeleton.saddles);
    (part.peaks, part.saddles) = (peaks, saddles);
    part.ridges.retain_mut(|ridge| {
        let numbers = saddle_numbers[ridge.saddle as usize].zip(peak_numbers[ridge.peak as usize]);
        if let Some((saddle, peak)) = numbers {
            (ridge.saddle, ridge.peak) = (saddle, peak);
            for point in &mut ridge.points {
                *point = [point[0] - first[1] as f64, point[1] - first[0] as f64];
            }
        }
        numbers.is_some()
    });
    (part, ground)
}
