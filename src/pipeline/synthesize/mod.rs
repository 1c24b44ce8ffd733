//! The job behind `orograph synthesize`: from the statistics of ranges to the layers of a divide tree, and to
//! terrain.

mod job;
mod maps;
mod range;

pub use job::{KeepPart, RangeReport, SynthesizeJob, SynthesizeReport, TerrainPart, run};
