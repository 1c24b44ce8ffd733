//! A random forest: trees that each saw other samples and other features.

use super::samples::Samples;
use super::tree::Tree;
use crate::error::{Error, ErrorKind, Result};
use crate::rng::Rng;
use crate::watch::Watch;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// A random forest (Breiman 2001, doi:10.1023/A:1010933404324).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Forest {
    trees: Vec<Tree>,
}

/// How a forest is grown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ForestOptions {
    /// Number of trees.
    pub trees: usize,
    /// What samples and features are drawn by.
    pub seed: u64,
}

/// A forest just grown.
#[derive(Clone, Debug, PartialEq)]
pub struct Grown {
    /// The forest.
    pub forest: Forest,
    /// For each sample the class that those trees tell which did not see it; `None` where all did.
    pub out_of_bag: Vec<Option<usize>>,
}

impl Forest {
    /// Grows a forest.
    ///
    /// Each tree sees as many samples as there are, drawn with replacement, and tries the square root of the number of
    /// features (rounded down) at every node. It has a generator of its own, so that threads do not matter.
    ///
    /// # Errors
    /// A usage error without trees; [`ErrorKind::Interrupted`] when the watch was cancelled.
    pub fn grow(samples: &Samples, options: &ForestOptions, watch: &Watch) -> Result<Grown> {
        if options.trees == 0 {
            return Err(Error::usage("a forest has at least one tree"));
        }
        let tried = samples.features().isqrt().max(1);
        let grow = |number: usize| {
            let mut rng = Rng::for_part(options.seed, number as u64);
            let weights = bag(samples.len(), &mut rng);
            let tree = Tree::grow(samples, &weights, tried, &mut rng);
            watch.advance(1)?;
            Ok((tree, weights))
        };
        let grown: Vec<(Tree, Vec<u32>)> = (0..options.trees).into_par_iter().map(grow).collect::<Result<_>>()?;
        #[allow(clippy::cast_possible_truncation, reason = "at most MOST_SAMPLES")]
        let out_of_bag = (0..samples.len() as u32)
            .into_par_iter()
            .map(|sample| {
                let row = samples.row(sample);
                let unseen = grown.iter().filter(|(_, weights)| weights[sample as usize] == 0);
                let (sum, trees) = added(unseen.map(|(tree, _)| tree), &row, samples.classes());
                (trees > 0).then(|| first_greatest(&sum))
            })
            .collect();
        Ok(Grown { forest: Self { trees: grown.into_iter().map(|(tree, _)| tree).collect() }, out_of_bag })
    }

    /// The trees.
    pub fn trees(&self) -> &[Tree] {
        &self.trees
    }

    /// The probability of each of `classes` classes for a row of features: the mean of the shares in the leaves that
    /// it comes to.
    pub fn probabilities(&self, row: &[f64], classes: usize) -> Vec<f64> {
        let (sum, trees) = added(self.trees.iter(), row, classes);
        sum.into_iter().map(|share| share / trees.max(1) as f64).collect()
    }

    /// The most probable class, the first of equals.
    pub fn class(&self, row: &[f64], classes: usize) -> usize {
        first_greatest(&self.probabilities(row, classes))
    }

    /// Checks all trees.
    ///
    /// # Errors
    /// `Corrupt` without trees, or as [`Tree::check`].
    pub fn check(&self, features: usize, classes: usize) -> Result<()> {
        if self.trees.is_empty() {
            return Err(Error::new(ErrorKind::Corrupt, "there is no tree"));
        }
        self.trees.iter().enumerate().try_for_each(|(number, tree)| {
            tree.check(features, classes).map_err(|error| {
                let place = error.place().unwrap_or_default();
                Error::new(error.kind(), error.message()).at_place(format!("tree {number}, {place}"))
            })
        })
    }
}

/// How often each of `count` samples is among as many drawn with replacement.
fn bag(count: usize, rng: &mut Rng) -> Vec<u32> {
    let mut weights = vec![0; count];
    for _ in 0..count {
        #[allow(clippy::cast_possible_truncation, reason = "below the number of samples")]
        let drawn = rng.below(count as u64) as usize;
        weights[drawn] += 1;
    }
    weights
}

/// The shares of the classes in the leaves of some trees, added in their order, and the number of trees.
fn added<'a>(trees: impl Iterator<Item = &'a Tree>, row: &[f64], classes: usize) -> (Vec<f64>, usize) {
    let mut sum = vec![0.0; classes];
    let mut number = 0;
    for tree in trees {
        let counts = tree.leaf(row);
        let all: u64 = counts.iter().map(|&count| u64::from(count)).sum();
        sum.iter_mut().zip(counts).for_each(|(sum, &count)| *sum += f64::from(count) / all as f64);
        number += 1;
    }
    (sum, number)
}

/// The number of the greatest value, the first of equals.
pub(super) fn first_greatest(values: &[f64]) -> usize {
    (0..values.len()).fold(0, |best, i| if values[i] > values[best] { i } else { best })
}
