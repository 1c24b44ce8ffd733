//! Contours: lakes, hollows and mounds around a centre.

use super::profile::Profile;
use super::skeleton::{Piece, cross, dot, inner_tangent, pair};
use super::{FallOff, Primitive};
use crate::construction::area::{Area, Region};
use crate::construction::bounds::Bounds;
use crate::construction::point::{Place, Point};
use crate::error::{Error, Result};
use crate::interval::Interval;
use crate::noise::Sample;

/// A shape around a centre: `f(p) = c_z + c(rho)`, rho the distance from the centre relative to that of a closed curve in
/// the same direction: 0 at the centre, 1 on the curve (Génevaux et al. 2015, section 4.1, lakes).
///
/// The curve goes smoothly through points around the centre, and is seen whole from there. A radial profile stands at
/// every point, or one for all; between two points they are mixed by `(3 - 2 t) t²` of the way along the curve, so by
/// angular sector. The weight falls off with rho.
///
/// # Bounds
/// With h the distance from the centre to the tangent at the curve's point, `|grad rho| = 1 / h`. Mixing profiles adds
/// their difference times the slope of the mix, which grows as 1 / rho towards the centre: bounded because profiles must
/// agree at the centre (the paper does not ask for it, and has no bound there).
#[derive(Clone, Debug)]
pub struct Contour {
    centre: [f64; 2],
    z_m: f64,
    /// Two a point, relative to the centre.
    pieces: Vec<Piece>,
    profiles: Vec<Profile>,
    fall_off: FallOff,
    area: Area,
    /// Least of h, in metres, and the greatest of `R / (B x B')`, per metre of speed.
    least_m: f64,
    spin: f64,
}

impl Contour {
    /// A contour through `points`, in order, to the left or to the right around `centre`. Places of profiles and of the
    /// fall-off are relative: 1 lies on the curve. Profiles are one for all, or one a point.
    ///
    /// # Errors
    /// A usage error for less than three points, a curve that is not seen whole from the centre, profiles that differ at
    /// the centre, and wrong numbers of them.
    pub fn new(
        centre: [f64; 2],
        z_m: f64,
        points: &[[f64; 2]],
        profiles: Vec<Profile>,
        fall_off: FallOff,
    ) -> Result<Self> {
        let count = points.len();
        if count < 3 {
            return Err(Error::usage(format!("a contour needs at least three points, found {count}")));
        }
        if profiles.len() != 1 && profiles.len() != count {
            return Err(Error::usage(format!(
                "a contour of {count} points needs one profile or {count}, found {}",
                profiles.len()
            )));
        }
        let finite = points.iter().chain([&centre]).flatten().all(|v| v.is_finite()) && z_m.is_finite();
        if !finite {
            return Err(Error::usage("a contour needs finite coordinates"));
        }
        if let Some(i) = profiles.iter().position(|profile| profile.at(0.0).0 != profiles[0].at(0.0).0) {
            return Err(Error::usage(format!(
                "profiles must agree at the centre: profile {i} has {} m there, the first {} m",
                profiles[i].at(0.0).0,
                profiles[0].at(0.0).0
            )));
        }
        let mut around: Vec<[f64; 3]> = points.iter().map(|p| [p[0] - centre[0], p[1] - centre[1], 0.0]).collect();
        let mut profiles = profiles;
        let flat = |p: [f64; 3]| [p[0], p[1]];
        if cross(flat(around[0]), flat(around[1])) < 0.0 {
            around.reverse();
            profiles.reverse();
        }
        let tangent =
            |i: usize| inner_tangent(around[(i + count - 1) % count], around[i % count], around[(i + 1) % count]);
        let mut pieces = vec![];
        for i in 0..count {
            pieces.extend(pair(around[i], tangent(i), around[(i + 1) % count], tangent(i + 1))?);
        }
        let (mut least_m, mut spin, mut area) = (f64::INFINITY, 0.0_f64, Area::EMPTY);
        for (i, piece) in pieces.iter().enumerate() {
            let sweep = piece.least_sweep();
            if !(sweep > 0.0 && cross(piece.at(0.0), piece.at(1.0)) > 0.0) {
                return Err(Error::usage(format!(
                    "the contour is not seen whole from its centre near point {}; move the centre or the point",
                    i / 2
                )));
            }
            let (speed, reach) = (piece.fastest(), piece.farthest());
            least_m = least_m.min(sweep / speed);
            spin = spin.max(reach / sweep);
            area = area.hull(&piece.area);
        }
        // Once around, not twice.
        let turned: f64 = pieces.windows(2).map(|two| f64::from(u8::from(crosses(&two[0], &two[1])))).sum();
        let closing = f64::from(u8::from(crosses(&pieces[pieces.len() - 1], &pieces[0])));
        if turned + closing != 1.0 {
            return Err(Error::usage("the contour winds around its centre more than once"));
        }
        Ok(Self { centre, z_m, pieces, profiles, fall_off, area, least_m, spin })
    }

