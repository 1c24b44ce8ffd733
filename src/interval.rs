//! Intervals: all values that something may take.
//!
//! Ends are not rounded outwards at each step: a bound holds up to rounding, and whoever compares it with values that
//! were themselves rounded takes [`Interval::widened`]. Ends may be infinite; 0 times infinity is 0 here, because a
//! factor that is 0 removes a part whatever it is.

/// The numbers from `min` to `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub min: f64,
    /// The upper end, at least `min`.
    pub max: f64,
}

/// The product of two bounds, where nothing times anything is nothing.
#[inline]
pub fn product(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

impl Interval {
    /// The single number 0.
    pub const ZERO: Self = Self { min: 0.0, max: 0.0 };
    /// The single number 1.
    pub const ONE: Self = Self { min: 1.0, max: 1.0 };
    /// All numbers.
    pub const ALL: Self = Self { min: f64::NEG_INFINITY, max: f64::INFINITY };

    /// The interval between two numbers in any order.
    pub fn new(a: f64, b: f64) -> Self {
        Self { min: a.min(b), max: a.max(b) }
    }

    /// A single number.
    pub fn point(value: f64) -> Self {
        Self { min: value, max: value }
    }

    /// All numbers at most `radius` from `centre`.
    pub fn around(centre: f64, radius: f64) -> Self {
        Self { min: centre - radius, max: centre + radius }
    }

    /// `max - min`.
    pub fn width(self) -> f64 {
        self.max - self.min
    }

    /// The greatest absolute value.
    pub fn size(self) -> f64 {
        self.min.abs().max(self.max.abs())
    }

    /// Whether a number lies inside.
    pub fn holds(self, value: f64) -> bool {
        self.min <= value && value <= self.max
    }

    /// The smallest interval that holds both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// What lies in both; where rounding leaves nothing, the end of `self` next to `other`.
    #[must_use]
    pub fn meet(self, other: Self) -> Self {
        let min = self.min.max(other.min).min(self.max);
        Self { min, max: self.max.min(other.max).max(min) }
    }

    /// All numbers clamped to `[low, high]`.
    #[must_use]
    pub fn clamped(self, low: f64, high: f64) -> Self {
        Self { min: self.min.clamp(low, high), max: self.max.clamp(low, high) }
    }

    /// All absolute values.
    #[must_use]
    pub fn abs(self) -> Self {
        let inner = if self.holds(0.0) { 0.0 } else { self.min.abs().min(self.max.abs()) };
        Self { min: inner, max: self.size() }
    }

    /// All squares.
    #[must_use]
    pub fn square(self) -> Self {
        let a = self.abs();
        Self { min: a.min * a.min, max: a.max * a.max }
    }

    /// All sums.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self { min: self.min + other.min, max: self.max + other.max }
    }

    /// All differences.
    #[must_use]
    pub fn minus(self, other: Self) -> Self {
        Self { min: self.min - other.max, max: self.max - other.min }
    }

    /// All products.
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        let ends = [
            product(self.min, other.min),
            product(self.min, other.max),
            product(self.max, other.min),
            product(self.max, other.max),
        ];
        ends.iter().fold(Self::point(ends[0]), |all, &end| all.hull(Self::point(end)))
    }

    /// All multiples by a number.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self::new(product(self.min, factor), product(self.max, factor))
    }

    /// A little wider: what rounding in a few thousand operations can add.
    #[must_use]
    pub fn widened(self) -> Self {
        let slack = if self.size().is_finite() { self.size() * 1e-12 + 1e-300 } else { 0.0 };
        Self { min: self.min - slack, max: self.max + slack }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn interval() -> impl Strategy<Value = Interval> {
        (-5.0..5.0_f64, -5.0..5.0_f64).prop_map(|(a, b)| Interval::new(a, b))
    }

    proptest! {
        #[test]
        fn operations_hold_what_they_stand_for(a in interval(), b in interval(), s in 0.0..=1.0_f64, t in 0.0..=1.0_f64) {
            let (x, y) = (a.min + s * a.width(), b.min + t * b.width());
            let (x, y) = (x.min(a.max), y.min(b.max));
            prop_assert!(a.plus(b).widened().holds(x + y));
            prop_assert!(a.minus(b).widened().holds(x - y));
            prop_assert!(a.times(b).widened().holds(x * y));
            prop_assert!(a.square().widened().holds(x * x));
            prop_assert!(a.abs().holds(x.abs()));
            prop_assert!(a.clamped(-1.0, 2.0).holds(x.clamp(-1.0, 2.0)));
            prop_assert!(a.hull(b).holds(x) && a.hull(b).holds(y));
            prop_assert!(!b.holds(x) || a.meet(b).holds(x));
            prop_assert!(a.scaled(-1.5).widened().holds(x * -1.5));
        }
    }

    #[test]
    fn nothing_times_infinity_is_nothing() {
        assert_eq!(Interval::ZERO.times(Interval::ALL), Interval::ZERO);
        assert_eq!(Interval::ALL.scaled(0.0), Interval::ZERO);
    }
}
