//! Domains: which peaks belong together, and all that is measured of them.

use super::classes::{ProminenceClass, class_bounds, class_of};
use super::disk::{Disk, DiskOutline};
use super::measure::Frame;
use super::metrics::{Metrics, count, count_fine};
use super::peaks::PeakMeasures;
use super::terrain::Terrain;
use crate::error::{Error, ErrorKind, Result};
use serde::{Deserialize, Serialize};

/// What to take of a dataset.
#[derive(Clone, Debug, PartialEq)]
pub enum Selection {
    /// Everything.
    Whole,
    /// The peaks that stand in the region of this name.
    Region(String),
    /// The peaks in a disk, which is called by this name.
    Disk(String, Disk),
}

impl Selection {
    /// Name of the domain.
    pub fn name(&self) -> &str {
        match self {
            Self::Whole => "whole",
            Self::Region(name) | Self::Disk(name, _) => name,
        }
    }

    /// The selected peaks in their order.
    ///
    /// # Errors
    /// A usage error for a region that no peak stands in, and for a geodesic disk on peaks without longitudes.
    pub fn select<'a>(&self, peaks: &'a [PeakMeasures]) -> Result<Vec<&'a PeakMeasures>> {
        match self {
            Self::Whole => Ok(peaks.iter().collect()),
            Self::Region(name) => {
                let found: Vec<_> = peaks.iter().filter(|p| p.region.as_ref() == Some(name)).collect();
                if found.is_empty() && !peaks.is_empty() {
                    let known = region_names(peaks);
                    let known = if known.is_empty() { "no peak has a region".into() } else { known.join(", ") };
                    return Err(Error::usage(format!("no peak stands in a region called '{name}': {known}")));
                }
                Ok(found)
            }
            Self::Disk(name, disk) => disk.select(peaks).ok_or_else(|| {
                Error::usage(format!(
                    "the peaks have no longitudes and latitudes: give the disk {name} as x,y,radius in their CRS"
                ))
            }),
        }
    }
}

/// The regions that peaks stand in, by name.
pub fn region_names(peaks: &[PeakMeasures]) -> Vec<String> {
    let mut names: Vec<String> = peaks.iter().filter_map(|p| p.region.clone()).collect();
    names.sort();
    names.dedup();
    names
}

/// What kind of domain it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DomainKind {
    /// All of the input.
    Whole,
    /// A region.
    Region,
    /// A disk.
    Disk,
}

/// Where the area of a domain comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AreaFrom {
    /// The sum of its cells that have an elevation.
    Cells,
    /// Its outline, whatever part of it has no data.
    Outline,
}

/// The lowest, highest and most prominent peak of a domain, which relative measures are relative to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Extremes {
    /// Least elevation of a peak in metres.
    pub lowest_peak_m: f64,
    /// Greatest elevation of a peak in metres.
    pub highest_peak_m: f64,
    /// Greatest prominence in metres.
    pub greatest_prominence_m: f64,
    /// Whether that prominence is certain.
    pub greatest_prominence_certain: bool,
}

/// The statistics of one domain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Domain {
    /// Name, unlike that of any other domain of the document.
    pub name: String,
    /// What it is.
    pub kind: DomainKind,
    /// The disk, where it is one.
    pub disk: Option<DiskOutline>,
    /// Area in square kilometres, where it is known.
    pub area_km2: Option<f64>,
    /// What the area is the area of.
    pub area_from: Option<AreaFrom>,
    /// Number of peaks.
    pub peak_count: u64,
    /// Peaks on 100 square kilometres, where the area is known and not 0.
    pub density_per_100_km2: Option<f64>,
    /// Extremes; `None` without peaks.
    pub extremes: Option<Extremes>,
    /// The distributions.
    pub metrics: Metrics,
    /// Classes of falling prominence; none without peaks.
    pub prominence_classes: Vec<ProminenceClass>,
    /// Statistics of the terrain; `None` where the input was no DEM.
    pub terrain: Option<Terrain>,
}

