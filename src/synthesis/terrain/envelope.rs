//! Slopes that hang from the crests.

use super::form::Graded;

/// Elevations in metres of the lowest ground under which no crest stands out and that is nowhere steeper than
/// `slope`, from cell to cell: the highest of what hangs from all crests. Crests are NaN where there is none; without
/// any all is minus infinity. Where the slope goes over from one to another it is nearly that.
///
/// # Complexity
/// O(n): two passes over the cells are enough for distances from cell to cell.
pub(super) fn envelope(
    crest_m: &[f32],
    [rows, cols]: [usize; 2],
    [width_m, height_m]: [f64; 2],
    slope: &Graded,
) -> Vec<f32> {
    let mut z: Vec<f32> = crest_m.iter().map(|&m| if m.is_nan() { f32::NEG_INFINITY } else { m }).collect();
    let steps_m = [width_m, height_m, (width_m * width_m + height_m * height_m).sqrt()].map(|step_m| step_m as f32);
    let mut slopes = slope.row(0, [rows, cols]);
    let mut above = vec![f32::NEG_INFINITY; cols];
    for row in 0..rows {
        if !slope.is_even() {
            slopes = slope.row(row, [rows, cols]);
        }
        hang(&mut z[row * cols..][..cols], &above, &slopes, steps_m);
        above.copy_from_slice(&z[row * cols..][..cols]);
    }
    above.fill(f32::NEG_INFINITY);
    for row in (0..rows).rev() {
        if !slope.is_even() {
            slopes = slope.row(row, [rows, cols]);
        }
        hang(&mut z[row * cols..][..cols], &above, &slopes, steps_m);
        above.copy_from_slice(&z[row * cols..][..cols]);
    }
    z
}

/// Distance in metres from each cell to the nearest that is marked, from cell to cell; infinite without any.
///
/// # Complexity
/// O(n).
pub(super) fn distance(is_marked: &[bool], size: [usize; 2], cell_m: [f64; 2]) -> Vec<f32> {
    let marks: Vec<f32> = is_marked.iter().map(|&is_marked| if is_marked { 0.0 } else { f32::NAN }).collect();
    let mut z = envelope(&marks, size, cell_m, &Graded::even(1.0));
    z.iter_mut().for_each(|z| *z = -*z);
    z
}

/// Hangs a row from the one before it and from its own cells.
fn hang(row: &mut [f32], before: &[f32], slopes: &[f32], [across, down, slant]: [f32; 3]) {
    let last = row.len() - 1;
    for col in 0..=last {
        let corners = before[col.saturating_sub(1)].max(before[(col + 1).min(last)]);
        row[col] = row[col].max(before[col] - slopes[col] * down).max(corners - slopes[col] * slant);
    }
    for col in 1..=last {
        row[col] = row[col].max(row[col - 1] - slopes[col] * across);
    }
    for col in (0..last).rev() {
        row[col] = row[col].max(row[col + 1] - slopes[col] * across);
    }
}
