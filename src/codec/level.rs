//! Levels of a tile: from one cell to all of them, each level from the coarser one in three passes.

use super::bits::{BitReader, BitWriter};
use super::mask::VoidLevel;
use super::params::PassParams;
use super::pass::{Ask, Residuals, TileRule, run_pass};
use super::plane::Plane;
use super::rans::Decoder;
use super::tables::{CENTRE, ESCAPE, TableSet, table_set};
use super::taps::{Known, PASSES, Pass};
use super::tile::TileShape;
use super::word::Word;
use crate::error::Result;

/// Number of levels of a tile above the finest: so many that the coarsest has one cell.
pub(super) fn levels(shape: TileShape) -> u8 {
    let side = shape.width.max(shape.height).max(1);
    (usize::BITS - (side - 1).leading_zeros()) as u8
}

/// A level with its errors: the start of the next finer one.
#[derive(Clone, Debug)]
pub(super) struct Level<W> {
    pub(super) cells: Plane<W>,
    pub(super) errors: Plane<u32>,
}

impl<W: Word> Level<W> {
    /// The coarsest level: one cell.
    pub(super) fn seed(cell: W) -> Self {
        Self { cells: Plane::framed(&[cell], 1), errors: Plane::framed(&[0], 1) }
    }

    /// The cells, row by row.
    pub(super) fn flat(&self) -> Vec<W> {
        (0..self.cells.height).flat_map(|row| self.cells.row(row).iter().copied()).collect()
    }
}

/// What the three passes of a level made, beside the coarser level that they began with.
pub(super) struct Refined<'a, W> {
    coarser: &'a Level<W>,
    cells: [Plane<W>; 3],
    errors: [Plane<u32>; 3],
}

impl<W: Word> Refined<'_, W> {
    /// The level as the start of a finer one.
    pub(super) fn level(&self) -> Level<W> {
        let [c, h, v] = &self.errors;
        let width = self.coarser.cells.width + self.cells[1].width;
        Level {
            cells: Plane::framed(&self.flat(), width),
            errors: Plane::framed(&Plane::merged([&self.coarser.errors, c, h, v]), width),
        }
    }

    /// The cells, row by row.
    pub(super) fn flat(&self) -> Vec<W> {
        let [c, h, v] = &self.cells;
        Plane::merged([&self.coarser.cells, c, h, v])
    }
}

/// Runs the three passes of a level; `run` gets each pass with what is known.
pub(super) fn refine<W: Word>(
    coarser: &Level<W>,
    mut run: impl FnMut(Pass, Known<'_, W>, Known<'_, u32>) -> Result<(Plane<W>, Plane<u32>)>,
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
}

impl<W: Word> Residuals<W> for Reading<'_> {
    #[inline(always)]
    fn next(&mut self, _: usize, _: usize, _: W, ask: Ask) -> i64 {
        let symbol = self.symbols.next(self.set.decoding(ask.table));
        let mut k = i64::from(symbol) - CENTRE;
        if symbol == ESCAPE {
            k = take_escaped(&mut self.raw);
        }
        if ask.raw > 0 {
            k = take_low(&mut self.raw, k, u32::from(ask.raw));
        }
        if ask.flip { k.wrapping_neg() } else { k }
    }
}

#[cold]
fn take_escaped(bits: &mut BitReader<'_>) -> i64 {
    bits.take_signed(6)
}

fn take_low(bits: &mut BitReader<'_>, k: i64, raw: u32) -> i64 {
    let mut low = bits.take(raw.min(32));
    if raw > 32 {
        low |= bits.take(raw - 32) << 32;
    }
    (k << raw) | low as i64
}

/// The passes that a segment holds, in their order.
pub(super) fn segment_levels(segment: usize, levels: u8) -> std::ops::Range<u8> {
    // Segment 0 holds level 3 and all coarser ones.
    match segment {
        0 => 3.min(levels)..levels,
        _ => (3 - segment as u8).min(levels)..(4 - segment as u8).min(levels),
    }
}

/// Decodes the levels of a segment, coarse to fine, down to `finest`.
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
) -> Result<Decoded<W>> {
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
    let mut reading =
        Reading { set: table_set(), symbols: Decoder::new(body.symbols, count)?, raw: BitReader::new(body.raw) };
    for (place, l) in span.clone().rev().enumerate() {
        if l < finest {
            // A small tile: the coarsest cell is all that was asked for.
            return Ok(Decoded::Level(level));
        }
        let refined = refine(&level, |pass, cells, errors| {
            let hole = voids.get(place).map(|level| &level.planes[pass as usize]);
            let size = plane_shape(pass, shape.at_level(l));
            if size.0 == 0 || size.1 == 0 {
                return Ok((Plane::new(size.0, size.1), Plane::new(size.0, size.1)));
            }
            let params = PassParams::read(side, pass, rule.serial)?;
            Ok(run_pass(pass, size, cells, errors, hole, &params, rule, &mut reading))
        })?;
        if l == finest {
            let cells = refined.flat();
            if l == span.start {
                side.check()?;
                reading.raw.check()?;
                reading.symbols.finish()?;
            }
            return Ok(Decoded::Cells(cells));
        }
        let finer = refined.level();
        level = finer;
    }
    side.check()?;
    reading.raw.check()?;
    reading.symbols.finish()?;
    Ok(Decoded::Level(level))
}

/// What a segment decodes to: the start of the next one, or the cells that were asked for.
pub(super) enum Decoded<W> {
    /// A level and its errors.
    Level(Level<W>),
    /// The cells of the level that was asked for, row by row.
    Cells(Vec<W>),
}

/// The parts of a segment beside its parameters: raw bits and symbols.
#[derive(Clone, Copy, Debug)]
pub(super) struct SegmentBody<'a> {
    pub(super) raw: &'a [u8],
    pub(super) symbols: &'a [u8],
}

/// Writes an escaped residual.
pub(super) fn put_escaped(bits: &mut BitWriter, k: i64) {
    bits.put_signed(k, 6);
}
