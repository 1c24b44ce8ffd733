//! Orograph reads georeferenced elevation models and measures their orometry: peaks, key saddles, prominence,
//! isolation and divide trees.
//!
//! # The house
//!
//! A room uses only the rooms below it and itself; a test (`tests/layers.rs`) checks that.
//!
//! ```text
//! 6  main.rs -> cli                       words <-> calls; exit codes; the only place that prints
//! 5  pipeline                              jobs from files to files: memory, layers, tags, archives
//! 4  figures  oro                          what the methods measured, as charts; the .oro container
//! 3  orometry  dictionary  construction    the methods
//!    amplify  erosion  synthesis  tin  classify
//!    plot                                  pictures that know no methods
//! 2  io  codec  noise  linalg              files through GDAL; cells <-> bytes; seeded noise; vectors and matrices
//! 1  grid  crs                             rasters in memory; where they lie on Earth
//! 0  error  units  watch  interval  rng    what everybody needs
//!    components
//! ```
//!
//! # Follow a DEM through
//!
//! `io::raster` opens a file ([`io::raster::RasterSource`]) and reads it into a [`grid::AnyGrid`] of keys: integers
//! that sort as the elevations do, whatever the file's type. [`orometry::survey`] finds basins and passes tile by
//! tile, joins them to the divide tree of the whole, prunes it and measures each peak with a [`crs::Metric`].
//! `pipeline::layers` turns the result into rows, and `io::vector` writes them.
//!
//! An archive needs every bit instead: `io::raster::stored` reads cells as they are stored, with a record of all that
//! the file says, and `pipeline::archive` takes them batch by batch into a container and out again.
//!
//! The other way round, `pipeline::terrain` reads a divide tree and `synthesis::terrain` raises a DEM on it.
//!
//! # The container alone
//!
//! Without the feature `program` (`default-features = false`) there are only [`oro`], [`codec`] and what they stand on:
//! no GDAL, no threads, and it builds for wasm32.

#[cfg(feature = "program")]
pub mod amplify;
#[cfg(feature = "program")]
pub mod classify;
#[cfg(feature = "program")]
pub mod cli;
pub mod codec;
#[cfg(feature = "program")]
mod components;
#[cfg(feature = "program")]
pub mod construction;
#[cfg(feature = "program")]
pub mod crs;
#[cfg(feature = "program")]
pub mod dictionary;
#[cfg(feature = "program")]
pub mod erosion;
pub mod error;
#[cfg(feature = "program")]
pub mod figures;
pub mod grid;
pub mod interval;
#[cfg(feature = "program")]
pub mod io;
#[cfg(feature = "program")]
mod linalg;
pub mod noise;
pub mod oro;
#[cfg(feature = "program")]
pub mod orometry;
#[cfg(feature = "program")]
pub mod pipeline;
#[cfg(feature = "program")]
pub mod plot;
pub mod rng;
#[cfg(feature = "program")]
pub mod synthesis;
#[cfg(feature = "program")]
pub mod tin;
pub mod units;
pub mod watch;
