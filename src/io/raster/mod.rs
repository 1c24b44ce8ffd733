//! Elevation models: what a raster file says of itself, and its cells.

mod crs;
mod dem;
mod read;
mod reduced;
mod source;
mod strips;
mod suspect;

pub use crs::parse_crs;
pub use dem::{Dem, Extremes};
pub use reduced::Reduced;
pub use source::{NoData, RasterOptions, RasterSource};
pub use suspect::Sentinel;
