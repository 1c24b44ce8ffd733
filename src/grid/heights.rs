//! Heights on a grid, whatever they come from: a raster file, a container, a grid in memory.

/// Rows and columns of heights in metres; NaN where there is none.
///
/// Lets layers that know neither files nor containers take heights from both.
pub trait Heights: Send + Sync {
    /// Number of rows; row 0 is the first in the file, usually the northern one.
    fn rows(&self) -> usize;

    /// Number of columns.
    fn cols(&self) -> usize;

    /// Copies a row into `out`, which holds as many values as there are columns.
    fn read_row(&self, row: usize, out: &mut [f64]);

    /// From rows and columns to coordinates of its own reference system, if it lies anywhere.
    fn georeference(&self) -> Option<super::GeoTransform> {
        None
    }
}

/// Heights in memory, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightRows {
    cols: usize,
    heights_m: Vec<f64>,
    georeference: Option<super::GeoTransform>,
}

impl HeightRows {
    /// Rows of `cols` heights in metres, NaN for voids; an incomplete last row is left out.
    pub fn new(cols: usize, heights_m: Vec<f64>, georeference: Option<super::GeoTransform>) -> Self {
        Self { cols, heights_m, georeference }
    }
}

impl Heights for HeightRows {
    fn rows(&self) -> usize {
        self.heights_m.len().checked_div(self.cols).unwrap_or(0)
    }

    fn cols(&self) -> usize {
        self.cols
    }

    fn read_row(&self, row: usize, out: &mut [f64]) {
        out.copy_from_slice(&self.heights_m[row * self.cols..(row + 1) * self.cols]);
    }

    fn georeference(&self) -> Option<super::GeoTransform> {
        self.georeference
    }
}
