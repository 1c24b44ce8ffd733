//! Encodes the levels of a tile.

use super::bits::BitWriter;
use super::cost::{cost_of, symbol_costs};
use super::fit::{ErrorFit, Samples};
use super::level::{Level, plane_shape, refine};
use super::mask::VoidLevel;
use super::params::{ERROR_WEIGHTS, PassParams, SHIFT_LIMIT};
use super::pass::{Ask, Residuals, TileRule, as_error, mean, run_pass};
use super::plane::Plane;
use super::rans;
use super::tables::{CENTRE, ESCAPE, SHAPES, TableRef, VARIANTS, reshaped, table_set};
use super::taps::{Known, Pass};
use super::tile::{SEGMENTS, TileShape};
use super::training::Fitted;
use super::word::Word;
use crate::error::Result;

/// Cells of a pass from which on filters are fitted.
const FIT_FROM: usize = 600;
/// Up to so many cells the weights of errors are fitted anew.
const FIT_UP_TO: usize = 150_000;

/// A residual with the table that the plain parameters give it.
#[derive(Clone, Copy, Debug)]
struct Residual {
    k: i64,
    table: TableRef,
    raw: u8,
}

/// Takes residuals from the cells as they should be.
struct Taking<'a, W> {
    original: &'a Plane<W>,
    step: i64,
    taken: Vec<Residual>,
}

impl<W: Word> Residuals<W> for Taking<'_, W> {
    #[inline(always)]
    fn next(&mut self, row: usize, col: usize, prediction: W, ask: Ask) -> i64 {
        let miss = self.original.row(row)[col].minus(prediction).wide();
        let k = match self.step {
            1 => miss,
            step => {
                // Away from zero from half a step on; steps are odd, so there are no ties.
                let k = (miss.unsigned_abs() + (step as u64 / 2)) / step as u64;
                if miss < 0 { -(k as i64) } else { k as i64 }
            }
        };
        self.taken.push(Residual { k: if ask.flip { k.wrapping_neg() } else { k }, table: ask.table, raw: ask.raw });
        k
    }
}

/// One segment in the making.
#[derive(Default)]
pub(super) struct SegmentParts {
    pub(super) side: BitWriter,
    raw: BitWriter,
    symbols: Vec<(u16, u8)>,
}

impl SegmentParts {
    /// Raw bits and symbols as bytes.
    pub(super) fn finish(self) -> (BitWriter, Vec<u8>, Vec<u8>) {
        let set = table_set();
        (self.side, self.raw.finish(), rans::encode(&self.symbols, |table| set.encoding(table)))
    }
}

/// How residuals spread over the symbols of each table.
struct Histogram {
    tables: Vec<(TableRef, Vec<u32>)>,
    escaped: u64,
}

impl Histogram {
    fn new(taken: &[Residual]) -> Self {
        let mut counts: Vec<Option<Vec<u32>>> = vec![None; super::tables::TABLES];
        let mut escaped = 0;
        for residual in taken {
            let symbol = symbol_of(residual.k >> residual.raw);
            let count = counts[usize::from(residual.table.0)].get_or_insert_with(|| vec![0; rans::SYMBOLS]);
            count[usize::from(symbol)] += 1;
            if symbol == ESCAPE {
                escaped += u64::from(number_bits(residual.k >> residual.raw)) << 8;
            }
        }
        let tables = counts
            .into_iter()
            .enumerate()
            .filter_map(|(table, counts)| counts.map(|counts| (TableRef(table as u16), counts)))
            .collect();
        Self { tables, escaped }
    }

    /// Cost of all residuals in 256ths of a bit, without raw bits.
    fn cost(&self, shape: u8, shift: i32) -> u64 {
        let costs = symbol_costs();
        let mut cost = self.escaped;
        for (table, counts) in &self.tables {
            let freq = table_set().freq(reshaped(*table, shape, shift));
            let escape = costs[usize::from(freq[usize::from(ESCAPE)])];
            for (symbol, &count) in counts.iter().enumerate() {
                let each = match freq[symbol] {
                    0 => escape + (7 << 8),
                    freq => costs[usize::from(freq)],
                };
                cost += u64::from(count) * u64::from(each);
            }
        }
        cost
    }

