//! Gradient noise: a lattice of random gradients, joined by a fade.
//!
//! At each point k of the integer lattice stands a plane through 0 with a random gradient g; between the four corners
//! of a cell the planes are mixed by the products of quintic fades q(u) = 6u^5 - 15u^4 + 10u^3 (Perlin, "Improving
//! noise", SIGGRAPH 2002, doi:10.1145/566570.566636), which makes the noise twice continuously differentiable:
//!
//! eta(p) = sum over the corners of w g . d,   d = p - k,   w = (q(u) or 1 - q(u)) (q(v) or 1 - q(v)).
//!
//! # How it is computed
//! Along a lattice row v is the same, so column k of the lattice, with the gradients (nx, ny) below and (fx, fy) above,
//! is a line in u: g u + s, g = nx + q(v) (fx - nx), s = ny v + q(v) (fy (v - 1) - ny v). Between column 0, from which
//! u counts, and column 1 the noise is A + q(u) M with A = g0 u + s0 and M = (g1 - g0) u + ((s1 - g1) - s0). Whoever
//! evaluates many points shares lines between rows of a cell, and cells between points; the steps and their order are
//! the same for all ([`Fade`], [`Line`], [`Cell`]), so results are the same to the bit.
//!
//! # Gradients
//! For t of `[-1, 1)` from the hash, and s = t², g = 1.4 (± (1 - s)(1 - 15/64 s), t (25/16 - 9/16 s)): nearly a circle,
//! nearly evenly, without tables or roots. |g|² / 1.4² is a polynomial in s that stays below 1.0193 (a test proves it),
//! so |g| < 1.4135.
//!
//! # Bound of the value
//! |eta| <= sum w |g| |d| <= 1.4135 sqrt(sum w |d|²), for the w sum to 1. Now sum w |d|² = h(u) + h(v) with
//! h(u) = (1 - q) u² + q (1 - u)², and with x = u - 1/2, h = 1/4 - x² (11/4 - 10 x² + 12 x^4) where the bracket is
//! positive for x² <= 1/4: h <= 1/4. So **|eta| <= 1.4135 sqrt(1/2) < 1**.
//!
//! # Bound of the slope
//! For a unit vector e, e . grad eta = sum g . (w e + (e . grad w) d), so the slope is at most 1.4135 times the
//! greatest sum of |w e + (e . grad w) d| over places in the cell and directions. That sum is 2.0691 at the cell's
//! centre along an axis, and nowhere above 2.09: the tests prove it by branch and bound, with the Lipschitz constants
//! of the sum in u, v and the angle. So **|grad eta| <= 1.4135 x 2.09 < [`SLOPE`]**.

use super::Sample;
use crate::rng::{cell_hash, row_hash};

/// Bound of the slope of [`gradient_noise`], lambda_eta of the papers.
pub const SLOPE: f64 = 2.955;

/// Adding it to a whole number below 2^51 in size leaves that number, modulo 2^32, in the low bits: 1.5 times 2^52.
const ALIGN: f64 = 6_755_399_441_055_744.0;

/// A coordinate within its cell.
#[derive(Clone, Copy, Default)]
pub(super) struct Fade {
    /// u: the part beyond the cell's beginning, of `[0, 1)`.
    pub(super) part: f64,
    /// q(u).
    pub(super) share: f64,
    /// q'(u).
    pub(super) slope: f64,
}

/// A lattice column at some height in its cell: `g u + s`, with the derivatives of g and s by v.
#[derive(Clone, Copy, Default)]
pub(super) struct Line {
    pub(super) g: f64,
    pub(super) s: f64,
    pub(super) g_slope: f64,
    pub(super) s_slope: f64,
}

/// A cell between two columns at some height: `A = line.g u + line.s`, `M = m1 u + m0`, and M's derivatives by v.
#[derive(Clone, Copy, Default)]
pub(super) struct Cell {
    pub(super) line: Line,
    pub(super) m1: f64,
    pub(super) m0: f64,
    pub(super) m1_slope: f64,
    pub(super) m0_slope: f64,
}

impl Fade {
    #[inline(always)]
    pub(super) fn of(part: f64) -> Self {
        let square = part * part;
        let back = 1.0 - part;
        let share = square * part * (part * (part * 6.0 - 15.0) + 10.0);
        Self { part, share, slope: 30.0 * square * (back * back) }
    }
}

impl Line {
    /// The line between the gradients below and above.
    #[inline(always)]
    pub(super) fn between(near: (f64, f64), far: (f64, f64), v: &Fade) -> Self {
        let turn = far.0 - near.0;
        let (below, above) = (near.1 * v.part, far.1 * (v.part - 1.0));
        let rise = above - below;
        Self {
            g: near.0 + v.share * turn,
            s: below + v.share * rise,
            g_slope: v.slope * turn,
            s_slope: (near.1 + v.share * (far.1 - near.1)) + v.slope * rise,
        }
    }
}

