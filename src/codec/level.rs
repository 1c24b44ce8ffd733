//! Levels of a tile: from one cell to all of them, each level from the coarser one in three passes.

use super::bands::Bands;
use super::binary::BinaryDecoder;
use super::bits::{BitReader, BitWriter};
use super::context::{Ask, Asks, TileRule};
use super::copies::{Contexts, Still, code_copies};
use super::mask::VoidLevel;
use super::params::PassParams;
use super::pass::{Planned, Residuals, run_pass};
use super::plane::Plane;
use super::rans::Decoder;
use super::restore::Restored;
use super::tables::{CENTRE, ESCAPE, TableSet, table_set};
use super::taps::{Known, PASSES, Pass};
use super::tile::TileShape;
use super::word::Word;
use super::zones::Zones;
use crate::error::{Error, ErrorKind, Result};

/// Number of levels of a tile above the finest: so many that the coarsest has one cell.
pub(super) fn levels(shape: TileShape) -> u8 {
    let side = shape.width.max(shape.height).max(1);
    (usize::BITS - (side - 1).leading_zeros()) as u8
}

/// A level with its errors: the start of the next finer one.
#[derive(Clone, Debug)]
pub(super) struct Level<W> {
    pub(super) cells: Plane<W>,
    pub(super) errors: Plane<u16>,
}

impl<W: Word> Level<W> {
    /// The coarsest level: one cell.
    pub(super) fn seed(cell: W) -> Self {
        Self { cells: Plane::framed(&[cell], 1), errors: Plane::framed(&[0], 1) }
    }
}

/// What the three passes of a level made, beside the coarser level that they began with.
pub(super) struct Refined<'a, W> {
    coarser: &'a Level<W>,
    cells: [Plane<W>; 3],
    errors: [Plane<u16>; 3],
}

impl<W: Word> Refined<'_, W> {
    /// The level as the start of a finer one.
    pub(super) fn level(&self) -> Level<W> {
        let ([c, h, v], [c_errors, h_errors, v_errors]) = (&self.cells, &self.errors);
        Level {
            cells: Plane::woven([&self.coarser.cells, c, h, v]),
            errors: Plane::woven([&self.coarser.errors, c_errors, h_errors, v_errors]),
        }
    }

    /// The cells, row by row.
    pub(super) fn rows(&self, take: impl FnMut(&[W])) {
        let [c, h, v] = &self.cells;
        Plane::woven_rows([&self.coarser.cells, c, h, v], take);
    }
}

/// Runs the three passes of a level; `run` gets each pass with what is known.
pub(super) fn refine<W: Word>(
    coarser: &Level<W>,
    mut run: impl FnMut(Pass, Known<'_, W>, Known<'_, u16>) -> Result<(Plane<W>, Plane<u16>)>,
) -> Result<Refined<'_, W>> {
    let mut refined = Refined { coarser, cells: Default::default(), errors: Default::default() };
    for (index, pass) in PASSES.into_iter().enumerate() {
        let ([c, h, _], [c_errors, h_errors, _]) = (&refined.cells, &refined.errors);
        let cells = Known { a: &coarser.cells, c, h };
        let errors = Known { a: &coarser.errors, c: c_errors, h: h_errors };
        (refined.cells[index], refined.errors[index]) = run(pass, cells, errors)?;
    }
    Ok(refined)
}

/// Width and height of a pass's plane in a level of the given shape.
pub(super) fn plane_shape(pass: Pass, level: TileShape) -> (usize, usize) {
    let (row, col) = pass.origin();
    ((level.width + 1 - col) / 2, (level.height + 1 - row) / 2)
}

/// Residuals from a segment.
struct Reading<'a> {
    set: &'static TableSet,
    symbols: Decoder<'a>,
    raw: BitReader<'a>,
    /// Work rows: how residuals are stored, and their symbols.
    asks: Vec<Ask>,
    row: Vec<u8>,
}

