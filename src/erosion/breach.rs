//! Depressions opened.

use super::basins::Basins;
use super::drainage::{OUT, downhill};
use super::relief::Relief;

/// Elevations in metres of a terrain that is lowered where it holds water back: no cell is higher than one whose water
/// passes through it.
///
/// `fast_m` has the elevations of cells that stand fast, and NaN elsewhere. These are never lowered: water passes over
/// them, if it must, as if it came from their height. The relief may have them at any other height, which then says where
/// water goes; all else has its own height there.
///
/// # Complexity
/// As [`fill`](super::fill()).
///
/// # Panics
/// When `fast_m` has another number of cells.
pub fn breach(relief: Relief, fast_m: &[f32]) -> Vec<f32> {
    assert_eq!(fast_m.len(), relief.z_m().len(), "an elevation for each cell");
    let (mut towards, steps) = (downhill(&relief), relief.steps());
    let basins = Basins::of(&relief, &towards);
    basins.join(&relief, &mut towards);
    let mut z_m = relief.into_z_m();
    let stands = |cell: usize| !fast_m[cell].is_nan();
    (0..z_m.len()).filter(|&cell| stands(cell)).for_each(|cell| z_m[cell] = fast_m[cell]);
    // Water falls all the way but where it was led out of a depression, and behind what stands fast: so ways are
    // followed from there, to where they are low enough. A basin's way begins when those that lead into it are done, and
    // is followed over its pass in any case.
    let fast = (0..z_m.len()).filter(|&cell| stands(cell)).map(|cell| (cell, cell));
    let ways = basins.ways.iter().rev().map(|way| (basins.pits[way.basin as usize] as usize, way.cell as usize));
    let starts: Vec<(usize, usize)> = fast.chain(ways).collect();
    for (mut cell, pass) in starts {
        let mut is_over = false;
        while towards[cell] < OUT {
            is_over |= cell == pass;
            let receiver = cell.wrapping_add_signed(steps[towards[cell] as usize]);
            // Not at one as high: the way out of a flat pit may begin level.
            if is_over && (stands(receiver) || z_m[receiver] < z_m[cell]) {
                break;
            }
            if !stands(receiver) {
                z_m[receiver] = z_m[receiver].min(z_m[cell]);
            }
            cell = receiver;
        }
    }
    z_m
}
