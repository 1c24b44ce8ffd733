//! Slopes of a sparse terrain, and what its atoms cannot exceed.

use super::atoms::Origin;
use super::terrain::{SparseTerrain, cubic, cubic_slopes};
use crate::interval::Interval;
use crate::noise::Sample;

/// What a sparse terrain is at a point, with derivatives by column (`dx`) and by row (`dy`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SparseSample {
    /// Elevation in metres: the blend of the discs.
    pub elevation: Sample,
    /// Sum of the discs' weights.
    pub weight: Sample,
}

impl SparseTerrain {
    /// [`SparseTerrain::elevation_m`] with its gradient, and the sum of the discs' weights with its own; `None` where no
    /// disc reaches.
    pub fn sample(&self, row: f64, col: f64) -> Option<SparseSample> {
        let radius = self.layout().shape().radius_cells();
        let [down, across] = self.layout().places_at((row, row), (col, col));
        let square = radius * radius;
        let (mut top_sum, mut weights) = (Sample::default(), Sample::default());
        for i in down {
            for j in across.clone() {
                let place = i * self.layout().patches().1 + j;
                let Some(patch) = self.patch_at(place) else { continue };
                let (top, left) = self.layout().corner(place);
                let (y, x) = (row - top as f64, col - left as f64);
                let (dx, dy) = (x - radius, y - radius);
                let rest = 1.0 - (dx * dx + dy * dy) / square;
                if rest <= 0.0 {
                    continue;
                }
                let (weight, fall) = (rest * rest * rest, -6.0 * rest * rest / square);
                let (wx, wy) = (fall * dx, fall * dy);
                let (mean, atoms, parts) = self.patch(patch);
                let mut own = Sample { value: f64::from(mean), dx: 0.0, dy: 0.0 };
                for (&atom, &part) in atoms.iter().zip(parts) {
                    let (part, atom) = (f64::from(part), self.atom_sample(atom as usize, x, y));
                    own.value += part * atom.value;
                    own.dx += part * atom.dx;
                    own.dy += part * atom.dy;
                }
                top_sum.value += weight * own.value;
                top_sum.dx += weight * own.dx + own.value * wx;
                top_sum.dy += weight * own.dy + own.value * wy;
                weights.value += weight;
                weights.dx += wx;
                weights.dy += wy;
            }
        }
        if weights.value <= 0.0 {
            return None;
        }
        let value = top_sum.value / weights.value;
        let slope = |sum: f64, weight: f64| (sum - value * weight) / weights.value;
        let elevation = Sample { value, dx: slope(top_sum.dx, weights.dx), dy: slope(top_sum.dy, weights.dy) };
        Some(SparseSample { elevation, weight: weights })
    }

    /// [`SparseTerrain::atom_value`] with derivatives by `x` and `y`.
    pub fn atom_sample(&self, atom: usize, x: f64, y: f64) -> Sample {
        if let Origin::Noise(noise) = self.dictionary().origin(atom) {
            let radius = self.layout().shape().radius_cells();
            let found = noise.sample(x / radius - 1.0, y / radius - 1.0);
            return Sample { value: found.value, dx: found.dx / radius, dy: found.dy / radius };
        }
        let (values, side) = (self.dictionary().atom(atom), self.dictionary().side());
        let factor = self.factor() as f64;
        let (at_x, at_y) = (x * factor - 0.5, y * factor - 0.5);
        let ((cols, by_col), (rows, by_row)) = (cubic(at_x, side), cubic(at_y, side));
        let (slope_by_col, slope_by_row) = (cubic_slopes(at_x), cubic_slopes(at_y));
        let mut found = Sample::default();
        for (i, &row) in rows.iter().enumerate() {
            let line = &values[row * side..][..side];
            let sum = |by: &[f64; 4]| -> f64 { cols.iter().zip(by).map(|(&col, by)| by * f64::from(line[col])).sum() };
            let along = sum(&by_col);
            found.value += by_row[i] * along;
            found.dx += by_row[i] * sum(&slope_by_col) * factor;
            found.dy += slope_by_row[i] * along * factor;
        }
        found
    }

    /// Range of an atom over a box of its square, and bound of its slope there, per cell; `x` and `y` are counted in
    /// cells of the layout from the square's corner.
    ///
    /// Between values it is a bicubic patch: it stays within the hull of its control points, and its derivatives within
    /// three times the differences of neighbouring ones. Of noise the bounds are those of its kind, anywhere.
    pub fn atom_bounds(&self, atom: usize, x: Interval, y: Interval) -> (Interval, f64) {
        if let Origin::Noise(noise) = self.dictionary().origin(atom) {
            let (range, slope) = noise.bounds();
            return (range, slope / self.layout().shape().radius_cells());
        }
        let (values, side) = (self.dictionary().atom(atom), self.dictionary().side() as i64);
        let at = |row: i64, col: i64| {
            let inside = |i: i64| i.clamp(0, side - 1) as usize;
            f64::from(values[inside(row) * side as usize + inside(col)])
        };
        // The values before the first and the last patch; a place on the edge of two may be rounded into the other.
        let patches = |ends: Interval| {
            let ends = ends.scaled(self.factor() as f64).widened();
            let before = |at: f64| ((at - 0.5).floor() as i64).clamp(-1, side - 1);
            before(ends.min)..=before(ends.max)
        };
        let mut found: Option<Interval> = None;
        let (mut along, mut across) = (0.0_f64, 0.0_f64);
        for row in patches(y) {
            for col in patches(x) {
                let lines = [-1, 0, 1, 2].map(|i| controls([-1, 0, 1, 2].map(|j| at(row + i, col + j))));
                let columns = [0, 1, 2, 3].map(|j| controls([0, 1, 2, 3].map(|i| lines[i][j])));
                for (j, column) in columns.iter().enumerate() {
                    for (i, &value) in column.iter().enumerate() {
                        let point = Interval::point(value);
                        found = Some(found.map_or(point, |range| range.hull(point)));
                        if i > 0 {
                            across = across.max((value - column[i - 1]).abs());
                        }
                        if j > 0 {
                            along = along.max((value - columns[j - 1][i]).abs());
                        }
                    }
                }
            }
        }
        let slope = 3.0 * self.factor() as f64 * (along * along + across * across).sqrt();
        (found.unwrap_or(Interval::point(0.0)).widened(), slope * (1.0 + 1e-12))
    }
}

/// Control points of the spline of Catmull and Rom between the middle two of four samples.
fn controls([a, b, c, d]: [f64; 4]) -> [f64; 4] {
    [b, b + (c - a) / 6.0, c - (d - b) / 6.0, c]
}
