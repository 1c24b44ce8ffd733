//! Addition: `f = f_A + alpha_B f_B` (Génevaux et al. 2015, section 5.3): details upon a terrain.
//!
//! The weight is `alpha_A`, or `alpha_A + alpha_B²`. With the latter rule B may lie where A is not defined; the terrain
//! there is `alpha_B f_B`, and jumps at A's border: no bound of the slope.

use super::WeightRule;
use crate::construction::bounds::Bounds;
use crate::construction::point::Point;
use crate::interval::product;
use crate::noise::Sample;

/// Adds B to A at a point.
#[inline(always)]
pub(in crate::construction) fn add<const GRADIENT: bool>(rule: WeightRule, a: Point, b: Point) -> Point {
    let (f, w) = (&b.elevation, &b.weight);
    let mut elevation = Sample { value: a.elevation.value + w.value * f.value, dx: 0.0, dy: 0.0 };
    if GRADIENT {
        elevation.dx = a.elevation.dx + (w.value * f.dx + f.value * w.dx);
        elevation.dy = a.elevation.dy + (w.value * f.dy + f.value * w.dy);
    }
    let weight = match rule {
        WeightRule::Keep => a.weight,
        WeightRule::Join => Sample {
            value: a.weight.value + w.value * w.value,
            dx: a.weight.dx + 2.0 * w.value * w.dx,
            dy: a.weight.dy + 2.0 * w.value * w.dy,
        },
    };
    Point { elevation, weight }.settled()
}

/// Bounds of an addition in which B is something; where A is nothing the rule is [`WeightRule::Join`].
pub(in crate::construction) fn bounds(rule: WeightRule, a: &Bounds, b: &Bounds) -> Bounds {
    let added = b.weight.times(b.elevation);
    let rise = b.weighted_slope + product(b.elevation.size(), b.weight_slope);
    let elevation = a.elevation.plus(added);
    match rule {
        WeightRule::Keep => {
            let weighted_slope = a.weighted_slope + product(a.weight.max, rise);
            Bounds { elevation, slope: a.slope + rise, weighted_slope, weight: a.weight, weight_slope: a.weight_slope }
        }
        WeightRule::Join => {
            let bare = a.weight.min <= 0.0 && !a.is_nothing();
            let elevation = if bare { elevation.hull(added) } else { elevation };
            let slope = if bare { f64::INFINITY } else { a.slope + rise };
            let weight = a.weight.plus(b.weight.square());
            let weight_slope = a.weight_slope + product(2.0 * b.weight.max, b.weight_slope);
            Bounds::new(elevation, slope, weight, weight_slope)
        }
    }
    .widened()
}
