//! The layer `peaks`.

use super::measure::{Frame, field};
use super::style;
use crate::io::vector::{Field, FieldKind, Geometry, GeometryKind, Style, Table, Value};
use crate::orometry::{Isolation, Peak};

/// Name and region of a peak, from other layers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PeakTags {
    /// Name of the nearest named point.
    pub name: Option<String>,
    /// Name of the polygon that the peak stands in.
    pub region: Option<String>,
}

/// Peaks as points with all their measures.
pub struct PeaksLayer<'a> {
    frame: &'a Frame<'a>,
    peaks: &'a [Peak],
    /// One for each peak, or none at all.
    tags: &'a [PeakTags],
    lon_lat: Vec<(f64, f64)>,
    fields: Vec<Field>,
}

impl<'a> PeaksLayer<'a> {
    /// The layer of some peaks; `tags` is empty or holds one for each.
    pub fn new(frame: &'a Frame<'a>, peaks: &'a [Peak], tags: &'a [PeakTags]) -> Self {
        use FieldKind::{Boolean, Integer, Real, Text};
        let integer = |name| field(name, Integer, None);
        let ratio = |name| field(name, Real, Some(6));
        let azimuth = |name| field(name, Real, Some(4));
        let fields = vec![
            integer("id"),
            field("name", Text, None),
            field("region", Text, None),
            integer("row"),
            integer("col"),
            frame.length("elevation"),
            frame.length("prominence"),
            frame.length("prominence_min"),
            field("prominence_certain", Boolean, None),
            field("is_root", Boolean, None),
            integer("key_saddle"),
            frame.length("key_saddle_elevation"),
            frame.length("saddle_distance"),
            azimuth("saddle_azimuth"),
            integer("island_parent"),
            integer("prominence_parent"),
            integer("line_parent"),
            frame.length("isolation"),
            frame.length("isolation_min"),
            field("isolation_certain", Boolean, None),
            azimuth("isolation_azimuth"),
            integer("higher_row"),
            integer("higher_col"),
            ratio("dominance"),
            ratio("relative_prominence"),
            ratio("relative_elevation"),
            ratio("relevance"),
            field("x", Real, None),
            field("y", Real, None),
            field("lon", Real, Some(9)),
            field("lat", Real, Some(9)),
        ];
        let lon_lat = frame.lon_lat(peaks.iter().map(|peak| peak.cell));
        Self { frame, peaks, tags, lon_lat, fields }
    }
}

impl Table for PeaksLayer<'_> {
    fn name(&self) -> &str {
        "peaks"
    }

    fn description(&self) -> &str {
        "Peaks with prominence, isolation and parents"
    }

    fn geometry_kind(&self) -> GeometryKind {
        GeometryKind::Point
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn rows(&self) -> usize {
        self.peaks.len()
    }

    fn geometry(&self, row: usize) -> Geometry {
        let (x, y) = self.frame.point(self.peaks[row].cell);
        Geometry::Point(x, y)
    }

    fn values<'a>(&'a self, row: usize, values: &mut Vec<Value<'a>>) {
        let peak = &self.peaks[row];
        let length = |length_m: f64| Value::Real(self.frame.unit.of(length_m));
        let maybe = |length_m: Option<f64>| length_m.map_or(Value::Null, length);
        let integer = |value: u64| Value::Integer(value as i64);
        let (cell_row, cell_col) = self.frame.place(peak.cell);
        let (x, y) = self.frame.point(peak.cell);
        let (lon, lat) = self.lon_lat[row];
        let tags = self.tags.get(row);
        let saddle = peak.key_saddle.as_ref();
        let isolation = peak.isolation.as_ref();
        let higher = isolation.and_then(|isolation| isolation.higher).map(|cell| self.frame.place(cell));
        let isolation_of = |of: fn(&Isolation) -> Option<f64>| maybe(isolation.and_then(of));
        values.extend([
            Value::Integer(i64::from(peak.id)),
            tags.and_then(|tags| tags.name.as_deref()).into(),
            tags.and_then(|tags| tags.region.as_deref()).into(),
            integer(cell_row),
            integer(cell_col),
            length(peak.elevation_m),
            length(peak.prominence_m),
            length(peak.prominence_min_m),
            Value::Boolean(peak.prominence_certain),
            Value::Boolean(peak.is_root),
            saddle.map_or(Value::Null, |_| Value::Integer(i64::from(peak.id))),
            maybe(saddle.map(|saddle| saddle.elevation_m)),
            maybe(saddle.map(|saddle| saddle.distance_m)),
            Value::from(saddle.map(|saddle| saddle.azimuth)),
            peak.island_parent.into(),
            peak.prominence_parent.into(),
            peak.line_parent.into(),
            isolation_of(|isolation| isolation.isolation_m),
            isolation_of(|isolation| isolation.isolation_min_m),
            isolation.map_or(Value::Null, |isolation| Value::Boolean(isolation.certain)),
            Value::from(isolation.map(|isolation| isolation.azimuth)),
            higher.map_or(Value::Null, |(row, _)| integer(row)),
            higher.map_or(Value::Null, |(_, col)| integer(col)),
            peak.dominance.into(),
            peak.relative_prominence.into(),
            peak.relative_elevation.into(),
            peak.relevance.into(),
            Value::Real(x),
            Value::Real(y),
            Value::Real(lon),
            Value::Real(lat),
        ]);
    }

    fn style(&self) -> Option<Style> {
        Some(style::peaks(self.frame.unit))
    }
}
