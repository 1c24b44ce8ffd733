//! Between projected coordinates and longitude and latitude, on the CRS's own ellipsoid.

use super::messages::quiet;
use crate::crs::{Crs, Ellipsoid, ToGeographic};
use crate::error::{Error, ErrorKind, Result};
use gdal::spatial_ref::{AxisMappingStrategy, CoordTransform, SpatialRef};
use std::cell::RefCell;

/// Turns coordinates of a projected CRS into degrees of longitude and latitude on its own datum.
#[derive(Clone, Debug)]
pub struct OwnGeographic {
    wkt: String,
}

thread_local! {
    /// GDAL's transformers belong to the thread that made them.
    static TRANSFORM: RefCell<Option<(String, CoordTransform)>> = const { RefCell::new(None) };
}

impl OwnGeographic {
    /// The transformation of a projected CRS.
    ///
    /// # Errors
    /// When PROJ cannot do it.
    pub fn new(crs: &Crs) -> Result<Self> {
        quiet();
        let transform = Self { wkt: crs.wkt.clone() };
        transform.create().map_err(|error| {
            Error::new(
                ErrorKind::Unsupported,
                format!("PROJ cannot turn coordinates of {} into longitudes and latitudes: {error}", crs.label()),
            )
        })?;
        Ok(transform)
    }

    fn create(&self) -> gdal::errors::Result<CoordTransform> {
        let mut from = SpatialRef::from_wkt(&self.wkt)?;
        let mut to = from.geog_cs()?;
        from.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
        to.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
        CoordTransform::new(&from, &to)
    }
}

impl ToGeographic for OwnGeographic {
    fn to_geographic(&self, x: &mut [f64], y: &mut [f64]) {
        TRANSFORM.with_borrow_mut(|kept| {
            if kept.as_ref().is_none_or(|(wkt, _)| *wkt != self.wkt) {
                *kept = self.create().ok().map(|transform| (self.wkt.clone(), transform));
            }
            let done = kept.as_ref().is_some_and(|(_, transform)| transform.transform_coords(x, y, &mut []).is_ok());
            for (x, y) in x.iter_mut().zip(y) {
                // What could not be transformed is infinite, or untouched if nothing was done.
                if !x.is_finite() || !y.is_finite() || (!done && (y.abs() > 90.0)) {
                    (*x, *y) = (f64::NAN, f64::NAN);
                }
            }
        });
    }
}

/// From the coordinates of one CRS to those of another.
#[derive(Debug)]
pub struct Reprojection {
    transform: CoordTransform,
}

impl Reprojection {
    /// The way from one CRS to another; heights are left alone.
    ///
    /// # Errors
    /// When PROJ knows none.
    pub fn new(from: &Crs, to: &Crs) -> Result<Self> {
        quiet();
        let parse = |crs: &Crs| -> gdal::errors::Result<SpatialRef> {
            let mut parsed = SpatialRef::from_wkt(&crs.wkt)?;
            parsed.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
            Ok(parsed)
        };
        let transform = parse(from).and_then(|source| CoordTransform::new(&source, &parse(to)?)).map_err(|error| {
            let message = format!("PROJ knows no way from {} to {}: {error}", from.label(), to.label());
            Error::new(ErrorKind::Unsupported, message)
        })?;
        Ok(Self { transform })
    }

    /// Coordinates in the other CRS in place of those in the one; NaN where there are none.
    pub fn project(&self, x: &mut [f64], y: &mut [f64]) {
        // What could not be transformed is infinite; a failure as a whole says no more than that.
        let before = (x.to_vec(), y.to_vec());
        let done = self.transform.transform_coords(x, y, &mut []).is_ok();
        let is_untouched = !done && before.0 == x && before.1 == y;
        for (x, y) in x.iter_mut().zip(y) {
            if is_untouched || !x.is_finite() || !y.is_finite() {
                (*x, *y) = (f64::NAN, f64::NAN);
            }
        }
    }
}

/// A plane that touches an ellipsoid: the stereographic projection about a point, true to angles, with distances that
/// are longer by a part in 500 at 5 degrees from it and one in 130 at 10.
#[derive(Debug)]
pub struct LocalPlane {
    transform: CoordTransform,
    definition: String,
}

impl LocalPlane {
    /// The plane that touches an ellipsoid at a longitude and latitude in degrees.
    ///
    /// # Errors
    /// When PROJ cannot do it.
    pub fn new(ellipsoid: &Ellipsoid, lon: f64, lat: f64) -> Result<Self> {
        quiet();
        let body = format!("+a={} +b={} +no_defs", ellipsoid.a_m, ellipsoid.b_m());
        let definition = format!("+proj=stere +lat_0={lat} +lon_0={lon} +k=1 +x_0=0 +y_0=0 +units=m {body}");
        let wrong = |error: gdal::errors::GdalError| {
            Error::new(ErrorKind::Unsupported, format!("PROJ cannot project to a plane at {lon}, {lat}: {error}"))
        };
        let mut from = SpatialRef::from_proj4(&format!("+proj=longlat {body}")).map_err(wrong)?;
        let to = SpatialRef::from_proj4(&definition).map_err(wrong)?;
        from.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
        let transform = CoordTransform::new(&from, &to).map_err(wrong)?;
        Ok(Self { transform, definition })
    }

    /// The plane as a PROJ string.
    pub fn definition(&self) -> &str {
        &self.definition
    }

    /// Metres in the plane in place of longitudes and latitudes in degrees.
    ///
    /// # Errors
    /// When a place has no image.
    pub fn project(&self, x: &mut [f64], y: &mut [f64]) -> Result<()> {
        let done = self.transform.transform_coords(x, y, &mut []).is_ok();
        if done && x.iter().chain(y.iter()).all(|v| v.is_finite()) {
            return Ok(());
        }
        Err(Error::new(
            ErrorKind::Unsupported,
            "some cells have no place in the plane that touches the raster's middle",
        ))
    }
}
