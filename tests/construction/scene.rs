//! Scenes: what they become, and what is said of those that cannot be read.

#[path = "../schema/mod.rs"]
mod schema;

use orograph::construction::scene::{Line, LineQuery, RasterQuery, Scene, Sources, SparseSource};
use orograph::construction::{Area, Lattice};
use orograph::error::{Error, ErrorKind, Result};
use orograph::grid::{GeoTransform, HeightRows, Heights};
use orograph::watch::Watch;
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A plane of 20 x 10 cells of 10 m that rises 1 m a cell eastwards, and one that is turned; a river.
struct Files;

impl Sources for Files {
    fn heights(&self, query: &RasterQuery<'_>) -> Result<Arc<dyn Heights>> {
        let RasterQuery { path, band, .. } = *query;
        let heights = (0..200).map(|i| f64::from(i % 20) + 100.0 * (band - 1) as f64).collect();
        let georeference = match path {
            "plane.tif" => GeoTransform([1000.0, 10.0, 0.0, 2100.0, 0.0, -10.0]),
            // Rows run north, columns west.
            "turned.tif" => GeoTransform([1200.0, -10.0, 0.0, 2000.0, 0.0, 10.0]),
            _ => return Err(Error::new(ErrorKind::Input, "no such file").at_path(path)),
        };
        Ok(Arc::new(HeightRows::new(20, heights, Some(georeference))))
    }

    fn weights(&self, query: &RasterQuery<'_>, heights: &dyn Heights) -> Result<Arc<dyn Heights>> {
        assert!(query.is_placed && query.band == 1);
        if query.path != "share.tif" {
            return Err(Error::new(ErrorKind::Input, "no such file").at_path(query.path));
        }
        let shares = (0..heights.rows() * heights.cols()).map(|i| if i % 20 < 10 { 1.0 } else { 0.25 }).collect();
        Ok(Arc::new(HeightRows::new(heights.cols(), shares, None)))
    }

    fn sparse(&self, path: &str) -> Result<SparseSource> {
        Err(Error::new(ErrorKind::Input, "no such file").at_path(path))
    }

    fn lines(&self, query: &LineQuery<'_>) -> Result<Vec<Line>> {
        let LineQuery { path, layer, .. } = *query;
        if path != "rivers.gpkg" {
            return Err(Error::new(ErrorKind::Input, "no such file").at_path(path));
        }
        let fields = BTreeMap::from([("width".to_string(), 8.0), ("depth".to_string(), 3.0)]);
        let points = vec![[1190.0, 2050.0, f64::NAN], [1100.0, 2060.0, f64::NAN], [1010.0, 2040.0, f64::NAN]];
        Ok(if layer == Some("empty") { vec![] } else { vec![Line { points, fields }] })
    }
}

fn read(text: &str) -> Result<Scene> {
    Scene::read(text, &Files)
}

/// A scene with this root.
fn with_root(root: &str) -> String {
    format!(r#"{{"format": "orograph-scene", "version": 1, "root": {root}}}"#)
}

const WHOLE: &str = r#"{
  "format": "orograph-scene", "version": 1, "crs": "EPSG:32632", "origin": [1000, 2000],
  "detail": {"around": [100, 50], "near_m": 100, "far_m": 500},
  "nodes": {
    "ground": {"image": {"heights": "plane.tif", "interpolation": "bicubic"}},
    "river": {"curve": {"lines": {"path": "rivers.gpkg"}, "drape": {"ref": "ground"}, "descend": true,
      "channel": {"width_m": "width", "depth_m": "depth", "bank_m": 4}, "plateau_m": 8, "radius_m": 16}},
    "dune": {"disc": {"base_m": 0, "radius_m": 30, "noise": {"kind": "ridged", "octaves": 2, "amplitude_m": 4,
      "wavelength_m": 20, "detail": [[0, 0.3], [0.2, 0.6]]}}},
    "spare": {"disc": {"radius_m": 10}}
  },
  "root": {"add": {
    "a": {"replace": {"a": {"ref": "ground"}, "b": {"blend": [
      {"ref": "river"},
      {"contour": {"centre": [60, 20], "z_m": 4, "points": [[75, 20], [62, 32], [45, 22], [58, 8]],
        "profile": [[0, -3], [1, 0], [1.4, 2]], "plateau": 1, "radius": 1.5}}]}}},
    "b": {"weigh": {"node": {"bend": {"node": {"place": {"node": {"ref": "dune"}, "scale": 1.5, "rotate_degrees": 30,
        "move_m": [120, 50], "z_scale": 0.5}}, "drag": {"centre": [120, 50], "by_m": [5, 0], "radius_m": 40}}},
      "guide": {"ref": "ground"}, "elevation_m": [18, 10], "slope": [0.5, 0.2]}}}},
  "layers": {"water": {"level": {"from": 0.1, "to": 0.4,
    "a": {"disc": {"base_m": 1}}, "b": {"curve": {"points": [[0, 0, 1], [100, 0, 2]], "profile": [[0, 0]], "radius_m": 9}}}}}
}"#;

