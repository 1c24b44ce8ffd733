//! A ray's way through what there is to meet.

use super::ray::Ray;
use crate::construction::area::Area;
use crate::construction::bounds::{Bounds, THRESHOLD};
use crate::construction::point::Point;
use crate::interval::{Interval, product};

/// The shortest step, as a share of the tolerance: where there are bounds, and where terrain ends.
const SHORTEST: f64 = 1.0 / 64.0;
const SHORTEST_BARE: f64 = 0.25;
/// Where there is no bound of slope this one is taken for granted, for steps of these shares of the tolerance.
const USUAL_SLOPE: f64 = 2.0;
const USUAL_STEPS: [f64; 2] = [1.0, 16.0];
/// A place below the ground is told from the one before it to this share of the tolerance.
const APART: f64 = 1.0 / 16.0;

/// Where terrain can be: a box in the plane, and elevations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Domain {
    pub(super) area: Area,
    pub(super) elevation: Interval,
}

/// A ray from one place to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub(super) ray: Ray,
    pub(super) from_m: f64,
    pub(super) to_m: f64,
    /// The ground is met no higher above it than this share of a pixel.
    pub(super) tolerance: f64,
    /// Metres of the plane per metre of way.
    pub(super) level: f64,
}

/// Where a line meets the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    /// Metres along the ray.
    pub(super) t_m: f64,
    /// A place up to which no ground was met, and at which it is.
    pub(super) proved_m: f64,
    /// Whether it came from the side, far below the surface.
    pub(super) wall: bool,
    /// Whether the ray gave up here, somewhere above the ground.
    pub(super) lost: bool,
    /// The ground there with its gradient, if it was evaluated already.
    pub(super) ground: Option<Point>,
}

/// A step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// What is to be gone, in metres.
    pub(super) far: f64,
    /// The shortest step, in metres; `far` is at least as long.
    pub(super) least: f64,
}

impl Line {
    /// The ray's way through a domain; `None` where it passes by.
    pub(super) fn through(ray: Ray, domain: &Domain, tolerance: f64) -> Option<Self> {
        let (mut from, mut to) = (ray.from_m, f64::INFINITY);
        let ends = [
            (domain.area.x, ray.origin[0], ray.direction[0]),
            (domain.area.y, ray.origin[1], ray.direction[1]),
            // The ground has no lower end: a ray may come upon its edge from the side.
            (Interval { min: f64::NEG_INFINITY, max: domain.elevation.max }, ray.origin[2], ray.direction[2]),
        ];
        for (range, origin, speed) in ends {
            if speed == 0.0 {
                if !range.holds(origin) {
                    return None;
                }
                continue;
            }
            let (a, b) = ((range.min - origin) / speed, (range.max - origin) / speed);
            from = from.max(a.min(b));
            to = to.min(a.max(b));
        }
        let [dx, dy, _] = ray.direction;
        // Straight down there is no end but the ground.
        let level = (dx * dx + dy * dy).sqrt();
        let to = if level == 0.0 && ray.direction[2] < 0.0 {
            to.min((domain.elevation.min - ray.origin[2]) / ray.direction[2] + ray.pixel_m(from).abs() + 1.0)
        } else {
            to
        };
        (from <= to && from.is_finite() && to.is_finite()).then_some(Self {
            ray,
            from_m: from,
            to_m: to,
            tolerance,
            level,
        })
    }

    /// How far above the ground it may be met after so many metres.
    #[inline(always)]
    pub(super) fn near_m(&self, t_m: f64) -> f64 {
        self.tolerance * self.ray.pixel_m(t_m)
    }

    /// Way in metres from a place at which the terrain is known, through a region with these bounds, that is free of
    /// ground. Up to rounding that is proved, but for the shortest steps.
    ///
    /// Slopes bind along ways of positive weight. Where the region has points without weight, the weight cannot have
    /// fallen by more than half within `weight / 2 / weight_slope`; and below the threshold there is no terrain before
    /// the weight has risen. Where there is no bound, ground that is steeper than [`USUAL_SLOPE`] may be missed if it is
    /// narrower than the longest of [`USUAL_STEPS`], 8 pixels at the usual tolerance.
    pub(super) fn free_m(&self, bounds: &Bounds, t_m: f64, height_m: f64, weight: f64) -> Step {
        let near = self.near_m(t_m);
        let weight_speed = product(bounds.weight_slope, self.level);
        let (mut free, mut bounded, mut least) = (0.0_f64, false, near * SHORTEST);
        if weight < THRESHOLD {
            free = (THRESHOLD - weight) / weight_speed;
            bounded = weight_speed.is_finite();
            least = near * if bounded { SHORTEST_BARE } else { USUAL_STEPS[0] };
        }
        if height_m > 0.0 && weight > 0.0 {
            for (low, limit) in [(bounds.weight.min, f64::INFINITY), (weight / 2.0, weight / 2.0 / weight_speed)] {
                let slope = if low > 0.0 { bounds.slope.min(bounds.weighted_slope / low) } else { f64::INFINITY };
                free = free.max(self.way_m(height_m, slope).min(limit));
                bounded |= slope.is_finite() && limit > 0.0;
            }
            if !bounded && weight >= THRESHOLD {
                let [least, most] = USUAL_STEPS.map(|share| near * share);
                return Step { far: self.way_m(height_m, USUAL_SLOPE).clamp(least, most), least };
            }
        }
        Step { far: free.max(least), least }
    }

