//! What callers say of a tile, and what they get.

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

    pub(super) fn check(self) -> Result<()> {
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

impl EncodedTile {
    /// Bytes of all segments.
    pub fn bytes(&self) -> usize {
        self.segments.iter().map(Vec::len).sum()
    }
}
