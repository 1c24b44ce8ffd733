//! Files, through GDAL: the only folder that says `gdal::`.
//!
//! [`raster`] reads and writes elevation models, [`features`] and [`lines`] read vector layers and [`vector`] writes them,
//! [`text`] reads texts, [`transform`] turns coordinates into longitudes and latitudes and those into a plane's, [`output`] and
//! [`output_folder`] see to it that no file is left half-written, [`messages`] turns what GDAL says into errors of this
//! crate.

pub mod features;
pub mod lines;
pub mod messages;
pub mod output;
pub mod output_folder;
pub mod raster;
pub mod text;
pub mod transform;
pub mod vector;