    /// The cheapest family and shift, and their cost.
    fn best(&self) -> (u8, i32, u64) {
        let mut best = (0, 0, u64::MAX);
        for shape in 0..SHAPES as u8 {
            for shift in -SHIFT_LIMIT..=SHIFT_LIMIT {
                let cost = self.cost(shape, shift);
                if cost < best.2 {
                    best = (shape, shift, cost);
                }
            }
        }
        best
    }
}

/// The symbol of a residual.
fn symbol_of(k: i64) -> u8 {
    match k.checked_add(CENTRE) {
        Some(symbol) if (0..i64::from(ESCAPE)).contains(&symbol) => symbol as u8,
        _ => ESCAPE,
    }
}

/// Bits that an escaped residual takes.
fn number_bits(k: i64) -> u32 {
    cost_of(super::bits::zigzag(k), 6)
}

/// What became of a pass.
struct Coded<W> {
    params: PassParams,
    taken: Vec<Residual>,
    cells: Plane<W>,
    errors: Plane<u32>,
    cost: u64,
}

/// Everything about a pass that does not change while its parameters are tried.
struct Task<'a, W> {
    pass: Pass,
    original: &'a Plane<W>,
    cells: Known<'a, W>,
    errors: Known<'a, u32>,
    void: Option<&'a Plane<u8>>,
    rule: TileRule,
}

