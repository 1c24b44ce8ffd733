//! The layer `saddles`.

use super::measure::{Frame, field};
use super::style;
use crate::io::vector::{Field, FieldKind, Geometry, GeometryKind, Style, Table, Value};
use crate::orometry::{KeySaddle, Peak};

/// Key saddles as points, one for each peak that has one.
pub struct SaddlesLayer<'a> {
    frame: &'a Frame<'a>,
    saddles: Vec<(u32, KeySaddle)>,
    fields: Vec<Field>,
}

impl<'a> SaddlesLayer<'a> {
    /// The layer of the key saddles of some peaks.
    pub fn new(frame: &'a Frame<'a>, peaks: &[Peak]) -> Self {
        let integer = |name| field(name, FieldKind::Integer, None);
        let fields = vec![integer("id"), integer("row"), integer("col"), frame.length("elevation")];
        let saddles = peaks.iter().filter_map(|peak| peak.key_saddle.map(|saddle| (peak.id, saddle))).collect();
        Self { frame, saddles, fields }
    }
}

impl Table for SaddlesLayer<'_> {
    fn name(&self) -> &str {
        "saddles"
    }

    fn description(&self) -> &str {
        "Key saddles; the id is that of the peak that ends there"
    }

    fn geometry_kind(&self) -> GeometryKind {
        GeometryKind::Point
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn rows(&self) -> usize {
        self.saddles.len()
    }

    fn geometry(&self, row: usize) -> Geometry {
        let (x, y) = self.frame.point(self.saddles[row].1.cell);
        Geometry::Point(x, y)
    }

    fn values<'a>(&'a self, row: usize, values: &mut Vec<Value<'a>>) {
        let (id, saddle) = &self.saddles[row];
        let (cell_row, cell_col) = self.frame.place(saddle.cell);
        values.extend([
            Value::Integer(i64::from(*id)),
            Value::Integer(cell_row as i64),
            Value::Integer(cell_col as i64),
            Value::Real(self.frame.unit.of(saddle.elevation_m)),
        ]);
    }

    fn style(&self) -> Option<Style> {
        Some(style::saddles())
    }
}
