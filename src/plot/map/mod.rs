//! Draws a map: a shaded and tinted relief with peaks, saddles, divides and labels, as a PNG picture.
//!
//! A [`Relief`] is a raster in metres, at any resolution; an [`Overlay`] is what lies on top of it, in the same
//! coordinates. [`draw`] makes the picture. The same input gives the same bytes.

mod canvas;
mod classes;
mod draw;
mod enlarge;
mod frame;
mod graticule;
mod hillshade;
mod labels;
mod legend;
mod overlay;
mod placement;
mod raster;
mod scale_bar;
mod symbols;
mod text;
pub(super) mod tint;

pub use draw::{Map, MapOptions, draw};
pub use overlay::{Overlay, PeakMark, Ridge};
pub use raster::Relief;
