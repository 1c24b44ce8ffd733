//! Fits a pass to its terrain: filters by weighted least squares, weights of errors by least squares without
//! negative weights. Only encoders do this; sums run in a fixed order, so every machine finds the same numbers.

use super::params::{ERROR_WEIGHTS, MAX_CODE, PassParams, WEIGHT_LIMIT, weight_of};
use super::pass::FRACTION;
use super::plane::Plane;
use super::taps::{Known, MAX_TAPS, Pass, SERIAL_TAPS};
use super::word::Word;
use super::zones::LevelZones;

/// Cells that a fit of a zone looks at, about.
const SAMPLES: usize = 6000;
/// Samples whose products are summed in single precision.
const BLOCK: usize = 64;

/// Taps of a sample, filled up to whole vectors.
const ROW: usize = MAX_TAPS.next_multiple_of(8);

/// The weighted normal equations; of the matrix the lower triangle.
struct Sums {
    matrix: [[f64; MAX_TAPS]; MAX_TAPS],
    right: [f64; MAX_TAPS],
    weight: f64,
}

/// One cell to learn from: its taps less their base, and the cell itself less it.
struct Sample {
    taps: [f32; ROW],
    target: f32,
    /// Expected spread of the target, squared and inverted.
    weight: f32,
    class: u8,
}

/// Cells of a pass, or of a zone of it, with all their taps.
pub(super) struct Samples {
    samples: Vec<Sample>,
    taps: usize,
    /// Taps without the serial ones.
    plain_taps: usize,
    /// Variance of the quantiser's noise.
    noise: f64,
    own: [bool; MAX_TAPS],
}

impl Samples {
    /// Gathers every so-many-th cell of a pass whose taps are no voids, zone by zone; `original` is the plane to be
    /// coded.
    pub(super) fn gather<W: Word>(
        pass: Pass,
        original: &Plane<W>,
        cells: Known<'_, W>,
        void: Option<&Plane<u8>>,
        step: i64,
        serial: bool,
        zones: Option<LevelZones<'_>>,
    ) -> Vec<Self> {
        let zone_count = zones.map_or(1, |zones| zones.count());
        let taps = pass.tap_count() - if serial { 0 } else { SERIAL_TAPS };
        let (width, height) = (original.width, original.height);
        let mut samples: Vec<Vec<Sample>> = (0..zone_count).map(|_| Vec::new()).collect();
        let floor = 0.3 * step as f32;
        // Whole runs of cells in some rows: a stride that shares no factor with the width would be slower to read.
        let stride = (width * height / (SAMPLES * zone_count)).max(1);
        let (row_stride, col_stride) = match stride {
            0..3 => (1, stride),
            _ => (stride.isqrt().max(1), stride.div_ceil(stride.isqrt().max(1))),
        };
        let mut phase = 0;
        for row in (2..height).step_by(row_stride) {
            let runs: Vec<&[W]> = pass.taps().iter().map(|&tap| cells.run(original, tap, row, width)).collect();
            let line = original.row(row);
            phase = (phase + 1) % col_stride;
            for col in (2 + phase..width.saturating_sub(1)).step_by(col_stride) {
                let hole = |r: usize, c: usize| void.is_some_and(|void| void.row(r)[c] != 0);
                if hole(row, col) || hole(row - 1, col) || hole(row - 2, col) || hole(row, col - 1) {
                    continue;
                }
                let near: [i64; 4] = std::array::from_fn(|k| runs[k][col].wide());
                let above = |k: usize| near[k].wrapping_sub(near[0]);
                let base = near[0].wrapping_add(above(1).wrapping_add(above(2)).wrapping_add(above(3)) >> 2);
                let relative = |value: W| value.wide().wrapping_sub(base) as f32;
                let mut sample = Sample { taps: [0.0; ROW], target: relative(line[col]), weight: 0.0, class: 0 };
                for (tap, run) in sample.taps.iter_mut().zip(&runs) {
                    *tap = relative(run[col]);
                }
                if serial {
                    sample.taps[taps - 2] = relative(line[col - 1]);
                    sample.taps[taps - 1] = relative(line[col - 2]);
                }
                let t = &sample.taps;
                let spread = (t[0].abs() + t[1].abs() + (t[2].abs() + t[3].abs())) * 0.25;
                let (one, other) = match pass {
                    Pass::C => (t[0] - t[3], t[1] - t[2]),
                    _ => (t[0] - t[1], t[2] - t[3]),
                };
                sample.class = u8::from(one.abs() + other.abs() > 2.0 * step as f32);
                let expected = 0.2 * spread + floor;
                sample.weight = 1.0 / (expected * expected);
                samples[zones.map_or(0, |zones| zones.of(row, col))].push(sample);
            }
        }
        let mut own = [false; MAX_TAPS];
        for (own, tap) in own.iter_mut().zip(pass.taps()) {
            *own = tap.0 == super::taps::Source::Own;
        }
        own[pass.taps().len()..].fill(true);
        let (plain_taps, step) = (pass.taps().len(), step as f64);
        let noise = (step * step - 1.0) / 12.0;
        samples.into_iter().map(|samples| Self { samples, taps, plain_taps, noise, own }).collect()
    }

