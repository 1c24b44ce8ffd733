//! Whether an exemplar's terrain resembles the input's.

use super::cell_size::CellSize;
use crate::amplify::Plane;

/// Slopes that differ by more than this factor are those of another kind of terrain.
const UNLIKE: f64 = 2.0;

/// The slopes of heights in metres (NaN for voids), as rise over run: central differences in the cells that have data at
/// all four sides.
pub(super) fn slopes(plane: &Plane, cell: CellSize) -> Vec<f64> {
    let mut slopes = vec![];
    for row in 1..plane.rows().saturating_sub(1) {
        let [above, own, below] = [row - 1, row, row + 1].map(|row| plane.row(row));
        for col in 1..plane.cols().saturating_sub(1) {
            let across = (own[col + 1] - own[col - 1]) / (2.0 * cell.across_m);
            let down = (below[col] - above[col]) / (2.0 * cell.down_m);
            let slope = (across * across + down * down).sqrt();
            if !slope.is_nan() {
                slopes.push(slope);
            }
        }
    }
    slopes
}

/// The median slope. Nothing where no cell has one.
pub(super) fn median_slope(plane: &Plane, cell: CellSize) -> Option<f64> {
    let mut slopes = slopes(plane, cell);
    let middle = slopes.len() / 2;
    (!slopes.is_empty()).then(|| *slopes.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// What to say of an exemplar whose median slope is so far from the input's that it may teach the wrong detail.
pub(super) fn remark(input: Option<f64>, exemplar: Option<f64>) -> Option<String> {
    let (input, exemplar) = (input?, exemplar?);
    let is_like = exemplar.max(input) <= UNLIKE * exemplar.min(input);
    // Flat land is no kind of terrain.
    if is_like || input <= 0.0 {
        return None;
    }
    let degrees = |slope: f64| slope.atan().to_degrees();
    Some(format!(
        "its terrain is of another kind than the input's: half of it is steeper than {:.1} degrees, of the input than {:.1}, seen \
         with cells of the input's size",
        degrees(exemplar),
        degrees(input)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELL: CellSize = CellSize { across_m: 10.0, down_m: 5.0 };

    #[test]
    fn slopes_count_the_cells_sizes() {
        let plane = |across: f64, down: f64| {
            Plane::new(4, 5, (0..20).map(|i| f64::from(i % 5) * across + f64::from(i / 5) * down).collect())
        };
        assert_eq!(median_slope(&plane(30.0, 20.0), CELL), Some(5.0));
        assert_eq!(median_slope(&plane(f64::NAN, 0.0), CELL), None);
        assert_eq!(median_slope(&Plane::new(1, 5, vec![0.0; 5]), CELL), None);
    }

    #[test]
    fn other_kinds_are_told() {
        assert!(remark(Some(0.3), Some(0.1)).is_some_and(|text| text.contains("5.7 degrees")));
        assert_eq!(remark(Some(0.3), Some(0.2)), None);
        assert_eq!(remark(Some(0.0), Some(0.2)), None);
        assert_eq!(remark(None, Some(0.2)), None);
    }
}
