//! The codec through its public door: any tile comes back as promised, at every level.

#![allow(unreachable_pub, reason = "modules of a test binary say what they offer to each other")]

mod any_tile;
mod extremes;
mod finds;
mod ground;
mod promise;
mod rasters;
mod refusals;
