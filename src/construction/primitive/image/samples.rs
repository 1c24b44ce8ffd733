//! Samples of an image, and what lies between them.

use super::found::{BLOCK, Found};
use crate::construction::primitive::pyramid::{Pyramid, join};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::Heights;
use crate::interval::Interval;
use crate::noise::Sample;

/// How heights between samples are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Between the four samples of a cell; continuous, with creases along rows and columns.
    #[default]
    Bilinear,
    /// Cubic splines of Catmull and Rom through sixteen samples; once continuously differentiable. Beyond the edges
    /// the outermost samples repeat.
    Bicubic,
}

/// So few cells are asked themselves for their bounds; the pyramid knows blocks of cells only.
const FEW: usize = 9;

/// Heights in the least memory that keeps them exactly.
#[derive(Clone, Debug)]
enum Cells {
    Single(Vec<f32>),
    Double(Vec<f64>),
}

/// Rows and columns of heights and weights; coordinates count samples from 0.
#[derive(Clone, Debug)]
pub struct Samples {
    rows: usize,
    cols: usize,
    heights_m: Cells,
    /// Weights where not all are 1.
    weights: Option<Vec<f32>>,
    /// Bounds of blocks of cells, once they are measured.
    blocks: Option<Pyramid<Found>>,
}

impl Samples {
    /// Reads heights, and weights of `[0, 1]` of the same size if there are some; others are clamped.
    ///
    /// Voids get weight 0, and the mean of their neighbours as height, so that interpolation next to them stays sane.
    ///
    /// # Errors
    /// An input error for less than two rows or columns, for infinite heights, for no height at all, and for weights
    /// of another size.
    pub fn read(heights: &dyn Heights, weights: Option<&dyn Heights>) -> Result<Self> {
        let (rows, cols) = (heights.rows(), heights.cols());
        if rows < 2 || cols < 2 {
            let message = format!("an image needs at least 2 x 2 samples, found {cols} columns and {rows} rows");
            return Err(Error::new(ErrorKind::Input, message));
        }
        if let Some(weights) = weights.filter(|w| (w.rows(), w.cols()) != (rows, cols)) {
            return Err(Error::new(
                ErrorKind::Input,
                format!(
                    "the raster of weights has {} x {} cells, the heights {cols} x {rows}; they must be of one size",
                    weights.cols(),
                    weights.rows()
                ),
            ));
        }
        let mut values = vec![0.0; rows * cols];
        let mut shares: Vec<f32> = vec![1.0; rows * cols];
        let mut line = vec![0.0; cols];
        for row in 0..rows {
            heights.read_row(row, &mut values[row * cols..(row + 1) * cols]);
            let shares = &mut shares[row * cols..(row + 1) * cols];
            if let Some(weights) = weights {
                weights.read_row(row, &mut line);
                for (share, &weight) in shares.iter_mut().zip(&line) {
                    *share = if weight.is_nan() { 0.0 } else { weight.clamp(0.0, 1.0) as f32 };
                }
            }
            for (col, share) in shares.iter_mut().enumerate() {
                let value = values[row * cols + col];
                if value.is_infinite() {
                    let message = format!("an infinite height in row {row}, column {col}");
                    return Err(Error::new(ErrorKind::Input, message));
                }
                if value.is_nan() {
                    *share = 0.0;
                }
            }
        }
        if shares.iter().all(|&share| share == 0.0) {
            return Err(Error::new(ErrorKind::Input, "the image has no height with a weight above 0"));
        }
        fill_voids(&mut values, rows, cols);
        let single = values.iter().all(|&v| f64::from(v as f32) == v);
        let heights_m =
            if single { Cells::Single(values.iter().map(|&v| v as f32).collect()) } else { Cells::Double(values) };
        let weights = shares.iter().any(|&share| share != 1.0).then_some(shares);
        Ok(Self { rows, cols, heights_m, weights, blocks: None })
    }

    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    pub(super) fn cols(&self) -> usize {
        self.cols
    }

