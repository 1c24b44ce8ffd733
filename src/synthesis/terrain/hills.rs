//! Hills between ridges and valleys, which are none of the tree's.

use super::ceiling::Ceiling;
use super::crest::Crest;
use super::form::Graded;
use super::skeleton::Skeleton;
use crate::erosion::{Relief, fill};
use crate::error::Result;
use rayon::prelude::*;

/// Hills that stand by themselves are less than so many metres high.
const HILL_M: f32 = 20.0;
/// By how much at least the ground beside ridges is lower than their peaks, in metres.
const BELOW_M: f32 = 0.5;
/// How high a rim keeps what is upside down from flowing off, in metres.
const RIM_M: f32 = 1e6;

/// Lays detail on ground that is stretched between ridges and valleys, `clear_m` metres from them, and keeps it below the
/// peaks of the ridges beside.
pub(super) fn hilly(
    z_m: &mut [f32],
    clear_m: &[f32],
    detail_m: &[f32],
    ceiling: &Ceiling,
    size: [usize; 2],
    slope: &Graded,
) {
    let cols = size[1];
    let rows = z_m.par_chunks_mut(cols).zip(clear_m.par_chunks(cols)).zip(detail_m.par_chunks(cols));
    rows.enumerate().for_each(|(row, ((line, clear_m), detail_m))| {
        let slopes = slope.row(row, size);
        for (col, ((z, &clear_m), &detail_m)) in line.iter_mut().zip(clear_m).zip(detail_m).enumerate() {
            if clear_m > 0.0 && clear_m.is_finite() {
                // The nearer to what stands fast the less detail there is.
                let most_m = slopes[col] * clear_m;
                let own_m = detail_m * most_m / (most_m + detail_m.abs());
                *z = (*z + own_m).min(ceiling.at(row, col) - BELOW_M);
            }
        }
    });
}

/// Takes hills away that stand by themselves: from each cell between the ridges a way leads up to one, and hardly down.
///
/// Upside down these hills are depressions, and ridges where water leaves: so they are filled. A rim keeps it from leaving
/// at the raster's edge.
pub(super) fn shaved(mut z_m: Vec<f32>, crest: &Crest, skeleton: &Skeleton) -> Result<Vec<f32>> {
    let [rows, cols] = skeleton.size;
    let mut rimmed_m = vec![RIM_M; (rows + 2) * (cols + 2)];
    rimmed_m.par_chunks_mut(cols + 2).skip(1).take(rows).enumerate().for_each(|(row, line)| {
        let cells = row * cols..(row + 1) * cols;
        let own = line[1..].iter_mut().zip(&z_m[cells.clone()]).zip(&crest.z_m[cells]);
        own.for_each(|((rimmed, z), crest)| *rimmed = if crest.is_nan() { -z } else { f32::NAN });
    });
    let upside_down = Relief::new(rows + 2, cols + 2, skeleton.cell_m, rimmed_m)?;
    let levels_m = fill(&upside_down);
    z_m.par_chunks_mut(cols).enumerate().for_each(|(row, line)| {
        for (col, z) in line.iter_mut().enumerate().filter(|(col, _)| !crest.is(row * cols + col)) {
            let level_m = -levels_m[(row + 1) * (cols + 2) + col + 1];
            // Where there is no ridge at all water could only leave over the rim.
            let hill_m = if level_m > -RIM_M { *z - level_m } else { 0.0 };
            *z += hill_m * HILL_M / (HILL_M + hill_m) - hill_m;
        }
    });
    Ok(z_m)
}
