//! Depressions find their way out.

use super::drainage::{OUT, PIT, climb};
use super::relief::Relief;
use crate::components::root;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

/// The basin of all cells whose water leaves, and of voids.
const OUTSIDE: u32 = 0;
/// Rows that are looked through at once.
const BAND: usize = 64;
/// Pits whose basins are followed at once.
const PITS: usize = 256;

/// A way from one basin into another over two neighbouring cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Pass {
    /// Elevation of the higher cell, as a number that sorts as it does.
    top: u32,
    /// The cell with the lower index, and the direction of the other.
    cell: u32,
    direction: u8,
}

/// The way out of a basin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// The basin.
    pub(super) basin: u32,
    /// The basin beyond, or the outside.
    pub(super) beyond: u32,
    /// Elevation of the pass in metres: that of the higher of its two cells.
    pub(super) top_m: f32,
    /// The basin's own cell at the pass, and the direction of the other.
    pub(super) cell: u32,
    pub(super) direction: u8,
}

/// The depressions of a terrain, by the cells that drain to the same pit.
pub(super) struct Basins {
    /// The basin of each cell; 0 is the outside.
    pub(super) of: Vec<u32>,
    /// The pit of each basin; the outside has none.
    pub(super) pits: Vec<u32>,
    /// The way out of each basin over the pass that lies lowest on it, each after that of the basin beyond.
    ///
    /// A basin from which there is no way has none; on a raster there is always one.
    pub(super) ways: Vec<Way>,
}

impl Basins {
    /// The depressions of a terrain whose cells drain `towards` their steepest neighbours.
    ///
    /// Passes are taken from the lowest up, as Kruskal does, so the way of each pit is one whose highest point is the
    /// lowest.
    ///
    /// # Complexity
    /// O(n) for n cells, and O(b log b) for the b pairs of neighbours on the borders between depressions.
    pub(super) fn of(relief: &Relief, towards: &[u8]) -> Self {
        let mut pits = vec![u32::MAX];
        pits.extend((0..).zip(towards).filter(|(_, to)| **to == PIT).map(|(cell, _)| cell));
        if pits.len() == 1 {
            return Self { of: vec![OUTSIDE; towards.len()], pits, ways: vec![] };
        }
        let basin_of = labels(relief, towards, &pits[1..]);
        let steps = relief.steps();
        let other = |pass: &Pass| (pass.cell as usize).wrapping_add_signed(steps[pass.direction as usize]);
        let mut parents: Vec<u32> = (0..pits.len() as u32).collect();
        let mut joins: Vec<[(u32, Pass); 2]> = vec![];
        let mut starts = vec![0_u32; pits.len() + 1];
        for pass in passes(relief, &basin_of) {
            let [a, b] = [basin_of[pass.cell as usize], basin_of[other(&pass)]];
            let (root_a, root_b) = (root(&mut parents, a), root(&mut parents, b));
            if root_a != root_b {
                parents[root_a.max(root_b) as usize] = root_a.min(root_b);
                joins.push([(b, pass), (a, pass)]);
                [a, b].into_iter().for_each(|end| starts[end as usize + 1] += 1);
            }
            if joins.len() + 1 == pits.len() {
                break;
            }
        }
        // Neighbours of each basin in the tree, one list after the other.
        (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
        let mut next = starts.clone();
        let mut near = vec![None; 2 * joins.len()];
        for [(b, pass), (a, _)] in joins {
            for (from, to) in [(a, b), (b, a)] {
                near[next[from as usize] as usize] = Some((to, pass));
                next[from as usize] += 1;
            }
        }
        let mut ways = Vec::with_capacity(pits.len() - 1);
        let mut open = vec![(OUTSIDE, OUTSIDE)];
        while let Some((basin, before)) = open.pop() {
            let list = starts[basin as usize] as usize..starts[basin as usize + 1] as usize;
            for &(inner, pass) in near[list].iter().flatten().filter(|(inner, _)| *inner != before) {
                let is_first = basin_of[pass.cell as usize] == inner;
                let (cell, direction) =
                    if is_first { (pass.cell, pass.direction) } else { (other(&pass) as u32, 7 - pass.direction) };
                let top_m = relief.z_m()[pass.cell as usize].max(relief.z_m()[other(&pass)]);
                ways.push(Way { basin: inner, beyond: basin, top_m, cell, direction });
                open.push((inner, basin));
            }
        }
        Self { of: basin_of, pits, ways }
    }

    /// Lets the water of each pit go on over its way out.
    pub(super) fn join(&self, relief: &Relief, towards: &mut [u8]) {
        let steps = relief.steps();
        self.ways.iter().for_each(|way| turn(towards, steps, way.cell as usize, way.direction));
    }
}

/// The basin of each cell.
fn labels(relief: &Relief, towards: &[u8], pits: &[u32]) -> Vec<u32> {
    // Each cell belongs to one basin, so nothing depends on who comes first.
    let labels: Vec<AtomicU32> = (0..towards.len()).into_par_iter().map(|_| AtomicU32::new(OUTSIDE)).collect();
    pits.par_iter().zip(1_u32..pits.len() as u32 + 1).with_min_len(PITS).for_each_init(
        Vec::new,
        |open, (&pit, basin)| {
            climb(relief, towards, pit, open, |cell| labels[cell as usize].store(basin, Ordering::Relaxed));
        },
    );
    labels.into_par_iter().map(AtomicU32::into_inner).collect()
}

/// The passes between basins, lowest first.
fn passes(relief: &Relief, basin_of: &[u32]) -> Vec<Pass> {
    let (rows, cols, z, steps) = (relief.rows(), relief.cols(), relief.z_m(), relief.steps());
    let bands: Vec<usize> = (0..rows).step_by(BAND).collect();
    let mut passes: Vec<Pass> = bands
        .into_par_iter()
        .flat_map_iter(|first| {
            let mut found = vec![];
            for row in first..(first + BAND).min(rows) {
                for col in 0..cols {
                    let cell = row * cols + col;
                    // The directions to cells with a higher index.
                    for k in 4..8 {
                        let (right, down) = ([1, -1, 0, 1][k - 4], usize::from(k > 4));
                        if row + down >= rows || col.checked_add_signed(right).is_none_or(|col| col >= cols) {
                            continue;
                        }
                        let other = cell.wrapping_add_signed(steps[k]);
                        if basin_of[cell] != basin_of[other] && !z[cell].is_nan() && !z[other].is_nan() {
                            let top = sortable(z[cell].max(z[other]));
                            found.push(Pass { top, cell: cell as u32, direction: k as u8 });
                        }
                    }
                }
            }
            found
        })
        .collect();
    passes.par_sort_unstable();
    passes
}

/// A whole number that sorts as an elevation does.
fn sortable(z: f32) -> u32 {
    let bits = (z + 0.0).to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
}

/// Makes the cells from `cell` down to its pit drain to `cell`, and that in a direction.
fn turn(towards: &mut [u8], steps: [isize; 8], mut cell: usize, mut direction: u8) {
    loop {
        let old = std::mem::replace(&mut towards[cell], direction);
        if old >= OUT {
            return;
        }
        cell = cell.wrapping_add_signed(steps[old as usize]);
        direction = 7 - old;
    }
}
