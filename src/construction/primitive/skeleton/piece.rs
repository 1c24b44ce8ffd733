//! One parabola.

use crate::construction::area::Area;
use crate::error::{Error, Result};
use crate::interval::Interval;

/// `B(t) = p + 2 t b + t² a` in plan, t of `[0, 1]`, and the elevation along it in the same form.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::construction) struct Piece {
    p: [f64; 2],
    b: [f64; 2],
    a: [f64; 2],
    z: [f64; 3],
    /// Length of the curve before it, and its own, in metres.
    pub(in crate::construction) from_m: f64,
    pub(in crate::construction) length_m: f64,
    /// Bound of the angle by which the curve has turned before it, and by which it turns itself, in radians.
    pub(in crate::construction) turned_before: f64,
    pub(in crate::construction) turning: f64,
    /// Greatest curvature per metre, and least speed in metres per unit of t.
    pub(in crate::construction) curvature: f64,
    pub(in crate::construction) slowest: f64,
    /// Whether the curve has a corner where it begins.
    pub(in crate::construction) corner: bool,
    pub(in crate::construction) area: Area,
}

/// The product `x1 y2 - y1 x2`.
#[inline(always)]
pub(in crate::construction) fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The scalar product.
#[inline(always)]
pub(in crate::construction) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

impl Piece {
    /// The parabola with control points `[x, y, z]`.
    ///
    /// # Errors
    /// A usage error where it turns back on itself: there it has no direction.
    pub(super) fn new(p: [f64; 3], c: [f64; 3], q: [f64; 3]) -> Result<Self> {
        let b = [c[0] - p[0], c[1] - p[1]];
        let a = [p[0] - 2.0 * c[0] + q[0], p[1] - 2.0 * c[1] + q[1]];
        // |B'|² = 4 |b + t a|² is least at t = - a.b / a.a.
        let square = dot(a, a);
        let t = if square > 0.0 { (-dot(a, b) / square).clamp(0.0, 1.0) } else { 0.0 };
        let slow = [b[0] + t * a[0], b[1] + t * a[1]];
        let slowest = 2.0 * dot(slow, slow).sqrt();
        let chord = [q[0] - p[0], q[1] - p[1]];
        let moves = slowest > 1e-9 * dot(chord, chord).sqrt().max(dot(b, b).sqrt());
        if !moves {
            return Err(Error::usage("it turns back on itself; leave points out or move them"));
        }
        let area = Area::of(&[[p[0], p[1]], [c[0], c[1]], [q[0], q[1]]]).widened();
        let mut piece = Self {
            p: [p[0], p[1]],
            b,
            a,
            z: [p[2], c[2], q[2]],
            from_m: 0.0,
            length_m: 0.0,
            turned_before: 0.0,
            turning: 0.0,
            curvature: 4.0 * cross(b, a).abs() / (slowest * slowest * slowest),
            slowest,
            corner: false,
            area,
        };
        piece.turning = Self::turn(piece.tangent(0.0), piece.tangent(1.0));
        // Sixteen chords: a measure along the curve, near its length, the same everywhere.
        let mut before = piece.at(0.0);
        for i in 1..=16 {
            let next = piece.at(f64::from(i) / 16.0);
            let way = [next[0] - before[0], next[1] - before[1]];
            piece.length_m += dot(way, way).sqrt();
            before = next;
        }
        Ok(piece)
    }

    /// Bound of the angle between two unit vectors: pi/2 times their distance.
    pub(super) fn turn(s: [f64; 2], t: [f64; 2]) -> f64 {
        let gap = [t[0] - s[0], t[1] - s[1]];
        std::f64::consts::FRAC_PI_2 * dot(gap, gap).sqrt()
    }

    /// The point at t.
    #[inline(always)]
    pub(in crate::construction) fn at(&self, t: f64) -> [f64; 2] {
        let along = |k: usize| self.p[k] + t * (2.0 * self.b[k] + t * self.a[k]);
        [along(0), along(1)]
    }

    /// The derivative at t.
    #[inline(always)]
    pub(in crate::construction) fn velocity(&self, t: f64) -> [f64; 2] {
        [2.0 * (self.b[0] + t * self.a[0]), 2.0 * (self.b[1] + t * self.a[1])]
    }

    /// The second derivative.
    #[inline(always)]
    pub(in crate::construction) fn acceleration(&self) -> [f64; 2] {
        [2.0 * self.a[0], 2.0 * self.a[1]]
    }

    /// The unit tangent at t.
    #[inline(always)]
    pub(in crate::construction) fn tangent(&self, t: f64) -> [f64; 2] {
        let v = self.velocity(t);
        let speed = dot(v, v).sqrt();
        [v[0] / speed, v[1] / speed]
    }

