//! Warping: `f(p) = f_A(q)`, `alpha(p) = alpha_A(q)` with `q = w⁻¹(p)` (Génevaux et al. 2015, section 5.4).
//!
//! Only the inverse of a warp is ever applied, so deformations are given by their inverses in closed form, with
//! Jacobian J. Gradients become `J^T grad f_A(q)`, slopes grow by at most the greatest `|J|`, and the slope of the level
//! of detail, seen from the warped node, by the greatest `|J⁻¹|`.

mod affine;
mod deformation;
mod rotation;

pub use affine::Affine;
pub use deformation::Deformation;
pub(in crate::construction) use rotation::rotation;

use crate::construction::area::{Area, Region};
use crate::construction::bounds::Bounds;
use crate::construction::point::{Place, Point};
use crate::interval::{Interval, product};
use crate::noise::Sample;

/// Rows of a 2 x 2 matrix.
pub(in crate::construction) type Matrix = [[f64; 2]; 2];

/// Any warp.
#[derive(Clone, Debug)]
pub(in crate::construction) enum Warp {
    /// Moves, turns, scales, and lifts.
    Affine(Affine),
    /// Bends.
    Deformation(Box<Deformation>),
}

/// The product of a matrix and a vector.
#[inline(always)]
pub(in crate::construction) fn apply(m: &Matrix, [x, y]: [f64; 2]) -> [f64; 2] {
    [m[0][0] * x + m[0][1] * y, m[1][0] * x + m[1][1] * y]
}

/// A gradient seen through a map with the Jacobian.
#[inline(always)]
pub(in crate::construction) fn pull(jacobian: &Matrix, s: Sample) -> Sample {
    let [[a, b], [c, d]] = *jacobian;
    Sample { value: s.value, dx: a * s.dx + c * s.dy, dy: b * s.dx + d * s.dy }
}

/// The inverse of a matrix that has one.
#[inline(always)]
pub(in crate::construction) fn inverse(m: &Matrix) -> Matrix {
    let [[a, b], [c, d]] = *m;
    let per = 1.0 / (a * d - b * c);
    [[d * per, -b * per], [-c * per, a * per]]
}

impl Warp {
    /// The place in the child's frame, and the Jacobian of the way there.
    #[inline(always)]
    pub(in crate::construction) fn enter(&self, place: &Place) -> (Place, Matrix) {
        let (at, jacobian, back) = match self {
            Self::Affine(affine) => (affine.enter(place.at), *affine.inward(), *affine.outward()),
            Self::Deformation(deformation) => {
                let (at, jacobian) = deformation.enter(place.at);
                (at, jacobian, inverse(&jacobian))
            }
        };
        (Place { at, kappa: pull(&back, place.kappa) }, jacobian)
    }

    /// What the child is, seen from outside.
    #[inline(always)]
    pub(in crate::construction) fn leave(&self, jacobian: &Matrix, point: Point) -> Point {
        let mut out = Point { elevation: pull(jacobian, point.elevation), weight: pull(jacobian, point.weight) };
        if let Self::Affine(affine) = self {
            let (scale, shift) = affine.lift();
            out.elevation.value = out.elevation.value * scale + shift;
            out.elevation.dx *= scale;
            out.elevation.dy *= scale;
        }
        out.settled()
    }

    /// Whether rows and columns stay rows and columns.
    pub(in crate::construction) fn keeps_axes(&self) -> bool {
        matches!(self, Self::Affine(affine) if affine.inward()[0][1] == 0.0 && affine.inward()[1][0] == 0.0)
    }

    /// The region in the child's frame.
    pub(in crate::construction) fn inside(&self, region: &Region) -> Region {
        let (_, back) = self.stretches(&region.area);
        Region { area: self.image(&region.area), kappa: region.kappa, kappa_slope: product(region.kappa_slope, back) }
    }

    /// A box in the child's frame that holds where the points of a box go.
    pub(in crate::construction) fn image(&self, area: &Area) -> Area {
        match self {
            Self::Affine(affine) => affine.image(area),
            Self::Deformation(deformation) => deformation.image(area),
        }
        .widened()
    }

    /// A box that holds all points that go into a box of the child's frame.
    pub(in crate::construction) fn support(&self, child: &Area) -> Area {
        match self {
            Self::Affine(affine) => affine.support(child),
            Self::Deformation(deformation) => deformation.support(child),
        }
        .widened()
    }

    /// Bounds of the norms of the Jacobian and of its inverse.
    fn stretches(&self, area: &Area) -> (f64, f64) {
        match self {
            Self::Affine(affine) => affine.stretches(),
            Self::Deformation(deformation) => deformation.stretches(area),
        }
    }

    /// The child's bounds, seen from outside.
    pub(in crate::construction) fn bounds(&self, area: &Area, child: &Bounds) -> Bounds {
        let (stretch, _) = self.stretches(area);
        let (scale, shift) = match self {
            Self::Affine(affine) => affine.lift(),
            Self::Deformation(_) => (1.0, 0.0),
        };
        Bounds {
            elevation: child.elevation.scaled(scale).plus(Interval::point(shift)),
            slope: product(child.slope, stretch * scale.abs()),
            weighted_slope: product(child.weighted_slope, stretch * scale.abs()),
            weight: child.weight,
            weight_slope: product(child.weight_slope, stretch),
        }
        .widened()
    }

    /// Bytes of memory beside the node itself.
    pub(in crate::construction) fn bytes(&self) -> usize {
        match self {
            Self::Affine(_) => 0,
            Self::Deformation(_) => size_of::<Deformation>(),
        }
    }
}
