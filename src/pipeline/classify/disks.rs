//! Disks laid over a range, each with its features.

use super::ranges::Range;
use crate::classify::{Spot, features};
use crate::crs::{CrsKind, Ellipsoid};
use crate::error::Result;
use crate::orometry::distributions::{Disk, Domain, PeakMeasures, Selection};
use crate::watch::Watch;
use rayon::prelude::*;

/// A disk with what a forest looks at.
#[derive(Clone, Debug)]
pub(super) struct DiskRow {
    /// Where it is.
    pub(super) spot: Spot,
    /// Its centre: longitude and latitude in degrees in a geographic CRS, else easting and northing.
    pub(super) centre: (f64, f64),
    /// Number of its peaks.
    pub(super) peaks: usize,
    /// Its features.
    pub(super) row: Vec<f64>,
}

/// How disks are laid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Laying {
    /// Their radius in metres.
    pub(super) radius_m: f64,
    /// Fewest peaks of a disk.
    pub(super) min_peaks: usize,
}

/// Most places of the grid of one range; on more, disks are laid farther apart.
const MOST_PLACES: f64 = 1024.0;

/// What coordinates are measured with.
enum Ground {
    /// Metres in one unit of easting and northing.
    Plane(f64),
    /// Longitudes and latitudes in degrees.
    Globe(Ellipsoid),
}

/// The box of a range's peaks.
struct Bounds {
    /// West and south.
    least: (f64, f64),
    /// East and north.
    greatest: (f64, f64),
}

impl Ground {
    fn of(range: &Range) -> Self {
        match range.crs.as_ref().map(|crs| &crs.kind) {
            Some(CrsKind::Geographic { ellipsoid, .. }) => Self::Globe(*ellipsoid),
            Some(CrsKind::Projected { metres, .. } | CrsKind::Local { metres }) => Self::Plane(*metres),
            None => Self::Plane(1.0),
        }
    }

    /// The coordinates of a peak; longitudes are counted so that they are nearest to `first`'s.
    fn place(&self, peak: &PeakMeasures, first: &PeakMeasures) -> (f64, f64) {
        match self {
            Self::Plane(_) => (peak.x, peak.y),
            Self::Globe(_) => {
                let (lon, lat) = (peak.lon.unwrap_or(f64::NAN), peak.lat.unwrap_or(f64::NAN));
                let start = first.lon.unwrap_or(f64::NAN) - 180.0;
                (start + (lon - start).rem_euclid(360.0), lat)
            }
        }
    }

    /// Metres in a unit of the first and of the second coordinate, in the middle of a box.
    fn metres(&self, bounds: &Bounds) -> (f64, f64) {
        match self {
            Self::Plane(metres) => (*metres, *metres),
            Self::Globe(ellipsoid) => {
                let lat = f64::midpoint(bounds.least.1, bounds.greatest.1);
                let south = lat.min(89.5) - 0.5;
                let geodesics = ellipsoid.geodesics();
                // A hundredth of a degree of longitude is as good as straight, whatever the latitude.
                (geodesics.distance_m(lat, lat, 0.01) * 100.0, geodesics.distance_m(south, south + 1.0, 0.0))
            }
        }
    }

    fn disk(&self, (x, y): (f64, f64), radius_m: f64) -> Result<Disk> {
        match self {
            Self::Plane(metres) => Ok(Disk::planar(x, y, radius_m, *metres)),
            Self::Globe(ellipsoid) => Disk::geographic(x, y, radius_m, *ellipsoid),
        }
    }

    fn centre_m(&self, (x, y): (f64, f64)) -> [f64; 3] {
        match self {
            Self::Plane(metres) => [x * metres, y * metres, 0.0],
            Self::Globe(ellipsoid) => ellipsoid.in_space(x, y),
        }
    }
}

/// Places along one axis: all within a radius of neither end where there is room, else the middle.
fn places(least: f64, greatest: f64, radius: f64, step: f64) -> Vec<f64> {
    let room = greatest - least - 2.0 * radius;
    #[allow(clippy::cast_possible_truncation, reason = "laying counts them before")]
    let steps = if room > 0.0 { (room / step).floor() as i64 } else { 0 };
    let start = f64::midpoint(least, greatest) - steps as f64 * step / 2.0;
    (0..=steps).map(|i| start + i as f64 * step).collect()
}

