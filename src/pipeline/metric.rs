//! Which distances a raster has.

use crate::crs::{Block, Crs, CrsKind, Geodesic, Metric, Place, Planar, Surface, Vector};
use crate::error::{Error, Result};
use crate::grid::GeoTransform;
use crate::io::raster::Dem;
use crate::io::transform::OwnGeographic;

/// How to measure distances on a projected raster.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Distance {
    /// In the plane of a projected CRS, on the ellipsoid of a geographic one.
    #[default]
    Crs,
    /// On the ellipsoid always.
    Geodesic,
}

/// The metric of a raster.
pub enum AnyMetric<'a> {
    /// Of the plane.
    Planar(Planar),
    /// Of the ellipsoid under a geographic grid.
    Geodesic(Geodesic),
    /// Of the ellipsoid under a projected grid.
    Surface(Surface<'a>),
}

/// Evaluates the same generic code with whichever metric there is.
#[macro_export]
macro_rules! with_metric {
    ($any:expr, $metric:ident => $body:expr) => {
        match $any {
            $crate::pipeline::AnyMetric::Planar($metric) => $body,
            $crate::pipeline::AnyMetric::Geodesic($metric) => $body,
            $crate::pipeline::AnyMetric::Surface($metric) => $body,
        }
    };
}

/// The metric of a DEM; `to_geographic` is needed for [`Distance::Geodesic`] on a projected one.
///
/// # Errors
/// A geographic grid that is rotated or reaches beyond a pole; geodesic distances where there is no ellipsoid.
pub fn metric_of<'a>(dem: &Dem, distance: Distance, to_geographic: Option<&'a OwnGeographic>) -> Result<AnyMetric<'a>> {
    let size = (dem.grid.rows(), dem.grid.cols());
    metric_on(&dem.transform, size, dem.grid.wraps(), dem.crs.as_ref(), distance, to_geographic)
}

/// The metric of a raster of so many rows and columns that need not be in a file.
///
/// # Errors
/// As [`metric_of`].
pub(super) fn metric_on<'a>(
    transform: &GeoTransform,
    (rows, cols): (usize, usize),
    wraps: bool,
    crs: Option<&Crs>,
    distance: Distance,
    to_geographic: Option<&'a OwnGeographic>,
) -> Result<AnyMetric<'a>> {
    match crs.map(|crs| &crs.kind) {
        Some(CrsKind::Geographic { ellipsoid, degrees }) => {
            Geodesic::new(ellipsoid, transform, *degrees, rows, cols, wraps).map(AnyMetric::Geodesic)
        }
        Some(CrsKind::Projected { ellipsoid, .. }) if distance == Distance::Geodesic => {
            let to_geographic = to_geographic.expect("the caller made one for a projected raster");
            Ok(AnyMetric::Surface(Surface::new(transform, ellipsoid, to_geographic, rows, cols)))
        }
        _ if distance == Distance::Geodesic => {
            Err(Error::usage("--distance geodesic needs a raster with a CRS on an ellipsoid; assign one with --crs"))
        }
        _ => Ok(AnyMetric::Planar(Planar::new(transform, crs.map_or(1.0, Crs::linear_unit_m)))),
    }
}

/// Width and height of a cell in the middle of a raster of so many rows, in metres.
pub(super) fn cell_m(rows: usize, metric: &impl Metric) -> [f64; 2] {
    let middle = rows as i64 / 2;
    [metric.distance_m((middle, 0), (middle, 1)), metric.distance_m((middle, 0), (middle + 1, 0))]
}

impl Metric for AnyMetric<'_> {
    fn distance_m(&self, p: Place, q: Place) -> f64 {
        with_metric!(self, metric => metric.distance_m(p, q))
    }

    fn vector(&self, p: Place, q: Place) -> Vector {
        with_metric!(self, metric => metric.vector(p, q))
    }

    fn near2(&self, p: Place, q: Place) -> f64 {
        with_metric!(self, metric => metric.near2(p, q))
    }

    fn block2(&self, p: Place, block: &Block) -> f64 {
        with_metric!(self, metric => metric.block2(p, block))
    }

    fn reach2(&self, near2: f64) -> f64 {
        with_metric!(self, metric => metric.reach2(near2))
    }

    fn outside_m(&self, p: Place, rows: i64, cols: i64, limit_m: f64) -> Option<f64> {
        with_metric!(self, metric => metric.outside_m(p, rows, cols, limit_m))
    }

    fn is_alike_along_rows(&self) -> bool {
        with_metric!(self, metric => metric.is_alike_along_rows())
    }

    fn is_whole_globe(&self, rows: i64) -> bool {
        with_metric!(self, metric => metric.is_whole_globe(rows))
    }
}
