//! The land that is to be filled: cells, and the metres between them.

use crate::crs::{Metric, Place};
use crate::grid::Cell;

/// A raster that need not exist: its size, and the size of its cells on the ground. Rows run southwards, columns
/// eastwards.
#[derive(Debug)]
pub struct Extent<'a, M: ?Sized> {
    pub(super) rows: usize,
    pub(super) cols: usize,
    pub(super) metric: &'a M,
    /// Metres from each row to the next.
    row_m: Vec<f64>,
    /// Metres from a column to the next, in each row.
    col_m: Vec<f64>,
}

impl<'a, M: Metric + ?Sized> Extent<'a, M> {
    /// The extent of so many rows and columns.
    pub fn new(rows: usize, cols: usize, metric: &'a M) -> Self {
        let row_m = (0..rows as i64).map(|row| metric.distance_m((row, 0), (row + 1, 0))).collect();
        let col_m = (0..rows as i64).map(|row| metric.distance_m((row, 0), (row, 1))).collect();
        Self { rows, cols, metric, row_m, col_m }
    }

    /// Number of rows and columns.
    pub fn size(&self) -> (usize, usize) {
        (self.rows, self.cols)
    }

    /// Area in square kilometres.
    pub fn area_km2(&self) -> f64 {
        // A step beyond a pole has no length.
        let cells_m2 = self.row_m.iter().zip(&self.col_m).map(|(r, c)| r * c).filter(|area| area.is_finite());
        cells_m2.sum::<f64>() * self.cols as f64 / 1e6
    }

    /// Metres of a row and of a column at a place, which may lie outside.
    pub(super) fn steps_m(&self, row: i64) -> (f64, f64) {
        #[allow(clippy::cast_sign_loss, reason = "clamped to the rows there are")]
        let row = row.clamp(0, self.rows as i64 - 1) as usize;
        (self.row_m[row], self.col_m[row])
    }

    /// The place so many metres east and north of another, if it is inside.
    pub(super) fn beside(&self, from: Place, east_m: f64, north_m: f64) -> Option<Place> {
        let (row_m, col_m) = self.steps_m(from.0);
        let row = (from.0 as f64 - north_m / row_m).round();
        let col = (from.1 as f64 + east_m / col_m).round();
        let is_inside = row >= 0.0 && col >= 0.0 && row < self.rows as f64 && col < self.cols as f64;
        #[allow(clippy::cast_possible_truncation, reason = "inside of the extent")]
        is_inside.then_some((row as i64, col as i64))
    }

    /// The cell of a place inside.
    pub(super) fn cell(&self, place: Place) -> Cell {
        #[allow(clippy::cast_sign_loss, reason = "places inside count from 0")]
        let cell = place.0 as u64 * self.cols as u64 + place.1 as u64;
        cell
    }
}

/// East and north of a unit vector with an azimuth in degrees.
///
/// The library's sine may differ between machines in its last bit, and with it where peaks stand: so this is a
/// polynomial of plain steps, right to 1e-12.
pub(super) fn compass(azimuth: f64) -> (f64, f64) {
    let turns = azimuth / 90.0;
    let quarter = turns.round();
    let x = (turns - quarter) * std::f64::consts::FRAC_PI_2;
    let xx = x * x;
    let series = |first: f64, from: f64| {
        let mut k = from + 14.0;
        let mut sum = 1.0;
        while k > from {
            sum = 1.0 - sum * xx / (k * (k - 1.0));
            k -= 2.0;
        }
        first * sum
    };
    let (sine, cosine) = (series(x, 1.0), series(1.0, 0.0));
    #[allow(clippy::cast_possible_truncation, reason = "a remainder of 4")]
    match quarter.rem_euclid(4.0) as i32 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rose() {
        for tenth in -100..=7300 {
            let azimuth = f64::from(tenth) / 10.0;
            let (east, north) = compass(azimuth);
            let (sine, cosine) = azimuth.to_radians().sin_cos();
            assert!((east - sine).abs() < 1e-12 && (north - cosine).abs() < 1e-12, "{azimuth}");
        }
        assert_eq!(compass(90.0), (1.0, 0.0));
    }
}
