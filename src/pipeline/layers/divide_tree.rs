//! The layer `divide_tree`.

use super::line;
use super::measure::{Frame, field};
use super::style;
use crate::io::vector::{Field, FieldKind, Geometry, GeometryKind, Style, Table, Value};
use crate::orometry::TreeEdge;

/// Edges of the divide tree as lines along the ridges.
pub struct DivideTreeLayer<'a> {
    frame: &'a Frame<'a>,
    edges: &'a [TreeEdge],
    fields: Vec<Field>,
}

impl<'a> DivideTreeLayer<'a> {
    /// The layer of some edges, which hold their paths.
    pub fn new(frame: &'a Frame<'a>, edges: &'a [TreeEdge]) -> Self {
        let integer = |name| field(name, FieldKind::Integer, None);
        let fields = vec![
            integer("peak_a"),
            integer("peak_b"),
            integer("saddle"),
            frame.length("saddle_elevation"),
            frame.length("length"),
            frame.length("prominence"),
        ];
        Self { frame, edges, fields }
    }
}

impl Table for DivideTreeLayer<'_> {
    fn name(&self) -> &str {
        "divide_tree"
    }

    fn description(&self) -> &str {
        "Divide tree: ridge lines from peak over key saddle to peak"
    }

    fn geometry_kind(&self) -> GeometryKind {
        line::kind(self.frame)
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn rows(&self) -> usize {
        self.edges.len()
    }

    fn geometry(&self, row: usize) -> Geometry {
        line::through(self.frame, &self.edges[row].path)
    }

    fn values<'a>(&'a self, row: usize, values: &mut Vec<Value<'a>>) {
        let edge = &self.edges[row];
        let length = |length_m: f64| Value::Real(self.frame.unit.of(length_m));
        values.extend([
            Value::Integer(i64::from(edge.peak_a)),
            Value::Integer(i64::from(edge.peak_b)),
            Value::Integer(i64::from(edge.saddle)),
            length(edge.saddle_elevation_m),
            length(edge.length_m),
            length(edge.prominence_m),
        ]);
    }

    fn style(&self) -> Option<Style> {
        Some(style::divide_tree(self.frame.unit))
    }
}
