//! Vector layers: what is to be written ([`Table`]), and the formats it is written in.

mod csv;
mod format;
mod ogr;
mod spatial_index;
mod table;

pub use format::{Format, Writer};
pub use table::{Field, FieldKind, Geometry, GeometryKind, Style, Table, Value};
