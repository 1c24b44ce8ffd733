//! One tile of one band: cells to segments and back.

use super::Cells;
use super::bits::{BitReader, BitWriter};
use super::context::{TileRule, greatest_coarseness, usual_coarseness};
use super::copies::{Writing, are_frequent};
use super::encode::{Pyramid, SegmentParts, TileEncoder};
use super::level::{Level, SegmentBody, decode_segment, levels, segment_levels};
use super::mapping::{Mapping, Meaning};
use super::mask::{decode_voids, encode_voids, void_levels};
use super::plane::Plane;
use super::restore::{Restored, broken_cells, cell_bits, fill_voids, set_cell_bits};
use super::values::{Mapped, find_voids, map_cells, void_bits};
use super::word::Word;
use crate::error::{Error, ErrorKind, Result};
use crate::grid::SampleType;

/// Number of segments of an encoded tile, coarse to fine.
pub const SEGMENTS: usize = 4;

/// The coarsest level of a tile: every 64th cell of every 64th row.
pub const TOP_LEVEL: u8 = 6;

/// Greatest side of a tile, in cells.
pub const MAX_TILE_SIDE: usize = 4096;

/// Size of a tile in cells; at the right and lower edge of a raster it may be smaller than the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TileShape {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl TileShape {
    /// The shape of a level: `ceil(side / 2^level)`.
    #[must_use]
    pub fn at_level(self, level: u8) -> Self {
        let step = 1usize.checked_shl(u32::from(level)).unwrap_or(usize::MAX);
        Self { width: self.width.div_ceil(step), height: self.height.div_ceil(step) }
    }

    /// Number of cells.
    pub fn cells(self) -> usize {
        self.width * self.height
    }

    fn check(self) -> Result<()> {
        match (1..=MAX_TILE_SIDE).contains(&self.width) && (1..=MAX_TILE_SIDE).contains(&self.height) {
            true => Ok(()),
            false => Err(Error::new(ErrorKind::Usage, format!("a tile has 1 to {MAX_TILE_SIDE} cells a side"))),
        }
    }
}

/// How far a decoded cell may be from the original.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// Every cell comes back with the same bits.
    Lossless,
    /// At most so far from the original, in stored values; more than 0, finite.
    MaxError(f64),
}

/// What a decoder must know of a band, and an encoder has to keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandRule {
    /// Type of the cells.
    pub sample: SampleType,
    /// Value of the cells without data, as the bits of the type (little-endian, zero-extended). Cells that hold
    /// exactly these bits come back exactly; no other cell is ever decoded onto them.
    pub nodata: Option<u64>,
    /// The guaranteed error.
    pub bound: Bound,
}

/// A tile as bytes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EncodedTile {
    /// Coarse to fine; a segment may be empty.
    pub segments: [Vec<u8>; SEGMENTS],
}

/// How many of the first segments a level needs.
pub fn segments_for(level: u8) -> usize {
    SEGMENTS - usize::from(level).min(SEGMENTS - 1)
}

/// Encodes the cells of a tile.
///
/// # Errors
/// When the cells are not of the rule's type or do not fill the shape, or the bound is no number above 0.
pub fn encode_tile(cells: &Cells, shape: TileShape, rule: &BandRule) -> Result<EncodedTile> {
    shape.check()?;
    if let Bound::MaxError(bound) = rule.bound
        && !(bound > 0.0 && bound.is_finite())
    {
        return Err(Error::new(ErrorKind::Usage, format!("a greatest error of {bound}: expected a number above 0")));
    }
    if cells.sample() != rule.sample || cells.len() != shape.cells() || cells.is_empty() {
        return Err(Error::new(ErrorKind::Usage, "the cells do not fit the tile"));
    }
    let voids = find_voids(cells, rule);
    let first = attempt(cells, shape, rule, &voids, false)?;
    // Cells that break the promise are written out one by one; with many of them floats are kept bit by bit.
    if first.patches > cells.len() / 50 && matches!(rule.sample, SampleType::F32 | SampleType::F64) {
        let second = attempt(cells, shape, rule, &voids, true)?;
        if second.tile.bytes() < first.tile.bytes() {
            return Ok(second.tile);
        }
    }
    Ok(first.tile)
}

impl EncodedTile {
    /// Bytes of all segments.
    pub fn bytes(&self) -> usize {
        self.segments.iter().map(Vec::len).sum()
    }
}

struct Attempt {
    tile: EncodedTile,
    patches: usize,
}

