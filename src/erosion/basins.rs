//! Depressions find their way out.

use super::drainage::{OUT, PIT};
use super::relief::Relief;
use crate::components::root;
use rayon::prelude::*;

/// The basin of all cells whose water leaves, and of voids.
const OUTSIDE: u32 = 0;
/// Rows that are looked through at once.
const BAND: usize = 64;

/// A way from one basin into another over two neighbouring cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Pass {
    /// Elevation of the higher cell, as a number that sorts as it does.
    top: u32,
    /// The cell with the lower index, and the direction of the other.
    cell: u32,
    direction: u8,
}

/// Lets the water of each pit go on over the pass that lies lowest on its way out.
///
/// `order` holds the cells of each basin one after the other, a pit or outlet first. Passes are taken from the lowest
/// up, as Kruskal does, so the way of each pit is one whose highest point is the lowest.
pub(super) fn join(relief: &Relief, towards: &mut [u8], order: &[u32]) {
    let (steps, mut basin_of) = (relief.steps(), vec![OUTSIDE; towards.len()]);
    let (mut basin, mut pits) = (OUTSIDE, vec![u32::MAX]);
    for &cell in order {
        match towards[cell as usize] {
            OUT => basin = OUTSIDE,
            PIT => {
                basin = pits.len() as u32;
                pits.push(cell);
            }
            _ => {}
        }
        basin_of[cell as usize] = basin;
    }
    let mut parents: Vec<u32> = (0..pits.len() as u32).collect();
    let mut ways: Vec<[(u32, Pass); 2]> = vec![];
    let mut starts = vec![0_u32; pits.len() + 1];
    let other = |pass: &Pass| (pass.cell as usize).wrapping_add_signed(steps[pass.direction as usize]);
    for pass in passes(relief, &basin_of) {
        let [a, b] = [basin_of[pass.cell as usize], basin_of[other(&pass)]];
        let (root_a, root_b) = (root(&mut parents, a), root(&mut parents, b));
        if root_a != root_b {
            parents[root_a.max(root_b) as usize] = root_a.min(root_b);
            ways.push([(b, pass), (a, pass)]);
            [a, b].into_iter().for_each(|end| starts[end as usize + 1] += 1);
        }
        if ways.len() + 1 == pits.len() {
            break;
        }
    }
    // Neighbours of each basin in the tree, one list after the other.
    (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
    let mut next = starts.clone();
    let mut near = vec![None; 2 * ways.len()];
    for [(b, pass), (a, _)] in ways {
        for (from, to) in [(a, b), (b, a)] {
            near[next[from as usize] as usize] = Some((to, pass));
            next[from as usize] += 1;
        }
    }
    let mut open = vec![(OUTSIDE, OUTSIDE)];
    while let Some((basin, before)) = open.pop() {
        let list = starts[basin as usize] as usize..starts[basin as usize + 1] as usize;
        for &(inner, pass) in near[list].iter().flatten().filter(|(inner, _)| *inner != before) {
            let is_first = basin_of[pass.cell as usize] == inner;
            let (cell, direction) =
                if is_first { (pass.cell as usize, pass.direction) } else { (other(&pass), 7 - pass.direction) };
            turn(towards, steps, cell, direction);
            open.push((inner, basin));
        }
    }
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
