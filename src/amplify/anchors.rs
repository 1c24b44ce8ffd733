//! Anchors: unit vectors that features are sorted by, in a tree of two levels (Timofte, Rothe, Van Gool 2016, Seven ways
//! to improve example-based single image super resolution, section 3.4).

use super::features::DIMS;
use crate::linalg::vectorised;
use rayon::prelude::*;

/// Branches of each knot.
pub(super) const BRANCHES: usize = 32;
/// Anchors in all.
pub(super) const ANCHORS: usize = BRANCHES * BRANCHES;
/// Turns of k-means.
const TURNS: usize = 10;
/// Features that the places of a knot's branches are learned from, at most.
const ENOUGH: usize = 1 << 16;
/// Features that are summed one after the other, whatever the threads.
const BLOCK: usize = 4096;

/// Unit vectors of one knot, axis by axis so that all are compared at once.
#[derive(Clone, Debug)]
pub(super) struct Knot(pub(super) [[f32; BRANCHES]; DIMS]);

impl Knot {
    /// The branch whose vector points most into the features' direction; the first of equals.
    #[inline(always)]
    fn nearest(&self, features: &[f32; DIMS]) -> usize {
        let mut products = [0.0f32; BRANCHES];
        for (parts, feature) in self.0.iter().zip(features) {
            for (product, part) in products.iter_mut().zip(parts) {
                *product += feature * part;
            }
        }
        let mut most = products[0];
        for &product in &products[1..] {
            most = if product > most { product } else { most };
        }
        products.iter().position(|&product| product == most).unwrap_or(0)
    }

    fn vector(&self, branch: usize) -> [f32; DIMS] {
        std::array::from_fn(|axis| self.0[axis][branch])
    }

    fn set(&mut self, branch: usize, vector: &[f32]) {
        self.0.iter_mut().zip(vector).for_each(|(parts, &v)| parts[branch] = v);
    }

    /// k-means of directions: branches point where the unit vectors that are nearest to them point together. Begins
    /// from vectors evenly spread over the list, which is in no order; a branch without followers stays.
    fn learn(units: &[[f32; DIMS]]) -> Self {
        let step = units.len().div_ceil(ENOUGH).max(1);
        let units: Vec<[f32; DIMS]> = units.iter().step_by(step).copied().collect();
        let mut knot = Self([[0.0; BRANCHES]; DIMS]);
        for branch in 0..BRANCHES {
            if let Some(unit) = units.get(branch * units.len() / BRANCHES) {
                knot.set(branch, unit);
            }
        }
        for _ in 0..TURNS {
            let sums: Vec<Vec<[f64; DIMS]>> = units.par_chunks(BLOCK).map(|block| knot.sums(block)).collect();
            for branch in 0..BRANCHES {
                let mut sum = [0.0; DIMS];
                for part in &sums {
                    sum.iter_mut().zip(&part[branch]).for_each(|(sum, part)| *sum += part);
                }
                let length = sum.iter().map(|v| v * v).sum::<f64>().sqrt();
                if length > 1e-9 {
                    knot.set(branch, &sum.map(|v| (v / length) as f32));
                }
            }
        }
        knot
    }

    /// For each branch the sum of the vectors that are nearest to it.
    fn sums(&self, units: &[[f32; DIMS]]) -> Vec<[f64; DIMS]> {
        let mut sums = vec![[0.0; DIMS]; BRANCHES];
        vectorised(|| {
            for unit in units {
                let sum = &mut sums[self.nearest(unit)];
                sum.iter_mut().zip(unit).for_each(|(sum, &v)| *sum += f64::from(v));
            }
        });
        sums
    }
}

/// The tree of anchors.
#[derive(Clone, Debug)]
pub(super) struct Anchors {
    pub(super) root: Knot,
    pub(super) knots: Vec<Knot>,
}

impl Anchors {
    /// Anchors among unit vectors, which are in no order.
    pub(super) fn learn(units: &[[f32; DIMS]]) -> Self {
        let root = Knot::learn(units);
        let branches: Vec<usize> = units.par_iter().map(|unit| root.nearest(unit)).collect();
        let mut followers = vec![vec![]; BRANCHES];
        for (unit, &branch) in units.iter().zip(&branches) {
            followers[branch].push(*unit);
        }
        let knots = followers.par_iter().map(|units| Knot::learn(units)).collect();
        Self { root, knots }
    }

    /// The anchor of features; their length does not matter.
    #[inline(always)]
    pub(super) fn of(&self, features: &[f32; DIMS]) -> usize {
        let branch = self.root.nearest(features);
        branch * BRANCHES + self.knots[branch].nearest(features)
    }

    /// The branch of the root that features lie on.
    #[inline(always)]
    pub(super) fn branch(&self, features: &[f32; DIMS]) -> usize {
        self.root.nearest(features)
    }

    /// The unit vector of an anchor.
    pub(super) fn vector(&self, anchor: usize) -> [f32; DIMS] {
        self.knots[anchor / BRANCHES].vector(anchor % BRANCHES)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    fn units(count: usize) -> Vec<[f32; DIMS]> {
        let mut rng = Rng::new(5);
        let vector = |rng: &mut Rng| -> [f64; DIMS] { std::array::from_fn(|_| rng.unit() - 0.5) };
        let unit = |v: [f64; DIMS]| v.map(|x| (x / v.iter().map(|x| x * x).sum::<f64>().sqrt()) as f32);
        (0..count).map(|_| unit(vector(&mut rng))).collect()
    }

    #[test]
    fn each_follows_the_nearest_branch_of_the_nearest() {
        let units = units(3000);
        let anchors = Anchors::learn(&units);
        let product = |a: &[f32; DIMS], b: &[f32; DIMS]| a.iter().zip(b).fold(0.0f32, |sum, (a, b)| sum + a * b);
        for unit in &units {
            let best = |vectors: Vec<[f32; DIMS]>| {
                let products: Vec<f32> = vectors.iter().map(|vector| product(unit, vector)).collect();
                (0..BRANCHES).fold(0, |best, k| if products[k] > products[best] { k } else { best })
            };
            let branch = best((0..BRANCHES).map(|k| anchors.root.vector(k)).collect());
            let anchor = best((0..BRANCHES).map(|k| anchors.vector(branch * BRANCHES + k)).collect());
            assert_eq!(anchors.of(unit), branch * BRANCHES + anchor);
            assert_eq!(anchors.of(&unit.map(|v| v * 4096.0)), anchors.of(unit), "length does not matter");
        }
    }

    #[test]
    fn threads_make_no_difference() {
        let units = units(9000);
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let anchors = pool.install(|| Anchors::learn(&units));
            (0..ANCHORS).map(|k| anchors.vector(k)).collect::<Vec<_>>()
        };
        assert_eq!(with(1), with(3));
    }

    #[test]
    fn few_are_enough() {
        for count in [0, 1, 5] {
            let anchors = Anchors::learn(&units(count));
            assert!(units(20).iter().all(|unit| anchors.of(unit) < ANCHORS));
        }
    }
}
