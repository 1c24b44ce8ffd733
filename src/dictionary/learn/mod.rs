//! Learning a dictionary from patches (paper 001, section 4.4).
//!
//! Two steps take turns: atoms are found for all patches ([`super::pursuit`]), then each atom is improved for the
//! patches that use it. Their residuals without it, as columns, are a matrix E; the best unit atom d explains most of
//! it, and `dᵀ E Eᵀ d` says how much. So all that is needed of E is its Gram matrix, which is small: its leading
//! eigenvector is K-SVD's new atom, and for atoms that must be real patches the form is computed for all of them.
//!
//! The error never rises: a patch keeps its old atoms where new ones are worse, and an atom stays where another,
//! rounded to `f32`, is no better. Atoms that nobody needs make room for the patches that are explained worst. Results do not depend on threads or the machine.

mod constrained;
mod renew;
mod residuals;

use super::atoms::{Dictionary, Origin, Samples};
use super::codes::Codes;
use super::pursuit::{Choice, Projection, Pursuit};
use crate::error::{Error, Result};
use crate::linalg::{dot, leading_eigenvector, quadratic};
use crate::watch::Watch;
use constrained::Candidates;
use rayon::prelude::*;
use residuals::{Residuals, User};

/// How long and for what a dictionary is learned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Learning {
    /// Turns of matching and improving.
    pub iterations: usize,
    /// Most atoms of a patch.
    pub sparsity: usize,
    /// How atoms are chosen.
    pub choice: Choice,
}

/// A learned dictionary.
#[derive(Clone, Debug, PartialEq)]
pub struct Learned {
    /// The atoms.
    pub dictionary: Dictionary,
    /// The error after each iteration: sum of the weighted squares of what is not explained, in square metres.
    pub error_m2: Vec<f64>,
}

/// A new atom.
struct Substitute {
    values: Vec<f32>,
    origin: Origin,
}

/// What becomes of an atom, and the coefficients with which its users take it.
struct Improved {
    substitute: Option<Substitute>,
    parts: Vec<f64>,
}

/// Learns a dictionary whose atoms are combinations of patches: K-SVD (Aharon, Elad, Bruckstein 2006), from a
/// dictionary to start with.
///
/// # Errors
/// When there are no samples, shapes differ, the sparsity is out of range, or the job is cancelled.
///
/// # Complexity
/// An iteration matches all patches, and adds up an outer product of the disc's values for each coefficient.
pub fn learn(samples: &Samples, start: Dictionary, how: &Learning, watch: &Watch) -> Result<Learned> {
    run(samples, start, how, None, watch)
}

/// Learns a dictionary whose atoms are all taken from `candidates`: real patches, or windows of noise (paper 001,
/// problem 2). The dictionary to start with is `count` of them, drawn by `seed`.
///
/// # Errors
/// As [`learn`].
///
/// # Complexity
/// An iteration multiplies all candidates with a matrix as large as the disc's values for each atom.
pub fn learn_constrained(
    samples: &Samples,
    candidates: &Dictionary,
    (count, seed): (usize, u64),
    how: &Learning,
    watch: &Watch,
) -> Result<Learned> {
    if candidates.is_empty() || candidates.side() != samples.shape().side() {
        let (n, side) = (candidates.len(), candidates.side());
        let message = format!("{n} candidates of side {side} for patches of side {}", samples.shape().side());
        return Err(Error::usage(message));
    }
    run(samples, candidates.draw(count, seed), how, Some(&Candidates::new(candidates, samples.shape())), watch)
}

