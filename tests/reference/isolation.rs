//! Isolation by looking at every cell.

use super::sweep::Raster;
use super::{Options, RefIsolation};
use orograph::crs::{Metric, Place};
use orograph::grid::Cell;

/// The distance from `p` to `q` if it can be less than `best_m`.
///
/// `near2` is a lower bound of the squared distance up to rounding; the room left here is ten times that.
fn distance_within(metric: &dyn Metric, p: Place, q: Place, best_m: f64) -> Option<f64> {
    (metric.near2(p, q) <= best_m * best_m * (1.0 + 1e-7)).then(|| metric.distance_m(p, q))
}

/// How far a peak is from higher ground, and from higher or unknown ground.
pub fn isolation(raster: &Raster, metric: &dyn Metric, peak: Cell, options: &Options) -> RefIsolation {
    let here = raster.place(peak);
    // By the index, so that the first of several as near is the one with the lowest index.
    let mut nearest: Option<(f64, Cell)> = None;
    for cell in raster.cells() {
        if raster.is_void(cell) || raster.key(cell) <= raster.key(peak) {
            continue;
        }
        let best_m = nearest.map_or(f64::INFINITY, |(d, _)| d);
        if let Some(d) = distance_within(metric, here, raster.place(cell), best_m).filter(|&d| d < best_m) {
            nearest = Some((d, cell));
        }
    }
    let isolation_m = nearest.map(|(d, _)| d);
    let unknown_m = nearest_unknown_m(raster, metric, here, options);
    let isolation_min_m = match (isolation_m, unknown_m) {
        (Some(known), Some(unknown)) => Some(known.min(unknown)),
        (known, unknown) => known.or(unknown),
    };
    RefIsolation {
        isolation_m,
        isolation_min_m,
        certain: isolation_min_m == isolation_m,
        azimuth: nearest.map_or(f64::NAN, |(_, cell)| metric.vector(here, raster.place(cell)).azimuth),
        higher: nearest.map(|(_, cell)| cell),
    }
}

/// The distance to the nearest unknown cell, in the raster or outside of it.
fn nearest_unknown_m(raster: &Raster, metric: &dyn Metric, here: Place, options: &Options) -> Option<f64> {
    let mut best_m = f64::INFINITY;
    if !options.nodata_is_sea {
        for cell in raster.cells().filter(|&cell| raster.is_void(cell)) {
            best_m = best_m.min(metric.distance_m(here, raster.place(cell)));
        }
    }
    let (metric, before, size) = match &options.frame {
        Some(frame) => (frame.metric, frame.before, (frame.size.0 as i64, frame.size.1 as i64)),
        None if raster.wraps => (metric, (1, 0), (raster.rows + 2, raster.cols)),
        None => (metric, (1, 1), (raster.rows + 2, raster.cols + 2)),
    };
    // Places are counted from the raster; the larger raster's own metric counts from its own first cell.
    let shift = if options.frame.is_some() { before } else { (0, 0) };
    for row in -before.0..size.0 - before.0 {
        for col in -before.1..size.1 - before.1 {
            if (0..raster.rows).contains(&row) && (0..raster.cols).contains(&col) {
                continue;
            }
            let (p, q) = ((here.0 + shift.0, here.1 + shift.1), (row + shift.0, col + shift.1));
            // Beyond a pole there is no place: the metric has no number for it.
            if !metric.near2(p, q).is_nan() {
                best_m = best_m.min(metric.distance_m(p, q));
            }
        }
    }
    best_m.is_finite().then_some(best_m)
}