/// What stands before the passes of a tile.
#[derive(Clone, Debug)]
struct Header {
    mapping: Mapping,
    /// Whether some cells are voids, and whether the coarsest is.
    voids: Option<bool>,
    /// Bits of the voids, where they are not those of the band.
    void_bits: Option<u64>,
    coarseness: u32,
    /// Whether copies are told.
    copies: bool,
    patched: bool,
    /// The coarsest cell.
    seed: i64,
}

impl Header {
    fn write(&self, bits: &mut BitWriter, sample: SampleType) {
        bits.put(u64::from(self.voids.is_some()), 1);
        if let Some(top) = self.voids {
            bits.put(u64::from(top), 1);
            if matches!(sample, SampleType::F32 | SampleType::F64) {
                bits.put(u64::from(self.void_bits.is_some()), 1);
            }
            if let Some(void) = self.void_bits {
                put_cell(bits, void, sample);
            }
        }
        bits.put(u64::from(self.patched), 1);
        self.mapping.write(bits);
        if self.mapping.range_bits > 0 {
            let usual = self.coarseness == usual_coarseness(self.mapping.step);
            bits.put(u64::from(!usual), 1);
            if !usual {
                bits.put(u64::from(self.coarseness), 6);
            }
            if self.mapping.step == 1 {
                bits.put(u64::from(self.copies), 1);
            }
            bits.put_signed(self.seed, self.mapping.range_bits.min(60));
        }
    }

    fn read(bits: &mut BitReader<'_>, rule: &BandRule) -> Result<Self> {
        let sample = rule.sample;
        let is_float = matches!(sample, SampleType::F32 | SampleType::F64);
        let (mut voids, mut void_bits) = (None, None);
        if bits.take(1) == 1 {
            if !is_float && rule.nodata.is_none() {
                return Err(Error::new(
                    ErrorKind::Corrupt,
                    "a tile of integers has voids, and its band no nodata value",
                ));
            }
            voids = Some(bits.take(1) == 1);
            if is_float && bits.take(1) == 1 {
                void_bits = Some(take_cell(bits, sample));
            }
        }
        let patched = bits.take(1) == 1;
        let mapping = Mapping::read(bits, sample)?;
        if rule.bound == Bound::Lossless && (mapping.step > 1 || matches!(mapping.meaning, Meaning::Fixed { .. })) {
            return Err(Error::new(ErrorKind::Corrupt, "a tile of a lossless band has lost something"));
        }
        let (mut copies, mut seed) = (false, 0);
        let mut coarseness = usual_coarseness(mapping.step);
        if mapping.range_bits > 0 {
            if bits.take(1) == 1 {
                coarseness = bits.take(6) as u32;
                let greatest = greatest_coarseness(mapping.range_bits);
                if coarseness > greatest {
                    return Err(Error::new(
                        ErrorKind::Corrupt,
                        format!("a tile's errors are coarsened by {coarseness} bits; at most {greatest} are allowed"),
                    ));
                }
            }
            copies = mapping.step == 1 && bits.take(1) == 1;
            seed = bits.take_signed(mapping.range_bits.min(60));
        }
        bits.check()?;
        Ok(Self { mapping, voids, void_bits, coarseness, copies, patched, seed })
    }
}

fn put_cell(bits: &mut BitWriter, value: u64, sample: SampleType) {
    let width = sample.bytes() as u32 * 8;
    bits.put(value & 0xffff_ffff, width.min(32));
    if width > 32 {
        bits.put(value >> 32, width - 32);
    }
}

fn take_cell(bits: &mut BitReader<'_>, sample: SampleType) -> u64 {
    let width = sample.bytes() as u32 * 8;
    let low = bits.take(width.min(32));
    if width > 32 { low | bits.take(width - 32) << 32 } else { low }
}

/// The bits that most voids have, where the band's are not the commonest.
fn commonest_void(cells: &Cells, voids: &[u8], rule: &BandRule) -> Option<u64> {
    let mut counts = std::collections::BTreeMap::new();
    for (index, _) in voids.iter().enumerate().filter(|&(_, &void)| void != 0) {
        *counts.entry(cell_bits(cells, index)).or_insert(0usize) += 1;
    }
    let (&bits, _) = counts.iter().max_by_key(|&(&bits, &count)| (count, std::cmp::Reverse(bits)))?;
    (bits != void_bits(rule)).then_some(bits)
}

/// Bits of the range from which on residuals cost so much that copies may be worth telling.
const COPIES_FROM: u32 = 18;

