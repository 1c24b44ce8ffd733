//! The shape of patches and atoms: a square of values with a disc of weights in it.

use crate::codec::sparse::weights;
use crate::error::{Error, Result};
use crate::linalg::dot;

/// Longest side of a patch.
pub(super) const MOST_SIDE: usize = 4096;

/// The shape of patches and atoms.
///
/// K values, a square of `side` by `side` cells, row by row; the disc of weights touches its sides, so its radius R
/// is half a side, which is what the paper's K counts (8 by 8 = 64 in its figure 4). Inner products, norms and means
/// count each cell by its weight, as blending does: a cell outside the disc, where the weight is 0, decides nothing.
/// The corners' values are kept all the same; they only continue the terrain for the interpolation between cells.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchShape {
    side: usize,
    weights: Vec<f64>,
    // The cells of the disc, and the roots of their weights.
    disc: Vec<u32>,
    roots: Vec<f32>,
}

impl PatchShape {
    /// Patches of `side` by `side` values.
    ///
    /// # Errors
    /// When the side is not within 3 and 4096.
    pub fn new(side: usize) -> Result<Self> {
        if !(3..=MOST_SIDE).contains(&side) {
            return Err(Error::usage(format!("patches of side {side}: 3 to {MOST_SIDE} cells are possible")));
        }
        let weights = weights(side);
        let disc: Vec<u32> = (0..weights.len()).filter(|&k| weights[k] > 0.0).map(|k| k as u32).collect();
        let roots = disc.iter().map(|&k| weights[k as usize].sqrt() as f32).collect();
        Ok(Self { side, weights, disc, roots })
    }

    /// Length of a side, in cells.
    pub fn side(&self) -> usize {
        self.side
    }

    /// Number of values, the paper's K.
    pub fn values(&self) -> usize {
        self.side * self.side
    }

    /// The disc's radius R, in cells.
    pub fn radius_cells(&self) -> f64 {
        self.side as f64 / 2.0
    }

    /// The weight of each value, row by row.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Number of values within the disc.
    pub fn disc_values(&self) -> usize {
        self.disc.len()
    }

    /// The positions of the disc's values within the square.
    pub(super) fn disc(&self) -> impl Iterator<Item = usize> {
        self.disc.iter().map(|&k| k as usize)
    }

    /// Roots of the weights of the disc's values.
    pub(super) fn roots(&self) -> &[f32] {
        &self.roots
    }

    /// The disc's values, each times the root of its weight: weighted inner products become plain ones.
    #[inline(always)]
    pub(super) fn scale_into(&self, values: &[f32], out: &mut [f32]) {
        debug_assert_eq!(values.len(), self.values(), "one patch");
        for ((out, &k), root) in out.iter_mut().zip(&self.disc).zip(&self.roots) {
            *out = values[k as usize] * root;
        }
    }

    /// All patches of a list, scaled and one behind the other.
    pub(super) fn scaled(&self, values: &[f32]) -> Vec<f32> {
        let size = self.disc_values();
        let mut out = vec![0.0; values.len() / self.values() * size];
        for (values, out) in values.chunks_exact(self.values()).zip(out.chunks_exact_mut(size)) {
            self.scale_into(values, out);
        }
        out
    }

    /// Weighted mean of a patch without voids.
    pub(super) fn mean<V: Copy + Into<f64>>(&self, values: &[V]) -> f64 {
        dot(&self.weights, values) / dot(&self.weights, &vec![1.0; self.values()])
    }

    /// Weighted norm of a patch without voids.
    pub(super) fn norm(&self, values: &[f64]) -> f64 {
        self.weights.iter().zip(values).map(|(w, v)| w * v * v).sum::<f64>().sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_have_limits() {
        assert!(PatchShape::new(2).is_err());
        assert!(PatchShape::new(MOST_SIDE + 1).is_err());
        assert!(PatchShape::new(3).is_ok());
    }

    #[test]
    fn the_disc_lies_in_the_square_and_corners_weigh_nothing() {
        let shape = PatchShape::new(8).unwrap();
        assert_eq!((shape.values(), shape.disc_values()), (64, 52));
        for corner in [0, 1, 6, 7, 8, 15, 48, 55, 56, 57, 62, 63] {
            assert_eq!(shape.weights()[corner], 0.0);
        }
        assert_eq!(shape.weights()[27], (1.0f64 - 0.5 / 16.0).powi(3));
        // Turned by a right angle it is the same.
        for k in 0..64 {
            assert_eq!(shape.weights()[k], shape.weights()[k % 8 * 8 + 7 - k / 8]);
        }
    }

    #[test]
    fn scaled_products_are_weighted_products() {
        let shape = PatchShape::new(5).unwrap();
        let a: Vec<f32> = (0..25).map(|i| (i * 7 % 11) as f32).collect();
        let b: Vec<f32> = (0..25).map(|i| (i * 5 % 13) as f32 - 4.0).collect();
        let plain: f64 = (0..25).map(|k| shape.weights()[k] * f64::from(a[k]) * f64::from(b[k])).sum();
        let (a, b) = (shape.scaled(&a), shape.scaled(&b));
        assert!((dot(&a, &b) - plain).abs() < 1e-4);
    }
}
