//! `orograph peaks` with polygons and named points, as a user runs it.

#![cfg(feature = "program")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Three cones of 1000, 900 and 800 m on cells of 100 m: `A` in the north-west, `B` in the north-east, `C` in the
/// south-east of it.
fn three_cones(dir: &Path, header: &str) -> PathBuf {
    let mut text = format!("ncols 40\nnrows 40\n{header}\n");
    for row in 0..40_i32 {
        for col in 0..40_i32 {
            let height = [(10, 10, 1000.0), (10, 30, 900.0), (30, 30, 800.0)]
                .map(|(r, c, top): (i32, i32, f64)| top - 40.0 * f64::from((row - r).pow(2) + (col - c).pow(2)).sqrt());
            text.push_str(&format!("{:.1} ", height.into_iter().fold(100.0, f64::max)));
        }
        text.push('\n');
    }
    let path = dir.join("cones.asc");
    std::fs::write(&path, text).unwrap();
    path
}

fn in_utm(dir: &Path) -> PathBuf {
    three_cones(dir, "xllcorner 498000\nyllcorner 5098000\ncellsize 100")
}

fn geojson(dir: &Path, name: &str, features: &[String]) -> PathBuf {
    let path = dir.join(name);
    let text = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","));
    std::fs::write(&path, text).unwrap();
    path
}

fn rectangle(name: &str, [x0, y0, x1, y1]: [f64; 4]) -> String {
    format!(
        r#"{{"type":"Feature","properties":{{"name":{name}}},"geometry":{{"type":"Polygon","coordinates":
        [[[{x0},{y0}],[{x1},{y0}],[{x1},{y1}],[{x0},{y1}],[{x0},{y0}]]]}}}}"#
    )
}

