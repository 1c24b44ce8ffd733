//! Coordinate reference systems, from GDAL's to this crate's.

use crate::crs::{Crs, CrsKind, Ellipsoid};
use crate::error::{Error, Result};
use gdal::spatial_ref::SpatialRef;

/// Reads a CRS as the user writes it: `EPSG:2056`, WKT, a PROJ string, a file name.
///
/// # Errors
/// A usage error when GDAL does not understand it.
pub fn parse_crs(text: &str) -> Result<Crs> {
    super::super::messages::quiet();
    let srs = SpatialRef::from_definition(text).map_err(|_| {
        let said = super::super::messages::take_failures().join("; ");
        Error::usage(format!("'{text}' is not a CRS that PROJ knows; expected for example EPSG:2056 or WKT. {said}"))
    })?;
    describe(&srs)
}

/// Describes a GDAL spatial reference.
pub(in crate::io) fn describe(srs: &SpatialRef) -> Result<Crs> {
    let wrong = |error| Error::usage(format!("the CRS cannot be read: {error}"));
    let ellipsoid = || -> Result<Ellipsoid> {
        let (a_m, b_m) = (srs.semi_major().map_err(wrong)?, srs.semi_minor().map_err(wrong)?);
        let inverse = a_m / (a_m - b_m);
        // The axes give the inverse flattening up to rounding; definitions write it with at most nine decimals.
        let written = (inverse * 1e9).round() / 1e9;
        let flattening = match () {
            () if a_m == b_m => 0.0,
            () if (inverse - written).abs() < 1e-7 => 1.0 / written,
            () => 1.0 / inverse,
        };
        Ok(Ellipsoid { a_m, flattening })
    };
    let kind = if srs.is_geographic() || srs.is_derived_geographic() {
        CrsKind::Geographic { ellipsoid: ellipsoid()?, degrees: degrees_of(srs.angular_units()) }
    } else if srs.is_projected() {
        CrsKind::Projected { ellipsoid: ellipsoid()?, metres: srs.linear_units() }
    } else {
        CrsKind::Local { metres: srs.linear_units() }
    };
    // `geog_cs` and the node paths look into the horizontal part of a compound CRS too.
    let projection = srs.get_attr_value("PROJECTION", 0).ok().flatten();
    let vertical_unit = if srs.is_compound() || srs.is_vertical() {
        srs.get_attr_value("VERT_CS|UNIT", 0).ok().flatten()
    } else {
        None
    };
    Ok(Crs {
        wkt: srs.to_wkt().map_err(wrong)?,
        name: srs.name().unwrap_or_default(),
        authority: srs.authority().ok(),
        kind,
        projection,
        vertical_unit,
    })
}

/// Degrees in an angular unit of so many radians; a degree is exactly 1.
fn degrees_of(radians: f64) -> f64 {
    let degrees = radians.to_degrees();
    if (degrees - 1.0).abs() < 1e-9 { 1.0 } else { degrees }
}
