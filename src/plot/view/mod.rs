//! Terrain as a camera sees it, as a PNG picture.
//!
//! What is seen in each direction comes as a [`Sight`]: the ground with its elevation, slope and distance, or the sky.
//! [`draw`] gives the ground the tints of the maps, the light of one sun and of the sky, and the haze of distance. The
//! same sights give the same picture.

mod light;
mod picture;

pub use light::Sun;
pub use picture::{Sight, ViewOptions, draw};
