//! Ellipsoids of revolution: geodesics and places in space.

use super::metric::SLACK;
use geographiclib_rs::{Geodesic as Karney, InverseGeodesic};

/// An ellipsoid of revolution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    /// Equatorial radius in metres.
    pub a_m: f64,
    /// Flattening; 0 for a sphere.
    pub flattening: f64,
}

impl Ellipsoid {
    /// The ellipsoid of WGS 84.
    pub const WGS84: Self = Self { a_m: 6_378_137.0, flattening: 1.0 / 298.257_223_563 };

    /// Semi-minor axis in metres.
    pub fn b_m(&self) -> f64 {
        self.a_m * (1.0 - self.flattening)
    }

    /// The solver of geodesics on this ellipsoid (Karney 2013, doi:10.1007/s00190-012-0578-z).
    pub fn geodesics(&self) -> Geodesics {
        Geodesics(Karney::new(self.a_m, self.flattening))
    }

    /// Distance from the axis and height above the equator's plane, in metres, of a point at a latitude.
    pub fn meridian(&self, lat: f64) -> (f64, f64) {
        if lat.abs() >= 90.0 {
            return (0.0, self.b_m().copysign(lat));
        }
        let e2 = self.flattening * (2.0 - self.flattening);
        let (sin, cos) = lat.to_radians().sin_cos();
        let n = self.a_m / (1.0 - e2 * sin * sin).sqrt();
        (n * cos, n * (1.0 - e2) * sin)
    }

    /// Earth-centred coordinates in metres of a point on the ellipsoid.
    pub fn in_space(&self, lon: f64, lat: f64) -> [f64; 3] {
        let (x, z) = self.meridian(lat);
        let (sin, cos) = lon.to_radians().sin_cos();
        [x * cos, x * sin, z]
    }

    /// An upper bound of the squared geodesic distance between points whose squared chord is known.
    ///
    /// A geodesic bends at most as a circle of the least radius of curvature r does; Schur's comparison theorem then
    /// bounds it by that circle's arc over the same chord, `2 r asin(c / 2 r) = c (1 + c²/24r² + 3c⁴/640r⁴ + ...)`,
    /// whose square stays below `c² (1 + c²/10r²)` up to `c = r`. Longer chords get the bound of the antipodes, half
    /// of a great circle over its diameter, with room for the flattening.
    #[inline]
    pub(super) fn reach2(&self, chord2: f64) -> f64 {
        let radius_m = self.b_m() * self.b_m() / self.a_m;
        let ratio = chord2 / (radius_m * radius_m);
        if ratio < 1.0 {
            return chord2 * (1.0 + ratio / 10.0) * SLACK + 1e-9;
        }
        let stretch = std::f64::consts::FRAC_PI_2 * (self.a_m / self.b_m()).powi(2);
        chord2 * stretch * stretch * SLACK
    }

    /// Area in square metres of one degree of longitude from the equator up to a latitude (negative southwards).
    pub fn area_per_degree_to(&self, lat: f64) -> f64 {
        // Authalic: q(lat) b^2 / 2 a radian (Snyder 1987, equation 3-12).
        let e2 = self.flattening * (2.0 - self.flattening);
        let sin = lat.clamp(-90.0, 90.0).to_radians().sin();
        let q = if e2 < 1e-12 {
            2.0 * sin
        } else {
            let e = e2.sqrt();
            (1.0 - e2) * (sin / (1.0 - e2 * sin * sin) + (e * sin).atanh() / e)
        };
        self.a_m * self.a_m * q / 2.0 * 1.0_f64.to_radians()
    }
}

/// Solver of the inverse geodesic problem on one ellipsoid.
#[derive(Clone, Copy, Debug)]
pub struct Geodesics(Karney);

impl Geodesics {
    /// Distance in metres and azimuth at the first point in degrees (0 to 180) between two latitudes that lie
    /// `dlon` degrees of longitude apart, the second in the east; `0 <= dlon <= 180`.
    ///
    /// Mirror pairs agree to the bit, as only the difference of the longitudes counts.
    pub fn inverse(&self, lat1: f64, lat2: f64, dlon: f64) -> (f64, f64) {
        let (s12, azi1, _, _): (f64, f64, f64, f64) = self.0.inverse(lat1, 0.0, lat2, dlon);
        (s12, azi1)
    }

    /// Distance in metres alone.
    pub fn distance_m(&self, lat1: f64, lat2: f64, dlon: f64) -> f64 {
        self.0.inverse(lat1, 0.0, lat2, dlon)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn area_of_the_earth() {
        let e = Ellipsoid::WGS84;
        let whole = 360.0 * (e.area_per_degree_to(90.0) - e.area_per_degree_to(-90.0));
        assert!((whole / 510_065_621_724_088.0 - 1.0).abs() < 1e-12, "{whole}");
    }

    #[test]
    fn chord_bounds_geodesic() {
        let e = Ellipsoid::WGS84;
        let g = e.geodesics();
        for (lat1, lat2, dlon) in [(10.0, 11.0, 0.5), (89.9, 89.8, 170.0), (-30.0, 30.0, 179.9), (45.0, 45.0, 1e-4)] {
            let (p, q) = (e.in_space(0.0, lat1), e.in_space(dlon, lat2));
            let chord = (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt();
            let d = g.distance_m(lat1, lat2, dlon);
            assert!(chord <= d && d <= chord * std::f64::consts::FRAC_PI_2 * 1.01, "{chord} {d}");
        }
    }
}
