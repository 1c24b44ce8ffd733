//! One step: patches of a plane, and fine atoms in their place.

use super::super::plane::Plane;
use super::options::PatchModel;
use super::pairs::Pairs;
use crate::error::Result;
use crate::linalg::vectorised;

/// Pairs of atoms, and where the patches of a plane lie.
///
/// Patches lie on one lattice for the whole raster, its squares beginning at the raster's corner, so that it does not
/// matter how planes are cut out of it.
#[derive(Clone, Debug)]
pub(super) struct Blending {
    pairs: Pairs,
    spacing: usize,
    /// For each column of a fine patch the square of its distance from the middle, as a part of the radius.
    squares: Vec<f64>,
}

/// Patches of a plane: where each begins in it, its mean, and its values above the mean.
struct Cut {
    corners: Vec<[usize; 2]>,
    means: Vec<f64>,
    values: Vec<f32>,
}

impl Blending {
    pub(super) fn new(pairs: Pairs, model: &PatchModel) -> Result<Self> {
        let side = pairs.shape().side() * pairs.factor();
        let radius = side as f64 / 2.0;
        let square = |k: usize| {
            let part = (k as f64 + 0.5 - radius) / radius;
            part * part
        };
        Ok(Self { pairs, spacing: model.spacing()?, squares: (0..side).map(square).collect() })
    }

    pub(super) fn factor(&self) -> usize {
        self.pairs.factor()
    }

    pub(super) fn pairs(&self) -> &Pairs {
        &self.pairs
    }

    pub(super) fn atoms(&self) -> usize {
        self.pairs.len()
    }

    pub(super) fn bytes(&self) -> usize {
        self.pairs.bytes()
    }

    /// Cells at each side of a plane that are needed beyond those that are made finer.
    pub(super) fn reach(&self) -> usize {
        self.pairs.shape().side()
    }

    /// The finer plane of all but [`Blending::reach`] cells at each side.
    pub(super) fn applied(&self, coarse: &Plane, corner: [i64; 2]) -> Plane {
        let factor = self.factor();
        let reach = self.reach();
        let [rows, cols] = [coarse.rows(), coarse.cols()].map(|side| (side - 2 * reach) * factor);
        let cut = self.cut(coarse, corner);
        let codes = self.pairs.matched(&cut.values);
        let mut sums = vec![0.0; rows * cols];
        let mut weights = vec![0.0; rows * cols];
        let mut line = vec![0.0; self.squares.len()];
        vectorised(
            #[inline(always)]
            || {
                for (patch, (from, &mean)) in cut.corners.iter().zip(&cut.means).enumerate() {
                    let top = from.map(|at| (at * factor) as i64 - (reach * factor) as i64);
                    let part = |first: i64, cells: usize| {
                        let end = (first + self.squares.len() as i64).min(cells as i64) - first;
                        (-first).max(0) as usize..end.max(0) as usize
                    };
                    let across = part(top[1], cols);
                    for row in part(top[0], rows) {
                        let own = &mut line[across.clone()];
                        self.fill(codes.get(patch), mean, row, across.clone(), own);
                        let start = (top[0] + row as i64) as usize * cols + (top[1] + across.start as i64) as usize;
                        let places = start..start + own.len();
                        let (sums, weights) = (&mut sums[places.clone()], &mut weights[places]);
                        let down = self.squares[row];
                        let squares = &self.squares[across.clone()];
                        for (((sum, weight), height), square) in sums.iter_mut().zip(weights).zip(own).zip(squares) {
                            let left = 1.0 - (square + down);
                            let left = if left > 0.0 { left } else { 0.0 };
                            let own = left * left * left;
                            *sum += own * *height;
                            *weight += own;
                        }
                    }
                }
            },
        );
        sums.iter_mut().zip(&weights).for_each(|(sum, weight)| *sum /= weight);
        Plane::new(rows, cols, sums)
    }

    /// Part of a row of a fine patch.
    #[inline(always)]
    fn fill(
        &self,
        (atoms, parts): (&[u32], &[f64]),
        mean: f64,
        row: usize,
        across: std::ops::Range<usize>,
        out: &mut [f64],
    ) {
        out.fill(mean);
        for (&atom, part) in atoms.iter().zip(parts) {
            let atom = self.pairs.atom(atom);
            let part = part / atom.norm_m;
            let own = &self.pairs.fine_row(atom, row)[across.clone()];
            for (out, &height) in out.iter_mut().zip(own) {
                *out += part * (f64::from(height) - atom.mean_m);
            }
        }
    }

    /// The patches that reach into what is made finer.
    fn cut(&self, coarse: &Plane, corner: [i64; 2]) -> Cut {
        let shape = self.pairs.shape();
        let side = shape.side();
        let weight: f64 = shape.weights().iter().sum();
        // Corners in the plane of the lattice's squares of `side` cells that hold a cell of what is made finer.
        let starts = |at: i64, cells: usize| {
            let (side, step) = (side as i64, self.spacing as i64);
            let shift = (step - side).div_euclid(2) - at;
            let first = (1 - shift).div_euclid(step) + i64::from((1 - shift).rem_euclid(step) > 0);
            (first..)
                .map(move |number| number * step + shift)
                .take_while(move |&start| start < cells as i64 - side)
                .map(|start| start as usize)
        };
        let mut cut = Cut { corners: vec![], means: vec![], values: vec![] };
        for row in starts(corner[0], coarse.rows()) {
            for col in starts(corner[1], coarse.cols()) {
                let cells = || (row..row + side).flat_map(|row| &coarse.row(row)[col..col + side]);
                // Above the first cell, so that flat ground has exactly its own mean.
                let first = coarse.row(row)[col];
                let sum: f64 = shape.weights().iter().zip(cells()).map(|(w, v)| w * (v - first)).sum();
                let mean = first + sum / weight;
                cut.corners.push([row, col]);
                cut.means.push(mean);
                cut.values.extend(cells().map(|v| (v - mean) as f32));
            }
        }
        cut
    }
}
