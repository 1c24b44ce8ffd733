//! Zones of a tile: blocks of cells that share the parameters of their passes, where one kind of ground does not fit
//! all of a tile (plain and mountains, land and sea, surveys of different years).

use super::binary::{Adaptive, BinaryDecoder, BinaryEncoder};
use super::mask::Bits;
use super::tile::TileShape;
use crate::error::{Error, ErrorKind, Result};
use std::ops::Range;

/// Most zones of a tile.
pub(super) const MAX_ZONES: usize = 4;
/// Cells of a block's side, as a power of two.
pub(super) const BLOCK_BITS: u32 = 5;
/// The coarsest level whose passes have parameters for each zone.
pub(super) const ZONED_UP_TO: u8 = 1;
/// The segment that tells the zones: that of the coarsest level that needs them.
pub(super) const ZONES_IN: usize = 2;
/// Levels from which on a tile may have zones: with fewer it is no larger than 128 cells a side.
pub(super) const ZONED_FROM: u8 = 8;

/// Which zone each block of a tile belongs to.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Zones {
    /// Number of zones, 2 to [`MAX_ZONES`].
    pub(super) count: usize,
    /// Blocks of a row.
    across: usize,
    /// The zone of each block, row by row.
    of: Vec<u8>,
}

/// The zones as a pass of a level sees them.
#[derive(Clone, Copy, Debug)]
pub(super) struct LevelZones<'a> {
    zones: &'a Zones,
    /// Cells of the pass along a block's side, as a power of two.
    shift: u32,
}

/// Blocks across and down a tile.
pub(super) fn blocks(shape: TileShape) -> (usize, usize) {
    (shape.width.div_ceil(1 << BLOCK_BITS), shape.height.div_ceil(1 << BLOCK_BITS))
}

/// Contexts of the map.
struct Contexts {
    /// Whether the next candidate is the one: by whether the blocks to the left and above are alike.
    which: [[Adaptive; MAX_ZONES - 1]; 2],
}

/// Codes the map of a tile; `truth` is what to write, or nothing when reading.
fn code<B: Bits>(bits: &mut B, shape: TileShape, count: usize, truth: Option<&[u8]>) -> Zones {
    let (across, down) = blocks(shape);
    let mut contexts = Contexts { which: [[Adaptive::new(); MAX_ZONES - 1]; 2] };
    let mut of = vec![0u8; across * down];
    for block in 0..of.len() {
        // Outside lies zone 0.
        let left = if block % across > 0 { of[block - 1] } else { 0 };
        let above = if block >= across { of[block - across] } else { 0 };
        let which = &mut contexts.which[usize::from(left == above)];
        let mut order = [left, above].into_iter().chain((0..count as u8).filter(|&zone| zone != left && zone != above));
        if left == above {
            order.next();
        }
        let mut zone = left;
        for (place, candidate) in order.enumerate() {
            zone = candidate;
            // The last one needs no bit.
            if place == count - 1 || bits.bit(truth.is_some_and(|truth| truth[block] == zone), &mut which[place]) {
                break;
            }
        }
        of[block] = zone;
    }
    Zones { count, across, of }
}

impl Zones {
    /// From the zone of each block, row by row.
    pub(super) fn new(shape: TileShape, count: usize, of: Vec<u8>) -> Self {
        Self { count, across: blocks(shape).0, of }
    }

    /// The map as bytes.
    pub(super) fn encode(&self, shape: TileShape) -> Vec<u8> {
        let mut bits = BinaryEncoder::new();
        code(&mut bits, shape, self.count, Some(&self.of));
        bits.finish()
    }

    /// Reads the map of a tile with so many zones.
    pub(super) fn decode(bytes: &[u8], shape: TileShape, count: usize) -> Result<Self> {
        let mut bits = BinaryDecoder::new(bytes);
        let zones = code(&mut bits, shape, count, None);
        match bits.is_done() {
            true => Ok(zones),
            false => Err(Error::new(ErrorKind::Corrupt, "the map of the tile's zones does not end where it should")),
        }
    }