impl<W: Word> Task<'_, W> {
    fn run(&self, mut params: PassParams) -> Coded<W> {
        (params.shape, params.shift) = (0, 0);
        let size = (self.original.width, self.original.height);
        let mut taking =
            Taking { original: self.original, step: self.rule.step, taken: Vec::with_capacity(size.0 * size.1) };
        let (cells, errors) =
            run_pass(self.pass, size, self.cells, self.errors, self.void, &params, self.rule, &mut taking);
        let histogram = Histogram::new(&taking.taken);
        let (shape, shift, cost) = histogram.best();
        (params.shape, params.shift) = (shape, shift);
        let mut side = BitWriter::default();
        params.write(&mut side, self.pass, self.rule.serial);
        let raw: u64 = taking.taken.iter().map(|residual| u64::from(residual.raw)).sum();
        Coded { cost: cost + ((side.bits() as u64 + raw) << 8), params, taken: taking.taken, cells, errors }
    }

    /// Filters: the best shipped ones, or fitted ones where they pay for themselves.
    fn filters(&self) -> PassParams {
        let serial = self.rule.serial;
        let count = self.original.width * self.original.height;
        let mut best = PassParams::shipped(self.pass, serial, self.variant());
        best.filter_variant = Some(0);
        let samples = Samples::gather(self.pass, self.original, self.cells, self.void, self.rule.step, serial);
        if samples.len() < 8 {
            best.filters = PassParams::shipped(self.pass, serial, 0).filters;
            return best;
        }
        let mut bits = f64::INFINITY;
        for variant in 0..VARIANTS as u8 {
            let filters = PassParams::shipped(self.pass, serial, variant).filters;
            let found = samples.bits([&filters[0], &filters[1]], self.rule.step) * count as f64;
            if found < bits {
                (bits, best.filter_variant, best.filters) = (found, Some(variant), filters);
            }
        }
        if count < FIT_FROM {
            return best;
        }
        let Some(filter) = samples.filter(None) else { return best };
        let price = 8.0 * self.pass.tap_count() as f64;
        let found = samples.bits([&filter, &filter], self.rule.step) * count as f64 + price;
        if found < bits {
            (bits, best.filter_variant, best.filters) = (found, None, [filter; 2]);
        }
        let steep = samples.steep();
        let mixed = steep * 20 > samples.len() && (samples.len() - steep) * 20 > samples.len();
        if count >= 4 * FIT_FROM
            && mixed
            && let (Some(flat), Some(steep)) = (samples.filter(Some(0)), samples.filter(Some(1)))
            && samples.bits([&flat, &steep], self.rule.step) * count as f64 + 2.0 * price < bits
        {
            (best.filter_variant, best.filters, best.classes) = (None, [flat, steep], 2);
        }
        best
    }

    /// The shipped weights of errors for the step.
    fn variant(&self) -> u8 {
        match self.rule.step {
            1 => 0,
            3 => 1,
            ..=11 => 2,
            _ => 3,
        }
    }

    /// Parts of the expected error and the error itself, of some cells.
    fn error_fit(&self, own: &Coded<W>) -> ErrorFit {
        let (width, height) = (self.original.width, self.original.height);
        let mut rows = Vec::new();
        let stride = (width * height / 6000).max(1);
        let row_stride = stride.isqrt().max(1);
        let col_stride = stride.div_ceil(row_stride);
        let taps = self.pass.taps();
        let floor = as_error(u32::try_from(self.rule.step).unwrap_or(u32::MAX), self.rule.coarseness);
        for row in (1..height).step_by(row_stride) {
            for col in (2..width.saturating_sub(1)).step_by(col_stride) {
                if self.void.is_some_and(|void| void.row(row)[col] != 0) {
                    continue;
                }
                let mut parts = [0.0f32; ERROR_WEIGHTS];
                for (part, group) in parts.iter_mut().zip(self.pass.error_groups()) {
                    let sum: u32 = group.iter().map(|&tap| self.errors.run(&own.errors, tap, row, width)[col]).sum();
                    *part = sum as f32;
                }
                let near: [W; 4] = std::array::from_fn(|k| self.cells.run(&own.cells, taps[k], row, width)[col]);
                let [a, b, c, d] = near;
                let base = mean(a, b, c, d);
                let spread: u32 = near.iter().map(|x| x.minus(base).magnitude() >> 2).sum();
                let across = match self.pass {
                    Pass::C => a.plus(d).minus(b.plus(c)),
                    _ => a.plus(b).minus(c.plus(d)),
                };
                parts[3] = as_error(spread, self.rule.coarseness) as f32;
                parts[4] = as_error(across.magnitude() >> 1, self.rule.coarseness) as f32;
                let above = own.errors.run(row as isize - 1, 0, width);
                parts[5] = (above[col - 1] + 2 * above[col] + above[col + 1]) as f32;
                let line = own.errors.row(row);
                if self.rule.serial {
                    (parts[6], parts[7]) = (line[col - 1] as f32, line[col - 2] as f32);
                }
                parts[8] = floor as f32;
                rows.push((parts, line[col] as f32));
            }
        }
        ErrorFit::new(rows)
    }

    /// Codes the pass; `before` are the weights of errors that fitted the same pass of the coarser level.
    fn code(&self, before: Option<[u8; ERROR_WEIGHTS]>) -> Coded<W> {
        let mut params = self.filters();
        let count = self.original.width * self.original.height;
        if let (Some(codes), true) = (before, count > FIT_UP_TO) {
            // Terrain is alike from level to level, and a second run would cost as much as the first.
            params.set_codes(codes);
            params.weight_variant = None;
            return self.run(params);
        }
        let first = self.run(params);
        if count < 4 * FIT_FROM {
            return first;
        }
        let Some(codes) = self.error_fit(&first).codes(&first.params) else { return first };
        let mut params = first.params.clone();
        params.set_codes(codes);
        params.weight_variant = None;
        let second = self.run(params);
        if second.cost < first.cost { second } else { first }
    }
}

/// The cells of every level of a tile, as they should be, finest first, and where its voids are.
pub(super) struct Pyramid<'a, W> {
    levels: Vec<(Vec<W>, usize)>,
    shape: TileShape,
    voids: &'a [VoidLevel],
}

impl<'a, W: Word> Pyramid<'a, W> {
    /// Thins the cells out, level by level; `voids` are those of the levels or none.
    pub(super) fn new(xs: &[i64], shape: TileShape, levels: u8, voids: &'a [VoidLevel]) -> Self {
        let mut found: Vec<(Vec<W>, usize)> = vec![(xs.iter().map(|&x| W::from_wide(x)).collect(), shape.width)];
        for _ in 0..levels {
            let (cells, width) = &found[found.len() - 1];
            let thin = cells.chunks(*width).step_by(2).flat_map(|row| row.iter().step_by(2).copied()).collect();
            found.push((thin, width.div_ceil(2)));
        }
        Self { levels: found, shape, voids }
    }
}

