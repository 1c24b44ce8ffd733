//! Encodes the levels of a tile.

use super::bands::Bands;
use super::bits::BitWriter;
use super::context::{Asks, TileRule};
use super::copies::{Still, Writing, code_copies};
use super::fit::{ErrorFit, Samples};
use super::level::{Level, plane_shape, refine};
use super::mask::VoidLevel;
use super::params::{ERROR_WEIGHTS, PassParams, SERIAL_UP_TO};
use super::pass::{floor_of, mean, pairs, run_pass, spread_and_across};
use super::plane::Plane;
use super::rans;
use super::tables::{ESCAPE, VARIANTS, table_set};
use super::take::{Taken, symbol_of};
use super::taps::{Known, Pass};
use super::tile::{SEGMENTS, TileShape};
use super::training::Fitted;
use super::word::Word;
use super::zones::{LevelZones, Zones};
use crate::error::Result;

/// Cells of a pass from which on filters are fitted.
const FIT_FROM: usize = 600;
/// Cells of which a sample of a pass consists, about.
const SAMPLED: usize = 20_000;

/// One segment in the making.
#[derive(Default)]
pub(super) struct SegmentParts {
    /// Where the tile tells copies.
    pub(super) copies: Option<Writing>,
    pub(super) side: BitWriter,
    raw: BitWriter,
    symbols: Vec<(u16, u8)>,
    /// Cells that hold something.
    held: usize,
}

impl SegmentParts {
    /// Parameters, and copies, raw bits and symbols as bytes.
    pub(super) fn finish(self) -> (BitWriter, Option<Vec<u8>>, Vec<u8>, Vec<u8>) {
        let set = table_set();
        let symbols = rans::encode(&self.symbols, rans::lanes_for(self.held), |table| set.encoding(table));
        (self.side, self.copies.map(|copies| copies.bits.finish()), self.raw.finish(), symbols)
    }
}

/// What became of a pass.
struct Coded<'a, W> {
    /// Of each zone.
    params: Vec<PassParams>,
    taken: Taken<'a, W>,
    cells: Plane<W>,
    errors: Plane<u16>,
    cost: u64,
}

/// Everything about a pass that does not change while its parameters are tried.
struct Task<'a, W> {
    pass: Pass,
    original: &'a Plane<W>,
    cells: Known<'a, W>,
    errors: Known<'a, u16>,
    still: Option<Still<'a, W>>,
    rule: TileRule,
    level: u8,
    zones: Option<LevelZones<'a>>,
}

impl<'a, W: Word> Task<'a, W> {
    /// Number of zones.
    fn zones(&self) -> usize {
        self.zones.map_or(1, |zones| zones.count())
    }

