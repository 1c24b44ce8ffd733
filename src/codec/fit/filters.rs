//! Filters by weighted least squares.

use super::samples::{ROW, Sample, Samples, miss};
use super::solve::solve;
use crate::codec::params::WEIGHT_LIMIT;
use crate::codec::pass::FRACTION;
use crate::codec::taps::MAX_TAPS;

/// Samples whose products are summed in single precision.
const BLOCK: usize = 64;
/// Samples whose products are added at once: sums are read and written less often.
const GROUP: usize = 4;

/// The weighted normal equations; of the matrix the lower triangle.
#[derive(Clone)]
struct Sums {
    matrix: [[f64; MAX_TAPS]; MAX_TAPS],
    right: [f64; MAX_TAPS],
    weight: f64,
}

impl Sums {
    /// Adds those of other samples.
    fn add(&mut self, other: &Self) {
        for (row, others) in self.matrix.iter_mut().zip(&other.matrix) {
            row.iter_mut().zip(others).for_each(|(cell, other)| *cell += other);
        }
        self.right.iter_mut().zip(&other.right).for_each(|(cell, other)| *cell += other);
        self.weight += other.weight;
    }
}

/// A filter without and one with the serial taps; the second is the first where samples have no serial taps.
pub(in crate::codec) type FilterPair = [[i32; MAX_TAPS]; 2];

/// The best filters of samples.
pub(in crate::codec) struct Fits {
    /// For all of them.
    pub(in crate::codec) all: FilterPair,
    /// For each class, where there are enough samples of both.
    pub(in crate::codec) by_class: Option<[FilterPair; 2]>,
}

impl Samples {
    /// The best filters; `None` with too few samples.
    pub(in crate::codec) fn fit(&self, classes: bool) -> Option<Fits> {
        let enough = 8 * self.taps;
        if self.samples.len() < enough {
            return None;
        }
        let (flat, steep) = self.samples.split_at(self.flat);
        let classes = classes && flat.len().min(steep.len()) >= enough.max(self.samples.len() / 20 + 1);
        let sums = |filter: Option<&[f32; ROW]>| {
            crate::codec::vectors::widest(
                #[inline(always)]
                || [self.sums(flat, filter), self.sums(steep, filter)],
            )
        };
        // First by expected spreads, then towards least absolute errors.
        let [mut all, steep] = sums(None);
        all.add(&steep);
        let filter = self.solved(all, self.taps);
        let [flat, steep] = sums(Some(&std::array::from_fn(|k| filter.get(k).map_or(0.0, |&weight| weight as f32))));
        let by_class = classes.then(|| [self.pair(&flat), self.pair(&steep)]);
        let mut all = flat;
        all.add(&steep);
        Some(Fits { all: self.pair(&all), by_class })
    }

    /// The filters that sums give.
    fn pair(&self, sums: &Sums) -> FilterPair {
        // The serial taps are the last ones: without them it is a smaller system of the same sums.
        let whole = self.solved(sums.clone(), self.taps);
        let plain = if self.taps == self.plain_taps { whole } else { self.solved(sums.clone(), self.plain_taps) };
        [plain, whole].map(|mut solution| {
            // What is added to all four nearest cells alike changes nothing but the rounding of their mean, which is
            // exact with a quarter each.
            let shared = solution[..4].iter().sum::<f64>() / 4.0 - 0.25;
            solution[..4].iter_mut().for_each(|weight| *weight -= shared);
            let one = f64::from(1 << FRACTION);
            let limit = f64::from(WEIGHT_LIMIT);
            solution.map(|weight| (weight * one).round().clamp(-limit, limit) as i32)
        })
    }

    /// The weights of the first `count` taps that sums give.
    fn solved(&self, mut sums: Sums, count: usize) -> [f64; MAX_TAPS] {
        let trace: f64 = (0..self.taps).map(|k| sums.matrix[k][k]).sum::<f64>() / self.taps as f64;
        for (k, row) in sums.matrix.iter_mut().enumerate().take(count) {
            row[k] += 1e-5 * trace + 1e-9;
            if self.own[k] {
                // The decoder sees these cells with the quantiser's noise; here they have none.
                row[k] += self.noise * sums.weight;
            }
        }
        solve(&mut sums.matrix, &sums.right, count)
    }

    /// The normal equations of samples, weighted; towards least absolute errors where a filter's misses are known.
    #[inline(always)]
    fn sums(&self, samples: &[Sample], filter: Option<&[f32; ROW]>) -> Sums {
        let mut sums = Sums { matrix: [[0.0; MAX_TAPS]; MAX_TAPS], right: [0.0; MAX_TAPS], weight: 0.0 };
        for block in samples.chunks(BLOCK) {
            // Sums of few terms in single precision, which vectorise well; sums of those in double.
            let mut products = [[0.0f32; ROW]; MAX_TAPS];
            let mut with_target = [0.0f32; ROW];
            for group in block.chunks(GROUP) {
                // Of an incomplete group the rest counts nothing.
                let (mut taps, mut weighted) = ([[0.0f32; ROW]; GROUP], [[0.0f32; ROW]; GROUP]);
                for ((sample, taps), weighted) in group.iter().zip(&mut taps).zip(&mut weighted) {
                    let mut weight = sample.weight;
                    if let Some(filter) = filter {
                        // Towards least absolute errors, which are what bits are spent on.
                        let scale = 1.0 / weight.sqrt();
                        weight = 1.0 / (scale * (miss(sample, filter).abs() + 0.5 * scale));
                    }
                    sums.weight += f64::from(weight);
                    *taps = sample.taps;
                    *weighted = sample.taps.map(|tap| tap * weight);
                    for (cell, &weighted) in with_target.iter_mut().zip(weighted.iter()) {
                        *cell += weighted * sample.target;
                    }
                }
                // The lower triangle, in whole vectors.
                let taps = taps.each_ref().map(|taps| taps.as_chunks::<8>().0);
                for (k, row) in products[..self.taps].iter_mut().enumerate() {
                    let [p, q, r, s] = weighted.each_ref().map(|weighted| weighted[k]);
                    for (part, cells) in row.as_chunks_mut::<8>().0[..=k / 8].iter_mut().enumerate() {
                        let [a, b, c, d] = taps.map(|taps| &taps[part]);
                        for j in 0..8 {
                            cells[j] += (p * a[j] + q * b[j]) + (r * c[j] + s * d[j]);
                        }
                    }
                }
            }
            for k in 0..self.taps {
                sums.right[k] += f64::from(with_target[k]);
                for (cell, &product) in sums.matrix[k][..=k].iter_mut().zip(&products[k]) {
                    *cell += f64::from(product);
                }
            }
        }
        sums
    }
}
