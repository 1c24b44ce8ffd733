//! Slopes that hang from the crests.

/// Elevations in metres of the lowest ground under which no crest stands out and that is nowhere steeper than
/// `slope`, from cell to cell: the highest of what hangs from all crests. Crests are NaN where there is none; without
/// any all is minus infinity.
///
/// # Complexity
/// O(n): two passes over the cells are enough for distances from cell to cell.
pub(super) fn envelope(
    crest_m: &[f32],
    [rows, cols]: [usize; 2],
    [width_m, height_m]: [f64; 2],
    slope: f64,
) -> Vec<f32> {
    let mut z: Vec<f32> = crest_m.iter().map(|&m| if m.is_nan() { f32::NEG_INFINITY } else { m }).collect();
    let drop = |distance_m: f64| (slope * distance_m) as f32;
    let drops = [drop(width_m), drop(height_m), drop((width_m * width_m + height_m * height_m).sqrt())];
    let mut above = vec![f32::NEG_INFINITY; cols];
    for row in 0..rows {
        hang(&mut z[row * cols..][..cols], &above, drops);
        above.copy_from_slice(&z[row * cols..][..cols]);
    }
    above.fill(f32::NEG_INFINITY);
    for row in (0..rows).rev() {
        hang(&mut z[row * cols..][..cols], &above, drops);
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
    let mut z = envelope(&marks, size, cell_m, 1.0);
    z.iter_mut().for_each(|z| *z = -*z);
    z
}

/// Hangs a row from the one before it and from its own cells.
fn hang(row: &mut [f32], before: &[f32], [across, down, slant]: [f32; 3]) {
    let last = row.len() - 1;
    for col in 0..=last {
        let corners = before[col.saturating_sub(1)].max(before[(col + 1).min(last)]);
        row[col] = row[col].max(before[col] - down).max(corners - slant);
    }
    for col in 1..=last {
        row[col] = row[col].max(row[col - 1] - across);
    }
    for col in (0..last).rev() {
        row[col] = row[col].max(row[col + 1] - across);
    }
}
