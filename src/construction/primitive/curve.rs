//! Curves: rivers and roads.

use super::profile::Profile;
use super::skeleton::{Hit, Skeleton, cross, dot};
use super::{FallOff, Primitive};
use crate::construction::area::{Area, Region};
use crate::construction::bounds::Bounds;
use crate::construction::point::{Block, Place, Places, Point, Want};
use crate::construction::vectors::widest;
use crate::error::{Error, Result};
use crate::interval::{Interval, product};
use crate::noise::Sample;

/// Places whose nearest points are found at once.
const LANES: usize = 8;

/// A river or a road: `f(p) = q_z + c(d)`, q the nearest point of the skeleton, d the signed distance from it (positive
/// on the left), c the cross-section there (Génevaux et al. 2015, section 4.1).
///
/// Cross-sections stand at places along the curve; between two of them they are mixed by `(3 - 2 t) t²` of the way.
/// Beyond the ends the sides' profiles are mixed by direction, so that the terrain goes round without a step. The weight
/// falls off with the distance.
///
/// # Bounds
/// The nearest point moves `1 / (1 - k d)` times as far as the place, k the curvature: slopes are bounded within the
/// skeleton's reach only. There is no bound where `k d` may reach 1, where the curve turns by more than a right angle
/// near the region (it may come back on its other side), and at corners, unless the terrain depends on the bare distance
/// alone: one symmetric profile, level skeleton. The weight has its bound everywhere, for distances always do.
#[derive(Clone, Debug)]
pub struct Curve {
    skeleton: Skeleton,
    /// Cross-sections with their places along the curve in metres, ascending.
    sections: Vec<(f64, Profile)>,
    fall_off: FallOff,
    /// Whether the terrain depends on the distance alone.
    plain: bool,
}

impl Curve {
    /// A curve with cross-sections at shares `[0, 1]` of its length, ascending.
    ///
    /// # Errors
    /// A usage error for no cross-section, and for shares that do not ascend within `[0, 1]`.
    pub fn new(skeleton: Skeleton, sections: Vec<(f64, Profile)>, fall_off: FallOff) -> Result<Self> {
        let shares: Vec<f64> = sections.iter().map(|section| section.0).collect();
        let sound = shares.iter().all(|s| (0.0..=1.0).contains(s)) && shares.windows(2).all(|pair| pair[0] < pair[1]);
        if shares.is_empty() || !sound {
            return Err(Error::usage(format!(
                "a curve needs cross-sections at ascending shares of its length from 0 to 1, found {shares:?}"
            )));
        }
        let length_m = skeleton.length_m();
        let sections: Vec<(f64, Profile)> =
            sections.into_iter().map(|(share, profile)| (share * length_m, profile)).collect();
        let heights = skeleton.pieces().iter().map(|piece| piece.elevations_m());
        let level = heights.clone().all(|(_, slope)| slope == 0.0);
        let plain = level && sections.len() == 1 && sections[0].1.is_even();
        Ok(Self { skeleton, sections, fall_off, plain })
    }

