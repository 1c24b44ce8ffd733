//! Orometry: peaks, key saddles, prominence, isolation and divide trees, exactly as the definitions have them.

mod survey;

pub use survey::{Isolation, KeySaddle, Peak, Survey, TreeEdge};