impl Domain {
    /// Measures a domain of `peaks`; distances are divided by `radius_m`.
    ///
    /// `terrain` are the statistics of its cells, where there is a DEM; else `outline_km2` is the area of the
    /// region's polygon, where that is known (a disk's is computed).
    ///
    /// # Errors
    /// As [`Selection::select`].
    pub fn measure(
        selection: &Selection,
        peaks: &[PeakMeasures],
        radius_m: f64,
        terrain: Option<Terrain>,
        outline_km2: Option<f64>,
    ) -> Result<Self> {
        let peaks = selection.select(peaks)?;
        let frame = Frame::of(&peaks, radius_m);
        // Without peaks nothing is counted, and any frame does.
        let counted = frame.unwrap_or(Frame { lowest_m: 0.0, highest_m: 0.0, most_prominent_m: 0.0, radius_m });
        let (kind, disk) = match selection {
            Selection::Whole => (DomainKind::Whole, None),
            Selection::Region(_) => (DomainKind::Region, None),
            Selection::Disk(_, disk) => (DomainKind::Disk, Some(disk)),
        };
        let outline_km2 = outline_km2.or_else(|| disk.map(Disk::area_km2));
        let (area_km2, area_from) = match (&terrain, outline_km2) {
            (Some(terrain), _) => (Some(terrain.area_km2()), Some(AreaFrom::Cells)),
            (None, Some(area)) => (Some(area), Some(AreaFrom::Outline)),
            (None, None) => (None, None),
        };
        let peak_count = peaks.len() as u64;
        Ok(Self {
            name: selection.name().to_string(),
            kind,
            disk: disk.map(Disk::outline),
            area_km2,
            area_from,
            peak_count,
            density_per_100_km2: area_km2.filter(|&a| a > 0.0).map(|a| 100.0 * peak_count as f64 / a),
            extremes: frame.map(|frame| extremes(&peaks, &frame)),
            metrics: count(&peaks, &counted),
            prominence_classes: classes(&peaks, &counted),
            terrain,
        })
    }

    /// Checks the shape of all that is in it, as it must be to be read.
    ///
    /// # Errors
    /// Says which histogram has which fault.
    pub(super) fn check(&self) -> Result<()> {
        for (measure, statistics) in self.metrics.iter() {
            let place = |set: &str| format!("metrics.{}.{set}", measure.name());
            super::metrics::check(measure, &statistics.fine).map_err(|e| e.at_place(place("fine")))?;
            if let Some(paper) = &statistics.paper {
                super::metrics::check(measure, paper).map_err(|e| e.at_place(place("paper")))?;
            }
        }
        for (i, class) in self.prominence_classes.iter().enumerate() {
            for (measure, histogram) in class.metrics.iter() {
                let place = || format!("prominence_classes[{i}].metrics.{}", measure.name());
                super::metrics::check(measure, histogram).map_err(|e| e.at_place(place()))?;
            }
        }
        if let Some(terrain) = &self.terrain {
            terrain.hypsometry.check().map_err(|e| e.at_place("terrain.hypsometry"))?;
            terrain.slope.check().map_err(|e| e.at_place("terrain.slope"))?;
        }
        match self.area_km2.filter(|a| !(a.is_finite() && *a >= 0.0)) {
            Some(area) => Err(Error::new(ErrorKind::Corrupt, format!("{area} is not an area")).at_place("area_km2")),
            None => Ok(()),
        }
    }

    /// Checks that the numbers agree with each other, as they do in every document that a program wrote and nobody
    /// edited: each peak is counted or missing in every histogram, and the classes add up to the whole.
    ///
    /// # Errors
    /// Says what does not add up.
    pub fn check_sums(&self) -> Result<()> {
        let wrong = |place: String, message: String| Err(Error::new(ErrorKind::Corrupt, message).at_place(place));
        for (measure, statistics) in self.metrics.iter() {
            let name = measure.name();
            for histogram in [Some(&statistics.fine), statistics.paper.as_ref()].into_iter().flatten() {
                let (counted, missing) = (histogram.total(), statistics.missing);
                if counted + missing != self.peak_count || statistics.uncertain > counted {
                    return wrong(
                        format!("metrics.{name}"),
                        format!(
                            "{counted} counted ({} uncertain) and {missing} missing make not {} peaks",
                            statistics.uncertain, self.peak_count
                        ),
                    );
                }
            }
            let mut sum = vec![0; statistics.fine.counts.len()];
            for class in &self.prominence_classes {
                let counts = &class.metrics.get(measure).counts;
                sum.iter_mut().zip(counts).for_each(|(sum, n)| *sum += n);
            }
            if sum != statistics.fine.counts {
                return wrong(
                    format!("prominence_classes, metric {name}"),
                    "the counts do not add up to the domain's".into(),
                );
            }
        }
        Ok(())
    }
}

