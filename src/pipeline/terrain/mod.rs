//! The job behind `orograph terrain`: from a divide tree that is drawn in layers, or told in a text, to a DEM.

mod drawn;
mod ground;
mod job;
mod kept;
mod layers;
mod shape;
mod text;
mod write;

pub(super) use job::tell_crossings;
pub use job::{TerrainJob, TerrainReport, run};
pub(super) use kept::read_kept;
pub(super) use shape::TerrainLike;
pub use shape::TerrainShape;
pub(super) use write::TerrainTarget;
pub use write::{RasterOutput, is_raster};
