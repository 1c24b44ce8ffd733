//! The search for an atom among candidates.

use super::super::atoms::{Dictionary, Origin};
use super::super::shape::PatchShape;
use crate::linalg::{UNDERFLOW, dot, product, product_error, quadratic, vectorised};
use rayon::prelude::*;

/// Candidates of one product.
const BLOCK: usize = 512;

/// Atoms to choose from.
pub(super) struct Candidates<'a> {
    dictionary: &'a Dictionary,
    size: usize,
    // Times the roots of weights, and their square lengths.
    atoms: Vec<f32>,
    squares: Vec<f64>,
}

impl<'a> Candidates<'a> {
    /// All atoms of a dictionary.
    pub(super) fn new(dictionary: &'a Dictionary, shape: &PatchShape) -> Self {
        let atoms = shape.scaled(dictionary.values());
        let size = shape.disc_values();
        let squares = atoms.chunks_exact(size).map(|atom| dot(atom, atom)).collect();
        Self { dictionary, size, atoms, squares }
    }

    /// The candidate p with the largest `pᵀ G p / pᵀ p`, the first of equals; `None` where all are 0.
    ///
    /// A fast product with the matrix in `f32` nominates, and those within its error are compared in double
    /// precision. The error: each value of `G p` is off by at most γ Σ|Gᵢⱼ||pⱼ| and the rounding of G, so the form
    /// by at most (γ + 2u) |p|ᵀ|G||p|, which is not more than the matrix's Frobenius norm times that and `pᵀ p`.
    pub(super) fn best(&self, gram: &[f64]) -> Option<(&'a [f32], &'a Origin)> {
        let frobenius = dot(gram, gram).sqrt();
        if frobenius.is_nan() || frobenius <= 0.0 {
            return None;
        }
        let matrix: Vec<f32> = gram.iter().map(|v| (v / frobenius) as f32).collect();
        let estimates: Vec<f64> = self
            .atoms
            .par_chunks(BLOCK * self.size)
            .zip(self.squares.par_chunks(BLOCK))
            .flat_map_iter(|(atoms, squares)| {
                let mut images = vec![0.0; atoms.len()];
                vectorised(
                    #[inline(always)]
                    || {
                        // The matrix is symmetric, so its rows are its columns.
                        product(atoms, &matrix, self.size, &mut images);
                        let pairs = images.chunks_exact(self.size).zip(atoms.chunks_exact(self.size)).zip(squares);
                        pairs.map(|((image, atom), square)| dot(image, atom) / square).collect::<Vec<f64>>()
                    },
                )
            })
            .collect();
        let unit = 1.0 / f64::from(1 << 24);
        let off = 1.01 * (product_error(self.size) + 2.0 * unit) + (self.size * self.size) as f64 * UNDERFLOW;
        let most = estimates.iter().copied().fold(0.0, f64::max);
        let mut best = (0.0, None);
        for (i, &estimate) in estimates.iter().enumerate() {
            if estimate >= most - 2.0 * off {
                let gain = quadratic(gram, &self.atoms[i * self.size..][..self.size]) / self.squares[i];
                if gain > best.0 {
                    best = (gain, Some(i));
                }
            }
        }
        best.1.map(|i| (self.dictionary.atom(i), self.dictionary.origin(i)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::noise_atom::NoiseFamily;
    use super::*;

    #[test]
    fn it_is_the_best_of_all() {
        let shape = PatchShape::new(6).unwrap();
        let dictionary = Dictionary::noise(NoiseFamily::Ridged, &shape, 1500, 3).unwrap();
        let candidates = Candidates::new(&dictionary, &shape);
        let size = shape.disc_values();
        for seed in 0..5 {
            let users = Dictionary::noise(NoiseFamily::Perlin, &shape, 7, seed).unwrap();
            let vectors: Vec<f64> = shape.scaled(users.values()).into_iter().map(f64::from).collect();
            let mut gram = crate::linalg::Gram::new(size);
            gram.add(&vectors);
            let gram = gram.finish();
            // How much of all users a candidate explains, user by user.
            let explained = |atom: &[f32]| {
                let mut scaled = vec![0.0; size];
                shape.scale_into(atom, &mut scaled);
                let along = |user: &[f64]| dot(user, &scaled).powi(2) / dot(&scaled, &scaled);
                vectors.chunks(size).map(along).sum::<f64>()
            };
            let best = (0..dictionary.len())
                .max_by(|&a, &b| explained(dictionary.atom(a)).total_cmp(&explained(dictionary.atom(b))))
                .unwrap();
            assert_eq!(candidates.best(&gram).unwrap().0, dictionary.atom(best));
        }
        assert!(candidates.best(&vec![0.0; size * size]).is_none());
    }
}
