//! Levels of a tile: from one cell to all of them, each level from the coarser one in three passes.

use super::bits::{BitReader, BitWriter};
use super::mask::VoidLevel;
use super::params::PassParams;
use super::pass::{Residuals, TileRule, run_pass};
use super::plane::Plane;
use super::rans::Decoder;
use super::tables::{CENTRE, ESCAPE, TableRef, TableSet, table_set};
use super::taps::{Known, PASSES};
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

    /// Puts four planes together.
    fn joined(cells: [&Plane<W>; 4], errors: [&Plane<u32>; 4]) -> Self {
        let width = cells[0].width + cells[2].width;
        Self {
            cells: Plane::framed(&Plane::merged(cells), width),
            errors: Plane::framed(&Plane::merged(errors), width),
        }
    }
}

/// Runs the three passes of a level; `run` gets each pass with what is known.
pub(super) fn refine<W: Word>(
    coarser: &Level<W>,
    mut run: impl FnMut(super::taps::Pass, Known<'_, W>, Known<'_, u32>) -> Result<(Plane<W>, Plane<u32>)>,
) -> Result<Level<W>> {
    let (mut c, mut c_errors) = (Plane::default(), Plane::default());
    let (mut h, mut h_errors) = (Plane::default(), Plane::default());
    let (mut v, mut v_errors) = (Plane::default(), Plane::default());
    for pass in PASSES {
        let cells = Known { a: &coarser.cells, c: &c, h: &h };
        let errors = Known { a: &coarser.errors, c: &c_errors, h: &h_errors };
        let (made, made_errors) = run(pass, cells, errors)?;
        match pass {
            super::taps::Pass::C => (c, c_errors) = (made, made_errors),
            super::taps::Pass::H => (h, h_errors) = (made, made_errors),
            super::taps::Pass::V => (v, v_errors) = (made, made_errors),
        }
    }
    Ok(Level::joined([&coarser.cells, &c, &h, &v], [&coarser.errors, &c_errors, &h_errors, &v_errors]))
}

/// Width and height of a pass's plane in a level of the given shape.
pub(super) fn plane_shape(pass: super::taps::Pass, level: TileShape) -> (usize, usize) {
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
    fn next(&mut self, _: usize, _: usize, _: W, table: TableRef, raw: u32, flip: bool) -> i64 {
        let symbol = self.symbols.next(self.set.decoding(table));
        let mut k = i64::from(symbol) - CENTRE;
        if symbol == ESCAPE {
            k = self.raw.take_signed(6);
        }
        if raw > 0 {
            k = take_low(&mut self.raw, k, raw);
        }
        if flip { k.wrapping_neg() } else { k }
    }
}

#[cold]
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
pub(super) fn decode_segment<W: Word>(
    body: &SegmentBody<'_>,
    side: &mut BitReader<'_>,
    mut level: Level<W>,
    shape: TileShape,
    span: std::ops::Range<u8>,
    finest: u8,
    rule: TileRule,
    voids: &[VoidLevel],
) -> Result<Level<W>> {
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
            return Ok(level);
        }
        level = refine(&level, |pass, cells, errors| {
            let hole = voids.get(place).map(|level| &level.planes[pass as usize]);
            let size = plane_shape(pass, shape.at_level(l));
            if size.0 == 0 || size.1 == 0 {
                return Ok((Plane::new(size.0, size.1), Plane::new(size.0, size.1)));
            }
            let params = PassParams::read(side, pass, rule.serial)?;
            Ok(run_pass(pass, size, cells, errors, hole, &params, rule, &mut reading))
        })?;
    }
    reading.raw.check()?;
    reading.symbols.finish()?;
    Ok(level)
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
