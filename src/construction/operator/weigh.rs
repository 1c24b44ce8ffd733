//! Weights that depend on another node: dunes that lie low, scree that lies steep (Génevaux et al. 2015, figure 13).
//!
//! The elevation is that of B; its weight is multiplied by a ramp of the elevation of a guide, and by a ramp of the
//! guide's slope. Where the guide is not defined neither is the node, so a guide's border inside B is a jump of the
//! weight. The weight's slope is bounded if the guide's slope is, but for a ramp of slopes there is no bound, nor an
//! exact gradient (it would need second derivatives of the guide): differences over [`STEP_M`] stand in.

use crate::construction::bounds::Bounds;
use crate::construction::point::Point;
use crate::error::{Error, Result};
use crate::interval::{Interval, product};
use crate::noise::Sample;

/// Half the distance over which the guide's slope is compared, in metres.
pub(in crate::construction) const STEP_M: f64 = 1.0 / 64.0;

/// 0 at `from` and before, 1 at `to` and beyond, `(3 - 2 t) t²` between; falling where `to` is less than `from`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    from: f64,
    to: f64,
}

/// How a weight depends on the guide.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rules {
    /// Ramp of the guide's elevation in metres.
    pub elevation: Option<Ramp>,
    /// Ramp of the guide's slope, metres per metre.
    pub slope: Option<Ramp>,
}

impl Ramp {
    /// A ramp from 0 at `from` to 1 at `to`.
    ///
    /// # Errors
    /// A usage error unless both are finite and differ.
    pub fn new(from: f64, to: f64) -> Result<Self> {
        if !(from.is_finite() && to.is_finite() && from != to && (1.0 / (to - from)).is_finite()) {
            return Err(Error::usage(format!("a ramp needs two different finite ends, found {from} and {to}")));
        }
        Ok(Self { from, to })
    }

    /// The ramp and its derivative.
    #[inline(always)]
    fn at(&self, value: f64) -> (f64, f64) {
        let width = self.to - self.from;
        let t = ((value - self.from) / width).clamp(0.0, 1.0);
        (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) / width)
    }

    /// Range of the ramp, and bound of its derivative.
    fn bounds(&self, values: Interval) -> (Interval, f64) {
        let (a, b) = (self.at(values.min).0, self.at(values.max).0);
        let range = Interval::new(a, b);
        if range.width() == 0.0 && (a == 0.0 || a == 1.0) {
            return (range, 0.0);
        }
        // t² (3 - 2 t) need not be rounded in order.
        (range.widened().clamped(0.0, 1.0), 1.5 / (self.to - self.from).abs())
    }
}

/// Slope of an elevation.
#[inline(always)]
fn steepness(point: &Point) -> f64 {
    (point.elevation.dx * point.elevation.dx + point.elevation.dy * point.elevation.dy).sqrt()
}

/// Weighs B by its guide at a point; `around` is the guide at steps to the left, right, down and up, if asked for.
#[inline(always)]
pub(in crate::construction) fn weigh<const GRADIENT: bool>(
    rules: &Rules,
    b: Point,
    guide: Point,
    around: Option<[Point; 4]>,
) -> Point {
    let defined = guide.weight.value > 0.0;
    if !defined {
        return Point::NOTHING;
    }
    let (mut share, mut sx, mut sy) = (1.0, 0.0, 0.0);
    if let Some(ramp) = &rules.elevation {
        let (value, slope) = ramp.at(guide.elevation.value);
        (share, sx, sy) = (value, slope * guide.elevation.dx, slope * guide.elevation.dy);
    }
    if let Some(ramp) = &rules.slope {
        let value = ramp.at(steepness(&guide)).0;
        if let (true, Some([left, right, down, up])) = (GRADIENT, &around) {
            let at = |point: &Point| ramp.at(steepness(point)).0;
            sx = sx * value + share * ((at(right) - at(left)) / (2.0 * STEP_M));
            sy = sy * value + share * ((at(up) - at(down)) / (2.0 * STEP_M));
        }
        share *= value;
    }
    let w = &b.weight;
    let mut weight = Sample { value: w.value * share, dx: 0.0, dy: 0.0 };
    if GRADIENT {
        weight.dx = w.dx * share + w.value * sx;
        weight.dy = w.dy * share + w.value * sy;
    }
    Point { elevation: b.elevation, weight }.settled()
}

/// Range of the share that the guide leaves of B's weight, and the bound of its slope.
pub(in crate::construction) fn share(rules: &Rules, guide: &Bounds) -> (Interval, f64) {
    let (mut share, mut slope) = (Interval::ONE, 0.0);
    if guide.is_nothing() {
        return (Interval::ZERO, 0.0);
    }
    if let Some(ramp) = &rules.elevation {
        let (range, steep) = ramp.bounds(guide.elevation);
        (share, slope) = (range, product(steep, guide.slope));
    }
    if let Some(ramp) = &rules.slope {
        let (range, steep) = ramp.bounds(Interval { min: 0.0, max: guide.slope });
        share = share.times(range);
        if steep > 0.0 {
            slope = f64::INFINITY;
        }
    }
    if guide.weight.min <= 0.0 && share.max > 0.0 {
        (share.min, slope) = (0.0, f64::INFINITY);
    }
    (share, slope)
}

/// Bounds of B weighed.
pub(in crate::construction) fn bounds((share, slope): (Interval, f64), b: &Bounds) -> Bounds {
    Bounds {
        elevation: b.elevation,
        slope: b.slope,
        weighted_slope: b.weighted_slope * share.max,
        weight: b.weight.times(share),
        weight_slope: product(b.weight_slope, share.max) + product(b.weight.max, slope),
    }
    .widened()
}
