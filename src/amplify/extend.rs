//! Terrain beyond a raster's edges, so that methods need to know of none.

use super::plane::Plane;

/// A rectangle of a raster that goes on beyond its edges as if it were turned about its outermost cells by half a turn:
/// slopes go on as slopes. `window` is a part of the raster whose first row and column are `corner`; the raster has
/// `size` rows and columns. `wanted` is the first row, the first column, rows and columns of the rectangle, counted from
/// the raster's corner, which may begin before it.
///
/// The window has to hold the part of the rectangle that lies in the raster, and as much inside of an edge as is wanted
/// outside of it.
///
/// # Panics
/// When it does not.
pub fn extended(window: &Plane, corner: [usize; 2], size: [usize; 2], wanted: [i64; 4]) -> Plane {
    let [row, col, rows, cols] = wanted;
    let lines: Vec<Mirror> = (row..row + rows).map(|row| Mirror::of(row, size[0], corner[0])).collect();
    let places: Vec<Mirror> = (col..col + cols).map(|col| Mirror::of(col, size[1], corner[1])).collect();
    let mut heights = Vec::with_capacity(lines.len() * places.len());
    for line in &lines {
        let across = |row: usize, place: &Mirror| place.value(|col| window.row(row)[col]);
        heights.extend(places.iter().map(|place| line.value(|row| across(row, place))));
    }
    Plane::new(lines.len(), places.len(), heights)
}

/// A whole raster with so many cells more at each side, and which of them are known.
pub(super) fn widened(plane: &Plane, known: &[bool], margin: usize) -> (Plane, Vec<bool>) {
    let size = [plane.rows(), plane.cols()];
    let [rows, cols] = size.map(|side| (side + 2 * margin) as i64);
    let wanted = [-(margin as i64), -(margin as i64), rows, cols];
    (extended(plane, [0, 0], size, wanted), extended_mask(known, size[1], [0, 0], size, wanted))
}

/// Which cells of a window make up a cell in or beyond the raster, along one axis.
#[derive(Clone, Copy, Debug)]
enum Mirror {
    /// It is one of them.
    Own(usize),
    /// Twice the first less the second.
    Turned(usize, usize),
    /// So many times the rise from the first cell to the last, added to a cell, or to what is turned.
    Far { ends: [usize; 2], rise: f64, cell: usize, turned: bool },
}

impl Mirror {
    fn of(at: i64, count: usize, corner: usize) -> Self {
        let own = |cell: i64| cell as usize - corner;
        let last = count as i64 - 1;
        let period = 2 * last;
        match at {
            _ if (0..=last).contains(&at) => Self::Own(own(at)),
            _ if last == 0 => Self::Own(own(0)),
            _ if at < 0 && -at <= last => Self::Turned(own(0), own(-at)),
            _ if at > last && at <= period => Self::Turned(own(last), own(period - at)),
            _ => {
                let within = at.rem_euclid(period);
                let turned = within > last;
                Self::Far {
                    ends: [own(0), own(last)],
                    rise: 2.0 * at.div_euclid(period) as f64,
                    cell: own(if turned { period - within } else { within }),
                    turned,
                }
            }
        }
    }

    fn value(&self, height: impl Fn(usize) -> f64) -> f64 {
        match *self {
            Self::Own(cell) => height(cell),
            Self::Turned(edge, cell) => 2.0 * height(edge) - height(cell),
            Self::Far { ends: [first, last], rise, cell, turned } => {
                let own = if turned { 2.0 * height(last) - height(cell) } else { height(cell) };
                own + rise * (height(last) - height(first))
            }
        }
    }

    /// The cell that it is known from.
    fn source(&self) -> usize {
        match *self {
            Self::Own(cell) | Self::Turned(_, cell) | Self::Far { cell, .. } => cell,
        }
    }
}

/// Which cells of such a rectangle are known: those whose mirror images in the raster are.
///
/// # Panics
/// As [`extended`].
pub fn extended_mask(known: &[bool], cols: usize, corner: [usize; 2], size: [usize; 2], wanted: [i64; 4]) -> Vec<bool> {
    let [row, col, rows, columns] = wanted;
    let places: Vec<usize> = (col..col + columns).map(|col| Mirror::of(col, size[1], corner[1]).source()).collect();
    let lines = (row..row + rows).map(|row| Mirror::of(row, size[0], corner[0]).source());
    lines.flat_map(|line| places.iter().map(move |place| known[line * cols + place])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The definition, one half turn after the other.
    fn turned(cells: &[f64], at: i64) -> f64 {
        let last = cells.len() as i64 - 1;
        if last == 0 {
            cells[0]
        } else if at < 0 {
            2.0 * cells[0] - turned(cells, -at)
        } else if at > last {
            2.0 * cells[last as usize] - turned(cells, 2 * last - at)
        } else {
            cells[at as usize]
        }
    }

    proptest! {
        #[test]
        fn edges_are_turned_about(cells in prop::collection::vec(0.0f64..100.0, 1..6), at in -20i64..20) {
            let window = Plane::new(1, cells.len(), cells.clone());
            let found = extended(&window, [0, 0], [1, cells.len()], [0, at, 1, 1]);
            prop_assert!((found.heights_m()[0] - turned(&cells, at)).abs() < 1e-9);
            let upright = extended(&window.transposed(), [0, 0], [cells.len(), 1], [at, 0, 1, 1]);
            prop_assert_eq!(upright, found);
        }

        #[test]
        fn a_window_is_enough(
            heights in prop::collection::vec(0.0f64..100.0, 99),
            row in 0usize..9,
            col in 0usize..11,
            halo in 0usize..8,
        ) {
            let whole = Plane::new(9, 11, heights);
            let wanted = [row as i64 - halo as i64, col as i64 - halo as i64, 2 * halo as i64 + 1, 2 * halo as i64 + 1];
            let known = extended(&whole, [0, 0], [9, 11], wanted);
            let (top, left) = (row.saturating_sub(halo), col.saturating_sub(halo));
            let (bottom, right) = ((row + halo + 1).min(9), (col + halo + 1).min(11));
            let window = whole.part(top, left, bottom - top, right - left);
            prop_assert_eq!(extended(&window, [top, left], [9, 11], wanted), known);
            let mask: Vec<bool> = whole.heights_m().iter().map(|height| *height > 50.0).collect();
            let part: Vec<bool> = window.heights_m().iter().map(|height| *height > 50.0).collect();
            prop_assert_eq!(
                extended_mask(&part, window.cols(), [top, left], [9, 11], wanted),
                extended_mask(&mask, 11, [0, 0], [9, 11], wanted)
            );
        }
    }
}
