//! What a node is at one point, and at a block of points.

use super::area::Area;
use crate::noise::Sample;

/// Points of a row of a block.
pub const COLS: usize = crate::noise::COLS;

/// Rows of a block, at most.
pub const ROWS: usize = 12;

/// Points of a block, at most: few enough that the blocks a node works on stay in the processor's first cache.
pub const WIDTH: usize = COLS * ROWS;

/// Elevation and weight at a point, both with their gradients.
///
/// Where the weight is 0 the node is not defined, and everything is 0: a part that is not there adds exactly nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// f: elevation in metres.
    pub elevation: Sample,
    /// alpha: weight, at least 0.
    pub weight: Sample,
}

/// A place with the level of detail there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Coordinates in metres, in the node's own frame.
    pub at: [f64; 2],
    /// kappa: level of detail of `[0, 1]`, with its gradient in the same frame.
    pub kappa: Sample,
}

/// What is asked of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Want {
    /// Elevations, or weights alone.
    pub elevation: bool,
    /// Gradients.
    pub gradient: bool,
}

/// [`Point`]s of a block, row by row: value, derivative by x and derivative by y. Without gradients the latter two
/// hold anything, and so does all beyond the rows of the [`Places`].
#[derive(Clone, Debug)]
pub struct Block {
    /// Elevations in metres.
    pub elevation: [[f64; WIDTH]; 3],
    /// Weights.
    pub weight: [[f64; WIDTH]; 3],
}

/// [`Place`]s of a block, row by row, and a box that holds them.
#[derive(Clone, Debug)]
pub struct Places {
    /// x of each.
    pub x: [f64; WIDTH],
    /// y of each.
    pub y: [f64; WIDTH],
    /// Level of detail of each, and its derivatives.
    pub kappa: [[f64; WIDTH]; 3],
    /// A box that holds all of them.
    pub area: Area,
    /// Rows that there are, each of [`COLS`] points, from 1 to [`ROWS`].
    pub rows: usize,
    /// Whether rows and columns cross: x depends on the column alone, and y on the row alone.
    pub crossing: bool,
}

impl Point {
    /// A node that is not defined here.
    pub const NOTHING: Self =
        Self { elevation: Sample { value: 0.0, dx: 0.0, dy: 0.0 }, weight: Sample { value: 0.0, dx: 0.0, dy: 0.0 } };

    /// The point itself, or nothing where its weight is not positive.
    #[inline(always)]
    #[must_use]
    pub fn settled(self) -> Self {
        let some = self.weight.value > 0.0;
        let kept = |value: f64| if some { value } else { 0.0 };
        let (f, w) = (self.elevation, self.weight);
        Self {
            elevation: Sample { value: kept(f.value), dx: kept(f.dx), dy: kept(f.dy) },
            // Not `kept`: compilers would make masked stores of it, which some processors are slow at.
            weight: Sample { value: w.value.max(0.0), dx: kept(w.dx), dy: kept(w.dy) },
        }
    }
}

impl Want {
    /// Elevations and weights with gradients.
    pub const ALL: Self = Self { elevation: true, gradient: true };
}

impl Default for Block {
    fn default() -> Self {
        Self { elevation: [[0.0; WIDTH]; 3], weight: [[0.0; WIDTH]; 3] }
    }
}

impl Block {
    /// The point at index `k`.
    #[inline(always)]
    pub fn get<const GRADIENT: bool>(&self, k: usize) -> Point {
        let sample = |rows: &[[f64; WIDTH]; 3]| Sample {
            value: rows[0][k],
            dx: if GRADIENT { rows[1][k] } else { 0.0 },
            dy: if GRADIENT { rows[2][k] } else { 0.0 },
        };
        Point { elevation: sample(&self.elevation), weight: sample(&self.weight) }
    }

    /// Sets the point at index `k`.
    #[inline(always)]
    pub fn set<const GRADIENT: bool>(&mut self, k: usize, point: Point) {
        self.elevation[0][k] = point.elevation.value;
        self.weight[0][k] = point.weight.value;
        if GRADIENT {
            self.elevation[1][k] = point.elevation.dx;
            self.elevation[2][k] = point.elevation.dy;
            self.weight[1][k] = point.weight.dx;
            self.weight[2][k] = point.weight.dy;
        }
    }

    /// Sets the first `count` points to nothing, derivatives only if they are wanted.
    pub fn clear(&mut self, count: usize, gradient: bool) {
        let arrays = if gradient { 3 } else { 1 };
        for values in self.elevation[..arrays].iter_mut().chain(&mut self.weight[..arrays]) {
            values[..count].fill(0.0);
        }
    }

    /// Copies the first `count` points of another block, derivatives only if they are wanted.
    pub(super) fn copy(&mut self, other: &Self, count: usize, gradient: bool) {
        for array in 0..if gradient { 3 } else { 1 } {
            self.elevation[array][..count].copy_from_slice(&other.elevation[array][..count]);
            self.weight[array][..count].copy_from_slice(&other.weight[array][..count]);
        }
    }
}

impl Places {
    /// Number of points.
    pub fn count(&self) -> usize {
        self.rows.min(ROWS) * COLS
    }

    /// The place at index `k`.
    #[inline(always)]
    pub fn get(&self, k: usize) -> Place {
        let kappa = Sample { value: self.kappa[0][k], dx: self.kappa[1][k], dy: self.kappa[2][k] };
        Place { at: [self.x[k], self.y[k]], kappa }
    }
}

/// The rows of a block.
#[inline(always)]
pub(super) fn rows<'a>(values: &'a [f64; WIDTH], places: &Places) -> &'a [[f64; COLS]] {
    &values.as_chunks().0[..places.rows]
}

/// The rows of a block, to be set.
#[inline(always)]
pub(super) fn rows_mut<'a>(values: &'a mut [f64; WIDTH], places: &Places) -> &'a mut [[f64; COLS]] {
    &mut values.as_chunks_mut().0[..places.rows]
}
