//! Segments of a tile to the cells of one of its levels.

use super::Cells;
use super::bits::BitReader;
use super::context::TileRule;
use super::header::Header;
use super::level::{Level, SegmentBody, decode_segment, levels, segment_levels};
use super::mask::decode_voids;
use super::parts::take_part;
use super::patches::read_patches;
use super::plane::Plane;
use super::restore::{Restored, fill_voids, set_cell_bits};
use super::tile::{BandRule, TileShape, segments_for};
use super::values::void_bits;
use super::word::Word;
use super::zones::{ZONES_IN, Zones};
use crate::error::{Error, ErrorKind, Result};

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
    let header = Header::read(&mut bits, rule, levels(shape))?;
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
    let mut zones = None;
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
            // Lengths of parts, and no part.
            1.. if segment.iter().all(|&byte| byte == 0) => {
                return Err(Error::new(ErrorKind::Corrupt, format!("segment {index} has bytes that say nothing")));
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
            if index == ZONES_IN && header.zones > 1 {
                zones = Some(Zones::decode(take_part(&mut rest)?, shape, header.zones)?);
            }
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
                    zones.as_ref(),
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
