//! Ways of water between the ridges.

use super::crest::Crest;
use super::skeleton::Skeleton;
use crate::erosion::{Drainage, Relief, breach};
use crate::error::Result;
use rayon::prelude::*;

/// Above the elevation of a crest: water does not pass there while it finds another way.
const WALL_M: f32 = 1e6;
/// Above the elevation of a crest where ridges touch: rather there than elsewhere.
const GATE_M: f32 = 5e5;
/// By how much ways at the foot of a ridge are harder to go than those ...
const FOOT_M: f32 = 200.0;
/// ... so many metres from it: gorges have walls on both sides.
const FOOT_WIDTH_M: f64 = 120.0;

/// The ways of water over a rough surface: around the ridges, at some distance from them, by their [`feet`].
pub(super) fn ways(rough_m: &[f32], foot_m: &[f32], crest: &Crest, skeleton: &Skeleton) -> Result<Drainage> {
    let [rows, cols] = skeleton.size;
    let mut z_m: Vec<f32> = rough_m.par_iter().zip(foot_m).map(|(z, foot)| z + foot).collect();
    wall_up(&mut z_m, crest);
    Ok(Drainage::of(&Relief::new(rows, cols, skeleton.cell_m, z_m)?))
}

/// By how much ways are harder at the feet of ridges, in metres: cones at every cell of a crest.
pub(super) fn feet(crest: &Crest, skeleton: &Skeleton) -> Vec<f32> {
    let [rows, cols] = skeleton.size;
    let cells = skeleton.cell_m.map(|side| (FOOT_WIDTH_M / side) as usize);
    let mut cone = vec![];
    for down in 0..=cells[1] {
        for right in 0..=cells[0] {
            let [x, y] = [right as f64 * skeleton.cell_m[0], down as f64 * skeleton.cell_m[1]];
            let near = 1.0 - (x * x + y * y).sqrt() / FOOT_WIDTH_M;
            if near > 0.0 {
                cone.push((down, right, FOOT_M * near as f32));
            }
        }
    }
    let mut foot_m = vec![0.0_f32; rows * cols];
    for cell in (0..rows * cols).filter(|&cell| crest.is(cell)) {
        let (row, col) = (cell / cols, cell % cols);
        for &(down, right, height_m) in &cone {
            let lines = [row.checked_sub(down), Some(row + down).filter(|&row| row < rows)];
            for line in lines.into_iter().flatten() {
                let places = [col.checked_sub(right), Some(col + right).filter(|&col| col < cols)];
                for place in places.into_iter().flatten() {
                    let own = &mut foot_m[line * cols + place];
                    *own = own.max(height_m);
                }
            }
        }
    }
    foot_m
}

/// Makes crests so high that water goes around them.
fn wall_up(z_m: &mut [f32], crest: &Crest) {
    z_m.par_iter_mut().zip(&crest.z_m).filter(|(_, crest)| !crest.is_nan()).for_each(|(z, crest)| *z = WALL_M + crest);
    crest.gates.iter().for_each(|&gate| z_m[gate as usize] += GATE_M - WALL_M);
}

/// Opens what would hold water, between the crests.
pub(super) fn drained(mut z_m: Vec<f32>, crest: &Crest, skeleton: &Skeleton) -> Result<Vec<f32>> {
    wall_up(&mut z_m, crest);
    let walled = Relief::new(skeleton.size[0], skeleton.size[1], skeleton.cell_m, z_m)?;
    Ok(breach(walled, &crest.z_m))
}
