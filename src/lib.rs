//! Orograph reads georeferenced elevation models and measures their orometry: peaks, key saddles, prominence,
//! isolation and divide trees.

pub mod cli;
pub mod crs;
pub mod error;
pub mod grid;
pub mod io;
pub mod orometry;
pub mod pipeline;
pub mod units;
pub mod watch;
