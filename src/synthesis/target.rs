//! What the peaks of a range are like, as far as synthesis wants to repeat it.

use super::strata::Strata;
use crate::error::{Error, ErrorKind, Result};
use crate::orometry::distributions::{Domain, Histogram, Measure};

/// The distributions that synthesised peaks are to have: those of a domain in the fine bins (Argudo et al. 2019,
/// section 5; the bins are those of the authors' program).
///
/// What a histogram of the whole domain says holds; the classes of prominence only say how the measures go together.
/// So a histogram that somebody edited need not be edited in every class too.
#[derive(Clone, Debug)]
pub struct Target {
    /// In metres.
    pub(super) elevation: Strata,
    /// In metres; cut at the least prominence that was counted.
    pub(super) prominence: Strata,
    /// Prominence over elevation.
    pub(super) dominance: Strata,
    /// Distance to the nearest higher peak in metres.
    pub(super) isolation: Strata,
    /// Azimuth of that peak in degrees clockwise from north.
    pub(super) direction: Strata,
    /// By how much the nearest higher peak is higher, in metres, of peaks by rising isolation; empty where nobody knows.
    pub(super) rises_m: Vec<f64>,
    /// The classes, by falling prominence; one that holds everything where the domain has none.
    pub(super) classes: Vec<Class>,
    /// Peaks of the domain.
    pub(super) peak_count: u64,
    /// Peaks on 100 square kilometres, where the area is known.
    pub(super) density_per_100_km2: Option<f64>,
}

/// What is known of the peaks of one class of prominence.
#[derive(Clone, Debug)]
pub(super) struct Class {
    /// Peaks in it.
    pub(super) weight: u64,
    /// Their elevations.
    pub(super) elevation: Strata,
    /// Their isolations in metres.
    pub(super) isolation: Strata,
}

impl Target {
    /// The distributions of a domain whose distances are divided by `radius_m`; `threshold_m` is the least prominence
    /// of its peaks.
    ///
    /// Its isolations should be those to the nearest higher *peak*, as those are what synthesis can give.
    ///
    /// # Errors
    /// `Input` when there are no peaks, or several and none with an isolation, and when a histogram is empty.
    pub fn of(domain: &Domain, radius_m: f64, threshold_m: Option<f64>) -> Result<Self> {
        let empty = |what: &str| {
            Err(Error::new(ErrorKind::Input, format!("the statistics of '{}' hold no {what}", domain.name)))
        };
        let whole = |measure: Measure| &domain.metrics.get(measure).fine;
        if domain.peak_count == 0 || whole(Measure::Elevation).total() == 0 {
            return empty("peaks: there is nothing to be like");
        }
        if whole(Measure::Prominence).total() == 0 {
            return empty("prominences");
        }
        if whole(Measure::IsolationDistance).total() == 0 && domain.peak_count > 1 {
            return empty("isolations: measure the range with them");
        }
        let (lowest_m, highest_m, greatest_m) = domain
            .extremes
            .map_or((f64::MIN, f64::MAX, f64::MAX), |e| (e.lowest_peak_m, e.highest_peak_m, e.greatest_prominence_m));
        let threshold_m = threshold_m.unwrap_or(0.0);
        let elevation = |histogram: &Histogram| Strata::of(histogram, 1.0);
        let isolation = |histogram: &Histogram| Strata::of(histogram, radius_m);
        let mut classes: Vec<Class> = domain
            .prominence_classes
            .iter()
            .filter(|class| class.peak_count > 0)
            .map(|class| Class {
                weight: class.peak_count,
                elevation: elevation(class.metrics.get(Measure::Elevation)),
                isolation: isolation(class.metrics.get(Measure::IsolationDistance)),
            })
            .collect();
        if classes.is_empty() {
            classes.push(Class {
                weight: 1,
                elevation: elevation(whole(Measure::Elevation)),
                isolation: isolation(whole(Measure::IsolationDistance)),
            });
        }
        Ok(Self {
            elevation: elevation(whole(Measure::Elevation)).within(lowest_m, highest_m),
            prominence: prominence(domain).within(threshold_m, greatest_m),
            dominance: Strata::of(whole(Measure::Dominance), 1.0),
            isolation: isolation(whole(Measure::IsolationDistance)),
            direction: Strata::of(whole(Measure::IsolationDirection), 1.0),
            rises_m: vec![],
            classes,
            peak_count: domain.peak_count,
            density_per_100_km2: domain.density_per_100_km2,
        })
    }

    /// The same, and by how much the nearest higher peak is higher: `rises_m` holds isolations and rises of peaks, in
    /// metres.
    ///
    /// Between close peaks the ground hardly falls, so a range has them at almost one elevation: if they are not, higher
    /// ground is much nearer than the higher peak.
    #[must_use]
    pub fn with_rises(mut self, mut rises_m: Vec<(f64, f64)>) -> Self {
        rises_m.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        self.rises_m = rises_m.into_iter().map(|(_, rise_m)| rise_m).collect();
        self
    }

    /// How many peaks so much land has, by the domain's density; as many as the domain has where that is not known.
    pub fn count_on(&self, area_km2: f64) -> usize {
        let count = self.density_per_100_km2.map_or(self.peak_count as f64, |density| density * area_km2 / 100.0);
        #[allow(clippy::cast_possible_truncation, reason = "rounded, and no machine holds as many")]
        let count = count.round().clamp(0.0, 1e12) as usize;
        count
    }
}

/// The prominences of a domain, in bins that the bounds of the classes part once more: most peaks have so little
/// prominence that the fine bins alone say little of them.
fn prominence(domain: &Domain) -> Strata {
    let whole = &domain.metrics.get(Measure::Prominence).fine;
    let mut sum = vec![0; whole.counts.len()];
    let mut bins = vec![];
    for class in domain.prominence_classes.iter().rev() {
        let histogram = class.metrics.get(Measure::Prominence);
        let to_m = class.to_m.unwrap_or(f64::INFINITY);
        for (i, (&count, edges)) in histogram.counts.iter().zip(histogram.edges.windows(2)).enumerate() {
            // Beyond the last edge lies a bound that only values have that count in the last bin.
            let (from, to) = (edges[0].max(class.from_m).min(edges[1]), edges[1].min(to_m));
            if count > 0 && from < to {
                sum[i.min(whole.counts.len() - 1)] += count;
                bins.push((from, to, count));
            }
        }
    }
    let increases = bins.windows(2).all(|pair: &[(f64, f64, u64)]| pair[0].1 <= pair[1].0);
    // Edited by hand: what the whole says holds.
    if sum == whole.counts && increases { Strata::of_bins(bins) } else { Strata::of(whole, 1.0) }
}
