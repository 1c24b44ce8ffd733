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
mod decode_tile;
mod divide;
mod encode;
mod encode_tile;
mod fit;
mod header;
mod level;
mod mapping;
mod mask;
mod params;
mod parts;
mod pass;
mod patches;
mod plane;
mod rans;
mod restore;
pub mod sparse;
mod tables;
mod take;
mod taps;
mod tile;
#[doc(hidden)]
pub mod training;
mod values;
mod vectors;
mod word;
mod zones;

pub(crate) use binary::{BinaryDecoder, BinaryEncoder};
pub use cells::Cells;
pub use decode_tile::decode_tile;
pub use encode_tile::encode_tile;
pub use tables::TABLE_SET;
pub use tile::{BandRule, Bound, EncodedTile, MAX_TILE_SIDE, SEGMENTS, TOP_LEVEL, TileShape, segments_for};
