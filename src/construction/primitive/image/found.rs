//! Bounds of cells of an image.

use crate::construction::primitive::pyramid::Joined;
use crate::interval::Interval;

/// Side of the finest blocks of cells whose bounds are kept.
pub(super) const BLOCK: usize = 8;

/// Bounds over cells: heights and weights, and their derivatives by column (`dx`) and row (`dy`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub(super) height: Interval,
    pub(super) dx: f64,
    pub(super) dy: f64,
    pub(super) weight: Interval,
    pub(super) weight_dx: f64,
    pub(super) weight_dy: f64,
}

impl Found {
    /// A cell whose weight is 0: heights there matter to nobody.
    pub(super) const NOTHING: Self = Self {
        height: Interval { min: f64::INFINITY, max: f64::NEG_INFINITY },
        dx: 0.0,
        dy: 0.0,
        weight: Interval::ZERO,
        weight_dx: 0.0,
        weight_dy: 0.0,
    };
}

impl Joined for Found {
    fn join(self, other: Self) -> Self {
        Self {
            height: self.height.hull(other.height),
            dx: self.dx.max(other.dx),
            dy: self.dy.max(other.dy),
            weight: self.weight.hull(other.weight),
            weight_dx: self.weight_dx.max(other.weight_dx),
            weight_dy: self.weight_dy.max(other.weight_dy),
        }
    }
}
