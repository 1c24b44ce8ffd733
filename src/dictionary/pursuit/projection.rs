//! One patch while atoms are chosen for it, in double precision and one order: the definition that fast code obeys.

use crate::linalg::dot;

/// An atom of whose square length less than this lies outside the span of those chosen is as good as in it; with it,
/// coefficients would only grow.
pub(super) const LEAST_NEW: f64 = 1e-4;

/// A patch and its projection on the atoms chosen so far.
///
/// Everything is scaled by the roots of the weights, so inner products are plain. The chosen atoms are kept as
/// directions at right angles and the triangle R of atoms = directions R, which is the Cholesky factor of their Gram
/// matrix, one column more with each atom.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct Projection {
    residual: Vec<f64>,
    directions: Vec<f64>,
    triangle: Vec<f64>,
    parts: Vec<f64>,
    atoms: Vec<u32>,
    // A constant over the cells that are there comes first, and this is its length.
    constant: Option<f64>,
}

impl Projection {
    /// Begins with a patch whose cells are all there.
    #[inline(always)]
    pub(in super::super) fn begin(&mut self, patch: &[f32]) {
        self.residual.clear();
        self.residual.extend(patch.iter().map(|&v| f64::from(v)));
        self.directions.clear();
        self.triangle.clear();
        self.parts.clear();
        self.atoms.clear();
        self.constant = None;
    }

    /// Begins with a patch of which some cells are missing, and have the value 0.
    ///
    /// Over the rest, atoms are not without a constant part; so the mean is fitted anew together with the atoms.
    pub(super) fn begin_partial(&mut self, patch: &[f32], known: &[bool], roots: &[f32]) {
        self.begin(patch);
        let constant: Vec<f64> =
            roots.iter().zip(known).map(|(&root, &known)| if known { f64::from(root) } else { 0.0 }).collect();
        let length = dot(&constant, &constant).sqrt();
        self.constant = Some(length);
        self.directions.extend(constant.iter().map(|v| v / length));
        self.triangle.push(length);
        self.project();
    }

    /// Takes the part along the last direction out of the residual.
    #[inline(always)]
    fn project(&mut self) {
        let size = self.residual.len();
        let direction = &self.directions[self.directions.len() - size..];
        let part = dot(&self.residual, direction);
        for (value, d) in self.residual.iter_mut().zip(direction) {
            *value -= part * d;
        }
        self.parts.push(part);
    }

    /// What is left of the patch.
    pub(super) fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Square length of what is left.
    #[inline(always)]
    pub(in super::super) fn error(&self) -> f64 {
        dot(&self.residual, &self.residual)
    }

    /// The last direction, of length 1.
    pub(super) fn last_direction(&self) -> &[f64] {
        &self.directions[self.directions.len() - self.residual.len()..]
    }

    /// The atoms chosen so far.
    pub(in super::super) fn atoms(&self) -> &[u32] {
        &self.atoms
    }

    /// Inner product of an atom with what is left.
    #[inline(always)]
    pub(super) fn correlation(&self, atom: &[f32]) -> f64 {
        dot(&self.residual, atom)
    }

    /// Square length of an atom's part outside the span, given its own square length.
    #[inline(always)]
    pub(super) fn outside(&self, atom: &[f32], square: f64) -> f64 {
        let mut left = square;
        for direction in self.directions.chunks_exact(self.residual.len()) {
            let part = dot(direction, atom);
            left -= part * part;
        }
        left
    }

    /// Chooses an atom; false, and nothing changes, when too little of it lies outside the span. `known` are the
    /// cells that are there.
    #[inline(always)]
    pub(in super::super) fn take(&mut self, number: u32, atom: &[f32], known: Option<&[bool]>) -> bool {
        let size = self.residual.len();
        let seen = |(i, &v): (usize, &f32)| if known.is_none_or(|known| known[i]) { f64::from(v) } else { 0.0 };
        let start = self.directions.len();
        self.directions.extend(atom.iter().enumerate().map(seen));
        let (before, new) = self.directions.split_at_mut(start);
        let square = dot(new, new);
        let column = self.triangle.len();
        self.triangle.resize(column + self.parts.len() + 1, 0.0);
        // Twice, as the first time leaves rounding errors where little is left.
        for _ in 0..2 {
            for (i, direction) in before.chunks_exact(size).enumerate() {
                let part = dot(new, direction);
                for (value, d) in new.iter_mut().zip(direction) {
                    *value -= part * d;
                }
                self.triangle[column + i] += part;
            }
        }
        let left = dot(new, new);
        if left.is_nan() || left < LEAST_NEW * square.min(1.0) || left == 0.0 {
            self.directions.truncate(start);
            self.triangle.truncate(column);
            return false;
        }
        let length = left.sqrt();
        new.iter_mut().for_each(|v| *v /= length);
        self.triangle[column + self.parts.len()] = length;
        self.project();
        self.atoms.push(number);
        true
    }

    /// The coefficients of the chosen atoms, and what is to be added to the mean.
    pub(in super::super) fn coefficients(&self) -> (Vec<f64>, f64) {
        let count = self.parts.len();
        let column = |j: usize| j * (j + 1) / 2;
        let mut x = self.parts.clone();
        for j in (0..count).rev() {
            x[j] /= self.triangle[column(j) + j];
            for i in 0..j {
                x[i] -= self.triangle[column(j) + i] * x[j];
            }
        }
        match self.constant {
            // The constant's vector is 1 in every cell.
            Some(_) => (x.split_off(1), x[0]),
            None => (x, 0.0),
        }
    }
}
