//! `orograph map`, from the command line to the picture.

#![cfg(feature = "program")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder with a DEM of hills, `dem.asc`.
fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().expect("a folder for the test");
    let (rows, cols) = (60, 80);
    let mut text = format!("ncols {cols}\nnrows {rows}\nxllcorner 500000\nyllcorner 200000\ncellsize 100\n");
    text += "NODATA_value -9999\n";
    for row in 0..rows {
        for col in 0..cols {
            let hills = (f64::from(row) * 0.3).sin() * (f64::from(col) * 0.25).cos() * 200.0 + 700.0;
            let height = if row < 5 && col < 5 { -9999.0 } else { hills };
            text += &format!("{height:.1} ");
        }
        text += "\n";
    }
    fs::write(dir.path().join("dem.asc"), text).expect("the DEM is written");
    dir
}

fn orograph(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_orograph"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("the program starts")
}

/// Runs the program and expects an exit code.
fn run(folder: &Path, arguments: &[&str], code: i32) -> Output {
    let output = orograph(folder, arguments);
    assert_eq!(
        output.status.code(),
        Some(code),
        "{arguments:?}\nstdout: {}\nstderr: {}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

/// Width and height of a PNG file, from its header.
fn size(path: &Path) -> (u32, u32) {
    let bytes = fs::read(path).expect("the picture is there");
    assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n", "the signature of PNG");
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    (number(16), number(20))
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> =
        fs::read_dir(folder).expect("the folder is there").map(|entry| entry.expect("an entry").path()).collect();
    files.sort();
    files
}

#[test]
fn a_dem_becomes_a_picture_of_the_width_asked_for() {
    let dir = folder();
    let output = run(dir.path(), &["map", "dem.asc", "a.png", "--width", "500", "--title", "Hills"], 0);
    let (width, height) = size(&dir.path().join("a.png"));
    assert_eq!(width, 500);
    assert!((350..550).contains(&height), "{height}");
    let said = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(said.contains("80 x 60 cells") && said.contains("written: a.png"), "{said}");
}

#[test]
fn layers_are_drawn_whatever_their_unit() {
    let dir = folder();
    run(dir.path(), &["peaks", "dem.asc", "peaks.gpkg"], 0);
    run(dir.path(), &["peaks", "dem.asc", "feet.gpkg", "--output-unit", "ft"], 0);
    let with = |layers: &str, out: &str, more: &[&str]| {
        let mut arguments = vec!["map", "dem.asc", layers, out, "--width", "400"];
        arguments.extend(more);
        run(dir.path(), &arguments, 0);
        fs::read(dir.path().join(out)).expect("the picture is there")
    };
    run(dir.path(), &["map", "dem.asc", "plain.png", "--width", "400"], 0);
    let plain = fs::read(dir.path().join("plain.png")).expect("the picture is there");
    let metres = with("peaks.gpkg", "m.png", &[]);
    assert_ne!(metres, plain, "the layers are on it");
    assert_eq!(metres, with("feet.gpkg", "ft.png", &[]), "feet and metres make one picture");
    assert_ne!(metres, with("peaks.gpkg", "isolation.png", &["--isolation"]));
    assert_ne!(metres, with("peaks.gpkg", "no_saddles.png", &["--no-saddles"]));
    run(dir.path(), &["peaks", "dem.asc", "bare.gpkg", "--layers", "peaks"], 0);
    let output = run(dir.path(), &["map", "dem.asc", "bare.gpkg", "x.png", "--layers", "peaks,saddles"], 3);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("bare.gpkg: there is no layer saddles"), "{said}");
}

#[test]
fn layers_in_another_crs_are_reprojected() {
    let dir = folder();
    let crs = ["--crs", "EPSG:32632", "--width", "300"];
    run(dir.path(), &["peaks", "dem.asc", "utm.gpkg", "--crs", "EPSG:32632"], 0);
    // The place of the highest peak, on the equator's side of the zone: longitude and latitude of the layer.
    let document = run(dir.path(), &["peaks", "dem.asc", "x.gpkg", "--crs", "EPSG:32632", "--json"], 0).stdout;
    let document: serde_json::Value = serde_json::from_slice(&document).expect("JSON");
    let top = &document["result"]["top"][0];
    let geojson = format!(
        r#"{{"type":"FeatureCollection","name":"peaks","features":[{{"type":"Feature","properties":
            {{"elevation_m":900,"prominence_m":200}},"geometry":{{"type":"Point","coordinates":[{},{}]}}}}]}}"#,
        top["lon"], top["lat"]
    );
    fs::write(dir.path().join("lonlat.geojson"), geojson).expect("the layer is written");
    let output = run(dir.path(), &[&["map", "dem.asc", "lonlat.geojson", "a.png", "--json"], &crs[..]].concat(), 0);
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(document["result"]["peaks_drawn"], 1, "{document}");
    let output = run(dir.path(), &["map", "dem.asc", "utm.gpkg", "b.png", "--crs", "EPSG:32660", "--json"], 0);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("another DEM"), "{said}");
}

