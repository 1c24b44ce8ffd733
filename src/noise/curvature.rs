//! Bound of how fast the slope of gradient noise changes.
//!
//! For a unit vector e the second derivative along it is e . H e = sum g . (2 (e . grad w) e + (e . grad grad w e) d)
//! with the names of the noise itself, so it is at most 1.4135 times the greatest sum of the brackets' lengths over places
//! in the cell and directions. That sum is 9.236 at (0.356, 0.356) along the diagonal, and nowhere above 10.2: a test
//! proves it by branch and bound. H is symmetric, so its norm is its greatest |e . H e|, and across cells the slope is
//! continuous: **|grad eta(p) - grad eta(q)| <= [`CURVATURE`] |p - q|**.

/// Bound of the change of [`super::gradient_noise`]'s gradient, per unit of way.
pub const CURVATURE: f64 = 14.42;

#[cfg(test)]
mod tests {
    use super::super::gradient_noise;
    use super::super::tests::assert_below;
    use super::*;
    use crate::rng::Rng;

    /// The fade with its first and second derivative.
    fn fade(u: f64) -> (f64, f64, f64) {
        let back = 1.0 - u;
        (u * u * u * (u * (u * 6.0 - 15.0) + 10.0), 30.0 * u * u * back * back, 60.0 * u * back * (1.0 - 2.0 * u))
    }

    /// The sum of the brackets' lengths at a place of the cell, e at an angle of so many radians.
    fn corner_sum(u: f64, v: f64, angle: f64) -> f64 {
        let (ey, ex) = angle.sin_cos();
        let ((qu, su, cu), (qv, sv, cv)) = (fade(u), fade(v));
        let mut sum = 0.0;
        for (wu, du, ddu, x) in [(1.0 - qu, -su, -cu, u), (qu, su, cu, u - 1.0)] {
            for (wv, dv, ddv, y) in [(1.0 - qv, -sv, -cv, v), (qv, sv, cv, v - 1.0)] {
                let along = 2.0 * (ex * du * wv + ey * wu * dv);
                let twice = ex * ex * ddu * wv + 2.0 * ex * ey * du * dv + ey * ey * wu * ddv;
                sum += (along * ex + twice * x).hypot(along * ey + twice * y);
            }
        }
        sum
    }

    #[test]
    fn bound_is_proved_by_branch_and_bound() {
        // With q' <= 15/8, |q''| <= 5.78, |q'''| <= 60 and sums over the corners: along u the sum changes by at most
        // 2 hypot(11.56, 14.07) + sqrt(2) 139.7 + 25.7 < 260, where 139.7 and 25.7 bound the eigenvalues of
        // (120, 43.4; 43.4, 43.4) and (11.56, 14.07; 14.07, 11.56). The angle: 4 hypot(3.75, 3.75) + 2 sqrt(2) 25.7 < 95.
        assert_below(10.2, (260.0, 95.0), corner_sum);
        const { assert!(1.4135 * 10.2 <= CURVATURE) };
    }

    #[test]
    fn slopes_change_no_faster_and_nearly_as_fast() {
        let mut rng = Rng::new(5);
        let mut fastest = 0.0_f64;
        for _ in 0..400_000 {
            let (seed, x, y, step) = (rng.next_u32(), rng.between(-1e3, 1e3), rng.between(-1e3, 1e3), 1e-4);
            let (dx, dy) = (rng.between(-step, step), rng.between(-step, step));
            let (a, b) = (gradient_noise::<true>(seed, x, y), gradient_noise::<true>(seed, x + dx, y + dy));
            fastest = fastest.max((a.dx - b.dx).hypot(a.dy - b.dy) / dx.hypot(dy).max(1e-6));
        }
        assert!(fastest < CURVATURE && fastest > 0.6 * CURVATURE, "{fastest}");
    }
}
