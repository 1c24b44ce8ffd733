//! Level of detail: A where little detail is asked for, B where much is (Génevaux et al. 2015, section 6).
//!
//! With `t = (kappa - k_A) / (k_B - k_A)` clamped to `[0, 1]`, `f = (1 - t) f_A + t f_B` and the same for the weight.
//! Where one of the two is not defined the elevation is the other's. The slope grows by
//! `sup|f_A - f_B| lambda_kappa / (k_B - k_A)`, which the paper leaves out.

use crate::construction::bounds::Bounds;
use crate::construction::point::Point;
use crate::error::{Error, Result};
use crate::interval::{Interval, product};
use crate::noise::Sample;

/// Levels of detail up to which A stands alone, and from which B does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thresholds {
    from: f64,
    to: f64,
}

impl Thresholds {
    /// The thresholds `k_A` and `k_B`.
    ///
    /// # Errors
    /// A usage error unless 0 <= `from` < `to` <= 1.
    pub fn new(from: f64, to: f64) -> Result<Self> {
        if !(from >= 0.0 && from < to && to <= 1.0) {
            return Err(Error::usage(format!(
                "thresholds of a level of detail need 0 <= from < to <= 1, found {from} and {to}"
            )));
        }
        Ok(Self { from, to })
    }

    /// Share of B at a level of detail.
    #[inline(always)]
    fn share(&self, kappa: f64) -> f64 {
        ((kappa - self.from) / (self.to - self.from)).clamp(0.0, 1.0)
    }

    /// Shares of B over levels of detail.
    pub(in crate::construction) fn shares(&self, kappa: Interval) -> Interval {
        Interval { min: self.share(kappa.min), max: self.share(kappa.max) }
    }
}

/// Mixes A and B at a point.
#[inline(always)]
pub(in crate::construction) fn mix<const GRADIENT: bool>(
    thresholds: &Thresholds,
    kappa: Sample,
    a: Point,
    b: Point,
) -> Point {
    let t = thresholds.share(kappa.value);
    let per = if t > 0.0 && t < 1.0 { 1.0 / (thresholds.to - thresholds.from) } else { 0.0 };
    let (tx, ty) = (kappa.dx * per, kappa.dy * per);
    let (in_a, in_b) = (a.weight.value > 0.0, b.weight.value > 0.0);
    let both = in_a && in_b;
    let s = if both {
        t
    } else if in_a {
        0.0
    } else {
        1.0
    };
    let (f, g) = (&a.elevation, &b.elevation);
    let (v, w) = (&a.weight, &b.weight);
    let mut point = Point {
        elevation: Sample { value: (1.0 - s) * f.value + s * g.value, dx: 0.0, dy: 0.0 },
        weight: Sample { value: (1.0 - t) * v.value + t * w.value, dx: 0.0, dy: 0.0 },
    };
    if GRADIENT {
        let gap = if both { g.value - f.value } else { 0.0 };
        point.elevation.dx = (1.0 - s) * f.dx + s * g.dx + gap * tx;
        point.elevation.dy = (1.0 - s) * f.dy + s * g.dy + gap * ty;
        point.weight.dx = (1.0 - t) * v.dx + t * w.dx + (w.value - v.value) * tx;
        point.weight.dy = (1.0 - t) * v.dy + t * w.dy + (w.value - v.value) * ty;
    }
    point.settled()
}

/// Bounds where both operands show: `t` are the shares of B; either operand may be nothing.
pub(in crate::construction) fn bounds(
    thresholds: &Thresholds,
    t: Interval,
    kappa_slope: f64,
    a: &Bounds,
    b: &Bounds,
) -> Bounds {
    let turn = kappa_slope / (thresholds.to - thresholds.from);
    let stay = Interval { min: 1.0 - t.max, max: 1.0 - t.min };
    let weight = stay.times(a.weight).plus(t.times(b.weight));
    let weight_slope = product(stay.max, a.weight_slope)
        + product(t.max, b.weight_slope)
        + product(a.weight.minus(b.weight).size(), turn);
    let (elevation, slope) = match (a.is_nothing(), b.is_nothing()) {
        (true, true) => return Bounds::NOTHING,
        (false, true) => (a.elevation, a.slope),
        (true, false) => (b.elevation, b.slope),
        (false, false) => {
            // Where one of them ends the other goes on at its own elevation.
            let jumps = a.weight.min <= 0.0 || b.weight.min <= 0.0;
            let slope = a.slope.max(b.slope) + product(a.apart(b), turn);
            (a.elevation.hull(b.elevation), if jumps { f64::INFINITY } else { slope })
        }
    };
    Bounds::new(elevation, slope, weight, weight_slope).widened()
}
