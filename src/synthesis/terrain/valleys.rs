//! Valleys between the ridges, carved until they fall all the way out.

use super::crest::Crest;
use super::skeleton::Skeleton;
use crate::erosion::{Drainage, Relief};

/// The least fall from cell to cell in metres.
const FALL_M: f32 = 0.01;
/// By how much a valley begins below its saddle, in metres.
const BELOW_SADDLE_M: f32 = 0.1;

/// What stands fast: crests and valley floors.
pub(super) struct Fast {
    /// Elevations in metres; of cells that do not stand fast, that of the surface.
    pub(super) z_m: Vec<f32>,
    /// Whether a cell stands fast.
    pub(super) is_fast: Vec<bool>,
}

/// How valleys are carved.
#[derive(Clone, Copy, Debug)]
pub(super) struct ValleyOptions {
    /// A valley begins where so many cells drain.
    pub(super) least_cells: u32,
    /// How far a valley's floor may rise from a cell to the next beside it, in metres.
    pub(super) rise_m: f32,
}

/// Carves valleys along the drainage of a rough surface: where many cells drain, and from both sides of every saddle and
/// of every place where ridges touch. They cross a crest only where it closes off the ground behind.
pub(super) fn carve(
    skeleton: &Skeleton,
    crest: &Crest,
    surface: &Relief,
    drainage: &Drainage,
    options: ValleyOptions,
) -> Fast {
    let cols = skeleton.size[1];
    let areas = drainage.areas_cells();
    let mut floor: Vec<f32> = surface.z_m().to_vec();
    let mut is_valley: Vec<bool> =
        (0..floor.len()).map(|cell| !crest.is(cell) && areas[cell] >= options.least_cells).collect();
    drop(areas);
    // What a valley must not be above, since it comes from a saddle.
    let mut limit = vec![f32::INFINITY; floor.len()];
    let saddles = skeleton.saddles.iter().map(|saddle| (saddle.row * cols + saddle.col, saddle.elevation_m as f32));
    let touches = crest.lowered.iter().map(|&cell| (cell as usize, crest.z_m[cell as usize]));
    for (start, top_m) in saddles.chain(touches) {
        for cell in crest.around(start).filter(|&cell| !crest.is(cell)) {
            is_valley[cell] = true;
            limit[cell] = limit[cell].min(top_m - BELOW_SADDLE_M);
        }
    }
    // From the ridges down: a valley goes on, and falls.
    for &cell in drainage.order().iter().rev() {
        let cell = cell as usize;
        if crest.is(cell) {
            (floor[cell], limit[cell]) = (crest.z_m[cell], crest.z_m[cell]);
        }
        floor[cell] = floor[cell].min(limit[cell]);
        if let Some(receiver) = drainage.receiver(cell).filter(|_| is_valley[cell]) {
            floor[receiver] = floor[receiver].min(floor[cell] - FALL_M);
            limit[receiver] = limit[receiver].min(limit[cell] - FALL_M);
            is_valley[receiver] = true;
        }
    }
    // From the outlets up: nowhere steeper than it may be, nowhere lower than what comes after, and no higher than a
    // saddle allows.
    let mut fast = Fast {
        z_m: (0..floor.len()).map(|cell| if crest.is(cell) { crest.z_m[cell] } else { surface.z_m()[cell] }).collect(),
        is_fast: (0..floor.len()).map(|cell| crest.is(cell)).collect(),
    };
    for &cell in drainage.order() {
        let cell = cell as usize;
        if !is_valley[cell] || crest.is(cell) {
            continue;
        }
        let receiver = drainage.receiver(cell);
        let (mut least_m, mut most_m) = (f32::NEG_INFINITY, f32::INFINITY);
        if let Some(below) = receiver {
            let is_slant = below / cols != cell / cols && below % cols != cell % cols;
            let rise_m = options.rise_m * if is_slant { std::f32::consts::SQRT_2 } else { 1.0 };
            (least_m, most_m) = (floor[below], floor[below] + rise_m);
        }
        floor[cell] = floor[cell].min(most_m).max(least_m).min(limit[cell]);
        fast.lay(cell, floor[cell], crest);
        // Nobody slips through between two corners of a valley.
        if let Some(below) = receiver {
            let corners = [cell / cols * cols + below % cols, below / cols * cols + cell % cols];
            let open = corners.into_iter().filter(|&corner| corner != cell && corner != below && !crest.is(corner));
            if let Some(corner) = open.min_by(|&a, &b| surface.z_m()[a].total_cmp(&surface.z_m()[b])) {
                fast.lay(corner, floor[cell], crest);
            }
        }
    }
    fast
}

impl Fast {
    /// Lets a cell that is no crest stand fast, at this elevation or that which it has if it is lower.
    fn lay(&mut self, cell: usize, elevation_m: f32, crest: &Crest) {
        if !crest.is(cell) {
            let own_m = if self.is_fast[cell] { self.z_m[cell].min(elevation_m) } else { elevation_m };
            (self.z_m[cell], self.is_fast[cell]) = (own_m, true);
        }
    }
}
