//! The sparse profile from the command line: `encode --sparse`, `learn`, and what other verbs make of it.

use super::rasters::{Raster, facts, terrain};
use super::{Run, fixture, folder, inside, listing};
use serde_json::Value;
use std::fs;

fn hills(dir: &tempfile::TempDir, voids: bool) -> String {
    let (c, r) = (150, 110);
    let cells: Vec<i16> = terrain(c, r).into_iter().map(|v| (v * 900.0) as i16).collect();
    let hole = |(i, v): (usize, i16)| if voids && (20..60).contains(&(i % c)) && i / c < 30 { -32768 } else { v };
    let cells = cells.into_iter().enumerate().map(hole).collect();
    let path = inside(dir, "hills.tif");
    Raster { nodata: Some(-32768.0), ..Raster::new((c, r), vec![cells]) }.write(&path);
    path
}

fn encode(input: &str, output: &str, options: &[&str]) -> Value {
    Run::done(&[&["encode", input, output, "--sparse", "--json"], options].concat()).json()["result"].clone()
}

/// Values of a band, NaN where there is none.
fn values(path: &str) -> Vec<f64> {
    orograph::io::messages::quiet();
    let dataset = gdal::Dataset::open(path).expect("opens");
    let (size, band) = (dataset.raster_size(), dataset.rasterband(1).expect("a band"));
    let void = band.no_data_value();
    let cells = band.read_as::<f64>((0, 0), size, size, None).expect("cells");
    cells.data().iter().map(|&v| if Some(v) == void { f64::NAN } else { v }).collect()
}

#[test]
fn errors_are_those_that_it_tells() {
    let dir = folder();
    for voids in [false, true] {
        let (hills, oro, back) = (hills(&dir, voids), inside(&dir, "a.oro"), inside(&dir, "back.tif"));
        let told = encode(&hills, &oro, &["--atoms", "20", "--sparsity", "3", "--overwrite"]);
        Run::done(&["verify", &oro]);
        Run::done(&["decode", &oro, &back, "--overwrite"]);
        let (before, after) = (values(&hills), values(&back));
        let mut squares = (0.0, 0.0, 0.0_f64);
        for (before, after) in before.iter().zip(&after) {
            assert_eq!(before.is_nan(), after.is_nan(), "voids stay voids, and nothing else becomes one");
            if !before.is_nan() {
                let error = (before - after).abs();
                squares = (squares.0 + error * error, squares.1 + 1.0, squares.2.max(error));
            }
        }
        let dictionary = &told["dictionary"];
        let near = |a: &Value, b: f64| (a.as_f64().expect("a number") / b - 1.0).abs() < 1e-9;
        assert!(near(&dictionary["rmse"], f64::sqrt(squares.0 / squares.1)), "{dictionary}");
        assert!(near(&told["bands"][0]["largest_error"], squares.2), "{told}");
        assert_eq!(dictionary["atoms"], 20);
        let info = Run::done(&["info", &oro, "--json"]).json();
        assert_eq!(&info["result"]["dictionary"], dictionary);
        assert_eq!(info["result"]["bands"][0]["type"], "Float32");
        assert_eq!(told["bytes"].as_u64(), fs::metadata(&oro).ok().map(|file| file.len()));
        // The place on Earth is kept.
        assert_eq!(facts(&hills).transform, facts(&back).transform);
    }
}

#[test]
fn bytes_depend_on_no_threads_and_no_tiles_change_a_cell() {
    let dir = folder();
    let hills = hills(&dir, true);
    let [one, two, small] = ["one.oro", "two.oro", "small.oro"].map(|name| inside(&dir, name));
    encode(&hills, &one, &["-j", "1"]);
    encode(&hills, &two, &["-j", "3"]);
    assert!(fs::read(&one).expect("there") == fs::read(&two).expect("there"), "the same bytes");
    encode(&hills, &small, &["--tile-size", "64"]);
    let [a, b] = ["a.tif", "b.tif"].map(|name| inside(&dir, name));
    Run::done(&["decode", &one, &a]);
    Run::done(&["decode", &small, &b]);
    assert!(facts(&a).bands[0].bits == facts(&b).bands[0].bits, "the same cells");
    let [a, b] = ["c.tif", "d.tif"].map(|name| inside(&dir, name));
    Run::done(&["decode", &one, &a, "--window", "30,20,64,50", "--level", "1"]);
    Run::done(&["decode", &small, &b, "--window", "30,20,64,50", "--level", "1"]);
    assert!(facts(&a).bands[0].bits == facts(&b).bands[0].bits, "the same cells of a level");
}

#[test]
fn more_atoms_a_patch_are_nearer() {
    let dir = folder();
    let (hills, oro) = (hills(&dir, false), inside(&dir, "a.oro"));
    let rmse = |sparsity: &str| {
        let told = encode(&hills, &oro, &["--sparsity", sparsity, "--atoms", "30", "--overwrite"]);
        told["dictionary"]["rmse"].as_f64().expect("a number")
    };
    let found = ["1", "2", "6"].map(rmse);
    assert!(found[0] > found[1] && found[1] > found[2], "{found:?}");
}

