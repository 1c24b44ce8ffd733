//! Cells <-> bytes: one tile of one band at a time, with a guaranteed error.
//!
//! The room knows no files, no threads and no clocks. [`encode_tile`] turns the [`Cells`] of a tile into
//! [`SEGMENTS`] byte strings, coarse to fine; [`decode_tile`] needs the first of them for a coarse level and all for
//! the cells themselves. `format-spec/oro.md` describes the bytes.

mod bands;
mod binary;
mod bits;
mod cells;
mod context;
mod copies;
mod cost;
mod encode;
mod fit;
mod level;
mod mapping;
mod mask;
mod params;
mod pass;
mod plane;
mod rans;
mod restore;
mod tables;
mod take;
mod taps;
mod tile;
#[doc(hidden)]
pub mod training;
mod values;
mod vectors;
mod word;

pub(crate) use binary::{BinaryDecoder, BinaryEncoder};
pub use cells::Cells;
pub use tables::TABLE_SET;
pub use tile::{
    BandRule, Bound, EncodedTile, MAX_TILE_SIDE, SEGMENTS, TOP_LEVEL, TileShape, decode_tile, encode_tile, segments_for,
};
