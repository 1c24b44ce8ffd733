//! A coordinate reference system as the rest of the crate needs to know it.

use super::ellipsoid::Ellipsoid;

/// What the coordinates of a CRS are.
#[derive(Clone, Debug, PartialEq)]
pub enum CrsKind {
    /// Longitudes and latitudes on an ellipsoid, in units of `degrees` degrees.
    Geographic {
        /// The ellipsoid of the datum.
        ellipsoid: Ellipsoid,
        /// Degrees in one unit of the coordinates.
        degrees: f64,
    },
    /// Plane coordinates in units of `metres` metres, on a projection of an ellipsoid.
    Projected {
        /// The ellipsoid of the datum.
        ellipsoid: Ellipsoid,
        /// Metres in one unit of the coordinates.
        metres: f64,
    },
    /// Plane coordinates that belong to no place on Earth.
    Local {
        /// Metres in one unit of the coordinates.
        metres: f64,
    },
}

/// A coordinate reference system.
#[derive(Clone, Debug, PartialEq)]
pub struct Crs {
    /// Its definition as WKT2:2019.
    pub wkt: String,
    /// Its name.
    pub name: String,
    /// Authority and code, such as `EPSG:4326`, where it has one.
    pub authority: Option<String>,
    /// What its coordinates are.
    pub kind: CrsKind,
    /// Method of the projection (`Mercator_1SP` and the like), where there is one.
    pub projection: Option<String>,
    /// Unit of its vertical axis, where it has one.
    pub vertical_unit: Option<String>,
}

impl Crs {
    /// Whether the coordinates are longitudes and latitudes.
    pub fn is_geographic(&self) -> bool {
        matches!(self.kind, CrsKind::Geographic { .. })
    }

    /// The ellipsoid, where the CRS has one.
    pub fn ellipsoid(&self) -> Option<&Ellipsoid> {
        match &self.kind {
            CrsKind::Geographic { ellipsoid, .. } | CrsKind::Projected { ellipsoid, .. } => Some(ellipsoid),
            CrsKind::Local { .. } => None,
        }
    }

    /// Metres in one unit of the coordinates, where they are plane; else 1.
    pub fn linear_unit_m(&self) -> f64 {
        match self.kind {
            CrsKind::Projected { metres, .. } | CrsKind::Local { metres } => metres,
            CrsKind::Geographic { .. } => 1.0,
        }
    }

    /// Authority and code where there is one, else the name.
    pub fn label(&self) -> &str {
        self.authority.as_deref().unwrap_or(&self.name)
    }
}

/// A longitude brought into -180 to 180 degrees.
pub(crate) fn normal_longitude(lon: f64) -> f64 {
    if (-180.0..=180.0).contains(&lon) { lon } else { lon - 360.0 * ((lon + 180.0) / 360.0).floor() }
}

impl Crs {
    /// Longitude and latitude in degrees, -180 to 180, of coordinates in a geographic CRS.
    pub fn geographic_degrees(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        match self.kind {
            CrsKind::Geographic { degrees, .. } => Some((normal_longitude(x * degrees), y * degrees)),
            _ => None,
        }
    }
}
