//! Classes of peaks by prominence, for synthesis in passes.

use super::metrics::Histograms;
use super::peaks::PeakMeasures;
use serde::{Deserialize, Serialize};

/// The peaks of a domain in four classes of falling prominence.
///
/// The bounds are the quantiles 14/15, 12/15 and 8/15 of the domain's prominences, so the classes hold about 1/15,
/// 2/15, 4/15 and 8/15 of the peaks (the passes of the program of Argudo et al. 2019). The set of a class *and all
/// above it* is the sum of the counts, as all classes share the bins and the domain's greatest values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProminenceClass {
    /// Least prominence of the class in metres; 0 for the last, which takes all that are left.
    pub from_m: f64,
    /// Prominence in metres that the class stays below; `None` for the first.
    pub to_m: Option<f64>,
    /// Peaks in the class.
    pub peak_count: u64,
    /// Histograms of these peaks alone, in the fine bins of the domain.
    pub metrics: Histograms,
}

/// Fifteenths of the peaks that are below each class.
const FIFTEENTHS: [usize; 3] = [14, 12, 8];

/// Bounds in metres of the classes, falling: a peak is in the first class whose bound its prominence reaches, else in
/// the last. The quantile `q` of `n` values is the one with `ceil(q n)` values before it.
pub(super) fn class_bounds(peaks: &[&PeakMeasures]) -> Option<[f64; 3]> {
    let mut prominences: Vec<f64> = peaks.iter().map(|p| p.prominence_m).collect();
    prominences.sort_by(f64::total_cmp);
    let last = prominences.len().checked_sub(1)?;
    Some(FIFTEENTHS.map(|f| prominences[(f * prominences.len()).div_ceil(15).min(last)]))
}

/// The class of a prominence: 0 is the most prominent.
pub(super) fn class_of(bounds: &[f64; 3], prominence_m: f64) -> usize {
    bounds.iter().position(|&bound| prominence_m >= bound).unwrap_or(bounds.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sizes(prominences: impl Iterator<Item = f64>) -> [usize; 4] {
        let peaks: Vec<PeakMeasures> =
            prominences.map(|prominence_m| PeakMeasures { prominence_m, ..PeakMeasures::default() }).collect();
        let peaks: Vec<&PeakMeasures> = peaks.iter().collect();
        let bounds = class_bounds(&peaks).unwrap();
        let mut sizes = [0; 4];
        peaks.iter().for_each(|p| sizes[class_of(&bounds, p.prominence_m)] += 1);
        sizes
    }

    #[test]
    fn sizes_of_the_classes() {
        assert_eq!(sizes((0..15).map(f64::from)), [1, 2, 4, 8]);
        assert_eq!(sizes((0..1500).rev().map(f64::from)), [100, 200, 400, 800]);
        assert_eq!(sizes((0..17).map(f64::from)), [1, 2, 4, 10]);
        assert_eq!(sizes((0..1).map(f64::from)), [1, 0, 0, 0]);
        assert_eq!(sizes((0..30).map(|_| 50.0)), [30, 0, 0, 0], "equals are not torn apart");
        assert_eq!(class_bounds(&[]), None);
    }
}
