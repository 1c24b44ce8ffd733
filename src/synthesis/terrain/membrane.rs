//! Ground stretched between what stands fast.

use rayon::prelude::*;

/// Sweeps over the cells of each level.
const SWEEPS: usize = 24;

/// Makes every cell that does not stand fast the mean of its four neighbours (those in the raster), the nearer ones
/// counting more: the discrete Laplace equation, which has neither peak nor pit inside.
///
/// From coarse to fine: cells of twice the size come first, and what they say is where the finer ones begin. Sweeps are
/// Jacobi's, so nothing depends on the order of cells or on threads.
///
/// # Complexity
/// O(n).
pub(super) fn stretch(z_m: &mut Vec<f32>, is_fast: &[bool], [rows, cols]: [usize; 2], cell_m: [f64; 2]) {
    if rows == 0 || cols == 0 || !is_fast.contains(&true) {
        return;
    }
    if rows.max(cols) > 2 && is_fast.contains(&false) {
        let (mut coarse, coarse_fast, size) = coarser(z_m, is_fast, [rows, cols]);
        stretch(&mut coarse, &coarse_fast, size, cell_m);
        for (cell, z) in z_m.iter_mut().enumerate().filter(|(cell, _)| !is_fast[*cell]) {
            *z = coarse[cell / cols / 2 * size[1] + cell % cols / 2];
        }
    }
    let [across, down] = cell_m.map(|side| (1.0 / (side * side)) as f32);
    let mut next = z_m.clone();
    for _ in 0..SWEEPS {
        let now = &z_m[..];
        next.par_chunks_mut(cols).enumerate().for_each(|(row, line)| {
            let own = &now[row * cols..][..cols];
            let above = row.checked_sub(1).map(|row| &now[row * cols..][..cols]);
            let below = (row + 1 < rows).then(|| &now[(row + 1) * cols..][..cols]);
            for (col, z) in line.iter_mut().enumerate().filter(|(col, _)| !is_fast[row * cols + col]) {
                let (mut sum, mut weight) = (0.0, 0.0);
                let mut add = |z: Option<f32>, part: f32| {
                    if let Some(z) = z {
                        sum += part * z;
                        weight += part;
                    }
                };
                add(above.map(|line| line[col]), down);
                add(below.map(|line| line[col]), down);
                add(col.checked_sub(1).map(|col| own[col]), across);
                add(own.get(col + 1).copied(), across);
                *z = if weight > 0.0 { sum / weight } else { *z };
            }
        });
        std::mem::swap(z_m, &mut next);
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
