//! Orograph reads georeferenced elevation models and measures their orometry: peaks, key saddles, prominence,
//! isolation and divide trees.
#[macro_use]
pub mod grid;
pub mod crs;
pub mod error;
pub mod io;
pub mod orometry;
pub mod pipeline;
pub mod plot;
pub mod units;
pub mod watch;
