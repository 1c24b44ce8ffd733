//! One tile of one band: cells to segments and back.

use super::Cells;
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
        Self { width: self.width.div_ceil(1 << level), height: self.height.div_ceil(1 << level) }
    }

    /// Number of cells.
    pub fn cells(self) -> usize {
        self.width * self.height
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
/// When the cells are not of the rule's type or do not fill the shape.
pub fn encode_tile(cells: &Cells, shape: TileShape, rule: &BandRule) -> Result<EncodedTile> {
    if cells.sample() != rule.sample || cells.len() != shape.cells() {
        return Err(Error::new(ErrorKind::Usage, "the cells do not fit the tile"));
    }
    let mut tile = EncodedTile::default();
    for (index, segment) in tile.segments.iter_mut().enumerate() {
        *segment = cells.decimated(shape.width, (SEGMENTS - 1 - index) as u8).to_le_bytes();
    }
    Ok(tile)
}

/// Decodes a level of a tile from its first segments (at least [`segments_for`] of them).
///
/// # Errors
/// [`ErrorKind::Corrupt`] when the bytes are no tile of that shape and rule.
pub fn decode_tile(segments: &[&[u8]], shape: TileShape, rule: &BandRule, level: u8) -> Result<Cells> {
    let corrupt = || Error::new(ErrorKind::Corrupt, "the tile's bytes end early");
    let stored = level.min(SEGMENTS as u8 - 1);
    let bytes = segments.get(segments_for(level) - 1).ok_or_else(corrupt)?;
    let cells = Cells::from_le_bytes(rule.sample, bytes).ok_or_else(corrupt)?;
    if cells.len() != shape.at_level(stored).cells() {
        return Err(corrupt());
    }
    Ok(cells.decimated(shape.at_level(stored).width, level - stored))
}
