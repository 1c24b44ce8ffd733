//! From the layers of a survey's GeoPackage to what a map shows on its relief.

use super::backbone::{Edge, carried_m};
use crate::error::{Error, ErrorKind, Result};
use crate::io::features::{Feature, Layer, LayerSummary, Value, list_layers, read_layer};
use crate::plot::map::{Overlay, PeakMark, Ridge};
use crate::units::FOOT_M;
use geo::{Geometry, LineString};
use std::path::Path;

const NAME: &str = "name";
/// Lengths, in metres or in feet as the end of the field's name says.
const ELEVATION: [&str; 2] = ["elevation_m", "elevation_ft"];
const PROMINENCE: [&str; 2] = ["prominence_m", "prominence_ft"];

/// The layers that a map shows, each where there is one.
#[derive(Clone, Copy, Debug, Default)]
pub struct OverlayLayers<'a> {
    /// Points with `name`, `elevation_m` and `prominence_m` (or these two in feet, as `elevation_ft` and
    /// `prominence_ft`), of which each may be missing.
    pub peaks: Option<&'a Layer>,
    /// Points; those with the greatest prominence come first where symbols crowd.
    pub saddles: Option<&'a Layer>,
    /// Lines with a prominence, and with `peak_a`, `peak_b` and `saddle`, which tell how they hang together.
    pub divide_tree: Option<&'a Layer>,
    /// Lines.
    pub isolation: Option<&'a Layer>,
}

impl OverlayLayers<'_> {
    /// The layers as a map takes them; features without a geometry of the right kind are left out.
    pub fn overlay(&self) -> Overlay {
        let mut overlay = Overlay::default();
        for (feature, fields) in features(self.peaks) {
            for (x, y) in points(feature) {
                overlay.peaks.push(PeakMark {
                    x,
                    y,
                    prominence_m: fields.length_m(feature, PROMINENCE),
                    elevation_m: fields.length_m(feature, ELEVATION),
                    name: fields.value(feature, NAME).and_then(Value::text).map(str::to_string),
                });
            }
        }
        let mut saddles: Vec<(f64, (f64, f64))> = features(self.saddles)
            .flat_map(|(feature, fields)| {
                let prominence_m = fields.length_m(feature, PROMINENCE);
                points(feature).into_iter().map(move |point| (prominence_m, point))
            })
            .collect();
        // Stable, and the unknown last: saddles without a prominence keep the order of the file.
        saddles.sort_by(|a, b| known(b.0).total_cmp(&known(a.0)));
        overlay.saddles = saddles.into_iter().map(|(_, point)| point).collect();
        let edges: Vec<Edge> = features(self.divide_tree).map(|(feature, fields)| fields.edge(feature)).collect();
        for ((feature, _), (edge, carried_m)) in features(self.divide_tree).zip(edges.iter().zip(carried_m(&edges))) {
            let ridge = |path| Ridge { path, prominence_m: edge.prominence_m, carried_m };
            overlay.ridges.extend(lines(feature).into_iter().map(ridge));
        }
        overlay.isolation = features(self.isolation).flat_map(|(feature, _)| lines(feature)).collect();
        overlay
    }
}

/// An overlay read from a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOverlay {
    /// What is drawn.
    pub overlay: Overlay,
    /// Number of features that have no place in the map's CRS.
    pub unplaced: usize,
    /// Layers that were wanted but are not there.
    pub missing: Vec<String>,
}

/// Reads those of the layers `peaks`, `saddles`, `divide_tree` and `isolation` of a GeoPackage that are `wanted`, as
/// far as they are there, in the CRS `target_wkt`, or in their own.
///
/// # Errors
/// When the file has none of the layers, or one of them cannot be read.
pub fn read_overlay(path: impl AsRef<Path>, wanted: &[&str], target_wkt: Option<&str>) -> Result<ReadOverlay> {
    let path = path.as_ref();
    let there = list_layers(path)?;
    let mut missing = Vec::new();
    let mut read = |name: &str, fields: &[&str]| -> Result<Option<Layer>> {
        if !wanted.contains(&name) {
            return Ok(None);
        }
        let Some(summary) = there.iter().find(|layer| layer.name == name && layer.has_geometry) else {
            missing.push(name.to_string());
            return Ok(None);
        };
        let fields: Vec<&str> = fields.iter().copied().filter(|field| has_field(summary, field)).collect();
        read_layer(path, Some(name), &fields, target_wkt).map(Some)
    };
    let [elevation_m, elevation_ft] = ELEVATION;
    let [prominence_m, prominence_ft] = PROMINENCE;
    let peaks = read("peaks", &[NAME, elevation_m, elevation_ft, prominence_m, prominence_ft])?;
    let saddles = read("saddles", &PROMINENCE)?;
    let divide_tree = read("divide_tree", &["peak_a", "peak_b", "saddle", prominence_m, prominence_ft])?;
    let isolation = read("isolation", &[])?;
    let all = [&peaks, &saddles, &divide_tree, &isolation];
    if all.iter().all(|layer| layer.is_none()) {
        let names: Vec<&str> = there.iter().map(|layer| layer.name.as_str()).collect();
        let list = if names.is_empty() { "no layer".to_string() } else { names.join(", ") };
        return Err(Error::new(
            ErrorKind::Input,
            format!("there is no layer {}: it has {list}; make them with orograph peaks", wanted.join(" or ")),
        )
        .at_path(path));
    }
    let unplaced = all.into_iter().flatten().map(|layer| layer.unplaced).sum();
    let layers = OverlayLayers {
        peaks: peaks.as_ref(),
        saddles: saddles.as_ref(),
        divide_tree: divide_tree.as_ref(),
        isolation: isolation.as_ref(),
    };
    Ok(ReadOverlay { overlay: layers.overlay(), unplaced, missing })
}

