//! Blending: `f = sum alpha_i f_i / sum alpha_i`, `alpha = sum alpha_i` (Génevaux et al. 2015, section 5.1).
//!
//! # Bounds
//! `grad f = sum alpha_i grad f_i / alpha + sum (f_i - f) grad alpha_i / alpha`. With `f_i - f = sum_j beta_j (f_i - f_j)`
//! and `beta_j = alpha_j / alpha`, the second sum is at most `D (sum lambda_i - min lambda_i) / inf alpha`, D the
//! greatest difference of two children and `lambda_i` the slopes of their weights. For two children that is
//! `max(lambda_A, lambda_B) + sup|f_A - f_B| max(lambda_alpha_A, lambda_alpha_B) / inf(alpha_A + alpha_B)`. The
//! paper's appendix drops the division by `alpha_A + alpha_B`; where the terrain is defined that is a factor of at
//! most 1 / T = 2, on the fringe there is no bound. The first sum is the greatest mean of the children's slopes by
//! shares `beta_i` that their weights allow; and the second is also at most the sum of `sup|f_i - f| lambda_i / inf alpha`.
//! Elevations are bounded by means like slopes. What stays bounded there is alpha times the slope,
//! [`Bounds::weighted_slope`], which is why a blend of blends still has a slope where it is defined.

use crate::construction::bounds::Bounds;
use crate::construction::point::{Block, Point, WIDTH};
use crate::interval::{Interval, product};
use crate::noise::Sample;

/// Adds a child to the sums: numerator in `elevation`, denominator in `weight`.
#[inline(always)]
fn gather<const GRADIENT: bool>(sum: &mut Point, child: &Point) {
    let (f, w) = (&child.elevation, &child.weight);
    sum.elevation.value += w.value * f.value;
    sum.weight.value += w.value;
    if GRADIENT {
        sum.elevation.dx += w.value * f.dx + f.value * w.dx;
        sum.elevation.dy += w.value * f.dy + f.value * w.dy;
        sum.weight.dx += w.dx;
        sum.weight.dy += w.dy;
    }
}

/// The blend of what was gathered.
#[inline(always)]
fn divide<const GRADIENT: bool>(sum: Point) -> Point {
    let Point { elevation: n, weight: w } = sum;
    let value = n.value / w.value;
    let slope = |n: f64, w_slope: f64| if GRADIENT { (n - value * w_slope) / w.value } else { 0.0 };
    Point { elevation: Sample { value, dx: slope(n.dx, w.dx), dy: slope(n.dy, w.dy) }, weight: w }.settled()
}

/// The blend of any number of children at a point, in their order.
pub(in crate::construction) fn blend(children: impl Iterator<Item = Point>) -> Point {
    let mut sum = Point::NOTHING;
    for child in children {
        gather::<true>(&mut sum, &child);
    }
    divide::<true>(sum)
}

/// Adds a child's block to the sums.
#[inline(always)]
pub(in crate::construction) fn gather_block<const GRADIENT: bool>(sum: &mut Block, child: &Block, count: usize) {
    for k in 0..count.min(WIDTH) {
        let mut point = sum.get::<GRADIENT>(k);
        gather::<GRADIENT>(&mut point, &child.get::<GRADIENT>(k));
        sum.set::<GRADIENT>(k, point);
    }
}

/// The blend of what was gathered, in place.
#[inline(always)]
pub(in crate::construction) fn divide_block<const GRADIENT: bool>(sum: &mut Block, count: usize) {
    for k in 0..count.min(WIDTH) {
        sum.set::<GRADIENT>(k, divide::<GRADIENT>(sum.get::<GRADIENT>(k)));
    }
}

/// The greatest `sum beta_i value_i` over shares `beta_i` within their ranges whose sum is 1: all have their least, and
/// the rest goes where values are greatest.
fn greatest(shares: &[Interval], mut values: Vec<(f64, usize)>) -> f64 {
    values.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut rest = 1.0 - shares.iter().map(|share| share.min).sum::<f64>();
    let mut sum = 0.0;
    for (value, i) in values {
        let more = shares[i].width().min(rest).max(0.0);
        rest -= more;
        sum += product(shares[i].min + more, value);
    }
    sum
}

/// Ranges of the children's shares of the weight. A little wider than they are: they are divided by sums of two kinds.
fn shares(children: &[Bounds], weight: Interval) -> Vec<Interval> {
    let share = |child: &Bounds| {
        let own = child.weight;
        let others = Interval { min: (weight.min - own.min).max(0.0), max: weight.max - own.max };
        let of = |own: f64, others: f64| if own > 0.0 { own / (own + others.max(0.0)) } else { 0.0 };
        Interval {
            min: of(own.min, others.max) * (1.0 - 1e-12),
            max: (of(own.max, others.min) * (1.0 + 1e-12)).min(1.0),
        }
    };
    children.iter().map(share).collect()
}

/// Bounds of a blend of children none of which is nothing.
pub(in crate::construction) fn bounds(children: &[Bounds]) -> Bounds {
    let [first, others @ ..] = children else { return Bounds::NOTHING };
    if others.is_empty() {
        let weighted_slope = first.weighted_slope.min(product(first.slope, first.weight.max));
        return Bounds { weighted_slope, ..*first }.widened();
    }
    let mut hull = first.elevation;
    let mut weight = Interval::ZERO;
    let (mut weighted, mut slopes, mut least) = (0.0, 0.0, f64::INFINITY);
    for child in children {
        hull = hull.hull(child.elevation);
        weight = weight.plus(child.weight);
        weighted += child.weighted_slope;
        slopes += child.weight_slope;
        least = least.min(child.weight_slope);
    }
    let shares = shares(children, weight);
    let listed = |value: &dyn Fn(&Bounds) -> f64| children.iter().map(value).enumerate().map(|(i, v)| (v, i)).collect();
    let steepest = greatest(&shares, listed(&|child| child.slope));
    let top = greatest(&shares, listed(&|child| child.elevation.max));
    let bottom = -greatest(&shares, listed(&|child| -child.elevation.min));
    let slack = hull.size() * 1e-11;
    let elevation = Interval { min: hull.min.max(bottom - slack), max: hull.max.min(top + slack) };
    // No child is further from the blend than this, nor from another child.
    let apart = |child: &Bounds| child.elevation.minus(elevation).size().min(hull.width());
    // An infinite slope of a weight less itself is no number.
    let most = if least.is_finite() { slopes - least } else { slopes };
    let each: f64 = children.iter().map(|child| product(apart(child), child.weight_slope)).sum();
    let drift = product(hull.width(), most).min(each);
    let over = |bound: f64| if bound == 0.0 { 0.0 } else { bound / weight.min };
    let slope = (steepest + over(drift)).min(over(weighted + drift));
    let weighted_slope = (weighted + drift).min(product(slope, weight.max));
    Bounds { elevation, slope, weighted_slope, weight, weight_slope: slopes }.widened()
}