    /// The skeleton.
    pub fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }

    /// Cross-section at a place along the curve and a distance: height, derivatives by place and by distance.
    fn section(&self, along_m: f64, d: f64) -> (f64, f64, f64) {
        let after = self.sections.partition_point(|section| section.0 <= along_m);
        let single = |i: usize| {
            let (height, slope) = self.sections[i].1.at(d);
            (height, 0.0, slope)
        };
        if after == 0 {
            return single(0);
        }
        let Some((to_m, next)) = self.sections.get(after) else { return single(after - 1) };
        let (from_m, before) = &self.sections[after - 1];
        let width = to_m - from_m;
        let t = (along_m - from_m) / width;
        let (share, turn) = (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) / width);
        let ((a, a_slope), (b, b_slope)) = (before.at(d), next.at(d));
        (a + share * (b - a), turn * (b - a), a_slope + share * (b_slope - a_slope))
    }

    /// The point at a place whose nearest point is known.
    fn point(&self, at: [f64; 2], hit: &Hit) -> Point {
        let piece = self.skeleton.piece(hit.piece);
        let foot = piece.at(hit.t);
        let offset = [at[0] - foot[0], at[1] - foot[1]];
        let d = hit.distance_m;
        let tangent = piece.tangent(hit.t);
        let side = cross(tangent, offset);
        let away = if d > 0.0 { [offset[0] / d, offset[1] / d] } else { [0.0, 0.0] };
        let (share, fall) = self.fall_off.at(d);
        let weight = Sample { value: share, dx: fall * away[0], dy: fall * away[1] };
        let along_m = piece.from_m + hit.t * piece.length_m;
        let (z, z_slope) = piece.elevation_m(hit.t);
        if hit.is_end {
            // Round the end: from one side's profile to the other's.
            let (left, _, left_slope) = self.section(along_m, d);
            let (right, _, right_slope) = self.section(along_m, -d);
            let sine = if d > 0.0 { (side / d).clamp(-1.0, 1.0) } else { 0.0 };
            let m = (1.0 + sine) / 2.0;
            let radial = m * left_slope - (1.0 - m) * right_slope;
            // Gradient of the sine: the left normal less its part along the offset, over the distance.
            let normal = [-tangent[1], tangent[0]];
            let spin = if d > 0.0 { (left - right) / (2.0 * d) } else { 0.0 };
            let slope = |k: usize| radial * away[k] + spin * (normal[k] - sine * away[k]);
            let value = z + (right + m * (left - right));
            return Point { elevation: Sample { value, dx: slope(0), dy: slope(1) }, weight }.settled();
        }
        let sign = if side < 0.0 { -1.0 } else { 1.0 };
        let (height, by_place, by_distance) = self.section(along_m, sign * d);
        let mut elevation = Sample { value: z + height, dx: 0.0, dy: 0.0 };
        // On the curve itself the distance has the direction of its normal.
        let normal = if d > 0.0 { [sign * away[0], sign * away[1]] } else { [-tangent[1], tangent[0]] };
        elevation.dx = by_distance * normal[0];
        elevation.dy = by_distance * normal[1];
        if !hit.is_fixed {
            // grad t = B' / (|B'|² - (p - B) . B'').
            let velocity = piece.velocity(hit.t);
            let speed = dot(velocity, velocity);
            let bend = speed - dot(offset, piece.acceleration());
            if bend > 1e-9 * speed {
                let rise = (z_slope + by_place * piece.length_m) / bend;
                elevation.dx += rise * velocity[0];
                elevation.dy += rise * velocity[1];
            }
        }
        Point { elevation, weight }.settled()
    }
}

impl Primitive for Curve {
    fn support(&self) -> Area {
        self.skeleton.area().grown(self.fall_off.radius_m()).widened()
    }

