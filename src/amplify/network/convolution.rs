//! Sums over 3 x 3 cells, which is all that a network does but for cutting at zero.

use super::field::Field;
use crate::linalg::{OctetWork, Octets, in_octets};

/// Side of the squares that are summed over.
pub(super) const SIDE: usize = 3;
/// Cells that are summed at once, and numbers of a cell that weights are summed for at once: with three octets of each as
/// many sums as leave registers for what is added.
const GROUP: usize = 3;

/// How the numbers of 3 x 3 cells make up those of the one in the middle.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Convolution {
    /// Numbers of each cell that go in.
    pub(super) inputs: usize,
    /// Numbers of each cell that come out.
    pub(super) outputs: usize,
    /// Octets of numbers that come out, the last filled up with zeros.
    pub(super) octets: usize,
    /// For each of the nine cells, row by row, and each of its numbers: its part in all that comes out.
    pub(super) weights: Vec<f32>,
}

impl Convolution {
    /// With weights of zero.
    pub(super) fn new(inputs: usize, outputs: usize) -> Self {
        let octets = outputs.div_ceil(8);
        Self { inputs, outputs, octets, weights: vec![0.0; SIDE * SIDE * inputs * octets * 8] }
    }

    /// Numbers of a cell of the field that comes out.
    pub(super) fn depth(&self) -> usize {
        8 * self.octets
    }

    /// What comes out of three rows: of all cells but the outermost. Each sum takes its terms row by row.
    ///
    /// # Panics
    /// When a row is too short.
    pub(super) fn row(&self, rows: [&[f32]; SIDE], rectified: bool, out: &mut [f32]) {
        in_octets(Row { layer: self, rows, rectified, out });
    }

    /// What comes out of a field: of all cells but the outermost.
    pub(super) fn field(&self, field: &Field, rectified: bool) -> Field {
        let mut out = Field::zeros(field.rows - 2, field.cols - 2, self.depth());
        for row in 0..out.rows {
            self.row([0, 1, 2].map(|k| field.row(row + k)), rectified, out.row_mut(row));
        }
        out
    }

    /// The derivatives by the weights, where `slopes` are those by what came out of `field`.
    pub(super) fn weight_slopes(&self, field: &Field, slopes: &Field) -> Vec<f32> {
        let mut sums = vec![0.0; self.weights.len()];
        in_octets(WeightSlopes { layer: self, field, slopes, sums: &mut sums });
        sums
    }

    /// What turns derivatives by what came out, with two rows and columns of zeros at each side, into derivatives by what
    /// went in.
    pub(super) fn turned(&self) -> Self {
        let mut turned = Self::new(self.depth(), self.inputs);
        let (own, depth) = (self.depth(), turned.depth());
        for cell in 0..SIDE * SIDE {
            for (input, parts) in self.of_cell(cell).chunks_exact(own).enumerate() {
                let opposite = (SIDE * SIDE - 1 - cell) * own;
                for (output, &part) in parts.iter().enumerate() {
                    turned.weights[(opposite + output) * depth + input] = part;
                }
            }
        }
        turned
    }

    /// The weights of one of the nine cells.
    fn of_cell(&self, cell: usize) -> &[f32] {
        let size = self.inputs * self.depth();
        &self.weights[cell * size..][..size]
    }

    /// Octets of weights of one row of cells: [`Convolution::octets`] of them for each number that goes in.
    #[inline(always)]
    fn of_row(&self, row: usize) -> &[[f32; 8]] {
        let size = SIDE * self.inputs * self.octets;
        &self.weights.as_chunks::<8>().0[row * size..][..size]
    }
}

/// Work on some octets of all that comes out of a layer, whose sums have room in registers.
trait OctetsOfLayer {
    /// Octets of the layer.
    fn count(&self) -> usize;

    /// `OCTETS` octets of all cells, from the octet `first`; always to be inlined.
    fn work<S: Octets, const OCTETS: usize>(&mut self, octets: S, first: usize);
}

/// Works on all octets of a layer, three at once as long as there are so many.
#[inline(always)]
fn by_threes<S: Octets>(work: &mut impl OctetsOfLayer, octets: S) {
    for first in (0..work.count()).step_by(3) {
        match work.count() - first {
            1 => work.work::<S, 1>(octets, first),
            2 => work.work::<S, 2>(octets, first),
            _ => work.work::<S, 3>(octets, first),
        }
    }
}

/// The first octets of some. A loop, since `map` is a call that goes through memory where tests are built.
#[inline(always)]
fn loaded<S: Octets, const OCTETS: usize>(octets: S, values: &[[f32; 8]]) -> [S::Eight; OCTETS] {
    let values = &values[..OCTETS];
    let mut eights = [octets.splat(0.0); OCTETS];
    for (eight, values) in eights.iter_mut().zip(values) {
        *eight = octets.load(values);
    }
    eights
}

