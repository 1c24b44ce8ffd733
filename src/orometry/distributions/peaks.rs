//! What the statistics need to know of a peak, wherever it was read from.

use crate::orometry::Peak;

/// The measures of one peak that the statistics are made of.
///
/// Lean enough to be filled from a [`Peak`] just surveyed as well as from a row of a `peaks` layer; fields carry the
/// names of that layer. Dominance, relative prominence, relative elevation and relevance are not here: the first
/// follows from elevation and prominence, the others depend on the domain and are always computed anew for it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PeakMeasures {
    /// Easting or longitude in the units of the CRS.
    pub x: f64,
    /// Northing or latitude in the units of the CRS.
    pub y: f64,
    /// Longitude in degrees; `None` without a CRS.
    pub lon: Option<f64>,
    /// Latitude in degrees; `None` without a CRS.
    pub lat: Option<f64>,
    /// Name of the region that the peak stands in.
    pub region: Option<String>,
    /// Elevation in metres.
    pub elevation_m: f64,
    /// Prominence in metres; for a root the convention of the survey.
    pub prominence_m: f64,
    /// Whether nothing unknown could change the prominence.
    pub prominence_certain: bool,
    /// Distance to the key saddle in metres; `None` for a root.
    pub saddle_distance_m: Option<f64>,
    /// Azimuth of the key saddle in degrees clockwise from north.
    pub saddle_azimuth: Option<f64>,
    /// Distance to the nearest higher cell in metres; `None` for the highest peak, or where it was not asked for.
    pub isolation_m: Option<f64>,
    /// Azimuth of that cell in degrees clockwise from north.
    pub isolation_azimuth: Option<f64>,
    /// Whether nothing unknown could shorten the isolation.
    pub isolation_certain: bool,
}

impl From<&Peak> for PeakMeasures {
    /// The measures of a surveyed peak; place and region stay empty, as a survey knows cells only.
    fn from(peak: &Peak) -> Self {
        let number = |v: f64| v.is_finite().then_some(v);
        Self {
            elevation_m: peak.elevation_m,
            prominence_m: peak.prominence_m,
            prominence_certain: peak.prominence_certain,
            saddle_distance_m: peak.key_saddle.and_then(|s| number(s.distance_m)),
            saddle_azimuth: peak.key_saddle.and_then(|s| number(s.azimuth)),
            isolation_m: peak.isolation.and_then(|i| i.isolation_m),
            isolation_azimuth: peak.isolation.and_then(|i| number(i.azimuth)),
            isolation_certain: peak.isolation.is_some_and(|i| i.certain),
            ..Self::default()
        }
    }
}

impl PeakMeasures {
    /// The same peak at its coordinates.
    #[must_use]
    pub fn at(mut self, (x, y): (f64, f64), lon_lat: Option<(f64, f64)>) -> Self {
        (self.x, self.y) = (x, y);
        (self.lon, self.lat) = lon_lat.unzip();
        self
    }

    /// The same peak with its region.
    #[must_use]
    pub fn in_region(mut self, region: Option<String>) -> Self {
        self.region = region;
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orometry::{Isolation, KeySaddle};

    #[test]
    fn from_a_surveyed_peak() {
        let mut peak = Peak {
            id: 1,
            cell: 7,
            elevation_m: 3000.0,
            prominence_m: 500.0,
            prominence_min_m: 500.0,
            prominence_certain: true,
            is_root: false,
            key_saddle: Some(KeySaddle { cell: 3, elevation_m: 2500.0, distance_m: 900.0, azimuth: f64::NAN }),
            island_parent: None,
            prominence_parent: None,
            line_parent: None,
            isolation: Some(Isolation {
                isolation_m: Some(1200.0),
                isolation_min_m: Some(1200.0),
                certain: true,
                azimuth: 45.0,
                higher: Some(2),
            }),
            dominance: None,
            relative_prominence: None,
            relative_elevation: None,
            relevance: None,
        };
        let m = PeakMeasures::from(&peak).at((8.0, 46.0), Some((8.0, 46.0)));
        assert_eq!((m.saddle_distance_m, m.saddle_azimuth), (Some(900.0), None), "an undefined azimuth is missing");
        assert_eq!((m.isolation_m, m.isolation_azimuth, m.isolation_certain), (Some(1200.0), Some(45.0), true));
        assert_eq!((m.lon, m.lat), (Some(8.0), Some(46.0)));
        peak.isolation = None;
        let m = PeakMeasures::from(&peak).at((8.0, 46.0), None);
        assert_eq!((m.isolation_m, m.isolation_certain, m.lon), (None, false, None));
    }
}
