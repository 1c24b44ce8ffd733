//! Where the saddles of a tree lie.

use super::extent::Extent;
use super::grow::Edge;
use super::ridges::Ridge;
use crate::crs::{Metric, Place};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::Cell;
use crate::rng::Rng;
use std::collections::BTreeSet;

/// How much of a saddle's place along its ridge is left to chance.
const CHANCE: f64 = 0.5;
/// Saddles lie in this part of their ridges.
const ALONG: (f64, f64) = (0.15, 0.85);
/// How far to the side a saddle may lie, as a part of the way to the middle of the triangle there.
const ASIDE: f64 = 0.6;
/// Cells around its place that a saddle may give way to.
const ROOM: i64 = 64;

/// Places the saddles of the edges, each in a cell of its own.
///
/// Along its ridge a saddle is nearer to the peak that is less above it, as both slopes are about as steep. To the side
/// it stays within the triangle of its peaks and the centroid of a Delaunay triangle beside them: no two of these
/// overlap, so no two ridges cross.
///
/// # Errors
/// When there is no free cell near a ridge.
pub(super) fn saddles<M: Metric + ?Sized>(
    extent: &Extent<'_, M>,
    places: &[Place],
    elevations_m: &[f64],
    edges: &[Edge],
    ridges: &[Ridge],
    rng: &mut Rng,
) -> Result<Vec<Cell>> {
    let mut taken: BTreeSet<Cell> = places.iter().map(|&place| extent.cell(place)).collect();
    let mut cells = Vec::with_capacity(edges.len());
    for edge in edges {
        let ridge = &ridges[edge.ridge as usize];
        let [a, b] = ridge.ends.map(|end| point(places[end as usize]));
        let [above_a, above_b] = ridge.ends.map(|end| elevations_m[end as usize] - edge.saddle_m);
        let even = above_a / (above_a + above_b);
        let along = (even + CHANCE * (rng.between(ALONG.0, ALONG.1) - even)).clamp(ALONG.0, ALONG.1);
        let on_line = mix(a, b, along);
        let mut sides = ridge.beside.iter().flatten();
        let side = if rng.below(2) == 0 { sides.next() } else { sides.next_back() };
        let wanted = side.map_or(on_line, |&third| {
            let c = point(places[third as usize]);
            let centroid = [0, 1].map(|i| (a[i] + b[i] + c[i]) / 3.0);
            // The square of an even number is small more often than not.
            mix(on_line, centroid, ASIDE * rng.unit() * rng.unit())
        });
        let Some(cell) = free(extent, wanted, &taken) else {
            return Err(Error::new(
                ErrorKind::Input,
                "there is no room for saddles between the peaks: give fewer peaks, or a finer --resolution",
            ));
        };
        taken.insert(cell);
        cells.push(cell);
    }
    Ok(cells)
}

fn point(place: Place) -> [f64; 2] {
    [place.0 as f64, place.1 as f64]
}

fn mix(a: [f64; 2], b: [f64; 2], part: f64) -> [f64; 2] {
    [0, 1].map(|i| a[i] + part * (b[i] - a[i]))
}

/// The free cell at a point, or the first in the rings of cells around it.
fn free<M: Metric + ?Sized>(extent: &Extent<'_, M>, at: [f64; 2], taken: &BTreeSet<Cell>) -> Option<Cell> {
    #[allow(clippy::cast_possible_truncation, reason = "between places, which are whole numbers")]
    let [row, col] = at.map(|v| v.round() as i64);
    let (rows, cols) = (extent.rows as i64, extent.cols as i64);
    (0..ROOM).find_map(|ring| {
        let ends = move |r: i64| if (r - row).abs() == ring || ring == 0 { 1 } else { 2 * ring };
        (row - ring..=row + ring)
            .flat_map(|r| (col - ring..=col + ring).step_by(ends(r) as usize).map(move |c| (r, c)))
            .filter(|&(r, c)| (0..rows).contains(&r) && (0..cols).contains(&c))
            .map(|place| extent.cell(place))
            .find(|cell| !taken.contains(cell))
    })
}