fn extremes(peaks: &[&PeakMeasures], frame: &Frame) -> Extremes {
    let certain = peaks.iter().any(|p| p.prominence_m == frame.most_prominent_m && p.prominence_certain);
    Extremes {
        lowest_peak_m: frame.lowest_m,
        highest_peak_m: frame.highest_m,
        greatest_prominence_m: frame.most_prominent_m,
        greatest_prominence_certain: certain,
    }
}

fn classes(peaks: &[&PeakMeasures], frame: &Frame) -> Vec<ProminenceClass> {
    let Some(bounds) = class_bounds(peaks) else { return vec![] };
    (0..=bounds.len())
        .map(|class| {
            let members: Vec<_> =
                peaks.iter().copied().filter(|p| class_of(&bounds, p.prominence_m) == class).collect();
            ProminenceClass {
                from_m: bounds.get(class).copied().unwrap_or(0.0),
                to_m: class.checked_sub(1).map(|above| bounds[above]),
                peak_count: members.len() as u64,
                metrics: count_fine(&members, frame),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::Measure;
    use super::*;
    use crate::crs::Ellipsoid;
    use proptest::prelude::*;

    /// The three peaks of the worked example in `format-spec/stats.md`.
    fn peaks() -> Vec<PeakMeasures> {
        let top = PeakMeasures {
            elevation_m: 4000.0,
            prominence_m: 4000.0,
            region: Some("north".into()),
            ..PeakMeasures::default()
        };
        let side = PeakMeasures {
            elevation_m: 3000.0,
            prominence_m: 1500.0,
            prominence_certain: true,
            saddle_distance_m: Some(6000.0),
            saddle_azimuth: Some(30.0),
            isolation_m: Some(45_000.0),
            isolation_azimuth: Some(359.9),
            isolation_certain: true,
            region: Some("south".into()),
            x: 10.0,
            ..PeakMeasures::default()
        };
        let hump = PeakMeasures {
            elevation_m: 2000.0,
            prominence_m: 30.0,
            prominence_certain: true,
            saddle_distance_m: Some(600.0),
            saddle_azimuth: Some(90.0),
            isolation_m: Some(1499.0),
            isolation_azimuth: Some(0.0),
            region: Some("south".into()),
            x: 20.0,
            ..PeakMeasures::default()
        };
        vec![top, side, hump]
    }

    fn filled(domain: &Domain, measure: Measure) -> Vec<(f64, u64)> {
        let h = domain.metrics.get(measure).paper.as_ref().unwrap();
        h.edges.iter().copied().zip(h.counts.iter().copied()).filter(|(_, n)| *n > 0).collect()
    }

    #[test]
    fn histograms_by_hand() {
        let domain = Domain::measure(&Selection::Whole, &peaks(), 30_000.0, None, Some(1500.0)).unwrap();
        domain.check().unwrap();
        domain.check_sums().unwrap();
        assert_eq!((domain.peak_count, domain.density_per_100_km2), (3, Some(0.2)));
        assert_eq!(domain.area_from, Some(AreaFrom::Outline));
        // 30/2000 = 0.015, 1500/3000 = 0.5, 1.
        assert_eq!(filled(&domain, Measure::Dominance), [(0.0, 1), (0.5, 1), (0.95, 1)]);
        assert_eq!(filled(&domain, Measure::DominanceGroups), [(0.014, 1), (0.49, 1), (0.882, 1)]);
        assert_eq!(filled(&domain, Measure::NormalisedElevation), [(0.0, 1), (0.5, 1), (0.95, 1)]);
        assert_eq!(filled(&domain, Measure::IsolationDirection), [(0.0, 1), (330.0, 1)]);
        assert_eq!(filled(&domain, Measure::IsolationDistance), [(0.0, 1), (0.95, 1)], "45 km are beyond R");
        assert_eq!(filled(&domain, Measure::SaddleDirection), [(30.0, 1), (90.0, 1)]);
        assert_eq!(filled(&domain, Measure::SaddleDistance), [(0.0, 1), (0.2, 1)]);
        assert_eq!(filled(&domain, Measure::Prominence), [(0.0, 1), (1500.0, 1), (1900.0, 1)]);
        // 30/4000 = 0.0075, 1500/4000 = 0.375, 1.
        assert_eq!(filled(&domain, Measure::RelativeProminence), [(0.0, 1), (0.35, 1), (0.95, 1)]);
        // sqrt(0.0075 * 0.5) = 0.061, sqrt(0.375 * 0.75) = 0.530, 1.
        assert_eq!(filled(&domain, Measure::Relevance), [(0.05, 1), (0.5, 1), (0.95, 1)]);
        let of = |m| {
            let s = domain.metrics.get(m);
            (s.missing, s.uncertain, s.fine.above)
        };
        assert_eq!(of(Measure::Prominence), (0, 1, 1), "the root is uncertain and beyond 2100 m");
        assert_eq!(of(Measure::IsolationDistance), (1, 1, 1));
        assert_eq!(of(Measure::Elevation), (0, 0, 0));
        assert_eq!(domain.metrics.get(Measure::Elevation).paper, None);
        let classes: Vec<_> = domain.prominence_classes.iter().map(|c| (c.from_m, c.to_m, c.peak_count)).collect();
        let bound = Some(4000.0);
        assert_eq!(classes, [(4000.0, None, 1), (4000.0, bound, 0), (4000.0, bound, 0), (0.0, bound, 2)]);
    }

    #[test]
    fn a_region_has_its_own_greatest_values() {
        let south = Selection::Region("south".into());
        let domain = Domain::measure(&south, &peaks(), 30_000.0, None, None).unwrap();
        assert_eq!(domain.peak_count, 2);
        assert_eq!(filled(&domain, Measure::RelativeProminence), [(0.0, 1), (0.95, 1)]);
        assert_eq!(filled(&domain, Measure::NormalisedElevation), [(0.0, 1), (0.95, 1)]);
        let extremes = domain.extremes.unwrap();
        assert_eq!((extremes.highest_peak_m, extremes.greatest_prominence_m), (3000.0, 1500.0));
        assert!(extremes.greatest_prominence_certain);
        let error = Selection::Region("west".into()).select(&peaks()).unwrap_err();
        assert!(error.message().contains("'west': north, south"), "{error}");
    }

    #[test]
    fn disks_select_by_place() {
        let disk = |d| Selection::Disk("d".into(), d);
        let near = disk(Disk::planar(12.0, 0.0, 5.0, 1.0));
        let domain = Domain::measure(&near, &peaks(), 30_000.0, None, None).unwrap();
        assert_eq!((domain.peak_count, domain.extremes.unwrap().highest_peak_m), (1, 3000.0));
        assert!((domain.area_km2.unwrap() - 25e-6 * std::f64::consts::PI).abs() < 1e-15);
        let geodesic = disk(Disk::geographic(0.0, 0.0, 1e6, Ellipsoid::WGS84).unwrap());
        let error = geodesic.select(&peaks()).unwrap_err();
        assert!(error.message().contains("x,y,radius"), "{error}");
    }

    #[test]
    fn a_domain_without_peaks() {
        let nowhere = Selection::Disk("n".into(), Disk::planar(-1e6, 0.0, 5.0, 1.0));
        let domain = Domain::measure(&nowhere, &peaks(), 30_000.0, None, None).unwrap();
        assert_eq!((domain.peak_count, domain.extremes, domain.prominence_classes.len()), (0, None, 0));
        domain.check().unwrap();
        domain.check_sums().unwrap();
    }

    proptest! {
        #[test]
        fn each_peak_is_counted_or_missing(
            rows in prop::collection::vec(
                (-3000.0..9000.0_f64, 0.0..9000.0_f64, any::<bool>(),
                 prop::option::of((0.0..1e5_f64, 0.0..360.0_f64)), prop::option::of((0.0..1e6_f64, 0.0..360.0_f64))),
                0..60,
            )
        ) {
            let peaks: Vec<PeakMeasures> = rows.iter().map(|&(elevation_m, prominence_m, certain, saddle, isolation)| {
                PeakMeasures {
                    elevation_m,
                    prominence_m,
                    prominence_certain: certain,
                    saddle_distance_m: saddle.map(|s| s.0),
                    saddle_azimuth: saddle.map(|s| s.1),
                    isolation_m: isolation.map(|i| i.0),
                    isolation_azimuth: isolation.map(|i| i.1),
                    isolation_certain: !certain && isolation.is_some(),
                    ..PeakMeasures::default()
                }
            }).collect();
            let domain = Domain::measure(&Selection::Whole, &peaks, 30_000.0, None, None).unwrap();
            prop_assert!(domain.check().is_ok());
            prop_assert!(domain.check_sums().is_ok(), "{}", domain.check_sums().unwrap_err());
            let no_saddle = rows.iter().filter(|r| r.3.is_none()).count() as u64;
            prop_assert_eq!(domain.metrics.get(Measure::SaddleDistance).missing, no_saddle);
            let elevations = &domain.metrics.get(Measure::Elevation).fine;
            prop_assert_eq!(elevations.below + elevations.above, 0);
        }
    }
}
