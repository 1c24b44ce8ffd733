//! What terrains are described from: elevations in metres.

use crate::error::{Error, ErrorKind, Result};

/// No elevation is further from zero; sums of squares of what is nearer stay far from overflow.
const MOST_M: f32 = 1e9;

/// Elevations in metres, row by row from the north; NaN is a void.
#[derive(Clone, Copy, Debug)]
pub struct Raster<'a> {
    rows: usize,
    cols: usize,
    elevation_m: &'a [f32],
}

impl<'a> Raster<'a> {
    /// A raster over elevations that are there already.
    ///
    /// # Errors
    /// When there is no cell, their number is not `rows * cols`, or one is infinite or beyond a thousand million
    /// metres; the place names the cell.
    pub fn new(rows: usize, cols: usize, elevation_m: &'a [f32]) -> Result<Self> {
        if rows.checked_mul(cols) != Some(elevation_m.len()) || elevation_m.is_empty() {
            let message = format!("{} elevations are no raster of {rows} rows and {cols} columns", elevation_m.len());
            return Err(Error::usage(message));
        }
        // Also in i64 and u32, which number patches and places.
        if rows > 1 << 30 || cols > 1 << 30 {
            return Err(Error::new(ErrorKind::Unsupported, "a raster of more than 2^30 rows or columns"));
        }
        if let Some(cell) = elevation_m.iter().position(|v| v.abs() > MOST_M) {
            let message = format!("{} m is no elevation; mark voids as nodata", elevation_m[cell]);
            let place = format!("row {}, column {}", cell / cols, cell % cols);
            return Err(Error::new(ErrorKind::Input, message).at_place(place));
        }
        Ok(Self { rows, cols, elevation_m })
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// All elevations, row by row.
    pub fn elevation_m(&self) -> &'a [f32] {
        self.elevation_m
    }

    /// The elevations of part of a row that may reach beyond the raster: where it begins within `left..left + width`,
    /// and the elevations from there on.
    pub(super) fn part(&self, row: i64, left: i64, width: usize) -> (usize, &'a [f32]) {
        let cols = self.cols as i64;
        let (from, to) = (left.clamp(0, cols), (left + width as i64).clamp(0, cols));
        if row < 0 || row >= self.rows as i64 || from >= to {
            return (0, &[]);
        }
        let start = row as usize * self.cols;
        ((from - left) as usize, &self.elevation_m[start + from as usize..start + to as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_rasters_are_refused() {
        for (rows, cols, cells) in [(0, 0, vec![]), (2, 2, vec![0.0; 3]), (usize::MAX, 2, vec![0.0; 4])] {
            assert_eq!(Raster::new(rows, cols, &cells).unwrap_err().kind(), ErrorKind::Usage);
        }
        let error = Raster::new(2, 2, &[0.0, 1.0, 2.0, f32::INFINITY]).unwrap_err();
        assert_eq!((error.kind(), error.place()), (ErrorKind::Input, Some("row 1, column 1")));
        assert!(Raster::new(1, 2, &[f32::NAN, -11000.0]).is_ok());
    }

    #[test]
    fn parts_are_what_lies_inside() {
        let cells = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let raster = Raster::new(2, 3, &cells).unwrap();
        assert_eq!(raster.part(1, -2, 4), (2, &cells[3..5]));
        assert_eq!(raster.part(0, 1, 9), (0, &cells[1..3]));
        assert_eq!(raster.part(0, 3, 2).1.len(), 0);
        assert_eq!(raster.part(2, 0, 3).1.len(), 0);
        assert_eq!(raster.part(-1, -5, 3).1.len(), 0);
    }
}
