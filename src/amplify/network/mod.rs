//! A small convolutional network that says what fine cells have above bicubic heights (Shi et al. 2016, Real-time single
//! image and video super-resolution using an efficient sub-pixel convolutional neural network, doi:10.1109/CVPR.2016.207:
//! all layers lie on the coarse cells, and the last has one number for each fine cell of a coarse one).
//!
//! It sees differences of heights, and no layer adds a constant. So how high terrain lies is
//! no matter to it, terrain that is so many times as steep gets so many times the detail, and what is level stays so. The
//! exemplars of a job are all it has learned from.

mod convolution;
mod field;
mod ground;
mod learn;
#[cfg(test)]
mod tests;

use super::back_projection::{BackProjection, CORRECTION_MARGIN};
use super::bicubic::{Bicubic, MARGIN};
use super::extend::widened;
use super::orientation::Way;
use super::plane::Plane;
use super::step::trimmed_mask;
use convolution::{Convolution, SIDE};
use field::Field;

/// Numbers of a cell between layers.
const CHANNELS: usize = 24;
/// Layers.
const LAYERS: usize = 5;
/// What goes in: how much the cells to the right and below are higher.
const RISES: usize = 2;
/// Coarse cells at each side of those whose fine cells are estimated: one a layer, and one for the differences.
const REACH: usize = LAYERS + 1;
/// The same, for what lays more on the estimates.
pub(super) const NETWORK_ESTIMATE_MARGIN: usize = REACH;
/// Coarse cells at each side that are needed beyond those that are made finer.
pub(super) const NETWORK_REACH: usize = REACH + CORRECTION_MARGIN;
/// Factors that there are networks of.
pub(super) const NETWORK_FACTORS: [usize; 5] = [7, 5, 4, 3, 2];

/// What was learned for one factor at one scale.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Network {
    pub(super) factor: usize,
    pub(super) is_square: bool,
    layers: Vec<Convolution>,
}

impl Network {
    /// Without any weights: its estimates are bicubic.
    fn new(factor: usize, is_square: bool) -> Self {
        let depths: Vec<usize> = [RISES].into_iter().chain([CHANNELS; LAYERS - 1]).chain([factor * factor]).collect();
        Self { factor, is_square, layers: depths.windows(2).map(|pair| Convolution::new(pair[0], pair[1])).collect() }
    }

    /// With weights as [`Network::tables`] gives them; nothing where there are others than it would give.
    pub(super) fn of_tables(factor: usize, is_square: bool, tables: &[Vec<f32>]) -> Option<Self> {
        let mut network = Self::new(factor, is_square);
        for (layer, table) in network.layers.iter_mut().zip(tables) {
            let (outputs, depth) = (layer.outputs, layer.depth());
            if table.len() != SIDE * SIDE * layer.inputs * outputs {
                return None;
            }
            for (parts, own) in layer.weights.chunks_exact_mut(depth).zip(table.chunks_exact(outputs)) {
                parts[..outputs].copy_from_slice(own);
            }
        }
        (tables.len() == LAYERS).then_some(network)
    }

    /// Layer by layer the numbers that come out of it, and for each of nine cells and each number that goes in its part in
    /// these.
    pub(super) fn tables(&self) -> impl Iterator<Item = (usize, Vec<f32>)> {
        self.layers.iter().map(|layer| {
            let parts = layer.weights.chunks_exact(layer.depth()).flat_map(|parts| &parts[..layer.outputs]);
            (layer.outputs, parts.copied().collect())
        })
    }

    /// Rows and columns of each table for a factor.
    pub(super) fn table_sizes(factor: usize) -> Vec<[usize; 2]> {
        let layers = Self::new(factor, true).layers;
        layers.iter().map(|layer| [SIDE * SIDE * layer.inputs, layer.outputs]).collect()
    }

    /// Numbers that were learned.
    pub(super) fn len(&self) -> usize {
        self.layers.iter().map(|layer| layer.weights.len()).sum()
    }

    /// The finer plane of all but [`NETWORK_REACH`] coarse cells at each side. Its means are the coarse heights where
    /// these are `known`.
    ///
    /// # Panics
    /// When the plane is not larger than its margins.
    pub(super) fn applied(&self, coarse: &Plane, known: &[bool]) -> Plane {
        let fine = self.estimated(coarse, 1.0);
        let known = trimmed_mask(known, coarse.cols(), REACH);
        BackProjection::new(self.factor).corrected(&fine, &coarse.trimmed(REACH), &known)
    }

    /// The finer plane of a whole raster, which goes on beyond its edges.
    pub(super) fn applied_whole(&self, coarse: &Plane, known: &[bool]) -> Plane {
        let (wide, known) = widened(coarse, known, NETWORK_REACH);
        self.applied(&wide, &known)
    }

