//! What goes wrong: the exit code, the message, and nothing left behind.

use super::{PROGRAM, Run, fixture, folder, inside, listing};
use gdal::DriverManager;
use gdal::raster::Buffer;
use std::fs;
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// Writes rows of elevations as an Arc/Info ASCII grid of 10 m cells.
fn ascii(dir: &TempDir, name: &str, rows: &[&[i32]]) -> String {
    let mut text = format!("ncols {}\nnrows {}\nxllcorner 0\nyllcorner 0\ncellsize 10\n", rows[0].len(), rows.len());
    for row in rows {
        text += &row.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
        text.push('\n');
    }
    fs::write(dir.path().join(name), text).expect("the raster is written");
    inside(dir, name)
}

/// Keeps the first 60 % of a file.
fn cut(bytes: &[u8]) -> &[u8] {
    &bytes[..bytes.len() * 6 / 10]
}

/// Runs `orograph peaks` and expects a failure that leaves the folder as it was.
fn fails(dir: &TempDir, input: &str, output: &str, options: &[&str], code: i32, words: &str) {
    let before = listing(dir.path());
    let run = Run::new(&[&["peaks", input, output], options].concat());
    run.expect(code, words);
    run.check(run.stdout().is_empty(), "nothing on standard output");
    run.check(listing(dir.path()) == before, "the folder as it was");
}

#[test]
fn inputs_that_are_no_rasters() {
    let dir = folder();
    let path = |name: &str| inside(&dir, name);
    fs::write(path("empty.tif"), "").expect("a file");
    fs::write(path("text.tif"), "just words\n").expect("a file");
    fs::write(path("cut.tif"), cut(&fs::read(fixture("jacksboro.tif")).expect("the fixture"))).expect("a file");
    for out in ["out.gpkg", "out.csv"].map(path) {
        fails(&dir, &path("absent.tif"), &out, &[], 3, "absent.tif: no such file");
        fails(&dir, &path("empty.tif"), &out, &[], 3, "empty.tif: the file is empty");
        fails(&dir, &path("text.tif"), &out, &[], 3, "text.tif: GDAL cannot open it");
        fails(&dir, &path("cut.tif"), &out, &[], 3, "cut.tif: ");
    }
    for name in ["absent.tif", "empty.tif", "text.tif", "cut.tif"] {
        Run::new(&["info", &path(name)]).expect(3, name);
        Run::new(&["stats", &path(name)]).expect(3, name);
        Run::new(&["map", &path(name), &path("out.png")]).expect(3, name);
    }
}

/// A file that opens, its directory being in front, and whose cells end early.
#[test]
fn cells_that_end_early() {
    let dir = folder();
    let whole = inside(&dir, "whole.tif");
    let (cols, rows) = (300, 200);
    {
        let driver = DriverManager::get_driver_by_name("GTiff").expect("GDAL writes GeoTIFF");
        let mut dataset = driver.create_with_band_type::<i16, _>(&whole, cols, rows, 1).expect("a file");
        dataset.set_geo_transform(&[0.0, 10.0, 0.0, 0.0, 0.0, -10.0]).expect("a geotransform");
        let cells = (0..cols * rows).map(|i| (i * 7919 % 1000) as i16).collect();
        let mut band = dataset.rasterband(1).expect("a band");
        band.write((0, 0), (cols, rows), &mut Buffer::new((cols, rows), cells)).expect("cells");
    }
    let damaged = inside(&dir, "damaged.tif");
    fs::write(&damaged, cut(&fs::read(&whole).expect("the whole"))).expect("a file");
    for out in ["out.gpkg", "out.csv"] {
        fails(&dir, &damaged, &inside(&dir, out), &[], 3, "damaged.tif: ");
    }
    let run = Run::new(&["peaks", &damaged, &inside(&dir, "out.csv"), "--json"]);
    run.expect(3, "");
    assert_eq!(run.json()["error"]["kind"], "corrupt");
}

