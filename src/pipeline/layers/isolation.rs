//! The layer `isolation`.

use super::line;
use super::measure::{Frame, field};
use super::style;
use crate::grid::Cell;
use crate::io::vector::{Field, FieldKind, Geometry, GeometryKind, Style, Table, Value};
use crate::orometry::Peak;

/// Lines from the peaks to their nearest higher cells.
pub struct IsolationLayer<'a> {
    frame: &'a Frame<'a>,
    lines: Vec<(u32, [Cell; 2], f64)>,
    fields: Vec<Field>,
}

impl<'a> IsolationLayer<'a> {
    /// The layer of the isolations of some peaks.
    pub fn new(frame: &'a Frame<'a>, peaks: &[Peak]) -> Self {
        let fields = vec![field("peak", FieldKind::Integer, None), frame.length("isolation")];
        let lines = peaks.iter().filter_map(|peak| {
            let isolation = peak.isolation.as_ref()?;
            Some((peak.id, [peak.cell, isolation.higher?], isolation.isolation_m?))
        });
        Self { frame, lines: lines.collect(), fields }
    }
}

impl Table for IsolationLayer<'_> {
    fn name(&self) -> &str {
        "isolation"
    }

    fn description(&self) -> &str {
        "Isolation: lines from peaks to the nearest higher cell"
    }

    fn geometry_kind(&self) -> GeometryKind {
        line::kind(self.frame)
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn rows(&self) -> usize {
        self.lines.len()
    }

    fn geometry(&self, row: usize) -> Geometry {
        line::through(self.frame, &self.lines[row].1)
    }

    fn values<'a>(&'a self, row: usize, values: &mut Vec<Value<'a>>) {
        let (id, _, isolation_m) = self.lines[row];
        values.extend([Value::Integer(i64::from(id)), Value::Real(self.frame.unit.of(isolation_m))]);
    }

    fn style(&self) -> Option<Style> {
        Some(style::isolation())
    }
}
