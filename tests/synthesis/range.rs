//! Ranges that are made up.

use orograph::crs::Planar;
use orograph::grid::GeoTransform;
use orograph::orometry::distributions::{Domain, PeakMeasures, Selection};
use orograph::rng::Rng;
use orograph::synthesis::Target;
use proptest::prelude::*;

/// The radius that distances are divided by, in metres.
pub const RADIUS_M: f64 = 30_000.0;
/// The least prominence, in metres.
pub const THRESHOLD_M: f64 = 30.0;

/// The metric of square cells of so many metres.
pub fn cells(cell_m: f64) -> Planar {
    Planar::new(&GeoTransform([0.0, cell_m, 0.0, 0.0, 0.0, -cell_m]), 1.0)
}

/// The statistics of peaks on so many square kilometres.
pub fn domain(peaks: &[PeakMeasures], area_km2: f64) -> Domain {
    Domain::measure(&Selection::Whole, peaks, RADIUS_M, None, Some(area_km2)).expect("a domain")
}

pub fn target(domain: &Domain) -> Target {
    Target::of(domain, RADIUS_M, Some(THRESHOLD_M)).expect("a target")
}

/// Peaks as a range may have them: many with little prominence, some with much, the highest with all of its height.
pub fn peaks(count: usize, from_m: f64, to_m: f64, spacing_m: f64, seed: u64) -> Vec<PeakMeasures> {
    let mut rng = Rng::new(seed);
    let mut peaks: Vec<PeakMeasures> = (0..count)
        .map(|_| {
            let elevation_m = rng.between(from_m, to_m);
            let part = rng.unit() * rng.unit();
            PeakMeasures {
                elevation_m,
                prominence_m: (THRESHOLD_M + 400.0 * part * part).min(elevation_m),
                isolation_m: Some(spacing_m * (0.3 + part * 2.0 + rng.unit())),
                isolation_azimuth: Some(rng.between(0.0, 360.0)),
                ..PeakMeasures::default()
            }
        })
        .collect();
    peaks.sort_by(|a, b| b.elevation_m.total_cmp(&a.elevation_m));
    if let Some(highest) = peaks.first_mut() {
        (highest.prominence_m, highest.isolation_m, highest.isolation_azimuth) = (highest.elevation_m, None, None);
    }
    peaks
}

/// Any range of a few peaks.
pub fn any() -> impl Strategy<Value = Vec<PeakMeasures>> {
    (2..60_usize, 40.0..3000.0_f64, 1.0..4000.0_f64, 200.0..9000.0_f64, proptest::prelude::any::<u64>())
        .prop_map(|(count, from_m, range_m, spacing_m, seed)| peaks(count, from_m, from_m + range_m, spacing_m, seed))
}