    /// With bounds of all cells for an interpolation.
    pub(super) fn measured(mut self, interpolation: Interpolation) -> Self {
        let cell = |row, col| self.cell(interpolation, row, col);
        self.blocks = Some(Pyramid::new(self.rows - 1, self.cols - 1, BLOCK, cell));
        self
    }

    /// Bounds over ranges of columns and rows.
    pub(super) fn over(&self, interpolation: Interpolation, c: Interval, r: Interval) -> Found {
        let cell = |at: f64, count: usize| (at.floor().max(0.0) as usize).min(count - 2);
        let (rows, cols) =
            ((cell(r.min, self.rows), cell(r.max, self.rows)), (cell(c.min, self.cols), cell(c.max, self.cols)));
        if (rows.1 - rows.0 + 1) * (cols.1 - cols.0 + 1) <= FEW {
            return join(rows, cols, |row, col| self.cell(interpolation, row, col));
        }
        self.blocks.as_ref().map_or(Found::NOTHING, |blocks| blocks.over(rows, cols, BLOCK))
    }

    #[inline(always)]
    fn height(&self, row: usize, col: usize) -> f64 {
        let at = row * self.cols + col;
        match &self.heights_m {
            Cells::Single(cells) => f64::from(cells[at]),
            Cells::Double(cells) => cells[at],
        }
    }

    #[inline(always)]
    fn weight(&self, row: usize, col: usize) -> f64 {
        self.weights.as_ref().map_or(1.0, |weights| f64::from(weights[row * self.cols + col]))
    }

    /// Height and weight at a column and a row, with derivatives by both; inside the raster.
    #[inline(always)]
    pub(super) fn at(&self, interpolation: Interpolation, c: f64, r: f64) -> (Sample, Sample) {
        // Coordinates are not negative, so cutting is rounding down.
        let (col, row) = ((c as usize).min(self.cols - 2), (r as usize).min(self.rows - 2));
        let (x, y) = (c - col as f64, r - row as f64);
        let weight = match &self.weights {
            None => Sample { value: 1.0, dx: 0.0, dy: 0.0 },
            Some(_) => {
                let line = [self.weight(row, col), self.weight(row, col + 1)];
                bilinear([line, [self.weight(row + 1, col), self.weight(row + 1, col + 1)]], x, y)
            }
        };
        let height = match interpolation {
            Interpolation::Bilinear => {
                let line = [self.height(row, col), self.height(row, col + 1)];
                bilinear([line, [self.height(row + 1, col), self.height(row + 1, col + 1)]], x, y)
            }
            Interpolation::Bicubic => {
                let patch = self.patch(row, col);
                let (mut values, mut slopes) = ([0.0; 4], [0.0; 4]);
                for i in 0..4 {
                    (values[i], slopes[i]) = cubic(patch[i], x);
                }
                let (value, dy) = cubic(values, y);
                Sample { value, dx: cubic(slopes, y).0, dy }
            }
        };
        (height, weight)
    }

    /// The sixteen samples around a cell. Loops, not closures: those would not be inlined into the caller's vectors.
    #[inline(always)]
    fn patch(&self, row: usize, col: usize) -> [[f64; 4]; 4] {
        let mut patch = [[0.0; 4]; 4];
        for (i, line) in patch.iter_mut().enumerate() {
            let row = (row + i).max(1).min(self.rows) - 1;
            for (j, height) in line.iter_mut().enumerate() {
                *height = self.height(row, (col + j).max(1).min(self.cols) - 1);
            }
        }
        patch
    }

