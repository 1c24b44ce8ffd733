//! The raster itself: keys in rows.

use super::key::Key;

/// Index of a cell in the whole raster, `row * columns + column`.
pub type Cell = u64;

/// One band as keys, row-major, row 0 in the north, column 0 in the west.
#[derive(Clone, Debug)]
pub struct Grid<K> {
    rows: usize,
    cols: usize,
    wraps: bool,
    cells: Vec<K>,
}

impl<K: Key> Grid<K> {
    /// A grid of `rows` times `cols` cells; `wraps` joins the last column to the first.
    ///
    /// # Panics
    /// When `cells` does not hold exactly `rows * cols` keys, or a side is 0.
    pub fn new(rows: usize, cols: usize, wraps: bool, cells: Vec<K>) -> Self {
        assert!(rows > 0 && cols > 0, "a grid has at least one cell");
        assert_eq!(cells.len(), rows * cols, "one key a cell");
        // Under three columns a cell would be its own neighbour, or the same one twice.
        Self { rows, cols, wraps: wraps && cols >= 3, cells }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Whether the last column is a neighbour of the first.
    pub fn wraps(&self) -> bool {
        self.wraps
    }

    /// All keys, row-major.
    pub fn cells(&self) -> &[K] {
        &self.cells
    }

    /// One row of keys.
    #[inline]
    pub fn row(&self, row: usize) -> &[K] {
        &self.cells[row * self.cols..(row + 1) * self.cols]
    }

    /// The key of a cell.
    #[inline]
    pub fn key(&self, cell: Cell) -> K {
        self.cells[cell as usize]
    }

    /// Whether a cell is a void.
    #[inline]
    pub fn is_void(&self, cell: Cell) -> bool {
        self.key(cell) == K::VOID
    }

    /// Row and column of a cell.
    #[inline]
    pub fn place(&self, cell: Cell) -> (usize, usize) {
        (cell as usize / self.cols, cell as usize % self.cols)
    }

    /// The cell at a row and column.
    #[inline]
    pub fn cell(&self, row: usize, col: usize) -> Cell {
        (row * self.cols + col) as Cell
    }
}

/// A grid of whichever key type its elevations need.
#[derive(Clone, Debug)]
pub enum AnyGrid {
    /// 8 and 16-bit elevations.
    Narrow(Grid<i16>),
    /// 32-bit elevations, floats included.
    Middle(Grid<i32>),
    /// Double-precision elevations.
    Wide(Grid<i64>),
}

/// Runs the same generic code on whichever grid there is.
#[macro_export]
macro_rules! with_grid {
    ($any:expr, $grid:ident => $body:expr) => {
        match $any {
            $crate::grid::AnyGrid::Narrow($grid) => $body,
            $crate::grid::AnyGrid::Middle($grid) => $body,
            $crate::grid::AnyGrid::Wide($grid) => $body,
        }
    };
}

impl AnyGrid {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        with_grid!(self, grid => grid.rows())
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        with_grid!(self, grid => grid.cols())
    }

    /// Whether the last column is a neighbour of the first.
    pub fn wraps(&self) -> bool {
        with_grid!(self, grid => grid.wraps())
    }

    /// The key of a cell, widened.
    pub fn key(&self, cell: Cell) -> i64 {
        with_grid!(self, grid => grid.key(cell).to_i64())
    }

    /// Whether a cell is a void.
    pub fn is_void(&self, cell: Cell) -> bool {
        with_grid!(self, grid => grid.is_void(cell))
    }
}
