//! Sparse terrains: discs of atoms of a dictionary.

use super::pyramid::{Joined, Pyramid};
use super::{FallOff, Primitive};
use crate::construction::area::{Area, Region};
use crate::construction::bounds::Bounds;
use crate::construction::operator::blend;
use crate::construction::point::{Place, Point};
use crate::dictionary::SparseTerrain;
use crate::error::{Error, ErrorKind, Result};
use crate::interval::Interval;
use crate::noise::Sample;
use std::sync::Arc;

/// Parts of a square's side, over each of which the discs and their weights are bounded.
const PARTS: usize = 4;
/// Greatest of `t² (3 - 2 t) / t`, at t = 3/4.
const STEEPER: f64 = 1.125;
/// Greatest derivative of `t² (3 - 2 t)`.
const STEEPEST: f64 = 1.5;

/// A terrain of sparse primitives (Guérin, Digne, Galin, Peytavie, "Sparse representation of terrains for procedural
/// modeling", Computer Graphics Forum 35(2), 2016, section 4.1) as one node: its elevation is the blend of its discs.
///
/// Coordinates are columns and rows of the raster that it was made from, whole numbers at corners of cells; a warp puts
/// it into place. The weight is `t² (3 - 2 t)`, t being the sum of the discs' weights, relative to that in the middle
/// between four discs and at most 1: so it is 1 wherever discs lie all around, and falls to 0 where they end. It ends
/// with a jump at the raster's own edge, as that of an image does.
///
/// # Bounds
/// The plane is cut into squares as wide as the step between discs, and these into parts. Over each part a disc's
/// elevation stays within its mean and its atoms' ranges there by their coefficients, and so do slopes; the discs that
/// reach it are blended with these bounds, as any blend: the slope is bounded where their weights cannot vanish together.
#[derive(Clone, Debug)]
pub struct Sparse {
    terrain: Arc<SparseTerrain>,
    /// Sum of weights from which on the weight is 1.
    whole: f64,
    /// Column and row of the corner of the first square.
    corner: [f64; 2],
    /// Rows and columns of squares.
    squares: (usize, usize),
    bounds: Pyramid<Within>,
}

/// Bounds over squares.
#[derive(Clone, Copy, Debug)]
struct Within(Bounds);

impl Joined for Within {
    fn join(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        let elevation = match (a.is_nothing(), b.is_nothing()) {
            (true, _) => b.elevation,
            (_, true) => a.elevation,
            _ => a.elevation.hull(b.elevation),
        };
        Self(Bounds {
            elevation,
            slope: a.slope.max(b.slope),
            weighted_slope: a.weighted_slope.max(b.weighted_slope),
            weight: a.weight.hull(b.weight),
            weight_slope: a.weight_slope.max(b.weight_slope),
        })
    }
}

/// A disc that may reach a square, by how many squares its own is before it, over the square's parts.
struct Reach {
    rows: usize,
    cols: usize,
    parts: Vec<ReachPart>,
}

/// A disc over a part of a square that it may reach.
struct ReachPart {
    /// Range and slope of the weight.
    weight: (Interval, f64),
    /// Range and slope of each atom; none where the disc has no weight.
    atoms: Vec<(Interval, f64)>,
}

impl Sparse {
    /// The node of a terrain.
    ///
    /// # Errors
    /// An input error for a terrain without any disc.
    pub fn new(terrain: SparseTerrain) -> Result<Self> {
        if terrain.patches() == 0 {
            return Err(Error::new(ErrorKind::Input, "the sparse terrain has no disc: all of it is void"));
        }
        let layout = terrain.layout();
        let (step, side, radius) = (layout.step(), layout.shape().side(), layout.shape().radius_cells());
        let (top, left) = layout.corner(0);
        let (down, across) = layout.patches();
        // The squares begin with the first disc's own, and go on until the last disc's ends.
        let more = side.div_ceil(step);
        let squares = (down + more - 1, across + more - 1);
        let reaches = reaches(&terrain)?;
        let whole = between(step, radius);
        let square = |row: usize, col: usize| {
            let mut near = vec![];
            for reach in &reaches {
                let Some((i, j)) = row.checked_sub(reach.rows).zip(col.checked_sub(reach.cols)) else { continue };
                if i < down
                    && j < across
                    && let Some(patch) = terrain.patch_at(i * across + j)
                {
                    near.push((patch, reach));
                }
            }
            let part = |k: usize| {
                let discs: Vec<Bounds> = near
                    .iter()
                    .map(|(patch, reach)| (*patch, &reach.parts[k]))
                    .filter(|(_, part)| part.weight.0.max > 0.0)
                    .map(|(patch, part)| {
                        let (range, slope) = disc_bounds(&terrain, &part.atoms, patch);
                        Bounds::new(range, slope, part.weight.0, part.weight.1)
                    })
                    .collect();
                if discs.is_empty() { Within(Bounds::NOTHING) } else { Within(ramped(&blend::bounds(&discs), whole)) }
            };
            (1..PARTS * PARTS).fold(part(0), |all, k| all.join(part(k)))
        };
        let bounds = Pyramid::new(squares.0, squares.1, 1, square);
        let corner = [left as f64, top as f64];
        Ok(Self { whole, corner, squares, bounds, terrain: Arc::new(terrain) })
    }

    /// The terrain.
    pub fn terrain(&self) -> &SparseTerrain {
        &self.terrain
    }

