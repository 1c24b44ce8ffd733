//! Pictures: charts as SVG and PNG.

mod axis;
mod bars;
mod chart;
mod drawing;
mod drawing_png;
mod glyphs;
mod rose;
mod svg;

pub use chart::{Chart, Panel, PanelKind, Series};
pub use drawing::{Anchor, Drawing, Ink, Item, Label, Step, Stroke, arc, circle, on_circle, rectangle};
pub use drawing_png::png;
pub use svg::svg;
