//! Terrain over a divide tree.

use super::crest::Crest;
use super::detail::detail;
use super::envelope::distance;
use super::ground::Ground;
use super::membrane::stretch;
use super::skeleton::Skeleton;
use super::surface::surface;
use super::valleys::{ValleyOptions, carve};
use crate::erosion::{Drainage, Relief};
use crate::error::Result;
use crate::watch::Watch;
use rayon::prelude::*;

/// How terrain is raised.
#[derive(Clone, Debug, PartialEq)]
pub struct TerrainOptions {
    /// Slope of the ground that hangs from the crests, rise over run: valleys become so deep.
    pub slope: f64,
    /// Slope of the detail of each wavelength, rise over run, in the mean.
    pub roughness: f64,
    /// How high the land is in the mean, if that is known.
    pub ground: Option<Ground>,
    /// Share of the depth of the plains below the ground that is theirs alone: valleys take some part.
    pub depth: f64,
    /// Elevation of plains in metres where no ground is known.
    pub floor_m: f64,
    /// Equal seeds give equal detail.
    pub seed: u64,
}

impl Default for TerrainOptions {
    fn default() -> Self {
        Self { slope: 0.5, roughness: 0.2, ground: None, depth: 0.75, floor_m: 0.0, seed: 0 }
    }
}

/// Terrain that was raised.
#[derive(Clone, Debug)]
pub struct Raised {
    /// The terrain.
    pub relief: Relief,
    /// Positions of pairs of ridges that meet higher than the tree has it, since their lines cross.
    pub crossings: Vec<[u32; 2]>,
}

/// Above the elevation of a crest: water does not pass there while it finds another way.
const WALL_M: f32 = 1e6;
/// Above the elevation of a crest where ridges touch: rather there than elsewhere.
const GATE_M: f32 = 5e5;
/// Square metres that drain to where a valley begins.
const VALLEY_M2: f64 = 5e5;

/// Slope of a valley's beginning, as a share of that of the ground.
const HEAD: f64 = 0.6;

/// Detail is less than this part of what the ground falls from the nearest ridge, or rises from the nearest valley.
const RELIEF: f32 = 1.0;
/// Hills that stand by themselves are less than so many metres high.
const HILL_M: f32 = 15.0;
/// How many times what is lacking is given to the plains, which are a part of the ground only.
const CORRECTION: f32 = 1.5;
/// Steps that are reported.
const STEPS: u64 = 7;

/// Raises terrain that has the peaks and key saddles of a divide tree.
///
/// Where the ground is known, terrain is raised twice: what came out too low or too high in the mean of some blocks the
/// first time has higher or lower plains the second time.
///
/// # Errors
/// A skeleton with a fault, a raster of more than 2^32 cells, or a cancelled job.
///
/// # Complexity
/// O(n) for n cells, and O(b log b) for the b pairs of neighbours on the borders between depressions.
pub fn raise(skeleton: &Skeleton, options: &TerrainOptions, watch: &Watch) -> Result<Raised> {
    let Some(ground) = &options.ground else { return raise_once(skeleton, options, watch) };
    let first = raise_once(skeleton, options, watch)?.relief;
    let own = Ground::of(first.z_m(), skeleton.size, ground.size);
    drop(first);
    let ground = Some(ground.corrected(&own, CORRECTION));
    raise_once(skeleton, &TerrainOptions { ground, ..options.clone() }, watch)
}

/// Raises terrain on the ground as it is given; see [`raise`].
pub(super) fn raise_once(skeleton: &Skeleton, options: &TerrainOptions, watch: &Watch) -> Result<Raised> {
    let [rows, cols] = skeleton.size;
    let [width_m, height_m] = skeleton.cell_m;
    skeleton.check()?;
    watch.begin("raising terrain", STEPS);
    let crest = Crest::of(skeleton);
    watch.advance(1)?;
    let mut rough_m = surface(skeleton, &crest, options);
    let detail_m = detail(skeleton.size, skeleton.cell_m, options.roughness, options.seed);
    watch.advance(1)?;
    rough_m.par_iter_mut().zip(&detail_m).for_each(|(z, detail)| *z += detail);
    wall_up(&mut rough_m, &crest);
    let rough = Relief::new(rows, cols, skeleton.cell_m, rough_m)?;
    let drainage = Drainage::of(&rough);
    watch.advance(1)?;
    let valleys = ValleyOptions {
        least_cells: (VALLEY_M2 / (width_m * height_m)).clamp(1.0, 4e9) as u32,
        rise_m: (HEAD * options.slope * width_m.max(height_m)) as f32,
    };
    let mut fast = carve(skeleton, &crest, &rough, &drainage, valleys);
    drop((drainage, rough));
    watch.advance(1)?;
    stretch(&mut fast.z_m, &fast.is_fast, skeleton.size, skeleton.cell_m);
    let clear_m = distance(&fast.is_fast, skeleton.size, skeleton.cell_m);
    let steep = steepness(&fast.z_m, skeleton.size, skeleton.cell_m);
    fast.z_m.par_iter_mut().enumerate().for_each(|(cell, z)| {
        // No bump rises above the ridge beside it, and none where the ground is flat.
        let (most_m, own_m) = (RELIEF * steep[cell] * clear_m[cell], detail_m[cell]);
        if most_m > 0.0 {
            *z += own_m * most_m / (most_m + own_m.abs());
        }
    });
    drop((clear_m, detail_m, steep));
    watch.advance(1)?;
    let z_m = shaved(fast.z_m, &crest, skeleton)?;
    watch.advance(1)?;
    let z_m = drained(z_m, &crest, skeleton)?;
    watch.advance(1)?;
    let relief = Relief::new(rows, cols, skeleton.cell_m, z_m)?;
    Ok(Raised { relief, crossings: crest.crossings })
}

