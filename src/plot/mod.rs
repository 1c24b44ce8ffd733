//! Pictures: maps and views as PNG, charts as SVG and PNG. They know nothing of the methods; what to draw is told in plain
//! numbers and words. The same input gives the same bytes.

pub mod chart;
pub mod map;
mod png;
pub mod view;
