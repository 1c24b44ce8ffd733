//! The ground of a finest quad as its samples show it: a surface that a ray is met with before the terrain is asked.

use super::quads::CELLS;
use super::ray::Ray;
use crate::construction::area::Area;

/// Samples each way, less one.
const LAST: i32 = CELLS as i32 - 1;

/// Samples in the middles of a quad's cells, bilinear between them and level beyond the outermost.
///
/// The mean distance of a place to the samples it lies between, by their shares, is at most half of a cell's diagonal.
/// So the terrain is nowhere further from the surface than [`Patch::rise_m`], by which it can rise on that way.
pub(super) struct Patch {
    /// Elevation from which heights are counted.
    base_m: f64,
    heights_m: [f32; CELLS * CELLS],
    /// How far the terrain is from the surface, at most.
    rise_m: f64,
    /// How far the terrain rises per metre, at most.
    pub(super) slope: f64,
    /// By how much heights are rounded, at most.
    slack_m: f64,
    corner: [f64; 2],
    /// Cells per metre.
    per_m: [f64; 2],
}

/// What a way over a patch is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pass {
    /// Where it first is no higher than the surface, if it is anywhere.
    pub(super) meets_m: Option<f64>,
    /// Where it begins to be less than [`Patch::rise_m`] above the surface, or a little before that.
    pub(super) doubt_m: Option<f64>,
    /// The first place where terrain that is higher than it by more than it may be passes for possible.
    pub(super) unproved_m: Option<f64>,
    /// Whether it is below the ground somewhere for certain.
    pub(super) under: bool,
}

impl Patch {
    /// The surface through samples of a quad; the terrain rises by at most `slope`, infinite where that is not known, and
    /// on half of a cell's diagonal by at most `rise_m`.
    pub(super) fn new(area: &Area, samples_m: &[f64; CELLS * CELLS], rise_m: f64, slope: f64) -> Self {
        let base_m = samples_m[0];
        let heights_m = samples_m.map(|sample| (sample - base_m) as f32);
        let furthest = heights_m.iter().fold(0.0_f32, |most, height| most.max(height.abs()));
        // For what single precision, and coordinates, are rounded by.
        let slack_m = f64::from(furthest) * 1e-7 + base_m.abs() * 1e-14;
        let (rise_m, slope) = (rise_m * (1.0 + 1e-9) + slack_m, slope * (1.0 + 1e-9));
        let per = |width: f64| CELLS as f64 / width;
        let per_m = [per(area.x.width()), per(area.y.width())];
        Self { base_m, heights_m, rise_m, slope, slack_m, corner: [area.x.min, area.y.min], per_m }
    }

    /// Follows a ray from `from_m` to `to_m`, or to where it meets the surface if that is the end. It may pass through
    /// terrain that is higher than it by `sunk_m`.
    pub(super) fn pass(&self, ray: &Ray, [from_m, to_m]: [f64; 2], sunk_m: f64, meeting_ends: bool) -> Pass {
        let mut pass = Pass { meets_m: None, doubt_m: None, unproved_m: None, under: false };
        // In cells, counted from the first sample.
        let speed = [ray.direction[0] * self.per_m[0], ray.direction[1] * self.per_m[1]];
        let [u0, v0]: [f64; 2] = std::array::from_fn(|i| (ray.origin[i] - self.corner[i]) * self.per_m[i] - 0.5);
        let z0 = ray.origin[2] - self.base_m;
        let place = |t: f64| [u0 + t * speed[0], v0 + t * speed[1]];
        let fall = ray.direction[2];
        let way = [speed[0], speed[1], fall];
        let start = [u0, v0];
        let mut cell = place(from_m).map(floor);
        let ahead = speed.map(|speed| i32::from(speed > 0.0));
        let pace = speed.map(|speed| 1.0 / speed.abs());
        let mut next: [f64; 2] = std::array::from_fn(|i| (f64::from(cell[i] + ahead[i]) - start[i]) / speed[i]);
        let mut a = from_m;
        loop {
            let axis = usize::from(next[1] < next[0]);
            let b = next[axis].min(to_m).max(a);
            let corners = self.corners(cell);
            let (z_a, z_b) = (z0 + a * fall, z0 + b * fall);
            if z_a.min(z_b) < corners.top() + self.rise_m {
                let at = [f64::from(cell[0]), f64::from(cell[1])];
                let above = |t: f64| z0 + t * fall - corners.at(place(t), at);
                let (above_a, above_b) = (above(a), above(b));
                // Along a line the surface is a parabola.
                let bend = 2.0 * (above_a - 2.0 * above(0.5 * (a + b)) + above_b);
                let tilt = above_b - above_a - bend;
                let mut least = above_a.min(above_b);
                if bend > 0.0 && tilt < 0.0 && tilt > -2.0 * bend {
                    least = least.min(above_a - tilt * tilt / (4.0 * bend));
                }
                if least < self.rise_m {
                    pass.doubt_m = pass.doubt_m.or(Some(a));
                    pass.under |= least < -self.rise_m;
                    let mut end = b;
                    if least <= 0.0 && pass.meets_m.is_none() {
                        let root = (tilt * tilt - 4.0 * bend * above_a).max(0.0).sqrt();
                        let share = if above_a <= 0.0 { 0.0 } else { (2.0 * above_a / (root - tilt)).clamp(0.0, 1.0) };
                        pass.meets_m = Some(a + share * (b - a));
                        end = if meeting_ends { a + share * (b - a) } else { b };
                    }
                    if pass.unproved_m.is_none() && self.rise_m > sunk_m {
                        let [x, y] = place(a);
                        let from = [x - at[0], y - at[1], z_a + sunk_m];
                        pass.unproved_m = self.unproved(&corners, from, way, end - a).map(|way_m| a + way_m);
                    }
                    if pass.under || (meeting_ends && pass.meets_m.is_some()) {
                        return pass;
                    }
                }
            }
            if b >= to_m {
                return pass;
            }
            cell[axis] += 2 * ahead[axis] - 1;
            next[axis] += pace[axis];
            if !(-1..=LAST).contains(&cell[axis]) {
                // Level from the outermost sample on: there is no further edge.
                cell[axis] = cell[axis].clamp(-1, LAST);
                next[axis] = f64::INFINITY;
            }
            a = b;
        }
    }

