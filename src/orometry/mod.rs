//! Orometry: peaks, key saddles, prominence, isolation and divide trees, exactly as the definitions have them.

mod above;
mod crowd;
pub mod distributions;
mod divide;
mod forest;
mod isolation;
mod lowest;
mod measure;
mod prune;
mod pyramid;
mod ridge;
mod survey;
mod tile;
mod tree;

pub use crowd::Crowd;
pub use measure::survey;
pub use survey::{Isolation, KeySaddle, Peak, Survey, SurveyOptions, TreeEdge};
pub use tree::{GivenPass, GivenTree, peak_isolations, survey_tree};