#[test]
fn rasters_without_a_cell_of_data() {
    let dir = folder();
    let dem = ascii(&dir, "constant.asc", &[&[7, 7, 7][..]; 3]);
    fails(&dir, &dem, &inside(&dir, "out.gpkg"), &["--nodata", "7"], 3, "constant.asc: all 9 cells are nodata");
}

#[test]
fn narrow_rasters_work() {
    let dir = folder();
    for (name, rows) in
        [("two", &[&[7, 9][..], &[7, 8], &[5, 7]][..]), ("one", &[&[7][..], &[9], &[5]]), ("row", &[&[5, 9, 7]])]
    {
        let dem = ascii(&dir, &format!("{name}.asc"), rows);
        let out = inside(&dir, &format!("{name}.csv"));
        Run::done(&["peaks", &dem, &out, "--min-prominence", "1", "--layers", "peaks"]);
        let peaks = super::Csv::read(&out);
        assert_eq!(peaks.columns(&["elevation_m", "is_root"]), [["9", "true"]], "{name}");
    }
}

#[test]
fn wrong_calls() {
    let dir = folder();
    let dem = fixture("jacksboro.tif");
    let out = inside(&dir, "out.gpkg");
    for (output, options, words) in [
        ("out.gpkg", &["--band", "2"][..], "there is no band 2"),
        ("out.gpkg", &["--band", "0"], "band"),
        ("out.xyz", &[], ".gpkg, .csv, .geojson or .fgb"),
        ("out", &[], ".gpkg, .csv, .geojson or .fgb"),
        ("out.gpkg", &["--layers", "peaks,towns"], "no layer 'towns'; there are peaks, saddles"),
        ("out.gpkg", &["--min-prominence", "high"], "--min-prominence"),
        ("out.gpkg", &["--min-prominence", "-1"], "--min-prominence -1: expected 0 or more"),
        ("out.gpkg", &["--no-isolation", "--min-isolation", "1km"], "--min-isolation"),
        ("out.gpkg", &["--memory", "much"], "--memory"),
        ("out.gpkg", &["--threads", "0"], "--threads 0"),
        ("out.gpkg", &["--output-unit", "miles"], "--output-unit"),
        ("out.gpkg", &["--nonsense"], "--nonsense"),
    ] {
        fails(&dir, &dem, &inside(&dir, output), options, 2, words);
    }
    Run::new(&["peaks", &dem]).expect(2, "<OUT>");
    Run::new(&["climb", &dem, &out]).expect(2, "climb");
    Run::new(&[]).expect(2, "Usage");
}

#[test]
fn targets_that_cannot_be_written() {
    let dir = folder();
    let dem = fixture("jacksboro.tif");
    fs::write(dir.path().join("file"), "precious").expect("a file");
    fs::create_dir(dir.path().join("folder.gpkg")).expect("a folder");
    for (output, words) in [
        ("nowhere/out.gpkg", "nowhere does not exist"),
        ("nowhere/out.csv", "nowhere does not exist"),
        ("file/out.gpkg", "file is not a folder"),
        ("folder.gpkg", "is a folder; name a file"),
    ] {
        fails(&dir, &dem, &inside(&dir, output), &[], 4, words);
        fails(&dir, &dem, &inside(&dir, output), &["--overwrite"], 4, words);
    }
    assert_eq!(fs::read(dir.path().join("file")).expect("still there"), b"precious");
}

#[test]
fn outputs_that_exist() {
    let dir = folder();
    let dem = fixture("two_cones.tif");
    for (there, output) in [("out.gpkg", "out.gpkg"), ("out_saddles.csv", "out.csv")] {
        let (there, output) = (inside(&dir, there), inside(&dir, output));
        fs::write(&there, "precious").expect("a file");
        fails(&dir, &dem, &output, &[], 4, "the output exists already; replace it with --overwrite");
        assert_eq!(fs::read(&there).expect("still there"), b"precious");
        // A run that fails later does not touch it either.
        fails(&dir, &dem, &output, &["--overwrite", "--memory", "1M"], 3, "MiB");
        assert_eq!(fs::read(&there).expect("still there"), b"precious");
        Run::done(&["peaks", &dem, &output, "--overwrite"]);
        assert_ne!(fs::read(&there).expect("still there"), b"precious");
    }
}