impl Reading<'_> {
    /// Fails when more of the segment was used than there is.
    fn check(&self, side: &BitReader<'_>) -> Result<()> {
        side.check()?;
        self.raw.check()?;
        self.symbols.check()
    }

    /// Fails unless all of the segment was used.
    fn finish(self, side: &BitReader<'_>, copies: Option<(BinaryDecoder<'_>, Contexts)>) -> Result<()> {
        side.finish()?;
        if copies.is_some_and(|(bits, _)| !bits.is_done()) {
            return Err(Error::new(ErrorKind::Corrupt, "the tile's copies do not end where they should"));
        }
        self.raw.finish()?;
        self.symbols.finish()
    }

    /// What a symbol and its raw bits say.
    #[inline(always)]
    fn complete(raw: &mut BitReader<'_>, symbol: u8, ask: Ask) -> i64 {
        let mut k = i64::from(symbol) - CENTRE;
        if symbol == ESCAPE {
            k = take_escaped(raw);
        }
        if ask.raw > 0 {
            k = take_low(raw, k, u32::from(ask.raw));
        }
        k
    }
}

impl<W: Word> Residuals<W> for Reading<'_> {
    const KEEPS: bool = false;

    fn keep(&mut self, _: &Planned<'_, W>, _: &[W]) {}

    #[inline(always)]
    fn next(&mut self, asks: &Asks, _: usize, _: usize, _: W, context: u16, turn: W) -> W {
        let ask = asks.of(context);
        let symbol = self.symbols.next(self.set.decoding(ask.table));
        W::from_wide(Self::complete(&mut self.raw, symbol, ask)).turned(turn)
    }

    #[inline(always)]
    fn next_row(&mut self, asks: &Asks, _: usize, planned: &Planned<'_, W>, residuals: &mut [W]) {
        let Planned { contexts, turns, holes, .. } = *planned;
        // One thing at a time: symbols depend on each other and should not wait for anything else.
        self.asks.clear();
        let mut wide = 0;
        match holes {
            None => self.asks.extend(contexts[..residuals.len()].iter().map(|&context| asks.of(context))),
            Some(holes) => {
                // Without a branch: where the holes are is hard to foresee.
                self.asks.resize(residuals.len(), Ask::default());
                let mut held = 0;
                for (&context, &hole) in contexts.iter().zip(holes) {
                    self.asks[held] = asks.of(context);
                    held += usize::from(hole == 0);
                }
                self.asks.truncate(held);
            }
        }
        self.asks.iter().for_each(|ask| wide |= ask.raw);
        self.row.resize(self.asks.len(), 0);
        self.symbols.next_all(&mut self.row, |index| self.set.decoding(self.asks[index].table));
        let mut escaped = false;
        self.row.iter().for_each(|&symbol| escaped |= symbol == ESCAPE);
        if escaped || wide > 0 {
            for ((residual, &symbol), &ask) in residuals.iter_mut().zip(&self.row).zip(&self.asks) {
                *residual = W::from_wide(Self::complete(&mut self.raw, symbol, ask));
            }
        } else {
            for (residual, &symbol) in residuals.iter_mut().zip(&self.row) {
                *residual = W::from_wide(i64::from(symbol) - CENTRE);
            }
        }
        if let Some(holes) = holes {
            // So far they stand side by side; from the last one on each goes to its place.
            let mut held = self.row.len();
            for col in (0..residuals.len()).rev() {
                let is_held = holes[col] == 0;
                held -= usize::from(is_held);
                residuals[col] = if is_held { residuals[held] } else { W::default() };
            }
        }
        for (residual, &turn) in residuals.iter_mut().zip(turns) {
            *residual = residual.turned(turn);
        }
    }
}

#[cold]
fn take_escaped(bits: &mut BitReader<'_>) -> i64 {
    bits.take_signed(6)
}

#[inline(always)]
fn take_low(bits: &mut BitReader<'_>, k: i64, raw: u32) -> i64 {
    if raw > 32 {
        return take_lowest(bits, k, raw);
    }
    (k << raw) | bits.take(raw) as i64
}

#[cold]
fn take_lowest(bits: &mut BitReader<'_>, k: i64, raw: u32) -> i64 {
    let low = bits.take(32);
    (k << raw) | (low | bits.take(raw - 32) << 32) as i64
}

