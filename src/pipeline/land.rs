//! Land that is to be made: a raster that is in no file yet.

use super::metric::{AnyMetric, Distance, cell_m, metric_on};
use crate::crs::{Crs, CrsKind};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::GeoTransform;
use crate::io::transform::OwnGeographic;

/// Where the land is, and its cells.
#[derive(Clone, Debug)]
pub(super) struct Land {
    /// The CRS of its coordinates.
    pub(super) crs: Option<Crs>,
    /// Where its cells are.
    pub(super) transform: GeoTransform,
    /// Number of rows.
    pub(super) rows: usize,
    /// Number of columns.
    pub(super) cols: usize,
}

/// Rows and columns may be this many.
const MOST: f64 = 1_000_000.0;

impl Land {
    /// The land of a box (least x, least y, greatest x, greatest y) in a CRS, with cells of `resolution_m` metres.
    ///
    /// # Errors
    /// `Usage` for a box that is empty or reaches beyond a pole, `Unsupported` for one with too many cells.
    pub(super) fn covering(bbox: [f64; 4], crs: Option<Crs>, resolution_m: f64) -> Result<Self> {
        let [west, south, east, north] = bbox;
        let is_box = bbox.iter().all(|v| v.is_finite()) && west < east && south < north;
        if !is_box {
            return Err(Error::usage(format!(
                "--bbox {west},{south},{east},{north}: expected the least x and y, then the greatest"
            )));
        }
        let cell = match crs.as_ref().map(|crs| &crs.kind) {
            Some(CrsKind::Geographic { ellipsoid, degrees }) => {
                if south * degrees < -90.0 || north * degrees > 90.0 {
                    return Err(Error::usage(format!("--bbox: latitudes from {south} to {north} lie beyond a pole")));
                }
                resolution_m / (ellipsoid.a_m.to_radians() * degrees)
            }
            _ => resolution_m / crs.as_ref().map_or(1.0, Crs::linear_unit_m),
        };
        // A box that is a whole number of cells has no more for rounding.
        let [cols, rows] = [east - west, north - south].map(|length| (length / cell - 1e-6).ceil().max(1.0));
        if !(cols <= MOST && rows <= MOST) {
            return Err(Error::new(
                ErrorKind::Unsupported,
                format!("the land has {cols} x {rows} cells: give a smaller --bbox or a coarser --resolution"),
            ));
        }
        let transform = GeoTransform([west, cell, 0.0, north, 0.0, -cell]);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most a million")]
        Ok(Self { crs, transform, rows: rows as usize, cols: cols as usize })
    }

    /// Rows and columns.
    pub(super) fn size(&self) -> (usize, usize) {
        (self.rows, self.cols)
    }

    /// Distances on the land.
    ///
    /// # Errors
    /// A CRS in which there are none.
    pub(super) fn metric<'a>(&self, to_geographic: Option<&'a OwnGeographic>) -> Result<AnyMetric<'a>> {
        metric_on(&self.transform, self.size(), false, self.crs.as_ref(), Distance::Crs, to_geographic)
    }

    /// Width and height of a cell in the middle of the land, in metres.
    pub(super) fn cell_m(&self, metric: &AnyMetric<'_>) -> [f64; 2] {
        cell_m(self.rows, metric)
    }
}
