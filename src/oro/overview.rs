//! OVER: level 6 of the whole raster once more, in tiles of its own, so that a look at the whole is a few requests.

use super::block::{self, Block};
use super::chunk;
use super::description::Description;
use super::tiling::{Place, Tiling};
use crate::codec::{BandRule, Bound, Cells, SEGMENTS, TOP_LEVEL};
use crate::error::Result;

/// With more tiles than this there is a section OVER; with fewer the tiles themselves are soon read.
pub(super) const MAX_TILES_WITHOUT: u64 = 16;

/// How level 6 of a raster is cut into tiles.
pub(super) fn tiling(description: &Description) -> Tiling {
    let (width, height) = description.level_size(TOP_LEVEL);
    Tiling { width, height, side: description.tile_side }
}

/// Decoded cells are kept as they are.
pub(super) fn rule(band: BandRule) -> BandRule {
    BandRule { bound: Bound::Lossless, ..band }
}

/// Gathers the tiles' coarsest levels; a row of its own tiles is encoded as soon as it is whole.
#[derive(Debug)]
pub(super) struct Builder {
    /// How the raster is cut.
    raster: Tiling,
    /// How its level 6 is cut.
    tiling: Tiling,
    rules: Vec<BandRule>,
    /// The row of tiles under way, band by band; empty until its first cells come.
    strip: Vec<Cells>,
    /// The chunks done.
    pub(super) bytes: Vec<u8>,
    /// Lengths of their segments.
    pub(super) lengths: Vec<[u32; SEGMENTS]>,
}

impl Builder {
    pub(super) fn new(description: &Description) -> Self {
        Self {
            raster: description.tiling(),
            tiling: tiling(description),
            rules: description.bands.iter().map(|band| rule(band.rule)).collect(),
            strip: vec![],
            bytes: vec![],
            lengths: vec![],
        }
    }

    /// Takes the coarsest level of a tile; tiles come in the order of their chunks.
    pub(super) fn push(&mut self, place: Place, top: &Cells) -> Result<()> {
        let step = 1 << TOP_LEVEL;
        let row = place.row / step;
        let strip = self.strip_block(row);
        if self.strip.is_empty() {
            for rule in &self.rules {
                self.strip.push(block::zeros(rule.sample, strip.width, strip.height)?);
            }
        }
        let shape = self.raster.shape(place.col, place.row).at_level(TOP_LEVEL);
        let side = self.raster.side / step;
        let from = Block { col: place.col * side, row: place.row * side, width: shape.width, height: shape.height };
        block::copy(&mut self.strip[place.band], strip, top, from);

        let last_row = (place.row + 1).is_multiple_of(step) || place.row + 1 == self.raster.down();
        if last_row && place.col + 1 == self.raster.across() && place.band + 1 == self.rules.len() {
            self.encode(row)?;
        }
        Ok(())
    }

    fn strip_block(&self, row: usize) -> Block {
        let height = self.tiling.shape(0, row).height;
        Block { col: 0, row: row * self.tiling.side, width: self.tiling.width, height }
    }

    /// Encodes a row of tiles and lets its cells go.
    fn encode(&mut self, row: usize) -> Result<()> {
        let strip = std::mem::take(&mut self.strip);
        let strip_block = self.strip_block(row);
        for col in 0..self.tiling.across() {
            let shape = self.tiling.shape(col, row);
            let block = Block { col: col * self.tiling.side, width: shape.width, ..strip_block };
            for (band, rule) in self.rules.iter().enumerate() {
                let mut cells = block::zeros(rule.sample, shape.width, shape.height)?;
                block::copy(&mut cells, block, &strip[band], strip_block);
                let chunk = chunk::encode(Place { col, row, band }, shape, rule, &cells)?;
                self.bytes.extend(chunk.bytes);
                self.lengths.push(chunk.lengths);
            }
        }
        Ok(())
    }
}