    /// As the passes of a level see them: nothing in levels without zones.
    pub(super) fn at_level(&self, level: u8) -> Option<LevelZones<'_>> {
        // A plane has half the rows and columns of its level.
        (level <= ZONED_UP_TO).then(|| LevelZones { zones: self, shift: BLOCK_BITS - 1 - u32::from(level) })
    }
}

impl LevelZones<'_> {
    /// Number of zones.
    pub(super) fn count(&self) -> usize {
        self.zones.count
    }

    /// The zone of a cell of a pass.
    #[inline(always)]
    pub(super) fn of(&self, row: usize, col: usize) -> usize {
        usize::from(self.zones.of[(row >> self.shift) * self.zones.across + (col >> self.shift)])
    }

    /// Cells of each zone in a pass of so many columns and rows.
    pub(super) fn cells(&self, width: usize, height: usize) -> Vec<usize> {
        let mut cells = vec![0; self.count()];
        let length =
            |block: usize, all: usize| ((block + 1) << self.shift).min(all).saturating_sub(block << self.shift);
        for (block, &zone) in self.zones.of.iter().enumerate() {
            let (row, col) = (block / self.zones.across, block % self.zones.across);
            cells[usize::from(zone)] += length(row, height) * length(col, width);
        }
        cells
    }

    /// Whether the zones of a row are those of the row above it.
    pub(super) fn is_as_above(&self, row: usize) -> bool {
        row & ((1 << self.shift) - 1) != 0
    }

    /// The runs of cells of one zone in a row of a pass, in order.
    pub(super) fn spans(&self, row: usize, width: usize, spans: &mut Vec<(Range<usize>, usize)>) {
        spans.clear();
        let first = (row >> self.shift) * self.zones.across;
        for (place, &zone) in self.zones.of[first..first + self.zones.across].iter().enumerate() {
            let (start, end, zone) = (place << self.shift, ((place + 1) << self.shift).min(width), usize::from(zone));
            if start >= end {
                break;
            }
            match spans.last_mut() {
                Some((span, last)) if *last == zone => span.end = end,
                _ => spans.push((start..end, zone)),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn maps_come_back(
            width in 1usize..300, height in 1usize..300, count in 2usize..=MAX_ZONES, seed in proptest::collection::vec(0u8..4, 100),
        ) {
            let shape = TileShape { width, height };
            let (across, down) = blocks(shape);
            let zones = Zones::new(shape, count, (0..across * down).map(|block| seed[block] % count as u8).collect());
            let bytes = zones.encode(shape);
            prop_assert_eq!(Zones::decode(&bytes, shape, count).ok(), Some(zones.clone()));
            // Neither more nor fewer bytes say the same; fewer may say something else.
            let longer = [&bytes[..], &[0]].concat();
            prop_assert!(Zones::decode(&longer, shape, count).is_err());
            if let Some((_, shorter)) = bytes.split_last() {
                prop_assert_ne!(Zones::decode(shorter, shape, count).ok(), Some(zones));
            }
        }

        #[test]
        fn spans_say_what_single_cells_say(
            width in 1usize..300, height in 1usize..300, level in 0..=ZONED_UP_TO, seed in proptest::collection::vec(0u8..4, 100),
        ) {
            let shape = TileShape { width, height };
            let (across, down) = blocks(shape);
            let zones = Zones::new(shape, 4, seed[..across * down].to_vec());
            let seen = zones.at_level(level).unwrap();
            let plane = shape.at_level(level + 1);
            let mut spans = Vec::new();
            for row in 0..plane.height {
                seen.spans(row, plane.width, &mut spans);
                let flat: Vec<usize> = spans.iter().flat_map(|(span, zone)| span.clone().map(|_| *zone)).collect();
                let single: Vec<usize> = (0..plane.width).map(|col| seen.of(row, col)).collect();
                prop_assert_eq!(&flat, &single);
                prop_assert!(spans.windows(2).all(|pair| pair[0].1 != pair[1].1));
                // The cell of the tile that the cell of the pass is lies in the block of that zone.
                let block = |col: usize| ((row << (level + 1)) >> BLOCK_BITS) * across + ((col << (level + 1)) >> BLOCK_BITS);
                prop_assert!((0..plane.width).all(|col| usize::from(seed[block(col)]) == single[col]));
            }
        }
    }
}
