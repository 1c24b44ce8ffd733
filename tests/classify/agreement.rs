//! Trees are the reference's, node by node; forests are sums of trees.

use super::{reference, samples};
use orograph::classify::{Forest, ForestOptions, Samples, Tree};
use orograph::error::ErrorKind;
use orograph::rng::Rng;
use orograph::watch::Watch;
use proptest::prelude::*;

fn forest(samples: &Samples, trees: usize, seed: u64, threads: usize) -> orograph::classify::Grown {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let options = ForestOptions { trees, seed };
    pool.install(|| Forest::grow(samples, &options, &Watch::default())).expect("grown")
}

/// How often each sample was drawn for a tree, and the generator after that.
fn bag(samples: &Samples, seed: u64, tree: u64) -> (Vec<u32>, Rng) {
    let mut rng = Rng::for_part(seed, tree);
    let mut weights = vec![0; samples.len()];
    for _ in 0..samples.len() {
        weights[rng.below(samples.len() as u64) as usize] += 1;
    }
    (weights, rng)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_split_is_the_reference(count in 1_usize..60, features in 1_usize..9, classes in 1_u32..5, tried in 1_usize..9, seed: u64) {
        let samples = samples(count, features, classes, seed);
        let (weights, rng) = bag(&samples, seed, 7);
        let tree = Tree::grow(&samples, &weights, tried, &mut rng.clone());
        prop_assert_eq!(tree.nodes(), reference::grow(&samples, &weights, tried, &mut rng.clone()));
        prop_assert!(tree.check(features, classes as usize).is_ok());
        // What a tree has seen it knows, but for twins of other classes.
        for member in (0..count as u32).filter(|&m| weights[m as usize] > 0) {
            prop_assert!(tree.leaf(&samples.row(member))[samples.label(member) as usize] >= weights[member as usize]);
        }
    }
}

#[test]
fn a_forest_is_its_trees() {
    let samples = samples(90, 9, 3, 5);
    let grown = forest(&samples, 30, 11, 2);
    assert_eq!(grown.forest.trees().len(), 30);
    let mut told = vec![];
    for (number, tree) in grown.forest.trees().iter().enumerate() {
        let (weights, mut rng) = bag(&samples, 11, number as u64);
        assert_eq!(tree.nodes(), reference::grow(&samples, &weights, 3, &mut rng), "three of nine features are tried");
        told.push(weights);
    }
    for sample in 0..90_u32 {
        let row = samples.row(sample);
        let share = |tree: &Tree, class: usize| {
            let counts = tree.leaf(&row);
            f64::from(counts[class]) / f64::from(counts.iter().sum::<u32>())
        };
        let trees = || grown.forest.trees().iter().zip(&told);
        let mean = |class: usize| trees().map(|(tree, _)| share(tree, class)).fold(0.0, |a, b| a + b) / 30.0;
        let probabilities = grown.forest.probabilities(&row, 3);
        assert_eq!(probabilities, [mean(0), mean(1), mean(2)]);
        let unseen = |class: usize| -> f64 {
            let trees = trees().filter(|(_, weights)| weights[sample as usize] == 0);
            trees.map(|(tree, _)| share(tree, class)).fold(0.0, |a, b| a + b)
        };
        let sums = [unseen(0), unseen(1), unseen(2)];
        let told = grown.out_of_bag[sample as usize].expect("thirty trees do not all see a sample");
        assert!(sums.iter().all(|&sum| sum <= sums[told]) && sums[..told].iter().all(|&sum| sum < sums[told]));
    }
}

#[test]
fn threads_do_not_matter_and_seeds_do() {
    let samples = samples(120, 12, 4, 1);
    let [one, three, other] = [(3, 1), (3, 3), (4, 2)].map(|(seed, threads)| forest(&samples, 25, seed, threads));
    assert_eq!(one, three);
    assert_ne!(one.forest, other.forest);
    // More trees of a seed are the same trees and some more.
    assert_eq!(forest(&samples, 40, 3, 2).forest.trees()[..25], *one.forest.trees());
}

#[test]
fn what_can_be_learned_is_learned() {
    let (learned, asked) = (samples(400, 6, 2, 8), samples(400, 6, 2, 9));
    let grown = forest(&learned, 60, 0, 2);
    let right = (0..400).filter(|&i| grown.forest.class(&asked.row(i), 2) == asked.label(i) as usize).count();
    let out_of_bag = (0..400).filter(|&i| grown.out_of_bag[i] == Some(learned.label(i as u32) as usize)).count();
    // The first feature alone tells half of them for certain: 3 of 4 are right by guessing the rest.
    assert!(right > 280 && out_of_bag > 280, "{right} {out_of_bag}");
}

#[test]
fn nothing_grows_without_trees_or_when_nobody_wants_it() {
    let samples = samples(10, 3, 2, 1);
    let none = Forest::grow(&samples, &ForestOptions { trees: 0, seed: 0 }, &Watch::default()).unwrap_err();
    assert_eq!(none.kind(), ErrorKind::Usage);
    let watch = Watch::default();
    watch.cancel();
    let stopped = Forest::grow(&samples, &ForestOptions { trees: 2, seed: 0 }, &watch).unwrap_err();
    assert_eq!(stopped.kind(), ErrorKind::Interrupted);
}