fn point(properties: &str, x: f64, y: f64) -> String {
    format!(r#"{{"type":"Feature","properties":{properties},"geometry":{{"type":"Point","coordinates":[{x},{y}]}}}}"#)
}

fn orograph(dir: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_orograph")).current_dir(dir).args(words).output().unwrap()
}

/// Runs the program and returns for each peak its name and region, and what it said on standard error.
fn tags(dir: &Path, words: &[&str]) -> (Vec<(String, String)>, String) {
    let run = orograph(dir, words);
    let said = String::from_utf8(run.stderr).unwrap();
    assert!(run.status.success(), "{said}");
    let table = std::fs::read_to_string(dir.join("out.csv")).unwrap();
    let mut lines = table.lines();
    assert!(lines.next().unwrap().starts_with("id,name,region,"), "{table}");
    let tags = lines.map(|line| line.split(',').collect::<Vec<_>>()).map(|cells| (cells[1].into(), cells[2].into()));
    (tags.collect(), said)
}

fn own(pairs: [(&str, &str); 3]) -> Vec<(String, String)> {
    pairs.into_iter().map(|(name, region)| (name.to_string(), region.to_string())).collect()
}

const PEAKS: [&str; 8] = ["peaks", "cones.asc", "out.csv", "--layers", "peaks", "--overwrite", "--min-prominence", "9"];

#[test]
fn regions_and_names_in_another_crs() {
    let dir = tempfile::tempdir().unwrap();
    in_utm(dir.path());
    // A stands at 8.98772, 46.06212, B at 9.01358, 46.06212, C at 9.01357, 46.04412 (by gdaltransform).
    let west = rectangle("\"West\"", [8.9, 46.0, 9.0, 46.1]);
    let east = rectangle("\"East\"", [9.0, 46.0, 9.1, 46.1]);
    let north = rectangle("\"North\"", [8.9, 46.05, 9.1, 46.1]);
    geojson(dir.path(), "r.geojson", &[east, west, north, rectangle("null", [9.0, 46.0, 9.1, 46.1])]);
    let features = [
        point(r#"{"label":"Alpha","name":"a"}"#, 8.989, 46.0621),
        point(r#"{"label":"Nearer","name":"n"}"#, 8.9880, 46.0621),
        point(r#"{"label":null,"name":"x"}"#, 9.01358, 46.06212),
        point(r#"{"label":"Charlie","name":"c"}"#, 9.01357, 46.0452),
    ];
    geojson(dir.path(), "p.geojson", &features);
    let words = [&PEAKS[..], &["--crs", "EPSG:32632"]].concat();
    let by_region = [&words[..], &["--regions", "r.geojson"]].concat();
    let (found, said) = tags(dir.path(), &by_region);
    assert_eq!(found, own([("", "West"), ("", "East"), ("", "East")]));
    assert!(said.contains("polygons without a name: 1"), "{said}");
    assert!(said.contains("2 peaks stand in several regions") && said.contains("peak 1 in West, North"), "{said}");
    let by_name = [&words[..], &["--names", "p.geojson", "--name-field", "label"]].concat();
    let (found, said) = tags(dir.path(), &by_name);
    assert_eq!(found, own([("Nearer", ""), ("", ""), ("Charlie", "")]));
    assert_eq!(said, "");
    let (found, _) = tags(dir.path(), &[&by_name[..], &["--name-distance", "100m", "--regions", "r.geojson"]].concat());
    assert_eq!(found, own([("Nearer", "West"), ("", "East"), ("", "East")]));
    let (found, _) = tags(dir.path(), &[&by_name[..], &["--distance", "geodesic", "--name-distance", "130m"]].concat());
    assert_eq!(found[2].0, "Charlie");
}

#[test]
fn longitudes_from_0_to_360() {
    let dir = tempfile::tempdir().unwrap();
    three_cones(dir.path(), "xllcorner 290\nyllcorner -36\ncellsize 0.001");
    geojson(dir.path(), "r.geojson", &[rectangle("\"Andes\"", [-80.0, -40.0, -60.0, -30.0])]);
    geojson(dir.path(), "p.geojson", &[point(r#"{"name":"A"}"#, -69.9895, -35.9705)]);
    let words = [&PEAKS[..], &["--crs", "EPSG:4326", "--regions", "r.geojson", "--names", "p.geojson"]].concat();
    let (found, said) = tags(dir.path(), &words);
    assert_eq!(found, own([("A", "Andes"), ("", "Andes"), ("", "Andes")]), "{said}");
    assert_eq!(said, "");
}

#[test]
fn the_command_is_kept_and_wrong_calls_are_told() {
    let dir = tempfile::tempdir().unwrap();
    in_utm(dir.path());
    geojson(dir.path(), "r.geojson", &[rectangle("\"Asia\"", [70.0, 40.0, 80.0, 50.0])]);
    let base = ["peaks", "cones.asc", "out.gpkg", "--crs", "EPSG:32632", "--json"];
    let run = orograph(dir.path(), &[&base[..], &["--regions", "r.geojson"]].concat());
    let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    let warning = document["warnings"][0].as_str().unwrap();
    assert!(warning.contains("no peak stands in any of the 1 regions"), "{warning}");
    assert_eq!(document["result"]["in_regions"], 0);
    let bytes = std::fs::read(dir.path().join("out.gpkg")).unwrap();
    let command = b"--regions r.geojson --region-field name --crs EPSG:32632";
    assert!(bytes.windows(command.len()).any(|window| window == command));
    std::fs::remove_file(dir.path().join("out.gpkg")).unwrap();
    for (words, code, message) in [
        (vec!["--regions", "absent.gpkg"], 3, "absent.gpkg: no such file"),
        (vec!["--regions", "r.geojson", "--region-field", "titel"], 3, "there is no field 'titel': the layer has name"),
        (vec!["--regions", "r.geojson", "--region-layer", "x"], 3, "there is no layer 'x': it has r"),
        (vec!["--names", "r.geojson"], 3, "no point with a name"),
        (vec!["--region-field", "name"], 2, "--regions"),
        (vec!["--names", "r.geojson", "--name-distance", "far"], 2, "--name-distance"),
    ] {
        let run = orograph(dir.path(), &[&base[..5], &words[..]].concat());
        let said = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(code), "{words:?}: {said}");
        assert!(said.contains(message), "{words:?}: {said}");
        assert!(!dir.path().join("out.gpkg").exists(), "nothing is written");
    }
}
