//! Disks: all places within a radius of a centre.

use super::peaks::PeakMeasures;
use crate::crs::Ellipsoid;
use crate::error::{Error, Result};
use crate::units::parse_length_m;
use serde::{Deserialize, Serialize};

/// A disk; its rim belongs to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Disk {
    /// Where its middle is.
    pub centre: Centre,
    /// Its radius in metres.
    pub radius_m: f64,
}

/// The middle of a disk, and with it how distances from there are measured.
#[derive(Clone, Debug, PartialEq)]
pub enum Centre {
    /// Geodesic distances from a longitude and latitude in degrees.
    Geographic {
        /// Longitude in degrees.
        lon: f64,
        /// Latitude in degrees.
        lat: f64,
        /// The ellipsoid of the CRS.
        ellipsoid: Ellipsoid,
    },
    /// Plane distances from coordinates in the units of a CRS that is not geographic.
    Planar {
        /// Easting.
        x: f64,
        /// Northing.
        y: f64,
        /// Metres in one unit of the coordinates.
        metres: f64,
    },
}

/// A disk as files describe it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DiskOutline {
    /// Whether `x` and `y` are longitude and latitude in degrees; else coordinates in the CRS of the input.
    pub geographic: bool,
    /// Longitude or easting of the centre.
    pub x: f64,
    /// Latitude or northing of the centre.
    pub y: f64,
    /// Radius in metres.
    pub radius_m: f64,
}

/// Reads a disk written as `x,y,radius`: two coordinates and a length with an optional unit.
///
/// # Errors
/// A usage error for anything else, and for a radius that is not positive.
pub fn parse_disk(text: &str) -> Result<(f64, f64, f64)> {
    let wrong = || {
        Error::usage(format!(
            "'{text}' is not a disk: expected longitude,latitude,radius (or x,y,radius), such as 9.8,46.8,30km"
        ))
    };
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let [x, y, radius] = parts[..] else { return Err(wrong()) };
    let number = |s: &str| s.parse::<f64>().ok().filter(|v| v.is_finite()).ok_or_else(wrong);
    let (x, y, radius_m) = (number(x)?, number(y)?, parse_length_m(radius).map_err(|_| wrong())?);
    if radius_m > 0.0 { Ok((x, y, radius_m)) } else { Err(wrong()) }
}

impl Disk {
    /// A geodesic disk.
    ///
    /// # Errors
    /// A usage error when the latitude lies beyond a pole.
    pub fn geographic(lon: f64, lat: f64, radius_m: f64, ellipsoid: Ellipsoid) -> Result<Self> {
        if !(-90.0..=90.0).contains(&lat) {
            return Err(Error::usage(format!(
                "the disk's latitude is {lat}: expected -90 to 90; the order is longitude,latitude,radius"
            )));
        }
        Ok(Self { centre: Centre::Geographic { lon, lat, ellipsoid }, radius_m })
    }

    /// A plane disk around coordinates in units of `metres` metres.
    pub fn planar(x: f64, y: f64, radius_m: f64, metres: f64) -> Self {
        Self { centre: Centre::Planar { x, y, metres }, radius_m }
    }

    /// The disk as files describe it.
    pub fn outline(&self) -> DiskOutline {
        let (geographic, x, y) = match self.centre {
            Centre::Geographic { lon, lat, .. } => (true, lon, lat),
            Centre::Planar { x, y, .. } => (false, x, y),
        };
        DiskOutline { geographic, x, y, radius_m: self.radius_m }
    }

    /// Its area in square kilometres; a geodesic disk's on the sphere of the ellipsoid's mean radius, which is
    /// within 0.7 % of that on the ellipsoid.
    pub fn area_km2(&self) -> f64 {
        let r_km = self.radius_m / 1000.0;
        match self.centre {
            Centre::Planar { .. } => std::f64::consts::PI * r_km * r_km,
            Centre::Geographic { ellipsoid, .. } => {
                let sphere_km = (2.0 * ellipsoid.a_m + ellipsoid.b_m()) / 3000.0;
                let half = (r_km / sphere_km / 2.0).min(std::f64::consts::FRAC_PI_2);
                4.0 * std::f64::consts::PI * (sphere_km * half.sin()).powi(2)
            }
        }
    }

    /// The peaks that stand in the disk; `None` when the place of one is not known in the disk's coordinates.
    pub fn select<'a>(&self, peaks: &'a [PeakMeasures]) -> Option<Vec<&'a PeakMeasures>> {
        let mut found = vec![];
        if let Centre::Planar { .. } = self.centre {
            found.extend(peaks.iter().filter(|p| self.holds_xy(p.x, p.y)));
            return Some(found);
        }
        let reach = self.reach();
        for peak in peaks {
            if reach.holds(peak.lon?, peak.lat?) {
                found.push(peak);
            }
        }
        Some(found)
    }

    /// Whether coordinates lie in a plane disk.
    ///
    /// # Panics
    /// When the disk is geodesic.
    pub(super) fn holds_xy(&self, x: f64, y: f64) -> bool {
        let Centre::Planar { x: cx, y: cy, metres } = self.centre else { panic!("a geodesic disk knows no x and y") };
        let (dx, dy) = ((x - cx) * metres, (y - cy) * metres);
        dx * dx + dy * dy <= self.radius_m * self.radius_m
    }

    /// What decides about longitudes and latitudes.
    ///
    /// # Panics
    /// When the disk is plane.
    pub(super) fn reach(&self) -> Reach {
        let Centre::Geographic { lon, lat, ellipsoid } = self.centre else { panic!("a plane disk has no longitude") };
        Reach {
            lon,
            lat,
            radius_m: self.radius_m,
            solver: ellipsoid.geodesics(),
            centre: ellipsoid.in_space(lon, lat),
            ellipsoid,
        }
    }
}