    /// Number of samples.
    pub(super) fn len(&self) -> usize {
        self.samples.len()
    }

    /// Share of the samples among steep ones.
    pub(super) fn steep(&self) -> usize {
        self.samples.iter().filter(|sample| sample.class == 1).count()
    }

    /// The best filters for all samples or for those of a class, without and with the serial taps; `None` with too few
    /// samples. The second is the first where the samples have no serial taps.
    pub(super) fn filters(&self, class: Option<u8>) -> Option<[[i32; MAX_TAPS]; 2]> {
        let count = self.samples.iter().filter(|sample| class.is_none_or(|class| sample.class == class)).count();
        if count < 8 * self.taps {
            return None;
        }
        let (mut solutions, mut filter) = ([[0.0f64; MAX_TAPS]; 2], None);
        for round in 0..2 {
            let mut sums = super::vectors::widest(
                #[inline(always)]
                || self.sums(class, filter.as_ref()),
            );
            let trace: f64 = (0..self.taps).map(|k| sums.matrix[k][k]).sum::<f64>() / self.taps as f64;
            for (k, row) in sums.matrix.iter_mut().enumerate().take(self.taps) {
                row[k] += 1e-5 * trace + 1e-9;
                if self.own[k] {
                    // The decoder sees these cells with the quantiser's noise; here they have none.
                    row[k] += self.noise * sums.weight;
                }
            }
            // The serial taps are the last ones: without them it is a smaller system of the same sums.
            if round == 1 && self.taps > self.plain_taps {
                solutions[0] = solve(&mut sums.matrix.clone(), &sums.right, self.plain_taps);
            }
            solutions[1] = solve(&mut sums.matrix, &sums.right, self.taps);
            filter = Some(std::array::from_fn(|k| solutions[1].get(k).map_or(0.0, |&weight| weight as f32)));
        }
        if self.taps == self.plain_taps {
            solutions[0] = solutions[1];
        }
        Some(solutions.map(|mut solution| {
            // What is added to all four nearest cells alike changes nothing but the rounding of their mean, which is
            // exact with a quarter each.
            let shared = solution[..4].iter().sum::<f64>() / 4.0 - 0.25;
            solution[..4].iter_mut().for_each(|weight| *weight -= shared);
            let one = f64::from(1 << FRACTION);
            let limit = f64::from(WEIGHT_LIMIT);
            solution.map(|weight| (weight * one).round().clamp(-limit, limit) as i32)
        }))
    }

