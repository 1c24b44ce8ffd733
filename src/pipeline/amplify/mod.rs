//! The job behind `orograph amplify`: a finer DEM from a coarse one and exemplars.
//!
//! `terrain` reads the input window by window, `sketch` one that is drawn, `exemplar` brings exemplars to the cells that
//! are to be made, `teach` learns from them, `learned` is what was learned and its file, `method` is what makes planes
//! finer, `strips` makes the output strip by strip, `sink` writes it, and `glance` looks at it for the page.

mod cell_size;
mod exemplar;
mod glance;
mod job;
mod learn_job;
mod learned;
mod likeness;
mod method;
mod mode;
mod resample;
mod sink;
mod sketch;
mod strips;
mod teach;
mod terrain;

pub use glance::Figures;
pub use job::{AmplifyJob, AmplifyReport, Source, run};
pub use learn_job::{LearnJob, LearnReport, learn};
pub use learned::{ExemplarSummary, LearnedSummary, Said, describe, is_learned};
pub use mode::Mode;
pub use teach::Teaching;