#[test]
fn a_scene_of_all_nodes_is_read_and_fits_the_schema() {
    let scene = read(WHOLE).expect("sound");
    assert_eq!(scene.crs.as_deref(), Some("EPSG:32632"));
    assert_eq!(scene.origin, [1000.0, 2000.0]);
    assert_eq!(scene.unused, ["spare"]);
    assert_eq!(scene.layers.len(), 1);
    // The plane alone: its cell centres, 5 m inside its corner.
    let plain = scene.tree.elevation_m([155.0, 15.0]).expect("defined");
    assert!((plain - 15.0).abs() < 1e-9, "{plain}");
    // The bed at the river's lower end, by its depth below the ground: between the first two samples of 0 and 1 m the
    // spline, whose outermost samples repeat, has 7/16.
    let bed = scene.tree.elevation_m([10.0, 40.0]).expect("defined");
    assert!((bed - (0.4375 - 3.0)).abs() < 1e-6, "{bed}");
    assert_eq!(scene.tree.elevation_m([-10.0, 0.0]), None);
    assert_eq!(scene.layers[0].1.elevation_m([1e4, 1e4]), Some(1.0));
    let lattice = Lattice { x0: 5.0, y0: 95.0, dx: 1.0, dy: -1.0, cols: 190, rows: 90 };
    let values = scene.tree.elevations_m(&lattice, &Watch::default()).expect("nobody cancels");
    for (i, value) in values.iter().enumerate() {
        let expected = scene.tree.elevation_m(lattice.at(i / 190, i % 190)).unwrap_or(f64::NAN);
        assert_eq!(value.to_bits(), expected.to_bits(), "point {i}");
    }
    let document: Value = serde_json::from_str(WHOLE).expect("JSON");
    let schema: Value = serde_json::from_str(include_str!("../../format-spec/scene.schema.json")).expect("JSON");
    schema::validate(&document, &schema, &schema, "scene");
    for node in document["nodes"].as_object().expect("an object").values() {
        schema::validate(node, &schema["$defs"]["node"], &schema, "node");
    }
}

