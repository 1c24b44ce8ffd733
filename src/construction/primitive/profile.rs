//! Cross-sections: piecewise quadratic functions of one number.

use crate::error::{Error, Result};
use crate::interval::Interval;

/// A function through knots, once continuously differentiable, constant beyond the first and the last.
///
/// Between two knots lie two parabolas that meet in the middle; slopes at knots are the smaller of the two secants'
/// where these have one sign, else 0. So the function never leaves the range of neighbouring knots.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Places, ascending.
    at: Vec<f64>,
    heights_m: Vec<f64>,
    slopes: Vec<f64>,
}

impl Profile {
    /// The profile through knots `(place, height in metres)`.
    ///
    /// # Errors
    /// A usage error for no knots, places that do not ascend, and numbers that are not finite.
    pub fn new(knots: &[(f64, f64)]) -> Result<Self> {
        if knots.is_empty() {
            return Err(Error::usage("a profile without knots; give at least one [place, height]"));
        }
        if !knots.iter().all(|(at, height)| at.is_finite() && height.is_finite()) {
            return Err(Error::usage("a profile's knots must be finite"));
        }
        if let Some(pair) = knots.windows(2).find(|pair| pair[0].0 >= pair[1].0) {
            return Err(Error::usage(format!(
                "a profile's places must ascend, found {} after {}",
                pair[1].0, pair[0].0
            )));
        }
        let secant = |i: usize| (knots[i + 1].1 - knots[i].1) / (knots[i + 1].0 - knots[i].0);
        let last = knots.len() - 1;
        let slope = |i: usize| {
            if i == 0 || i == last {
                return 0.0;
            }
            let (a, b) = (secant(i - 1), secant(i));
            if a * b <= 0.0 {
                0.0
            } else if a.abs() < b.abs() {
                a
            } else {
                b
            }
        };
        Ok(Self {
            at: knots.iter().map(|knot| knot.0).collect(),
            heights_m: knots.iter().map(|knot| knot.1).collect(),
            slopes: (0..=last).map(slope).collect(),
        })
    }

    /// Height at a place, and slope.
    pub fn at(&self, place: f64) -> (f64, f64) {
        let after = self.at.partition_point(|&at| at <= place);
        if after == 0 {
            return (self.heights_m[0], 0.0);
        }
        let i = after - 1;
        if after == self.at.len() {
            return (self.heights_m[i], 0.0);
        }
        let h = self.at[after] - self.at[i];
        let (z0, z1, m0, m1) = (self.heights_m[i], self.heights_m[after], self.slopes[i], self.slopes[after]);
        // Control points of the two parabolas: z0, c0, middle, c1, z1.
        let (c0, c1) = (z0 + m0 * h / 4.0, z1 - m1 * h / 4.0);
        let middle = (c0 + c1) / 2.0;
        let t = 2.0 * (place - self.at[i]) / h;
        let (t, from, control, to) = if t < 1.0 { (t, z0, c0, middle) } else { (t - 1.0, middle, c1, z1) };
        let (a, b) = (from + t * (control - from), control + t * (to - control));
        (a + t * (b - a), 4.0 * (b - a) / h)
    }

    /// Range over places, and greatest slope there.
    pub fn bounds(&self, places: Interval) -> (Interval, f64) {
        let mut range = Interval::point(self.at(places.min).0).hull(Interval::point(self.at(places.max).0));
        let mut slope = 0.0_f64;
        for (i, &at) in self.at.iter().enumerate() {
            if places.holds(at) {
                range = range.hull(Interval::point(self.heights_m[i]));
            }
            let Some(&next) = self.at.get(i + 1) else { continue };
            if next < places.min || at > places.max {
                continue;
            }
            let secant = (self.heights_m[i + 1] - self.heights_m[i]) / (next - at);
            let (m0, m1) = (self.slopes[i], self.slopes[i + 1]);
            // The slope is linear between knots and the middle.
            let middle = 2.0 * secant - (m0 + m1) / 2.0;
            slope = slope.max(m0.abs()).max(m1.abs()).max(middle.abs());
        }
        (range.widened(), slope * (1.0 + 1e-12))
    }

    /// Whether it is the same to both sides of 0.
    pub fn is_even(&self) -> bool {
        let n = self.at.len();
        (0..n).all(|i| self.at[i] == -self.at[n - 1 - i] && self.heights_m[i] == self.heights_m[n - 1 - i])
    }

    /// Bytes of memory beside itself.
    pub fn bytes(&self) -> usize {
        3 * size_of_val(&self.at[..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn profiles_go_through_their_knots_within_bounds(
            knots in proptest::collection::vec((0.1..5.0_f64, -10.0..10.0_f64), 1..6),
            from in -5.0..20.0_f64,
            width in 0.0..10.0_f64,
        ) {
            let mut at = 0.0;
            let knots: Vec<(f64, f64)> = knots.iter().map(|(step, z)| { at += step; (at, *z) }).collect();
            let profile = Profile::new(&knots).expect("sound");
            for (at, z) in &knots {
                prop_assert!((profile.at(*at).0 - z).abs() < 1e-12);
            }
            let (range, slope) = profile.bounds(Interval::new(from, from + width));
            for i in 0..=50 {
                let x = from + width * f64::from(i) / 50.0;
                let (z, m) = profile.at(x.min(from + width));
                prop_assert!(range.holds(z) && m.abs() <= slope + 1e-12, "{z} {m} at {x}, {range:?} {slope}");
                let e = 1e-6;
                let (before, after) = (profile.at(x - e).0, profile.at(x + e).0);
                prop_assert!(((after - before) / (2.0 * e) - m).abs() < 1e-3 * (1.0 + m.abs()));
            }
        }
    }

    #[test]
    fn bad_knots_are_named() {
        let message = |knots: &[(f64, f64)]| Profile::new(knots).expect_err("bad").message().to_string();
        assert!(message(&[]).contains("without knots"));
        assert!(message(&[(1.0, 0.0), (1.0, 2.0)]).contains("ascend"));
        assert!(message(&[(f64::NAN, 0.0)]).contains("finite"));
    }
}
