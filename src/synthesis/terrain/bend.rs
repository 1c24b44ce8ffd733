//! A tree without lines gets lines.

use super::skeleton::{RidgeLine, Skeleton, Spot};
use crate::noise::{NoiseKind, NoiseSum, Sample, Spectrum};
use crate::orometry::GivenTree;
use crate::rng::Rng;

/// Wavelength in metres of the largest bends.
const WAVELENGTH_M: f64 = 1500.0;
/// How far a ridge bends at most, as a share of its length, and in metres.
const BEND: f64 = 0.12;
const BEND_M: f64 = 250.0;
/// Cells from one point of a line to the next.
const STEP: f64 = 2.0;

impl Skeleton {
    /// The skeleton of a tree that has places and elevations but no lines: ridges lead from saddle to peak, bent by one
    /// noise for all of the land, so neighbours bend alike and do not meet.
    pub fn of_tree(tree: &GivenTree, cell_m: [f64; 2], seed: u64) -> Self {
        let cols = tree.cols as u64;
        #[allow(clippy::cast_possible_truncation, reason = "cells of a raster in memory")]
        let spot = |cell: u64, elevation_m: f64| Spot {
            row: (cell / cols) as usize,
            col: (cell % cols) as usize,
            elevation_m,
        };
        let peaks: Vec<Spot> = tree.peaks.iter().map(|&(cell, elevation_m)| spot(cell, elevation_m)).collect();
        let saddles: Vec<Spot> = tree.passes.iter().map(|pass| spot(pass.cell, pass.elevation_m)).collect();
        let mut rng = Rng::new(seed);
        let mut noise = || {
            let spectrum = Spectrum {
                octaves: 3,
                amplitude: 1.0,
                wavelength: WAVELENGTH_M,
                persistence: 0.5,
                lacunarity: 2.0,
                seed: rng.next_u64(),
            };
            NoiseSum::new(NoiseKind::Fractal, spectrum.terms())
        };
        let bends = [noise(), noise()];
        let mut ridges = Vec::with_capacity(2 * saddles.len());
        for (saddle, pass) in (0..).zip(&tree.passes) {
            for peak in pass.peaks {
                let points = bent(&saddles[saddle as usize], &peaks[peak as usize], cell_m, &bends);
                ridges.push(RidgeLine { saddle, peak, points });
            }
        }
        Self { size: [tree.rows, tree.cols], cell_m, peaks, saddles, ridges }
    }
}

/// Columns and rows of the points of a bent line.
fn bent(saddle: &Spot, peak: &Spot, cell_m: [f64; 2], bends: &[NoiseSum; 2]) -> Vec<[f64; 2]> {
    let ends = [saddle, peak].map(|spot| [spot.col as f64, spot.row as f64]);
    let way = [0, 1].map(|k| ends[1][k] - ends[0][k]);
    let length_m = [0, 1].map(|k| (way[k] * cell_m[k]).powi(2)).iter().sum::<f64>().sqrt();
    let reach_m = (BEND * length_m).min(BEND_M);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "points of a line on a raster")]
    let steps = (length_m / (STEP * cell_m[0].min(cell_m[1]))).ceil().max(1.0) as usize;
    let point = |step: usize| {
        let part = step as f64 / steps as f64;
        let at = [0, 1].map(|k| ends[0][k] + part * way[k]);
        let [x, y] = [at[0] * cell_m[0], at[1] * cell_m[1]];
        // Nothing at both ends, where the line has to arrive.
        let share = 4.0 * part * (1.0 - part);
        [0, 1].map(|k| at[k] + share * reach_m * bends[k].at(x, y, Sample::default()).value / cell_m[k])
    };
    (0..=steps).map(point).collect()
}
