//! The ridges that peaks could be joined by.

use super::extent::Extent;
use crate::crs::{Metric, Place};
use crate::error::Result;
use crate::tin::Triangulation;
use std::collections::BTreeMap;

/// A ridge that may become one of the tree's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ridge {
    /// Numbers of its peaks, which count from the highest; the higher one first.
    pub(super) ends: [u32; 2],
    /// What it costs to choose it.
    pub(super) weight: f64,
    /// The third peaks of the triangles beside it, where there are any.
    pub(super) beside: [Option<u32>; 2],
}

/// The ridges between peaks that stand from the highest to the lowest: the edges of their Delaunay triangulation, of
/// which real divide trees use more than 95 % (Argudo et al. 2019, section 5.2).
///
/// The weight is that of their equation 1, `d / h^rho`, with `d` the distance in metres, `h` the elevation of the lower
/// peak in metres, at least 1, and `exponent` for rho: 0 for short ridges, more for high ones.
///
/// # Errors
/// Two peaks in one place.
pub(super) fn ridges<M: Metric + ?Sized>(
    extent: &Extent<'_, M>,
    places: &[Place],
    elevations_m: &[f64],
    exponent: u8,
) -> Result<Vec<Ridge>> {
    let (row_m, col_m) = extent.steps_m(extent.rows as i64 / 2);
    let points: Vec<[f64; 2]> = places.iter().map(|&(row, col)| [col as f64 * col_m, row as f64 * row_m]).collect();
    let triangulation = Triangulation::new(&points, &[])?;
    let sorted = |a: u32, b: u32| [a.min(b), a.max(b)];
    let mut edges: BTreeMap<[u32; 2], [Option<u32>; 2]> =
        triangulation.edges().map(|[a, b]| (sorted(a, b), [None; 2])).collect();
    for triangle in triangulation.triangles() {
        for corner in 0..3 {
            let [a, b, third] = [0, 1, 2].map(|step| triangle[(corner + step) % 3]);
            let beside = edges.entry(sorted(a, b)).or_default();
            beside[usize::from(a < b)] = Some(third);
        }
    }
    let ridge = |(ends, beside): ([u32; 2], [Option<u32>; 2])| {
        let distance_m = extent.metric.distance_m(places[ends[0] as usize], places[ends[1] as usize]);
        let height = elevations_m[ends[1] as usize].max(1.0);
        let weight = (0..exponent).fold(distance_m, |weight, _| weight / height);
        Ridge { ends, weight, beside }
    };
    Ok(edges.into_iter().map(ridge).collect())
}
