//! The jobs behind `orograph classify`: from layers of peaks to a classifier, and with it to answers.

mod disks;
mod predict;
mod ranges;
mod table;
mod train;

pub use predict::{Answer, PredictJob, PredictReport, predict};
pub use ranges::PeaksInput;
pub use train::{TrainJob, TrainReport, train};
