//! From the plane to the unit square of an image.

use super::super::skeleton::{Skeleton, cross, dot};
use crate::construction::area::Area;
use crate::construction::operator::warp::{Matrix, inverse};
use crate::error::{Error, Result};
use crate::interval::Interval;

/// Where an image lies. Its coordinates are u along its rows and v along its columns, both from 0 to 1, with the first
/// sample at (0, 0).
#[derive(Clone, Debug)]
pub struct Mapping(Kind);

#[derive(Clone, Debug)]
enum Kind {
    /// Row 0 lies along the greatest y.
    Box(Area),
    /// `p = a + u e + v f + u v g`.
    Quadrangle { a: [f64; 2], e: [f64; 2], f: [f64; 2], g: [f64; 2], turn: f64, area: Area, stretch: f64 },
    /// u along the curve, v from left to right of it.
    Along { skeleton: Skeleton, half_width_m: f64 },
}

/// What a region shows of an image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// Ranges of u and v; `None` for nothing.
    pub(super) uv: Option<(Interval, Interval)>,
    /// Bound of the norm of the Jacobian of `(u, v)`, per metre.
    pub(super) stretch: f64,
    /// Whether the image may end in the region.
    pub(super) has_edge: bool,
}

const UNIT: Interval = Interval { min: 0.0, max: 1.0 };

impl Mapping {
    /// A box: its corners are the centres of the corner samples, rows run east, the first in the north.
    ///
    /// # Errors
    /// A usage error for a box without area.
    pub fn on_box(area: Area) -> Result<Self> {
        let (w, h) = (area.x.width(), area.y.width());
        if !(w > 0.0 && h > 0.0 && (1.0 / w).is_finite() && (1.0 / h).is_finite() && w.is_finite() && h.is_finite()) {
            return Err(Error::usage(format!("an image needs a box with an area, found {w} m by {h} m")));
        }
        Ok(Self(Kind::Box(area)))
    }

    /// A convex quadrangle: where the first sample of the first row comes to lie, the last of the first row, the last
    /// of the last row and the first of the last row. Inverse bilinear: `p = a + u e + v f + u v g`.
    ///
    /// # Errors
    /// A usage error for quadrangles that are not strictly convex.
    pub fn on_quadrangle(corners: [[f64; 2]; 4]) -> Result<Self> {
        let minus = |p: [f64; 2], q: [f64; 2]| [p[0] - q[0], p[1] - q[1]];
        let turns: Vec<f64> = (0..4)
            .map(|i| {
                let (p, q, r) = (corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]);
                cross(minus(q, p), minus(r, q))
            })
            .collect();
        let size = corners.iter().fold(0.0_f64, |size, &p| size.max(dot(minus(p, corners[0]), minus(p, corners[0]))));
        let turn = if turns[0] > 0.0 { 1.0 } else { -1.0 };
        if !turns.iter().all(|t| t * turn > 1e-9 * size) || !size.is_finite() {
            return Err(Error::usage(format!(
                "the quadrangle {corners:?} is not convex; give its corners in order, first row first"
            )));
        }
        let [a, b, c, d] = corners;
        let (e, f) = (minus(b, a), minus(d, a));
        let g = minus(minus(c, b), f);
        // The determinant is linear in u and v: least at a corner. |J| is at most that of the longest sides.
        let least = turns.iter().fold(f64::INFINITY, |least, t| least.min(t.abs()));
        let long = |p: [f64; 2], q: [f64; 2]| dot(p, p).max(dot(q, q));
        let norm = (long(e, minus(c, d)) + long(f, minus(c, b))).sqrt();
        Ok(Self(Kind::Quadrangle { a, e, f, g, turn, area: Area::of(&corners), stretch: norm / least * (1.0 + 1e-9) }))
    }

    /// Along a curve: rows run with it, the first on its left at `half_width_m`, the last as far on its right.
    ///
    /// # Errors
    /// A usage error unless the width is positive.
    pub fn along(skeleton: Skeleton, half_width_m: f64) -> Result<Self> {
        if !(half_width_m > 0.0 && half_width_m.is_finite()) {
            return Err(Error::usage(format!(
                "an image along a curve needs a positive width, found {half_width_m} m to each side"
            )));
        }
        Ok(Self(Kind::Along { skeleton, half_width_m }))
    }

    /// A box around the image.
    pub(super) fn area(&self) -> Area {
        match &self.0 {
            Kind::Box(area) | Kind::Quadrangle { area, .. } => *area,
            Kind::Along { skeleton, half_width_m } => skeleton.area().grown(*half_width_m),
        }
    }

    /// u and v at a point with the Jacobian of both, or `None` beside the image.
    #[inline(always)]
    pub(super) fn enter(&self, at: [f64; 2]) -> Option<([f64; 2], Matrix)> {
        match &self.0 {
            Kind::Box(area) => {
                let (w, h) = (area.x.width(), area.y.width());
                // Samples on the edge are there however their coordinates were rounded; whoever enters clamps.
                area.widened()
                    .holds(at)
                    .then(|| ([(at[0] - area.x.min) / w, (area.y.max - at[1]) / h], [[1.0 / w, 0.0], [0.0, -1.0 / h]]))
            }
            Kind::Quadrangle { a, e, f, g, turn, .. } => {
                let h = [at[0] - a[0], at[1] - a[1]];
                // k2 v² + k1 v + k0 = 0, whose derivative at the solution is the determinant of the Jacobian.
                let (k2, k1, k0) = (cross(*g, *f), cross(*e, *f) + cross(h, *g), -cross(*e, h));
                let square = k1 * k1 - 4.0 * k2 * k0;
                if square < 0.0 {
                    return None;
                }
                let root = turn * square.sqrt();
                let v = if turn * k1 > 0.0 { -2.0 * k0 / (k1 + root) } else { (root - k1) / (2.0 * k2) };
                let along = [e[0] + v * g[0], e[1] + v * g[1]];
                let rest = [h[0] - v * f[0], h[1] - v * f[1]];
                let u = dot(rest, along) / dot(along, along);
                let across = [f[0] + u * g[0], f[1] + u * g[1]];
                let inside = (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v);
                inside.then(|| ([u, v], inverse(&[[along[0], across[0]], [along[1], across[1]]])))
            }
            Kind::Along { skeleton, half_width_m } => beside(skeleton, *half_width_m, at),
        }
    }

    /// What a box shows.
    pub(super) fn seen(&self, area: &Area) -> Seen {
        match &self.0 {
            Kind::Box(own) => {
                let (w, h) = (own.x.width(), own.y.width());
                let part = area.meet(&own.widened());
                if part.is_empty() {
                    return Seen { uv: None, stretch: 0.0, has_edge: true };
                }
                let u = Interval { min: (part.x.min - own.x.min) / w, max: (part.x.max - own.x.min) / w };
                let v = Interval { min: (own.y.max - part.y.max) / h, max: (own.y.max - part.y.min) / h };
                let has_edge = area.x.min <= own.x.min
                    || area.x.max >= own.x.max
                    || area.y.min <= own.y.min
                    || area.y.max >= own.y.max;
                let stretch = (1.0 / w).max(1.0 / h);
                Seen { uv: Some((u.widened().clamped(0.0, 1.0), v.widened().clamped(0.0, 1.0))), stretch, has_edge }
            }
            Kind::Quadrangle { stretch, .. } => {
                let corners = area.corners().map(|corner| self.enter(corner));
                let inside = corners.iter().all(Option::is_some);
                let (mut u, mut v) = (UNIT, UNIT);
                if inside {
                    // Lines of equal u, and of equal v, are straight: corners have the extremes.
                    let range = |k: usize| {
                        let values = corners.iter().flatten().map(|(uv, _)| uv[k]);
                        let (min, max) = values.fold((1.0_f64, 0.0_f64), |(min, max), v| (min.min(v), max.max(v)));
                        Interval { min: min - 1e-9, max: max + 1e-9 }.clamped(0.0, 1.0)
                    };
                    (u, v) = (range(0), range(1));
                }
                let touches = |i: Interval| i.min <= 0.0 || i.max >= 1.0;
                Seen { uv: Some((u, v)), stretch: *stretch, has_edge: !inside || touches(u) || touches(v) }
            }
            Kind::Along { skeleton, half_width_m } => along_seen(skeleton, *half_width_m, area),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        match &self.0 {
            Kind::Along { skeleton, .. } => skeleton.bytes(),
            _ => 0,
        }
    }
}

