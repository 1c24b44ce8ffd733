//! Heights for voids, so that the cells beside them can be worked on.

use super::plane::Plane;

/// How many cells into a void heights are made; what lies further in sways no cell with data.
pub const FILL_REACH: usize = 8;

/// Heights (NaN is a void) with each void cell as the mean of its neighbours, ring by ring from the data inwards; and
/// which cells had data. Deeper than [`FILL_REACH`] cells heights are 0.
pub fn filled(rows: usize, cols: usize, heights_m: Vec<f64>) -> (Plane, Vec<bool>) {
    filled_to(FILL_REACH, rows, cols, heights_m)
}

/// The same, so many cells deep.
pub fn filled_to(reach: usize, rows: usize, cols: usize, mut heights_m: Vec<f64>) -> (Plane, Vec<bool>) {
    let known: Vec<bool> = heights_m.iter().map(|height| !height.is_nan()).collect();
    let mut voids: Vec<usize> = (0..known.len()).filter(|&cell| !known[cell]).collect();
    for _ in 0..reach {
        if voids.is_empty() {
            break;
        }
        let found: Vec<f64> = voids.iter().map(|&cell| mean_around(&heights_m, rows, cols, cell)).collect();
        // All of a ring at once: the order of the cells does not matter.
        voids.iter().zip(&found).for_each(|(&cell, &mean)| heights_m[cell] = mean);
        voids.retain(|&cell| heights_m[cell].is_nan());
    }
    voids.iter().for_each(|&cell| heights_m[cell] = 0.0);
    (Plane::new(rows, cols, heights_m), known)
}

/// The mean of the heights around a cell; NaN where there is none.
fn mean_around(heights_m: &[f64], rows: usize, cols: usize, cell: usize) -> f64 {
    let (row, col) = (cell / cols, cell % cols);
    let (mut sum, mut count) = (0.0, 0.0);
    for r in row.saturating_sub(1)..rows.min(row + 2) {
        for height in &heights_m[r * cols + col.saturating_sub(1)..r * cols + cols.min(col + 2)] {
            if !height.is_nan() {
                sum += height;
                count += 1.0;
            }
        }
    }
    sum / count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voids_take_the_mean_of_what_is_around() {
        let n = f64::NAN;
        let (plane, known) = filled(2, 3, vec![1.0, n, n, 3.0, n, n]);
        assert_eq!(plane.heights_m(), [1.0, 2.0, 2.0, 3.0, 2.0, 2.0]);
        assert_eq!(known, [true, false, false, true, false, false]);
        let (plane, _) = filled(1, 12, [vec![5.0], vec![n; 11]].concat());
        assert_eq!(plane.heights_m()[..9], [5.0; 9]);
        assert_eq!(plane.heights_m()[9..], [0.0; 3], "too deep to matter");
        assert_eq!(filled(1, 1, vec![n]).0.heights_m(), [0.0]);
    }

    #[test]
    fn what_is_far_away_does_not_matter() {
        let mut heights: Vec<f64> = (0..40).map(f64::from).collect();
        heights[10..30].fill(f64::NAN);
        let (whole, _) = filled(1, 40, heights.clone());
        let (part, _) = filled(1, 14, heights[6..20].to_vec());
        // As far as the reach from what was cut off.
        assert_eq!(
            part.heights_m()[FILL_REACH..14 - FILL_REACH + 4],
            whole.heights_m()[6 + FILL_REACH..20 - FILL_REACH + 4]
        );
    }
}