/// Which segment holds a cell: that of the coarsest level that has it.
fn segment_of(index: usize, width: usize) -> usize {
    let (row, col) = (index / width, index % width);
    let level = (row | col).trailing_zeros().min(SEGMENTS as u32 - 1) as usize;
    SEGMENTS - 1 - level
}

fn attempt(cells: &Cells, shape: TileShape, rule: &BandRule, voids: &[u8], exact: bool) -> Result<Attempt> {
    let Mapped { mapping, mut xs } = map_cells(cells, voids, rule, exact);
    if let (Some(0..), Some(first)) =
        (voids.first().filter(|&&void| void != 0), voids.iter().position(|&void| void == 0))
    {
        // Predictions have to begin with something.
        xs[0] = xs[first];
    }
    if mapping.range_bits > 31 {
        finish::<i64>(cells, shape, rule, voids, mapping, &xs)
    } else {
        finish::<i32>(cells, shape, rule, voids, mapping, &xs)
    }
}

fn finish<W: Word>(
    cells: &Cells,
    shape: TileShape,
    rule: &BandRule,
    voids: &[u8],
    mapping: Mapping,
    xs: &[i64],
) -> Result<Attempt> {
    let levels = levels(shape);
    let holes = if voids.is_empty() { Vec::new() } else { void_levels(voids, shape, levels) };
    let mut coarseness = usual_coarseness(mapping.step);
    let mut copies = false;
    let (mut parts, mut decoded_xs): ([SegmentParts; SEGMENTS], Option<Vec<W>>) = Default::default();
    if mapping.range_bits > 0 {
        coarseness = coarseness_of(xs, voids, shape.width, mapping.step).min(greatest_coarseness(mapping.range_bits));
        let pyramid = Pyramid::<W>::new(xs, shape, levels, &holes);
        let mut coded = TileEncoder::new(&pyramid, TileRule { step: mapping.step, coarseness });
        copies = mapping.step == 1 && mapping.range_bits >= COPIES_FROM && are_frequent(xs, shape.width);
        if copies {
            coded.segments.iter_mut().for_each(|parts| parts.copies = Some(Writing::new()));
        }
        for level in (0..levels).rev() {
            coded.code_level(level)?;
        }
        (parts, decoded_xs) = (coded.segments, Some(coded.cells));
    }
    let mut decoded = Restored::new(&mapping, rule, cells.len());
    match &decoded_xs {
        Some(xs) => decoded.push(xs),
        None => decoded.fill(W::default(), cells.len()),
    }
    let mut decoded = decoded.finish();
    let commonest = commonest_void(cells, voids, rule);
    fill_voids(&mut decoded, voids, commonest.unwrap_or(void_bits(rule)));
    let broken = broken_cells(cells, &decoded, rule);
    let header = Header {
        seed: xs[0],
        voids: (!voids.is_empty()).then(|| voids[0] != 0),
        void_bits: commonest,
        coarseness,
        copies,
        patched: !broken.is_empty(),
        mapping,
    };
    let mut tile = EncodedTile::default();
    for (index, (parts, segment)) in parts.into_iter().zip(&mut tile.segments).enumerate() {
        let mut side = BitWriter::default();
        if index == 0 {
            header.write(&mut side, rule.sample);
        }
        let (passes, copies, raw, symbols) = parts.finish();
        if header.patched {
            write_patches(&mut side, cells, shape, &broken, index);
        }
        side.append(&passes);
        let span = segment_levels(index, levels);
        let mask = match header.voids {
            Some(top) => encode_voids(&holes, u8::from(top), shape, span.clone()),
            None => Vec::new(),
        };
        if index > 0 && (span.is_empty() || side.bits() + mask.len() + raw.len() + symbols.len() == 0) {
            // Nothing to say: the segment stays empty.
            continue;
        }
        put_part(segment, &side.finish());
        if header.voids.is_some() {
            put_part(segment, &mask);
        }
        if header.mapping.range_bits > 0 {
            if let Some(copies) = &copies {
                put_part(segment, copies);
            }
            put_part(segment, &raw);
            segment.extend_from_slice(&symbols);
        }
    }
    Ok(Attempt { tile, patches: broken.len() })
}

