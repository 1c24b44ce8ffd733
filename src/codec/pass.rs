//! One pass over one plane: predict each cell, guess how far off that may be, take the residual, rebuild the cell.
//!
//! Encoder and decoder run the same code; they differ in where a residual comes from ([`Residuals`]). Rows are
//! prepared whole, in loops without dependences; what depends on the cell to the left (serial passes) is added cell by
//! cell.

use super::bands::Bands;
use super::context::{Asks, TileRule, context_of, contexts_of, zone_context};
use super::copies::{COPY, Still};
use super::params::{ERROR_WEIGHTS, PassParams};
use super::plane::{FRAME, Plane};
use super::taps::{Known, MAX_TAPS, Pass, SERIAL_TAPS};
use super::word::Word;
use super::zones::LevelZones;
use std::ops::Range;

/// Fraction bits of a filter's weights.
pub(super) const FRACTION: u32 = 10;
const HALF: i64 = 1 << (FRACTION - 1);

/// Where residuals come from.
pub(super) trait Residuals<W: Word> {
    /// Whether [`Residuals::keep`] wants every row.
    const KEEPS: bool;

    /// The residual, in steps, of the cell at a row and column whose prediction is given; it is stored turned where
    /// `turn` is less than 0.
    fn next(&mut self, asks: &Asks, row: usize, col: usize, prediction: W, context: u16, turn: W) -> W;