/// The passes that a segment holds, in their order.
pub(super) fn segment_levels(segment: usize, levels: u8) -> std::ops::Range<u8> {
    // Segment 0 holds level 3 and all coarser ones.
    match segment {
        0 => 3.min(levels)..levels,
        _ => (3 - segment as u8).min(levels)..(4 - segment as u8).min(levels),
    }
}

/// Decodes the levels of a segment, coarse to fine, down to `finest`, whose cells go to `restored`; any other level is
/// returned as the start of the next segment.
///
/// `voids` are those of the levels, coarse to fine, or none.
#[allow(clippy::too_many_arguments, reason = "a segment, where it belongs, and what is known of it")]
pub(super) fn decode_segment<W: Word>(
    body: &SegmentBody<'_>,
    side: &mut BitReader<'_>,
    mut level: Level<W>,
    shape: TileShape,
    span: std::ops::Range<u8>,
    finest: u8,
    rule: TileRule,
    voids: &[VoidLevel],
    zones: Option<&Zones>,
    restored: &mut Restored<'_>,
) -> Result<Option<Level<W>>> {
    let mut count = 0;
    for (place, l) in span.clone().rev().enumerate() {
        for (index, pass) in PASSES.into_iter().enumerate() {
            let (width, height) = plane_shape(pass, shape.at_level(l));
            count += width * height;
            if let Some(level) = voids.get(place) {
                let hole = &level.planes[index];
                count -= (0..hole.height).map(|row| hole.row(row).iter().filter(|&&v| v != 0).count()).sum::<usize>();
            }
        }
    }
    let mut reading = Reading {
        set: table_set(),
        symbols: Decoder::new(body.symbols, count)?,
        raw: BitReader::new(body.raw),
        asks: Vec::new(),
        row: Vec::new(),
    };
    let mut copies = body.copies.map(|bytes| (BinaryDecoder::new(bytes), Contexts::new()));
    for (place, l) in span.clone().rev().enumerate() {
        if l < finest {
            // A small tile: the coarsest cell is all that was asked for.
            return Ok(Some(level));
        }
        let refined = refine(&level, |pass, cells, errors| {
            let hole = voids.get(place).map(|level| &level.planes[pass as usize]);
            let size = plane_shape(pass, shape.at_level(l));
            if size.0 == 0 || size.1 == 0 {
                return Ok((Plane::new(size.0, size.1), Plane::new(size.0, size.1)));
            }
            let mut told = None;
            if let Some((bits, contexts)) = &mut copies {
                told = Some(code_copies(bits, contexts, pass, cells, size, hole, None));
                if bits.is_beyond() {
                    return Err(Error::new(ErrorKind::Corrupt, "the tile's copies end early"));
                }
            }
            let still = match &told {
                Some(copies) => Some(copies.still()),
                None => hole.map(|marks| Still { marks, copies: None }),
            };
            let zones = zones.and_then(|zones| zones.at_level(l));
            let params = PassParams::read_all(side, pass, l, zones.map_or(1, |zones| zones.count()))?;
            Ok(run_pass(pass, size, cells, errors, still, &params, zones, rule, Bands::All, &mut reading))
        })?;
        if l == finest {
            refined.rows(|row| restored.push(row));
            match l == span.start {
                true => reading.finish(side, copies)?,
                false => reading.check(side)?,
            }
            return Ok(None);
        }
        let finer = refined.level();
        level = finer;
    }
    reading.finish(side, copies)?;
    Ok(Some(level))
}

/// The parts of a segment beside its parameters: copies, raw bits and symbols.
#[derive(Clone, Copy, Debug)]
pub(super) struct SegmentBody<'a> {
    pub(super) copies: Option<&'a [u8]>,
    pub(super) raw: &'a [u8],
    pub(super) symbols: &'a [u8],
}

/// Writes an escaped residual.
pub(super) fn put_escaped(bits: &mut BitWriter, k: i64) {
    bits.put_signed(k, 6);
}
