//! From patches to cells.

use super::patches::PatchTile;
use super::terms::Term;
use std::ops::Range;

/// What a whole number of each kind stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    /// Of means, in stored values.
    pub mean: f64,
    /// Of coefficients, in stored values.
    pub part: f64,
    /// Of an atom's values.
    pub atom: f64,
}

/// Where patches lie: places for them every `step` cells, each a square of `side` cells that reaches beyond its
/// neighbours' and beyond the raster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lattice {
    /// Side of a patch in cells.
    pub side: usize,
    /// From one place to the next in cells.
    pub step: usize,
    /// Row of the first row of cells of the first place's square, which may lie before the raster.
    pub top: i64,
    /// Column of its first column.
    pub left: i64,
    /// Columns of places.
    pub across: usize,
    /// Rows of places.
    pub down: usize,
}

impl Lattice {
    /// The lattice of patches of `side` cells every `step` cells over a raster: leftover cells are shared by the
    /// first and the last place.
    pub fn new(width: usize, height: usize, side: usize, step: usize) -> Self {
        let (across, down) = (width.div_ceil(step), height.div_ceil(step));
        let reach = (step as i64 - side as i64).div_euclid(2);
        let first = |count: usize, cells: usize| reach - ((count * step - cells) / 2) as i64;
        Self { side, step, top: first(down, height), left: first(across, width), across, down }
    }

    /// The places whose patches are stored with the tile that holds these cells of a row or column: those whose
    /// number times the step is one of them.
    pub fn stored_with(&self, cells: Range<usize>) -> Range<usize> {
        cells.start.div_ceil(self.step)..cells.end.div_ceil(self.step)
    }

    /// The columns of places whose patches reach into columns of cells.
    pub fn columns(&self, cells: &Range<usize>) -> Range<usize> {
        self.reaching(cells, self.left, self.across)
    }

    /// The rows of places whose patches reach into rows of cells.
    pub fn rows(&self, cells: &Range<usize>) -> Range<usize> {
        self.reaching(cells, self.top, self.down)
    }

    fn reaching(&self, cells: &Range<usize>, first: i64, count: usize) -> Range<usize> {
        let (step, side) = (self.step as i64, self.side as i64);
        // The first that ends after the first cell, and the first that begins at or after the end.
        let begin = (cells.start as i64 - first - side).div_euclid(step) + 1;
        let end = (cells.end as i64 - 1 - first).div_euclid(step) + 1;
        begin.clamp(0, count as i64) as usize..end.clamp(0, count as i64) as usize
    }
}

/// The weights of a patch's cells: `(1 - r²)³` for the distance r from the patch's centre in half sides, 0 beyond.
fn weights(side: usize) -> Vec<f64> {
    let radius = side as f64 / 2.0;
    let square = radius * radius;
    let centred = |i: usize| i as f64 + 0.5 - radius;
    let weight = |k: usize| {
        let (x, y) = (centred(k % side), centred(k / side));
        let left = 1.0 - (x * x + y * y) / square;
        if left > 0.0 { left * left * left } else { 0.0 }
    };
    (0..side * side).map(weight).collect()
}

/// Adds patches up in a window of cells.
///
/// Patches have to come row by row: so the sums of each cell are added in one order, and the same patches give the same
/// cells for any window, to the bit, on any machine. Only `+ - * /` are used.
#[derive(Clone, Debug)]
pub struct Blend {
    lattice: Lattice,
    cols: Range<usize>,
    rows: Range<usize>,
    weights: Vec<f64>,
    sums: Vec<[f64; 2]>,
}

impl Blend {
    /// No patches yet, over these columns and rows of cells.
    pub fn new(lattice: Lattice, cols: Range<usize>, rows: Range<usize>) -> Self {
        let sums = vec![[0.0; 2]; cols.len() * rows.len()];
        Self { lattice, cols, rows, weights: weights(lattice.side), sums }
    }

