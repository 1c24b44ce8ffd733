//! From patches to cells.

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

    /// Whether discs in squares of `side` cells every `step` cells leave no gaps, half a cell being lost where one of
    /// them is even and the other odd.
    pub fn covers(side: usize, step: usize) -> bool {
        let reach = step.saturating_add((step % 2) ^ (side % 2));
        step > 0 && reach <= side && 2 * reach * reach < side * side
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

/// The weight of a point at `x`, `y` cells from the centre of a disc: `(1 - r²)³` for the distance r in radii, 0 beyond.
#[inline(always)]
pub fn fall_off(x: f64, y: f64, radius: f64) -> f64 {
    let left = 1.0 - (x * x + y * y) / (radius * radius);
    if left > 0.0 { left * left * left } else { 0.0 }
}

/// The weights of a patch's cells, row by row: those of its disc, which touches the sides of its square.
pub fn weights(side: usize) -> Vec<f64> {
    let radius = side as f64 / 2.0;
    let centred = |i: usize| i as f64 + 0.5 - radius;
    (0..side * side).map(|k| fall_off(centred(k % side), centred(k / side), radius)).collect()
}

/// Adds patches up in a window of the cells of a level, whose columns and rows are every `stride`-th of the raster.
///
/// Patches have to come row by row: so the sums of each cell are added in one order, and the same patches give the same
/// cells for any window, to the bit, on any machine. Only `+ - * /` are used.
#[derive(Clone, Debug)]
pub struct Blend {
    lattice: Lattice,
    stride: usize,
    cols: Range<usize>,
    rows: Range<usize>,
    weights: Vec<f64>,
    sums: Vec<[f64; 2]>,
}

impl Blend {
    /// No patches yet, over these columns and rows of the level's cells.
    pub fn new(lattice: Lattice, stride: usize, cols: Range<usize>, rows: Range<usize>) -> Self {
        let sums = vec![[0.0; 2]; cols.len() * rows.len()];
        Self { lattice, stride, cols, rows, weights: weights(lattice.side), sums }
    }

    /// Columns and rows of the places whose patches reach into the window.
    pub fn places(&self) -> (Range<usize>, Range<usize>) {
        let whole = |cells: &Range<usize>| match cells.is_empty() {
            true => 0..0,
            false => cells.start * self.stride..(cells.end - 1) * self.stride + 1,
        };
        (self.lattice.columns(&whole(&self.cols)), self.lattice.rows(&whole(&self.rows)))
    }

    /// Calls for each cell of the window that has a weight in the patch at a place, with its sum, its number in the
    /// patch and the weight.
    fn visit(&mut self, (row, col): (usize, usize), mut cell: impl FnMut(&mut [f64; 2], usize, f64)) {
        let (side, stride) = (self.lattice.side as i64, self.stride as i64);
        let top = self.lattice.top + (row * self.lattice.step) as i64;
        let left = self.lattice.left + (col * self.lattice.step) as i64;
        // Cells of the level from the first that the square reaches to before the first beyond it.
        let within = |first: i64, cells: &Range<usize>| {
            let (from, to) = (cells.start as i64, cells.end as i64);
            let begin = (first + stride - 1).div_euclid(stride).max(from);
            begin..(first + side + stride - 1).div_euclid(stride).min(to).max(begin)
        };
        let (rows, cols) = (within(top, &self.rows), within(left, &self.cols));
        for y in rows {
            let begin = (y - self.rows.start as i64) as usize * self.cols.len();
            for x in cols.clone() {
                let k = ((y * stride - top) * side + (x * stride - left)) as usize;
                if self.weights[k] > 0.0 {
                    cell(&mut self.sums[begin + (x - self.cols.start as i64) as usize], k, self.weights[k]);
                }
            }
        }
    }

    /// Makes the cells that the patch at a place reaches void: it is there, but not known.
    pub fn spoil(&mut self, at: (usize, usize)) {
        self.visit(at, |sum, _, _| *sum = [f64::NAN; 2]);
    }

    /// Adds the patch at a place: its mean and the sum of its terms, weighted. `atoms` are the atoms' values.
    pub fn add(&mut self, at: (usize, usize), (mean, terms): (i32, &[Term]), atoms: &[i32], steps: &Steps) {
        let mean = f64::from(mean) * steps.mean;
        let size = self.weights.len();
        let parts: Vec<(&[i32], f64)> = terms
            .iter()
            .map(|term| (&atoms[term.atom as usize * size..][..size], f64::from(term.part) * steps.part))
            .collect();
        self.visit(at, |sum, k, weight| {
            let mut height = mean;
            for (atom, part) in &parts {
                height += part * (f64::from(atom[k]) * steps.atom);
            }
            sum[0] += weight * height;
            sum[1] += weight;
        });
    }

    /// The cells, row by row; NaN where there is no patch.
    pub fn cells(&self) -> impl Iterator<Item = f64> {
        self.sums.iter().map(|&[sum, weight]| if weight > 0.0 { sum / weight } else { f64::NAN })
    }
}

/// A cell as it is stored: the nearest single-precision number, or its neighbour where that has the bits of the nodata
/// value, as a cell that is known is no void.
pub fn blended(height: f64, nodata: Option<u32>) -> f32 {
    let cell = height as f32;
    if nodata == Some(cell.to_bits()) { f32::from_bits(cell.to_bits() ^ 1) } else { cell }
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
    fn windows_and_levels_are_parts_of_the_whole() {
        let lattice = Lattice::new(23, 17, 6, 3);
        let atoms: Vec<i32> = (0..72).map(|i| (i * 37 % 101) - 50).collect();
        let steps = Steps { mean: 0.25, part: 0.5, atom: 1.0 / 128.0 };
        let blend = |stride: usize, cols: Range<usize>, rows: Range<usize>, spoilt: Option<(usize, usize)>| {
            let mut blend = Blend::new(lattice, stride, cols, rows);
            for place in 0..lattice.across * lattice.down {
                let terms = [Term { atom: place as u32 % 2, part: place as i32 - 9 }];
                let at = (place / lattice.across, place % lattice.across);
                let (cols, rows) = blend.places();
                let before = blend.sums.clone();
                blend.add(at, (place as i32 * 3, &terms), &atoms, &steps);
                assert!(before == blend.sums || cols.contains(&at.1) && rows.contains(&at.0), "{at:?} reaches in");
            }
            spoilt.into_iter().for_each(|at| blend.spoil(at));
            blend.cells().map(f64::to_bits).collect::<Vec<_>>()
        };
        let whole = blend(1, 0..23, 0..17, None);
        assert!(whole.iter().all(|bits| f64::from_bits(*bits).is_finite()), "everything is covered");
        assert_eq!(blend(1, 5..11, 8..9, None), whole[8 * 23 + 5..8 * 23 + 11]);
        for stride in [2, 4, 8] {
            let (across, down) = (23_usize.div_ceil(stride), 17_usize.div_ceil(stride));
            let every: Vec<u64> =
                (0..down * across).map(|i| whole[i / across * stride * 23 + i % across * stride]).collect();
            assert_eq!(blend(stride, 0..across, 0..down, None), every);
        }
        let spoilt = blend(1, 0..23, 0..17, Some((2, 3)));
        assert_eq!(spoilt.iter().filter(|&&bits| f64::from_bits(bits).is_nan()).count(), 32, "the cells of a disc");
    }
}
