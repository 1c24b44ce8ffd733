//! Ground stretched between what stands fast.

use super::form::Graded;
use rayon::prelude::*;

/// Sweeps over the cells of each level.
const SWEEPS: usize = 24;

/// Makes every cell that does not stand fast the mean of its four neighbours (those in the raster), the nearer ones
/// counting more, and a little higher: the discrete Poisson equation of ground that is lifted evenly and creeps downhill,
/// `curvature` being how much its slope changes per metre. It has no pit inside, and without curvature no peak.
///
/// From coarse to fine: cells of twice the size come first, and what they say is where the finer ones begin. Sweeps are
/// Jacobi's, so nothing depends on the order of cells or on threads.
///
/// # Complexity
/// O(n).
pub(super) fn stretch(
    z_m: &mut Vec<f32>,
    is_fast: &[bool],
    [rows, cols]: [usize; 2],
    cell_m: [f64; 2],
    curvature: &Graded,
) {
    if rows == 0 || cols == 0 || !is_fast.contains(&true) {
        return;
    }
    if rows.max(cols) > 2 && is_fast.contains(&false) {
        let (mut coarse, coarse_fast, size) = coarser(z_m, is_fast, [rows, cols]);
        stretch(&mut coarse, &coarse_fast, size, cell_m.map(|side| 2.0 * side), curvature);
        z_m.par_chunks_mut(cols).zip(is_fast.par_chunks(cols)).enumerate().for_each(|(row, (line, is_fast))| {
            let from = &coarse[row / 2 * size[1]..];
            for (col, z) in line.iter_mut().enumerate().filter(|(col, _)| !is_fast[*col]) {
                *z = from[col / 2];
            }
        });
    }
    let [across, down] = cell_m.map(|side| 1.0 / (side * side));
    let parts = [across, down].map(|part| (part / (2.0 * (across + down))) as f32);
    let lift = (1.0 / (2.0 * (across + down))) as f32;
    // One row for all where they are alike.
    let known = if curvature.is_even() { 1 } else { rows };
    let lifts_m: Vec<f32> = (0..known)
        .into_par_iter()
        .flat_map_iter(|row| curvature.row(row, [rows, cols]).into_iter().map(|value| value * lift))
        .collect();
    let mut next = z_m.clone();
    for _ in 0..SWEEPS {
        let now = &z_m[..];
        next.par_chunks_mut(cols).zip(is_fast.par_chunks(cols)).enumerate().for_each(|(row, (line, is_fast))| {
            let [above, own, below] =
                [row.saturating_sub(1), row, (row + 1).min(rows - 1)].map(|row| &now[row * cols..][..cols]);
            relax(line, own, [above, below], is_fast, parts, &lifts_m[row % known * cols..][..cols]);
        });
        std::mem::swap(z_m, &mut next);
    }
}

/// A sweep over a row. A neighbour that is not in the raster is as high as the cell itself, which draws nowhere.
fn relax(
    line: &mut [f32],
    own: &[f32],
    [above, below]: [&[f32]; 2],
    is_fast: &[bool],
    [across, down]: [f32; 2],
    lifts_m: &[f32],
) {
    let last = own.len() - 1;
    let mean = |left: f32, right: f32, above: f32, below: f32, lift_m: f32| {
        across * (left + right) + down * (above + below) + lift_m
    };
    for col in [0, last] {
        let z = mean(own[col.saturating_sub(1)], own[(col + 1).min(last)], above[col], below[col], lifts_m[col]);
        line[col] = if is_fast[col] { own[col] } else { z };
    }
    // Slices of one length, so that several cells are worked on at once.
    let inside = last.saturating_sub(1);
    let (left, right, middle) = (&own[..inside], &own[last.min(2)..][..inside], &own[last.min(1)..][..inside]);
    let [above, below] = [above, below].map(|row| &row[last.min(1)..][..inside]);
    let (line, is_fast) = (&mut line[last.min(1)..][..inside], &is_fast[last.min(1)..][..inside]);
    let lifts_m = &lifts_m[last.min(1)..][..inside];
    for i in 0..inside {
        let z = mean(left[i], right[i], above[i], below[i], lifts_m[i]);
        line[i] = if is_fast[i] { middle[i] } else { z };
    }
}

/// The same with cells of twice the size, which stand fast at the mean of what stands fast in them.
fn coarser(z_m: &[f32], is_fast: &[bool], [rows, cols]: [usize; 2]) -> (Vec<f32>, Vec<bool>, [usize; 2]) {
    let size = [rows.div_ceil(2), cols.div_ceil(2)];
    let cells: Vec<(f32, bool)> = (0..size[0] * size[1])
        .into_par_iter()
        .map(|cell| {
            let (row, col) = (cell / size[1] * 2, cell % size[1] * 2);
            let (mut sums, mut counts) = ([0.0_f32; 2], [0_u8; 2]);
            for row in row..(row + 2).min(rows) {
                for fine in row * cols + col..row * cols + (col + 2).min(cols) {
                    let kind = usize::from(is_fast[fine]);
                    sums[kind] += z_m[fine];
                    counts[kind] += 1;
                }
            }
            let kind = usize::from(counts[1] > 0);
            (sums[kind] / f32::from(counts[kind].max(1)), kind == 1)
        })
        .collect();
    let (coarse, fast) = cells.into_iter().unzip();
    (coarse, fast, size)
}