/// A tile while its levels are coded, coarse to fine.
pub(super) struct TileEncoder<'a, W> {
    pyramid: &'a Pyramid<'a, W>,
    rule: TileRule,
    level: Level<W>,
    /// Fitted codes of the weights of errors, from the last level, for each pass.
    codes: [Option<[u8; ERROR_WEIGHTS]>; 3],
    pub(super) segments: [SegmentParts; SEGMENTS],
    /// The cells as the decoder will have them, when all levels are coded.
    pub(super) cells: Vec<W>,
    /// All bits so far, in 256ths, about.
    pub(super) cost: u64,
    /// What a trainer wants to see, when it asks for it.
    pub(super) observed: Option<Observed>,
}

/// Parameters and residuals of the passes, for training.
#[derive(Default)]
pub(super) struct Observed {
    pub(super) fitted: Vec<Fitted>,
    /// Residuals by table, symbol by symbol, one list for each pass.
    pub(super) spread: Vec<Vec<(u16, u8)>>,
}

impl<'a, W: Word> TileEncoder<'a, W> {
    /// Begins with the coarsest cell.
    pub(super) fn new(pyramid: &'a Pyramid<'a, W>, rule: TileRule) -> Self {
        let seed = &pyramid.levels[pyramid.levels.len() - 1].0;
        Self {
            pyramid,
            rule,
            level: Level::seed(seed[0]),
            codes: [None; 3],
            segments: Default::default(),
            cells: seed.clone(),
            cost: 0,
            observed: None,
        }
    }

    /// Codes a level; levels come one after the other, down to 0.
    pub(super) fn code_level(&mut self, l: u8) -> Result<()> {
        let Self { pyramid, rule, level, codes, segments, cost, observed, .. } = self;
        let (cells, width) = &pyramid.levels[usize::from(l)];
        let holes = pyramid.voids.get(usize::from(l));
        let parts = &mut segments[SEGMENTS - 1 - usize::from(l).min(SEGMENTS - 1)];
        let refined = refine(level, |pass, known, errors| {
            let (row, col) = pass.origin();
            let size = plane_shape(pass, pyramid.shape.at_level(l));
            if size.0 == 0 || size.1 == 0 {
                return Ok((Plane::new(size.0, size.1), Plane::new(size.0, size.1)));
            }
            let mut original = Plane::quarter(cells, *width, row, col);
            original.close();
            let void = holes.map(|holes| &holes.planes[pass as usize]);
            let task = Task { pass, original: &original, cells: known, errors, void, rule: *rule };
            let made = task.code(codes[pass as usize]);
            codes[pass as usize] = made.params.weight_variant.is_none().then_some(made.params.codes);
            *cost += made.cost;
            if let Some(observed) = observed {
                observed.fitted.push(Fitted {
                    pass: pass as usize,
                    serial: rule.serial,
                    step: rule.step,
                    cells: size.0 * size.1,
                    filter: made.params.filters[1].to_vec(),
                    codes: made.params.codes.to_vec(),
                });
                observed.spread.push(made.taken.iter().map(|r| (r.table.0, symbol_of(r.k >> r.raw))).collect());
            }
            write_pass(parts, &made, pass, *rule);
            Ok((made.cells, made.errors))
        })?;
        match l {
            0 => self.cells = refined.flat(),
            _ => {
                let finer = refined.level();
                self.level = finer;
            }
        }
        Ok(())
    }
}

/// Appends a pass to its segment.
fn write_pass<W: Word>(parts: &mut SegmentParts, made: &Coded<W>, pass: Pass, rule: TileRule) {
    made.params.write(&mut parts.side, pass, rule.serial);
    let set = table_set();
    parts.symbols.reserve(made.taken.len());
    for residual in &made.taken {
        let table = reshaped(residual.table, made.params.shape, made.params.shift);
        let k = residual.k >> residual.raw;
        let mut symbol = symbol_of(k);
        if set.freq(table)[usize::from(symbol)] == 0 {
            symbol = ESCAPE;
        }
        parts.symbols.push((table.0, symbol));
        if symbol == ESCAPE {
            super::level::put_escaped(&mut parts.raw, k);
        }
        if residual.raw > 0 {
            let raw = u32::from(residual.raw);
            let low = residual.k as u64 & (u64::MAX >> (64 - raw));
            parts.raw.put(low & 0xffff_ffff, raw.min(32));
            if raw > 32 {
                parts.raw.put(low >> 32, raw - 32);
            }
        }
    }
}