/// How much errors are coarsened: as usual for the step, unless cells are far from the mean of their neighbours; then so
/// that nine of ten errors stay well below the limit.
pub(super) fn coarseness_of(xs: &[i64], voids: &[u8], width: usize, step: i64) -> u32 {
    let mut far: Vec<u64> = Vec::new();
    let rows: Vec<&[i64]> = xs.chunks_exact(width).collect();
    let stride = (rows.len() / 64).max(1);
    for row in (1..rows.len().saturating_sub(1)).step_by(stride) {
        for col in (1..width.saturating_sub(1)).step_by((width / 64).max(1)) {
            let void = |row: usize, col: usize| voids.get(row * width + col).is_some_and(|&void| void != 0);
            if void(row, col) || void(row - 1, col) || void(row + 1, col) || void(row, col - 1) || void(row, col + 1) {
                continue;
            }
            let above = |x: i64| x.wrapping_sub(rows[row - 1][col]);
            let mean = above(rows[row + 1][col])
                .wrapping_add(above(rows[row][col - 1]))
                .wrapping_add(above(rows[row][col + 1]))
                >> 2;
            far.push(above(rows[row][col]).wrapping_sub(mean).unsigned_abs());
        }
    }
    let usual = usual_coarseness(step);
    if far.is_empty() {
        return usual;
    }
    let place = far.len() * 9 / 10;
    let (_, &mut far, _) = far.select_nth_unstable(place);
    (64 - far.leading_zeros() + 2).saturating_sub(13).max(usual)
}

/// Cells of a segment that are written out: number, distances, bits.
fn write_patches(bits: &mut BitWriter, cells: &Cells, shape: TileShape, broken: &[usize], segment: usize) {
    let mine: Vec<usize> = broken.iter().copied().filter(|&index| segment_of(index, shape.width) == segment).collect();
    bits.put_number(mine.len() as u64, 2);
    let mut next = 0;
    for index in mine {
        bits.put_number((index - next) as u64, 8);
        put_cell(bits, cell_bits(cells, index), cells.sample());
        next = index + 1;
    }
}

/// Reads the patches of a segment: cell of the tile and bits.
fn read_patches(
    bits: &mut BitReader<'_>,
    sample: SampleType,
    shape: TileShape,
    segment: usize,
    patches: &mut Vec<(usize, u64)>,
) -> Result<()> {
    let count = bits.take_number(2);
    if count > shape.cells() as u64 {
        return Err(Error::new(ErrorKind::Corrupt, "a segment has more patches than cells"));
    }
    let mut next = 0u64;
    for _ in 0..count {
        let index = next.saturating_add(bits.take_number(8));
        if index >= shape.cells() as u64 {
            return Err(Error::new(ErrorKind::Corrupt, "a patch lies outside of its tile"));
        }
        // Coarse levels would be other cells than those of the finest one.
        if segment_of(index as usize, shape.width) != segment {
            return Err(Error::new(ErrorKind::Corrupt, "a patch stands in another segment than its cell"));
        }
        patches.push((index as usize, take_cell(bits, sample)));
        bits.check()?;
        next = index + 1;
    }
    Ok(())
}

/// Appends a part of a segment: its length, seven bits a byte, and its bytes.
fn put_part(segment: &mut Vec<u8>, part: &[u8]) {
    let mut length = part.len();
    while length >= 128 {
        segment.push(length as u8 | 128);
        length >>= 7;
    }
    segment.push(length as u8);
    segment.extend_from_slice(part);
}

/// Reads a part of a segment and leaves what follows it.
fn take_part<'a>(segment: &mut &'a [u8]) -> Result<&'a [u8]> {
    let early = || Error::new(ErrorKind::Corrupt, "a segment ends early");
    let mut length = 0u64;
    for place in 0..5 {
        let (&byte, rest) = segment.split_first().ok_or_else(early)?;
        *segment = rest;
        length |= u64::from(byte & 127) << (7 * place);
        if byte == 0 && place > 0 {
            return Err(Error::new(ErrorKind::Corrupt, "the length of a part of a segment has needless bytes"));
        }
        if byte < 128 {
            let length = usize::try_from(length).map_err(|_| early())?;
            let (part, rest) = segment.split_at_checked(length).ok_or_else(early)?;
            *segment = rest;
            return Ok(part);
        }
    }
    Err(Error::new(ErrorKind::Corrupt, "the length of a part of a segment has too many bytes"))
}

/// Decodes a level of a tile from its first segments (at least [`segments_for`] of them).
///
/// # Errors
/// [`ErrorKind::Corrupt`] when the bytes are no tile of that shape and rule.
pub fn decode_tile(segments: &[&[u8]], shape: TileShape, rule: &BandRule, level: u8) -> Result<Cells> {
    shape.check()?;
    let segments = segments
        .get(..segments_for(level))
        .ok_or_else(|| Error::new(ErrorKind::Corrupt, "a segment of the tile is missing"))?;
    let mut rest = segments[0];
    let mut bits = BitReader::new(take_part(&mut rest)?);
    let header = Header::read(&mut bits, rule)?;
    if header.mapping.range_bits > 31 {
        decode_levels::<i64>(segments, &header, (bits, rest), shape, rule, level)
    } else {
        decode_levels::<i32>(segments, &header, (bits, rest), shape, rule, level)
    }
}

