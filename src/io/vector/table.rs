//! A layer to be written: its fields and, row by row, its values.

/// Type of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldKind {
    /// 64-bit integers.
    Integer,
    /// Double-precision floats.
    Real,
    /// True or false.
    Boolean,
    /// Text.
    Text,
}

/// A field of a layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// Its type.
    pub kind: FieldKind,
    /// Decimals that text formats keep of a real number; `None` for as many as it takes to read the same number.
    pub decimals: Option<u8>,
}

/// A value of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<'a> {
    /// No value.
    Null,
    /// For [`FieldKind::Integer`].
    Integer(i64),
    /// For [`FieldKind::Real`]; NaN is written as no value.
    Real(f64),
    /// For [`FieldKind::Boolean`].
    Boolean(bool),
    /// For [`FieldKind::Text`].
    Text(&'a str),
}

impl From<Option<f64>> for Value<'_> {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::Null, Self::Real)
    }
}

impl From<Option<u32>> for Value<'_> {
    fn from(value: Option<u32>) -> Self {
        value.map_or(Self::Null, |value| Self::Integer(i64::from(value)))
    }
}

impl<'a> From<Option<&'a str>> for Value<'a> {
    fn from(value: Option<&'a str>) -> Self {
        value.map_or(Self::Null, Self::Text)
    }
}

/// Geometry type of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GeometryKind {
    /// Points.
    Point,
    /// Lines in one piece.
    Line,
    /// Lines in one or more pieces.
    MultiLine,
    /// Triangles in three dimensions, as polygons.
    Triangle,
}

/// Geometry of a row.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// A point.
    Point(f64, f64),
    /// The pieces of a line.
    Lines(Vec<Vec<(f64, f64)>>),
    /// The corners of a triangle, counter-clockwise: x, y and z.
    Triangle([[f64; 3]; 3]),
}

/// A QGIS style of a layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    /// Its name.
    pub name: String,
    /// The style as QGIS saves it.
    pub qml: String,
}

/// A layer to be written.
pub trait Table: Sync {
    /// Name of the layer.
    fn name(&self) -> &str;
    /// What the layer holds, in a sentence.
    fn description(&self) -> &str;
    /// Type of its geometries.
    fn geometry_kind(&self) -> GeometryKind;
    /// Its fields.
    fn fields(&self) -> &[Field];
    /// Number of its rows.
    fn rows(&self) -> usize;
    /// Geometry of a row.
    fn geometry(&self, row: usize) -> Geometry;
    /// Appends the values of a row, one for each field.
    fn values<'a>(&'a self, row: usize, values: &mut Vec<Value<'a>>);
    /// The style in which QGIS shows it.
    fn style(&self) -> Option<Style> {
        None
    }
}
