//! From rows and columns to coordinates.

/// The affine map from pixel to CRS coordinates, in GDAL's order.
///
/// `x = t[0] + col * t[1] + row * t[2]`, `y = t[3] + col * t[4] + row * t[5]`; whole numbers are cell corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeoTransform(pub [f64; 6]);

impl GeoTransform {
    /// Pixel coordinates with the north up: `x = col`, `y = -row`.
    pub const PIXELS: Self = Self([0.0, 1.0, 0.0, 0.0, 0.0, -1.0]);

    /// Coordinates of a cell's centre; fractions and cells outside are fine.
    #[inline]
    pub fn centre(&self, row: f64, col: f64) -> (f64, f64) {
        let t = &self.0;
        let (c, r) = (col + 0.5, row + 0.5);
        (t[0] + c * t[1] + r * t[2], t[3] + c * t[4] + r * t[5])
    }

    /// Fractional row and column at which the coordinates lie; `(0.5, 0.5)` is the centre of the first cell.
    pub fn pixel(&self, x: f64, y: f64) -> (f64, f64) {
        let t = &self.0;
        let det = t[1] * t[5] - t[2] * t[4];
        let (dx, dy) = (x - t[0], y - t[3]);
        ((t[1] * dy - t[4] * dx) / det, (t[5] * dx - t[2] * dy) / det)
    }

    /// Whether rows and columns run along the axes.
    pub fn is_axis_parallel(&self) -> bool {
        self.0[2] == 0.0 && self.0[4] == 0.0
    }

    /// Whether the map can be inverted.
    pub fn is_invertible(&self) -> bool {
        let t = &self.0;
        let det = t[1] * t[5] - t[2] * t[4];
        t.iter().all(|v| v.is_finite()) && det != 0.0 && det.is_finite()
    }

    /// The transform of a window that starts at `row`, `col`.
    #[must_use]
    pub fn window(&self, row: f64, col: f64) -> Self {
        let (x, y) = self.centre(row - 0.5, col - 0.5);
        let t = &self.0;
        Self([x, t[1], t[2], y, t[4], t[5]])
    }

    /// The transform of a raster at the same place whose cells are so many rows high and columns wide.
    #[must_use]
    pub fn scaled(&self, rows: f64, cols: f64) -> Self {
        let t = &self.0;
        Self([t[0], t[1] * cols, t[2] * rows, t[3], t[4] * cols, t[5] * rows])
    }

    /// The transform of the raster with its rows in reverse.
    #[must_use]
    pub fn flipped_rows(&self, rows: usize) -> Self {
        let t = &self.0;
        let n = rows as f64;
        Self([t[0] + n * t[2], t[1], -t[2], t[3] + n * t[5], t[4], -t[5]])
    }

    /// The transform of the raster with its columns in reverse.
    #[must_use]
    pub fn flipped_cols(&self, cols: usize) -> Self {
        let t = &self.0;
        let n = cols as f64;
        Self([t[0] + n * t[1], -t[1], t[2], t[3] + n * t[4], -t[4], t[5]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixel_inverts_centre_even_when_sheared() {
        let t = GeoTransform([100.0, 2.0, 0.5, 50.0, -0.25, -3.0]);
        let (x, y) = t.centre(7.0, 11.0);
        let (row, col) = t.pixel(x, y);
        assert!((row - 7.5).abs() < 1e-12 && (col - 11.5).abs() < 1e-12, "{row} {col}");
    }

    #[test]
    fn flipping_keeps_places() {
        let t = GeoTransform([100.0, 2.0, 0.5, 50.0, -0.25, -3.0]);
        let f = t.flipped_rows(10).flipped_cols(20);
        let (a, b) = (t.centre(3.0, 4.0), f.centre(6.0, 15.0));
        assert!((a.0 - b.0).abs() < 1e-12 && (a.1 - b.1).abs() < 1e-12, "{a:?} {b:?}");
    }
}
