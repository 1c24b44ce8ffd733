//! Rasters in memory: cells, their order, their neighbours, where they lie.
//!
//! A [`Grid`] holds one band as **keys**: integers that sort exactly as the elevations do, whatever type the file
//! has. Everything that asks which of two cells is higher asks the keys; [`Elevations`] turns a key into the stored
//! value and into metres. A **void** (nodata, NaN, masked) has the key that sorts below every elevation.
//!
//! **Above** is the total order of the cells: higher first, and among equals the one with the lower index
//! (`row * columns + column`). [`neighbours`] is the one place that knows it.

mod bits;
mod elevations;
mod georeference;
mod heights;
mod key;
pub mod neighbours;
mod raster;
pub mod ring;
mod window;

pub use elevations::{Elevations, Sample, SampleType};
pub use georeference::GeoTransform;
pub use heights::{HeightRows, Heights};
pub use key::Key;
pub use raster::{AnyGrid, Cell, Grid};
pub use window::window_of;
