//! The eight ways to turn and mirror a square patch. Terrain looks alike in all of them, so patches are brought into
//! the one in which they rise most towards the right, then downwards: one patch stands for eight.

use super::plane::Plane;

/// Number of ways.
pub(super) const WAYS: usize = 8;
/// Bits of a way: columns from right to left, rows from bottom to top, then rows as columns.
const COLUMNS: usize = 1;
const ROWS: usize = 2;
const TRANSPOSED: usize = 4;

/// How a patch is turned, 0 to 7.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Way(usize);

impl Way {
    /// One of [`WAYS`]; the first half transposes nothing.
    pub(super) fn number(number: usize) -> Self {
        Self(number % WAYS)
    }

    /// Four ways that are as different as can be: quarter turns, or where cells are not square, all that transpose nothing.
    pub(super) fn four(is_square: bool) -> [Self; 4] {
        if is_square {
            [0, COLUMNS | ROWS, COLUMNS | TRANSPOSED, ROWS | TRANSPOSED].map(Self)
        } else {
            [0, COLUMNS, ROWS, COLUMNS | ROWS].map(Self)
        }
    }

    /// Where a cell of a turned plane of a size is found in the plane as it lies.
    #[inline(always)]
    pub(super) fn place(self, mut row: usize, mut col: usize, [rows, cols]: [usize; 2]) -> (usize, usize) {
        if self.0 & ROWS != 0 {
            row = rows - 1 - row;
        }
        if self.0 & COLUMNS != 0 {
            col = cols - 1 - col;
        }
        if self.0 & TRANSPOSED != 0 { (col, row) } else { (row, col) }
    }

    /// A plane turned: transposed first, then its rows and columns turned round.
    pub(super) fn turned(self, plane: &Plane) -> Plane {
        let mut size = [plane.rows(), plane.cols()];
        if self.0 & TRANSPOSED != 0 {
            size.reverse();
        }
        let cells = (0..size[0]).flat_map(|row| (0..size[1]).map(move |col| self.place(row, col, size)));
        Plane::new(size[0], size[1], cells.map(|(row, col)| plane.row(row)[col]).collect())
    }

    /// The way that brings the patch around a cell into its standing position. Cells that are not square are not
    /// transposed. Turned planes give turned patches to the bit.
    #[inline(always)]
    pub(super) fn of(plane: &Plane, row: usize, col: usize, is_square: bool) -> Self {
        let [above, own, below] = [row - 1, row, row + 1].map(|row| &plane.row(row)[col - 1..col + 2]);
        let right = ((above[2] - above[0]) + (below[2] - below[0])) + (own[2] - own[0]);
        let down = ((below[0] - above[0]) + (below[2] - above[2])) + (below[1] - above[1]);
        let bit = |is_set: bool, bit: usize| if is_set { bit } else { 0 };
        let transposed = is_square && down.abs() > right.abs();
        Self(bit(right < 0.0, COLUMNS) | bit(down < 0.0, ROWS) | bit(transposed, TRANSPOSED))
    }
}

/// Where the cells of squares of one side are found, way by way.
#[derive(Clone, Debug)]
pub(super) struct Ways {
    /// Row and column of each cell of the turned square in the square as it lies.
    cells: [Vec<(usize, usize)>; WAYS],
}

impl Ways {
    pub(super) fn new(side: usize) -> Self {
        let cells = |way: usize| {
            let place = |cell: usize| {
                let (mut row, mut col) = (cell / side, cell % side);
                if way & TRANSPOSED != 0 {
                    (row, col) = (col, row);
                }
                if way & ROWS != 0 {
                    row = side - 1 - row;
                }
                if way & COLUMNS != 0 {
                    col = side - 1 - col;
                }
                (row, col)
            };
            (0..side * side).map(place).collect()
        };
        Self { cells: std::array::from_fn(cells) }
    }

    /// For each way, where the cells lie from the square's first cell in a plane of so many columns.
    pub(super) fn offsets(&self, cols: usize) -> Offsets {
        Offsets(std::array::from_fn(|way| self.cells[way].iter().map(|(row, col)| row * cols + col).collect()))
    }
}

/// Places of the cells of turned squares in one plane.
#[derive(Clone, Debug)]
pub(super) struct Offsets([Vec<usize>; WAYS]);

impl Offsets {
    /// Those of one way.
    #[inline(always)]
    pub(super) fn of(&self, way: Way) -> &[usize] {
        &self.0[way.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned(plane: &Plane, way: usize) -> Plane {
        let mut heights = plane.heights_m().to_vec();
        let side = plane.cols();
        if way & COLUMNS != 0 {
            heights.chunks_mut(side).for_each(<[f64]>::reverse);
        }
        if way & ROWS != 0 {
            heights = heights.chunks(side).rev().flatten().copied().collect();
        }
        let plane = Plane::new(side, side, heights);
        if way & TRANSPOSED != 0 { plane.transposed() } else { plane }
    }

    #[test]
    fn all_ways_end_in_one_position() {
        let plane = Plane::new(5, 5, (0..25).map(|i| f64::from((i * i * 7 + i * 3) % 31) + 0.1).collect());
        let standing = |plane: &Plane| -> Vec<f64> {
            let offsets = Ways::new(5).offsets(5);
            offsets.of(Way::of(plane, 2, 2, true)).iter().map(|&cell| plane.heights_m()[cell]).collect()
        };
        let known = standing(&plane);
        let rise = (1..4).map(|i| known[i * 5 + 3] - known[i * 5 + 1]).sum::<f64>();
        let fall = (1..4).map(|i| known[15 + i] - known[5 + i]).sum::<f64>();
        assert!(rise >= fall && fall >= 0.0, "{known:?}");
        for way in 0..WAYS {
            assert_eq!(standing(&turned(&plane, way)), known, "way {way}");
            // The table is the turn.
            let offsets = Ways::new(5).offsets(5);
            let by_table: Vec<f64> = offsets.of(Way(way)).iter().map(|&cell| plane.heights_m()[cell]).collect();
            assert_eq!(by_table, turned(&plane, way).heights_m());
        }
    }

    #[test]
    fn planes_are_turned() {
        let plane = Plane::new(2, 3, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let heights = |way: usize| Way(way).turned(&plane).heights_m().to_vec();
        assert_eq!(heights(COLUMNS), [3.0, 2.0, 1.0, 6.0, 5.0, 4.0]);
        assert_eq!(heights(ROWS), [4.0, 5.0, 6.0, 1.0, 2.0, 3.0]);
        assert_eq!(heights(TRANSPOSED), [1.0, 4.0, 2.0, 5.0, 3.0, 6.0]);
        // A quarter of a turn, and another one back.
        assert_eq!(heights(COLUMNS | TRANSPOSED), [4.0, 1.0, 5.0, 2.0, 6.0, 3.0]);
        let back = Way(ROWS | TRANSPOSED).turned(&Way(COLUMNS | TRANSPOSED).turned(&plane));
        assert_eq!(back, plane);
        assert!(Way::four(false).iter().all(|way| way.0 & TRANSPOSED == 0));
    }

    #[test]
    fn cells_that_are_not_square_stay_upright() {
        let steep = Plane::new(3, 3, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
        assert_eq!(Way::of(&steep, 1, 1, false), Way(0));
        assert_eq!(Way::of(&steep, 1, 1, true), Way(TRANSPOSED));
    }
}
