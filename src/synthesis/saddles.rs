//! Where the saddles of a tree lie.

use super::crossing::{Line, cross, is_beside};
use super::extent::Extent;
use super::grow::Edge;
use super::kept::Kept;
use super::ridges::{Joint, Ridge, Web};
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
/// Along its ridge a saddle is nearer to the end that is less above it, as both slopes are about as steep. To the side
/// it stays within the triangle of its joints and the centroid of a Delaunay triangle beside them: no two of these
/// overlap, so no two ridges cross. Where something is kept, so that its ridges may pass by closely, that holds for the
/// cell of the saddle, too; a triangle without any cell takes one from which no ridge is crossed.
///
/// Kept saddles are where they are.
///
/// # Errors
/// When there is no free cell near a ridge.
pub(super) fn saddles<M: Metric + ?Sized>(
    extent: &Extent<'_, M>,
    elevations_m: &[f64],
    edges: &[Edge],
    web: &Web,
    kept: &Kept,
    rng: &mut Rng,
) -> Result<Vec<Cell>> {
    let peaks = web.joints.iter().take(elevations_m.len());
    let mut taken: BTreeSet<Place> = peaks.map(|peak| place(peak.twice)).collect();
    taken.extend(kept.cells());
    let mut found: Vec<Option<Place>> = Vec::with_capacity(edges.len());
    let mut wishes = Vec::with_capacity(edges.len());
    for edge in edges {
        let ridge = &web.ridges[edge.ridge as usize];
        if let Some(kept_ridge) = ridge.kept {
            found.push(Some(kept.ridges[kept_ridge as usize].saddle));
            wishes.push([0.0; 2]);
            continue;
        }
        let wish = wish(ridge, &web.joints, edge.saddle_m, rng);
        let is_good = |&to: &Place| !taken.contains(&to) && (kept.is_empty() || is_clear(ridge, &web.joints, to));
        let cell = around(extent, wish, ROOM).find(is_good);
        taken.extend(cell);
        found.push(cell);
        wishes.push(wish);
    }
    // Those whose triangles hold no cell come last, when all other ridges are known.
    for number in (0..edges.len()).filter(|&number| found[number].is_none()).collect::<Vec<_>>() {
        let ridge = |number: usize| &web.ridges[edges[number].ridge as usize];
        let own = ridge(number);
        if !kept.is_empty() {
            let ends = own.joints.map(|joint| web.start(joint, kept).map(|at| 2 * at));
            let steps = web.steps.iter().map(|step| step.map(|joint| web.joints[joint as usize].twice));
            let made = (0..edges.len()).filter(|&other| ridge(other).kept.is_none()).filter_map(|other| {
                let (row, col) = found[other]?;
                let ends = ridge(other).joints.map(|joint| web.start(joint, kept).map(|at| 2 * at));
                Some(ends.map(|end| [end, [2 * row, 2 * col]]))
            });
            let lines: Vec<Line> = steps.chain(made.flatten()).collect();
            let is_good = |&(row, col): &Place| {
                let mine = ends.map(|end| [end, [2 * row, 2 * col]]);
                let is_free = !mine.iter().any(|&mine| lines.iter().any(|&line| cross(mine, line)));
                !taken.contains(&(row, col)) && is_free && !cross(mine[0], mine[1])
            };
            found[number] = around(extent, wishes[number], ROOM).find(is_good);
        }
        taken.extend(found[number]);
    }
    let no_room = || {
        let message = "there is no room for saddles between the peaks: give fewer peaks, or a finer --resolution";
        Error::new(ErrorKind::Input, message)
    };
    found.into_iter().map(|place| place.map(|place| extent.cell(place)).ok_or_else(no_room)).collect()
}

/// Where a saddle would best be: row and column.
fn wish(ridge: &Ridge, joints: &[Joint], saddle_m: f64, rng: &mut Rng) -> [f64; 2] {
    let point = |joint: u32| joints[joint as usize].twice.map(|twice| twice as f64 / 2.0);
    let [a, b] = ridge.joints.map(point);
    let [above_a, above_b] = ridge.joints.map(|joint| joints[joint as usize].elevation_m - saddle_m);
    let even = above_a / (above_a + above_b);
    let along = (even + CHANCE * (rng.between(ALONG.0, ALONG.1) - even)).clamp(ALONG.0, ALONG.1);
    let on_line = mix(a, b, along);
    let mut sides = ridge.beside.iter().flatten();
    let side = if rng.below(2) == 0 { sides.next() } else { sides.next_back() };
    side.map_or(on_line, |&third| {
        let c = point(third);
        let centroid = [0, 1].map(|i| (a[i] + b[i] + c[i]) / 3.0);
        // The square of an even number is small more often than not.
        mix(on_line, centroid, ASIDE * rng.unit() * rng.unit())
    })
}

fn mix(a: [f64; 2], b: [f64; 2], part: f64) -> [f64; 2] {
    [0, 1].map(|i| a[i] + part * (b[i] - a[i]))
}

fn place(twice: [i64; 2]) -> Place {
    (twice[0].div_euclid(2), twice[1].div_euclid(2))
}

/// Whether a saddle at a place lies in the triangles beside its ridge that are its own.
fn is_clear(ridge: &Ridge, joints: &[Joint], (row, col): Place) -> bool {
    let twice = |joint: u32| joints[joint as usize].twice;
    let [a, b] = ridge.joints.map(twice);
    let is_between = [a, b].iter().flatten().any(|at| at % 2 != 0);
    let mut sides = ridge.beside.iter().flatten();
    !is_between && sides.any(|&third| is_beside([2 * row, 2 * col], a, b, twice(third)))
}

/// The cell at a point, and those in the rings of cells around it.
fn around<M: Metric + ?Sized>(extent: &Extent<'_, M>, at: [f64; 2], rings: i64) -> impl Iterator<Item = Place> {
    #[allow(clippy::cast_possible_truncation, reason = "between places, which are whole numbers")]
    let [row, col] = at.map(|v| v.round() as i64);
    let (rows, cols) = (extent.rows as i64, extent.cols as i64);
    (0..rings).flat_map(move |ring| {
        let ends = move |r: i64| if (r - row).abs() == ring || ring == 0 { 1 } else { 2 * ring };
        (row - ring..=row + ring)
            .flat_map(move |r| (col - ring..=col + ring).step_by(ends(r) as usize).map(move |c| (r, c)))
            .filter(move |&(r, c)| (0..rows).contains(&r) && (0..cols).contains(&c))
    })
}
