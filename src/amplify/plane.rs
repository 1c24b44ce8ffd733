//! Heights that a method works on.

/// A rectangle of heights in metres, row by row; NaN is a void where voids are taken, and nowhere else.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    rows: usize,
    cols: usize,
    heights_m: Vec<f64>,
}

impl Plane {
    /// `rows * cols` heights.
    ///
    /// # Panics
    /// When there is another number of them.
    pub fn new(rows: usize, cols: usize, heights_m: Vec<f64>) -> Self {
        assert_eq!(heights_m.len(), rows * cols, "one height a cell");
        Self { rows, cols, heights_m }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// All heights.
    pub fn heights_m(&self) -> &[f64] {
        &self.heights_m
    }

    /// All heights, to be changed.
    pub(super) fn heights_mut(&mut self) -> &mut [f64] {
        &mut self.heights_m
    }

    /// One row.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.heights_m[row * self.cols..][..self.cols]
    }

    /// A rectangle of it: first row, first column, rows, columns.
    ///
    /// # Panics
    /// When it does not lie inside.
    #[must_use]
    pub fn part(&self, row: usize, col: usize, rows: usize, cols: usize) -> Self {
        let lines = (row..row + rows).flat_map(|row| &self.row(row)[col..col + cols]);
        Self::new(rows, cols, lines.copied().collect())
    }

    /// What is left without so many rows and columns at each side.
    ///
    /// # Panics
    /// When there are not so many.
    #[must_use]
    pub fn trimmed(&self, margin: usize) -> Self {
        self.part(margin, margin, self.rows - 2 * margin, self.cols - 2 * margin)
    }

    /// Rows as columns.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let heights = (0..self.cols).flat_map(|col| (0..self.rows).map(move |row| self.row(row)[col]));
        Self::new(self.cols, self.rows, heights.collect())
    }

    /// Means of squares of `factor` cells; rows and columns that fill no square are left out.
    ///
    /// Sums go down the rows of a column first, then over the columns, each in its order.
    #[must_use]
    pub fn averaged(&self, factor: usize) -> Self {
        let (rows, cols) = (self.rows / factor, self.cols / factor);
        let cells = (factor * factor) as f64;
        let mut means = Vec::with_capacity(rows * cols);
        let mut sums = vec![0.0; cols * factor];
        for row in 0..rows {
            sums.copy_from_slice(&self.row(row * factor)[..cols * factor]);
            for line in 1..factor {
                sums.iter_mut().zip(self.row(row * factor + line)).for_each(|(sum, height)| *sum += height);
            }
            means.extend(sums.chunks_exact(factor).map(|square| square.iter().sum::<f64>() / cells));
        }
        Self::new(rows, cols, means)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_over_whole_squares() {
        let plane = Plane::new(3, 5, (0..15).map(f64::from).collect());
        assert_eq!(plane.averaged(2), Plane::new(1, 2, vec![3.0, 5.0]));
        assert_eq!(plane.averaged(1), plane);
        assert_eq!(plane.averaged(4).heights_m(), [0.0; 0]);
    }

    #[test]
    fn parts_and_transposition() {
        let plane = Plane::new(3, 4, (0..12).map(f64::from).collect());
        assert_eq!(plane.trimmed(1), Plane::new(1, 2, vec![5.0, 6.0]));
        assert_eq!(plane.transposed().row(1), [1.0, 5.0, 9.0]);
        assert_eq!(plane.transposed().transposed(), plane);
    }
}