    /// The normal equations of the samples, or of those of a class, weighted; anew towards least absolute errors where
    /// a filter's misses are known.
    #[inline(always)]
    fn sums(&self, class: Option<u8>, filter: Option<&[f32; ROW]>) -> Sums {
        let mut sums = Sums { matrix: [[0.0; MAX_TAPS]; MAX_TAPS], right: [0.0; MAX_TAPS], weight: 0.0 };
        for block in self.samples.chunks(BLOCK) {
            // Sums of few terms in single precision, which vectorise well; sums of those in double.
            let mut products = [[0.0f32; ROW]; MAX_TAPS];
            let mut with_target = [0.0f32; ROW];
            for sample in block {
                if class.is_some_and(|class| sample.class != class) {
                    continue;
                }
                let mut weight = sample.weight;
                if let Some(filter) = filter {
                    // Towards least absolute errors, which are what bits are spent on.
                    let scale = 1.0 / weight.sqrt();
                    weight = 1.0 / (scale * (miss(sample, filter).abs() + 0.5 * scale));
                }
                sums.weight += f64::from(weight);
                let weighted = sample.taps.map(|tap| tap * weight);
                for (cell, &weighted) in with_target.iter_mut().zip(&weighted) {
                    *cell += weighted * sample.target;
                }
                // The lower triangle, in whole vectors.
                for (k, row) in products[..self.taps].iter_mut().enumerate() {
                    let (row, taps) = (row.as_chunks_mut::<8>().0, sample.taps.as_chunks::<8>().0);
                    for (cells, taps) in row[..=k / 8].iter_mut().zip(taps) {
                        for (cell, &tap) in cells.iter_mut().zip(taps) {
                            *cell += weighted[k] * tap;
                        }
                    }
                }
            }
            for k in 0..self.taps {
                sums.right[k] += f64::from(with_target[k]);
                for (cell, &product) in sums.matrix[k][..=k].iter_mut().zip(&products[k]) {
                    *cell += f64::from(product);
                }
            }
        }
        sums
    }

    /// Mean of the squared-off logarithms of what filters miss by: about the bits a cell takes, up to a constant.
    pub(super) fn bits(&self, filters: [&[i32; MAX_TAPS]; 2], step: i64) -> f64 {
        let scaled = filters.map(scaled);
        let unit = 0.3 * step as f32;
        super::vectors::widest(
            #[inline(always)]
            || {
                let mut bits = 0.0;
                for sample in self.samples.iter().step_by(2) {
                    let miss = miss(sample, &scaled[usize::from(sample.class)]).abs();
                    // The spread's part is what the contexts know already.
                    bits += f64::from(log2(miss * miss + unit * unit)) * 0.5;
                }
                bits / self.samples.len().div_ceil(2).max(1) as f64
            },
        )
    }
}

/// A filter's weights as numbers.
fn scaled(filter: &[i32; MAX_TAPS]) -> [f32; ROW] {
    std::array::from_fn(|k| filter.get(k).map_or(0.0, |&weight| weight as f32 / (1 << FRACTION) as f32))
}

/// By how much a filter misses a sample's target. Taps that a pass has not are 0.
#[inline(always)]
fn miss(sample: &Sample, filter: &[f32; ROW]) -> f32 {
    let mut sums = [0.0f32; 8];
    for (taps, weights) in sample.taps.as_chunks::<8>().0.iter().zip(filter.as_chunks::<8>().0) {
        for ((sum, tap), weight) in sums.iter_mut().zip(taps).zip(weights) {
            *sum += tap * weight;
        }
    }
    let [a, b, c, d, e, f, g, h] = sums;
    sample.target - ((a + e) + (b + f) + ((c + g) + (d + h)))
}

/// Logarithm to base 2 from the bits of a float: the same on every machine, within 0.01.
#[inline(always)]
pub(super) fn log2(value: f32) -> f32 {
    let bits = value.to_bits();
    let exponent = (bits >> 23) as f32 - 127.0;
    let x = f32::from_bits((bits & 0x007f_ffff) | 0x3f80_0000) - 1.0;
    exponent + x * (1.342_57 - 0.342_57 * x)
}