#[test]
fn rasters_lie_where_their_georeference_says() {
    for (raster, at_50) in [("plane.tif", 4.5), ("turned.tif", 14.5)] {
        let root = with_root(&format!(r#"{{"image": {{"heights": "{raster}", "band": 2}}}}"#));
        let tree = read(&root).expect("sound").tree;
        let found = tree.elevation_m([1050.0, 2050.0]).expect("defined");
        assert!((found - 100.0 - at_50).abs() < 1e-9, "{raster}: {found}");
        let (x, y) = (tree.support().x, tree.support().y);
        assert!((x.min - 1005.0).abs() < 1e-6 && (y.max - 2095.0).abs() < 1e-6, "{raster}: {x:?} {y:?}");
    }
}

#[test]
fn named_nodes_are_made_once() {
    let text = r#"{"format": "orograph-scene", "version": 1, "nodes": {"hill": {"disc": {"radius_m": 9}}},
        "root": {"blend": [{"ref": "hill"}, {"place": {"node": {"ref": "hill"}, "move_m": [5, 0]}}]}}"#;
    let tree = read(text).expect("sound").tree;
    assert_eq!(tree.counts(), (1, 2));
    assert!(tree.bounds(&Area::PLANE).terrain_slope() < 1e-9);
}

#[test]
fn faults_are_named_by_their_place() {
    let disc = r#"{"disc": {"radius_m": 5}}"#;
    let cases = [
        (with_root(r#"{"blend": [{"disc": {}}, {"crater": {}}]}"#), "$.root.blend[1]", "unknown node 'crater'"),
        (with_root(r#"{"disc": {"radius": 4}}"#), "$.root.disc", "unknown member 'radius'"),
        (with_root(r#"{"disc": {"radius_m": "NaN"}}"#), "$.root.disc.radius_m", "a finite number, found \"NaN\""),
        (with_root(r#"{"disc": {"radius_m": NaN}}"#), "line 1, column 74", "no JSON"),
        (with_root(r#"{"disc": {"radius_m": -4}}"#), "$.root.disc", "radius larger than its plateau"),
        (with_root(r#"{"blend": []}"#), "$.root.blend", "blend of nothing"),
        (with_root(r#"{"blend": [{}]}"#), "$.root.blend[0]", "one member"),
        (with_root(r#"{"image": {"heights": "missing.tif"}}"#), "$.root.image.heights", "missing.tif: no such file"),
        (
            with_root(r#"{"image": {"heights": "plane.tif", "quadrangle": [[0, 0], [9, 0], [2, 2], [0, 9]]}}"#),
            "$.root.image.quadrangle",
            "not convex",
        ),
        (
            with_root(&format!(r#"{{"place": {{"node": {disc}, "matrix": [1, 2, 2, 4]}}}}"#)),
            "$.root.place",
            "singular warp",
        ),
        (with_root(&format!(r#"{{"place": {{"node": {disc}, "scale": [1, 0]}}}}"#)), "$.root.place", "singular warp"),
        (
            with_root(&format!(
                r#"{{"bend": {{"node": {disc}, "noise": {{"amplitude_m": 50, "wavelength_m": 60}}}}}}"#
            )),
            "$.root.bend.noise",
            "the plane could fold",
        ),
        (
            with_root(r#"{"curve": {"points": [[0, 0, 0], [9, 0, 0]], "profile": [], "radius_m": 5}}"#),
            "$.root.curve.profile",
            "without knots",
        ),
        (
            with_root(r#"{"curve": {"points": [[0, 0], [9, 0]], "profile": [[0, 0]], "radius_m": 5}}"#),
            "$.root.curve",
            "without elevation",
        ),
        (
            with_root(
                r#"{"curve": {"lines": {"path": "rivers.gpkg"}, "z_m": 0, "radius_m": 5,
                "channel": {"width_m": "breadth", "depth_m": 1, "bank_m": 1}}}"#,
            ),
            "$.root.curve.channel.width_m",
            "no numeric field 'breadth'",
        ),
        (
            with_root(&format!(
                r#"{{"curve": {{"lines": {{"path": "rivers.gpkg"}}, "drape": {disc}, "profile": [[0, 0]], "radius_m": 5}}}}"#
            )),
            "$.root.curve.drape",
            "not defined at (1190, 2050)",
        ),
        (with_root(r#"{"ref": "hill"}"#), "$.root.ref", "no node 'hill'"),
        (
            r#"{"format": "orograph-scene", "version": 1, "root": {"ref": "a"},
                "nodes": {"a": {"blend": [{"ref": "b"}]}, "b": {"blend": [{"ref": "a"}]}}}"#
                .into(),
            "$.nodes.b.blend[0].ref",
            "a cycle: a -> b -> a",
        ),
        (r#"{"format": "orograph-scene", "version": 2, "root": {}}"#.into(), "$.version", "version 1"),
        (r#"{"format": "orograph-scene", "version": 1}"#.into(), "$", "'root' is missing"),
        ("[]".into(), "$", "expected an object"),
    ];
    for (text, place, part) in cases {
        let Err(error) = read(&text) else { panic!("read: {text}") };
        assert_eq!(error.kind(), ErrorKind::Input, "{error}");
        assert_eq!(error.place(), Some(place), "{error}");
        assert!(error.message().contains(part), "{error}");
    }
}

#[test]
fn deep_scenes_are_refused_not_crashed_on() {
    let nodes: Vec<String> = (0..2000).map(|i| format!(r#""n{i}": {{"blend": [{{"ref": "n{}"}}]}}"#, i + 1)).collect();
    let text = format!(
        r#"{{"format": "orograph-scene", "version": 1, "root": {{"ref": "n0"}}, "nodes": {{{}, "n2000": {{"disc": {{}}}}}}}}"#,
        nodes.join(",")
    );
    let error = read(&text).expect_err("too deep");
    assert!(error.message().contains("inside each other"), "{error}");
}