    /// Bicubic heights and so many times what the network says of the fine cells, of all but [`REACH`] coarse cells at each
    /// side.
    ///
    /// The network looks at the terrain in four ways, and the mean of what it says is taken (Lim et al. 2017, Enhanced
    /// deep residual networks for single image super-resolution, doi:10.1109/CVPRW.2017.151, section 3.3): it has learned
    /// to say about the same in all of them, and errs in each in another way.
    pub(super) fn estimated(&self, coarse: &Plane, times: f64) -> Plane {
        let (factor, depth) = (self.factor, self.depth());
        let mut fine = Bicubic::new(factor).enlarged(coarse).trimmed((REACH - MARGIN) * factor);
        let cols = fine.cols();
        let ways = Way::four(self.is_square);
        let part = times / ways.len() as f64;
        for way in ways {
            let turned = way.turned(coarse);
            let size = [turned.rows() - 2 * REACH, turned.cols() - 2 * REACH].map(|side| side * factor);
            // From one fine cell of the turned plane to the next there are as many cells of the plane as it lies.
            let at = |row: usize, col: usize| {
                let (row, col) = way.place(row, col, size);
                row * cols + col
            };
            let step = if size[1] > 1 { at(0, 1) as isize - at(0, 0) as isize } else { 0 };
            self.details(&turned, |row, details| {
                for line in 0..factor {
                    let mut cell = at(row * factor + line, 0) as isize;
                    for detail in details.chunks_exact(depth) {
                        for &detail in &detail[line * factor..][..factor] {
                            fine.heights_mut()[cell as usize] += f64::from(detail) * part;
                            cell += step;
                        }
                    }
                }
            });
        }
        fine
    }

    /// Numbers that come out for each coarse cell.
    fn depth(&self) -> usize {
        self.layers[LAYERS - 1].depth()
    }

    /// Tells what comes out, row by row of coarse cells without [`REACH`] at each side. All layers go down the rows
    /// together, so that what lies between them stays small.
    fn details(&self, coarse: &Plane, mut tell: impl FnMut(usize, &[f32])) {
        let cols = coarse.cols() - 2;
        let width = |layer: usize| (cols - 2 * layer) * if layer == 0 { RISES } else { CHANNELS };
        // The last three rows before each layer, and how many there were.
        let mut rows: Vec<[Vec<f32>; SIDE]> =
            (0..LAYERS).map(|layer| std::array::from_fn(|_| vec![0.0; width(layer)])).collect();
        let mut seen = [0; LAYERS];
        let mut out = vec![0.0; (cols - 2 * LAYERS) * self.depth()];
        let mut told = 0;
        for row in 1..coarse.rows() - 1 {
            rises([coarse.row(row), coarse.row(row + 1)].map(|row| &row[1..]), &mut rows[0][seen[0] % SIDE]);
            seen[0] += 1;
            for (number, layer) in self.layers.iter().enumerate() {
                if seen[number] < SIDE {
                    break;
                }
                let (before, after) = rows.split_at_mut(number + 1);
                let last = [0, 1, 2].map(|k| before[number][(seen[number] + k) % SIDE].as_slice());
                match after.first_mut() {
                    Some(after) => {
                        layer.row(last, true, &mut after[seen[number + 1] % SIDE]);
                        seen[number + 1] += 1;
                    }
                    None => {
                        layer.row(last, false, &mut out);
                        tell(told, &out);
                        told += 1;
                    }
                }
            }
        }
    }

    /// What the network says of a field of [`rises`], and the fields before each layer.
    fn traced(&self, input: Field) -> (Field, Vec<Field>) {
        let mut before = vec![input];
        for (number, layer) in self.layers.iter().enumerate() {
            before.push(layer.field(&before[number], number + 1 < LAYERS));
        }
        let out = before.pop().expect("there are layers");
        (out, before)
    }

    /// Derivatives by all weights, layer by layer, where `slopes` are those by what came out.
    fn weight_slopes(&self, before: &[Field], mut slopes: Field) -> Vec<f32> {
        let mut found = vec![vec![]; LAYERS];
        for (number, layer) in self.layers.iter().enumerate().rev() {
            found[number] = layer.weight_slopes(&before[number], &slopes);
            if number > 0 {
                slopes = layer.turned().field(&slopes.widened(2), false);
                for (slope, &value) in slopes.values.iter_mut().zip(&before[number].values) {
                    *slope = if value > 0.0 { *slope } else { 0.0 };
                }
            }
        }
        found.concat()
    }

    /// All weights, layer by layer, to be changed.
    fn weights_mut(&mut self) -> impl Iterator<Item = &mut f32> {
        self.layers.iter_mut().flat_map(|layer| &mut layer.weights)
    }
}

/// How much the cells to the right and below are higher, for the cells of a row but the last.
fn rises([row, below]: [&[f64]; 2], out: &mut [f32]) {
    for ((rises, pair), below) in out.chunks_exact_mut(RISES).zip(row.windows(2)).zip(below) {
        rises[0] = (pair[1] - pair[0]) as f32;
        rises[1] = (below - pair[0]) as f32;
    }
}
