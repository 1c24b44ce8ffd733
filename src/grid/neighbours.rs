//! The 8-neighbourhood and the total order of the cells: the tie rule lives here and nowhere else.

use super::key::Key;
use super::raster::{Cell, Grid};

/// Offsets (row, column) of the neighbours in the order of their indices, away from the seam of a wrapping grid.
pub const OFFSETS: [(isize, isize); 8] = [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)];

/// Bit of each neighbour of [`OFFSETS`] in a mask.
pub const BITS: [u8; 8] = [1, 2, 4, 8, 16, 32, 64, 128];

/// Positions of [`OFFSETS`] in the order in which they go round the cell, north-west first, clockwise.
pub const RING: [usize; 8] = [0, 1, 2, 4, 7, 6, 5, 3];

/// Whether `p` is above `q`: higher, or as high with a lower index.
#[inline]
pub fn is_above<K: Key>(p: (K, Cell), q: (K, Cell)) -> bool {
    p.0 > q.0 || (p.0 == q.0 && p.1 < q.1)
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
        let cells = self.cells();
        let here = cell as usize;
        // In the order of the indices: a later neighbour must be higher to win, and so the lowest index does.
        let mut top = here - cols - 1;
        for next in [here - cols, here - cols + 1, here - 1] {
            if cells[next] > cells[top] {
                top = next;
            }
        }
        if cells[top] < cells[here] {
            top = here;
        }
        for next in [here + 1, here + cols - 1, here + cols, here + cols + 1] {
            if cells[next] > cells[top] {
                top = next;
            }
        }
        (top != here).then_some(top as Cell)
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

/// How many pieces the cells above form in the ring around a cell, for each mask of [`BITS`].
///
/// Two cells of the ring are joined when they are neighbours of each other. A cell whose mask has two pieces or more
/// may join components when it is swept; one with a single piece never does.
pub static PIECES: [u8; 256] = pieces();

const fn pieces() -> [u8; 256] {
    let mut table = [0_u8; 256];
    let mut mask = 0;
    while mask < 256 {
        // Follow the ring; around the corners N-E, E-S, S-W, W-N are neighbours although the corner lies between.
        let mut piece = [0_u8; 8];
        let mut i = 0;
        while i < 8 {
            if mask & (1 << RING[i]) != 0 {
                piece[i] = 1 << i;
            }
            i += 1;
        }
        let mut pass = 0;
        while pass < 8 {
            let mut i = 0;
            while i < 8 {
                let mut step = 1;
                while step <= 2 {
                    // RING[1], [3], [5], [7] are the sides N, E, S, W: two steps apart they touch at a corner.
                    let j = (i + step) % 8;
                    if piece[i] != 0 && piece[j] != 0 && (step == 1 || i % 2 == 1) {
                        let both = piece[i] | piece[j];
                        piece[i] = both;
                        piece[j] = both;
                    }
                    step += 1;
                }
                i += 1;
            }
            pass += 1;
        }
        // A piece counts where its first member is met.
        let mut count = 0;
        let mut i = 0;
        while i < 8 {
            if piece[i] != 0 && piece[i].trailing_zeros() == i as u32 {
                count += 1;
            }
            i += 1;
        }
        table[mask] = count;
        mask += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pieces by the obvious way: cells of the ring with Chebyshev distance 1 are joined.
    fn pieces_slowly(mask: usize) -> u8 {
        let mut label: Vec<usize> = (0..8).collect();
        for _ in 0..8 {
            for i in 0..8 {
                for j in 0..8 {
                    let (a, b) = (OFFSETS[i], OFFSETS[j]);
                    if mask >> i & mask >> j & 1 == 1 && (a.0 - b.0).abs().max((a.1 - b.1).abs()) <= 1 {
                        let low = label[i].min(label[j]);
                        label[i] = low;
                        label[j] = low;
                    }
                }
            }
        }
        (0..8).filter(|&i| mask >> i & 1 == 1 && label[i] == i).count() as u8
    }

    #[test]
    fn pieces_of_every_mask() {
        for mask in 0..256 {
            assert_eq!(PIECES[mask], pieces_slowly(mask), "mask {mask:08b}");
        }
    }

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
