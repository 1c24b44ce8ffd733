//! Matching pursuit: a few atoms for each patch (paper 001, section 4.3).
//!
//! Patches go through in blocks. The product of a block with all atoms, fast and slightly off, nominates; all atoms
//! that could be the best, given a proved bound of what it can be off, are compared in double precision and one
//! order, and the first of equals wins. Where there are thousands of atoms and one a patch is wanted, a tree nominates. So the result is that of comparing all atoms in double precision, on every
//! machine and with any number of threads. A patch with missing cells takes just that slow way.

mod projection;
mod scan;
mod several;
mod single;
#[cfg(test)]
mod tests;
mod tree;

pub(super) use projection::Projection;

use super::atoms::{Dictionary, Samples};
use super::codes::{Block, Codes};
use super::patches::Patches;
use super::shape::PatchShape;
use crate::error::{Error, Result};
use crate::linalg::{UNDERFLOW, dot, product_error, vectorised};
use projection::LEAST_NEW;
use rayon::prelude::*;
use single::Turn;
use tree::Tree;

/// Patches of a block.
const BLOCK: usize = 256;
/// Patches of a block where atoms are in a tree: like ones are then looked for together.
const TREE_BLOCK: usize = 8192;
/// A pursuit ends when an atom would explain less than this part of a patch's square length.
const LEAST_GAIN: f64 = 1e-14;
/// Atoms from which on the best of them is looked for in a tree.
const MANY: usize = 2048;
/// Most atoms of a patch; more would be no sparse description.
const MOST_SPARSITY: usize = 64;

/// How the next atom is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Choice {
    /// The atom with which the smallest residual is left once all chosen atoms are fitted anew, as paper 001,
    /// section 4.3, writes it: order-recursive matching pursuit.
    SmallestResidual,
    /// The atom most in line with the residual before: orthogonal matching pursuit (Pati et al. 1993).
    LargestCorrelation,
}

/// Which coefficients atoms may have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Signs {
    /// Any, as in the paper: a valley may be a ridge upside down.
    #[default]
    Both,
    /// Only positive ones.
    Positive,
}

/// A dictionary made ready for matching.
#[derive(Clone, Debug)]
pub struct Pursuit {
    shape: PatchShape,
    sparsity: usize,
    choice: Choice,
    signs: Signs,
    // Atoms times the roots of weights, and their square lengths.
    atoms: Vec<f32>,
    squares: Vec<f64>,
    // By how much at most the length of an atom is not 1.
    unequal: f64,
    // Where there are many, and one a patch is wanted.
    tree: Option<Tree>,
}

/// What a terrain is made of besides atoms: their coefficients, and the mean of each patch.
#[derive(Clone, Debug, PartialEq)]
pub struct Decomposition {
    /// Atoms and coefficients.
    pub codes: Codes,
    /// The height of each patch, in metres; where cells are missing, fitted together with the atoms.
    pub mean_m: Vec<f64>,
}

/// Memory of one thread.
#[derive(Default)]
struct Scratch {
    patches: Vec<f32>,
    scores: Vec<f32>,
    // Of searches in a tree.
    turns: Vec<Turn>,
    // Of pursuits of several atoms.
    directions: Vec<f32>,
    overlaps: Vec<f32>,
    outside: Vec<f32>,
    projections: Vec<Projection>,
}

