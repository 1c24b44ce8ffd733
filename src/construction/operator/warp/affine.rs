//! Affine warps: a node moved, turned, scaled, sheared and lifted.

use super::{Matrix, apply, inverse, rotation};
use crate::construction::area::Area;
use crate::error::{Error, Result};
use crate::interval::Interval;

/// `p = M q + t` from the child's frame to the parent's, and elevations times a scale plus a shift.
///
/// The lift is not in Génevaux et al. 2015, whose homothety needs it: a mountain of half the size is half as high.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    outward: Matrix,
    inward: Matrix,
    shift: [f64; 2],
    z_scale: f64,
    z_shift_m: f64,
}

impl Affine {
    /// The warp with matrix `m` (rows), translation `t` in metres, and a lift `f = z_scale f_A + z_shift_m`.
    ///
    /// # Errors
    /// A usage error for a matrix without a (finite) inverse and for numbers that are not finite.
    pub fn new(m: [[f64; 2]; 2], t: [f64; 2], z_scale: f64, z_shift_m: f64) -> Result<Self> {
        let finite = m.iter().flatten().chain(&t).chain([&z_scale, &z_shift_m]).all(|v| v.is_finite());
        if !finite {
            return Err(Error::usage("an affine warp needs finite numbers"));
        }
        let det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
        let size = m.iter().flatten().fold(0.0_f64, |size, v| size.max(v.abs()));
        // Relative to its entries, so that small units are no reason to refuse.
        let invertible = det.abs() > 1e-12 * size * size && (1.0 / det).is_finite();
        if !invertible {
            return Err(Error::usage(format!(
                "singular warp: the matrix {m:?} maps the plane onto a line; its determinant is {det}"
            )));
        }
        Ok(Self { outward: m, inward: inverse(&m), shift: t, z_scale, z_shift_m })
    }

    /// Scaled by `scale` (along x and y), then turned by `degrees` to the left, then moved to `t`; the elevation is
    /// multiplied by `z_scale` and moved by `z_shift_m`.
    ///
    /// # Errors
    /// As [`Affine::new`].
    pub fn placed(scale: [f64; 2], degrees: f64, t: [f64; 2], z_scale: f64, z_shift_m: f64) -> Result<Self> {
        let (c, s) = rotation(degrees);
        Self::new([[c * scale[0], -s * scale[1]], [s * scale[0], c * scale[1]]], t, z_scale, z_shift_m)
    }

    /// This warp applied to what `inner` has warped: one warp in place of two.
    ///
    /// # Errors
    /// A usage error where the product of the two can no longer be inverted.
    pub fn after(&self, inner: &Self) -> Result<Self> {
        let (m, n) = (&self.outward, &inner.outward);
        let entry = |row: usize, col: usize| m[row][0] * n[0][col] + m[row][1] * n[1][col];
        let moved = apply(m, inner.shift);
        Self::new(
            [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]],
            [moved[0] + self.shift[0], moved[1] + self.shift[1]],
            self.z_scale * inner.z_scale,
            self.z_scale * inner.z_shift_m + self.z_shift_m,
        )
    }

    /// The point in the child's frame.
    #[inline(always)]
    pub(super) fn enter(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        // Moved first: large coordinates lose nothing in the products.
        apply(&self.inward, [x - self.shift[0], y - self.shift[1]])
    }

    /// The Jacobian of the way into the child's frame.
    #[inline(always)]
    pub(super) fn inward(&self) -> &Matrix {
        &self.inward
    }

    /// The Jacobian of the way out.
    #[inline(always)]
    pub(super) fn outward(&self) -> &Matrix {
        &self.outward
    }

    /// Scale and shift of elevations.
    #[inline(always)]
    pub(super) fn lift(&self) -> (f64, f64) {
        (self.z_scale, self.z_shift_m)
    }

    pub(super) fn image(&self, area: &Area) -> Area {
        let shift = self.shift;
        let moved = |i: Interval, by: f64| Interval { min: i.min - by, max: i.max - by };
        combine(&self.inward, &Area { x: moved(area.x, shift[0]), y: moved(area.y, shift[1]) })
    }

    pub(super) fn support(&self, child: &Area) -> Area {
        if child.is_empty() {
            return Area::EMPTY;
        }
        let out = combine(&self.outward, child);
        let moved = |i: Interval, by: f64| Interval { min: i.min + by, max: i.max + by };
        Area { x: moved(out.x, self.shift[0]), y: moved(out.y, self.shift[1]) }
            .grown(1e-12 * size(child, &self.outward))
    }

    /// Greatest singular values of the way in and of the way out.
    pub(super) fn stretches(&self) -> (f64, f64) {
        (norm(&self.inward), norm(&self.outward))
    }
}

/// How large coordinates of a box become, for the rounding of small differences of large numbers; 0 for endless ones.
fn size(area: &Area, m: &Matrix) -> f64 {
    let size = area.x.size().max(area.y.size()) * norm(m);
    if size.is_finite() { size } else { 0.0 }
}

/// The box of a matrix times a box.
fn combine(m: &Matrix, area: &Area) -> Area {
    Area {
        x: area.x.scaled(m[0][0]).plus(area.y.scaled(m[0][1])),
        y: area.x.scaled(m[1][0]).plus(area.y.scaled(m[1][1])),
    }
    .grown(1e-12 * size(area, m))
}

/// The greatest singular value, a little more than rounding takes away.
fn norm(m: &Matrix) -> f64 {
    let [[a, b], [c, d]] = *m;
    // sigma = (|(a + d, c - b)| + |(a - d, c + b)|) / 2.
    let length = |x: f64, y: f64| (x * x + y * y).sqrt();
    (length(a + d, c - b) + length(a - d, c + b)) / 2.0 * (1.0 + 1e-14)
}
