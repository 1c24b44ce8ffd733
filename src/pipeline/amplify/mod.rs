//! The job behind `orograph amplify`: a finer DEM from a coarse one and exemplars.
//!
//! `terrain` reads the input window by window, `exemplar` brings exemplars to the cells that are to be made,
//! `method` is what makes planes finer, `strips` makes the output strip by strip, `sink` writes it, and `glance` looks at it for the page.

mod cell_size;
mod exemplar;
mod glance;
mod job;
mod likeness;
mod method;
mod resample;
mod sink;
mod strips;
mod terrain;

pub use glance::Figures;
pub use job::{AmplifyJob, AmplifyReport, Mode, run};