    /// The elevation at t in metres, and its derivative by t.
    #[inline(always)]
    pub(in crate::construction) fn elevation_m(&self, t: f64) -> (f64, f64) {
        let [z0, z1, z2] = self.z;
        let (a, b) = (z0 + t * (z1 - z0), z1 + t * (z2 - z1));
        (a + t * (b - a), 2.0 * (b - a))
    }

    /// Range of the elevation, and bound of its derivative by t.
    pub(in crate::construction) fn elevations_m(&self) -> (Interval, f64) {
        let [z0, z1, z2] = self.z;
        let range = Interval::new(z0, z1).hull(Interval::point(z2));
        (range.widened(), 2.0 * (z1 - z0).abs().max((z2 - z1).abs()))
    }

    /// Least of `B x B'` for a piece around the origin; positive where it runs to the left around it.
    pub(in crate::construction) fn least_sweep(&self) -> f64 {
        // Half of it is p x b + t p x a + t² b x a.
        let (c0, c1, c2) = (cross(self.p, self.b), cross(self.p, self.a), cross(self.b, self.a));
        let value = |t: f64| 2.0 * (c0 + t * (c1 + t * c2));
        let stationary = if c2 > 0.0 { (-c1 / (2.0 * c2)).clamp(0.0, 1.0) } else { 0.0 };
        value(0.0).min(value(1.0)).min(value(stationary))
    }

    /// Greatest speed, in metres per unit of t.
    pub(in crate::construction) fn fastest(&self) -> f64 {
        let speed = |t: f64| dot(self.velocity(t), self.velocity(t)).sqrt();
        speed(0.0).max(speed(1.0))
    }

    /// Bound of the distance from the origin.
    pub(in crate::construction) fn farthest(&self) -> f64 {
        let corner = [self.area.x.size(), self.area.y.size()];
        dot(corner, corner).sqrt()
    }