struct Row<'a> {
    layer: &'a Convolution,
    rows: [&'a [f32]; SIDE],
    rectified: bool,
    out: &'a mut [f32],
}

impl OctetWork for Row<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Octets>(mut self, octets: S) {
        by_threes(&mut self, octets);
    }
}

impl OctetsOfLayer for Row<'_> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.layer.octets
    }

    #[inline(always)]
    fn work<S: Octets, const OCTETS: usize>(&mut self, octets: S, first: usize) {
        let cols = self.out.len() / self.layer.depth();
        let mut col = 0;
        while col + GROUP <= cols {
            self.cells::<S, OCTETS, GROUP>(octets, first, col);
            col += GROUP;
        }
        while col < cols {
            self.cells::<S, OCTETS, 1>(octets, first, col);
            col += 1;
        }
    }
}

impl Row<'_> {
    #[inline(always)]
    fn cells<S: Octets, const OCTETS: usize, const CELLS: usize>(&mut self, octets: S, first: usize, col: usize) {
        let (inputs, stride) = (self.layer.inputs, self.layer.octets);
        let mut sums = [[octets.splat(0.0); OCTETS]; CELLS];
        for (number, row) in self.rows.iter().enumerate() {
            let span = SIDE * inputs;
            let row = &row[col * inputs..][..(CELLS - 1) * inputs + span];
            for (k, parts) in self.layer.of_row(number).chunks_exact(stride).enumerate() {
                let parts = loaded::<S, OCTETS>(octets, &parts[first..]);
                for (cell, sums) in sums.iter_mut().enumerate() {
                    let value = octets.splat(row[cell * inputs + k]);
                    for (sum, part) in sums.iter_mut().zip(parts) {
                        *sum = octets.times_plus(value, part, *sum);
                    }
                }
            }
        }
        let out = self.out.as_chunks_mut::<8>().0;
        for (cell, sums) in sums.iter().enumerate() {
            for (octet, &sum) in sums.iter().enumerate() {
                let sum = if self.rectified { octets.rectified(sum) } else { sum };
                octets.store(sum, &mut out[(col + cell) * stride + first + octet]);
            }
        }
    }
}

struct WeightSlopes<'a> {
    layer: &'a Convolution,
    field: &'a Field,
    slopes: &'a Field,
    sums: &'a mut [f32],
}

impl OctetWork for WeightSlopes<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Octets>(mut self, octets: S) {
        by_threes(&mut self, octets);
    }
}

impl OctetsOfLayer for WeightSlopes<'_> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.layer.octets
    }

    #[inline(always)]
    fn work<S: Octets, const OCTETS: usize>(&mut self, octets: S, first: usize) {
        let span = SIDE * self.layer.inputs;
        for line in 0..SIDE {
            let mut k = 0;
            while k + GROUP <= span {
                self.weights::<S, OCTETS, GROUP>(octets, first, line, k);
                k += GROUP;
            }
            while k < span {
                self.weights::<S, OCTETS, 1>(octets, first, line, k);
                k += 1;
            }
        }
    }
}

impl WeightSlopes<'_> {
    /// Sums over all cells, row by row, for some of the numbers of a row of three cells.
    #[inline(always)]
    fn weights<S: Octets, const OCTETS: usize, const COUNT: usize>(
        &mut self,
        octets: S,
        first: usize,
        line: usize,
        k: usize,
    ) {
        let (inputs, stride) = (self.layer.inputs, self.layer.octets);
        let mut sums = [[octets.splat(0.0); OCTETS]; COUNT];
        for row in 0..self.slopes.rows {
            let values = &self.field.row(row + line)[k..];
            let slopes = self.slopes.row(row).as_chunks::<8>().0.chunks_exact(stride);
            for (slopes, values) in slopes.zip(values.windows(COUNT).step_by(inputs)) {
                let slopes = loaded::<S, OCTETS>(octets, &slopes[first..]);
                for (sums, &value) in sums.iter_mut().zip(values) {
                    let value = octets.splat(value);
                    for (sum, slope) in sums.iter_mut().zip(slopes) {
                        *sum = octets.times_plus(value, slope, *sum);
                    }
                }
            }
        }
        let out = self.sums.as_chunks_mut::<8>().0;
        for (number, sums) in sums.iter().enumerate() {
            for (octet, &sum) in sums.iter().enumerate() {
                octets.store(sum, &mut out[(line * SIDE * inputs + k + number) * stride + first + octet]);
            }
        }
    }
}