    /// Runs the pass on rows of the plane.
    fn run(&self, mut params: Vec<PassParams>, bands: Bands) -> Coded<'a, W> {
        let size = (self.original.width, self.original.height);
        let mut taken = Taken::new(self.original, self.rule.step);
        let Self { pass, still, rule, .. } = *self;
        let (cells, errors) =
            run_pass(pass, size, self.cells, self.errors, still, &params, self.zones, rule, bands, &mut taken);
        let mut cost = 0;
        let histograms = taken.histograms(&params, rule);
        for (params, histogram) in params.iter_mut().zip(histograms) {
            let (shape, shift, best) = histogram.best();
            (params.shape, params.shift) = (shape, shift);
            cost += best;
        }
        let mut side = BitWriter::default();
        PassParams::write_all(&params, &mut side, pass, self.level);
        // A sample stands for all rows, of which the parameters are written once.
        let cost =
            (u128::from(cost) * size.1 as u128 / bands.count(size.1) as u128) as u64 + ((side.bits() as u64) << 8);
        Coded { cost, params, taken, cells, errors }
    }

    /// Parameters of each zone for the passes of both kinds, or without serial ones.
    fn filters(&self, kinds: &[bool]) -> Vec<Vec<PassParams>> {
        let serial = kinds.contains(&true);
        let still = self.still.map(|still| still.marks);
        let zones = Samples::gather(self.pass, self.original, self.cells, still, self.rule.step, serial, self.zones);
        let found: Vec<_> = zones.iter().map(|samples| self.zone_filters(samples, kinds)).collect();
        (0..kinds.len()).map(|kind| found.iter().map(|zone| zone[kind].clone()).collect()).collect()
    }

    /// Filters of a zone: the best shipped ones, or fitted ones where they pay for themselves.
    fn zone_filters(&self, samples: &Samples, kinds: &[bool]) -> Vec<PassParams> {
        let (step, count) = (self.rule.step, samples.cells);
        let fits = if count < FIT_FROM { None } else { samples.fit(count >= 4 * FIT_FROM) };
        let best = |&serial: &bool| {
            let mut best = PassParams::shipped(self.pass, serial, self.variant());
            best.filters = PassParams::shipped(self.pass, serial, 0).filters;
            best.filter_variant = Some(0);
            if samples.len() < 8 {
                return best;
            }
            let mut bits = f64::INFINITY;
            for variant in 0..VARIANTS as u8 {
                let filters = PassParams::shipped(self.pass, serial, variant).filters;
                let found = samples.bits([&filters[0], &filters[1]], step) * count as f64;
                if found < bits {
                    (bits, best.filter_variant, best.filters) = (found, Some(variant), filters);
                }
            }
            let price = 8.0 * self.pass.tap_count() as f64;
            let Some(fits) = &fits else { return best };
            let filter = fits.all[usize::from(serial)];
            let found = samples.bits([&filter, &filter], step) * count as f64 + price;
            if found < bits {
                (bits, best.filter_variant, best.filters) = (found, None, [filter; 2]);
            }
            if let Some(filters) = &fits.by_class {
                let [flat, steep] = filters.map(|filters| filters[usize::from(serial)]);
                if samples.bits([&flat, &steep], step) * (count as f64) + 2.0 * price < bits {
                    (best.filter_variant, best.filters, best.classes) = (None, [flat, steep], 2);
                }
            }
            best
        };
        kinds.iter().map(best).collect()
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

    /// Parts of the expected error and the error itself, of some of the cells that ran, zone by zone.
    fn error_fits(&self, own: &Coded<'_, W>, bands: Bands) -> Vec<ErrorFit> {
        let (width, height) = (self.original.width, self.original.height);
        let mut rows: Vec<_> = (0..self.zones()).map(|_| Vec::new()).collect();
        let count = bands.count(height) * width;
        let stride = (count / (2000 * self.zones())).max(1);
        let row_stride = stride.isqrt().max(1);
        let col_stride = stride.div_ceil(row_stride);
        let taps = self.pass.taps();
        let floor = floor_of(self.rule);
        // Nothing is known above the first row of a band.
        for (row, _) in bands.rows(height).filter(|&(_, first)| !first).step_by(row_stride) {
            for col in (2..width.saturating_sub(1)).step_by(col_stride) {
                if self.still.is_some_and(|still| still.marks.row(row)[col] != 0) {
                    continue;
                }
                let mut parts = [0.0f32; ERROR_WEIGHTS];
                for (part, group) in parts.iter_mut().zip(self.pass.error_groups()) {
                    let error = |&tap| u32::from(self.errors.run(&own.errors, tap, row, width)[col]);
                    *part = group.iter().map(error).sum::<u32>() as f32;
                }
                let near: [W; 4] = std::array::from_fn(|k| self.cells.run(&own.cells, taps[k], row, width)[col]);
                let [a, b, c, d] = near;
                let (spread, across) =
                    spread_and_across(pairs(self.pass, near), mean(a, b, c, d), self.rule.coarseness);
                parts[3] = spread as f32;
                parts[4] = across as f32;
                let above = own.errors.run(row as isize - 1, 0, width);
                parts[5] = (u32::from(above[col - 1]) + 2 * u32::from(above[col]) + u32::from(above[col + 1])) as f32;
                let line = own.errors.row(row);
                if own.params[0].serial {
                    (parts[6], parts[7]) = (f32::from(line[col - 1]), f32::from(line[col - 2]));
                }
                parts[8] = floor as f32;
                rows[self.zones.map_or(0, |zones| zones.of(row, col))].push((parts, f32::from(line[col])));
            }
        }
        rows.into_iter().map(ErrorFit::new).collect()
    }

    /// Codes the pass; `serial` says which kind it must be of.
    fn code(&self, serial: Option<bool>) -> Coded<'a, W> {
        let kinds = match serial {
            _ if self.level > SERIAL_UP_TO => &[false][..],
            Some(false) => &[false],
            Some(true) => &[true],
            None => &[false, true],
        };
        let bands = Bands::of_cells(SAMPLED, self.original.width, self.original.height);
        let mut best: Option<Coded<'a, W>> = None;
        for params in self.filters(kinds) {
            let coded = self.run(params, bands);
            // Of few cells both kinds get weights of their own, in many the kinds differ more than by those.
            let coded = if bands == Bands::All { self.with_fitted_weights(coded, bands) } else { coded };
            // Serial passes take longer to decode: they have to be worth it.
            if best.as_ref().is_none_or(|best| coded.cost + coded.cost / 256 < best.cost) {
                best = Some(coded);
            }
        }
        let Some(best) = best else {
            return self.run(vec![PassParams::shipped(self.pass, false, 0); self.zones()], Bands::All);
        };
        match bands {
            Bands::All => best,
            Bands::Sample(_) => self.run(self.with_fitted_weights(best, bands).params, Bands::All),
        }
    }

    /// What became of the pass, or of a sample of it, with weights of errors that fit it where they are worth their
    /// bits.
    fn with_fitted_weights(&self, first: Coded<'a, W>, bands: Bands) -> Coded<'a, W> {
        if self.original.width * self.original.height < 4 * FIT_FROM {
            return first;
        }
        let mut params = first.params.clone();
        for (params, fit) in params.iter_mut().zip(self.error_fits(&first, bands)) {
            if let Some(codes) = fit.codes(params) {
                params.set_codes(codes);
                params.weight_variant = None;
            }
        }
        if params == first.params {
            return first;
        }
        let second = self.run(params, bands);
        if second.cost < first.cost { second } else { first }
    }
}

