//! One pass over one plane: predict each cell, guess how far off that may be, take the residual, rebuild the cell.
//!
//! Encoder and decoder run the same code; they differ in where a residual comes from ([`Residuals`]). Rows are
//! prepared whole, in loops without dependences; what depends on the cell to the left (serial tiles) is added cell by
//! cell.

use super::params::{ERROR_WEIGHTS, PassParams};
use super::plane::{FRAME, Plane};
use super::tables::{TableRef, TableSet};
use super::taps::{Known, MAX_TAPS, Pass, SERIAL_TAPS};
use super::word::Word;

/// Fraction bits of a filter's weights.
pub(super) const FRACTION: u32 = 10;
const HALF: i64 = 1 << (FRACTION - 1);
/// Errors are kept in quarters of a unit, up to this.
pub(super) const ERROR_LIMIT: u32 = 1 << 20;
/// Bins of the expected error: quarter octaves.
const BINS: usize = 256;

/// What is the same for all passes of a tile.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileRule {
    /// The quantiser's step, odd.
    pub(super) step: i64,
    /// Errors are divided by `2^coarseness`.
    pub(super) coarseness: u32,
    /// Whether predictions use the cells to the left in the same plane.
    pub(super) serial: bool,
}

impl TileRule {
    /// The rule of a step and of a range of `range_bits` bits.
    pub(super) fn new(step: i64, range_bits: u32, serial: bool) -> Self {
        let step_bits = 64 - step.leading_zeros();
        Self { step, coarseness: step_bits.saturating_sub(6).max(range_bits.min(55).saturating_sub(24)), serial }
    }

    /// Multiplier and shift that turn a weighted sum of errors into 64ths of a step.
    fn scale(self) -> (u64, u32) {
        // 2^coarseness / (64 * step), as mantissa * 2^-shift with a mantissa of 32 bits.
        let step_bits = 64 - (self.step as u64).leading_zeros();
        let mantissa = ((1u128 << (31 + step_bits)) / self.step as u128) as u64;
        (mantissa.min(u64::from(u32::MAX)), 31 + step_bits + 6 - self.coarseness)
    }
}

/// Where residuals come from.
pub(super) trait Residuals<W: Word> {
    /// The residual, in steps, of the cell at a row and column whose prediction is given.
    fn next(&mut self, row: usize, col: usize, prediction: W, ask: Ask) -> i64;

    /// The residuals of a whole row whose predictions do not depend on each other.
    fn next_row(&mut self, row: usize, predictions: &[W], asks: &[Ask], residuals: &mut [W]) {
        for (col, ((residual, &prediction), &ask)) in residuals.iter_mut().zip(predictions).zip(asks).enumerate() {
            *residual = W::from_wide(self.next(row, col, prediction, ask));
        }
    }
}

/// How a residual is stored: its table, how many low bits as they are, and whether its sign is turned.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ask {
    pub(super) table: TableRef,
    pub(super) raw: u8,
    pub(super) flip: bool,
}

/// What the bin of the expected error and the class of the prediction's fraction lead to, for one pass.
struct Bins {
    asks: [[Ask; 4]; BINS],
    mantissa: u64,
    shift: u32,
    /// How the fraction of a prediction is told apart: at steps 1 and 3 only.
    fine: i64,
}

impl Bins {
    fn new(params: &PassParams, rule: TileRule) -> Self {
        let (mantissa, shift) = rule.scale();
        let fine = if rule.step <= 3 { rule.step } else { 0 };
        let mut bins = Self { asks: [[Ask::default(); 4]; BINS], mantissa, shift, fine };
        for (bin, asks) in bins.asks.iter_mut().enumerate() {
            for (class, ask) in asks.iter_mut().enumerate() {
                ask.table = TableSet::table(rule.step, params.shape, params.shift, bin, class);
                ask.raw = TableSet::raw_bits(bin) as u8;
            }
        }
        bins
    }

    /// How the residual is stored where so much error is expected and the prediction was rounded by `rest`.
    #[inline(always)]
    fn ask(&self, expected: u32, rest: i64) -> Ask {
        let bin = bin_of((u64::from(expected) * self.mantissa) >> self.shift);
        let distance = rest.unsigned_abs();
        let class = match self.fine {
            // Exactly half counts as nearly half.
            1 => (distance >> 7).min(3),
            3 => distance / 184,
            _ => 0,
        };
        let mut ask = self.asks[bin][class as usize & 3];
        ask.flip = self.fine != 0 && rest < 0;
        ask
    }
}