/// u and v beside a curve.
fn beside(skeleton: &Skeleton, half_width_m: f64, at: [f64; 2]) -> Option<([f64; 2], Matrix)> {
    let mut near = vec![];
    skeleton.near(&Area::of(&[at]), half_width_m, &mut near);
    let hit = skeleton.nearest(&near, at, half_width_m)?;
    let piece = skeleton.piece(hit.piece);
    let foot = piece.at(hit.t);
    let offset = [at[0] - foot[0], at[1] - foot[1]];
    let tangent = piece.tangent(hit.t);
    // Beyond the ends there is no image.
    if hit.is_end && dot(offset, tangent).abs() > 1e-9 * half_width_m {
        return None;
    }
    let d = cross(tangent, offset);
    let u = (piece.from_m + hit.t * piece.length_m) / skeleton.length_m();
    let v = (0.5 - d / (2.0 * half_width_m)).clamp(0.0, 1.0);
    let velocity = piece.velocity(hit.t);
    let speed = dot(velocity, velocity);
    let bend = speed - dot(offset, piece.acceleration());
    let per = if bend > 1e-9 * speed && !hit.is_fixed { piece.length_m / (skeleton.length_m() * bend) } else { 0.0 };
    let across = -1.0 / (2.0 * half_width_m);
    Some((
        [u.clamp(0.0, 1.0), v],
        [[velocity[0] * per, velocity[1] * per], [-tangent[1] * across, tangent[0] * across]],
    ))
}

/// What a box shows of an image along a curve; bounded within the reach of the curve only.
fn along_seen(skeleton: &Skeleton, half_width_m: f64, area: &Area) -> Seen {
    let mut near = vec![];
    skeleton.near(area, half_width_m, &mut near);
    let (Some(&first), Some(&last)) = (near.first(), near.last()) else {
        return Seen { uv: None, stretch: 0.0, has_edge: true };
    };
    let pieces = skeleton.pieces();
    let (from, to) = (&pieces[first as usize], &pieces[last as usize]);
    let whole = skeleton.length_m();
    let u = Interval { min: from.from_m / whole, max: (to.from_m + to.length_m) / whole }.widened().clamped(0.0, 1.0);
    let mut stretch = 0.0_f64;
    let mut bounded = to.turned_before + to.turning - from.turned_before < std::f64::consts::FRAC_PI_2;
    for &i in &near {
        let piece = &pieces[i as usize];
        let bend = 1.0 - piece.curvature * half_width_m;
        bounded &= bend > 1e-6 && !(i > first && piece.corner);
        stretch = stretch.max(piece.length_m / (whole * piece.slowest * bend.max(1e-6)));
    }
    // The rows of the Jacobian are perpendicular.
    let stretch = if bounded { stretch.max(0.5 / half_width_m) } else { f64::INFINITY };
    Seen { uv: Some((u, UNIT)), stretch, has_edge: true }
}
