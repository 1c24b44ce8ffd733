//! Bounds of cells, in levels of blocks.

/// Side of a block, in cells or in blocks of the level below.
const SIDE: usize = 8;

/// What is known of cells, and can be joined to what is known of several.
pub(super) trait Joined: Copy {
    /// What holds for both.
    fn join(self, other: Self) -> Self;
}

/// What is known of blocks of cells, of blocks of blocks, and so on to one.
#[derive(Clone, Debug)]
pub(super) struct Pyramid<T> {
    /// Rows and columns of each level, finest first, with its blocks.
    levels: Vec<(usize, usize, Vec<T>)>,
}

/// Joins what `at` says of rows and columns, ends included.
pub(super) fn join<T: Joined>(rows: (usize, usize), cols: (usize, usize), mut at: impl FnMut(usize, usize) -> T) -> T {
    let mut all = at(rows.0, cols.0);
    for row in rows.0..=rows.1 {
        for col in cols.0..=cols.1 {
            all = all.join(at(row, col));
        }
    }
    all
}

impl<T: Joined> Pyramid<T> {
    /// Blocks of `side` cells over so many rows and columns of them, at least one of each.
    pub(super) fn new(rows: usize, cols: usize, side: usize, cell: impl Fn(usize, usize) -> T) -> Self {
        let mut levels: Vec<(usize, usize, Vec<T>)> = vec![];
        let (mut below_rows, mut below_cols, mut side) = (rows, cols, side);
        loop {
            let (rows, cols) = (below_rows.div_ceil(side), below_cols.div_ceil(side));
            let block = |i: usize| {
                let (row, col) = (i / cols * side, i % cols * side);
                let ends = ((row, (row + side).min(below_rows) - 1), (col, (col + side).min(below_cols) - 1));
                join(ends.0, ends.1, |row, col| match levels.last() {
                    None => cell(row, col),
                    Some((_, below, blocks)) => blocks[row * below + col],
                })
            };
            let blocks: Vec<T> = (0..rows * cols).map(block).collect();
            levels.push((rows, cols, blocks));
            (below_rows, below_cols, side) = (rows, cols, SIDE);
            if rows * cols == 1 {
                return Self { levels };
            }
        }
    }

    /// What holds for the blocks from one row and column of them to others, ends included; of the finest level at which
    /// these are few. `side` is that of the finest blocks, and rows and columns are those of cells.
    pub(super) fn over(&self, rows: (usize, usize), cols: (usize, usize), side: usize) -> T {
        let (mut rows, mut cols, mut side) = (rows, cols, side);
        for (_, width, blocks) in &self.levels {
            rows = (rows.0 / side, rows.1 / side);
            cols = (cols.0 / side, cols.1 / side);
            if (rows.1 - rows.0) * (cols.1 - cols.0) <= 16 {
                return join(rows, cols, |row, col| blocks[row * width + col]);
            }
            side = SIDE;
        }
        // The last level is one block, so the loop has returned.
        self.levels[self.levels.len() - 1].2[0]
    }

    pub(super) fn bytes(&self) -> usize {
        self.levels.iter().map(|(_, _, blocks)| size_of_val(&blocks[..])).sum()
    }
}