/// The bin of an expected error in 64ths of a step: quarter octaves from 4 on.
#[inline(always)]
fn bin_of(error: u64) -> usize {
    let error = error | 4;
    let octave = 63 - error.leading_zeros();
    // From 2^2 on: four bins an octave.
    (((octave - 2) * 4) as usize + ((error >> (octave - 2)) & 3) as usize) & (BINS - 1)
}

/// Work rows of a pass.
struct Rows<W> {
    base: Vec<W>,
    deviation: Vec<W>,
    class: Vec<u8>,
    expected: Vec<u32>,
    spare: Vec<W>,
    asks: Vec<Ask>,
    residuals: Vec<W>,
}

/// A prediction and by how much it was rounded, in fractions.
#[inline(always)]
fn rounded<W: Word>(base: W, deviation: W) -> (W, i64) {
    let whole = deviation.plus(W::from_wide(HALF)).halved(FRACTION);
    (base.plus(whole), deviation.minus(whole.doubled(FRACTION)).wide())
}

/// The cell that a residual makes of a prediction, and its error.
#[inline(always)]
fn rebuilt<W: Word>(prediction: W, rest: i64, k: i64, rule: TileRule) -> (W, u32) {
    let jump = W::from_wide(k.wrapping_mul(rule.step));
    let far = i64::from(jump.magnitude().min(1 << 30)) << FRACTION;
    let far = (far - if jump.is_negative() { -rest } else { rest }).unsigned_abs();
    let error = ((far >> (FRACTION - 2)) >> rule.coarseness).min(u64::from(ERROR_LIMIT)) as u32;
    (prediction.plus(jump), error)
}

/// Adds the weighted taps to `sum`.
fn weigh<W: Word>(sum: &mut [W], taps: &[(&[W], i32)]) {
    let count = sum.len();
    let mut groups = taps.chunks_exact(4);
    for group in &mut groups {
        let [(a, p), (b, q), (c, r), (d, s)] = [group[0], group[1], group[2], group[3]];
        let (a, b, c, d) = (&a[..count], &b[..count], &c[..count], &d[..count]);
        for j in 0..count {
            let pair = a[j].times(p).plus(b[j].times(q));
            sum[j] = sum[j].plus(pair).plus(c[j].times(r).plus(d[j].times(s)));
        }
    }
    for &(a, p) in groups.remainder() {
        for (sum, &a) in sum.iter_mut().zip(&a[..count]) {
            *sum = sum.plus(a.times(p));
        }
    }
}

/// Adds a weighted group of errors to `sum`.
fn weigh_errors(sum: &mut [u32], group: &[&[u32]], weight: u32) {
    if weight == 0 {
        return;
    }
    let count = sum.len();
    match group {
        [a, b] => {
            let (a, b) = (&a[..count], &b[..count]);
            for j in 0..count {
                sum[j] = sum[j].wrapping_add(weight.wrapping_mul(a[j].wrapping_add(b[j])));
            }
        }
        [a, b, c, d] => {
            let (a, b, c, d) = (&a[..count], &b[..count], &c[..count], &d[..count]);
            for j in 0..count {
                let four = a[j].wrapping_add(b[j]).wrapping_add(c[j].wrapping_add(d[j]));
                sum[j] = sum[j].wrapping_add(weight.wrapping_mul(four));
            }
        }
        _ => {}
    }
}

/// Caps a magnitude in cell units as an error in coarse quarters.
#[inline(always)]
pub(super) fn as_error(magnitude: u32, coarseness: u32) -> u32 {
    // At most 2^30 before the shift to quarters.
    ((magnitude.min(1 << 29) << 2) >> coarseness).min(ERROR_LIMIT)
}

/// The mean of four cells, rounded down. Their sum could overflow where their differences do not.
#[inline(always)]
pub(super) fn mean<W: Word>(a: W, b: W, c: W, d: W) -> W {
    a.plus(b.minus(a).plus(c.minus(a)).plus(d.minus(a)).halved(2))
}