    /// The residuals of a whole row whose predictions do not depend on each other; 0 in holes.
    fn next_row(&mut self, asks: &Asks, row: usize, planned: &Planned<'_, W>, residuals: &mut [W]);

    /// A row is over; these were its residuals.
    fn keep(&mut self, planned: &Planned<'_, W>, residuals: &[W]);
}

/// What is known of the cells of a row before their residuals.
pub(super) struct Planned<'a, W> {
    pub(super) predictions: &'a [W],
    pub(super) contexts: &'a [u16],
    /// Less than 0 where a residual is stored with the other sign.
    pub(super) turns: &'a [W],
    /// Other than 0 where a cell holds nothing and takes no residual.
    pub(super) holes: Option<&'a [u8]>,
}

/// Work rows of a pass.
struct Rows<W> {
    base: Vec<W>,
    deviation: Vec<W>,
    class: Vec<u8>,
    expected: Vec<u32>,
    spare: Vec<W>,
    contexts: Vec<u16>,
    residuals: Vec<W>,
}

/// A prediction and by how much it was rounded, in fractions.
#[inline(always)]
fn rounded<W: Word>(base: W, deviation: W) -> (W, W) {
    let whole = deviation.plus(W::from_wide(HALF)).halved(FRACTION);
    (base.plus(whole), deviation.minus(whole.doubled(FRACTION)))
}

/// Adds the weighted taps to `sum`.
#[inline(always)]
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

/// Adds a weighted group of errors to `sum`. Weights are at most 1024, errors at most 65535, and there are at most 17
/// of them, so that sums stay below `2^31`.
#[inline(always)]
fn weigh_errors(sum: &mut [u32], group: &[&[u16]], weight: u32) {
    if weight == 0 {
        return;
    }
    let count = sum.len();
    match group {
        [a, b] => {
            let (a, b) = (&a[..count], &b[..count]);
            for j in 0..count {
                sum[j] += weight * (u32::from(a[j]) + u32::from(b[j]));
            }
        }
        [a, b, c, d] => {
            let (a, b, c, d) = (&a[..count], &b[..count], &c[..count], &d[..count]);
            for j in 0..count {
                let four = u32::from(a[j]) + u32::from(b[j]) + (u32::from(c[j]) + u32::from(d[j]));
                sum[j] += weight * four;
            }
        }
        _ => {}
    }
}

/// The mean of four cells, rounded down. Their sum could overflow where their differences do not.
#[inline(always)]
pub(super) fn mean<W: Word>(a: W, b: W, c: W, d: W) -> W {
    a.plus(b.minus(a).plus(c.minus(a)).plus(d.minus(a)).halved(2))
}

/// How far the four nearest cells are from their mean, and how much two pairs of them disagree, as errors.
#[inline(always)]
pub(super) fn spread_and_across<W: Word>([p, q, r, s]: [W; 4], base: W, coarseness: u32) -> (u32, u32) {
    let far = |x: W| x.minus(base).part(2);
    let spread = far(p).plus(far(q)).plus(far(r).plus(far(s)));
    let across = p.plus(q).minus(r.plus(s)).part(1);
    (spread.error(coarseness), across.error(coarseness))
}

/// The least error that is expected: a step's share.
pub(super) fn floor_of(rule: TileRule) -> u32 {
    rule.step.error(rule.coarseness)
}

/// The nearest four cells by pairs: over C the two diagonals are compared, elsewhere the row with the column.
#[inline(always)]
pub(super) fn pairs<T>(pass: Pass, [a, b, c, d]: [T; 4]) -> [T; 4] {
    if pass == Pass::C { [a, d, b, c] } else { [a, b, c, d] }
}

/// Nearest cells, their mean, their spread, and what of the expected error they tell; returns how many of the run are of
/// the steep class.
#[inline(always)]
fn look_around<W: Word>(
    pass: Pass,
    near: [&[W]; 4],
    rows: &mut Rows<W>,
    span: &Range<usize>,
    params: &PassParams,
    rule: TileRule,
) -> usize {
    let count = span.len();
    let [a, b, c, d] = near.map(|run| &run[..count]);
    let (base, expected) = (&mut rows.base[span.clone()][..count], &mut rows.expected[span.clone()][..count]);
    for j in 0..count {
        base[j] = mean(a[j], b[j], c[j], d[j]);
    }
    let (spread_weight, across_weight) = (params.weights[3], params.weights[4]);
    let floor = params.weights[8] * floor_of(rule);
    let [p, q, r, s] = pairs(pass, [a, b, c, d]);
    for j in 0..count {
        let (spread, across) = spread_and_across([p[j], q[j], r[j], s[j]], base[j], rule.coarseness);
        expected[j] = floor + spread_weight * spread + across_weight * across;
    }
    if params.classes < 2 {
        return 0;
    }
    let flat = u32::try_from(rule.step.saturating_mul(2)).unwrap_or(u32::MAX);
    let mut steep = 0;
    for (j, class) in rows.class[span.clone()].iter_mut().enumerate() {
        let (one, other) = (p[j].minus(q[j]).magnitude(), r[j].minus(s[j]).magnitude());
        *class = u8::from(one.saturating_add(other) > flat);
        steep += u32::from(*class);
    }
    steep as usize
}

/// Runs a pass and returns its cells and errors, framed, with the widest vectors that the processor has.
///
/// `still` says which cells take no residual: voids, which are filled with their prediction, and copies. `bands` are the rows
/// to run: all of them, unless an encoder wants a sample. There are parameters for each zone; all of them are serial or
/// none is.
#[allow(clippy::too_many_arguments, reason = "the parts of a level, each of its own type")]
pub(super) fn run_pass<W: Word, R: Residuals<W>>(
    pass: Pass,
    size: (usize, usize),
    cells: Known<'_, W>,
    errors: Known<'_, u16>,
    still: Option<Still<'_, W>>,
    params: &[PassParams],
    zones: Option<LevelZones<'_>>,
    rule: TileRule,
    bands: Bands,
    residuals: &mut R,
) -> (Plane<W>, Plane<u16>) {
    super::vectors::widest(
        #[inline(always)]
        || run(pass, size, cells, errors, still, params, zones, rule, bands, residuals),
    )
}

#[allow(clippy::too_many_arguments, reason = "the parts of a level, each of its own type")]
#[inline(always)]
fn run<W: Word, R: Residuals<W>>(
    pass: Pass,
    (width, height): (usize, usize),
    cells: Known<'_, W>,
    errors: Known<'_, u16>,
    still: Option<Still<'_, W>>,
    params: &[PassParams],
    zones: Option<LevelZones<'_>>,
    rule: TileRule,
    bands: Bands,
    residuals: &mut R,
) -> (Plane<W>, Plane<u16>) {
    let mut own = Plane::<W>::new(width, height);
    let mut own_errors = Plane::<u16>::new(width, height);
    if own.is_empty() {
        return (own, own_errors);
    }
    let asks = Asks::new(params, rule);
    let class_factor = rule.class_factor();
    let turning = W::from_wide(if rule.turns() { -1 } else { 0 });
    let step = W::from_wide(rule.step);
    let reach = width + 2 * FRAME;
    let mut rows = Rows {
        base: vec![W::default(); width],
        deviation: vec![W::default(); width],
        class: vec![0; width],
        expected: vec![0; width],
        spare: vec![W::default(); width],
        contexts: vec![0; width],
        residuals: vec![W::default(); width],
    };
    let taps = pass.taps();
    // Runs of cells with the same parameters, and which.
    let mut spans = vec![(0..width, 0)];
    for (row, first) in bands.rows(height) {
        if first {
            for above in [row as isize - 1, row as isize - 2] {
                let row = row as isize;
                own.framed_row_mut(above)[..reach].copy_from_slice(&cells.a.framed_row(row)[..reach]);
                own_errors.framed_row_mut(above)[..reach].copy_from_slice(&errors.a.framed_row(row)[..reach]);
            }
        }
        if let Some(zones) = zones
            && (first || !zones.is_as_above(row))
        {
            zones.spans(row, width, &mut spans);
        }
        // What is known of the row before its first cell.
        let mut runs = [&[][..]; MAX_TAPS];
        for (run, &tap) in runs.iter_mut().zip(taps) {
            *run = cells.run(&own, tap, row, width);
        }
        let mut groups = [[&[][..]; 4]; 3];
        for (runs, group) in groups.iter_mut().zip(pass.error_groups()) {
            for (run, &tap) in runs.iter_mut().zip(*group) {
                *run = errors.run(&own_errors, tap, row, width);
            }
        }
        let above = [-1, 0, 0, 1].map(|col| own_errors.run(row as isize - 1, col, width));
        for (span, zone) in &spans {
            let params = &params[*zone];
            let near = [0, 1, 2, 3].map(|tap| &runs[tap][span.clone()]);
            let steep = look_around(pass, near, &mut rows, span, params, rule);
            let expected = &mut rows.expected[span.clone()];
            for ((group, taps), &weight) in groups.iter().zip(pass.error_groups()).zip(&params.weights) {
                let group = group.map(|run| run.get(span.clone()).unwrap_or_default());
                weigh_errors(expected, &group[..taps.len()], weight);
            }
            weigh_errors(expected, &above.map(|run| &run[span.clone()]), params.weights[5]);
            for class in 0..2 {
                if steep == if class == 0 { span.len() } else { 0 } {
                    // No cell is of this class.
                    continue;
                }
                let filter = &params.filters[class];
                let total: i32 = filter.iter().sum();
                let sum =
                    if steep == 0 || steep == span.len() || class == 0 { &mut rows.deviation } else { &mut rows.spare };
                let sum = &mut sum[span.clone()];
                for (sum, base) in sum.iter_mut().zip(&rows.base[span.clone()]) {
                    *sum = base.times(total.wrapping_neg());
                }
                let mut weighted = [(&[][..], 0); MAX_TAPS];
                for (weighted, (run, &weight)) in weighted.iter_mut().zip(runs[..taps.len()].iter().zip(filter)) {
                    *weighted = (&run[span.clone()], weight);
                }
                weigh(sum, &weighted[..taps.len()]);
            }
            if steep > 0 && steep < span.len() {
                let (spare, class) = (&rows.spare[span.clone()], &rows.class[span.clone()]);
                for ((deviation, &spare), &class) in rows.deviation[span.clone()].iter_mut().zip(spare).zip(class) {
                    *deviation = if class == 0 { *deviation } else { spare };
                }
            }
        }
        let holes = still.map(|still| still.marks.row(row));
        let copies = still.and_then(|still| still.copies).map(|copies| copies.row(row));
        let nearest_errors = errors.a.run(row as isize, 0, width);
        let first = cells.a.run(row as isize, 0, 1)[0];
        let first_error = nearest_errors[0];
        let line = own.framed_row_mut(row as isize);
        let error_line = own_errors.framed_row_mut(row as isize);
        line[..FRAME].fill(first);
        error_line[..FRAME].fill(first_error);
        if params[0].serial {
            let (mut left, mut left2) = (first, first);
            let (mut left_error, mut left2_error) = (u32::from(first_error), u32::from(first_error));
            let Rows { base, deviation, class, expected, spare, contexts, residuals: taken } = &mut rows;
            let (base, deviation, class, expected) =
                (&base[..width], &deviation[..width], &class[..width], &expected[..width]);
            let (turns, contexts, taken) = (&mut spare[..width], &mut contexts[..width], &mut taken[..width]);
            let (line, error_line) = (&mut line[FRAME..FRAME + width], &mut error_line[FRAME..FRAME + width]);
            for (span, zone) in &spans {
                let params = &params[*zone];
                let zone_bits = zone_context(*zone);
                let [w_left, w_left2] = [params.weights[6], params.weights[7]];
                let serial: [[i32; SERIAL_TAPS]; 2] =
                    std::array::from_fn(|class| std::array::from_fn(|k| params.filters[class][taps.len() + k]));
                let classed = params.classes == 2;
                for col in span.clone() {
                    let [p, q] = serial[usize::from(classed) & usize::from(class[col] & 1)];
                    // The weights' share of the base is in the sum already.
                    let deviation = deviation[col].plus(left.times(p)).plus(left2.times(q));
                    let expected = expected[col] + w_left * left_error + w_left2 * left2_error;
                    let (prediction, rest) = rounded(base[col], deviation);
                    let mark = holes.map_or(0, |holes| holes[col]);
                    let (value, error) = if mark != 0 {
                        match copies {
                            Some(copies) if mark == COPY => (copies[col], 0),
                            _ => (prediction, u32::from(nearest_errors[col])),
                        }
                    } else {
                        let context = context_of(expected, rest.low(), class_factor) | zone_bits;
                        let turn = rest.kept(turning);
                        let residual = residuals.next(&asks, row, col, prediction, context, turn);
                        if R::KEEPS {
                            (contexts[col], turns[col], taken[col]) = (context, turn, residual);
                        }
                        let jump = residual.product(step);
                        let error = match rule.coarseness {
                            0 => jump.fine_error(rest),
                            coarseness => jump.error(coarseness),
                        };
                        (prediction.plus(jump), error)
                    };
                    line[col] = value;
                    error_line[col] = error as u16;
                    (left2, left) = (left, value);
                    (left2_error, left_error) = (left_error, error);
                }
            }
            if R::KEEPS {
                residuals.keep(&Planned { predictions: base, contexts, turns, holes }, taken);
            }
        } else {
            // Nothing depends on the cell to the left: loops of one thing each are faster than one loop of all.
            let (predictions, rests) = (&mut rows.base[..width], &mut rows.deviation[..width]);
            for (base, deviation) in predictions.iter_mut().zip(rests.iter_mut()) {
                (*base, *deviation) = rounded(*base, *deviation);
            }
            contexts_of(&mut rows.contexts[..width], &rows.expected[..width], |col| rests[col].low(), class_factor);
            for (span, zone) in spans.iter().filter(|(_, zone)| *zone > 0) {
                rows.contexts[span.clone()].iter_mut().for_each(|context| *context |= zone_context(*zone));
            }
            let turns = &mut rows.spare[..width];
            for (turn, rest) in turns.iter_mut().zip(rests.iter()) {
                *turn = rest.kept(turning);
            }
            let taken = &mut rows.residuals[..width];
            let planned = Planned { predictions, contexts: &rows.contexts[..width], turns, holes };
            residuals.next_row(&asks, row, &planned, taken);
            if R::KEEPS {
                residuals.keep(&planned, taken);
            }
            let (line, error_line) = (&mut line[FRAME..FRAME + width], &mut error_line[FRAME..FRAME + width]);
            for k in taken.iter_mut() {
                *k = k.product(step);
            }
            for ((cell, prediction), &jump) in line.iter_mut().zip(predictions.iter()).zip(taken.iter()) {
                *cell = prediction.plus(jump);
            }
            if rule.coarseness == 0 {
                for ((error, &rest), jump) in error_line.iter_mut().zip(rests.iter()).zip(taken.iter()) {
                    *error = jump.fine_error(rest) as u16;
                }
            } else {
                for (error, jump) in error_line.iter_mut().zip(taken.iter()) {
                    *error = jump.error(rule.coarseness) as u16;
                }
            }
            if let Some(holes) = holes {
                for ((error, &hole), &nearest) in error_line.iter_mut().zip(holes).zip(nearest_errors) {
                    *error = if hole == 0 { *error } else { nearest };
                }
                for (col, &copy) in copies.unwrap_or_default().iter().enumerate().filter(|&(col, _)| holes[col] == COPY)
                {
                    (line[col], error_line[col]) = (copy, 0);
                }
            }
        }
        let line = own.framed_row_mut(row as isize);
        let last = line[FRAME + width - 1];
        line[FRAME + width..].fill(last);
        let error_line = own_errors.framed_row_mut(row as isize);
        let last_error = error_line[FRAME + width - 1];
        error_line[FRAME + width..].fill(last_error);
    }
    if bands == Bands::All {
        own.close();
        own_errors.close();
    }
    (own, own_errors)
}

const _: () = assert!(ERROR_WEIGHTS == 9, "three groups, spread, across, above, left, left2, floor");