#[test]
fn the_same_call_makes_the_same_bytes() {
    let dir = folder();
    run(dir.path(), &["peaks", "dem.asc", "peaks.gpkg"], 0);
    for (out, threads) in [("a.png", "1"), ("b.png", "2"), ("c.png", "3")] {
        run(dir.path(), &["map", "dem.asc", "peaks.gpkg", out, "-j", threads], 0);
    }
    let read = |name: &str| fs::read(dir.path().join(name)).expect("the picture is there");
    assert_eq!(read("a.png"), read("b.png"));
    assert_eq!(read("a.png"), read("c.png"));
}

#[test]
fn outputs_are_replaced_only_when_told_so() {
    let dir = folder();
    fs::write(dir.path().join("a.png"), "precious").expect("a file is written");
    let output = run(dir.path(), &["map", "dem.asc", "a.png"], 4);
    assert!(String::from_utf8_lossy(&output.stderr).contains("--overwrite"));
    assert_eq!(fs::read(dir.path().join("a.png")).expect("still there"), b"precious");
    run(dir.path(), &["map", "dem.asc", "a.png", "--overwrite", "--width", "200"], 0);
    assert_eq!(size(&dir.path().join("a.png")).0, 200);
    run(dir.path(), &["map", "dem.asc", "nowhere/a.png"], 4);
}

#[test]
fn wrong_calls_and_inputs_leave_nothing_behind() {
    let dir = folder();
    fs::write(dir.path().join("text.gpkg"), "no layers at all").expect("a file is written");
    let before = files(dir.path());
    for (arguments, code, words) in [
        (&["map", "absent.tif", "a.png"][..], 3, "absent.tif: no such file"),
        (&["map", "dem.asc", "absent.gpkg", "a.png"], 3, "absent.gpkg"),
        (&["map", "dem.asc", "text.gpkg", "a.png"], 3, "text.gpkg"),
        (&["map", "dem.asc", "a.jpg"], 2, ".png"),
        (&["map", "dem.asc", "a"], 2, ".png"),
        (&["map", "dem.asc"], 2, "OUT.png"),
        (&["map", "dem.asc", "a.png", "--width", "3"], 2, "160 to 16384"),
        (&["map", "dem.asc", "a.png", "--exaggeration", "-1"], 2, "positive"),
        (&["map", "dem.asc", "a.png", "--sea-level", "high"], 2, "--sea-level"),
        (&["map", "dem.asc", "a.png", "--sea-level", "3", "--no-sea"], 2, "--no-sea"),
        (&["map", "dem.asc", "a.png", "--no-sea", "--nodata-is-sea"], 2, "--sea-level"),
        (&["map", "dem.asc", "a.png", "--isolation"], 2, "no layers"),
        (&["map", "dem.asc", "text.gpkg", "a.png", "--layers", "towns"], 2, "peaks, saddles"),
        (&["map", "dem.asc", "a.png", "--memory", "1M"], 3, "--width"),
        (&["map", "dem.asc", "a.png", "--band", "2"], 2, "band 2"),
    ] {
        let output = run(dir.path(), arguments, code);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains(words), "{arguments:?}: {said}");
        assert_eq!(files(dir.path()), before, "{arguments:?}");
    }
}

#[test]
fn json_is_one_document() {
    let dir = folder();
    let output = run(dir.path(), &["map", "dem.asc", "a.png", "--width", "300", "--json"], 0);
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one JSON document");
    assert_eq!((document["verb"].as_str(), document["outputs"][0].as_str()), (Some("map"), Some("a.png")));
    assert_eq!(document["result"]["width_px"], 300);
    assert_eq!(document["result"]["rows"], 60);
    let output = run(dir.path(), &["map", "dem.asc", "a.png", "--json"], 4);
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one JSON document");
    assert_eq!(document["error"]["kind"], "output");
}
