//! What a forest looks at: the shares of the bins of a disk's histograms.

use crate::orometry::distributions::{BinSet, Domain, Measure};
use serde::{Deserialize, Serialize};

/// A histogram whose shares are features.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Feature {
    /// Name of the measure that is counted.
    pub metric: String,
    /// Number of its bins.
    pub bins: usize,
}

/// The histograms that make up a row of features, in its order: the ten of the paper's table 1 in the paper's bins.
pub fn table() -> Vec<Feature> {
    let bins = |measure| BinSet::Paper.edges(measure, (0.0, 0.0)).map_or(0, |edges| edges.len() - 1);
    Measure::TABLE_1.map(|measure| Feature { metric: measure.name().into(), bins: bins(measure) }).into()
}

/// The row of features of a domain: the share of each bin of [`table`], 0 everywhere where nothing was counted.
///
/// These are the paper's, and no more, for reasons: shares say nothing of how many peaks there are, and no measure is a
/// plain elevation, so that neither the threshold of prominence nor the height of the land decides; a range made up
/// elsewhere can then be like a real one. The coarse bins are those of table 1: a disk has some ten to a hundred peaks,
/// which would leave most of the finer bins empty. Isolations and saddle distances are divided by the radius that the
/// domain was measured with, which must be that of the disk.
pub fn features(domain: &Domain) -> Vec<f64> {
    let shares = |measure| domain.metrics.get(measure).paper.as_ref().map_or(Vec::new(), |bins| bins.shares());
    Measure::TABLE_1.into_iter().flat_map(shares).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orometry::distributions::{PeakMeasures, Selection};

    #[test]
    fn shares_of_table_1() {
        let peak = |elevation_m, prominence_m| PeakMeasures { elevation_m, prominence_m, ..PeakMeasures::default() };
        let peaks = [peak(1000.0, 1000.0), peak(500.0, 50.0), peak(600.0, 30.0), peak(500.0, 40.0)];
        let row = features(&Domain::measure(&Selection::Whole, &peaks, 10_000.0, None, None).unwrap());
        let table = table();
        assert_eq!(row.len(), table.iter().map(|feature| feature.bins).sum::<usize>());
        assert_eq!((row.len(), table.len()), (176, 10));
        // Dominances: 1, 0.1, 0.05 and 0.08.
        assert_eq!((row[0], row[1], row[2], row[19]), (0.0, 0.5, 0.25, 0.25));
        let starts = |name: &str| -> usize {
            table.iter().take_while(|feature| feature.metric != name).map(|feature| feature.bins).sum()
        };
        let at = starts("prominence");
        assert_eq!((row[at], row[at + 10]), (0.75, 0.25));
        let at = starts("isolation_distance");
        assert!(row[at..at + 20].iter().all(|&share| share == 0.0), "none was given");
    }
}
