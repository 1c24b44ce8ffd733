//! Valleys between the ridges, carved until they fall all the way out.

use super::crest::Crest;
use super::form::Graded;
use super::skeleton::Skeleton;
use crate::erosion::Drainage;

/// The least fall from cell to cell in metres.
const FALL_M: f32 = 0.01;
/// By how much a valley begins below its saddle, in metres.
const BELOW_SADDLE_M: f32 = 0.1;
/// Half of the width of a valley floor, as a share of the root of the area that drains there, ...
const WIDTH: f64 = 0.015;
/// ... and at most, in metres.
const WIDEST_M: f64 = 300.0;

/// What stands fast: crests and valley floors.
pub(super) struct Fast {
    /// Elevations in metres; of cells that do not stand fast, that of the surface.
    pub(super) z_m: Vec<f32>,
    /// Whether a cell stands fast.
    pub(super) is_fast: Vec<bool>,
}

/// How valleys are carved.
#[derive(Clone, Copy, Debug)]
pub(super) struct ValleyOptions<'a> {
    /// A valley begins where so many square metres drain.
    pub(super) least_m2: f64,
    /// Slope of the ground around.
    pub(super) slope: &'a Graded,
    /// How far a valley's floor may rise from a cell to the next beside it, in metres, where that slope is 1.
    pub(super) rise_m: f32,
}

/// Carves valleys along the drainage of a surface: where many cells drain, and from both sides of every saddle and of
/// every place where ridges touch. They cross a crest only where it closes off the ground behind. Their floors are as
/// wide as what drains there makes them.
pub(super) fn carve(
    skeleton: &Skeleton,
    crest: &Crest,
    surface_m: Vec<f32>,
    drainage: &Drainage,
    options: ValleyOptions<'_>,
) -> Fast {
    let cols = skeleton.size[1];
    let areas = drainage.areas_cells();
    let cell_m2 = skeleton.cell_m[0] * skeleton.cell_m[1];
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
    let least_cells = (options.least_m2 / cell_m2).clamp(1.0, 4e9) as u32;
    let mut floor = surface_m.clone();
    let mut is_valley: Vec<bool> = (0..floor.len()).map(|cell| !crest.is(cell) && areas[cell] >= least_cells).collect();
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
    let mut fast = Fast { z_m: surface_m, is_fast: (0..floor.len()).map(|cell| crest.is(cell)).collect() };
    fast.z_m.iter_mut().zip(&crest.z_m).filter(|(_, crest)| !crest.is_nan()).for_each(|(z, crest)| *z = *crest);
    for &cell in drainage.order() {
        let cell = cell as usize;
        if !is_valley[cell] || crest.is(cell) {
            continue;
        }
        let receiver = drainage.receiver(cell);
        let (mut least_m, mut most_m) = (f32::NEG_INFINITY, f32::INFINITY);
        if let Some(below) = receiver {
            let is_slant = below / cols != cell / cols && below % cols != cell % cols;
            let own_m = options.rise_m * options.slope.at([cell / cols, cell % cols], skeleton.size);
            let rise_m = own_m * if is_slant { std::f32::consts::SQRT_2 } else { 1.0 };
            (least_m, most_m) = (floor[below], floor[below] + rise_m);
        }
        floor[cell] = floor[cell].min(most_m).max(least_m).min(limit[cell]);
        fast.lay(cell, floor[cell], crest);
        // Nobody slips through between two corners of a valley.
        if let Some(below) = receiver {
            let corners = [cell / cols * cols + below % cols, below / cols * cols + cell % cols];
            let open = corners.into_iter().filter(|&corner| corner != cell && corner != below && !crest.is(corner));
            if let Some(corner) = open.min_by(|&a, &b| fast.z_m[a].total_cmp(&fast.z_m[b])) {
                fast.lay(corner, floor[cell], crest);
            }
        }
    }
    drop((limit, floor));
    let width = |cell: usize| (WIDTH * (f64::from(areas[cell]) * cell_m2).sqrt()).min(WIDEST_M) as f32;
    let valleys = drainage.order().iter().filter(|&&cell| is_valley[cell as usize] && !crest.is(cell as usize));
    fast.widen(skeleton, valleys.map(|&cell| (cell, width(cell as usize))).collect());
    fast
}

impl Fast {
    /// Widens valley floors to both sides, from cells with so many metres, as far as the next ridge or valley.
    fn widen(&mut self, skeleton: &Skeleton, mut front: Vec<(u32, f32)>) {
        let ([rows, cols], [width_m, height_m]) = (skeleton.size, skeleton.cell_m.map(|side| side as f32));
        while !front.is_empty() {
            let mut next = vec![];
            for (cell, left_m) in front {
                let cell = cell as usize;
                let (row, col) = (cell / cols, cell % cols);
                // Over sides alone: over corners one would come to the other side of a ridge.
                let sides = [
                    (row > 0, cell.wrapping_sub(cols), height_m),
                    (col > 0, cell.wrapping_sub(1), width_m),
                    (col + 1 < cols, cell + 1, width_m),
                    (row + 1 < rows, cell + cols, height_m),
                ];
                for (_, beside, step_m) in sides.into_iter().filter(|(is_inside, ..)| *is_inside) {
                    if step_m <= left_m && !self.is_fast[beside] {
                        (self.z_m[beside], self.is_fast[beside]) = (self.z_m[cell], true);
                        next.push((beside as u32, left_m - step_m));
                    }
                }
            }
            front = next;
        }
    }

    /// Lets a cell that is no crest stand fast, at this elevation or that which it has if it is lower.
    fn lay(&mut self, cell: usize, elevation_m: f32, crest: &Crest) {
        if !crest.is(cell) {
            let own_m = if self.is_fast[cell] { self.z_m[cell].min(elevation_m) } else { elevation_m };
            (self.z_m[cell], self.is_fast[cell]) = (own_m, true);
        }
    }
}
