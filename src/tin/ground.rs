//! The ground of a raster: where four neighbouring cells, or three of them, have data.
//!
//! A **square** is the area between four neighbouring cell centres. It is ground as a whole where all four have data,
//! half of it where three have. Cells that no ground touches (single ones, lines of one cell's width) cannot be part
//! of a triangle.
//!
//! Its border runs along edges between neighbouring cells, of which at least one void is a neighbour too. Such an edge
//! has a circle around it that holds no other cell with data, so every Delaunay triangulation that has its ends has the
//! edge: triangles are ground or not, as a whole.

use super::heights::Heights;

/// The four corners of a square that begins at a column and row.
pub(super) fn corners([x, y]: [i64; 2]) -> [[i64; 2]; 4] {
    [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]]
}

/// Neighbours of a cell.
const AROUND: [[i64; 2]; 8] = [[-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];

impl Heights {
    /// Number of corners with data of the square that begins at a column and row.
    fn filled(&self, square: [i64; 2]) -> usize {
        corners(square).into_iter().filter(|&corner| self.has(corner)).count()
    }

    /// Whether a cell touches the ground.
    pub(super) fn is_ground(&self, [x, y]: [i64; 2]) -> bool {
        self.has([x, y])
            && [[x - 1, y - 1], [x, y - 1], [x - 1, y], [x, y]].into_iter().any(|square| self.filled(square) >= 3)
    }

    /// Whether a cell has a void among its neighbours.
    pub(super) fn is_beside_void(&self, [x, y]: [i64; 2]) -> bool {
        AROUND.iter().any(|[dx, dy]| {
            let [x, y] = [x + dx, y + dy];
            let inside = x >= 0 && y >= 0 && (x as usize) < self.cols() && (y as usize) < self.rows();
            inside && !self.has([x, y])
        })
    }

    /// Whether the step from a cell to a neighbour stays on the ground.
    pub(super) fn is_ground_step(&self, a: [i64; 2], b: [i64; 2]) -> bool {
        let square = [a[0].min(b[0]), a[1].min(b[1])];
        self.has(a)
            && self.has(b)
            && if a[0] == b[0] {
                self.filled(square) >= 3 || self.filled([square[0] - 1, square[1]]) >= 3
            } else if a[1] == b[1] {
                self.filled(square) >= 3 || self.filled([square[0], square[1] - 1]) >= 3
            } else {
                self.filled(square) >= 3
            }
    }

    /// Whether a triangle of cells is ground, which it is as a whole or not at all: so it is enough to look at where it
    /// begins at its first corner.
    pub(super) fn is_ground_triangle(&self, [a, b, c]: [[i64; 2]; 3]) -> bool {
        if !self.has_voids() {
            return true;
        }
        let [dx, dy] = [b[0] + c[0] - 2 * a[0], b[1] + c[1] - 2 * a[1]];
        let square = [a[0] - i64::from(dx < 0), a[1] - i64::from(dy < 0)];
        let (sx, sy) = (if dx < 0 { -1 } else { 1 }, if dy < 0 { -1 } else { 1 });
        let [across, along, beyond] = [[a[0] + sx, a[1]], [a[0], a[1] + sy], [a[0] + sx, a[1] + sy]];
        match self.filled(square) {
            4 => true,
            3 if !self.has(beyond) => true,
            // The border leads from here to the opposite corner.
            3 if !self.has(along) => dx.abs() > dy.abs(),
            3 if !self.has(across) => dy.abs() > dx.abs(),
            _ => false,
        }
    }

    /// Number of cells with data that no ground touches.
    pub(super) fn uncovered(&self) -> u64 {
        if !self.has_voids() && self.rows() > 1 && self.cols() > 1 {
            return 0;
        }
        self.places().filter(|&place| self.has(place) && !self.is_ground(place)).count() as u64
    }

    /// All columns and rows, row by row.
    pub(super) fn places(&self) -> impl Iterator<Item = [i64; 2]> {
        let (rows, cols) = (self.rows() as i64, self.cols() as i64);
        (0..rows).flat_map(move |y| (0..cols).map(move |x| [x, y]))
    }

    /// The cells without which the ground would lose its shape: those beside voids, and the raster's corners.
    pub(super) fn required(&self) -> Vec<u32> {
        let (right, bottom) = (self.cols() as i64 - 1, self.rows() as i64 - 1);
        let corners = [[0, 0], [right, 0], [0, bottom], [right, bottom]];
        let mut found: Vec<u32> =
            corners.into_iter().filter(|&place| self.is_ground(place)).map(|place| self.cell(place)).collect();
        if self.has_voids() {
            let beside = self.places().filter(|&place| self.has(place) && self.is_beside_void(place));
            found.extend(beside.filter(|&place| self.is_ground(place)).map(|place| self.cell(place)));
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The edges between neighbouring cells that part ground from voids.
    pub(super) fn shores(&self) -> Vec<[u32; 2]> {
        let mut found = Vec::new();
        let mut add = |a, b| found.push([self.cell(a), self.cell(b)]);
        for [x, y] in self.places() {
            let square = corners([x, y]);
            match square.iter().position(|&corner| !self.has(corner)) {
                Some(void) if self.filled([x, y]) == 3 => add(square[(void + 1) % 4], square[(void + 3) % 4]),
                _ => {}
            }
            // The raster's own border is no shore.
            let within =
                |[x, y]: [i64; 2]| x >= 0 && y >= 0 && x + 1 < self.cols() as i64 && y + 1 < self.rows() as i64;
            for (end, other) in [([x + 1, y], [x, y - 1]), ([x, y + 1], [x - 1, y])] {
                let is_edge = self.has([x, y]) && self.has(end) && within([x, y]) && within(other);
                if is_edge && (self.filled([x, y]) >= 3) != (self.filled(other) >= 3) {
                    add([x, y], end);
                }
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heights(rows: &[&str]) -> Heights {
        let z = rows.iter().flat_map(|row| row.bytes()).map(|c| if c == b'.' { f64::NAN } else { 1.0 });
        Heights::new(rows.len(), rows[0].len(), z.collect()).unwrap()
    }

    #[test]
    fn lines_of_cells_are_no_ground() {
        let heights = heights(&["##...", "##.##", ".....", "####.", "#.##."]);
        assert!(heights.is_ground([0, 1]) && heights.is_ground([3, 4]));
        assert!(!heights.is_ground([3, 1]) && !heights.is_ground([2, 1]));
        assert_eq!(heights.uncovered(), 2, "the two in the second row");
        assert!(heights.is_ground_step([1, 3], [0, 4]), "the border of a half");
        assert!(!heights.is_ground_step([3, 1], [4, 1]));
    }

    #[test]
    fn triangles_are_ground_by_where_they_begin() {
        let heights = heights(&["###", "##.", "###"]);
        assert!(heights.is_ground_triangle([[0, 0], [1, 0], [1, 1]]));
        assert!(heights.is_ground_triangle([[1, 1], [1, 0], [2, 0]]), "half a square");
        assert!(heights.is_ground_triangle([[2, 0], [1, 1], [1, 0]]), "half a square, from its border");
        assert!(!heights.is_ground_triangle([[2, 0], [2, 2], [1, 1]]), "the void");
        assert!(!heights.is_ground_triangle([[1, 1], [2, 0], [2, 2]]), "the void, from the other side");
    }
}