    fn bounds(&self, region: &Region) -> Bounds {
        let (centre, reach) = (region.area.centre(), region.area.radius());
        let size = region.area.x.size().max(region.area.y.size());
        let slack = 1e-13 * size + 1e-12 * reach;
        let radius_m = self.fall_off.radius_m();
        let limit = (radius_m + reach) * 1.001 + slack;
        let Some(middle) = self.skeleton.distance_m(centre, limit) else { return Bounds::NOTHING };
        let (least, most) = ((middle - reach - slack).max(0.0), middle + reach + slack);
        let (weight, weight_slope) = self.fall_off.bounds(Interval { min: least * least, max: most * most });
        if weight.max <= 0.0 {
            return Bounds::NOTHING;
        }
        let far = most.min(radius_m);
        let mut near = vec![];
        self.skeleton.near(&region.area, far + slack, &mut near);
        let (Some(&first), Some(&last)) = (near.first(), near.last()) else { return Bounds::NOTHING };

        let mut heights: Option<Interval> = None;
        let mut steep = 0.0_f64;
        for (_, profile) in &self.sections {
            let (range, slope) = profile.bounds(Interval { min: -far, max: far });
            heights = Some(heights.map_or(range, |all| all.hull(range)));
            steep = steep.max(slope);
        }
        let heights = heights.unwrap_or(Interval::ZERO);
        // Greatest change of the cross-section by the place along the curve.
        let turn = self.sections.windows(2).fold(0.0_f64, |turn, pair| turn.max(1.5 / (pair[1].0 - pair[0].0)));
        let by_place = product(heights.width(), turn);
        let mut z: Option<Interval> = None;
        let (mut along, mut bounded) = (0.0_f64, true);
        let pieces = self.skeleton.pieces();
        for &i in &near {
            let piece = &pieces[i as usize];
            let (range, slope) = piece.elevations_m();
            z = Some(z.map_or(range, |all| all.hull(range)));
            let bend = 1.0 - piece.curvature * far;
            bounded &= bend > 1e-6;
            along = along.max((slope + by_place * piece.length_m) / (piece.slowest * bend.max(1e-6)));
        }
        bounded &= !near.iter().any(|&i| i > first && pieces[i as usize].corner);
        let (from, to) = (&pieces[first as usize], &pieces[last as usize]);
        bounded &= to.turned_before + to.turning - from.turned_before < std::f64::consts::FRAC_PI_2;
        let within = |end: [f64; 2]| region.area.square_distances(end).min <= (far + slack) * (far + slack);
        let has_end = within(pieces[0].at(0.0)) || within(pieces[pieces.len() - 1].at(1.0));
        let slope = if self.plain {
            steep
        } else if bounded {
            // Round an end both the distance and the direction count.
            let across = if has_end { steep * std::f64::consts::SQRT_2 } else { steep };
            across.max((along * along + steep * steep).sqrt())
        } else {
            f64::INFINITY
        };
        Bounds::new(heights.plus(z.unwrap_or(Interval::ZERO)), slope, weight, weight_slope).widened()
    }

    fn at(&self, place: &Place) -> Point {
        let mut pieces = vec![];
        let radius_m = self.fall_off.radius_m();
        self.skeleton.near(&Area::of(&[place.at]), radius_m, &mut pieces);
        self.skeleton.nearest(&pieces, place.at, radius_m).map_or(Point::NOTHING, |hit| self.point(place.at, &hit))
    }

    fn block(&self, places: &Places, _: Want, out: &mut Block) {
        let mut pieces = vec![];
        let radius_m = self.fall_off.radius_m();
        self.skeleton.near(&places.area, radius_m, &mut pieces);
        let (xs, ys) = (places.x.as_chunks::<LANES>().0, places.y.as_chunks::<LANES>().0);
        for (i, (xs, ys)) in xs.iter().zip(ys).take(places.count().div_ceil(LANES)).enumerate() {
            let found = widest(
                #[inline(always)]
                || self.skeleton.nearest_of(&pieces, xs, ys, radius_m),
            );
            for k in 0..LANES {
                let hit = self.skeleton.hit(&found, k);
                let point = hit.map_or(Point::NOTHING, |hit| self.point([xs[k], ys[k]], &hit));
                out.set::<true>(i * LANES + k, point);
            }
        }
    }

    fn misses(&self, area: &Area) -> bool {
        let (centre, radius) = (area.centre(), area.radius());
        // Half the diagonal is a little more than rounding takes away.
        radius.is_finite() && self.skeleton.distance_m(centre, self.fall_off.radius_m() + radius).is_none()
    }

    fn bytes(&self) -> usize {
        let sections: usize =
            self.sections.iter().map(|(_, profile)| size_of::<(f64, Profile)>() + profile.bytes()).sum();
        size_of::<Self>() + self.skeleton.bytes() + sections
    }
}
