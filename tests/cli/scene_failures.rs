//! `orograph scene`: what is said of scenes that cannot be read, by the node's place, and with which exit code.

use super::rasters::Raster;
use super::scene::scene;
use super::{Run, folder, inside, listing};
use std::fs;

#[test]
fn faults_are_named_by_their_place_in_the_file() {
    let dir = folder();
    Raster::new((4, 4), vec![vec![1.0_f32; 16]]).write(&inside(&dir, "plane.tif"));
    let line = r#"{"type":"Feature","properties":{"width":3},"geometry":{"type":"LineString","coordinates":[[9,46.9],[9.001,46.9]]}}"#;
    let lines = format!(r#"{{"type":"FeatureCollection","features":[{line}]}}"#);
    fs::write(dir.path().join("roads.geojson"), lines).expect("a layer");
    fs::write(dir.path().join("empty.tif"), "").expect("a file");
    let curve = |more: &str| format!(r#""root": {{"curve": {{"radius_m": 5, "profile": [[0, 0]], {more}}}}}"#);
    let cases = [
        (
            r#""root": {"image": {"heights": "missing.tif"}}"#.to_string(),
            "$.root.image.heights",
            "missing.tif: no such file",
        ),
        (r#""root": {"image": {"heights": "empty.tif"}}"#.into(), "$.root.image.heights", "the file is empty"),
        (
            r#""root": {"image": {"heights": "plane.tif", "band": 3}}"#.into(),
            "$.root.image.heights",
            "there is no band 3",
        ),
        (
            r#""root": {"image": {"heights": "plane.tif", "weights": "no.tif"}}"#.into(),
            "$.root.image.weights",
            "no such file",
        ),
        (
            r#""root": {"image": {"heights": "plane.tif", "crop": [0, 0, 9, 9]}}"#.into(),
            "$.root.image.heights",
            "nothing of it lies in crop",
        ),
        (curve(r#""lines": {"path": "no.gpkg"}, "z_m": 3"#), "$.root.curve.lines.path", "no.gpkg: no such file"),
        (
            curve(r#""lines": {"path": "roads.geojson", "layer": "rivers"}, "z_m": 3"#),
            "$.root.curve.lines.path",
            "there is no layer 'rivers'",
        ),
        (
            format!(
                r#""crs": "EPSG:32632", {}"#,
                curve(r#""lines": {"path": "roads.geojson", "where": "width > 5"}, "z_m": 3"#)
            ),
            "$.root.curve.lines",
            "no such lines",
        ),
        (
            format!(r#""crs": "EPSG:32632", {}"#, curve(r#""lines": {"path": "roads.geojson"}"#)),
            "$.root.curve",
            "points without elevation",
        ),
        (
            format!(
                r#""crs": "EPSG:32632", {}"#,
                curve(r#""lines": {"path": "roads.geojson"}, "drape": {"image": {"heights": "plane.tif"}}"#)
            ),
            "$.root.curve.drape",
            "not defined at",
        ),
        (r#""crs": "EPSG:4326", "root": {"disc": {}}"#.into(), "$.crs", "longitudes and latitudes"),
        (r#""crs": "Utopia", "root": {"disc": {}}"#.into(), "$.crs", "no"),
        (
            r#""root": {"ref": "a"}, "nodes": {"a": {"blend": [{"ref": "a"}]}}"#.into(),
            "$.nodes.a.blend[0].ref",
            "a cycle: a -> a",
        ),
        (
            r#""root": {"place": {"node": {"disc": {}}, "matrix": [1, 2, 2, 4]}}"#.into(),
            "$.root.place",
            "singular warp",
        ),
        (r#""root": {"crater": {}}"#.into(), "$.root", "unknown node 'crater'"),
        (r#""root": {"disc": {"base_m": NaN}}"#.into(), "line 1", "no JSON"),
        (r#""root": {"disc": {"base_m": 1e999}}"#.into(), "line 1", "no JSON"),
        (r#""root": {"sparse": {"terrain": "plane.tif"}}"#.into(), "$.root.sparse.terrain", "sparse profile"),
        (r#""root": {"bend": {"node": {"disc": {}}}}"#.into(), "$.root.bend", "needs noise, drag or twist"),
    ];
    let before = listing(dir.path()).len();
    for (text, place, words) in cases {
        let path = scene(&dir, "scene.json", &text);
        let out = inside(&dir, "out.tif");
        for verb in [&["scene", "check", &path][..], &["scene", "eval", &path, &out, "--resolution", "1m"]] {
            let run = Run::new(&[verb, &["--json"]].concat());
            run.expect(3, words);
            let error = &run.json()["error"];
            run.check(error["place"].as_str().is_some_and(|found| found.starts_with(place)), place);
            run.check(error["path"] == path.as_str(), "the scene's path");
        }
    }
    assert_eq!(listing(dir.path()).len(), before + 1, "nothing but the scene");
}

#[test]
fn files_and_boxes_that_are_not_there() {
    let dir = folder();
    let out = inside(&dir, "out.tif");
    Run::new(&["scene", "eval", &inside(&dir, "no.json"), &out]).expect(3, "no.json: no such file");
    fs::write(dir.path().join("bytes.json"), [255, 254, 0, 1]).expect("a file");
    Run::new(&["scene", "check", &inside(&dir, "bytes.json")]).expect(3, "it is no text");
    let hill = scene(&dir, "hill.json", r#""root": {"disc": {"base_m": 9, "radius_m": 50}}"#);
    let run = |options: &[&str]| Run::new(&[&["scene", "eval", &hill, &out][..], options].concat());
    run(&[]).expect(2, "--resolution");
    run(&["--resolution", "1m", "--bbox", "900,900,950,950"])
        .expect(2, "nothing of the scene lies in it; the scene's is -50");
    run(&["--resolution", "1m", "--bbox", "950,900,900,950"]).expect(2, "expected xmin,ymin,xmax,ymax");
    run(&["--resolution", "1m", "--bbox", "900,900"]).expect(2, "four numbers");
    run(&["--resolution", "0"]).expect(2, "--resolution");
    run(&["--resolution", "1m", "--detail", "2"]).expect(2, "from 0 to 1");
    run(&["--resolution", "1m", "--detail-around", "0,0,9,3"]).expect(2, "NEAR less than FAR");
    run(&["--resolution", "1m", "--nodata", "9"]).expect(3, "choose another with --nodata");
    run(&["--resolution", "1um"]).expect(2, "is not a length");
    run(&["--resolution", "1m", "--memory", "1M"]).expect(3, "raise --memory");
    // In its box, but where its weight is less than a half.
    run(&["--resolution", "1m", "--bbox", "40,40,49,49"]).expect(3, "no terrain is defined");
    let endless = scene(&dir, "endless.json", r#""root": {"disc": {"base_m": 9}}"#);
    Run::new(&["scene", "eval", &endless, &out, "--resolution", "1m"]).expect(2, "the scene is endless");
    Run::new(&["scene", "eval", &hill, &inside(&dir, "out.xyzzy"), "--resolution", "1m"]).expect(2, "out.xyzzy");
    fs::write(&out, "mine").expect("a file");
    run(&["--resolution", "1m"]).expect(4, "--overwrite");
    assert_eq!(fs::read(&out).expect("it is there"), b"mine");
    assert_eq!(listing(dir.path()), ["bytes.json", "endless.json", "hill.json", "out.tif"]);
}

#[test]
fn pictures_that_cannot_be_drawn() {
    let dir = folder();
    let hill = scene(&dir, "hill.json", r#""root": {"disc": {"base_m": 9, "radius_m": 50}}"#);
    let out = inside(&dir, "out.png");
    let run = |options: &[&str]| Run::new(&[&["scene", "render", &hill, &out][..], options].concat());
    run(&["--size", "0x9"]).expect(2, "--size 0x9");
    run(&["--size", "big"]).expect(2, "such as 1920x1080");
    run(&["--samples", "0"]).expect(2, "--samples 0");
    run(&["--camera", "0,0,99"]).expect(2, "where does the camera look?");
    run(&["--camera", "0,0", "--look-at", "0,0,0"]).expect(2, "expected X,Y,Z");
    run(&["--camera", "900,0,+5", "--look-at", "0,0,0"]).expect(2, "there is no ground below");
    run(&["--camera", "0,0,5", "--look-at", "0,0,5", "--size", "9x9"]).expect(2, "one point");
    run(&["--sun", "300"]).expect(2, "two numbers");
    run(&["--sun", "300,-5"]).expect(2, "0 to 90 degrees");
    run(&["--colour", "water=blue"]).expect(2, "RRGGBB");
    run(&["--colour", "water=0000ff"]).expect(2, "no such layer");
    Run::new(&["scene", "render", &hill, &inside(&dir, "out.jpg")]).expect(2, "name it .png");
    let endless = scene(&dir, "endless.json", r#""root": {"disc": {"base_m": 9}}"#);
    Run::new(&["scene", "render", &endless, &out]).expect(2, "the scene is endless");
    assert_eq!(listing(dir.path()), ["endless.json", "hill.json"]);
}