    /// Bounds of one cell.
    fn cell(&self, interpolation: Interpolation, row: usize, col: usize) -> Found {
        let corners = |at: &dyn Fn(usize, usize) -> f64| [0, 1].map(|i| [0, 1].map(|j| at(row + i, col + j)));
        let weight = net(&corners(&|row, col| self.weight(row, col)).map(|line| line.to_vec()), 1.0);
        if weight.0.max <= 0.0 {
            return Found::NOTHING;
        }
        let height = match interpolation {
            Interpolation::Bilinear => net(&corners(&|row, col| self.height(row, col)).map(|line| line.to_vec()), 1.0),
            Interpolation::Bicubic => {
                let lines = self.patch(row, col).map(controls);
                let columns = [0, 1, 2, 3].map(|j| controls([0, 1, 2, 3].map(|i| lines[i][j])).to_vec());
                // Columns became rows: derivatives swap.
                let (range, by_row, by_col) = net(&columns, 3.0);
                (range, by_col, by_row)
            }
        };
        Found {
            height: height.0.widened(),
            dx: height.1,
            dy: height.2,
            weight: weight.0,
            weight_dx: weight.1,
            weight_dy: weight.2,
        }
    }

    pub(super) fn bytes(&self) -> usize {
        let cells = match &self.heights_m {
            Cells::Single(cells) => size_of_val(&cells[..]),
            Cells::Double(cells) => size_of_val(&cells[..]),
        };
        cells
            + self.weights.as_ref().map_or(0, |w| size_of_val(&w[..]))
            + self.blocks.as_ref().map_or(0, Pyramid::bytes)
    }
}

/// Range of a net of control points, and greatest differences along its lines and across, times the degree.
fn net(lines: &[Vec<f64>], degree: f64) -> (Interval, f64, f64) {
    let mut range = Interval::point(lines[0][0]);
    let (mut along, mut across) = (0.0_f64, 0.0_f64);
    for (i, line) in lines.iter().enumerate() {
        for (j, &value) in line.iter().enumerate() {
            range = range.hull(Interval::point(value));
            if j > 0 {
                along = along.max((value - line[j - 1]).abs());
            }
            if i > 0 {
                across = across.max((value - lines[i - 1][j]).abs());
            }
        }
    }
    (range, along * degree, across * degree)
}

/// Control points of the spline of Catmull and Rom between the middle two of four samples.
fn controls([a, b, c, d]: [f64; 4]) -> [f64; 4] {
    [b, b + (c - a) / 6.0, c - (d - b) / 6.0, c]
}

/// The spline between the middle two of four samples, and its derivative.
#[inline(always)]
fn cubic([a, b, c, d]: [f64; 4], t: f64) -> (f64, f64) {
    let (m, n) = ((c - a) * 0.5, (d - b) * 0.5);
    let gap = c - b;
    let (two, three) = (3.0 * gap - 2.0 * m - n, m + n - 2.0 * gap);
    (b + t * (m + t * (two + t * three)), m + t * (2.0 * two + t * (3.0 * three)))
}

/// Between four corners, row by row.
#[inline(always)]
fn bilinear([[a, b], [c, d]]: [[f64; 2]; 2], x: f64, y: f64) -> Sample {
    let (top, bottom) = (a + x * (b - a), c + x * (d - c));
    let (dx_top, dx_bottom) = (b - a, d - c);
    Sample { value: top + y * (bottom - top), dx: dx_top + y * (dx_bottom - dx_top), dy: bottom - top }
}

/// Gives voids heights: twice the mean of the neighbours that have one, then 0.
fn fill_voids(values: &mut [f64], rows: usize, cols: usize) {
    if !values.iter().any(|v| v.is_nan()) {
        return;
    }
    for _ in 0..2 {
        let before = values.to_vec();
        for row in 0..rows {
            for col in 0..cols {
                if !before[row * cols + col].is_nan() {
                    continue;
                }
                let (mut sum, mut count) = (0.0, 0.0);
                for r in row.saturating_sub(1)..(row + 2).min(rows) {
                    for c in col.saturating_sub(1)..(col + 2).min(cols) {
                        let value = before[r * cols + c];
                        if !value.is_nan() {
                            sum += value;
                            count += 1.0;
                        }
                    }
                }
                if count > 0.0 {
                    // Single precision keeps rasters of it small.
                    values[row * cols + col] = f64::from((sum / count) as f32);
                }
            }
        }
    }
    for value in values.iter_mut().filter(|v| v.is_nan()) {
        *value = 0.0;
    }
}