fn has_field(layer: &LayerSummary, name: &str) -> bool {
    layer.fields.iter().any(|field| field == name)
}

fn features(layer: Option<&Layer>) -> impl Iterator<Item = (&Feature, Fields<'_>)> {
    layer.into_iter().flat_map(|layer| layer.features.iter().map(move |feature| (feature, Fields(layer))))
}

/// Attributes by their names.
#[derive(Clone, Copy)]
struct Fields<'a>(&'a Layer);

impl Fields<'_> {
    fn value<'f>(&self, feature: &'f Feature, name: &str) -> Option<&'f Value> {
        feature.values.get(self.0.field(name)?)
    }

    /// A line of the divide tree; peaks that the layer does not name make it a tree of its own.
    fn edge(&self, feature: &Feature) -> Edge {
        let peak = |name, none| self.value(feature, name).and_then(Value::number).map_or(none, |id| id as i64);
        Edge {
            peaks: [peak("peak_a", -1), peak("peak_b", -2)],
            ended: peak("saddle", -3),
            prominence_m: self.length_m(feature, PROMINENCE),
        }
    }

    fn length_m(&self, feature: &Feature, [metres, feet]: [&str; 2]) -> f64 {
        let number = |name| self.value(feature, name).and_then(Value::number);
        number(metres).or_else(|| number(feet).map(|feet| feet * FOOT_M)).unwrap_or(f64::NAN)
    }
}

fn known(value: f64) -> f64 {
    if value.is_nan() { f64::NEG_INFINITY } else { value }
}

fn points(feature: &Feature) -> Vec<(f64, f64)> {
    match &feature.geometry {
        Some(Geometry::Point(point)) => vec![point.x_y()],
        Some(Geometry::MultiPoint(points)) => points.0.iter().map(|point| point.x_y()).collect(),
        _ => Vec::new(),
    }
}

fn lines(feature: &Feature) -> Vec<Vec<(f64, f64)>> {
    let path = |line: &LineString<f64>| line.0.iter().map(|c| (c.x, c.y)).collect();
    match &feature.geometry {
        Some(Geometry::LineString(line)) => vec![path(line)],
        Some(Geometry::MultiLineString(lines)) => lines.0.iter().map(path).collect(),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(fields: &[&str], features: Vec<(Geometry<f64>, Vec<Value>)>) -> Layer {
        Layer {
            name: "layer".into(),
            crs_wkt: None,
            fields: fields.iter().map(|f| f.to_string()).collect(),
            features: features
                .into_iter()
                .map(|(geometry, values)| Feature { fid: None, geometry: Some(geometry), values })
                .collect(),
            unplaced: 0,
        }
    }

    #[test]
    fn four_layers_make_an_overlay() {
        let number = Value::Number;
        let point = |x: f64, y: f64| Geometry::Point((x, y).into());
        let line = |x: f64| LineString::from(vec![(x, 0.0), (x, 1.0)]);
        let peaks = layer(
            &["prominence_m", NAME],
            vec![
                (point(1.0, 2.0), vec![number(40.0), Value::Text("Ela".into())]),
                (point(3.0, 4.0), vec![Value::Null, Value::Null]),
            ],
        );
        let saddles =
            layer(&["prominence_ft"], vec![(point(5.0, 5.0), vec![Value::Null]), (point(6.0, 6.0), vec![number(9.0)])]);
        let two = Geometry::MultiLineString(geo::MultiLineString(vec![line(1.0), line(2.0)]));
        let tree = layer(&["prominence_ft"], vec![(two, vec![number(30.0)]), (point(0.0, 0.0), vec![number(1.0)])]);
        let isolation = layer(&[], vec![(Geometry::LineString(line(7.0)), vec![])]);
        let layers = OverlayLayers {
            peaks: Some(&peaks),
            saddles: Some(&saddles),
            divide_tree: Some(&tree),
            isolation: Some(&isolation),
        };
        let overlay = layers.overlay();
        assert_eq!((overlay.peaks[0].x, overlay.peaks[0].prominence_m), (1.0, 40.0));
        assert_eq!(overlay.peaks[0].name.as_deref(), Some("Ela"));
        assert!(overlay.peaks[0].elevation_m.is_nan() && overlay.peaks[1].prominence_m.is_nan());
        assert_eq!(overlay.saddles, [(6.0, 6.0), (5.0, 5.0)], "the known first");
        assert_eq!(overlay.ridges.len(), 2, "a point is no ridge");
        assert!((overlay.ridges[0].prominence_m - 9.144).abs() < 1e-9, "30 feet");
        assert_eq!(overlay.isolation, [vec![(7.0, 0.0), (7.0, 1.0)]]);
        assert_eq!(OverlayLayers::default().overlay(), Overlay::default());
    }

    #[test]
    fn layers_are_read_as_far_as_they_are_there() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("peaks.geojson");
        let text = r#"{"type":"FeatureCollection","name":"peaks","features":[{"type":"Feature",
            "properties":{"elevation_m":2865},"geometry":{"type":"Point","coordinates":[9.0,46.0]}}]}"#;
        std::fs::write(&path, text).unwrap();
        let read = read_overlay(&path, &["peaks", "saddles"], None).unwrap();
        assert_eq!((read.overlay.peaks.len(), read.unplaced), (1, 0));
        assert_eq!(read.missing, ["saddles"]);
        assert_eq!(read.overlay.peaks[0].elevation_m, 2865.0);
        std::fs::write(&path, text.replace("\"peaks\"", "\"towns\"")).unwrap();
        let message = read_overlay(&path, &["peaks"], None).unwrap_err().to_string();
        assert!(message.contains("it has towns"), "{message}");
    }
}
