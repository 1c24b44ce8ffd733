//! The lowest cell of a connected component: the base of roots that lie below zero.

use crate::grid::{Cell, Grid, Key};

/// Finds the lowest cells of components, each component once.
pub(super) struct Lowest<'a, K> {
    grid: &'a Grid<K>,
    /// One bit a cell.
    seen: Vec<u64>,
}

impl<'a, K: Key> Lowest<'a, K> {
    pub(super) fn new(grid: &'a Grid<K>) -> Self {
        Self { grid, seen: vec![0; grid.cells().len().div_ceil(64)] }
    }

    /// The least key of the component that holds a cell; the component must not have been asked for before.
    pub(super) fn key(&mut self, start: Cell) -> K {
        let mut least = self.grid.key(start);
        let mut open = vec![start];
        self.mark(start);
        while let Some(cell) = open.pop() {
            least = least.min(self.grid.key(cell));
            for (_, next) in self.grid.neighbours(cell) {
                if self.mark(next) {
                    open.push(next);
                }
            }
        }
        least
    }

    fn mark(&mut self, cell: Cell) -> bool {
        let (word, bit) = (cell as usize / 64, 1 << (cell % 64));
        let new = self.seen[word] & bit == 0;
        self.seen[word] |= bit;
        new
    }
}
