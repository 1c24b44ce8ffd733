//! The `.oro` container: a raster in tiles that are read one by one, from anything that can hand out ranges of bytes.
//!
//! `format-spec/oro.md` describes the bytes; modules have the names of its parts.
//!
//! ```text
//! header | chunk 0 | chunk 1 | ... | OVER | META | INDX | directory | footer
//!           one tile of one band      overview            where all that is
//! ```
//!
//! # Write and read
//!
//! [`encode_chunk`] turns the cells of a tile into a [`Chunk`], wherever and on as many threads as the caller likes;
//! a [`Writer`] takes the chunks in order. A [`Reader`] needs a [`RangeRead`]: bytes, a file, or something behind HTTP.
//!
//! ```
//! use orograph::codec::Cells;
//! use orograph::grid::SampleType;
//! use orograph::oro::{Band, Description, Place, Reader, Window, Writer, encode_chunk};
//!
//! let mut description = Description::new(100, 70, vec![Band::new(SampleType::I16)]);
//! description.tile_side = 64;
//! let mut writer = Writer::new(vec![], description.clone())?;
//! for chunk in 0..description.chunks() {
//!     let place = description.tiling().place(chunk, 1);
//!     let shape = description.tiling().shape(place.col, place.row);
//!     let cells = Cells::I16((0..shape.cells() as i16).collect());
//!     writer.push(&encode_chunk(&description, place, &cells)?)?;
//! }
//! let (bytes, summary) = writer.finish()?;
//! assert_eq!(bytes.len() as u64, summary.bytes);
//!
//! let reader = Reader::open(bytes)?;
//! assert_eq!(reader.description(), &description);
//! let tile = reader.tile(Place { col: 1, row: 0, band: 0 }, 0)?;
//! assert_eq!(tile.len(), 36 * 64);
//! let coarse = reader.window(0, 6, Window { col: 0, row: 0, width: 2, height: 2 })?;
//! assert_eq!(coarse, Cells::I16(vec![0, 0, 0, 0]));
//! # Ok::<(), orograph::error::Error>(())
//! ```
//!
//! The room knows no threads and no clocks, and of files only that they can be a [`RangeRead`]. It builds without
//! GDAL (`--no-default-features`) and for wasm32.

mod area;
mod block;
mod bytes;
mod check;
mod chunk;
mod description;
mod dictionary;
mod directory;
mod footer;
mod header;
mod index;
mod metadata;
mod overview;
mod reader;
mod shelf;
mod source;
mod sparse;
mod text;
mod tiling;
mod window;
mod writer;

pub use bytes::checksum;
pub use check::{CheckReport, Fault, FaultPlace, Look};
pub use chunk::{Chunk, ChunkBytes, encode_chunk};
pub use description::{
    Band, CellMeaning, DEFAULT_TILE_SIDE, Description, Georeference, MAX_BANDS, MAX_CHUNKS, MAX_LEVEL, MAX_SIDE,
    MAX_TEXT, MetadataItem, TILE_SIDE_STEP,
};
pub use dictionary::{Dictionary, Found};
pub use directory::{Section, SectionType};
pub use header::{MAGIC, VERSION};
pub use reader::Reader;
pub use shelf::Shelf;
pub use source::RangeRead;
pub use sparse::encode_patch_chunk;
pub use tiling::{Place, Tiling};
pub use window::Window;
pub use writer::{Summary, Writer};
