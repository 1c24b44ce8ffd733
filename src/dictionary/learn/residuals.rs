//! What atoms leave of patches, computed when it is asked for.

use super::super::atoms::{Dictionary, Origin, Samples};
use super::super::codes::Codes;
use crate::linalg::{Gram, dot, vectorised};
use rayon::prelude::*;

/// A patch that uses an atom, and in which of its slots.
pub(super) type User = (u32, u32);

/// Users whose sums are taken together: never fewer than this.
const PART: usize = 512;
/// Most parts of a sum, so that they need little memory. Neither depends on threads, so sums do not either.
const PARTS: usize = 32;
/// Patches whose errors are computed together.
const BLOCK: usize = 1024;

/// Patches, atoms and codes; residuals are what the last two leave of the first.
pub(super) struct Residuals<'a> {
    pub(super) samples: &'a Samples,
    pub(super) dictionary: Dictionary,
    pub(super) codes: Codes,
    // Atoms times the roots of weights.
    atoms: Vec<f32>,
}

impl<'a> Residuals<'a> {
    /// Patches without codes yet.
    pub(super) fn new(samples: &'a Samples, dictionary: Dictionary) -> Self {
        let atoms = samples.shape().scaled(dictionary.values());
        Self { samples, dictionary, codes: Codes::new(0, 1), atoms }
    }

    /// An atom, times the roots of weights.
    #[inline(always)]
    pub(super) fn atom(&self, k: usize) -> &[f32] {
        let size = self.samples.shape().disc_values();
        &self.atoms[k * size..][..size]
    }

    /// Puts another atom at a place.
    pub(super) fn replace(&mut self, k: usize, values: &[f32], origin: Origin) {
        let size = self.samples.shape().disc_values();
        self.samples.shape().scale_into(values, &mut self.atoms[k * size..][..size]);
        self.dictionary.replace(k, values, origin);
    }

    /// What codes leave of a patch without one of its slots, times the roots of weights; `patch` is room for it.
    #[inline(always)]
    fn residual(&self, codes: &Codes, i: usize, without: Option<u32>, patch: &mut [f32], out: &mut [f64]) {
        self.samples.shape().scale_into(self.samples.patch_m(i), patch);
        out.iter_mut().zip(patch.iter()).for_each(|(out, &v)| *out = f64::from(v));
        let (atoms, parts) = codes.get(i);
        for (slot, (&k, part)) in atoms.iter().zip(parts).enumerate() {
            if without != Some(slot as u32) {
                for (out, &v) in out.iter_mut().zip(self.atom(k as usize)) {
                    *out -= part * f64::from(v);
                }
            }
        }
    }

    /// The square length of what codes leave of each patch.
    pub(super) fn errors(&self, codes: &Codes) -> Vec<f64> {
        let size = self.samples.shape().disc_values();
        let mut errors = vec![0.0; self.samples.len()];
        errors.par_chunks_mut(BLOCK).enumerate().for_each(|(block, errors)| {
            let (mut patch, mut residual) = (vec![0.0; size], vec![0.0; size]);
            vectorised(
                #[inline(always)]
                || {
                    for (i, error) in errors.iter_mut().enumerate() {
                        self.residual(codes, block * BLOCK + i, None, &mut patch, &mut residual);
                        *error = dot(&residual, &residual);
                    }
                },
            );
        });
        errors
    }

    /// Calls `work` for parts of the users, in parallel, with room for a patch; results in the order of the parts.
    fn parted<T: Send>(&self, users: &[User], work: impl Fn(&[User], &mut [f32]) -> T + Sync) -> Vec<T> {
        let part = PART.max(users.len().div_ceil(PARTS));
        let size = self.samples.shape().disc_values();
        users.par_chunks(part).map(|users| work(users, &mut vec![0.0; size])).collect()
    }

    /// The sum of the outer products of the users' residuals.
    pub(super) fn gram(&self, users: &[User]) -> Vec<f64> {
        let size = self.samples.shape().disc_values();
        let parts = self.parted(users, |users, patch| {
            let mut gram = Gram::new(size);
            // As many as are added up in one go.
            let mut four = vec![0.0; 4 * size];
            vectorised(
                #[inline(always)]
                || {
                    for users in users.chunks(4) {
                        for (&(i, slot), out) in users.iter().zip(four.chunks_exact_mut(size)) {
                            self.residual(&self.codes, i as usize, Some(slot), patch, out);
                        }
                        gram.add(&four[..users.len() * size]);
                    }
                },
            );
            gram
        });
        let mut sum = Gram::new(size);
        parts.iter().for_each(|part| sum.join(part));
        sum.finish()
    }

    /// The outer product of what is left of one patch.
    pub(super) fn own_gram(&self, i: usize) -> Vec<f64> {
        let size = self.samples.shape().disc_values();
        let (mut patch, mut residual, mut gram) = (vec![0.0; size], vec![0.0; size], Gram::new(size));
        self.residual(&self.codes, i, None, &mut patch, &mut residual);
        gram.add(&residual);
        gram.finish()
    }

    /// The coefficients with which an atom explains most of the users' residuals.
    pub(super) fn parts(&self, users: &[User], atom: &[f32]) -> Vec<f64> {
        let square = dot(atom, atom);
        let parts = self.parted(users, |users, patch| {
            let mut residual = vec![0.0; atom.len()];
            vectorised(
                #[inline(always)]
                || {
                    let mut part = |&(i, slot): &User| {
                        self.residual(&self.codes, i as usize, Some(slot), patch, &mut residual);
                        dot(&residual, atom) / square
                    };
                    users.iter().map(&mut part).collect::<Vec<f64>>()
                },
            )
        });
        parts.concat()
    }

    /// The sum of the users' residuals, each as often as it goes along a direction, as an atom. All values of the
    /// square, as the disc's corners have no part in the direction.
    pub(super) fn combination(&self, users: &[User], direction: &[f64]) -> Option<Vec<f32>> {
        let shape = self.samples.shape();
        let sums = self.parted(users, |users, patch| {
            let mut residual = vec![0.0; direction.len()];
            let mut sum = vec![0.0; shape.values()];
            vectorised(
                #[inline(always)]
                || {
                    for &(i, slot) in users {
                        self.residual(&self.codes, i as usize, Some(slot), patch, &mut residual);
                        let along = dot(&residual, direction);
                        let values = self.samples.patch_m(i as usize);
                        sum.iter_mut().zip(values).for_each(|(sum, &v)| *sum += along * f64::from(v));
                        let (atoms, parts) = self.codes.get(i as usize);
                        for (other, (&k, part)) in atoms.iter().zip(parts).enumerate() {
                            if other as u32 != slot {
                                let values = self.dictionary.atom(k as usize);
                                sum.iter_mut().zip(values).for_each(|(sum, &v)| *sum -= along * part * f64::from(v));
                            }
                        }
                    }
                },
            );
            sum
        });
        let mut values = vec![0.0; shape.values()];
        for sum in sums {
            values.iter_mut().zip(sum).for_each(|(value, part)| *value += part);
        }
        let mean = shape.mean(&values);
        values.iter_mut().for_each(|v| *v -= mean);
        let norm = shape.norm(&values);
        let atom: Vec<f32> = values.iter().map(|v| (v / norm) as f32).collect();
        (norm > 0.0 && atom.iter().all(|v| v.is_finite())).then_some(atom)
    }
}