#[test]
fn dictionaries_are_learned_and_used() {
    let dir = folder();
    let (hills, atoms, oro) = (hills(&dir, true), inside(&dir, "atoms.oro"), inside(&dir, "a.oro"));
    for constrained in [&[][..], &["--constrained"]] {
        let learn = ["learn", &fixture("jacksboro.tif"), &hills, &atoms, "--atoms", "16", "--overwrite", "--json"];
        let told = Run::done(&[&learn[..], constrained].concat()).json()["result"].clone();
        assert_eq!((told["atoms"].as_u64(), told["patch"].as_u64()), (Some(16), Some(8)));
        let errors: Vec<f64> =
            told["unexplained"].as_array().expect("a list").iter().map(|v| v.as_f64().expect("a number")).collect();
        assert!(errors.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-12)), "never worse: {errors:?}");
        assert!(errors.last().is_some_and(|&last| last < 0.5), "{errors:?}");
        Run::done(&["verify", &atoms]);
        let told = encode(&hills, &oro, &["--dictionary", &atoms, "--sparsity", "2", "--overwrite"]);
        assert_eq!(told["dictionary"]["atoms"], 16);
    }
    // A raster is no dictionary.
    Run::done(&["encode", &hills, &oro, "--overwrite"]);
    let run = Run::new(&["encode", &hills, &inside(&dir, "b.oro"), "--sparse", "--dictionary", &oro]);
    run.expect(3, "the file has no dictionary");
}

#[test]
fn units_do_not_weigh() {
    let dir = folder();
    let (cols, rows) = (90, 70);
    let metres = terrain(cols, rows).into_iter().map(|v| (v * 1250.0) as f32);
    let other: Vec<f32> = terrain(rows, cols).into_iter().map(|v| (v * 3e3) as f32).collect();
    let [m, dm, plain, other_m] = ["m.tif", "dm.oro", "plain.tif", "other.tif"].map(|name| inside(&dir, name));
    let cells: Vec<f32> = metres.collect();
    let tenfold: Vec<f32> = cells.iter().map(|v| v * 10.0).collect();
    Raster::new((cols, rows), vec![cells]).write(&m);
    Raster::new((cols, rows), vec![tenfold]).write(&plain);
    Run::done(&["encode", &plain, &dm, "--lossless", "--vertical-unit", "dm"]);
    Raster::new((rows, cols), vec![other]).write(&other_m);
    let unexplained = |first: &str| {
        let told =
            Run::done(&["learn", first, &other_m, &inside(&dir, "a.oro"), "--atoms", "6", "--overwrite", "--json"]);
        told.json()["result"]["unexplained"][0].as_f64().expect("a number")
    };
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-3;
    assert!(near(unexplained(&dm), unexplained(&m)), "as declared");
    assert!(!near(unexplained(&plain), unexplained(&m)), "without a unit relief is ten times as high");
    let forced =
        Run::done(&["learn", &plain, &inside(&dir, "b.oro"), "--atoms", "6", "--vertical-unit", "dm", "--json"]);
    assert!(forced.json()["result"]["unexplained"].is_array());
    Run::new(&["learn", &m, &inside(&dir, "c.oro"), "--vertical-unit", "ell"]).expect(2, "'ell' is not a known unit");
}

#[test]
fn flat_and_void_rasters() {
    let dir = folder();
    let [path, oro, back] = ["flat.tif", "flat.oro", "back.tif"].map(|name| inside(&dir, name));
    for (value, nodata) in [(7.5_f32, None), (-9999.0, Some(-9999.0))] {
        Raster { nodata, ..Raster::new((33, 9), vec![vec![value; 33 * 9]]) }.write(&path);
        encode(&path, &oro, &["--overwrite"]);
        Run::done(&["decode", &oro, &back, "--overwrite"]);
        assert_eq!(facts(&path).bands[0].bits, facts(&back).bands[0].bits);
    }
}

#[test]
fn refusals() {
    let dir = folder();
    let (hills, oro) = (hills(&dir, false), inside(&dir, "a.oro"));
    let refused = |options: &[&str], code: i32, words: &str| {
        Run::new(&[&["encode", &hills, &oro], options].concat()).expect(code, words);
        assert_eq!(listing(dir.path()), ["hills.tif"], "nothing is left behind");
    };
    refused(&["--atoms", "3"], 2, "--atoms");
    refused(&["--sparse", "--lossless"], 2, "cannot be used with");
    refused(&["--sparse", "--max-error", "1m"], 2, "cannot be used with");
    refused(&["--sparse", "--sparsity", "0"], 2, "1..=64");
    refused(&["--sparse", "--patch", "2"], 2, "3 to 4096");
    refused(&["--sparse", "--step", "7"], 2, "steps of 1 to");
    refused(&["--sparse", "--atoms", "0"], 2, "atoms");
    refused(&["--sparse", "--dictionary", "none.oro"], 3, "none.oro");
    Run::new(&["learn", &hills, &inside(&dir, "out.tif")]).expect(2, "name it so");
    Run::new(&["learn", "none.tif", &oro]).expect(3, "none.tif");
}
