//! Histograms as what numbers are drawn from, stratum by stratum.

use crate::orometry::distributions::Histogram;
use crate::rng::Rng;

/// A row of bins with the weights that numbers are drawn by.
///
/// Independent draws would scatter about the weights by the root of their number, which at 1000 draws alone is an error
/// of 1 to 2 % in a bin. Here every bin gets its share to within one draw, and draws lie evenly inside their bin.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Strata {
    /// Edges of the bins, increasing; one more than there are bins.
    edges: Vec<f64>,
    /// Weight of each bin.
    weights: Vec<u64>,
}

impl Strata {
    /// The bins of a histogram whose values are `unit` of what is drawn.
    pub(super) fn of(histogram: &Histogram, unit: f64) -> Self {
        let edges = histogram.edges.iter().map(|edge| edge * unit).collect();
        Self { edges, weights: histogram.counts.clone() }
    }

    /// Bins given one by one: first edge, last edge, weight. They must increase and may leave gaps.
    pub(super) fn of_bins(bins: impl IntoIterator<Item = (f64, f64, u64)>) -> Self {
        let (mut edges, mut weights): (Vec<f64>, Vec<u64>) = (vec![], vec![]);
        for (from, to, weight) in bins {
            if edges.last().is_none_or(|&last| last < from) {
                if !edges.is_empty() {
                    weights.push(0);
                }
                edges.push(from);
            }
            edges.push(to);
            weights.push(weight);
        }
        Self { edges, weights }
    }

    /// The same bins, the first and the last that hold something cut to what lies from `least` to `most`.
    pub(super) fn within(mut self, least: f64, most: f64) -> Self {
        let filled = |weights: &[u64]| (weights.iter().position(|&w| w > 0), weights.iter().rposition(|&w| w > 0));
        if let (Some(first), Some(last)) = filled(&self.weights) {
            self.edges.truncate(last + 2);
            self.weights.truncate(last + 1);
            self.edges.drain(..first);
            self.weights.drain(..first);
            if least < self.edges[1] {
                self.edges[0] = self.edges[0].max(least);
            }
            let end = self.edges.len() - 1;
            if most > self.edges[end - 1] {
                self.edges[end] = self.edges[end].min(most);
            }
        }
        self
    }

    /// Sum of the weights.
    pub(super) fn total(&self) -> u64 {
        self.weights.iter().sum()
    }

    /// Number of bins.
    pub(super) fn bins(&self) -> usize {
        self.weights.len()
    }

    /// The bin of a value; those outside count in the first and the last.
    pub(super) fn bin(&self, value: f64) -> usize {
        self.edges.partition_point(|&edge| edge <= value).saturating_sub(1).min(self.bins().saturating_sub(1))
    }

    /// The bin of a value as an interval.
    pub(super) fn bounds(&self, value: f64) -> (f64, f64) {
        let bin = self.bin(value);
        (self.edges[bin], self.edges[bin + 1])
    }

    /// How many of `count` draws fall into each bin: within one of its share; exactly its weight where `count` is the
    /// sum of the weights. All 0 where nothing has a weight.
    pub(super) fn apportion(&self, count: usize) -> Vec<usize> {
        apportion(&self.weights, count)
    }

    /// The value that a part of all lie below, as if each bin were filled evenly; NaN where nothing has a weight.
    pub(super) fn quantile(&self, part: f64) -> f64 {
        let wanted = part * self.total() as f64;
        let mut below = 0.0;
        for (pair, &weight) in self.edges.windows(2).zip(&self.weights) {
            if weight > 0 && below + weight as f64 >= wanted {
                return pair[0] + (pair[1] - pair[0]) * ((wanted - below) / weight as f64).max(0.0);
            }
            below += weight as f64;
        }
        f64::NAN
    }

    /// `count` numbers in rising order.
    pub(super) fn draw(&self, count: usize, rng: &mut Rng) -> Vec<f64> {
        let mut drawn = Vec::with_capacity(count);
        for (bin, n) in self.apportion(count).into_iter().enumerate() {
            let (from, to) = (self.edges[bin], self.edges[bin + 1]);
            drawn.extend((0..n).map(|i| from + (to - from) * ((i as f64 + rng.unit()) / n as f64)));
        }
        drawn
    }
}

/// Shares `count` out by weights, each within one of its share: the rounded sums up to each place, less the one before.
pub(super) fn apportion(weights: &[u64], count: usize) -> Vec<usize> {
    let total = weights.iter().map(|&w| u128::from(w)).sum::<u128>();
    let (mut sum, mut before) = (0_u128, 0);
    let share = |&weight: &u64| {
        sum += u128::from(weight);
        let upto = (2 * sum * count as u128 + total).checked_div(2 * total).unwrap_or(0);
        #[allow(clippy::cast_possible_truncation, reason = "at most the count")]
        let upto = upto as usize;
        upto - std::mem::replace(&mut before, upto)
    };
    weights.iter().map(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;
    use proptest::prelude::*;

    #[test]
    fn bins_with_gaps_and_cut_ends() {
        let strata = Strata::of_bins([(0.0, 10.0, 2), (10.0, 20.0, 1), (30.0, 40.0, 5)]);
        assert_eq!(
            (strata.edges.as_slice(), strata.weights.as_slice()),
            (&[0.0, 10.0, 20.0, 30.0, 40.0][..], &[2, 1, 0, 5][..])
        );
        let cut = strata.within(4.0, 33.0);
        assert_eq!((cut.edges[0], cut.edges[4]), (4.0, 33.0));
        assert_eq!((cut.quantile(0.0), cut.quantile(1.0)), (4.0, 33.0));
        assert_eq!((cut.bin(-1.0), cut.bin(10.0), cut.bin(99.0)), (0, 1, 3), "half-open, and nothing is lost");
        let empty = Strata::of_bins([(0.0, 1.0, 0)]).within(0.5, 0.6);
        assert_eq!((empty.total(), empty.draw(5, &mut Rng::new(1))), (0, vec![]));
        assert!(empty.quantile(0.5).is_nan());
    }

    proptest! {
        #[test]
        fn every_bin_gets_its_share(
            weights in prop::collection::vec(prop_oneof![Just(0), 0..9_u64, 0..5000_u64], 1..40),
            count in 0..900_usize,
            seed in any::<u64>(),
        ) {
            let total: u64 = weights.iter().sum();
            let strata = Strata::of_bins((0..).zip(&weights).map(|(i, &w)| (f64::from(i), f64::from(i) + 1.0, w)));
            let parts = strata.apportion(count);
            let wanted = if total == 0 { 0 } else { count };
            prop_assert_eq!(parts.iter().sum::<usize>(), wanted);
            for (&part, &weight) in parts.iter().zip(&weights) {
                let share = weight as f64 * count as f64 / total.max(1) as f64;
                prop_assert!((part as f64 - share).abs() < 1.0 + 1e-9, "{part} for a share of {share}");
            }
            let exact: Vec<u64> = strata.apportion(total as usize).iter().map(|&n| n as u64).collect();
            prop_assert_eq!(&exact, &weights);
            let drawn = strata.draw(count, &mut Rng::new(seed));
            prop_assert!(drawn.is_sorted());
            let mut counted = vec![0; weights.len()];
            drawn.iter().for_each(|&value| counted[strata.bin(value)] += 1);
            prop_assert_eq!(counted, parts);
        }
    }
}
