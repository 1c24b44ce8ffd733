//! The job behind `orograph stats`: from DEMs, layers of peaks and statistics files to statistics and charts.

mod dem;
mod input;
mod job;
mod layer;
mod output;

pub(super) use input::{InputFile, PeaksFile, Reading};
pub(super) use layer::{LayerPeaks, place, tag};

pub use job::{DiskWords, DomainComparison, StatsJob, StatsReport, run};