    /// The first place of a way between four samples at which terrain may be higher, if there is one. From each sample
    /// on the terrain rises no faster than its slope: what lies above these cones is free.
    fn unproved(&self, corners: &Corners, from: [f64; 3], way: [f64; 3], length_m: f64) -> Option<f64> {
        let [right, up] = [corners.corner + corners.right, corners.corner + corners.up];
        let samples = [corners.corner, right, up, right + corners.up + corners.twist];
        let steep = [self.slope / self.per_m[0], self.slope / self.per_m[1]];
        let mut t = 0.0;
        // Each cone takes the proof further at most once.
        for _ in 0..samples.len() {
            let mut furthest = t;
            for (k, sample) in samples.iter().enumerate() {
                let part = [(k % 2) as f64, (k / 2) as f64];
                let off: [f64; 2] = std::array::from_fn(|i| steep[i] * (from[i] + t * way[i] - part[i]));
                let off_speed: [f64; 2] = std::array::from_fn(|i| steep[i] * way[i]);
                let height = from[2] + t * way[2] - sample - self.slack_m;
                // off² - height² = c + 2 b s + a s² after s more metres.
                let c = off[0] * off[0] + off[1] * off[1] - height * height;
                // Not a number where a slope is not known.
                if height < 0.0 || c > 0.0 || c.is_nan() {
                    continue;
                }
                let b = off[0] * off_speed[0] + off[1] * off_speed[1] - height * way[2];
                let a = off_speed[0] * off_speed[0] + off_speed[1] * off_speed[1] - way[2] * way[2];
                let square = b * b - a * c;
                let leaves = if b > 0.0 && square >= 0.0 {
                    -c / (b + square.sqrt())
                } else if b <= 0.0 && a > 0.0 {
                    (square.max(0.0).sqrt() - b) / a
                } else {
                    f64::INFINITY
                };
                furthest = furthest.max(t + leaves);
            }
            if furthest >= length_m {
                return None;
            }
            if furthest <= t {
                return Some(t);
            }
            t = furthest;
        }
        Some(t)
    }

    /// The samples around a place between them.
    #[inline(always)]
    fn corners(&self, cell: [i32; 2]) -> Corners {
        let [cols, rows] = cell.map(|at| [at.clamp(0, LAST) as usize, (at + 1).clamp(0, LAST) as usize]);
        let height = |row: usize, col: usize| f64::from(self.heights_m[row * CELLS + col]);
        let rows = rows.map(|row| [height(row, cols[0]), height(row, cols[1])]);
        let [left, right] = [rows[0][0], rows[0][1]];
        let up = rows[1][0] - left;
        Corners { corner: left, right: right - left, up, twist: rows[1][1] - right - up }
    }
}

/// A bilinear piece of the surface.
struct Corners {
    corner: f64,
    right: f64,
    up: f64,
    twist: f64,
}