#[test]
fn too_little_memory() {
    let dir = folder();
    let words = "the work needs about 98 MiB of memory and may use 1 MiB";
    fails(&dir, &fixture("jacksboro.tif"), &inside(&dir, "out.gpkg"), &["--memory", "1M"], 3, words);
}

#[test]
fn rotated_grids() {
    let dir = folder();
    let vrt = inside(&dir, "rotated.vrt");
    let text = format!(
        r#"<VRTDataset rasterXSize="403" rasterYSize="344"><SRS>EPSG:4326</SRS>
        <GeoTransform>-84.4, 0.0008, 0.0002, 36.7, 0.0002, -0.0008</GeoTransform>
        <VRTRasterBand dataType="Int16" band="1"><SimpleSource>
        <SourceFilename relativeToVRT="0">{}</SourceFilename><SourceBand>1</SourceBand>
        </SimpleSource></VRTRasterBand></VRTDataset>"#,
        fixture("jacksboro.tif")
    );
    fs::write(&vrt, text).expect("a VRT");
    fails(
        &dir,
        &vrt,
        &inside(&dir, "out.gpkg"),
        &[],
        3,
        "rotated; resample it to a north-up one first, for example with gdalwarp",
    );
    Run::done(&["peaks", &fixture("rotated.tif"), &inside(&dir, "out.gpkg")]);
}

#[test]
fn failures_as_json() {
    let dir = folder();
    let (dem, absent, out) = (fixture("jacksboro.tif"), inside(&dir, "absent.tif"), inside(&dir, "out.gpkg"));
    fs::write(&out, "precious").expect("a file");
    let fresh = inside(&dir, "fresh.gpkg");
    for (arguments, code, kind, words, path) in [
        (&["peaks", &absent, &fresh][..], 3, "input", "no such file", Some(&absent)),
        (&["info", &absent], 3, "input", "no such file", Some(&absent)),
        (&["stats", &absent], 3, "input", "no such file", Some(&absent)),
        (&["peaks", &dem, &out], 4, "output", "--overwrite", Some(&out)),
        (&["peaks", &dem, &fresh, "--memory", "1M"], 3, "unsupported", "98 MiB", Some(&dem)),
        (&["peaks", &dem, &fresh, "--band", "2"], 2, "usage", "no band 2", Some(&dem)),
        (&["peaks", &dem, &fresh, "--layers", "towns"], 2, "usage", "towns", None),
        (&["peaks", &dem, &fresh, "--nonsense"], 2, "usage", "--nonsense", None),
        (&["peaks", &dem], 2, "usage", "required", None),
    ] {
        let run = Run::new(&[arguments, &["--json"]].concat());
        run.expect(code, "");
        let error = &run.json()["error"];
        run.check(error["kind"] == kind, kind);
        run.check(error["message"].as_str().is_some_and(|message| message.contains(words)), words);
        run.check(error["path"].as_str() == path.map(String::as_str), "the path");
        run.check(error.get("place").is_some(), "a place, if only null");
    }
    let run = Run::done(&["peaks", &dem, &fresh, "--json"]);
    assert_eq!(run.json()["result"]["peaks"], 184);
}

#[test]
fn a_reader_that_has_read_enough() {
    let dir = folder();
    let (dem, out) = (fixture("jacksboro.tif"), inside(&dir, "out.gpkg"));
    for arguments in
        [&["peaks", &dem, &out][..], &["info", &dem], &["info", &dem, "--json"], &["stats", &dem], &["--help"], &["-V"]]
    {
        let mut command = Command::new(PROGRAM);
        command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the program starts");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("the program ends");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {said}");
        assert!(!said.contains("panicked"), "{arguments:?}: {said}");
    }
    assert!(fs::metadata(&out).is_ok(), "the output is there all the same");
}
