//! From files to results: reads what a method needs, runs it, and hands over what it found.

mod overlay;

pub use overlay::{OverlayLayers, ReadOverlay, read_overlay};
