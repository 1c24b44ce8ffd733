//! Wyvill's fall-off, the weight of most features.

use crate::error::{Error, Result};
use crate::interval::Interval;
use crate::noise::Sample;

/// `g(d) = (1 - x²)³` with `x = (d - plateau) / (radius - plateau)`: 1 up to `plateau_m`, 0 from `radius_m` on.
///
/// Génevaux et al. 2015, section 4.1 (Wyvill, Guy, Galin 1999), there without a plateau. Once continuously
/// differentiable; its slope is at most `96 sqrt(5) / 125` over the width of the fall, reached at `x = 1 / sqrt(5)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FallOff {
    plateau_m: f64,
    radius_m: f64,
    per_m: f64,
    /// 1 / radius², of use without a plateau.
    per_square: f64,
}

/// 96 sqrt(5) / 125, rounded up.
const STEEPEST: f64 = 1.717_301_6;

impl FallOff {
    /// A fall-off from `plateau_m` to `radius_m`.
    ///
    /// # Errors
    /// A usage error unless 0 <= `plateau_m` < `radius_m`, both finite.
    pub fn new(plateau_m: f64, radius_m: f64) -> Result<Self> {
        let per_m = 1.0 / (radius_m - plateau_m);
        if !(plateau_m >= 0.0 && radius_m > plateau_m && radius_m.is_finite() && per_m.is_finite()) {
            return Err(Error::usage(format!(
                "a fall-off needs a radius larger than its plateau, which is at least 0: found radius {radius_m} m, plateau {plateau_m} m"
            )));
        }
        Ok(Self { plateau_m, radius_m, per_m, per_square: per_m * per_m })
    }

    /// Distance from which on the weight is 0, in metres.
    pub fn radius_m(&self) -> f64 {
        self.radius_m
    }

    /// Distance up to which the weight is 1, in metres.
    pub fn plateau_m(&self) -> f64 {
        self.plateau_m
    }

    /// Weight at a distance, and its derivative.
    #[inline(always)]
    pub fn at(&self, distance_m: f64) -> (f64, f64) {
        if self.plateau_m <= 0.0 {
            let (value, slope) = self.of_square::<false>(distance_m * distance_m);
            return (value, slope * distance_m);
        }
        let x = ((distance_m - self.plateau_m) * self.per_m).max(0.0);
        let rest = (1.0 - x * x).max(0.0);
        let square = rest * rest;
        (rest * square, -6.0 * x * square * self.per_m)
    }

    /// Weight at an offset from a centre, with its gradient.
    #[inline(always)]
    pub fn around(&self, dx: f64, dy: f64) -> Sample {
        let (value, slope) = self.over(dx * dx + dy * dy);
        Sample { value, dx: slope * dx, dy: slope * dy }
    }

    /// Weight at a squared distance: that of no place further away is more.
    pub(super) fn at_square(&self, square: f64) -> f64 {
        self.over(square).0
    }

    /// Weight at a squared distance, and its derivative over the distance.
    #[inline(always)]
    fn over(&self, square: f64) -> (f64, f64) {
        if self.plateau_m > 0.0 { self.of_square::<true>(square) } else { self.of_square::<false>(square) }
    }

    /// The same where it is known whether there is a plateau. Without a plateau no root is needed.
    ///
    /// Rounding keeps the weight's order: it never rises with the square.
    #[inline(always)]
    pub(super) fn of_square<const PLATEAU: bool>(&self, square: f64) -> (f64, f64) {
        if PLATEAU {
            let distance = square.sqrt();
            let (value, slope) = self.at(distance);
            // At the centre the slope is 0.
            return (value, slope / distance.max(f64::MIN_POSITIVE));
        }
        let rest = (1.0 - square * self.per_square).max(0.0);
        let steep = rest * rest;
        (rest * steep, -6.0 * steep * self.per_square)
    }

    /// Range of the weight and bound of its slope over squared distances.
    pub fn bounds(&self, squares: Interval) -> (Interval, f64) {
        let distances = Interval { min: squares.min.sqrt(), max: squares.max.sqrt() };
        let near = self.at(distances.min).1;
        let far = if distances.max < self.radius_m { self.at(distances.max).1 } else { 0.0 };
        let (high, low) = (self.over(squares.min).0, self.over(squares.max).0);
        let x = |d: f64| (d - self.plateau_m) * self.per_m;
        // The slope grows up to x = 1 / sqrt(5) = 0.447..., and shrinks beyond.
        let slope = if x(distances.min) < 0.4473 && x(distances.max) > 0.4472 {
            STEEPEST * self.per_m
        } else {
            near.abs().max(far.abs()) * (1.0 + 1e-12)
        };
        (Interval { min: low, max: high }, slope)
    }

    /// Bound of the slope of the weight.
    pub fn slope(&self) -> f64 {
        STEEPEST * self.per_m
    }
}
