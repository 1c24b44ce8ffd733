//! Orometry: peaks, key saddles, prominence, isolation and divide trees, exactly as the definitions have them.

pub mod distributions;
mod survey;

pub use survey::{Isolation, KeySaddle, Peak, Survey, TreeEdge};