impl Cell {
    #[inline(always)]
    pub(super) fn between(left: Line, right: Line) -> Self {
        Self {
            line: left,
            m1: right.g - left.g,
            m0: (right.s - right.g) - left.s,
            m1_slope: right.g_slope - left.g_slope,
            m0_slope: (right.s_slope - right.g_slope) - left.s_slope,
        }
    }

    /// The noise in the cell; without `GRADIENT` the derivatives are 0.
    #[inline(always)]
    pub(super) fn at<const GRADIENT: bool>(&self, u: &Fade) -> Sample {
        let m = self.m1 * u.part + self.m0;
        let value = (self.line.g * u.part + self.line.s) + u.share * m;
        if !GRADIENT {
            return Sample { value, dx: 0.0, dy: 0.0 };
        }
        let slope = self.m1_slope * u.part + self.m0_slope;
        Sample {
            value,
            dx: (self.line.g + u.share * self.m1) + u.slope * m,
            dy: (self.line.g_slope * u.part + self.line.s_slope) + u.share * slope,
        }
    }
}

/// The gradient of a lattice point.
#[inline(always)]
pub(super) fn direction(hash: u32) -> (f64, f64) {
    let t = f64::from(hash as i32) * (1.0 / 2_147_483_648.0);
    let s = t * t;
    let x = (1.0 - s) * (1.4 - 0.328125 * s);
    let y = t * (2.1875 - 0.7875 * s);
    // The lowest bit moves t by nothing that matters; it serves as the sign.
    (f64::from_bits(x.to_bits() ^ (u64::from(hash) << 63)), y)
}

/// The part of a coordinate in its cell, and the cell's index modulo 2^32.
#[inline(always)]
pub(super) fn split(x: f64) -> (f64, u32) {
    let whole = x.floor();
    (x - whole, (whole + ALIGN).to_bits() as u32)
}

/// Gradient noise of a seed at `(x, y)`, in `[-1, 1]`, with its gradient; 0 at whole numbers.
///
/// Coordinates are finite and below 2^51 in size; the lattice repeats after 2^32 cells. The derivatives are 0 without
/// `GRADIENT`, the value is the same to the bit.
#[inline(always)]
pub fn gradient_noise<const GRADIENT: bool>(seed: u32, x: f64, y: f64) -> Sample {
    let ((u, column), (v, row)) = (split(x), split(y));
    let (near, far) = (row_hash(seed, row), row_hash(seed, row.wrapping_add(1)));
    let v = Fade::of(v);
    let next = column.wrapping_add(1);
    let left = Line::between(direction(cell_hash(near, column)), direction(cell_hash(far, column)), &v);
    let right = Line::between(direction(cell_hash(near, next)), direction(cell_hash(far, next)), &v);
    Cell::between(left, right).at::<GRADIENT>(&Fade::of(u))
}

#[cfg(test)]
mod tests {
    use super::super::tests::assert_below;
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn values_stay_as_they_are() {
        let found = gradient_noise::<true>(7, 3.25, -2.5);
        assert_eq!(
            found,
            Sample { value: -0.546_776_939_292_901_9, dx: 0.844_931_471_747_022_7, dy: -0.467_962_865_119_397_7 }
        );
    }