impl Pursuit {
    /// Makes a dictionary ready for finding at most `sparsity` atoms for each patch.
    ///
    /// # Errors
    /// When the dictionary is empty, its side is none that patches can have, or the sparsity is not within 1 and 64.
    pub fn new(dictionary: &Dictionary, sparsity: usize, choice: Choice) -> Result<Self> {
        if dictionary.is_empty() {
            return Err(Error::usage("matching with a dictionary without atoms"));
        }
        if !(1..=MOST_SPARSITY).contains(&sparsity) {
            return Err(Error::usage(format!("a sparsity of {sparsity}: 1 to {MOST_SPARSITY} atoms are possible")));
        }
        let shape = PatchShape::new(dictionary.side())?;
        let atoms = shape.scaled(dictionary.values());
        let squares: Vec<f64> = atoms.chunks_exact(shape.disc_values()).map(|atom| dot(atom, atom)).collect();
        let unequal = squares.iter().fold(0.0, |most: f64, square| most.max((square.sqrt() - 1.0).abs()));
        let pursuit = Self { shape, sparsity, choice, signs: Signs::Both, atoms, squares, unequal, tree: None };
        Ok(pursuit.with_tree(MANY))
    }

    /// The same with other coefficients.
    ///
    /// # Errors
    /// When coefficients of several atoms are to be positive: that is not how they are found.
    pub fn with_signs(self, signs: Signs) -> Result<Self> {
        if signs == Signs::Positive && self.sparsity > 1 {
            return Err(Error::usage("positive coefficients are found for one atom a patch only"));
        }
        Ok(Self { signs, ..self }.with_tree(MANY))
    }

    /// The same with a tree where there are at least so many atoms and one a patch is wanted.
    fn with_tree(self, many: usize) -> Self {
        let is_signed = self.signs == Signs::Both;
        let tree = || Tree::new(&self.shape, &self.atoms, &self.squares, is_signed);
        let tree = (self.sparsity == 1 && self.count() >= many).then(tree);
        Self { tree, ..self }
    }

    /// Finds atoms for all patches of a terrain.
    ///
    /// # Errors
    /// When the patches have another shape than the atoms.
    ///
    /// # Complexity
    /// Patches times atoms times values times sparsity, at the speed of a product of matrices, twice that for
    /// [`Choice::SmallestResidual`] beyond the first atom; without that speed for patches with missing cells.
    pub fn decompose(&self, patches: &Patches) -> Result<Decomposition> {
        let shape = patches.layout().shape();
        if *shape != self.shape {
            let message = format!("atoms of side {} for patches of side {}", self.shape.side(), shape.side());
            return Err(Error::usage(message));
        }
        let (codes, shift_m) = self.match_all(patches.all_values_m(), |patch| patches.known(patch));
        let mean_m = patches.mean_m().iter().zip(shift_m).map(|(mean, shift)| mean + shift).collect();
        Ok(Decomposition { codes, mean_m })
    }

    /// Finds atoms for whole patches that lie one behind the other, as values above their weighted means.
    ///
    /// # Panics
    /// When the last of them is not whole.
    pub fn decompose_values(&self, values: &[f32]) -> Codes {
        assert!(values.len().is_multiple_of(self.shape.values()), "whole patches");
        self.match_all(values, |_| None).0
    }

    /// Finds atoms for samples to learn from.
    pub(super) fn match_samples(&self, samples: &Samples) -> Codes {
        self.match_all(samples.values_m(), |_| None).0
    }