    /// The raster's own box.
    fn raster(&self) -> Area {
        let layout = self.terrain.layout();
        Area::of(&[[0.0, 0.0], [layout.cols() as f64, layout.rows() as f64]])
    }
}

/// Sum of weights in the middle between four discs of a full lattice.
fn between(step: usize, radius: f64) -> f64 {
    let (step, reach) = (step as f64, (radius / step as f64).ceil() as i64 + 1);
    let mut sum = 0.0;
    for i in -reach..reach {
        for j in -reach..reach {
            let (x, y) = ((j as f64 + 0.5) * step, (i as f64 + 0.5) * step);
            sum += crate::codec::sparse::fall_off(x, y, radius);
        }
    }
    sum
}

/// The discs that reach into a square, of a full lattice.
fn reaches(terrain: &SparseTerrain) -> Result<Vec<Reach>> {
    let (step, shape) = (terrain.layout().step(), terrain.layout().shape());
    let (radius, more) = (shape.radius_cells(), shape.side().div_ceil(step));
    let fall_off = FallOff::new(0.0, radius)?;
    let part_m = step as f64 / PARTS as f64;
    let mut found = vec![];
    for rows in 0..more {
        for cols in 0..more {
            let part = |k: usize| {
                // Seen from the corner of the disc's own square.
                let along = |squares: usize, part: usize| {
                    let first = (squares * step) as f64 + part as f64 * part_m;
                    Interval { min: first, max: first + part_m }
                };
                let (x, y) = (along(cols, k % PARTS), along(rows, k / PARTS));
                let (weight, slope) = fall_off.bounds(Area { x, y }.square_distances([radius, radius]));
                let weight = (weight.widened().clamped(0.0, 1.0), slope * (1.0 + 1e-9));
                let atoms = if weight.0.max > 0.0 { 0..terrain.dictionary().len() } else { 0..0 };
                ReachPart { weight, atoms: atoms.map(|atom| terrain.atom_bounds(atom, x, y)).collect() }
            };
            found.push(Reach { rows, cols, parts: (0..PARTS * PARTS).map(part).collect() });
        }
    }
    Ok(found)
}

/// Range and slope of a disc's own elevation where its atoms have these.
fn disc_bounds(terrain: &SparseTerrain, bounds: &[(Interval, f64)], patch: usize) -> (Interval, f64) {
    let (mean, atoms, parts) = terrain.patch(patch);
    let (mut range, mut slope) = (Interval::point(f64::from(mean)), 0.0);
    for (&atom, &part) in atoms.iter().zip(parts) {
        let (own, steep) = bounds[atom as usize];
        range = range.plus(own.scaled(f64::from(part)));
        slope += steep * f64::from(part).abs();
    }
    (range.widened(), slope)
}

/// The ramp of a sum of weights, and its derivative.
fn ramp(sum: f64, whole: f64) -> (f64, f64) {
    let t = (sum / whole).min(1.0);
    (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) / whole)
}

/// Bounds of a blend of discs whose weight goes through the ramp.
fn ramped(blend: &Bounds, whole: f64) -> Bounds {
    let ends = Interval { min: ramp(blend.weight.min, whole).0, max: ramp(blend.weight.max, whole).0 };
    // Products and sums need not be rounded in order: a weight that is 1 here may be less by that.
    let weight = ends.widened().clamped(0.0, 1.0);
    let is_still = blend.weight.min >= whole * (1.0 + 1e-9);
    Bounds {
        weighted_slope: (blend.weighted_slope * (STEEPER / whole))
            .min(crate::interval::product(blend.slope, weight.max)),
        weight: if is_still { Interval::ONE } else { weight },
        weight_slope: if is_still { 0.0 } else { blend.weight_slope * (STEEPEST / whole) },
        ..*blend
    }
    .widened()
}

impl Primitive for Sparse {
    fn support(&self) -> Area {
        self.raster()
    }

    fn bounds(&self, region: &Region) -> Bounds {
        let raster = self.raster();
        let seen = region.area.meet(&raster);
        if seen.is_empty() {
            return Bounds::NOTHING;
        }
        let step = self.terrain.layout().step() as f64;
        // A place on the edge of a square may be rounded into the one beside it.
        let range = |ends: Interval, k: usize, count: usize| {
            let square = |at: f64| (((at - self.corner[k]) / step).floor().max(0.0) as usize).min(count - 1);
            let ends = ends.widened();
            (square(ends.min), square(ends.max))
        };
        let (rows, cols) = (range(seen.y, 1, self.squares.0), range(seen.x, 0, self.squares.1));
        let mut found = self.bounds.over(rows, cols, 1).0;
        if found.is_nothing() {
            return Bounds::NOTHING;
        }
        let inside = |inner: Interval, outer: Interval| inner.min > outer.min && inner.max < outer.max;
        if !(inside(region.area.x, raster.x) && inside(region.area.y, raster.y)) {
            (found.weight.min, found.weight_slope) = (0.0, f64::INFINITY);
        }
        found
    }

    fn at(&self, place: &Place) -> Point {
        let [col, row] = place.at;
        if !self.raster().holds(place.at) {
            return Point::NOTHING;
        }
        let Some(found) = self.terrain.sample(row, col) else { return Point::NOTHING };
        let (value, slope) = ramp(found.weight.value, self.whole);
        let weight = Sample { value, dx: slope * found.weight.dx, dy: slope * found.weight.dy };
        Point { elevation: found.elevation, weight }.settled()
    }

    fn bytes(&self) -> usize {
        size_of::<Self>() + self.terrain.bytes() + self.bounds.bytes()
    }
}
