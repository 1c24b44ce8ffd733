//! Several numbers for each cell of a rectangle.

/// `depth` numbers for each cell, those of one cell together, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub(super) rows: usize,
    pub(super) cols: usize,
    pub(super) depth: usize,
    pub(super) values: Vec<f32>,
}

impl Field {
    /// Zeros.
    pub(super) fn zeros(rows: usize, cols: usize, depth: usize) -> Self {
        Self { rows, cols, depth, values: vec![0.0; rows * cols * depth] }
    }

    /// The numbers of one row.
    #[inline(always)]
    pub(super) fn row(&self, row: usize) -> &[f32] {
        &self.values[row * self.cols * self.depth..][..self.cols * self.depth]
    }

    /// The numbers of one row, to be changed.
    #[inline(always)]
    pub(super) fn row_mut(&mut self, row: usize) -> &mut [f32] {
        &mut self.values[row * self.cols * self.depth..][..self.cols * self.depth]
    }

    /// With so many rows and columns of zeros more at each side.
    pub(super) fn widened(&self, margin: usize) -> Self {
        let mut wide = Self::zeros(self.rows + 2 * margin, self.cols + 2 * margin, self.depth);
        for row in 0..self.rows {
            wide.row_mut(row + margin)[margin * self.depth..][..self.cols * self.depth].copy_from_slice(self.row(row));
        }
        wide
    }
}