    #[test]
    fn gradients_are_nearly_of_one_length() {
        // |g|² / 1.4² as a polynomial in s, in Bernstein's form on 32 parts of [0, 1]: no coefficient, hence no
        // value, exceeds 1.0193.
        let (k, p, q) = (15.0 / 64.0, 25.0 / 16.0, 9.0 / 16.0);
        let coefficients =
            [1.0, -2.0 - 2.0 * k + p * p, 1.0 + 4.0 * k + k * k - 2.0 * p * q, -2.0 * k - 2.0 * k * k + q * q, k * k];
        let power = |base: f64, n: usize| (0..n).fold(1.0, |product, _| product * base);
        let choose = |n: usize, m: usize| (0..m).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64);
        for part in 0..32 {
            let (from, width) = (f64::from(part) / 32.0, 1.0 / 32.0);
            // The polynomial in z, s = from + width z.
            let local: Vec<f64> = (0..5)
                .map(|m| {
                    (m..5).map(|n| coefficients[n] * choose(n, m) * power(from, n - m)).sum::<f64>() * power(width, m)
                })
                .collect();
            for i in 0..5 {
                let bernstein: f64 = (0..=i).map(|m| choose(i, m) / choose(4, m) * local[m]).sum();
                assert!(bernstein < 1.0193, "part {part}, coefficient {i}: {bernstein}");
            }
        }
        let mut rng = Rng::new(1);
        for _ in 0..10_000 {
            let (x, y) = direction(rng.next_u32());
            let length = (x * x + y * y).sqrt();
            assert!(length < 1.4135 && length > 1.398, "{x} {y}");
        }
        assert!(1.4135 * 0.5_f64.sqrt() < 1.0);
        const { assert!(1.4135 * 2.09 <= SLOPE) };
    }

    /// The sum over the corners of |w e + (e . grad w) d| at a place of the cell, e at an angle of so many radians.
    fn corner_sum(u: f64, v: f64, angle: f64) -> f64 {
        let (ey, ex) = angle.sin_cos();
        let (fu, fv) = (Fade::of(u), Fade::of(v));
        let ((qu, su), (qv, sv)) = ((fu.share, fu.slope), (fv.share, fv.slope));
        let mut sum = 0.0;
        for (wu, du, x) in [(1.0 - qu, -su, u), (qu, su, u - 1.0)] {
            for (wv, dv, y) in [(1.0 - qv, -sv, v), (qv, sv, v - 1.0)] {
                let along = ex * du * wv + ey * wu * dv;
                sum += (wu * wv * ex + along * x).hypot(wu * wv * ey + along * y);
            }
        }
        sum
    }

    #[test]
    fn slope_bound_is_proved_by_branch_and_bound() {
        // |d corner_sum / du| <= sum |dw/du| + |d| sum |e . grad dw/du| + sum |e . grad w|, where |d| <= sqrt 2,
        // q' <= 15/8 and |q''| <= 5.78: 3.75 + sqrt(2) hypot(11.56, 14.07) + 5.31 < 35. The angle: 1 + 5.31 sqrt 2.
        assert_below(2.09, (35.0, 8.6), corner_sum);
    }

    #[test]
    fn values_and_slopes_keep_their_bounds_and_come_near() {
        let mut rng = Rng::new(2);
        let (mut greatest, mut steepest, mut square) = (0.0_f64, 0.0_f64, 0.0);
        let count = 400_000;
        for _ in 0..count {
            let n = gradient_noise::<true>(rng.next_u32(), rng.between(-1e6, 1e6), rng.between(-1e6, 1e6));
            greatest = greatest.max(n.value.abs());
            steepest = steepest.max((n.dx * n.dx + n.dy * n.dy).sqrt());
            square += n.value * n.value / f64::from(count);
        }
        assert!(greatest <= 1.0 && steepest <= SLOPE, "{greatest} {steepest}");
        // Far below, the bounds would be of no use.
        assert!(greatest > 0.85 && steepest > 0.85 * SLOPE, "{greatest} {steepest}");
        assert!((square.sqrt() - 0.35).abs() < 0.05, "{}", square.sqrt());
    }

    #[test]
    fn gradient_agrees_with_differences_and_is_continuous_across_cells() {
        let mut rng = Rng::new(3);
        for i in 0..2000 {
            let seed = rng.next_u32();
            let mut x = rng.between(-50.0, 50.0);
            let y = rng.between(-50.0, 50.0);
            if i % 4 == 0 {
                x = x.round();
            }
            let e = 1e-5;
            let at = |x, y| gradient_noise::<false>(seed, x, y).value;
            let n = gradient_noise::<true>(seed, x, y);
            assert_eq!(n.value, at(x, y));
            let (dx, dy) = ((at(x + e, y) - at(x - e, y)) / (2.0 * e), (at(x, y + e) - at(x, y - e)) / (2.0 * e));
            assert!((n.dx - dx).abs() < 1e-7 && (n.dy - dy).abs() < 1e-7, "{x} {y}: {n:?}, {dx} {dy}");
        }
    }

    #[test]
    fn noise_is_the_same_in_all_directions() {
        // Mean squared derivatives along x, along y and along both diagonals.
        let mut rng = Rng::new(4);
        let mut power = [0.0; 4];
        for _ in 0..200_000 {
            let n = gradient_noise::<true>(rng.next_u32(), rng.between(0.0, 100.0), rng.between(0.0, 100.0));
            let diagonal = [n.dx + n.dy, n.dx - n.dy].map(|d| d * d / 2.0);
            for (sum, d) in power.iter_mut().zip([n.dx * n.dx, n.dy * n.dy, diagonal[0], diagonal[1]]) {
                *sum += d;
            }
        }
        let mean = power.iter().sum::<f64>() / 4.0;
        assert!(power.iter().all(|p| (p / mean - 1.0).abs() < 0.02), "{power:?}");
    }
}
