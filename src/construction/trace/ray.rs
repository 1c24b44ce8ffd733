//! Rays.

/// Nothing is looked at more closely than from this distance.
pub(super) const NEAREST_M: f64 = 0.1;

/// A ray in the terrain's own coordinates. After `t` metres it is at `origin + t direction`; metres are those of the
/// picture: where heights are exaggerated, the direction's vertical part is that of length 1 divided by the factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// x, y and elevation at 0, in metres.
    pub origin: [f64; 3],
    /// Change of x, y and elevation per metre.
    pub direction: [f64; 3],
    /// How wide a pixel is at 0, in metres.
    pub footprint_m: f64,
    /// By how much it widens per metre.
    pub growth: f64,
    /// Where the ray begins: 0, or minus infinity where rays are parallel.
    pub from_m: f64,
}

impl Ray {
    /// x and y after so many metres.
    #[inline(always)]
    pub fn at(&self, t_m: f64) -> [f64; 2] {
        [self.origin[0] + t_m * self.direction[0], self.origin[1] + t_m * self.direction[1]]
    }

    /// Elevation after so many metres.
    #[inline(always)]
    pub fn elevation_m(&self, t_m: f64) -> f64 {
        self.origin[2] + t_m * self.direction[2]
    }

    /// How wide a pixel is after so many metres; in the first decimetre as wide as at its end.
    #[inline(always)]
    pub fn pixel_m(&self, t_m: f64) -> f64 {
        self.footprint_m + self.growth * t_m.max(NEAREST_M)
    }
}
