//! The plane through three points.

/// `z = base + slope_x * (x - x0) + slope_y * (y - y0)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    x0: f64,
    y0: f64,
    base: f64,
    /// Rise for each step in x.
    pub(super) slope_x: f64,
    slope_y: f64,
}

impl Plane {
    /// The plane through points with different places that do not lie on a line.
    #[inline]
    pub(super) fn through([a, b, c]: [[f64; 3]; 3]) -> Self {
        let (bx, by, bz) = (b[0] - a[0], b[1] - a[1], b[2] - a[2]);
        let (cx, cy, cz) = (c[0] - a[0], c[1] - a[1], c[2] - a[2]);
        let det = bx * cy - cx * by;
        Self { x0: a[0], y0: a[1], base: a[2], slope_x: (bz * cy - cz * by) / det, slope_y: (bx * cz - cx * bz) / det }
    }

    /// Elevation at a place.
    #[inline]
    pub(super) fn at(&self, x: f64, y: f64) -> f64 {
        self.base + self.slope_x * (x - self.x0) + self.slope_y * (y - self.y0)
    }
}