/// Makes crests so high that water goes around them.
fn wall_up(z_m: &mut [f32], crest: &Crest) {
    z_m.par_iter_mut().zip(&crest.z_m).filter(|(_, crest)| !crest.is_nan()).for_each(|(z, crest)| *z = WALL_M + crest);
    crest.gates.iter().for_each(|&gate| z_m[gate as usize] += GATE_M - WALL_M);
}

/// Takes hills away that stand by themselves: from each cell between the ridges a way leads up to one, and hardly down.
///
/// Upside down these hills are depressions, and ridges where water leaves: so they are filled. A rim keeps it from leaving
/// at the raster's edge.
fn shaved(mut z_m: Vec<f32>, crest: &Crest, skeleton: &Skeleton) -> Result<Vec<f32>> {
    let [rows, cols] = skeleton.size;
    let mut rimmed_m = vec![WALL_M; (rows + 2) * (cols + 2)];
    rimmed_m.par_chunks_mut(cols + 2).skip(1).take(rows).enumerate().for_each(|(row, line)| {
        let cells = row * cols..(row + 1) * cols;
        let own = line[1..].iter_mut().zip(&z_m[cells.clone()]).zip(&crest.z_m[cells]);
        own.for_each(|((rimmed, z), crest)| *rimmed = if crest.is_nan() { -z } else { f32::NAN });
    });
    let upside_down = Relief::new(rows + 2, cols + 2, skeleton.cell_m, rimmed_m)?;
    let levels_m = Drainage::of(&upside_down).levels_m(&upside_down);
    z_m.par_chunks_mut(cols).enumerate().for_each(|(row, line)| {
        for (col, z) in line.iter_mut().enumerate().filter(|(col, _)| !crest.is(row * cols + col)) {
            let level_m = -levels_m[(row + 1) * (cols + 2) + col + 1];
            // Where there is no ridge at all water could only leave over the rim.
            let hill_m = if level_m > -WALL_M { *z - level_m } else { 0.0 };
            *z += hill_m * HILL_M / (HILL_M + hill_m) - hill_m;
        }
    });
    Ok(z_m)
}

/// Opens what would hold water, between the crests.
fn drained(mut z_m: Vec<f32>, crest: &Crest, skeleton: &Skeleton) -> Result<Vec<f32>> {
    let [rows, cols] = skeleton.size;
    wall_up(&mut z_m, crest);
    let walled = Relief::new(rows, cols, skeleton.cell_m, z_m)?;
    let drainage = Drainage::of(&walled);
    let mut z_m = walled.into_z_m();
    z_m.par_iter_mut().zip(&crest.z_m).filter(|(_, crest)| !crest.is_nan()).for_each(|(z, crest)| *z = *crest);
    for &cell in drainage.order().iter().rev() {
        let cell = cell as usize;
        if let Some(receiver) = drainage.receiver(cell).filter(|&receiver| !crest.is(receiver)) {
            z_m[receiver] = z_m[receiver].min(z_m[cell]);
        }
    }
    Ok(z_m)
}

/// Slope of each cell, rise over run.
fn steepness(z_m: &[f32], [rows, cols]: [usize; 2], [width_m, height_m]: [f64; 2]) -> Vec<f32> {
    let per = [1.0 / width_m as f32, 1.0 / height_m as f32];
    let mut steep = vec![0.0_f32; z_m.len()];
    steep.par_chunks_mut(cols).enumerate().for_each(|(row, line)| {
        let own = &z_m[row * cols..][..cols];
        let (above, below) = (&z_m[row.saturating_sub(1) * cols..], &z_m[(row + 1).min(rows - 1) * cols..]);
        for (col, steep) in line.iter_mut().enumerate() {
            let x = (own[(col + 1).min(cols - 1)] - own[col.saturating_sub(1)]) * (0.5 * per[0]);
            let y = (below[col] - above[col]) * (0.5 * per[1]);
            *steep = (x * x + y * y).sqrt();
        }
    });
    steep
}
