//! From projected coordinates to longitude and latitude, on the CRS's own ellipsoid.

use super::messages::quiet;
use crate::crs::{Crs, ToGeographic};
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
