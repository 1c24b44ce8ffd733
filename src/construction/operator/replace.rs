//! Replacement: `f = (1 - beta) f_A + beta f_B` (Génevaux et al. 2015, section 5.2).
//!
//! `beta` is `alpha_B` clamped to `[0, 1]`: a blend's weight may exceed 1, and the printed formula would then overshoot
//! `f_B`. The weight is `alpha_A`, or `(1 - beta) alpha_A + beta²`. With the latter rule B may lie where A is not
//! defined: there the elevation is `f_B` alone. Where the border of A runs through B, and B does not cover it fully, the
//! terrain jumps there, and there is no bound of the slope.

use super::WeightRule;
use crate::construction::bounds::Bounds;
use crate::construction::point::Point;
use crate::interval::{Interval, product};
use crate::noise::Sample;

/// Replaces A by B at a point.
#[inline(always)]
pub(in crate::construction) fn replace<const GRADIENT: bool>(rule: WeightRule, a: Point, b: Point) -> Point {
    let raw = b.weight.value;
    let beta = raw.clamp(0.0, 1.0);
    // Clamped it does not change.
    let (bx, by) = if raw < 1.0 { (b.weight.dx, b.weight.dy) } else { (0.0, 0.0) };
    let defined = a.weight.value > 0.0;
    let (keep, take) = if defined { (1.0 - beta, beta) } else { (0.0, 1.0) };
    let mut elevation = Sample { value: keep * a.elevation.value + take * b.elevation.value, dx: 0.0, dy: 0.0 };
    if GRADIENT {
        let gap = if defined { b.elevation.value - a.elevation.value } else { 0.0 };
        elevation.dx = keep * a.elevation.dx + take * b.elevation.dx + gap * bx;
        elevation.dy = keep * a.elevation.dy + take * b.elevation.dy + gap * by;
    }
    let weight = match rule {
        WeightRule::Keep => a.weight,
        WeightRule::Join => {
            let (stay, turn) = (1.0 - beta, 2.0 * beta - a.weight.value);
            Sample {
                value: stay * a.weight.value + beta * beta,
                dx: stay * a.weight.dx + turn * bx,
                dy: stay * a.weight.dy + turn * by,
            }
        }
    };
    Point { elevation, weight }.settled()
}

/// Bounds of a replacement in which B is something; where A is nothing the rule is [`WeightRule::Join`].
pub(in crate::construction) fn bounds(rule: WeightRule, a: &Bounds, b: &Bounds) -> Bounds {
    let beta = b.weight.clamped(0.0, 1.0);
    let stay = Interval { min: 1.0 - beta.max, max: 1.0 - beta.min };
    let turn = if b.weight.min < 1.0 { b.weight_slope } else { 0.0 };
    if a.is_nothing() {
        // Only the weight is not that of B.
        let weighted_slope = product(beta.max, b.weighted_slope);
        let weight_slope = product(2.0 * beta.max, turn);
        return Bounds { weighted_slope, weight: beta.square(), weight_slope, ..*b }.widened();
    }
    let drift = product(a.apart(b), turn);
    // beta times the slope of B, which is bounded where the slope alone is not.
    let from_b = product(beta.max, b.slope).min(b.weighted_slope);
    let apart = product(stay.max, a.slope) + from_b;
    // Both at once are never whole.
    let mixed = (product(stay.max, a.slope) + product(beta.min, b.slope))
        .max(product(stay.min, a.slope) + product(beta.max, b.slope));
    let mut slope = apart.min(mixed) + drift;
    let elevation = if beta.min >= 1.0 { b.elevation } else { a.elevation.hull(b.elevation) };
    match rule {
        WeightRule::Keep => {
            let weighted = product(stay.max, a.weighted_slope) + product(a.weight.max, from_b + drift);
            let weighted_slope = weighted.min(product(slope, a.weight.max));
            Bounds { elevation, slope, weighted_slope, weight: a.weight, weight_slope: a.weight_slope }
        }
        WeightRule::Join => {
            if a.weight.min <= 0.0 && beta.min < 1.0 {
                slope = f64::INFINITY;
            }
            let weight = stay.times(a.weight).plus(beta.square());
            let push = beta.scaled(2.0).minus(a.weight).size();
            let weight_slope = product(stay.max, a.weight_slope) + product(push, turn);
            Bounds::new(elevation, slope, weight, weight_slope)
        }
    }
    .widened()
}
