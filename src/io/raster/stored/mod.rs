//! Rasters as they are stored: cells bit for bit, and all that a file says of them.
//!
//! [`StoredSource`] describes a file in a [`Record`] and reads windows of its bands; [`StoredTarget`] writes a raster
//! with a record in any format that GDAL writes. Nothing is converted, scaled, turned round or filled in between.

mod cell;
mod describe;
mod driver;
mod georeference;
mod mask;
mod memory;
mod metadata;
mod record;
mod source;
mod target;

pub use cell::StoredCell;
pub use driver::Format;
pub use memory::{MemoryRaster, MemoryTarget};
pub use record::{BandRecord, Item, Record};
pub use source::{PALETTE_NOTE, StoredOptions, StoredSource};
pub use target::StoredTarget;
