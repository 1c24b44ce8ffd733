//! Prominence and isolation of a given tree, by looking at everything.

use orograph::crs::{Metric, Place};
use orograph::grid::Cell;
use orograph::orometry::GivenTree;

pub fn place(tree: &GivenTree, cell: Cell) -> Place {
    ((cell / tree.cols as u64) as i64, (cell % tree.cols as u64) as i64)
}

/// For each peak the lowest saddle of the way to every other peak; peaks are joined to themselves by nothing.
fn ways(tree: &GivenTree, from: usize) -> Vec<f64> {
    let mut lowest = vec![f64::NAN; tree.peaks.len()];
    lowest[from] = f64::INFINITY;
    let mut todo = vec![from];
    while let Some(here) = todo.pop() {
        for pass in &tree.passes {
            let [a, b] = pass.peaks.map(|peak| peak as usize);
            for (a, b) in [(a, b), (b, a)] {
                if a == here && lowest[b].is_nan() {
                    lowest[b] = lowest[a].min(pass.elevation_m);
                    todo.push(b);
                }
            }
        }
    }
    lowest
}

/// Prominences in metres: height above the highest of the lowest saddles of the ways to strictly higher peaks, and the
/// height of the highest peak.
pub fn prominences_m(tree: &GivenTree) -> Vec<f64> {
    let of = |peak: usize| {
        let own_m = tree.peaks[peak].1;
        let ways = ways(tree, peak);
        let higher = (0..tree.peaks.len()).filter(|&other| tree.peaks[other].1 > own_m);
        higher.map(|other| ways[other]).reduce(f64::max).map_or(own_m, |saddle_m| own_m - saddle_m)
    };
    (0..tree.peaks.len()).map(of).collect()
}

/// Distances in metres to the nearest strictly higher peak.
pub fn isolations_m<M: Metric>(tree: &GivenTree, metric: &M) -> Vec<Option<f64>> {
    (0..tree.peaks.len()).map(|peak| nearest_higher(tree, metric, peak).map(|(isolation_m, _)| isolation_m)).collect()
}

/// Those distances of all peaks but the highest, each with the metres by which that peak is higher.
pub fn rises_m<M: Metric>(tree: &GivenTree, metric: &M) -> Vec<(f64, f64)> {
    let of = |peak: usize| {
        nearest_higher(tree, metric, peak).map(|(isolation_m, higher_m)| (isolation_m, higher_m - tree.peaks[peak].1))
    };
    (0..tree.peaks.len()).filter_map(of).collect()
}

/// Distance to the nearest strictly higher peak, and its elevation, both in metres.
fn nearest_higher<M: Metric>(tree: &GivenTree, metric: &M, peak: usize) -> Option<(f64, f64)> {
    let (cell, own_m) = tree.peaks[peak];
    let higher = tree.peaks.iter().filter(|other| other.1 > own_m);
    let seen = higher.map(|other| (metric.distance_m(place(tree, cell), place(tree, other.0)), other.1));
    seen.min_by(|a, b| a.0.total_cmp(&b.0))
}
