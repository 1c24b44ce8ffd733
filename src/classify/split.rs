//! Where one feature parts samples best.

use super::samples::Samples;
use std::cmp::Ordering;

/// A part of the samples on either side of a threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// The feature that is looked at.
    pub feature: usize,
    /// Samples whose value is at most this are on the left, the others on the right; both sides have some.
    pub threshold: f64,
    /// How pure the sides are: a fraction that is greater the less their Gini impurity is.
    purity: Fraction,
}

/// A fraction of whole numbers, which compares without rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Fraction {
    above: u64,
    below: u64,
}

impl Fraction {
    /// With at most 2^20 samples the products stay below 2^100.
    fn exceeds(self, other: Self) -> bool {
        u128::from(self.above) * u128::from(other.below) > u128::from(other.above) * u128::from(self.below)
    }
}

impl Split {
    /// Whether its sides are purer than those of another split of the same samples.
    pub fn is_purer(&self, other: &Self) -> bool {
        self.purity.exceeds(other.purity)
    }
}

/// The split by one feature that makes the sides purest, the one with the lowest threshold of equals; `None` where all
/// members have the same value.
///
/// Members are samples that count `weights[sample]` times. With `l` and `r` of them on the sides, `l_c` and `r_c` of
/// class `c`, the weighted Gini impurity of the sides is `n - sum l_c² / l - sum r_c² / r`: the two sums, brought to one
/// denominator, are compared as whole numbers. Thresholds lie halfway between neighbouring values (Breiman, Friedman,
/// Olshen, Stone 1984, section 2.4).
///
/// # Complexity
/// O(m log m + m) for m members.
pub fn best_split(samples: &Samples, weights: &[u32], members: &[u32], feature: usize) -> Option<Split> {
    let mut sorted: Vec<(f64, u32)> = members.iter().map(|&m| (samples.value(feature, m), m)).collect();
    // The order among equal values changes nothing: no threshold lies between them.
    sorted.sort_unstable_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(Ordering::Equal));
    let (first, last) = (sorted.first()?.0, sorted.last()?.0);
    if first >= last {
        return None;
    }
    let mut right = Side::empty(samples.classes());
    members.iter().for_each(|&m| right.add(samples.label(m), u64::from(weights[m as usize])));
    let mut left = Side::empty(samples.classes());
    let mut best: Option<Split> = None;
    for pair in sorted.windows(2) {
        let ((value, member), next) = (pair[0], pair[1].0);
        let (label, weight) = (samples.label(member), u64::from(weights[member as usize]));
        left.add(label, weight);
        right.take(label, weight);
        if value < next {
            let above = left.squares * right.weight + right.squares * left.weight;
            let purity = Fraction { above, below: left.weight * right.weight };
            if best.is_none_or(|best| purity.exceeds(best.purity)) {
                best = Some(Split { feature, threshold: between(value, next), purity });
            }
        }
    }
    best
}

/// What is on one side.
struct Side {
    counts: Vec<u64>,
    weight: u64,
    /// Sum of the squares of the counts.
    squares: u64,
}

impl Side {
    fn empty(classes: usize) -> Self {
        Self { counts: vec![0; classes], weight: 0, squares: 0 }
    }

    fn add(&mut self, label: u32, weight: u64) {
        let count = &mut self.counts[label as usize];
        self.squares += weight * (2 * *count + weight);
        *count += weight;
        self.weight += weight;
    }

    fn take(&mut self, label: u32, weight: u64) {
        let count = &mut self.counts[label as usize];
        self.squares -= weight * (2 * *count - weight);
        *count -= weight;
        self.weight -= weight;
    }
}

/// A number from `low` on that is less than `high`: halfway where there is room.
fn between(low: f64, high: f64) -> f64 {
    let middle = low / 2.0 + high / 2.0;
    if low <= middle && middle < high { middle } else { low }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_part_neighbours() {
        for (low, high) in
            [(0.0, 1.0), (-1.0, -1.0_f64.next_down()), (f64::MIN, f64::MAX), (0.0, 5e-324), (5e-324, 1e-323)]
        {
            let (low, high) = if low < high { (low, high) } else { (high, low) };
            let threshold = between(low, high);
            assert!(low <= threshold && threshold < high, "{low} {threshold} {high}");
        }
        assert_eq!(between(1.0, 2.0), 1.5);
    }

    #[test]
    fn the_purest_of_a_few() {
        let rows: Vec<(Vec<f64>, u32)> =
            [(1.0, 0), (2.0, 0), (3.0, 1), (3.0, 0), (4.0, 1)].map(|(v, class)| (vec![v, 7.0], class)).to_vec();
        let samples = Samples::new(&rows, 2).unwrap();
        let best = best_split(&samples, &[1; 5], &[0, 1, 2, 3, 4], 0).unwrap();
        // At 2.5: 2²/2 + (2² + 1²)/3 = 3.67; at 3.5: (3² + 1²)/4 + 1 = 3.5; at 1.5: 1 + (2² + 2²)/4 = 3.
        assert_eq!(best.threshold, 2.5);
        // The last sample three times: at 3.5 it is (3² + 1²)/4 + 9/3 = 5.5, at 2.5 2 + (4² + 1)/5 = 5.4.
        assert_eq!(best_split(&samples, &[1, 1, 1, 1, 3], &[4, 3, 2, 1, 0], 0).unwrap().threshold, 3.5);
        assert_eq!(best_split(&samples, &[1; 5], &[0, 1, 2, 3, 4], 1), None);
        assert_eq!(best_split(&samples, &[1; 5], &[2, 3], 0), None);
    }
}
