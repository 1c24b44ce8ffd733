//! Bounds of cells, in levels of blocks.

use crate::interval::Interval;

/// Side of a block, in cells or in blocks of the level below.
const SIDE: usize = 8;

/// Bounds over cells: heights and weights, and their derivatives by column (`dx`) and row (`dy`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub(super) height: Interval,
    pub(super) dx: f64,
    pub(super) dy: f64,
    pub(super) weight: Interval,
    pub(super) weight_dx: f64,
    pub(super) weight_dy: f64,
}

/// Bounds of blocks of cells, of blocks of blocks, and so on to one.
#[derive(Clone, Debug, Default)]
pub(super) struct Statistics {
    /// Rows and columns of each level, finest first, with its blocks.
    levels: Vec<(usize, usize, Vec<Found>)>,
}

impl Found {
    fn join(self, other: Self) -> Self {
        Self {
            height: self.height.hull(other.height),
            dx: self.dx.max(other.dx),
            dy: self.dy.max(other.dy),
            weight: self.weight.hull(other.weight),
            weight_dx: self.weight_dx.max(other.weight_dx),
            weight_dy: self.weight_dy.max(other.weight_dy),
        }
    }
}

/// Joins what `at` says of rows and columns, ends included.
pub(super) fn join(rows: (usize, usize), cols: (usize, usize), mut at: impl FnMut(usize, usize) -> Found) -> Found {
    let mut all = at(rows.0, cols.0);
    for row in rows.0..=rows.1 {
        for col in cols.0..=cols.1 {
            all = all.join(at(row, col));
        }
    }
    all
}

impl Statistics {
    /// Bounds of so many rows and columns of cells, at least one of each.
    pub(super) fn new(rows: usize, cols: usize, cell: impl Fn(usize, usize) -> Found) -> Self {
        let mut levels: Vec<(usize, usize, Vec<Found>)> = vec![];
        let (mut below_rows, mut below_cols) = (rows, cols);
        loop {
            let (rows, cols) = (below_rows.div_ceil(SIDE), below_cols.div_ceil(SIDE));
            let block = |i: usize| {
                let (row, col) = (i / cols * SIDE, i % cols * SIDE);
                let ends = ((row, (row + SIDE).min(below_rows) - 1), (col, (col + SIDE).min(below_cols) - 1));
                join(ends.0, ends.1, |row, col| match levels.last() {
                    None => cell(row, col),
                    Some((_, below, blocks)) => blocks[row * below + col],
                })
            };
            let blocks: Vec<Found> = (0..rows * cols).map(block).collect();
            levels.push((rows, cols, blocks));
            (below_rows, below_cols) = (rows, cols);
            if rows * cols == 1 {
                return Self { levels };
            }
        }
    }

    /// Bounds over the blocks that hold the cells from one row and column to others, ends included: of the finest
    /// level at which these are few.
    pub(super) fn over(&self, rows: (usize, usize), cols: (usize, usize)) -> Found {
        let (mut rows, mut cols) = (rows, cols);
        for (_, width, blocks) in &self.levels {
            rows = (rows.0 / SIDE, rows.1 / SIDE);
            cols = (cols.0 / SIDE, cols.1 / SIDE);
            if (rows.1 - rows.0) * (cols.1 - cols.0) <= 16 {
                return join(rows, cols, |row, col| blocks[row * width + col]);
            }
        }
        // The last level is one block, so the loop has returned.
        self.levels[self.levels.len() - 1].2[0]
    }

    pub(super) fn bytes(&self) -> usize {
        self.levels.iter().map(|(_, _, blocks)| size_of_val(&blocks[..])).sum()
    }
}
