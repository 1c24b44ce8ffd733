//! Geodesics between the cells of a grid of longitudes and latitudes.
//!
//! The searches use the chord through the ellipsoid: a lower bound of the geodesic that knows no antimeridian and
//! no pole, cheap as it needs two tables only. With `(X, Z)` the meridian coordinates of a row and `w` the
//! difference in longitude, `chord² = (X1 - X2)² + (Z1 - Z2)² + 4 X1 X2 sin²(w / 2)`.

use super::ellipsoid::{Ellipsoid, Geodesics};
use super::metric::{Block, Metric, Place, SLACK, Vector};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::GeoTransform;

/// Distances on the ellipsoid of a geographic CRS.
#[derive(Clone, Debug)]
pub struct Geodesic {
    solver: Geodesics,
    /// Latitude in degrees of the rows from -1 to `rows`; those beyond a pole are NaN.
    lat: Vec<f64>,
    /// Meridian coordinates of the same rows in metres.
    meridian: Vec<(f64, f64)>,
    /// Squared sine of half the longitude between columns that are this many apart.
    sin2: Vec<f64>,
    /// Degrees of longitude from one column to the next.
    step: f64,
    /// Columns in 360 degrees, where the grid wraps.
    around: Option<i64>,
    ellipsoid: Ellipsoid,
    lat0: f64,
    lat_step: f64,
}

/// How far a row may lie beyond 90 degrees before it is no place: rounding in a geotransform.
const POLE_SLACK: f64 = 1e-7;

impl Geodesic {
    /// The metric of a grid of `rows` times `cols` cells with axis-parallel rows and columns; coordinates are in
    /// units of `degrees` degrees; `wraps` says that the columns span 360 degrees.
    ///
    /// # Errors
    /// When the grid is rotated, or a row lies beyond a pole.
    pub fn new(
        ellipsoid: &Ellipsoid,
        transform: &GeoTransform,
        degrees: f64,
        rows: usize,
        cols: usize,
        wraps: bool,
    ) -> Result<Self> {
        if !transform.is_axis_parallel() {
            return Err(Error::new(
                ErrorKind::Unsupported,
                "the grid of longitudes and latitudes is rotated; resample it to a north-up one first, for example with gdalwarp",
            ));
        }
        let step = (transform.0[1] * degrees).abs();
        let lat_of = |row: f64| {
            let lat = transform.centre(row, 0.0).1 * degrees;
            // A row that misses the pole by rounding only is the pole.
            if (lat.abs() - 90.0).abs() < POLE_SLACK { 90.0_f64.copysign(lat) } else { lat }
        };
        for row in [0, rows - 1] {
            let lat = lat_of(row as f64);
            if lat.abs() > 90.0 {
                return Err(Error::new(
                    ErrorKind::Unsupported,
                    format!(
                        "row {row} lies at latitude {lat}, beyond the pole; check the geotransform, or assign the right CRS with --crs"
                    ),
                ));
            }
        }
        let lat: Vec<f64> = (-1..=rows as i64)
            .map(|row| lat_of(row as f64))
            .map(|lat| if lat.abs() > 90.0 { f64::NAN } else { lat })
            .collect();
        let meridian = lat.iter().map(|&lat| ellipsoid.meridian(lat)).collect();
        let sin2 =
            (0..=cols + 1).map(|dc| (dc as f64 * step).to_radians() / 2.0).map(|half| half.sin().powi(2)).collect();
        Ok(Self {
            solver: ellipsoid.geodesics(),
            lat,
            meridian,
            sin2,
            step,
            around: wraps.then_some(cols as i64),
            ellipsoid: *ellipsoid,
            lat0: lat_of(0.0),
            lat_step: transform.0[5] * degrees,
        })
    }

    #[inline]
    fn apart(&self, p: Place, q: Place) -> i64 {
        (p.1 - q.1).abs()
    }

    /// Degrees of longitude between columns that are `apart` columns apart, 0 to 180.
    fn dlon(&self, apart: i64) -> f64 {
        let apart = match self.around {
            Some(around) => apart.min(around - apart),
            None => apart,
        };
        let dlon = (apart as f64 * self.step) % 360.0;
        dlon.min(360.0 - dlon)
    }

    #[inline]
    fn lat(&self, row: i64) -> f64 {
        self.lat[(row + 1) as usize]
    }

    #[inline]
    fn meridian(&self, row: i64) -> (f64, f64) {
        self.meridian[(row + 1) as usize]
    }