    /// How fast the line's height above the ground may shrink and grow per metre of way, through a region with these
    /// bounds all of whose points have weight; `None` where there are others, or no bound.
    pub(super) fn speeds(&self, bounds: &Bounds) -> Option<[f64; 2]> {
        let low = bounds.weight.min;
        let slope = if low > 0.0 { bounds.slope.min(bounds.weighted_slope / low) } else { f64::INFINITY };
        let (level, rise) = (slope * self.level, self.ray.direction[2]);
        slope.is_finite().then_some([level - rise, level + rise])
    }

    /// Whether a height above the ground proves that there was none on so many metres of way before it, through a region
    /// with these bounds: it must be at least what it can have grown by on them.
    pub(super) fn clears(&self, bounds: &Bounds, way_m: f64, height_m: f64) -> bool {
        height_m > 0.0 && self.speeds(bounds).is_some_and(|[_, grows]| height_m >= grows * way_m)
    }

    /// Way to ground that is `height_m` below, if none is steeper than `slope`.
    fn way_m(&self, height_m: f64, slope: f64) -> f64 {
        let closing = product(slope, self.level) - self.ray.direction[2];
        if closing <= 0.0 { f64::INFINITY } else { height_m / closing }
    }
}

/// How far a line has been followed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Progress {
    /// The next place to look at.
    pub(super) t_m: f64,
    /// The last place that was free, and its height above the ground if there is some.
    before: Option<(f64, Option<f64>)>,
    /// A place that was found below the ground, more than the tolerance.
    below_m: Option<f64>,
    steps: u32,
}

/// What a place says.
pub(super) enum Verdict {
    /// The line has ended.
    Met(Hit),
    /// The next place is set, between one that is free and one below the ground.
    Between,
    /// The place is free.
    Free,
}

impl Progress {
    pub(super) fn new(from_m: f64) -> Self {
        Self { t_m: from_m, before: None, below_m: None, steps: 0 }
    }

    /// The last place that was free, and its height above the ground, if there was some.
    pub(super) fn last(&self) -> Option<(f64, f64)> {
        self.before.and_then(|(t_m, height)| height.map(|height| (t_m, height)))
    }

    /// Counts a place that was looked at in vain.
    pub(super) fn wasted(&mut self) {
        self.steps += 1;
    }

    /// Judges the place `t_m` by the ground there.
    pub(super) fn judge(&mut self, line: &Line, t_m: f64, height_m: f64, weight: f64, max_steps: u32) -> Verdict {
        self.steps += 1;
        let near = line.near_m(t_m);
        let meets = weight >= THRESHOLD && height_m <= near;
        let hit = |t_m: f64, wall: bool, lost: bool| Verdict::Met(Hit { t_m, proved_m: t_m, wall, lost, ground: None });
        if self.steps >= max_steps {
            return hit(t_m, false, !meets);
        }
        if !meets {
            self.before = Some((t_m, (weight >= THRESHOLD).then_some(height_m)));
        } else if height_m >= -near {
            return Verdict::Met(self.settled(line, t_m, height_m));
        } else {
            self.below_m = Some(t_m);
        }
        let Some(below) = self.below_m else { return Verdict::Free };
        let Some((free, _)) = self.before else { return hit(below, true, false) };
        if below - free <= near * APART {
            return hit(below, true, false);
        }
        self.t_m = 0.5 * (free + below);
        Verdict::Between
    }

    /// Where a line that is at the ground meets it: the end of the chord from the place before.
    fn settled(&self, line: &Line, t_m: f64, height_m: f64) -> Hit {
        let mut t = t_m;
        if let Some((t0, Some(h0))) = self.before {
            let fall = h0 - height_m;
            if fall > 0.0 {
                // Not beyond the place as far again: there the chord says nothing.
                t = (t_m + height_m * (t_m - t0) / fall).clamp(t0, t_m + (t_m - t0)).min(line.to_m);
            }
        }
        Hit { t_m: t, proved_m: t_m, wall: false, lost: false, ground: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_clears_a_way_leaves_no_room_for_a_wall(
            fall in -0.5..1.0_f64, slope in 0.1..4.0_f64, way_m in 0.1..20.0_f64, height_m in -1.0..30.0_f64,
            top in 0.0..1.0_f64,
        ) {
            let ray = Ray { origin: [0.0, 0.0, 0.0], direction: [1.0, 0.0, -fall], footprint_m: 0.1, growth: 0.0, from_m: 0.0 };
            let line = Line { ray, from_m: 0.0, to_m: way_m, tolerance: 0.5, level: 1.0 };
            let bounds = Bounds::new(Interval { min: -1e3, max: 1e3 }, slope, Interval::ONE, 0.0);
            // The steepest wall there can be, which stands as high as it can anywhere on the way.
            let ground_at_end = ray.elevation_m(way_m) - height_m;
            let highest = ground_at_end + slope * way_m * (1.0 - top);
            let is_met = highest >= ray.elevation_m(way_m * top) || height_m <= 0.0;
            if line.clears(&bounds, way_m, height_m) {
                prop_assert!(!is_met || (highest - ray.elevation_m(way_m * top)).abs() < 1e-9);
            }
            // Nor is more asked for than that: the wall at the way's beginning would be met.
            let rises = slope - fall >= 0.0 && height_m > 1e-9;
            if rises && ground_at_end + slope * way_m < -1e-9 {
                prop_assert!(line.clears(&bounds, way_m, height_m));
            }
        }
    }
}
