//! To which neighbour the water of each cell goes.

use super::basins::Basins;
use super::relief::Relief;
use rayon::prelude::*;

/// In place of a direction: water leaves the raster here.
pub(super) const OUT: u8 = 8;
/// In place of a direction: there is no ground here.
pub(super) const VOID: u8 = 9;
/// In place of a direction, while basins are not joined yet: every neighbour is higher.
pub(super) const PIT: u8 = 10;

/// To which neighbour the water of each cell goes, and an order in which to follow it.
///
/// Water goes the steepest way down, and of equally steep ones the first of
/// [`OFFSETS`](crate::grid::neighbours::OFFSETS). Of two cells as high the one with the lower index is the lower one. It leaves at the raster's edge and next to voids. From the
/// lowest cell of a depression it goes on over its lowest pass, up the way that leads there and down the other side, as
/// Cordonnier, Bovy and Braun carve it ("A versatile, linear complexity algorithm for flow routing in topographies with
/// depressions", Earth Surface Dynamics 7, 2019, section 3): so every cell drains to one of its neighbours, and the
/// highest point on its water's way is as low as can be.
#[derive(Clone, Debug, PartialEq)]
pub struct Drainage {
    towards: Vec<u8>,
    order: Vec<u32>,
    steps: [isize; 8],
}

impl Drainage {
    /// The ways of water over a terrain.
    ///
    /// # Complexity
    /// O(n) for n cells, and O(b log b) for the b pairs of neighbours on the borders between depressions.
    pub fn of(relief: &Relief) -> Self {
        let mut towards = downhill(relief);
        Basins::of(relief, &towards).join(relief, &mut towards);
        let outlets: Vec<u32> = (0..).zip(&towards).filter(|(_, to)| **to == OUT).map(|(cell, _)| cell).collect();
        let order = upstream(relief, &towards, &outlets);
        let steps = relief.steps();
        Self { towards, order, steps }
    }

    /// The cell that a cell drains to; `None` where water leaves, and for voids.
    #[inline]
    pub fn receiver(&self, cell: usize) -> Option<usize> {
        let to = self.towards[cell];
        (to < OUT).then(|| cell.wrapping_add_signed(self.steps[to as usize]))
    }

    /// The direction in which a cell drains, as a position in [`OFFSETS`](crate::grid::neighbours::OFFSETS).
    #[inline]
    pub fn direction(&self, cell: usize) -> Option<usize> {
        let to = self.towards[cell];
        (to < OUT).then_some(to as usize)
    }

    /// All cells but voids, each after the one that it drains to.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Number of cells whose water passes through each cell, itself included; 0 for voids.
    pub fn areas_cells(&self) -> Vec<u32> {
        let mut areas = vec![0; self.towards.len()];
        for &cell in self.order.iter().rev() {
            let cell = cell as usize;
            areas[cell] += 1;
            if let Some(receiver) = self.receiver(cell) {
                areas[receiver] += areas[cell];
            }
        }
        areas
    }

    /// The elevations to which depressions fill until they overflow, in metres; elsewhere the elevation itself.
    ///
    /// # Panics
    /// When the relief has another number of cells than that of the drainage.
    pub fn levels_m(&self, relief: &Relief) -> Vec<f32> {
        let mut levels = relief.z_m().to_vec();
        for &cell in &self.order {
            let cell = cell as usize;
            if let Some(receiver) = self.receiver(cell) {
                levels[cell] = levels[cell].max(levels[receiver]);
            }
        }
        levels
    }
}

/// The direction of the steepest way down of each cell.
pub(super) fn downhill(relief: &Relief) -> Vec<u8> {
    let (cols, z) = (relief.cols(), relief.z_m());
    let mut towards = vec![VOID; z.len()];
    if z.is_empty() {
        return towards;
    }
    let (steps, nearness) = (relief.steps(), relief.distances_m().map(|distance| 1.0 / distance));
    let direction = |cell: usize| {
        let here = z[cell];
        if here.is_nan() {
            return VOID;
        }
        if relief.is_at_edge(cell) {
            return OUT;
        }
        let (mut best, mut to) = (-1.0_f32, PIT);
        for k in 0..8 {
            let there = z[cell.wrapping_add_signed(steps[k])];
            if there.is_nan() {
                return OUT;
            }
            // Of cells as high the one before is the lower one; the first four directions lead there.
            let slope = (here - there) * nearness[k];
            if slope > best && (there < here || (there == here && k < 4)) {
                (best, to) = (slope, k as u8);
            }
        }
        to
    };
    towards.par_chunks_mut(cols).enumerate().for_each(|(row, towards)| {
        for (col, to) in towards.iter_mut().enumerate() {
            *to = direction(row * cols + col);
        }
    });
    towards
}

/// Parts in which ways are followed, as many for any number of threads.
const PARTS: usize = 256;

/// The cells that drain to some roots, each after the one that it drains to.
fn upstream(relief: &Relief, towards: &[u8], roots: &[u32]) -> Vec<u32> {
    let part = |roots: &[u32]| {
        let (mut order, mut open) = (vec![], vec![]);
        roots.iter().for_each(|&root| climb(relief, towards, root, &mut open, |cell| order.push(cell)));
        order
    };
    let parts: Vec<Vec<u32>> = roots.par_chunks(roots.len().div_ceil(PARTS).max(1)).map(part).collect();
    let mut order = Vec::with_capacity(parts.iter().map(Vec::len).sum());
    parts.into_iter().for_each(|part| order.extend_from_slice(&part));
    order
}

/// Visits the cells that drain to a root, each after the one that it drains to; `open` is room to work in.
pub(super) fn climb(relief: &Relief, towards: &[u8], root: u32, open: &mut Vec<u32>, mut visit: impl FnMut(u32)) {
    let steps = relief.steps();
    open.push(root);
    while let Some(cell) = open.pop() {
        visit(cell);
        let here = cell as usize;
        let mut give = |k: usize| {
            let giver = here.wrapping_add_signed(steps[k]);
            if towards[giver] == 7 - k as u8 {
                open.push(giver as u32);
            }
        };
        if !relief.is_at_edge(here) {
            (0..8).for_each(give);
            continue;
        }
        let (row, col) = (here / relief.cols(), here % relief.cols());
        for (k, (down, right)) in crate::grid::neighbours::OFFSETS.into_iter().enumerate() {
            let row = row.checked_add_signed(down).filter(|&row| row < relief.rows());
            let col = col.checked_add_signed(right).filter(|&col| col < relief.cols());
            if row.is_some() && col.is_some() {
                give(k);
            }
        }
    }
}
