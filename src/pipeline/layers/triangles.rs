//! The layer `triangles`.

use super::measure::field;
use super::style;
use crate::io::vector::{Field, FieldKind, Geometry, GeometryKind, Style, Table, Value};
use crate::tin::Mesh;

/// Triangles of a mesh whose vertices have coordinates in the layer's CRS and elevations in metres.
pub struct TrianglesLayer<'a> {
    mesh: &'a Mesh,
    fields: Vec<Field>,
    /// Least and greatest elevation in metres.
    range_m: (f64, f64),
}

impl<'a> TrianglesLayer<'a> {
    /// The layer of a mesh.
    pub fn new(mesh: &'a Mesh) -> Self {
        let names = ["elevation_m", "elevation_min_m", "elevation_max_m"];
        let fields = names.into_iter().map(|name| field(name, FieldKind::Real, Some(3))).collect();
        let range_m = mesh.bounds().map_or((0.0, 0.0), |(low, high)| (low[2], high[2]));
        Self { mesh, fields, range_m }
    }

    fn corners(&self, row: usize) -> [[f64; 3]; 3] {
        self.mesh.triangles[row].map(|v| self.mesh.vertices[v as usize])
    }
}

impl Table for TrianglesLayer<'_> {
    fn name(&self) -> &str {
        "triangles"
    }

    fn description(&self) -> &str {
        "Triangulated terrain: triangles with the elevations of their corners, and the mean, least and greatest of them"
    }

    fn geometry_kind(&self) -> GeometryKind {
        GeometryKind::Triangle
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn rows(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn geometry(&self, row: usize) -> Geometry {
        Geometry::Triangle(self.corners(row))
    }

    fn values<'a>(&'a self, row: usize, values: &mut Vec<Value<'a>>) {
        let [a, b, c] = self.corners(row).map(|corner| corner[2]);
        values.extend([(a + b + c) / 3.0, a.min(b).min(c), a.max(b).max(c)].map(Value::Real));
    }

    fn style(&self) -> Option<Style> {
        Some(style::triangles(self.range_m))
    }
}