    /// Adds the patch at a place: its mean and the sum of its terms, weighted. `atoms` are the atoms' values.
    pub fn add(&mut self, (row, col): (usize, usize), (mean, terms): (i32, &[Term]), atoms: &[i32], steps: &Steps) {
        let side = self.lattice.side as i64;
        let top = self.lattice.top + (row * self.lattice.step) as i64;
        let left = self.lattice.left + (col * self.lattice.step) as i64;
        let overlap = |first: i64, cells: &Range<usize>| {
            first.max(cells.start as i64)..(first + side).min(cells.end as i64).max(first.max(cells.start as i64))
        };
        let (rows, cols) = (overlap(top, &self.rows), overlap(left, &self.cols));
        let mean = f64::from(mean) * steps.mean;
        let size = self.weights.len();
        let parts: Vec<(&[i32], f64)> = terms
            .iter()
            .map(|term| (&atoms[term.atom as usize * size..][..size], f64::from(term.part) * steps.part))
            .collect();
        for y in rows {
            let begin = (y - self.rows.start as i64) as usize * self.cols.len();
            for x in cols.clone() {
                let k = ((y - top) * side + (x - left)) as usize;
                let weight = self.weights[k];
                if weight > 0.0 {
                    let mut height = mean;
                    for (atom, part) in &parts {
                        height += part * (f64::from(atom[k]) * steps.atom);
                    }
                    let sum = &mut self.sums[begin + (x - self.cols.start as i64) as usize];
                    sum[0] += weight * height;
                    sum[1] += weight;
                }
            }
        }
    }

    /// Adds the patches of a tile that reach into the window; `first` is the row and column of its first place.
    pub fn add_tile(&mut self, tile: &PatchTile, first: (usize, usize), atoms: &[i32], steps: &Steps) {
        let (rows, cols) = (self.lattice.rows(&self.rows), self.lattice.columns(&self.cols));
        for (place, patch) in tile.patches().enumerate() {
            let at = (first.0 + place / tile.across, first.1 + place % tile.across);
            if let Some(patch) = patch.filter(|_| rows.contains(&at.0) && cols.contains(&at.1)) {
                self.add(at, patch, atoms, steps);
            }
        }
    }

    /// The cells, row by row; NaN where there is no patch.
    pub fn cells(&self) -> impl Iterator<Item = f64> {
        self.sums.iter().map(|&[sum, weight]| if weight > 0.0 { sum / weight } else { f64::NAN })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn windows_have_the_places_that_reach_into_them(
            width in 1usize..40, side in 1usize..12, step in 1usize..9, from in 0usize..40, length in 1usize..40,
        ) {
            let lattice = Lattice::new(width, width, side, step);
            let cells = from.min(width - 1)..(from.min(width - 1) + length).min(width);
            let found = lattice.columns(&cells);
            for place in 0..lattice.across {
                let first = lattice.left + (place * step) as i64;
                let reaches = first < cells.end as i64 && first + side as i64 > cells.start as i64;
                prop_assert_eq!(found.contains(&place), reaches, "place {}", place);
            }
        }

        #[test]
        fn every_place_is_stored_with_one_tile(width in 1usize..300, step in 1usize..200) {
            let lattice = Lattice::new(width, width, step, step);
            let tiles = (0..width.div_ceil(64)).map(|tile| tile * 64..width.min((tile + 1) * 64));
            let places: Vec<usize> = tiles.flat_map(|cells| lattice.stored_with(cells)).collect();
            prop_assert_eq!(places, (0..lattice.across).collect::<Vec<_>>());
        }
    }

    #[test]
    fn windows_are_parts_of_the_whole() {
        let lattice = Lattice::new(23, 17, 6, 3);
        let atoms: Vec<i32> = (0..72).map(|i| (i * 37 % 101) - 50).collect();
        let steps = Steps { mean: 0.25, part: 0.5, atom: 1.0 / 128.0 };
        let blend = |cols: Range<usize>, rows: Range<usize>| {
            let mut blend = Blend::new(lattice, cols, rows);
            for place in 0..lattice.across * lattice.down {
                let terms = [Term { atom: place as u32 % 2, part: place as i32 - 9 }];
                let at = (place / lattice.across, place % lattice.across);
                blend.add(at, (place as i32 * 3, &terms), &atoms, &steps);
            }
            blend.cells().map(f64::to_bits).collect::<Vec<_>>()
        };
        let whole = blend(0..23, 0..17);
        assert!(whole.iter().all(|bits| f64::from_bits(*bits).is_finite()), "everything is covered");
        let part = blend(5..11, 8..9);
        assert_eq!(part, whole[8 * 23 + 5..8 * 23 + 11]);
    }
}
