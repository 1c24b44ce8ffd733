//! The job behind `orograph tin`: from a DEM to a mesh.

mod job;
mod lines;
mod place;
mod write;

pub use job::{Exactness, TinJob, TinReport, run};
pub(super) use job::{Made, place, triangulate};
pub use lines::LineSource;
pub(super) use place::Placed;
pub use write::MeshFormat;
pub(super) use write::{Provenance, Target};
