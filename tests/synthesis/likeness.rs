//! The histograms of what is made are those of what it is like.

use super::{range, reference};
use orograph::orometry::distributions::{BinSet, Domain, PeakMeasures, compare};
use orograph::orometry::survey_tree;
use orograph::synthesis::{Controls, Extent, SynthesisOptions, Target, synthesize};
use orograph::watch::Watch;

/// The statistics of `count` peaks made on a square of so many cells of 30 m.
fn made(target: &Target, count: usize, side: usize, seed: u64) -> Domain {
    let metric = range::cells(30.0);
    let extent = Extent::new(side, side, &metric);
    let options = SynthesisOptions { seed, ..SynthesisOptions::default() };
    let made = synthesize(&extent, &[target], &[count], &Controls::default(), &options, &Watch::default());
    let survey = survey_tree(&made.expect("a tree").tree, &metric).expect("a survey");
    let peaks: Vec<PeakMeasures> = survey.peaks.iter().map(PeakMeasures::from).collect();
    range::domain(&peaks, extent.area_km2())
}

/// The largest difference of a bin in per cent: prominence, dominance, elevation, isolation.
fn errors(range: &Domain, made: &Domain) -> [f64; 4] {
    let compared = compare(range, made, BinSet::Fine, range::RADIUS_M).expect("the same bins");
    ["prominence", "dominance", "elevation", "isolation_distance"].map(|name| {
        let of = compared.iter().find(|comparison| comparison.metric == name).expect("each measure");
        100.0 * of.largest_bin_difference.expect("none is empty")
    })
}

/// Twice over: the statistics of what was made are those of mountains that there can be, so they can be had again.
#[test]
fn within_the_bounds() {
    for (count, from_m, to_m) in [(400, 300.0, 1100.0), (700, 200.0, 2400.0), (500, 2500.0, 7300.0)] {
        let first = range::domain(&range::peaks(count, from_m, to_m, 1000.0, 7), 3600.0);
        let real = made(&range::target(&first), count, 2000, 11);
        for seed in 1..4 {
            let [prominence, dominance, elevation, isolation] =
                errors(&real, &made(&range::target(&real), count, 2000, seed));
            let said = format!("{count} {seed}: {prominence} {dominance} {elevation} {isolation}");
            assert!(prominence <= 1.0 && dominance <= 1.0 && isolation <= 4.0, "{said}");
            assert!(elevation <= 100.0 / count as f64 + 1e-9, "one count a bin: {said}");
        }
    }
}

/// Other numbers of peaks than the range has, to within a count or two a bin.
#[test]
fn fewer_and_more_peaks() {
    let first = range::domain(&range::peaks(600, 300.0, 2100.0, 1000.0, 3), 3600.0);
    let real = made(&range::target(&first), 600, 2000, 5);
    for (count, side) in [(150, 1000), (2400, 4000)] {
        let [prominence, dominance, elevation, isolation] = errors(&real, &made(&range::target(&real), count, side, 1));
        let said = format!("{count}: {prominence} {dominance} {elevation} {isolation}");
        let one = 100.0 / count as f64;
        assert!(elevation <= one + 1e-9 && prominence <= 2.0 * one + 0.5 && dominance <= 2.0 * one + 1.0, "{said}");
        assert!(isolation <= 4.0, "{said}");
    }
}

/// How often, in per cent, a close peak's nearest higher peak is at most so many metres higher.
fn close_peaks_as_high(target: &Target, count: usize, seed: u64) -> f64 {
    let metric = range::cells(30.0);
    let extent = Extent::new(2000, 2000, &metric);
    let options = SynthesisOptions { seed, ..SynthesisOptions::default() };
    let made = synthesize(&extent, &[target], &[count], &Controls::default(), &options, &Watch::default());
    let rises_m = reference::rises_m(&made.expect("a tree").tree, &metric);
    let close: Vec<f64> =
        rises_m.into_iter().filter(|&(isolation_m, _)| isolation_m < CLOSE_M).map(|(_, m)| m).collect();
    assert!(close.len() > count / 4, "{} of {count} peaks are close to a higher one", close.len());
    100.0 * close.iter().filter(|&&rise_m| rise_m <= ALIKE_M).count() as f64 / close.len() as f64
}

/// Isolations below are those of close peaks, in metres; rises up to that are those of peaks that are about as high.
const CLOSE_M: f64 = 1200.0;
const ALIKE_M: f64 = 100.0;

/// Where a range's close peaks are about as high as each other, those of what is made like it are, and its histograms
/// are as good; where nobody knows, they are as it happens.
#[test]
fn close_peaks_are_as_high_as_they_should_be() {
    let first = range::domain(&range::peaks(600, 300.0, 2100.0, 1000.0, 3), 3600.0);
    let real = made(&range::target(&first), 600, 2000, 5);
    let rises_m: Vec<(f64, f64)> = (0..600).map(|i| f64::from(i) * 10.0).map(|m| (m, m * 0.05)).collect();
    // The order in which they are given means nothing.
    let knowing = range::target(&real).with_rises(rises_m.into_iter().rev().collect());
    for seed in 1..4 {
        let [before, after] = [&range::target(&real), &knowing].map(|target| close_peaks_as_high(target, 600, seed));
        assert!(before < 50.0 && after > 60.0, "{seed}: {before} % without, {after} % with the rises");
        let [prominence, dominance, elevation, isolation] = errors(&real, &made(&knowing, 600, 2000, seed));
        let said = format!("{seed}: {prominence} {dominance} {elevation} {isolation}");
        assert!(
            prominence <= 1.0 && dominance <= 1.0 && elevation <= 100.0 / 600.0 + 1e-9 && isolation <= 4.0,
            "{said}"
        );
    }
}

#[test]
fn other_seeds_make_other_trees() {
    let target = range::target(&range::domain(&range::peaks(80, 300.0, 2100.0, 1000.0, 3), 400.0));
    let metric = range::cells(30.0);
    let extent = Extent::new(700, 700, &metric);
    let make = |seed| {
        let options = SynthesisOptions { seed, ..SynthesisOptions::default() };
        synthesize(&extent, &[&target], &[80], &Controls::default(), &options, &Watch::default()).expect("a tree").tree
    };
    let (one, two) = (make(1), make(2));
    assert_ne!(one.peaks[0].0, two.peaks[0].0);
    assert_eq!(one, make(1));
}

#[test]
fn a_range_of_one_peak() {
    let target = range::target(&range::domain(&range::peaks(1, 700.0, 2100.0, 1000.0, 3), 400.0));
    let metric = range::cells(30.0);
    let extent = Extent::new(100, 100, &metric);
    let make = |count: usize| {
        let options = SynthesisOptions::default();
        synthesize(&extent, &[&target], &[count], &Controls::default(), &options, &Watch::default())
    };
    assert_eq!(make(1).expect("a peak").tree.passes, []);
    let error = make(2).expect_err("no distance").to_string();
    assert!(error.contains("how far 2 are to be"), "{error}");
}

#[test]
fn statistics_without_what_is_needed() {
    let mut peaks = range::peaks(9, 700.0, 2100.0, 1000.0, 3);
    let refused = |peaks: &[PeakMeasures]| {
        Target::of(&range::domain(peaks, 400.0), range::RADIUS_M, None).expect_err("refused").to_string()
    };
    assert!(refused(&[]).contains("no peaks"));
    peaks.iter_mut().for_each(|peak| peak.isolation_m = None);
    assert!(refused(&peaks).contains("no isolations"));
}