/// Nearest cells, their mean, their spread, and what of the expected error they tell.
fn look_around<W: Word>(pass: Pass, near: [&[W]; 4], rows: &mut Rows<W>, params: &PassParams, rule: TileRule) {
    let count = rows.base.len();
    let [a, b, c, d] = near.map(|run| &run[..count]);
    let (base, expected) = (&mut rows.base[..count], &mut rows.expected[..count]);
    for j in 0..count {
        base[j] = mean(a[j], b[j], c[j], d[j]);
    }
    let (spread_weight, across_weight) = (params.weights[3], params.weights[4]);
    let coarseness = rule.coarseness;
    // The least error: a step's share.
    let floor = params.weights[8].wrapping_mul(as_error(u32::try_from(rule.step).unwrap_or(u32::MAX), coarseness));
    // Over C the two diagonals are compared, elsewhere the row with the column.
    let (p, q, r, s) = if pass == Pass::C { (a, d, b, c) } else { (a, b, c, d) };
    for j in 0..count {
        let far = |x: W| x.minus(base[j]).magnitude() >> 2;
        let spread = far(a[j]) + far(b[j]) + (far(c[j]) + far(d[j]));
        let across = p[j].plus(q[j]).minus(r[j].plus(s[j])).magnitude() >> 1;
        expected[j] = floor
            .wrapping_add(spread_weight.wrapping_mul(as_error(spread, coarseness)))
            .wrapping_add(across_weight.wrapping_mul(as_error(across, coarseness)));
    }
    if params.classes == 2 {
        let flat = u32::try_from(rule.step.saturating_mul(2)).unwrap_or(u32::MAX);
        for (j, class) in rows.class[..count].iter_mut().enumerate() {
            let (one, other) = (p[j].minus(q[j]).magnitude(), r[j].minus(s[j]).magnitude());
            *class = u8::from(one.saturating_add(other) > flat);
        }
    }
}

