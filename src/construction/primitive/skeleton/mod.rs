//! Skeletons: curves in plan with an elevation along them, and the nearest point on them.

mod piece;

pub(super) use piece::{Piece, cross, dot};

use super::super::area::Area;
use super::super::operator::boxes::Boxes;
use crate::error::{Error, Result};

/// A chain of parabolas.
///
/// [`Skeleton::through`] joins points by two parabolas an interval, with the tangents of Catmull and Rom: once
/// continuously differentiable, through every point. It stands for the cubic spline with the same tangents, and its
/// nearest point is exact: the roots of a cubic polynomial, bracketed, not a search along samples.
#[derive(Clone, Debug)]
pub struct Skeleton {
    pieces: Vec<Piece>,
    boxes: Boxes,
    length_m: f64,
}

/// The nearest point on a skeleton.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    /// Index of the piece.
    pub(super) piece: usize,
    /// Parameter on it, in `[0, 1]`.
    pub(super) t: f64,
    /// Distance in metres.
    pub(super) distance_m: f64,
    /// Whether it is the beginning or the end of the whole curve, passed by: not the foot of a perpendicular.
    pub(super) is_end: bool,
    /// Whether it is a corner or an end: the nearest point stays while the place moves.
    pub(super) is_fixed: bool,
}

/// The nearest points to several places.
pub(super) struct Nearest<const N: usize> {
    /// Indices of pieces, or [`NONE`].
    piece: [u32; N],
    t: [f64; N],
    square: [f64; N],
}

/// No piece.
const NONE: u32 = u32::MAX;

impl Skeleton {
    /// The curve through points `[x, y, z]` in metres; `smooth`, or straight from point to point.
    ///
    /// # Errors
    /// A usage error for less than two points, points that repeat, and numbers that are not finite.
    pub fn through(points: &[[f64; 3]], smooth: bool) -> Result<Self> {
        if points.len() < 2 {
            return Err(Error::usage(format!("a curve needs at least two points, found {}", points.len())));
        }
        if let Some(i) = points.iter().position(|p| !p.iter().all(|v| v.is_finite())) {
            return Err(Error::usage(format!("point {i} of the curve is not finite")));
        }
        if let Some(i) = (1..points.len()).find(|&i| points[i][..2] == points[i - 1][..2]) {
            return Err(Error::usage(format!("points {} and {i} of the curve are the same", i - 1)));
        }
        let mut pieces = vec![];
        for i in 0..points.len() - 1 {
            let (p, q) = (points[i], points[i + 1]);
            if !smooth {
                pieces.push(Piece::new(p, half(p, q), q)?);
                continue;
            }
            pieces.extend(pair(p, tangent(points, i), q, tangent(points, i + 1)).map_err(|e| at_point(&e, i))?);
        }
        let mut length_m = 0.0;
        let mut turning = 0.0;
        for i in 0..pieces.len() {
            if i > 0 {
                // Smooth joints turn by nothing but rounding.
                let corner = Piece::turn(pieces[i - 1].tangent(1.0), pieces[i].tangent(0.0));
                pieces[i].corner = corner > 1e-6;
                turning += corner;
            }
            pieces[i].from_m = length_m;
            pieces[i].turned_before = turning;
            length_m += pieces[i].length_m;
            turning += pieces[i].turning;
        }
        let boxes = Boxes::new(pieces.iter().map(|piece| piece.area).collect());
        Ok(Self { pieces, boxes, length_m })
    }

    /// Length in metres, as the parameter of profiles along the curve counts it.
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    pub(super) fn piece(&self, i: usize) -> &Piece {
        &self.pieces[i]
    }

    pub(super) fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// A box around the curve.
    pub(super) fn area(&self) -> Area {
        self.pieces.iter().fold(Area::EMPTY, |all, piece| all.hull(&piece.area))
    }

    /// Indices of the pieces that may lie within `radius_m` of the box, ascending.
    pub(super) fn near(&self, area: &Area, radius_m: f64, found: &mut Vec<u32>) {
        self.boxes.meeting(&area.grown(radius_m).widened(), found);
    }

    /// The nearest point of the given pieces that is nearer than `within_m`; the first of several.
    pub(super) fn nearest(&self, pieces: &[u32], p: [f64; 2], within_m: f64) -> Option<Hit> {
        let found = self.nearest_of(pieces, &[p[0]], &[p[1]], within_m);
        self.hit(&found, 0)
    }