impl Laying {
    /// The disks of a range that hold enough peaks, of which only the range's own count.
    ///
    /// Centres lie on a regular grid half a radius apart, farther where that would make very many, at least a radius
    /// inside the box of the peaks where there is room.
    ///
    /// # Errors
    /// [`crate::error::ErrorKind::Interrupted`] when the watch was cancelled.
    pub(super) fn lay(&self, range: &Range, number: usize, watch: &Watch) -> Result<Vec<DiskRow>> {
        let ground = Ground::of(range);
        let Some(first) = range.peaks.first() else { return Ok(vec![]) };
        let start = ground.place(first, first);
        let mut bounds = Bounds { least: start, greatest: start };
        for (x, y) in range.peaks.iter().map(|peak| ground.place(peak, first)) {
            bounds.least = (bounds.least.0.min(x), bounds.least.1.min(y));
            bounds.greatest = (bounds.greatest.0.max(x), bounds.greatest.1.max(y));
        }
        let metres = ground.metres(&bounds);
        let sides_m =
            [(bounds.greatest.0 - bounds.least.0) * metres.0, (bounds.greatest.1 - bounds.least.1) * metres.1];
        let mut step_m = self.radius_m / 2.0;
        let count = |step_m: f64| {
            let along = |side_m: f64| ((side_m - 2.0 * self.radius_m).max(0.0) / step_m).floor() + 1.0;
            along(sides_m[0]) * along(sides_m[1])
        };
        while count(step_m) > MOST_PLACES {
            step_m *= 1.25;
        }
        let axis =
            |least: f64, greatest: f64, metres: f64| places(least, greatest, self.radius_m / metres, step_m / metres);
        let columns = axis(bounds.least.0, bounds.greatest.0, metres.0);
        let rows = axis(bounds.least.1, bounds.greatest.1, metres.1);
        let all: Vec<((i64, i64), (f64, f64))> = (0_i64..)
            .zip(&rows)
            .flat_map(|(row, &y)| (0_i64..).zip(&columns).map(move |(col, &x)| ((col, row), (x, y))))
            .collect();
        let found: Vec<Option<DiskRow>> = all
            .into_par_iter()
            .map(|(place, centre)| {
                watch.advance(0)?;
                let disk = ground.disk(centre, self.radius_m)?;
                let measured = self.measure(&Selection::Disk(String::new(), disk), &range.peaks)?;
                Ok(measured.map(|(peaks, row)| DiskRow {
                    spot: Spot { range: number, place, centre_m: ground.centre_m(centre) },
                    centre,
                    peaks,
                    row,
                }))
            })
            .collect::<Result<_>>()?;
        Ok(found.into_iter().flatten().collect())
    }

    /// Number of peaks and features of a disk; `None` where it holds too few.
    ///
    /// # Errors
    /// As [`Selection::select`].
    pub(super) fn measure(&self, disk: &Selection, peaks: &[PeakMeasures]) -> Result<Option<(usize, Vec<f64>)>> {
        // Most disks of a wide box are empty: that is soon seen.
        let count = disk.select(peaks)?.len();
        if count < self.min_peaks.max(1) {
            return Ok(None);
        }
        let domain = Domain::measure(disk, peaks, self.radius_m, None, None)?;
        Ok(Some((count, features(&domain))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::Crs;

    fn range(places: &[(f64, f64)], geographic: bool) -> Range {
        let kind = CrsKind::Geographic { ellipsoid: Ellipsoid::WGS84, degrees: 1.0 };
        let crs = Crs {
            wkt: String::new(),
            name: String::new(),
            authority: None,
            kind,
            projection: None,
            vertical_unit: None,
        };
        let peak = |&(x, y): &(f64, f64)| PeakMeasures {
            elevation_m: 100.0 + y,
            prominence_m: 50.0,
            ..PeakMeasures::default().at((x, y), geographic.then_some((x, y)))
        };
        Range { name: "a".into(), peaks: places.iter().map(peak).collect(), crs: geographic.then_some(crs) }
    }

    fn lay(range: &Range, radius_m: f64, min_peaks: usize) -> Vec<DiskRow> {
        Laying { radius_m, min_peaks }.lay(range, 3, &Watch::default()).unwrap()
    }

    #[test]
    fn a_regular_grid_inside_the_box() {
        let peaks: Vec<(f64, f64)> = (0..121).map(|i| (f64::from(i % 11), f64::from(i / 11))).collect();
        let disks = lay(&range(&peaks, false), 2.0, 1);
        assert_eq!(disks.len(), 49);
        assert_eq!((disks[0].centre, disks[48].centre), ((2.0, 2.0), (8.0, 8.0)));
        assert_eq!((disks[1].spot.place, disks[1].spot.range, disks[7].spot.place), ((1, 0), 3, (0, 1)));
        assert!(disks.iter().all(|disk| disk.peaks == 13), "rims belong to disks");
        assert_eq!(lay(&range(&peaks, false), 2.0, 14).len(), 0);
        let narrow = lay(&range(&peaks, false), 6.0, 1);
        assert_eq!((narrow.len(), narrow[0].centre), (1, (5.0, 5.0)));
        assert!(lay(&range(&peaks, false), 0.01, 0).len() <= 1024, "no disk without a peak, and not too many places");
        assert!(lay(&range(&[], false), 1.0, 0).is_empty());
    }

    #[test]
    fn over_the_antimeridian_and_near_a_pole() {
        let peaks: Vec<(f64, f64)> =
            (0..400).map(|i| (179.5 + f64::from(i % 20) / 20.0, 60.0 + f64::from(i / 20) / 40.0)).collect();
        let turned: Vec<(f64, f64)> = peaks.iter().map(|&(x, y)| (if x > 180.0 { x - 360.0 } else { x }, y)).collect();
        let [disks, same] = [&peaks, &turned].map(|peaks| lay(&range(peaks, true), 8000.0, 5));
        assert!(disks.len() > 30, "{}", disks.len());
        assert_eq!(disks.len(), same.len());
        for (a, b) in disks.iter().zip(&same) {
            assert_eq!((a.peaks, &a.row), (b.peaks, &b.row));
        }
        let step_m = |a: &DiskRow, b: &DiskRow| {
            (0..3).map(|i| (a.spot.centre_m[i] - b.spot.centre_m[i]).powi(2)).sum::<f64>().sqrt()
        };
        assert!((step_m(&disks[0], &disks[1]) / 4000.0 - 1.0).abs() < 0.02, "{}", step_m(&disks[0], &disks[1]));
        let pole: Vec<(f64, f64)> = (0..36).map(|i| (f64::from(i) * 10.0, 89.9)).collect();
        assert!(!lay(&range(&pole, true), 20_000.0, 5).is_empty());
    }
}
