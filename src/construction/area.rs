//! Boxes in the plane, and what is known of a box before it is evaluated.

use crate::interval::Interval;

/// All points of an axis-parallel box, edges included; coordinates in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Range of x.
    pub x: Interval,
    /// Range of y.
    pub y: Interval,
}

/// A box with what is known of the level of detail in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Where.
    pub area: Area,
    /// Range of the level of detail.
    pub kappa: Interval,
    /// Bound of the slope of the level of detail, per metre.
    pub kappa_slope: f64,
}

impl Area {
    /// The whole plane.
    pub const PLANE: Self = Self { x: Interval::ALL, y: Interval::ALL };
    /// No point at all.
    pub const EMPTY: Self = {
        let none = Interval { min: f64::INFINITY, max: f64::NEG_INFINITY };
        Self { x: none, y: none }
    };

    /// The smallest box that holds all points.
    pub fn of(points: &[[f64; 2]]) -> Self {
        points.iter().fold(Self::EMPTY, |all, &[x, y]| all.hull(&Self { x: Interval::point(x), y: Interval::point(y) }))
    }

    /// The box around a disc.
    pub fn around([x, y]: [f64; 2], radius_m: f64) -> Self {
        Self { x: Interval::around(x, radius_m), y: Interval::around(y, radius_m) }
    }

    /// Whether there is no point in it.
    pub fn is_empty(&self) -> bool {
        self.x.min > self.x.max || self.y.min > self.y.max
    }

    /// Whether the point lies in it.
    pub fn holds(&self, [x, y]: [f64; 2]) -> bool {
        self.x.holds(x) && self.y.holds(y)
    }

    /// Whether there is a point in both.
    pub fn meets(&self, other: &Self) -> bool {
        self.x.min <= other.x.max
            && other.x.min <= self.x.max
            && self.y.min <= other.y.max
            && other.y.min <= self.y.max
            && !self.is_empty()
            && !other.is_empty()
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn hull(&self, other: &Self) -> Self {
        Self { x: self.x.hull(other.x), y: self.y.hull(other.y) }
    }

    /// The points of both; empty where they do not meet.
    #[must_use]
    pub fn meet(&self, other: &Self) -> Self {
        if self.meets(other) { Self { x: self.x.meet(other.x), y: self.y.meet(other.y) } } else { Self::EMPTY }
    }

    /// The box and all points at most so far from it along either axis.
    #[must_use]
    pub fn grown(&self, by_m: f64) -> Self {
        if self.is_empty() {
            return *self;
        }
        let grow = |i: Interval| Interval { min: i.min - by_m, max: i.max + by_m };
        Self { x: grow(self.x), y: grow(self.y) }
    }

    /// A little larger than rounding of coordinates of this size can matter.
    #[must_use]
    pub fn widened(&self) -> Self {
        if self.is_empty() { *self } else { Self { x: self.x.widened(), y: self.y.widened() } }
    }

    /// The centre; of use for bounded boxes only.
    pub fn centre(&self) -> [f64; 2] {
        [self.x.min + self.x.width() / 2.0, self.y.min + self.y.width() / 2.0]
    }

    /// Half of the diagonal: no point is further from the centre. A little more than rounding takes away.
    pub fn radius(&self) -> f64 {
        let (w, h) = (self.x.width(), self.y.width());
        (w * w + h * h).sqrt() * (0.5 + 1e-12) + (self.x.size() + self.y.size()) * 1e-15
    }

    /// Squares of the least and the greatest distance of its points from a point, rounded as those of single points.
    pub fn square_distances(&self, [x, y]: [f64; 2]) -> Interval {
        let square = |i: Interval, c: f64| Interval { min: i.min - c, max: i.max - c }.square();
        square(self.x, x).plus(square(self.y, y))
    }

    /// The four corners.
    pub fn corners(&self) -> [[f64; 2]; 4] {
        [[self.x.min, self.y.min], [self.x.max, self.y.min], [self.x.min, self.y.max], [self.x.max, self.y.max]]
    }
}

impl Region {
    /// The same level of detail over another box.
    #[must_use]
    pub fn over(&self, area: Area) -> Self {
        Self { area, ..*self }
    }
}
