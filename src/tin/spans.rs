//! Which cells lie in a triangle: exact, in whole numbers.

/// Calls `each` with the row and the first and last column of the cell centres in a triangle, its edges included, for
/// every row that has some, downwards.
///
/// Coordinates are multiples of a cell's `1 << BITS`th part and at most 2^30 of them from 0; `(cols, rows)` bounds the
/// cells. A triangle without an area has no cells.
#[inline]
pub(super) fn each_span<const BITS: u32>(
    mut corners: [[i64; 2]; 3],
    (cols, rows): (i64, i64),
    mut each: impl FnMut(i64, i64, i64),
) {
    corners.sort_unstable_by_key(|corner| corner[1]);
    let [a, b, c] = corners;
    // Positive where the middle corner lies on the right of the long edge.
    let side = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    if side == 0 {
        return;
    }
    let unit = 1_i64 << BITS;
    let first_row = up::<BITS>(a[1]).max(0);
    let last_row = (c[1] >> BITS).min(rows - 1);
    let mut edges = Edges { long: Edge::new(a, c), upper: Edge::new(a, b), lower: Edge::new(b, c), middle: b[1] };
    for row in first_row..=last_row {
        let (long, short) = edges.at(row * unit);
        let (left, right) = if side > 0 { (long, short) } else { (short, long) };
        let first = left.ceil::<BITS>().max(0);
        let last = right.floor::<BITS>().min(cols - 1);
        if first <= last {
            each(row, first, last);
        }
    }
}

/// The least whole number of cells that is not below a coordinate.
#[inline]
fn up<const BITS: u32>(v: i64) -> i64 {
    -((-v) >> BITS)
}

struct Edges {
    long: Edge,
    upper: Edge,
    lower: Edge,
    middle: i64,
}

impl Edges {
    /// Where the long edge and one of the short ones cross a height.
    #[inline]
    fn at(&mut self, y: i64) -> (Crossing, Crossing) {
        // An upper edge that is level ends where the lower one begins.
        let short = if y < self.middle { &self.upper } else { &self.lower };
        (self.long.at(y), if short.dy == 0 { self.upper.at_end(y) } else { short.at(y) })
    }
}

/// An edge from a higher end (less y) to a lower one.
#[derive(Clone, Copy)]
struct Edge {
    x: i64,
    y: i64,
    dx: i64,
    dy: i64,
}

impl Edge {
    #[inline]
    fn new(a: [i64; 2], b: [i64; 2]) -> Self {
        Self { x: a[0], y: a[1], dx: b[0] - a[0], dy: b[1] - a[1] }
    }

    #[inline]
    fn at(&self, y: i64) -> Crossing {
        Crossing { x: self.x, over: (y - self.y) * self.dx, dy: self.dy }
    }

    /// The crossing at the lower end.
    #[inline]
    fn at_end(&self, y: i64) -> Crossing {
        debug_assert_eq!(y, self.y + self.dy, "the end's own height");
        Crossing { x: self.x + self.dx, over: 0, dy: 1 }
    }
}

/// The place `x + over / dy`.
struct Crossing {
    x: i64,
    over: i64,
    dy: i64,
}

impl Crossing {
    /// The last cell that is not on its right.
    #[inline]
    fn floor<const BITS: u32>(&self) -> i64 {
        // Rounding down twice is rounding down once.
        (self.x + self.over.div_euclid(self.dy)) >> BITS
    }

    /// The first cell that is not on its left.
    #[inline]
    fn ceil<const BITS: u32>(&self) -> i64 {
        up::<BITS>(self.x - (-self.over).div_euclid(self.dy))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    fn corner() -> impl Strategy<Value = [i64; 2]> {
        [-20..60_i64, -20..60_i64]
    }

    fn same_as_three_half_planes<const BITS: u32>(corners: [[i64; 2]; 3]) {
        let unit = 1_i64 << BITS;
        let size = (40 / unit + 2, 44 / unit + 2);
        let mut found = BTreeSet::new();
        each_span::<BITS>(corners, size, |row, first, last| {
            found.extend((first..=last).map(|col| (row, col)));
        });
        let side = |a: [i64; 2], b: [i64; 2], p: [i64; 2]| {
            ((b[0] - a[0]) * (p[1] - a[1]) - (p[0] - a[0]) * (b[1] - a[1])).signum()
        };
        let [a, b, c] = corners;
        let turn = side(a, b, c);
        let inside = |p| turn != 0 && [(a, b), (b, c), (c, a)].iter().all(|&(q, r)| side(q, r, p) * turn >= 0);
        let wanted: BTreeSet<(i64, i64)> = (0..size.1)
            .flat_map(|row| (0..size.0).map(move |col| (row, col)))
            .filter(|&(row, col)| inside([col * unit, row * unit]))
            .collect();
        assert_eq!(found, wanted, "{corners:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

        #[test]
        fn spans_are_the_cells_on_the_right_side_of_all_edges(corners in [corner(), corner(), corner()]) {
            same_as_three_half_planes::<0>(corners);
            same_as_three_half_planes::<2>(corners);
        }
    }
}
