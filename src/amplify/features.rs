//! What is looked at of a coarse patch: its heights above the middle, as numbers of about equal weight.

use super::orientation::{Offsets, Way, Ways};
use super::plane::Plane;
use crate::linalg::{Gram, eigenvectors};
use rayon::prelude::*;

/// Cells of a patch at each side of its middle.
pub(super) const RADIUS: usize = 3;
/// Side of a patch.
pub(super) const SIDE: usize = 2 * RADIUS + 1;
/// Heights of a patch but the middle one.
pub(super) const INPUTS: usize = SIDE * SIDE - 1;
/// Numbers that a patch is turned into: all that there is to know of it.
pub(super) const DIMS: usize = INPUTS;
/// Patches that are summed one after the other, whatever the threads.
const BLOCK: usize = 4096;
/// Directions in which patches vary less than this part of the most are as weak as this.
const LEAST_PART: f64 = 1e-9;

/// Takes patches out of a plane.
pub(super) struct Patches<'a> {
    plane: &'a Plane,
    offsets: Offsets,
    is_square: bool,
}

impl<'a> Patches<'a> {
    pub(super) fn new(plane: &'a Plane, is_square: bool) -> Self {
        Self { plane, offsets: Ways::new(SIDE).offsets(plane.cols()), is_square }
    }

    /// The heights around a cell above its own, in standing position, and how they were turned.
    #[inline(always)]
    pub(super) fn take(&self, row: usize, col: usize, out: &mut [f32; INPUTS]) -> Way {
        let way = Way::of(self.plane, row, col, self.is_square);
        let middle = self.plane.row(row)[col];
        let square = &self.plane.heights_m()[(row - RADIUS) * self.plane.cols() + col - RADIUS..];
        let (before, after) = self.offsets.of(way).split_at(INPUTS / 2);
        for (out, &cell) in out.iter_mut().zip(before.iter().chain(&after[1..])) {
            *out = (square[cell] - middle) as f32;
        }
        way
    }
}

/// Turns patches into features: axes along which they vary most (Pearson 1901), each divided by the fourth root of how
/// much they vary along it. So slopes, which all patches have, leave room for shapes.
#[derive(Clone, Debug)]
pub(super) struct Features {
    /// For each height of a patch its part in each feature.
    pub(super) weights: Vec<[f32; DIMS]>,
}

impl Features {
    /// The features that suit patches, which lie one behind the other.
    pub(super) fn learn(patches: &[f32]) -> Self {
        let sums: Vec<Gram> = patches
            .par_chunks(BLOCK * INPUTS)
            .map(|block| {
                let mut gram = Gram::new(INPUTS);
                for patch in block.chunks_exact(INPUTS) {
                    gram.add(&unit(patch));
                }
                gram
            })
            .collect();
        let mut gram = Gram::new(INPUTS);
        // In the order of the blocks.
        sums.iter().for_each(|sum| gram.join(sum));
        let (values, vectors) = eigenvectors(&gram.finish(), INPUTS);
        let least = values[0] * LEAST_PART;
        let mut weights = vec![[0.0; DIMS]; INPUTS];
        for (k, vector) in vectors.chunks_exact(INPUTS).enumerate() {
            // Means do not matter, as with patches that had it taken away; and signs of eigenvectors are not settled.
            let sign = if vector.iter().sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
            let divisor = (values[k].max(least) / values[0]).sqrt().sqrt();
            for (weights, v) in weights.iter_mut().zip(vector) {
                weights[k] = (sign * v / divisor) as f32;
            }
        }
        Self { weights }
    }

    /// The features of a patch.
    #[inline(always)]
    pub(super) fn of(&self, patch: &[f32; INPUTS]) -> [f32; DIMS] {
        let mut features = [0.0; DIMS];
        for (weights, height) in self.weights.iter().zip(patch) {
            for (feature, weight) in features.iter_mut().zip(weights) {
                *feature += height * weight;
            }
        }
        features
    }
}

/// A patch divided by its length, so that gentle ones count as much as steep ones.
fn unit(patch: &[f32]) -> Vec<f64> {
    let length = patch.iter().map(|&v| f64::from(v) * f64::from(v)).sum::<f64>().sqrt();
    patch.iter().map(|&v| f64::from(v) / length.max(f64::MIN_POSITIVE)).collect()
}