/// A geodesic disk made ready for many questions.
pub(super) struct Reach {
    lon: f64,
    lat: f64,
    radius_m: f64,
    solver: crate::crs::Geodesics,
    centre: [f64; 3],
    ellipsoid: Ellipsoid,
}

impl Reach {
    /// Whether a longitude and latitude in degrees lie in the disk; not where one is not a number.
    pub(super) fn holds(&self, lon: f64, lat: f64) -> bool {
        if !(lon.is_finite() && (-90.0..=90.0).contains(&lat)) {
            return false;
        }
        // The chord is a lower bound of the geodesic; bent as strongly as the ellipsoid is anywhere, an upper one.
        let there = self.ellipsoid.in_space(lon, lat);
        let chord = (0..3).map(|i| (there[i] - self.centre[i]).powi(2)).sum::<f64>().sqrt();
        let slack = 1e-6 + 1e-9 * self.radius_m;
        if chord > self.radius_m + slack {
            return false;
        }
        let (a_m, b_m) = (self.ellipsoid.a_m, self.ellipsoid.b_m());
        let bend_m = (b_m * b_m / a_m).min(a_m * a_m / b_m);
        let sin = chord / (2.0 * bend_m);
        // Only nearby: far away a geodesic on an ellipsoid is no plane section.
        if sin < 0.1 && 2.0 * bend_m * sin.asin() < self.radius_m - slack {
            return true;
        }
        let apart = (lon - self.lon).rem_euclid(360.0);
        self.solver.distance_m(self.lat, lat, apart.min(360.0 - apart)) <= self.radius_m
    }

    /// Whether a latitude is within reach at any longitude.
    pub(super) fn holds_latitude(&self, lat: f64) -> bool {
        self.holds(self.lon, lat)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn disks_as_written() {
        assert_eq!(parse_disk("9.8, 46.8, 30km").unwrap(), (9.8, 46.8, 30_000.0));
        for text in ["", "9.8,46.8", "9.8,46.8,0", "9.8,46.8,-3km", "a,b,c", "1,2,3,4", "1,2,30parsecs", "nan,0,1km"] {
            assert!(parse_disk(text).is_err(), "{text} was taken for a disk");
        }
        assert!(Disk::geographic(46.8, 98.0, 1.0, Ellipsoid::WGS84).unwrap_err().message().contains("order"));
    }

    #[test]
    fn area_of_a_disk() {
        let whole = Disk::geographic(0.0, 90.0, 3e7, Ellipsoid::WGS84).unwrap().area_km2();
        assert!((whole / 510_065_621.7 - 1.0).abs() < 1e-3, "the globe: {whole}");
        let small = Disk::geographic(7.0, 46.0, 30_000.0, Ellipsoid::WGS84).unwrap().area_km2();
        let plane = Disk::planar(0.0, 0.0, 30_000.0, 0.3048).area_km2();
        assert!((plane - 900.0 * std::f64::consts::PI).abs() < 1e-9);
        assert!((small / plane - 1.0).abs() < 1e-5, "{small} {plane}");
    }

    #[test]
    fn peaks_without_a_place() {
        let disk = Disk::geographic(0.0, 0.0, 1000.0, Ellipsoid::WGS84).unwrap();
        let peaks = [PeakMeasures::default()];
        assert_eq!(disk.select(&peaks), None);
        assert_eq!(Disk::planar(1.0, 0.0, 1.0, 1.0).select(&peaks).unwrap().len(), 1, "the rim belongs");
    }

    proptest! {
        #[test]
        fn the_short_cuts_never_decide_wrongly(
            lat in -90.0..90.0_f64, azimuth in 0.0..360.0_f64, part in 0.0..3.0_f64, radius_m in 1.0..3e6_f64,
        ) {
            let e = Ellipsoid::WGS84;
            let disk = Disk::geographic(179.0, lat, radius_m, e).unwrap();
            // A place about `part` radii away in some direction.
            let (sin, cos) = azimuth.to_radians().sin_cos();
            let step = (part * radius_m / 111_000.0).min(170.0);
            let lat2 = (lat + step * cos).clamp(-90.0, 90.0);
            let lon2 = 179.0 + (step * sin / lat.to_radians().cos().max(0.01)).clamp(-179.0, 179.0);
            let apart = (lon2 - 179.0).abs();
            let slowly = e.geodesics().distance_m(lat, lat2, apart.min(360.0 - apart)) <= radius_m;
            prop_assert_eq!(disk.reach().holds(lon2, lat2), slowly);
        }
    }
}