/// The cells of every level of a tile, as they should be, finest first, and where its voids are.
pub(super) struct Pyramid<'a, W> {
    levels: Vec<(Vec<W>, usize)>,
    pub(super) shape: TileShape,
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

    /// Number of levels above the finest.
    pub(super) fn depth(&self) -> usize {
        self.levels.len() - 1
    }

    /// The cells of the finest level, row by row, and where its voids are.
    pub(super) fn finest(&self) -> (&[W], Option<&Plane<u8>>) {
        (&self.levels[0].0, self.voids.first().map(|level| &level.cells))
    }
}

/// A tile while its levels are coded, coarse to fine.
pub(super) struct TileEncoder<'a, W> {
    pyramid: &'a Pyramid<'a, W>,
    rule: TileRule,
    level: Level<W>,
    pub(super) segments: [SegmentParts; SEGMENTS],
    /// The cells as the decoder will have them, when all levels are coded.
    pub(super) cells: Vec<W>,
    /// The kind of all passes, for training.
    pub(super) serial: Option<bool>,
    /// What a trainer wants to see, when it asks for it.
    pub(super) observed: Option<Observed>,
    /// Where parts of the tile have parameters of their own.
    pub(super) zones: Option<Zones>,
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
            segments: Default::default(),
            cells: if pyramid.levels.len() == 1 { seed.clone() } else { Vec::new() },
            serial: None,
            observed: None,
            zones: None,
        }
    }

    /// Codes a level; levels come one after the other, down to 0.
    pub(super) fn code_level(&mut self, l: u8) -> Result<()> {
        let Self { pyramid, rule, level, segments, serial, observed, zones, .. } = self;
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
            let copies = parts.copies.as_mut().map(|Writing { bits, contexts }| {
                code_copies(bits, contexts, pass, known, size, void, Some(&original))
            });
            let still = match &copies {
                Some(copies) => Some(copies.still()),
                None => void.map(|marks| Still { marks, copies: None }),
            };
            let voids =
                void.map_or(0, |void| (0..size.1).map(|row| void.row(row).iter().filter(|&&v| v != 0).count()).sum());
            parts.held += size.0 * size.1 - voids;
            let zones = zones.as_ref().and_then(|zones| zones.at_level(l));
            let task = Task { pass, original: &original, cells: known, errors, still, rule: *rule, level: l, zones };
            let made = task.code(*serial);
            if let Some(observed) = observed {
                observed.fitted.push(Fitted {
                    pass: pass as usize,
                    serial: made.params[0].serial,
                    step: rule.step,
                    cells: size.0 * size.1,
                    filter: made.params[0].filters[1].to_vec(),
                    codes: made.params[0].codes.to_vec(),
                });
                let asks = Asks::new(&[PassParams { shape: 0, shift: 0, ..made.params[0].clone() }], *rule);
                let spread = made.taken.residuals.iter().zip(&made.taken.contexts).map(|(k, &context)| {
                    let ask = asks.of(context);
                    (ask.table.0, symbol_of(k.wide() >> ask.raw))
                });
                observed.spread.push(spread.collect());
            }
            write_pass(parts, &made, pass, l, *rule);
            Ok((made.cells, made.errors))
        })?;
        match l {
            0 => refined.rows(|row| self.cells.extend_from_slice(row)),
            _ => {
                let finer = refined.level();
                self.level = finer;
            }
        }
        Ok(())
    }
}

/// Appends a pass to its segment.
fn write_pass<W: Word>(parts: &mut SegmentParts, made: &Coded<'_, W>, pass: Pass, l: u8, rule: TileRule) {
    PassParams::write_all(&made.params, &mut parts.side, pass, l);
    let set = table_set();
    let asks = Asks::new(&made.params, rule);
    parts.symbols.reserve(made.taken.residuals.len());
    for (&k, &context) in made.taken.residuals.iter().zip(&made.taken.contexts) {
        let (ask, residual) = (asks.of(context), k.wide());
        let k = residual >> ask.raw;
        let mut symbol = symbol_of(k);
        if set.freq(ask.table)[usize::from(symbol)] == 0 {
            symbol = ESCAPE;
        }
        parts.symbols.push((ask.table.0, symbol));
        if symbol == ESCAPE {
            super::level::put_escaped(&mut parts.raw, k);
        }
        if ask.raw > 0 {
            let raw = u32::from(ask.raw);
            let low = residual as u64 & (u64::MAX >> (64 - raw));
            parts.raw.put(low & 0xffff_ffff, raw.min(32));
            if raw > 32 {
                parts.raw.put(low >> 32, raw - 32);
            }
        }
    }
}