    /// Codes of patches that lie one behind the other, and what to add to their means.
    fn match_all<'k>(&self, values: &[f32], known: impl Fn(usize) -> Option<&'k [bool]> + Sync) -> (Codes, Vec<f64>) {
        let size = self.shape.values();
        let count = values.len() / size;
        let mut codes = Codes::new(count, self.sparsity);
        let mut shifts = vec![0.0; count];
        let rows = if self.tree.is_some() { TREE_BLOCK } else { BLOCK };
        let blocks = values.par_chunks(rows * size).zip(codes.blocks_mut(rows)).zip(shifts.par_chunks_mut(rows));
        blocks.enumerate().for_each_init(Scratch::default, |scratch, (block, ((values, mut codes), shifts))| {
            vectorised(
                #[inline(always)]
                || {
                    if let Some(tree) = &self.tree {
                        self.match_in(tree, values, &mut codes, scratch);
                    } else if self.signs == Signs::Positive {
                        self.match_single::<false>(values, &mut codes, scratch);
                    } else if self.sparsity == 1 {
                        self.match_single::<true>(values, &mut codes, scratch);
                    } else {
                        self.match_several(values, &mut codes, scratch);
                    }
                },
            );
            for (row, shift) in shifts.iter_mut().enumerate() {
                if let Some(known) = known(block * rows + row) {
                    *shift = self.match_partial(&values[row * size..][..size], known, &mut codes, row);
                }
            }
        });
        (codes, shifts)
    }

    /// One atom, times the roots of weights.
    #[inline(always)]
    pub(super) fn atom(&self, atom: usize) -> &[f32] {
        let size = self.shape.disc_values();
        &self.atoms[atom * size..][..size]
    }

    /// Number of atoms.
    fn count(&self) -> usize {
        self.squares.len()
    }

    /// How far a score can be off where an atom is multiplied with a vector of length 1.
    ///
    /// Both sides count: the fast product, and the sums in double precision (2⁻⁴⁰ is more than enough for them).
    fn score_error(&self) -> f64 {
        let size = self.shape.disc_values();
        let double = 1.0 / (1u64 << 40) as f64;
        (product_error(size) + double) * (1.0 + self.unequal) + size as f64 * UNDERFLOW
    }

    /// Scales a block of patches.
    #[inline(always)]
    fn scale_block(&self, values: &[f32], out: &mut Vec<f32>) -> usize {
        let size = self.shape.disc_values();
        let rows = values.len() / self.shape.values();
        out.resize(rows * size, 0.0);
        for (patch, out) in values.chunks_exact(self.shape.values()).zip(out.chunks_exact_mut(size)) {
            self.shape.scale_into(patch, out);
        }
        rows
    }

    /// Finds atoms for a patch with missing cells, by comparing all in double precision; what to add to its mean.
    fn match_partial(&self, values: &[f32], known: &[bool], codes: &mut Block, row: usize) -> f64 {
        let mut patch = vec![0.0; self.shape.disc_values()];
        self.shape.scale_into(values, &mut patch);
        for (value, &known) in patch.iter_mut().zip(known) {
            *value = if known { *value } else { 0.0 };
        }
        let mut projection = Projection::default();
        projection.begin_partial(&patch, known, self.shape.roots());
        let whole = projection.error();
        // Square lengths of what is seen of each atom, without its constant part; less with each atom chosen.
        let mut outside: Vec<f64> = (0..self.count())
            .map(|k| {
                let atom = self.atom(k);
                let seen = atom.iter().zip(known).filter(|(_, known)| **known);
                projection.outside(atom, seen.map(|(&v, _)| f64::from(v) * f64::from(v)).sum())
            })
            .collect();
        let first = outside.clone();
        while projection.atoms().len() < self.sparsity && projection.error() > LEAST_GAIN * whole {
            let mut best = (0.0, None);
            for k in 0..self.count() {
                let length = match self.choice {
                    Choice::SmallestResidual => outside[k],
                    Choice::LargestCorrelation => first[k],
                };
                if length < LEAST_NEW {
                    continue;
                }
                let correlation = projection.correlation(self.atom(k));
                if self.signs == Signs::Positive && correlation <= 0.0 {
                    continue;
                }
                let gain = correlation * correlation / length;
                if gain > best.0 && !projection.atoms().contains(&(k as u32)) {
                    best = (gain, Some(k));
                }
            }
            let (gain, Some(k)) = best else { break };
            if gain <= LEAST_GAIN * whole || !projection.take(k as u32, self.atom(k), Some(known)) {
                break;
            }
            if self.choice == Choice::SmallestResidual {
                for (k, outside) in outside.iter_mut().enumerate() {
                    let part = dot(projection.last_direction(), self.atom(k));
                    *outside -= part * part;
                }
            }
        }
        let (parts, shift) = projection.coefficients();
        codes.set(row, projection.atoms(), &parts);
        shift
    }
}
