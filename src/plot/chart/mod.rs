//! Pictures: charts as SVG and PNG.

mod axis;
mod bars;
mod drawing;
mod drawing_png;
mod figure;
mod glyphs;
mod rose;
mod svg;

pub use drawing::{Anchor, Drawing, Ink, Item, Label, Step, Stroke, arc, circle, on_circle, rectangle};
pub use drawing_png::png;
pub use figure::{Chart, Panel, PanelKind, Series};
pub use svg::svg;