/// Solves the first `count` equations of a symmetric positive system by Cholesky's method; only the lower triangle is
/// read.
pub(super) fn solve<const N: usize>(matrix: &mut [[f64; N]; N], right: &[f64; N], count: usize) -> [f64; N] {
    let mut x = [0.0; N];
    for i in 0..count {
        for j in 0..=i {
            let known: f64 = matrix[i][..j].iter().zip(&matrix[j][..j]).map(|(a, b)| a * b).sum();
            let sum = matrix[i][j] - known;
            matrix[i][j] = if i == j { sum.max(1e-12).sqrt() } else { sum / matrix[j][j] };
        }
    }
    for i in 0..count {
        let mut sum = right[i];
        for k in 0..i {
            sum -= matrix[i][k] * x[k];
        }
        x[i] = sum / matrix[i][i];
    }
    for i in (0..count).rev() {
        let mut sum = x[i];
        for k in i + 1..count {
            sum -= matrix[k][i] * x[k];
        }
        x[i] = sum / matrix[i][i];
    }
    x
}

/// Sums for the fit of the weights of errors: what each part of the expectation was, and what the error was.
pub(super) struct ErrorFit {
    rows: Vec<([f32; ERROR_WEIGHTS], f32)>,
}

impl ErrorFit {
    /// From the parts of the expected error and the error of cells.
    pub(super) fn new(rows: Vec<([f32; ERROR_WEIGHTS], f32)>) -> Self {
        Self { rows }
    }

    /// Codes of the best weights; those of parts that are 0 everywhere are 0.
    pub(super) fn codes(&self, start: &PassParams) -> Option<[u8; ERROR_WEIGHTS]> {
        if self.rows.len() < 300 {
            return None;
        }
        let mut weights: [f64; ERROR_WEIGHTS] = start.weights.map(|weight| f64::from(weight) / 1024.0);
        for _ in 0..2 {
            let (matrix, right) = super::vectors::widest(
                #[inline(always)]
                || self.sums(&weights),
            );
            for _ in 0..60 {
                for k in 0..ERROR_WEIGHTS {
                    if matrix[k][k] <= 0.0 {
                        weights[k] = 0.0;
                        continue;
                    }
                    let mut sum = right[k];
                    for l in 0..ERROR_WEIGHTS {
                        if l != k {
                            sum -= matrix[k][l] * weights[l];
                        }
                    }
                    weights[k] = (sum / matrix[k][k]).max(0.0);
                }
            }
            weights[ERROR_WEIGHTS - 1] = weights[ERROR_WEIGHTS - 1].max(0.01);
        }
        Some(weights.map(|weight| code_of(weight * 1024.0)))
    }
}

impl ErrorFit {
    /// The normal equations, weighted by what the given weights expect.
    #[inline(always)]
    fn sums(&self, weights: &[f64; ERROR_WEIGHTS]) -> ([[f64; ERROR_WEIGHTS]; ERROR_WEIGHTS], [f64; ERROR_WEIGHTS]) {
        // Filled up to whole vectors.
        let mut matrix = [[0.0f64; ERROR_ROW]; ERROR_WEIGHTS];
        let mut right = [0.0f64; ERROR_WEIGHTS];
        for (parts, error) in &self.rows {
            let mut row = [0.0f64; ERROR_ROW];
            for (cell, &part) in row.iter_mut().zip(parts) {
                *cell = f64::from(part);
            }
            let expected: f64 = (0..ERROR_WEIGHTS).map(|k| weights[k] * row[k]).sum();
            let expected = expected.max(0.1 * row[ERROR_WEIGHTS - 1]).max(1e-3);
            let weight = 1.0 / (expected * expected.sqrt());
            for k in 0..ERROR_WEIGHTS {
                let weighted = weight * row[k];
                right[k] += weighted * f64::from(*error);
                for (sum, part) in matrix[k].iter_mut().zip(&row) {
                    *sum += weighted * part;
                }
            }
        }
        (std::array::from_fn(|k| std::array::from_fn(|l| matrix[k][l])), right)
    }
}

/// Error weights, filled up to whole vectors.
const ERROR_ROW: usize = ERROR_WEIGHTS.next_multiple_of(4);

/// The code whose weight is nearest.
fn code_of(weight: f64) -> u8 {
    (0..=MAX_CODE)
        .min_by(|&a, &b| {
            let miss = |code: u8| (f64::from(weight_of(code)) - weight).abs();
            miss(a).total_cmp(&miss(b))
        })
        .unwrap_or(0)
}