fn run(
    samples: &Samples,
    dictionary: Dictionary,
    how: &Learning,
    candidates: Option<&Candidates>,
    watch: &Watch,
) -> Result<Learned> {
    if samples.is_empty() {
        return Err(Error::usage("learning from no patches"));
    }
    if dictionary.side() != samples.shape().side() {
        let (atoms, patches) = (dictionary.side(), samples.shape().side());
        return Err(Error::usage(format!("atoms of side {atoms} for patches of side {patches}")));
    }
    watch.begin("learning", how.iterations as u64);
    let mut state = Residuals::new(samples, dictionary);
    let (mut error_m2, mut errors) = (vec![], vec![]);
    for iteration in 0..how.iterations {
        let pursuit = Pursuit::new(&state.dictionary, how.sparsity, how.choice)?;
        let mut found = pursuit.match_samples(samples);
        if iteration > 0 {
            keep_better(&state, &pursuit, &errors, &mut found);
        }
        state.codes = found;
        improve_all(&mut state, candidates, watch)?;
        errors = state.errors(&state.codes);
        renew::renew(&mut state, &mut errors, candidates);
        error_m2.push(errors.iter().sum());
        watch.advance(1)?;
    }
    Ok(Learned { dictionary: state.dictionary, error_m2 })
}

/// Puts the old atoms of a patch back where the new ones leave more of it.
fn keep_better(state: &Residuals, pursuit: &Pursuit, old_errors: &[f64], found: &mut Codes) {
    let mut projection = Projection::default();
    let mut patch = vec![0.0; state.samples.shape().disc_values()];
    for (i, error) in state.errors(found).into_iter().enumerate() {
        if error <= old_errors[i] {
            continue;
        }
        let (atoms, parts) = state.codes.get(i);
        state.samples.shape().scale_into(state.samples.patch_m(i), &mut patch);
        projection.begin(&patch);
        let fits = atoms.iter().all(|&k| projection.take(k, pursuit.atom(k as usize), None));
        if fits && projection.error() <= old_errors[i] {
            found.set(i, atoms, &projection.coefficients().0);
        } else {
            found.set(i, atoms, parts);
        }
    }
}

/// Improves all atoms in their order, each for the residuals that the ones before it leave.
fn improve_all(state: &mut Residuals, candidates: Option<&Candidates>, watch: &Watch) -> Result<()> {
    let users = state.codes.users(state.dictionary.len());
    // With one atom a patch, atoms have nothing to do with each other; in groups, so that a job can be cancelled.
    let group = if state.codes.sparsity() == 1 { 64 } else { 1 };
    for first in (0..users.len()).step_by(group) {
        watch.check()?;
        let last = (first + group).min(users.len());
        let improved: Vec<Option<Improved>> =
            (first..last).into_par_iter().map(|k| improve(state, k, &users[k], candidates)).collect();
        for (k, improved) in (first..last).zip(improved) {
            let Some(Improved { substitute, parts }) = improved else { continue };
            for (&(patch, slot), part) in users[k].iter().zip(parts) {
                *state.codes.part_mut(patch as usize, slot as usize) = part;
            }
            if let Some(Substitute { values, origin }) = substitute {
                state.replace(k, &values, origin);
            }
        }
    }
    Ok(())
}

/// The best atom in the place of atom `k`, for those who use it.
fn improve(state: &Residuals, k: usize, users: &[User], candidates: Option<&Candidates>) -> Option<Improved> {
    if users.is_empty() {
        return None;
    }
    let gram = state.gram(users);
    let old = state.atom(k);
    let explains = |atom: &[f32]| quadratic(&gram, atom) / dot(atom, atom);
    let substitute = match candidates {
        None => {
            let mut direction: Vec<f64> = old.iter().map(|&v| f64::from(v)).collect();
            leading_eigenvector(&gram, &mut direction);
            state.combination(users, &direction).map(|values| Substitute { values, origin: Origin::Learned })
        }
        Some(candidates) => candidates
            .best(&gram)
            .map(|(values, origin)| Substitute { values: values.to_vec(), origin: origin.clone() }),
    };
    let mut scaled = vec![0.0; old.len()];
    let substitute = substitute.filter(|new| {
        state.samples.shape().scale_into(&new.values, &mut scaled);
        explains(&scaled) > explains(old)
    });
    let parts = state.parts(users, if substitute.is_some() { &scaled } else { old });
    Some(Improved { substitute, parts })
}
