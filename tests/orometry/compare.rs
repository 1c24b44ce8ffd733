//! Two answers, compared field by field.

use super::reference::{Answer, RefEdge, RefPeak};
use std::fmt::Debug;

/// How equal lengths must be.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// Relative, for the prominence: 0 unless a base level in a unit that is not exact comes in.
    pub prominence: f64,
    /// Relative, for the lower bound of the isolation: 0 where distances that are equal on paper are equal to the bit.
    pub isolation_min: f64,
}

struct Differences(Vec<String>);

impl Differences {
    fn same<T: PartialEq + Debug>(&mut self, place: &str, field: &str, got: &T, want: &T) {
        if got != want {
            self.0.push(format!("{place}: {field} is {got:?}, should be {want:?}"));
        }
    }

    fn near(&mut self, place: &str, field: &str, got: Option<f64>, want: Option<f64>, tolerance: f64) {
        if !is_near(got, want, tolerance) {
            self.0.push(format!("{place}: {field} is {got:?}, should be {want:?}"));
        }
    }
}

/// Equal to the bit, or within a relative tolerance; NaN equals NaN.
fn is_near(got: Option<f64>, want: Option<f64>, tolerance: f64) -> bool {
    match (got, want) {
        (None, None) => true,
        (Some(a), Some(b)) => (a.is_nan() && b.is_nan()) || a == b || (a - b).abs() <= tolerance * a.abs().max(b.abs()),
        _ => false,
    }
}

fn peak(found: &mut Differences, got: &RefPeak, want: &RefPeak, tolerance: Tolerance) {
    let place = format!("peak {} at cell {}", want.id, want.cell);
    let t = tolerance.prominence;
    found.same(&place, "id", &got.id, &want.id);
    found.same(&place, "cell", &got.cell, &want.cell);
    found.near(&place, "elevation_m", Some(got.elevation_m), Some(want.elevation_m), 0.0);
    found.near(&place, "prominence_m", Some(got.prominence_m), Some(want.prominence_m), t);
    found.near(&place, "prominence_min_m", Some(got.prominence_min_m), Some(want.prominence_min_m), t);
    found.same(&place, "prominence_certain", &got.prominence_certain, &want.prominence_certain);
    found.same(&place, "is_root", &got.is_root, &want.is_root);
    found.same(&place, "key_saddle", &got.key_saddle, &want.key_saddle);
    found.near(&place, "key_saddle_elevation_m", got.key_saddle_elevation_m, want.key_saddle_elevation_m, 0.0);
    found.near(&place, "saddle_distance_m", got.saddle_distance_m, want.saddle_distance_m, 0.0);
    found.near(&place, "saddle_azimuth", got.saddle_azimuth, want.saddle_azimuth, 0.0);
    found.same(&place, "island_parent", &got.island_parent, &want.island_parent);
    found.same(&place, "prominence_parent", &got.prominence_parent, &want.prominence_parent);
    found.same(&place, "line_parent", &got.line_parent, &want.line_parent);
    match (&got.isolation, &want.isolation) {
        (Some(g), Some(w)) => {
            found.near(&place, "isolation_m", g.isolation_m, w.isolation_m, 0.0);
            found.same(&place, "higher cell", &g.higher, &w.higher);
            found.near(&place, "isolation_azimuth", Some(g.azimuth), Some(w.azimuth), 0.0);
            let t = tolerance.isolation_min;
            found.near(&place, "isolation_min_m", g.isolation_min_m, w.isolation_min_m, t);
            // A tie of higher and unknown ground that is not exact may fall either way.
            let tie = t > 0.0 && is_near(w.isolation_m, w.isolation_min_m, t);
            if !tie {
                found.same(&place, "isolation_certain", &g.certain, &w.certain);
            }
            if g.certain != (g.isolation_m == g.isolation_min_m) {
                found.0.push(format!("{place}: isolation_certain contradicts its numbers: {g:?}"));
            }
        }
        (g, w) => found.same(&place, "isolation", g, w),
    }
    let t = t.max(4e-16);
    found.near(&place, "dominance", got.dominance, want.dominance, t);
    found.near(&place, "relative_prominence", got.relative_prominence, want.relative_prominence, t);
    found.near(&place, "relative_elevation", got.relative_elevation, want.relative_elevation, t);
    found.near(&place, "relevance", got.relevance, want.relevance, t);
}

fn edge(found: &mut Differences, got: &RefEdge, want: &RefEdge, tolerance: Tolerance) {
    let place = format!("edge over the saddle of peak {}", want.saddle);
    let ends = |e: &RefEdge| (e.peak_a, e.peak_b, e.saddle, e.saddle_cell);
    found.same(&place, "(a, b, saddle, cell)", &ends(got), &ends(want));
    found.near(&place, "saddle_elevation_m", Some(got.saddle_elevation_m), Some(want.saddle_elevation_m), 0.0);
    found.near(&place, "prominence_m", Some(got.prominence_m), Some(want.prominence_m), tolerance.prominence);
    found.same(&place, "path", &got.path, &want.path);
}

/// What differs between an answer and the right one; empty if nothing does.
pub fn differences(got: &Answer, want: &Answer, tolerance: Tolerance) -> Vec<String> {
    let mut found = Differences(vec![]);
    let cells = |a: &Answer| a.peaks.iter().map(|p| (p.id, p.cell)).collect::<Vec<_>>();
    found.same("peaks", "(id, cell)", &cells(got), &cells(want));
    let saddles = |a: &Answer| a.edges.iter().map(|e| e.saddle).collect::<Vec<_>>();
    found.same("edges", "saddles", &saddles(got), &saddles(want));
    if found.0.is_empty() {
        for (g, w) in got.peaks.iter().zip(&want.peaks) {
            peak(&mut found, g, w, tolerance);
        }
        for (g, w) in got.edges.iter().zip(&want.edges) {
            edge(&mut found, g, w, tolerance);
        }
    }
    found.0
}