fn decode_levels<W: Word>(
    segments: &[&[u8]],
    header: &Header,
    (first_bits, first_rest): (BitReader<'_>, &[u8]),
    shape: TileShape,
    rule: &BandRule,
    finest: u8,
) -> Result<Cells> {
    let levels = levels(shape);
    let tile_rule = TileRule { step: header.mapping.step, coarseness: header.coarseness };
    let asked = shape.at_level(finest);
    let mut restored = Restored::new(&header.mapping, rule, asked.cells());
    let mut level = Some(Level::seed(W::from_wide(header.seed)));
    let mut holes = header.voids.map(|top| Plane::framed(&[u8::from(top)], 1));
    let mut patches = Vec::new();
    for (index, segment) in segments.iter().enumerate() {
        let span = segment_levels(index, levels);
        let (mut bits, mut rest) = match index {
            0 => (first_bits.clone(), first_rest),
            _ if span.is_empty() && segment.is_empty() => continue,
            _ if span.is_empty() => {
                return Err(Error::new(ErrorKind::Corrupt, format!("segment {index} should be empty")));
            }
            _ if segment.is_empty() => {
                if header.mapping.range_bits > 0 || header.patched {
                    return Err(Error::new(ErrorKind::Corrupt, format!("segment {index} is empty")));
                }
                // Its parts are empty too: a mask may need no bytes.
                (BitReader::new(&[]), if header.voids.is_some() { &[0][..] } else { &[] })
            }
            _ => {
                let mut rest = *segment;
                (BitReader::new(take_part(&mut rest)?), rest)
            }
        };
        if header.patched {
            read_patches(&mut bits, rule.sample, shape, index, &mut patches)?;
            bits.check()?;
        }
        if header.mapping.range_bits == 0 {
            // There are no passes, and so no parameters.
            bits.finish()?;
        }
        let mut void_levels = Vec::new();
        if let Some(coarser) = &holes {
            void_levels = decode_voids(take_part(&mut rest)?, coarser, shape, span.clone())?;
        }
        if header.mapping.range_bits > 0 {
            let copies = if header.copies { Some(take_part(&mut rest)?) } else { None };
            let raw = take_part(&mut rest)?;
            let body = SegmentBody { copies, raw, symbols: rest };
            if let Some(coarser) = level {
                let span = span.clone();
                level = decode_segment(
                    &body,
                    &mut bits,
                    coarser,
                    shape,
                    span,
                    finest,
                    tile_rule,
                    &void_levels,
                    &mut restored,
                )?;
            }
            rest = &[];
        }
        if !rest.is_empty() {
            return Err(Error::new(ErrorKind::Corrupt, format!("segment {index} has bytes after its end")));
        }
        // The level that was asked for may end amid a segment: nothing behind it is looked at.
        if let Some(found) =
            void_levels.into_iter().take(span.end.saturating_sub(finest.max(span.start)).into()).next_back()
        {
            holes = Some(found.cells);
        }
    }
    match level {
        _ if header.mapping.range_bits == 0 => restored.fill(W::default(), asked.cells()),
        Some(level) => (0..level.cells.height).for_each(|row| restored.push(level.cells.row(row))),
        None => {}
    }
    let mut cells = restored.finish();
    if let Some(holes) = &holes {
        let flat: Vec<u8> = (0..holes.height).flat_map(|row| holes.row(row).to_vec()).collect();
        if flat.len() != cells.len() {
            return Err(Error::new(ErrorKind::Corrupt, "the tile's mask has another size"));
        }
        fill_voids(&mut cells, &flat, header.void_bits.unwrap_or(void_bits(rule)));
    }
    for (index, bits) in patches {
        let (row, col) = (index / shape.width, index % shape.width);
        let step = 1usize.checked_shl(u32::from(finest)).unwrap_or(usize::MAX);
        if row % step == 0 && col % step == 0 {
            set_cell_bits(&mut cells, (row / step) * asked.width + col / step, bits);
        }
    }
    match cells.len() == asked.cells() {
        true => Ok(cells),
        false => Err(Error::new(ErrorKind::Corrupt, "the tile has another number of cells")),
    }
}
