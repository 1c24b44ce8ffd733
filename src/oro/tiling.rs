//! The raster in square tiles, row-major; those at the right and lower edge may be smaller.

use crate::codec::TileShape;
use std::fmt;

/// How a raster is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tiling {
    /// Columns of the raster.
    pub width: usize,
    /// Rows of the raster.
    pub height: usize,
    /// Side of a tile in cells.
    pub side: usize,
}

/// A tile and a band: where a chunk belongs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place {
    /// Column of the tile; 0 is the leftmost.
    pub col: usize,
    /// Row of the tile; 0 is the uppermost.
    pub row: usize,
    /// The band; 0 is the first.
    pub band: usize,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tile column {}, row {}, band {}", self.col, self.row, self.band + 1)
    }
}

impl Tiling {
    /// Tiles side by side.
    pub fn across(&self) -> usize {
        self.width.div_ceil(self.side)
    }

    /// Tiles one below the other.
    pub fn down(&self) -> usize {
        self.height.div_ceil(self.side)
    }

    /// Number of tiles.
    pub fn tiles(&self) -> u64 {
        self.across() as u64 * self.down() as u64
    }

    /// Size of a tile.
    pub fn shape(&self, col: usize, row: usize) -> TileShape {
        let (left, top) = (col * self.side, row * self.side);
        TileShape {
            width: self.side.min(self.width.saturating_sub(left)),
            height: self.side.min(self.height.saturating_sub(top)),
        }
    }

    /// Whether the place has a tile.
    pub fn contains(&self, col: usize, row: usize) -> bool {
        col < self.across() && row < self.down()
    }

    /// Number of the place's chunk when each tile has so many bands; places follow each other row by row, and in one
    /// tile band by band.
    pub fn chunk(&self, place: Place, bands: usize) -> u64 {
        (place.row as u64 * self.across() as u64 + place.col as u64) * bands as u64 + place.band as u64
    }

    /// The place of a chunk: the reverse of [`Tiling::chunk`].
    pub fn place(&self, chunk: u64, bands: usize) -> Place {
        let (tile, across) = (chunk / bands as u64, self.across() as u64);
        Place { col: (tile % across) as usize, row: (tile / across) as usize, band: (chunk % bands as u64) as usize }
    }
}