    #[inline]
    fn chord2(a: (f64, f64), b: (f64, f64), sin2: f64) -> f64 {
        let (dx, dz) = (a.0 - b.0, a.1 - b.1);
        dx * dx + dz * dz + 4.0 * a.0 * b.0 * sin2
    }

    /// Distance from a latitude to another, `apart` columns away; one place at the poles.
    fn between(&self, lat1: f64, lat2: f64, apart: i64) -> (f64, f64) {
        if lat1 == lat2 && (apart == 0 || lat1.abs() == 90.0) {
            return (0.0, f64::NAN);
        }
        self.solver.inverse(lat1, lat2, self.dlon(apart))
    }
}

impl Metric for Geodesic {
    fn distance_m(&self, p: Place, q: Place) -> f64 {
        self.between(self.lat(p.0), self.lat(q.0), self.apart(p, q)).0
    }

    fn vector(&self, p: Place, q: Place) -> Vector {
        let apart = self.apart(p, q);
        let (distance_m, azimuth) = self.between(self.lat(p.0), self.lat(q.0), apart);
        // The solver saw the second place in the east; which way round is shorter depends on the columns.
        let short = (apart as f64 * self.step) % 360.0 <= 180.0;
        let east = (q.1 >= p.1) == short;
        let azimuth = if east || azimuth == 0.0 { azimuth } else { 360.0 - azimuth };
        Vector { distance_m, azimuth }
    }

    #[inline]
    fn near2(&self, p: Place, q: Place) -> f64 {
        Self::chord2(self.meridian(p.0), self.meridian(q.0), self.sin2[self.apart(p, q) as usize])
    }

    #[inline]
    fn block2(&self, p: Place, block: &Block) -> f64 {
        let here = self.meridian(p.0);
        let row = p.0.clamp(block.rows.0, block.rows.1);
        let near = self.meridian(row);
        let along = (here.0 - near.0).powi(2) + (here.1 - near.1).powi(2);
        let (c0, c1) = block.cols;
        if (c0..=c1).contains(&p.1) {
            return along;
        }
        // The squared sine rises up to 180 degrees and falls after: its least value is at an end of the columns.
        let sin2 = self.sin2[(c0 - p.1).unsigned_abs() as usize].min(self.sin2[(c1 - p.1).unsigned_abs() as usize]);
        let least_x = self.meridian(block.rows.0).0.min(self.meridian(block.rows.1).0);
        (along + 4.0 * here.0 * least_x * sin2) / SLACK
    }

    #[inline]
    fn reach2(&self, near2: f64) -> f64 {
        self.ellipsoid.reach2(near2)
    }

    fn outside_m(&self, p: Place, rows: i64, cols: i64, limit_m: f64) -> Option<f64> {
        let mut best = limit_m;
        let lat1 = self.lat(p.0);
        for row in [-1, rows] {
            let lat = self.lat(row);
            if !lat.is_nan() && Self::chord2(self.meridian(p.0), self.meridian(row), 0.0) <= best * best * SLACK {
                best = best.min(self.between(lat1, lat, 0).0);
            }
        }
        if self.around.is_some() {
            return (best < limit_m).then_some(best);
        }
        let here = self.meridian(p.0);
        for col in [-1, cols] {
            let apart = self.apart(p, (0, col));
            // sin w >= w (1 - w²/6), so the plane of the other meridian is at least so far; cheap, and mostly enough.
            let w = (apart as f64 * self.step).to_radians();
            if w < 1.5 && here.0 * w * (1.0 - w * w / 6.0) > best * SLACK {
                continue;
            }
            let dlon = self.dlon(apart);
            let sin2 = (dlon.to_radians() / 2.0).sin().powi(2);
            // The nearest place of a column may lie in any row, towards the pole, in the raster or beyond it.
            for down in [false, true] {
                let mut row = if down { p.0 } else { p.0 - 1 };
                loop {
                    let lat =
                        if (-1..=rows).contains(&row) { self.lat(row) } else { self.lat0 + row as f64 * self.lat_step };
                    if lat.is_nan() || lat.abs() > 90.0 {
                        break;
                    }
                    let there = self.ellipsoid.meridian(lat);
                    let limit2 = best * best * SLACK;
                    if Self::chord2(here, there, 0.0) > limit2 {
                        break;
                    }
                    if Self::chord2(here, there, sin2) <= limit2 {
                        best = best.min(self.between(lat1, lat, apart).0);
                    }
                    row += if down { 1 } else { -1 };
                }
            }
        }
        (best < limit_m).then_some(best)
    }

    fn is_whole_globe(&self, rows: i64) -> bool {
        self.around.is_some() && self.lat(-1).is_nan() && self.lat(rows).is_nan()
    }
}