    /// Parameter where a ray from the origin meets the piece, which runs to the left around it.
    pub(in crate::construction) fn crossing(&self, e: [f64; 2]) -> f64 {
        // B x e falls through 0: k0 + k1 t + k2 t² with e x B rises.
        let (k0, k1, k2) = (cross(e, self.p), 2.0 * cross(e, self.b), cross(e, self.a));
        let root = (k1 * k1 - 4.0 * k2 * k0).max(0.0).sqrt();
        let t = if k1 > 0.0 { -2.0 * k0 / (k1 + root) } else { (root - k1) / (2.0 * k2) };
        // Where rounding leaves 0 / 0.
        if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) }
    }

    /// Whether a point of the piece may be nearer to one of the places than the square of a distance says.
    ///
    /// The piece lies within a quarter of |a| from its chord. Rounding does no harm: it says no only where the piece is
    /// clearly further away, and there what [`Piece::nearest`] finds is no nearer either.
    #[inline(always)]
    pub(in crate::construction) fn may_be_nearer<const N: usize>(
        &self,
        xs: &[f64; N],
        ys: &[f64; N],
        squares: &[f64; N],
    ) -> bool {
        let chord = [2.0 * self.b[0] + self.a[0], 2.0 * self.b[1] + self.a[1]];
        let per = 1.0 / dot(chord, chord).max(f64::MIN_POSITIVE);
        let bulge = dot(self.a, self.a).sqrt() * 0.25;
        let mut near = false;
        for k in 0..N {
            let w = [xs[k] - self.p[0], ys[k] - self.p[1]];
            let t = (dot(w, chord) * per).clamp(0.0, 1.0);
            let (x, y) = (w[0] - t * chord[0], w[1] - t * chord[1]);
            let reach = squares[k].sqrt() + bulge;
            near |= x * x + y * y <= reach * reach * (1.0 + 1e-9);
        }
        near
    }

    /// Parameters of the points nearest to some places, and the squares of their distances.
    ///
    /// Half the derivative of the squared distance is the cubic `b.w + (2 b.b + a.w) t + 3 a.b t² + a.a t³` with
    /// `w = p - place`. Between its stationary points it is monotone, and where it rises through 0 there is a minimum:
    /// at most two, each in its own bracket. All places go through the same steps without branches, so that several are
    /// one vector; what each comes to does not depend on the others.
    #[inline(always)]
    pub(in crate::construction) fn nearest<const N: usize>(
        &self,
        xs: &[f64; N],
        ys: &[f64; N],
    ) -> ([f64; N], [f64; N]) {
        let (a, b) = (self.a, self.b);
        let (c2, c3) = (3.0 * dot(a, b), dot(a, a));
        let (mut wx, mut wy, mut c0, mut c1) = ([0.0; N], [0.0; N], [0.0; N], [0.0; N]);
        let (mut best, mut best_t) = ([0.0; N], [0.0; N]);
        let mut stops = [[0.0; N], [1.0; N], [1.0; N], [1.0; N]];
        for k in 0..N {
            let w = [self.p[0] - xs[k], self.p[1] - ys[k]];
            (wx[k], wy[k]) = (w[0], w[1]);
            (c0[k], c1[k]) = (dot(b, w), 2.0 * dot(b, b) + dot(a, w));
            best[k] = self.square(w, 0.0);
            // Roots of c1 + 2 c2 t + 3 c3 t²; what divisions by 0 give is not inside.
            let root = c2 * c2 - 3.0 * c3 * c1[k];
            let side = root.max(0.0).sqrt();
            let q = -(c2 + if c2 < 0.0 { -side } else { side });
            let (s, t) = (within(q / (3.0 * c3)), within(c1[k] / q));
            let (first, second) = if s < t { (s, t) } else { (t, s) };
            (stops[1][k], stops[2][k]) = if root > 0.0 { (first, second) } else { (1.0, 1.0) };
        }
        for j in 0..3 {
            let (low, high) = (&stops[j], &stops[j + 1]);
            let mut steps = [0.0; N];
            for k in 0..N {
                let value = |t: f64| c0[k] + t * (c1[k] + t * (c2 + t * c3));
                let rises = (low[k] < high[k]) & (value(low[k]) < 0.0) & (value(high[k]) > 0.0);
                steps[k] = if rises { 1.0 } else { 0.0 };
            }
            if steps.iter().all(|&step| step == 0.0) {
                continue;
            }
            let roots = rising_roots(&c0, &c1, (c2, c3), (*low, *high), steps);
            for k in 0..N {
                let square = self.square([wx[k], wy[k]], roots[k]);
                let nearer = (steps[k] > 0.0) & (square < best[k]);
                (best[k], best_t[k]) = if nearer { (square, roots[k]) } else { (best[k], best_t[k]) };
            }
        }
        for k in 0..N {
            let square = self.square([wx[k], wy[k]], 1.0);
            (best[k], best_t[k]) = if square < best[k] { (square, 1.0) } else { (best[k], best_t[k]) };
        }
        (best_t, best)
    }

    /// Square of the distance at t of a place, given the beginning less the place: coordinates may be large.
    #[inline(always)]
    fn square(&self, w: [f64; 2], t: f64) -> f64 {
        let x = w[0] + t * (2.0 * self.b[0] + t * self.a[0]);
        let y = w[1] + t * (2.0 * self.b[1] + t * self.a[1]);
        x * x + y * y
    }
}

/// The parameter, or 1 where it is not between 0 and 1.
#[inline(always)]
fn within(t: f64) -> f64 {
    if (t > 0.0) & (t < 1.0) { t } else { 1.0 }
}

/// Roots of cubics that rise from below 0 at `low` to above at `high`, monotonically: Newton's steps from where a line
/// between both ends is 0, and halving where they leave the bracket. A step of less than 1e-12 is the last, for the next
/// would be its square. Where the first step given is 0 the result is any number.
#[inline(always)]
fn rising_roots<const N: usize>(
    c0: &[f64; N],
    c1: &[f64; N],
    (c2, c3): (f64, f64),
    (mut low, mut high): ([f64; N], [f64; N]),
    mut steps: [f64; N],
) -> [f64; N] {
    let mut roots = [0.0; N];
    for k in 0..N {
        let value = |t: f64| c0[k] + t * (c1[k] + t * (c2 + t * c3));
        let (from, to) = (value(low[k]), value(high[k]));
        roots[k] = low[k] - (high[k] - low[k]) * (from / (to - from));
    }
    for _ in 0..60 {
        for k in 0..N {
            let t = roots[k];
            let value = c0[k] + t * (c1[k] + t * (c2 + t * c3));
            let slope = c1[k] + t * (2.0 * c2 + t * 3.0 * c3);
            (low[k], high[k]) = if value < 0.0 { (t, high[k]) } else { (low[k], t) };
            let newton = t - value / slope;
            let next = if (newton > low[k]) & (newton < high[k]) { newton } else { (low[k] + high[k]) / 2.0 };
            let next = if steps[k] > 1e-12 { next } else { t };
            steps[k] = (next - t).abs();
            roots[k] = next;
        }
        // In a loop of its own: the one above becomes vectors.
        let mut open = false;
        for step in &steps {
            open |= *step > 1e-12;
        }
        if !open {
            break;
        }
    }
    roots
}
