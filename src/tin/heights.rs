//! A raster of elevations.

use crate::error::{Error, ErrorKind, Result};

/// Longest side of a raster: what keeps the products of scan conversion within 64 bits.
const MAX_SIDE: usize = 1 << 20;

/// Most cells of a raster: their numbers have 32 bits, of which one value stands for none.
const MAX_CELLS: usize = u32::MAX as usize;

/// Elevations in metres, row-major; NaN where there is no data.
#[derive(Clone, Debug)]
pub struct Heights {
    rows: usize,
    cols: usize,
    z_m: Vec<f64>,
    has_voids: bool,
}

impl Heights {
    /// A raster of `rows` times `cols` elevations in metres; those that are not finite are voids.
    ///
    /// # Errors
    /// A raster with more than a million rows or columns, or more cells than 32 bits count.
    ///
    /// # Panics
    /// When `z_m` does not hold exactly `rows * cols` elevations.
    pub fn new(rows: usize, cols: usize, mut z_m: Vec<f64>) -> Result<Self> {
        assert_eq!(z_m.len(), rows * cols, "one elevation a cell");
        Self::admit(rows, cols)?;
        let mut has_voids = false;
        for z in z_m.iter_mut().filter(|z| !z.is_finite()) {
            (*z, has_voids) = (f64::NAN, true);
        }
        Ok(Self { rows, cols, z_m, has_voids })
    }

    /// Refuses a raster of a size that cannot be triangulated here.
    ///
    /// # Errors
    /// As [`Heights::new`].
    pub fn admit(rows: usize, cols: usize) -> Result<()> {
        if rows.max(cols) <= MAX_SIDE && rows.checked_mul(cols).is_some_and(|cells| cells < MAX_CELLS) {
            return Ok(());
        }
        let message = format!(
            "{cols} x {rows} cells are too many to triangulate at once: at most {MAX_SIDE} a side and {MAX_CELLS} in all; \
             cut the raster with --window or --bbox"
        );
        Err(Error::new(ErrorKind::Unsupported, message))
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// All elevations in metres, row-major.
    pub fn z_m(&self) -> &[f64] {
        &self.z_m
    }

    /// Whether there is a cell without data.
    pub fn has_voids(&self) -> bool {
        self.has_voids
    }

    /// Column and row of a cell.
    #[inline]
    pub(super) fn place(&self, cell: u32) -> [i64; 2] {
        [(cell as usize % self.cols) as i64, (cell as usize / self.cols) as i64]
    }

    /// The cell at a column and row inside the raster.
    #[inline]
    #[allow(clippy::cast_possible_truncation, reason = "cells are counted with 32 bits")]
    pub(super) fn cell(&self, [x, y]: [i64; 2]) -> u32 {
        (y as usize * self.cols + x as usize) as u32
    }

    /// Whether there is data at a column and row, which may lie outside.
    #[inline]
    pub(super) fn has(&self, [x, y]: [i64; 2]) -> bool {
        let inside = x >= 0 && y >= 0 && (x as usize) < self.cols && (y as usize) < self.rows;
        inside && !self.z_m[y as usize * self.cols + x as usize].is_nan()
    }

    /// Elevation at a column and row inside the raster.
    #[inline]
    pub(super) fn z(&self, [x, y]: [i64; 2]) -> f64 {
        self.z_m[y as usize * self.cols + x as usize]
    }
}