    /// The same for several places at once; [`Skeleton::hit`] reads the result.
    #[inline(always)]
    pub(super) fn nearest_of<const N: usize>(
        &self,
        pieces: &[u32],
        xs: &[f64; N],
        ys: &[f64; N],
        within_m: f64,
    ) -> Nearest<N> {
        let mut found = Nearest { piece: [NONE; N], t: [0.0; N], square: [within_m * within_m; N] };
        for &i in pieces {
            let piece = &self.pieces[i as usize];
            if !piece.may_be_nearer(xs, ys, &found.square) {
                continue;
            }
            let (t, square) = piece.nearest(xs, ys);
            for k in 0..N {
                let nearer = square[k] < found.square[k];
                found.piece[k] = if nearer { i } else { found.piece[k] };
                found.t[k] = if nearer { t[k] } else { found.t[k] };
                found.square[k] = if nearer { square[k] } else { found.square[k] };
            }
        }
        found
    }

    /// One of several results.
    pub(super) fn hit<const N: usize>(&self, found: &Nearest<N>, k: usize) -> Option<Hit> {
        if found.piece[k] == NONE {
            return None;
        }
        let (piece, t, best) = (found.piece[k] as usize, found.t[k], found.square[k]);
        let last = self.pieces.len() - 1;
        let is_end = (piece == 0 && t == 0.0) || (piece == last && t == 1.0);
        let corner = (t == 0.0 && self.pieces[piece].corner)
            || (t == 1.0 && self.pieces.get(piece + 1).is_some_and(|next| next.corner));
        Some(Hit { piece, t, distance_m: best.sqrt(), is_end, is_fixed: is_end || corner })
    }

    /// Distance in metres from `p` to the curve, if less than `within_m`.
    pub fn distance_m(&self, p: [f64; 2], within_m: f64) -> Option<f64> {
        let mut pieces = vec![];
        self.near(&Area::of(&[p]), within_m, &mut pieces);
        self.nearest(&pieces, p, within_m).map(|hit| hit.distance_m)
    }

    /// Bytes of memory beside itself.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.pieces[..]) + self.boxes.bytes()
    }
}

/// The two parabolas from one point with its tangent to another.
///
/// # Errors
/// A usage error where they turn back on themselves.
pub(super) fn pair(p: [f64; 3], m: [f64; 3], q: [f64; 3], n: [f64; 3]) -> Result<[Piece; 2]> {
    let c = std::array::from_fn(|k| p[k] + m[k] / 4.0);
    let d = std::array::from_fn(|k| q[k] - n[k] / 4.0);
    let middle = half(c, d);
    Ok([Piece::new(p, c, middle)?, Piece::new(middle, d, q)?])
}

fn at_point(error: &Error, i: usize) -> Error {
    Error::usage(format!("between points {i} and {} of the curve: {}", i + 1, error.message()))
}

fn half(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| (p[k] + q[k]) / 2.0)
}

/// Tangent at a point of an open chain.
fn tangent(points: &[[f64; 3]], i: usize) -> [f64; 3] {
    let (before, after) = (points[i.saturating_sub(1)], points[(i + 1).min(points.len() - 1)]);
    if i == 0 || i + 1 == points.len() {
        return std::array::from_fn(|k| after[k] - before[k]);
    }
    inner_tangent(before, points[i], after)
}

/// Tangent of Catmull and Rom at the middle one of three points, shortened to the nearer neighbour: long ones would
/// make loops.
pub(super) fn inner_tangent(before: [f64; 3], at: [f64; 3], after: [f64; 3]) -> [f64; 3] {
    let length = |p: [f64; 3], q: [f64; 3]| {
        let (x, y) = (q[0] - p[0], q[1] - p[1]);
        (x * x + y * y).sqrt()
    };
    let (a, b, whole) = (length(before, at), length(at, after), length(before, after));
    // A curve that turns back on itself has no direction.
    let scale = if whole > 0.0 { (2.0 * a.min(b) / whole).min(1.0) } else { 0.0 };
    std::array::from_fn(|k| (after[k] - before[k]) * scale / 2.0)
}
