//! The ground as it would be without valleys.

use super::ceiling::Ceiling;
use super::crest::Crest;
use super::envelope::envelope;
use super::form::Graded;
use super::raise::TerrainOptions;
use super::skeleton::Skeleton;
use rayon::prelude::*;

/// How much of the slope is left on plains.
const PLAIN: f32 = 0.02;
/// How far below the peaks beside them plains are at least, in metres.
const BELOW_M: f32 = 15.0;

/// Elevations in metres of slopes that hang from crests, down to plains.
///
/// With a [`Ground`](super::Ground) plains lie so far below it, everywhere as far, that slopes and plains together are
/// as high in the mean as the ground; options take a share of that depth, since valleys take their part, too. Else they
/// are level.
pub(super) fn surface(skeleton: &Skeleton, crest: &Crest, ceiling: &Ceiling, options: &TerrainOptions) -> Vec<f32> {
    let [rows, cols] = skeleton.size;
    let slope = options.graded(|form| form.slope);
    let mut z_m = envelope(&crest.z_m, skeleton.size, skeleton.cell_m, &slope);
    let Some(ground) = &options.ground else {
        let floor_m = options.floor_m as f32;
        z_m.par_chunks_mut(cols).enumerate().for_each(|(row, line)| {
            for (col, z) in line.iter_mut().enumerate() {
                *z = lifted(*z, floor_m.min(ceiling.at(row, col) - BELOW_M));
            }
        });
        return z_m;
    };
    let mut plain_m = vec![0.0_f32; z_m.len()];
    plain_m.par_chunks_mut(cols).enumerate().for_each(|(row, line)| {
        for (col, plain) in line.iter_mut().enumerate() {
            *plain = ground.at([(row as f64 + 0.5) / rows as f64, (col as f64 + 0.5) / cols as f64]);
        }
    });
    let depth_m = depth_m(&z_m, &plain_m, cols);
    let shares: Graded = options.graded(|form| form.depth);
    z_m.par_chunks_mut(cols).zip(plain_m.par_chunks(cols)).enumerate().for_each(|(row, (line, plain_m))| {
        let shares = shares.row(row, [rows, cols]);
        for (col, (z, plain)) in line.iter_mut().zip(plain_m).enumerate() {
            *z = lifted(*z, (plain - depth_m * shares[col]).min(ceiling.at(row, col) - BELOW_M));
        }
    });
    z_m
}

/// A surface on plains: hardly lower than they are.
fn lifted(z_m: f32, plain_m: f32) -> f32 {
    if z_m.is_finite() { z_m.max(plain_m + PLAIN * (z_m - plain_m)) } else { plain_m }
}

/// How far below the ground plains must lie so that slopes and plains are as high as the ground in the mean; as far as
/// the slopes go where they are too gentle for that.
fn depth_m(slopes_m: &[f32], ground_m: &[f32], cols: usize) -> f32 {
    let mut below: Vec<f32> = vec![];
    // A sample of the cells: every seventh of every seventh row.
    for (slopes, ground) in slopes_m.chunks_exact(cols).zip(ground_m.chunks_exact(cols)).step_by(7) {
        let depths = slopes.iter().zip(ground).map(|(slope, ground)| ground - slope);
        below.extend(depths.step_by(7).filter(|depth| depth.is_finite()));
    }
    below.sort_unstable_by(f32::total_cmp);
    // From the deepest up: how much is gained by plains at this depth, until it is what is lacking.
    let lacking: f64 = below.iter().map(|&depth| f64::from(depth)).sum();
    let mut gained = 0.0;
    for (count, pair) in below.windows(2).rev().enumerate() {
        let step = f64::from(pair[1] - pair[0]) * (count + 1) as f64;
        if gained + step >= lacking {
            return pair[1] - ((lacking - gained).max(0.0) / (count + 1) as f64) as f32;
        }
        gained += step;
    }
    below.last().copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plains_make_the_mean() {
        let slopes: Vec<f32> = (0..4900).map(|i| (i * 7919 % 1009) as f32).collect();
        let ground = vec![600.0_f32; slopes.len()];
        let depth = depth_m(&slopes, &ground, 70);
        let sampled = |f: &dyn Fn(f32) -> f32| {
            let rows = slopes.chunks_exact(70).step_by(7);
            let cells: Vec<f32> = rows.flat_map(|row| row.iter().step_by(7).map(|&z| f(z))).collect();
            cells.iter().sum::<f32>() / cells.len() as f32
        };
        let mean = sampled(&|z| z.max(600.0 - depth));
        assert!((mean - 600.0).abs() < 0.5, "{mean} at {depth}");
        // Slopes that are higher than the ground leave plains out of sight.
        let depth = depth_m(&slopes, &vec![100.0; slopes.len()], 70);
        assert!(sampled(&|z| z.max(100.0 - depth)) >= 100.0);
    }
}
