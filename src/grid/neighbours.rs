//! The 8-neighbourhood and the total order of the cells: the tie rule lives here and nowhere else.

use super::key::Key;
use super::raster::{Cell, Grid};

/// Offsets (row, column) of the neighbours in the order of their indices, away from the seam of a wrapping grid.
pub const OFFSETS: [(isize, isize); 8] = [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)];

/// Whether `p` is above `q`: higher, or as high with a lower index.
#[inline]
pub fn is_above<K: Key>(p: (K, Cell), q: (K, Cell)) -> bool {
    p.0 > q.0 || (p.0 == q.0 && p.1 < q.1)
}

/// Position of the topmost of the eight cells around a position in rows of `stride` cells.
///
/// Positions must sort as indices do, so this does not serve across the seam of a wrapping grid.
#[inline]
pub fn topmost_around<K: Key>(cells: &[K], here: usize, stride: usize) -> usize {
    let (north, south) = (here - stride, here + stride);
    let at = [north - 1, north, north + 1, here - 1, here + 1, south - 1, south, south + 1];
    // A tournament: no comparison waits for the one before. Of equals the lower position has the greater number.
    let p: [K::Numbered; 8] = std::array::from_fn(|i| cells[at[i]].numbered(7 - i as u8));
    let top = p[0].max(p[1]).max(p[2].max(p[3])).max(p[4].max(p[5]).max(p[6].max(p[7])));
    at[7 - K::number_of(top) as usize]
}

impl<K: Key> Grid<K> {
    /// The neighbour at `(row + dr, col + dc)` if there is such a cell in the raster; it may be a void.
    #[inline]
    pub fn step(&self, row: usize, col: usize, (dr, dc): (isize, isize)) -> Option<Cell> {
        let row = row.checked_add_signed(dr).filter(|&r| r < self.rows())?;
        let col = match col.checked_add_signed(dc) {
            Some(c) if c < self.cols() => c,
            _ if !self.wraps() => return None,
            Some(_) => 0,
            None => self.cols() - 1,
        };
        Some(self.cell(row, col))
    }

    /// The neighbours of a cell that are in the raster and not void, with their position in [`OFFSETS`].
    pub fn neighbours(&self, cell: Cell) -> impl Iterator<Item = (usize, Cell)> + '_ {
        let (row, col) = self.place(cell);
        OFFSETS
            .into_iter()
            .enumerate()
            .filter_map(move |(i, offset)| self.step(row, col, offset).map(|n| (i, n)))
            .filter(|&(_, n)| !self.is_void(n))
    }

    /// The topmost neighbour of a cell, if that is above the cell: the next step of the steepest way up.
    ///
    /// `None` for a peak.
    #[inline]
    pub fn uphill(&self, cell: Cell) -> Option<Cell> {
        let (row, col) = self.place(cell);
        let (rows, cols) = (self.rows(), self.cols());
        if row == 0 || col == 0 || row + 1 >= rows || col + 1 >= cols {
            return self.uphill_at_edge(cell);
        }
        let here = cell as usize;
        let top = topmost_around(self.cells(), here, cols);
        let (top_key, key) = (self.cells()[top], self.cells()[here]);
        (top_key > key || (top_key == key && top < here)).then_some(top as Cell)
    }

    #[cold]
    fn uphill_at_edge(&self, cell: Cell) -> Option<Cell> {
        let mut top = (self.key(cell), cell);
        for (_, next) in self.neighbours(cell) {
            if is_above((self.key(next), next), top) {
                top = (self.key(next), next);
            }
        }
        (top.1 != cell).then_some(top.1)
    }

    /// The peak that is reached by always going to the topmost neighbour.
    pub fn basin(&self, mut cell: Cell) -> Cell {
        while let Some(next) = self.uphill(cell) {
            cell = next;
        }
        cell
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_go_to_the_lower_index() {
        let flat = Grid::new(3, 3, false, vec![7_i16; 9]);
        assert_eq!(flat.uphill(4), Some(0));
        assert_eq!(flat.uphill(0), None);
        let wrapped = Grid::new(1, 4, true, vec![5_i16, 7, 7, 5]);
        assert_eq!(wrapped.uphill(3), Some(2), "two as high: the lower index, here in the west");
        let wrapped = Grid::new(1, 4, true, vec![7_i16, 5, 5, 7]);
        assert_eq!(wrapped.uphill(3), Some(0), "across the seam");
    }
}
