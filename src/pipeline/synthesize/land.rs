//! The land that is filled: a raster that is in no file.

use super::range::Range;
use crate::crs::{Crs, CrsKind};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::GeoTransform;
use crate::io::raster::parse_crs;

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
    /// The land of a box in a CRS, both those of the first range unless given, with cells of `resolution_m` metres.
    ///
    /// # Errors
    /// `Usage` where neither the range nor the options say where it is, and for a box that is empty or too large.
    pub(super) fn new(range: &Range, bbox: Option<[f64; 4]>, crs: Option<&str>, resolution_m: f64) -> Result<Self> {
        let place = range.place.as_ref();
        let own_crs = place.and_then(|place| place.crs.clone());
        let given = crs.map(parse_crs).transpose()?;
        let is_elsewhere = given.as_ref().is_some_and(|given| own_crs.as_ref().is_none_or(|own| own.wkt != given.wkt));
        let crs = given.or(own_crs);
        let bbox = match (bbox, place) {
            (Some(bbox), _) => bbox,
            (None, Some(place)) if !is_elsewhere => place.bbox,
            (None, Some(_)) => {
                return Err(Error::usage("--crs is not the range's own: say with --bbox which land to fill in it"));
            }
            (None, None) => {
                return Err(Error::usage(
                    "statistics do not say where the range is: say with --bbox, in units of --crs or in metres, which land to fill",
                ));
            }
        };
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
}