/// The sample before a place, or one beyond the outermost.
#[inline(always)]
fn floor(at: f64) -> i32 {
    let whole = at as i32;
    (whole - i32::from(at < f64::from(whole))).clamp(-1, LAST)
}

impl Corners {
    /// The highest of the four samples.
    #[inline(always)]
    fn top(&self) -> f64 {
        self.corner + self.right.max(0.0).max(self.up.max(self.up + self.right + self.twist))
    }

    #[inline(always)]
    fn at(&self, place: [f64; 2], cell: [f64; 2]) -> f64 {
        let (u, v) = (place[0] - cell[0], place[1] - cell[1]);
        self.corner + u * self.right + v * (self.up + u * self.twist)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interval::Interval;
    use proptest::prelude::*;

    /// The surface by its definition.
    fn surface(patch: &Patch, [x, y]: [f64; 2]) -> f64 {
        let at = |x: f64, i: usize| ((x - patch.corner[i]) * patch.per_m[i] - 0.5).clamp(0.0, f64::from(LAST));
        let (u, v) = (at(x, 0), at(y, 1));
        let (col, row) = ((u.floor() as usize).min(CELLS - 2), (v.floor() as usize).min(CELLS - 2));
        let height = |row: usize, col: usize| f64::from(patch.heights_m[row * CELLS + col]);
        let mix = |a: f64, b: f64, t: f64| a + t * (b - a);
        let (u, v) = (u - col as f64, v - row as f64);
        let line = |row: usize| mix(height(row, col), height(row, col + 1), u);
        patch.base_m + mix(line(row), line(row + 1), v)
    }

    proptest! {
        #[test]
        fn a_pass_is_what_small_steps_say(
            samples in proptest::collection::vec(-1.0..1.0_f64, 64), from in prop::array::uniform2(0.0..8.0_f64),
            to in prop::array::uniform2(0.0..8.0_f64), ends in prop::array::uniform2(-0.5..2.0_f64), rise in 0.05..0.6_f64,
        ) {
            prop_assume!(from[0] != to[0] && from[1] != to[1] && ends[0] != ends[1]);
            let side = |from: f64| Interval { min: from, max: from + 8.0 };
            let area = Area { x: side(10.0), y: side(-4.0) };
            let patch = Patch::new(&area, samples.as_slice().try_into().unwrap(), rise, rise * 2.0_f64.sqrt());
            let origin = [10.0 + from[0], from[1] - 4.0, ends[0]];
            let direction = [to[0] - from[0], to[1] - from[1], ends[1] - ends[0]];
            let ray = Ray { origin, direction, footprint_m: 0.0, growth: 0.0, from_m: 0.0 };
            let pass = patch.pass(&ray, [0.0, 1.0], 0.0, false);
            let above = |t: f64| ray.elevation_m(t) - surface(&patch, ray.at(t));
            let first = |level: f64| (0..=4000).map(|i| f64::from(i) / 4000.0).find(|&t| above(t) <= level);
            // Between two steps the way comes no closer than this.
            let slack = 0.02;
            let free = |t: f64| {
                let [x, y] = ray.at(t);
                (0..64).any(|k| {
                    let (col, row) = ((k % 8) as f64 + 0.5, (k / 8) as f64 + 0.5);
                    let far = (x - 10.0 - col).hypot(y + 4.0 - row);
                    ray.elevation_m(t) >= samples[k] + rise * 2.0_f64.sqrt() * far - 1e-5
                })
            };
            if let Some(t) = (0..=1000).map(|i| f64::from(i) / 1000.0).find(|&t| !free(t)) {
                prop_assert!(pass.under || pass.unproved_m.is_some_and(|unproved| unproved <= t + 1e-9), "{t} {pass:?}");
            }
            if let Some(t) = first(-1e-9) {
                prop_assert!(pass.under || pass.meets_m.is_some_and(|meets| meets <= t + 1e-9));
            }
            if let Some(t) = pass.meets_m {
                let height = above(t);
                prop_assert!(height.abs() < 1e-9 || (t == 0.0 && height < 0.0), "{height} at {t}");
            }
            if let Some(t) = first(rise) {
                prop_assert!(pass.doubt_m.is_some_and(|doubt| doubt <= t));
            } else {
                prop_assert!(pass.doubt_m.is_none() || first(rise + slack).is_some());
            }
            prop_assert!(pass.under || first(-rise - 1e-6).is_none());
            prop_assert!(!pass.under || first(-rise + slack).is_some());
        }
    }
}
