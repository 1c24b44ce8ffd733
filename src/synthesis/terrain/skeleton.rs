//! A divide tree on a raster that is to be made.

use super::heights::Elevation;
use crate::error::{Error, ErrorKind, Result};

/// A peak or a saddle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Row of its cell.
    pub row: usize,
    /// Column of its cell.
    pub col: usize,
    /// Elevation in metres.
    pub elevation_m: f64,
}

/// A ridge from a saddle up to a peak, or to where it meets another ridge of that peak's and becomes one with it.
#[derive(Clone, Debug, PartialEq)]
pub struct RidgeLine {
    /// Position of the saddle.
    pub saddle: u32,
    /// Position of the peak.
    pub peak: u32,
    /// Column and row of each point, whole numbers at centres of cells; the saddle's first.
    pub points: Vec<[f64; 2]>,
}

/// A divide tree, or several, on a raster that is to be made.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    /// Rows and columns of the raster.
    pub size: [usize; 2],
    /// Width and height of a cell in metres.
    pub cell_m: [f64; 2],
    /// The peaks.
    pub peaks: Vec<Spot>,
    /// The saddles.
    pub saddles: Vec<Spot>,
    /// Two ridges for each saddle.
    pub ridges: Vec<RidgeLine>,
}

impl Skeleton {
    /// Checks that all lies on the raster, and that ridges rise from saddles to peaks.
    ///
    /// # Errors
    /// `Input`, with the first fault.
    pub fn check(&self) -> Result<()> {
        let wrong = |message: String| Err(Error::new(ErrorKind::Input, message));
        let [rows, cols] = self.size;
        for (kind, spots) in [("peak", &self.peaks), ("saddle", &self.saddles)] {
            for spot in spots {
                let Spot { row, col, elevation_m } = *spot;
                if row >= rows || col >= cols || !elevation_m.is_finite() {
                    return wrong(format!(
                        "a {kind} of {elevation_m} m at row {row}, column {col}, of {rows} rows and {cols} columns"
                    ));
                }
            }
        }
        for ridge in &self.ridges {
            let ends = self.saddles.get(ridge.saddle as usize).zip(self.peaks.get(ridge.peak as usize));
            let Some((saddle, peak)) = ends else {
                return wrong(format!(
                    "a ridge from saddle {} to peak {}, which are not there",
                    ridge.saddle, ridge.peak
                ));
            };
            if saddle.elevation_m > peak.elevation_m {
                return wrong(format!(
                    "the saddle at row {}, column {} is {} m high, above its peak at row {}, column {} with {} m",
                    saddle.row, saddle.col, saddle.elevation_m, peak.row, peak.col, peak.elevation_m
                ));
            }
        }
        Ok(())
    }

    /// Elevation in metres of a ridge's saddle and of its peak.
    pub(super) fn ends_m(&self, ridge: &RidgeLine) -> [f64; 2] {
        [self.saddles[ridge.saddle as usize].elevation_m, self.peaks[ridge.peak as usize].elevation_m]
    }

    /// How high ways between peaks are.
    pub(super) fn heights(&self) -> super::heights::Heights {
        let mut passes: Vec<(Elevation, [u32; 2])> = vec![];
        let mut first: Vec<Option<u32>> = vec![None; self.saddles.len()];
        for ridge in &self.ridges {
            match first[ridge.saddle as usize] {
                None => first[ridge.saddle as usize] = Some(ridge.peak),
                Some(other) => {
                    passes.push((self.saddles[ridge.saddle as usize].elevation_m as f32, [other, ridge.peak]));
                }
            }
        }
        super::heights::Heights::of(self.peaks.len(), passes)
    }
}
