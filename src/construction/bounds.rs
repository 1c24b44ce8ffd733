//! What a node cannot exceed in a region.

use crate::interval::{Interval, product};

/// The weight from which on the terrain is defined, T of Génevaux et al. 2015, section 3.
pub const THRESHOLD: f64 = 0.5;

/// Bounds of a node over a region; they speak of the points where its weight is positive.
///
/// Slopes are Lipschitz constants along any way through such points. Infinite says that there is none: the node may
/// jump, or its slope is not known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Elevations in metres.
    pub elevation: Interval,
    /// Slope of the elevation, metres per metre.
    pub slope: f64,
    /// Weight times slope of the elevation. At a blend's fringe the slope grows without limit while the weight
    /// vanishes; their product does not.
    pub weighted_slope: f64,
    /// Weights; exactly 1 or exactly 0 only where every point has that weight to the bit.
    pub weight: Interval,
    /// Slope of the weight, per metre.
    pub weight_slope: f64,
}

impl Bounds {
    /// Bounds of a node that is nowhere defined.
    pub const NOTHING: Self =
        Self { elevation: Interval::ZERO, slope: 0.0, weighted_slope: 0.0, weight: Interval::ZERO, weight_slope: 0.0 };

    /// Bounds of elevation and weight alone: the weighted slope follows.
    pub fn new(elevation: Interval, slope: f64, weight: Interval, weight_slope: f64) -> Self {
        Self { elevation, slope, weighted_slope: product(slope, weight.max), weight, weight_slope }
    }

    /// Whether the weight is 0 everywhere.
    pub fn is_nothing(&self) -> bool {
        self.weight.max <= 0.0
    }

    /// Bound of the slope where the terrain is defined, that is where the weight is at least [`THRESHOLD`].
    pub fn terrain_slope(&self) -> f64 {
        self.slope.min(self.weighted_slope / self.weight.min.max(THRESHOLD))
    }

    /// Greatest difference of elevation between a point of one and the same point of the other.
    pub(super) fn apart(&self, other: &Self) -> f64 {
        self.elevation.minus(other.elevation).size()
    }

    /// The same with slopes a little larger, for what rounding adds.
    pub(super) fn widened(self) -> Self {
        let more = 1.0 + 1e-12;
        Self {
            elevation: self.elevation.widened(),
            slope: self.slope * more,
            weighted_slope: self.weighted_slope * more,
            weight_slope: self.weight_slope * more,
            ..self
        }
    }
}