    /// Piece and parameter on it in a direction of length 1.
    fn towards(&self, e: [f64; 2]) -> (usize, f64) {
        // A sector ends where the next begins, to the bit: there are no gaps.
        let count = self.pieces.len();
        let start = |i: usize| self.pieces[i % count].at(0.0);
        let i = (0..count).find(|&i| cross(start(i), e) >= 0.0 && cross(e, start(i + 1)) > 0.0).unwrap_or(0);
        (i, self.pieces[i].crossing(e))
    }

    /// rho at an offset from the centre.
    fn rho(&self, offset: [f64; 2]) -> f64 {
        let r = dot(offset, offset).sqrt();
        if r == 0.0 {
            return 0.0;
        }
        let e = [offset[0] / r, offset[1] / r];
        let (i, t) = self.towards(e);
        r / dot(self.pieces[i].at(t), e)
    }
}

/// Whether the positive x axis lies in a piece's sector, counted where the next piece begins beyond it.
fn crosses(piece: &Piece, next: &Piece) -> bool {
    piece.at(0.0)[1] < 0.0 && next.at(0.0)[1] >= 0.0
}

impl Primitive for Contour {
    fn support(&self) -> Area {
        let reach = self.fall_off.radius_m();
        let grown =
            |i: Interval, c: f64| Interval { min: c + (i.min * reach).min(0.0), max: c + (i.max * reach).max(0.0) };
        Area { x: grown(self.area.x, self.centre[0]), y: grown(self.area.y, self.centre[1]) }.widened()
    }

    fn bounds(&self, region: &Region) -> Bounds {
        let (centre, radius) = (region.area.centre(), region.area.radius());
        let middle = self.rho([centre[0] - self.centre[0], centre[1] - self.centre[1]]);
        let reach = radius / self.least_m + 1e-9 * (1.0 + middle);
        let rho = Interval { min: (middle - reach).max(0.0), max: middle + reach };
        let squares = Interval { min: rho.min * rho.min, max: rho.max * rho.max };
        let (weight, fall) = self.fall_off.bounds(squares);
        if weight.max <= 0.0 {
            return Bounds::NOTHING;
        }
        let rho = Interval { max: rho.max.min(self.fall_off.radius_m()).max(rho.min), ..rho };
        let mut heights: Option<Interval> = None;
        let (mut steep, mut apart) = (0.0_f64, 0.0_f64);
        let count = self.profiles.len();
        // Differences of profiles grow from 0 at the centre.
        let inward = Interval { min: 0.0, max: rho.max };
        for (i, profile) in self.profiles.iter().enumerate() {
            let (range, slope) = profile.bounds(rho);
            heights = Some(heights.map_or(range, |all| all.hull(range)));
            steep = steep.max(slope);
            if count > 1 {
                let next = self.profiles[(i + 1) % count].bounds(inward).1;
                apart = apart.max(profile.bounds(inward).1 + next);
            }
        }
        // The mix changes by at most 3/4 a piece.
        let slope = steep / self.least_m + 0.75 * apart * self.spin;
        let elevation = heights.unwrap_or(Interval::ZERO).plus(Interval::point(self.z_m));
        Bounds::new(elevation, slope * (1.0 + 1e-9), weight, fall / self.least_m).widened()
    }

    fn at(&self, place: &Place) -> Point {
        let offset = [place.at[0] - self.centre[0], place.at[1] - self.centre[1]];
        let r = dot(offset, offset).sqrt();
        if r == 0.0 {
            let elevation = Sample { value: self.z_m + self.profiles[0].at(0.0).0, dx: 0.0, dy: 0.0 };
            return Point { elevation, weight: Sample { value: self.fall_off.at(0.0).0, dx: 0.0, dy: 0.0 } }.settled();
        }
        let e = [offset[0] / r, offset[1] / r];
        let (i, t) = self.towards(e);
        let (on, velocity) = (self.pieces[i].at(t), self.pieces[i].velocity(t));
        let rho = r / dot(on, e);
        let sweep = cross(on, velocity);
        let out = [velocity[1] / sweep, -velocity[0] / sweep];
        let (share, fall) = self.fall_off.at(rho);
        let weight = Sample { value: share, dx: fall * out[0], dy: fall * out[1] };
        let count = self.profiles.len();
        let (a, b) = (&self.profiles[i / 2 % count], &self.profiles[(i / 2 + 1) % count]);
        let ((low, low_slope), (high, high_slope)) = (a.at(rho), b.at(rho));
        let s = ((i % 2) as f64 + t) / 2.0;
        let (mix, turn) = (s * s * (3.0 - 2.0 * s), 3.0 * s * (1.0 - s));
        let radial = low_slope + mix * (high_slope - low_slope);
        // dt by the angle is |B|² over the sweep.
        let spin = turn * (high - low) * dot(on, on) / (sweep * r);
        let elevation = Sample {
            value: self.z_m + (low + mix * (high - low)),
            dx: radial * out[0] - spin * e[1],
            dy: radial * out[1] + spin * e[0],
        };
        Point { elevation, weight }.settled()
    }

    fn bytes(&self) -> usize {
        let profiles: usize = self.profiles.iter().map(|profile| size_of::<Profile>() + profile.bytes()).sum();
        size_of::<Self>() + size_of_val(&self.pieces[..]) + profiles
    }
}
