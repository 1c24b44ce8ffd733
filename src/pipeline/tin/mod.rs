//! The job behind `orograph tin`: from a DEM to a mesh.

mod job;
mod lines;
mod place;
mod write;

pub use job::{Exactness, TinJob, TinReport, run};
pub use lines::LineSource;
pub use write::MeshFormat;
