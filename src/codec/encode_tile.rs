//! Cells of a tile to segments.

use super::Cells;
use super::bits::BitWriter;
use super::context::{TileRule, greatest_coarseness, usual_coarseness};
use super::copies::{Writing, are_frequent};
use super::encode::{Pyramid, SegmentParts, TileEncoder};
use super::header::Header;
use super::level::{levels, segment_levels};
use super::mapping::Mapping;
use super::mask::{encode_voids, void_levels};
use super::parts::put_part;
use super::patches::write_patches;
use super::restore::{Restored, broken_cells, cell_bits, fill_voids};
use super::tile::{BandRule, Bound, EncodedTile, SEGMENTS, TileShape};
use super::values::{Mapped, find_voids, map_cells, void_bits};
use super::word::Word;
use super::zones::ZONES_IN;
use crate::error::{Error, ErrorKind, Result};
use crate::grid::SampleType;

/// Bits of the range from which on residuals cost so much that copies may be worth telling.
const COPIES_FROM: u32 = 18;

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

struct Attempt {
    tile: EncodedTile,
    patches: usize,
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
    let (mut copies, mut zones) = (false, None);
    let (mut parts, mut decoded_xs): ([SegmentParts; SEGMENTS], Option<Vec<W>>) = Default::default();
    if mapping.range_bits > 0 {
        coarseness = coarseness_of(xs, voids, shape.width, mapping.step).min(greatest_coarseness(mapping.range_bits));
        let pyramid = Pyramid::<W>::new(xs, shape, levels, &holes);
        let mut coded = TileEncoder::new(&pyramid, TileRule { step: mapping.step, coarseness });
        copies = mapping.step == 1 && mapping.range_bits >= COPIES_FROM && are_frequent(xs, shape.width);
        if copies {
            coded.segments.iter_mut().for_each(|parts| parts.copies = Some(Writing::new()));
        }
        coded.zones = pyramid.divide(mapping.step);
        for level in (0..levels).rev() {
            coded.code_level(level)?;
        }
        (parts, decoded_xs, zones) = (coded.segments, Some(coded.cells), coded.zones);
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
        zones: zones.as_ref().map_or(1, |zones| zones.count),
        patched: !broken.is_empty(),
        mapping,
    };
    let mut tile = EncodedTile::default();
    for (index, (parts, segment)) in parts.into_iter().zip(&mut tile.segments).enumerate() {
        let mut side = BitWriter::default();
        if index == 0 {
            header.write(&mut side, rule.sample, levels);
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
        if let Some(zones) = zones.as_ref().filter(|_| index == ZONES_IN) {
            put_part(segment, &zones.encode(shape));
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

/// The bits that most voids have, where the band's are not the commonest.
fn commonest_void(cells: &Cells, voids: &[u8], rule: &BandRule) -> Option<u64> {
    let mut counts = std::collections::BTreeMap::new();
    for (index, _) in voids.iter().enumerate().filter(|&(_, &void)| void != 0) {
        *counts.entry(cell_bits(cells, index)).or_insert(0usize) += 1;
    }
    let (&bits, _) = counts.iter().max_by_key(|&(&bits, &count)| (count, std::cmp::Reverse(bits)))?;
    (bits != void_bits(rule)).then_some(bits)
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
