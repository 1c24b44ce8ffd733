//! A tree without lines gets lines.

use super::skeleton::{RidgeLine, Skeleton, Spot};
use crate::noise::{NoiseKind, NoiseSum, Sample, Spectrum};
use crate::orometry::{GivenPass, GivenTree};
use crate::rng::Rng;
use std::collections::BTreeSet;

/// Wavelength in metres of the largest bends.
const WAVELENGTH_M: f64 = 1500.0;
/// How far a ridge bends at most, as a share of its length, and in metres.
const BEND: f64 = 0.12;
const BEND_M: f64 = 250.0;
/// Cells from one point of a line to the next.
const STEP: f64 = 2.0;

impl Skeleton {
    /// The skeleton of a tree that has places and elevations but hardly any lines: ridges lead from saddle to peak, or to
    /// the first bend that they have, bent by one noise for all of the land, so neighbours bend alike and do not meet.
    /// What `is_drawn` says is drawn, of passes by their position, stays as it is; others bend less where they would come
    /// too near to that.
    pub fn of_tree(tree: &GivenTree, is_drawn: &dyn Fn(usize) -> bool, cell_m: [f64; 2], seed: u64) -> Self {
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
        let drawn = |number: usize, pass: &GivenPass| {
            let line = |side: usize| {
                let on = pass.bends[side].iter().map(|&cell| point(&spot(cell, f64::NAN)));
                let mut points = vec![point(&saddles[number])];
                points.extend(on);
                points.push(point(&peaks[pass.peaks[side] as usize]));
                points
            };
            [line(0), line(1)]
        };
        let passes = || tree.passes.iter().enumerate();
        let mut near = BTreeSet::new();
        for line in passes().filter(|(number, _)| is_drawn(*number)).flat_map(|(number, pass)| drawn(number, pass)) {
            for pair in line.windows(2) {
                near.extend(cells_between(pair[0], pair[1]).flat_map(around));
            }
        }
        let mut ridges = Vec::with_capacity(2 * saddles.len());
        for (number, pass) in passes() {
            for (peak, line) in pass.peaks.into_iter().zip(drawn(number, pass)) {
                let points = match line[..] {
                    [saddle, to, ..] if !is_drawn(number) => bent(saddle, to, cell_m, &bends, &near),
                    _ => line,
                };
                #[allow(clippy::cast_possible_truncation, reason = "saddles are counted with 32 bits")]
                ridges.push(RidgeLine { saddle: number as u32, peak, points });
            }
        }
        Self { size: [tree.rows, tree.cols], cell_m, peaks, saddles, ridges }
    }
}

/// Column and row.
fn point(spot: &Spot) -> [f64; 2] {
    [spot.col as f64, spot.row as f64]
}

/// The cell of a point: column and row.
fn cell(at: [f64; 2]) -> [i64; 2] {
    #[allow(clippy::cast_possible_truncation, reason = "points of a line on a raster")]
    at.map(|at| at.round() as i64)
}

/// The cells around one, and itself.
fn around([col, row]: [i64; 2]) -> impl Iterator<Item = [i64; 2]> {
    (-1..=1).flat_map(move |down| (-1..=1).map(move |right| [col + right, row + down]))
}

/// Cells along a straight line, each beside the one before.
fn cells_between(from: [f64; 2], to: [f64; 2]) -> impl Iterator<Item = [i64; 2]> {
    let way = [0, 1].map(|k| to[k] - from[k]);
    let steps = way[0].abs().max(way[1].abs()).ceil().max(1.0);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "steps of a line on a raster")]
    (0..=steps as u32).map(move |step| cell([0, 1].map(|k| from[k] + way[k] * (f64::from(step) / steps))))
}

/// Shares of a bend that are tried where it comes too near to what is drawn.
const SHARES: [f64; 4] = [1.0, 0.5, 0.25, 0.0];
/// So near to its ends a line may touch what is drawn: it may begin there.
const ENDS: i64 = 4;

/// Columns and rows of the points of a line that is bent as far as it stays clear of some cells.
fn bent(
    from: [f64; 2],
    to: [f64; 2],
    cell_m: [f64; 2],
    bends: &[NoiseSum; 2],
    near: &BTreeSet<[i64; 2]>,
) -> Vec<[f64; 2]> {
    let is_end = |at: [i64; 2]| {
        [from, to].map(cell).iter().any(|end| (end[0] - at[0]).abs().max((end[1] - at[1]).abs()) <= ENDS)
    };
    let is_clear = |line: &Vec<[f64; 2]>| {
        let mut cells = line.windows(2).flat_map(|pair| cells_between(pair[0], pair[1]));
        near.is_empty() || !cells.any(|at| near.contains(&at) && !is_end(at))
    };
    let lines = SHARES.map(|share| move || bent_by(share, from, to, cell_m, bends));
    lines.iter().map(|line| line()).find(is_clear).unwrap_or_else(|| vec![from, to])
}

/// Columns and rows of the points of a line with a share of its bends.
fn bent_by(share: f64, from: [f64; 2], to: [f64; 2], cell_m: [f64; 2], bends: &[NoiseSum; 2]) -> Vec<[f64; 2]> {
    let way = [0, 1].map(|k| to[k] - from[k]);
    let length_m = [0, 1].map(|k| (way[k] * cell_m[k]).powi(2)).iter().sum::<f64>().sqrt();
    let reach_m = share * (BEND * length_m).min(BEND_M);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "points of a line on a raster")]
    let steps = (length_m / (STEP * cell_m[0].min(cell_m[1]))).ceil().max(1.0) as usize;
    let point = |step: usize| {
        let part = step as f64 / steps as f64;
        let at = [0, 1].map(|k| from[k] + part * way[k]);
        let [x, y] = [at[0] * cell_m[0], at[1] * cell_m[1]];
        // Nothing at both ends, where the line has to arrive.
        let share = 4.0 * part * (1.0 - part);
        [0, 1].map(|k| at[k] + share * reach_m * bends[k].at(x, y, Sample::default()).value / cell_m[k])
    };
    (0..=steps).map(point).collect()
}