/// Runs a pass and returns its cells and errors, framed.
///
/// `void` says which cells hold nothing: they are filled with their prediction and take no residual.
#[allow(clippy::too_many_arguments, reason = "the parts of a level, each of its own type")]
pub(super) fn run_pass<W: Word, R: Residuals<W>>(
    pass: Pass,
    (width, height): (usize, usize),
    cells: Known<'_, W>,
    errors: Known<'_, u32>,
    void: Option<&Plane<u8>>,
    params: &PassParams,
    rule: TileRule,
    residuals: &mut R,
) -> (Plane<W>, Plane<u32>) {
    let mut own = Plane::<W>::new(width, height);
    let mut own_errors = Plane::<u32>::new(width, height);
    if own.is_empty() {
        return (own, own_errors);
    }
    let bins = Bins::new(params, rule);
    let reach = width + 2 * FRAME;
    for row in [-1isize, -2] {
        own.framed_row_mut(row)[..reach].copy_from_slice(&cells.a.framed_row(0)[..reach]);
        own_errors.framed_row_mut(row)[..reach].copy_from_slice(&errors.a.framed_row(0)[..reach]);
    }
    let mut rows = Rows {
        base: vec![W::default(); width],
        deviation: vec![W::default(); width],
        class: vec![0; width],
        expected: vec![0; width],
        spare: vec![W::default(); width],
        asks: vec![Ask::default(); width],
        residuals: vec![W::default(); width],
    };
    let taps = pass.taps();
    let [w_above, w_left, w_left2] = [params.weights[5], params.weights[6], params.weights[7]];
    for row in 0..height {
        // What is known of the row before its first cell.
        let near = std::array::from_fn(|k| cells.run(&own, taps[k], row, width));
        look_around(pass, near, &mut rows, params, rule);
        for (group, &weight) in pass.error_groups().iter().zip(&params.weights) {
            let mut runs = [&[][..]; 4];
            for (run, &tap) in runs.iter_mut().zip(*group) {
                *run = errors.run(&own_errors, tap, row, width);
            }
            weigh_errors(&mut rows.expected, &runs[..group.len()], weight);
        }
        let above = |col: isize| own_errors.run(row as isize - 1, col, width);
        weigh_errors(&mut rows.expected, &[above(-1), above(0), above(0), above(1)], w_above);
        for class in 0..usize::from(params.classes) {
            let filter = &params.filters[class];
            let total: i32 = filter.iter().sum();
            let sum = if class == 0 { &mut rows.deviation } else { &mut rows.spare };
            for (sum, base) in sum.iter_mut().zip(&rows.base) {
                *sum = base.times(total.wrapping_neg());
            }
            let mut runs = [(&[][..], 0); MAX_TAPS];
            for (run, (&tap, &weight)) in runs.iter_mut().zip(taps.iter().zip(filter)) {
                *run = (cells.run(&own, tap, row, width), weight);
            }
            weigh(sum, &runs[..taps.len()]);
        }
        if params.classes == 2 {
            for j in 0..width {
                rows.deviation[j] = if rows.class[j] == 0 { rows.deviation[j] } else { rows.spare[j] };
            }
        }
        let holes = void.map(|void| void.row(row));
        let nearest_errors = errors.a.run(row as isize, 0, width);
        let first = cells.a.run(row as isize, 0, 1)[0];
        let first_error = nearest_errors[0];
        let line = own.framed_row_mut(row as isize);
        let error_line = own_errors.framed_row_mut(row as isize);
        line[..FRAME].fill(first);
        error_line[..FRAME].fill(first_error);
        let (mut left, mut left2) = (first, first);
        let (mut left_error, mut left2_error) = (first_error, first_error);
        let serial: [[i32; SERIAL_TAPS]; 2] =
            std::array::from_fn(|class| std::array::from_fn(|k| params.filters[class][taps.len() + k]));
        if !rule.serial && holes.is_none_or(|holes| !holes.contains(&1)) {
            // Nothing depends on the cell to the left: loops of one thing each are faster than one loop of all.
            let (predictions, rests) = (&mut rows.base, &mut rows.deviation);
            for (base, deviation) in predictions.iter_mut().zip(rests.iter_mut()) {
                let whole = deviation.plus(W::from_wide(HALF)).halved(FRACTION);
                *base = base.plus(whole);
                *deviation = deviation.minus(whole.doubled(FRACTION));
            }
            for ((ask, &expected), rest) in rows.asks.iter_mut().zip(&rows.expected).zip(rests.iter()) {
                *ask = bins.ask(expected, rest.wide());
            }
            residuals.next_row(row, predictions, &rows.asks, &mut rows.residuals);
            let (line, error_line) = (&mut line[FRAME..FRAME + width], &mut error_line[FRAME..FRAME + width]);
            let (predictions, rests, taken) = (&predictions[..width], &rests[..width], &rows.residuals[..width]);
            match i32::try_from(rule.step) {
                Ok(step) if rule.coarseness == 0 => {
                    for col in 0..width {
                        let jump = taken[col].times(step);
                        line[col] = predictions[col].plus(jump);
                        error_line[col] = jump.fine_error(rests[col]);
                    }
                }
                _ => {
                    for col in 0..width {
                        let rest = rests[col].wide();
                        (line[col], error_line[col]) = rebuilt(predictions[col], rest, taken[col].wide(), rule);
                    }
                }
            }
        } else {
            for col in 0..width {
                let mut deviation = rows.deviation[col];
                let mut expected = rows.expected[col];
                if rule.serial {
                    let [p, q] = serial[usize::from(rows.class[col] & 1)];
                    // The weights' share of the base is in the sum already.
                    deviation = deviation.plus(left.times(p)).plus(left2.times(q));
                    expected = expected
                        .wrapping_add(w_left.wrapping_mul(left_error))
                        .wrapping_add(w_left2.wrapping_mul(left2_error));
                }
                let (prediction, rest) = rounded(rows.base[col], deviation);
                let (value, error) = if holes.is_some_and(|holes| holes[col] != 0) {
                    (prediction, nearest_errors[col])
                } else {
                    let ask = bins.ask(expected, rest);
                    rebuilt(prediction, rest, residuals.next(row, col, prediction, ask), rule)
                };
                line[FRAME + col] = value;
                error_line[FRAME + col] = error;
                (left2, left) = (left, value);
                (left2_error, left_error) = (left_error, error);
            }
        }
        let (last, last_error) = (line[FRAME + width - 1], error_line[FRAME + width - 1]);
        line[FRAME + width..].fill(last);
        error_line[FRAME + width..].fill(last_error);
    }
    own.close();
    own_errors.close();
    (own, own_errors)
}

const _: () = assert!(ERROR_WEIGHTS == 9, "three groups, spread, across, above, left, left2, floor");
