//! The job behind `orograph synthesize`: from the statistics of ranges to the layers of a divide tree.

mod job;
mod land;
mod maps;
mod range;

pub use job::{RangeReport, SynthesizeJob, SynthesizeReport, run};
