//! Elevation models: what a raster file says of itself, and its cells.
//!
//! [`RasterSource`] reads one band as elevations that can be compared; [`stored`] keeps rasters as they are.

mod crs;
mod dem;
mod read;
mod reduced;
mod source;
pub mod stored;
mod strips;
mod suspect;

pub use crs::parse_crs;
pub use dem::{Dem, Extremes};
pub use reduced::Reduced;
pub use source::{NoData, RasterOptions, RasterSource};
pub use suspect::Sentinel;
