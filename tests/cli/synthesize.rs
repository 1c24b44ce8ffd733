//! `orograph synthesize`: what its files hold, and what it refuses.

use super::rasters::Raster;
use super::{Run, fixture, folder, inside, listing};
use orograph::io::features::{list_layers, metadata_item, read_layer};
use serde_json::Value;
use std::fs;

/// Runs it and returns its result.
fn synthesize(output: &str, options: &[&str]) -> Value {
    Run::done(&[&["synthesize", output, "--tree-only", "--json"], options].concat()).json()["result"].clone()
}

/// The largest difference of a bin between the first range and what was made, in per cent.
fn error(result: &Value, metric: &str) -> f64 {
    let metrics = result["ranges"][0]["metrics"].as_array().expect("metrics");
    let of = metrics.iter().find(|of| of["metric"] == metric).expect("the metric");
    100.0 * of["largest_bin_difference"].as_f64().expect("a number")
}

#[test]
fn the_layers_of_peaks() {
    let dir = folder();
    let (like, out, peaks) = (fixture("jacksboro.tif"), inside(&dir, "out.gpkg"), inside(&dir, "peaks.gpkg"));
    let result = synthesize(&out, &["--like", &like]);
    Run::done(&["peaks", &like, &peaks]);
    let layers = |path: &str| -> Vec<(String, Vec<String>)> {
        list_layers(path).expect("layers").into_iter().map(|layer| (layer.name, layer.fields)).collect()
    };
    assert_eq!(layers(&out), layers(&peaks), "the layers and fields of orograph peaks, styles among them");
    assert_eq!((&result["peaks"], &result["edges"]), (&184.into(), &183.into()), "as many as the range has");
    for (metric, most) in [("prominence", 1.0), ("dominance", 1.1), ("elevation", 0.01), ("isolation_distance", 4.0)] {
        assert!(error(&result, metric) <= most, "{metric}: {}", error(&result, metric));
    }
    let made = read_layer(&out, Some("peaks"), &["elevation_m", "x", "y"], None).expect("the layer");
    assert_eq!(made.features.len(), 184);
    let real = read_layer(&peaks, Some("peaks"), &["elevation_m"], None).expect("the layer");
    assert_eq!(made.crs_wkt, real.crs_wkt);
    let command = metadata_item(&out, "OROGRAPH_COMMAND").expect("readable").expect("a command");
    assert!(command.ends_with("--seed 0 --min-prominence 30m"), "{command}");
    // What was made is a range to be like, too.
    let again = synthesize(&inside(&dir, "again.csv"), &["--like", &out, "--seed", "5"]);
    assert_eq!(again["peaks"], 184);
    assert!(error(&again, "dominance") <= 1.1 && error(&again, "isolation_distance") <= 4.0, "{again}");
    assert!(listing(dir.path()).contains(&"again_divide_tree.csv".to_string()));
}

#[test]
fn the_same_bytes_whatever_the_threads() {
    let dir = folder();
    let like = fixture("jacksboro.tif");
    let made = [("a.gpkg", "-j1", "9"), ("b.gpkg", "-j2", "9"), ("c.gpkg", "-j3", "9"), ("d.gpkg", "-j1", "8")].map(
        |(name, threads, seed)| {
            let out = inside(&dir, name);
            Run::done(&["synthesize", &out, "--tree-only", "--like", &like, "--seed", seed, threads]);
            fs::read(out).expect("the output")
        },
    );
    assert!(made[0] == made[1] && made[0] == made[2] && made[0] != made[3]);
}

#[test]
fn terrain_with_its_tree() {
    let dir = folder();
    let (like, out, tree) = (fixture("jacksboro.tif"), inside(&dir, "out.tif"), inside(&dir, "tree.gpkg"));
    let options = ["--like", &like, "--tree", &tree, "--ground-map", &like, "--resolution", "60m", "--json"];
    let result = Run::done(&[&["synthesize", &out], &options[..]].concat()).json()["result"].clone();
    assert!(result["slope"].as_f64().is_some_and(|slope| slope > 0.05 && slope < 1.0), "{}", result["slope"]);
    let found = inside(&dir, "found.gpkg");
    Run::done(&["peaks", &out, &found]);
    let points = |path: &str| -> Vec<(f64, f64)> {
        let layer = read_layer(path, Some("peaks"), &["x", "y"], None).expect("the layer");
        let number = |value: &orograph::io::features::Value| value.number().expect("a number");
        layer.features.iter().map(|feature| (number(&feature.values[0]), number(&feature.values[1]))).collect()
    };
    let (wanted, found) = (points(&tree), points(&found));
    let cell = 60.0 / 111_000.0;
    let near = |a: &(f64, f64), b: &(f64, f64)| (a.0 - b.0).abs() < 2.5 * cell && (a.1 - b.1).abs() < 2.5 * cell;
    let kept = wanted.iter().filter(|peak| found.iter().any(|other| near(peak, other))).count();
    // Cells of 60 m are coarse for peaks of 30 m.
    assert!(kept * 100 >= wanted.len() * 92, "{kept} of {}", wanted.len());
}

#[test]
fn statistics_that_were_edited() {
    let dir = folder();
    let (stats, out) = (inside(&dir, "stats.json"), inside(&dir, "out.geojson"));
    Run::done(&["stats", &fixture("jacksboro.tif"), "-o", &stats]);
    let mut document: Value = serde_json::from_str(&fs::read_to_string(&stats).expect("the file")).expect("JSON");
    // All peaks between 700 and 800 m, but for one.
    let elevation = &mut document["domains"][0]["metrics"]["elevation"]["fine"];
    let counts = elevation["counts"].as_array_mut().expect("counts");
    counts.iter_mut().for_each(|count| *count = 0.into());
    (counts[7], counts[10]) = (183.into(), 1.into());
    fs::write(&stats, document.to_string()).expect("written");
    let land = ["--like", &stats, "--bbox", "0,0,30000,30000", "--peaks", "100"];
    let result = synthesize(&out, &land);
    assert_eq!((&result["peaks"], &result["rows"], &result["cols"]), (&100.into(), &1000.into(), &1000.into()));
    let peaks = read_layer(inside(&dir, "out_peaks.geojson"), None, &["elevation_m"], None).expect("the layer");
    let elevation_m = |i: usize| peaks.features[i].values[0].number().expect("a number");
    let high = (0..100).filter(|&i| elevation_m(i) > 1000.0).count();
    let middle = (0..100).filter(|&i| (700.0..800.0).contains(&elevation_m(i))).count();
    assert!(high <= 1 && high + middle == 100, "{high} {middle}");
}

#[test]
fn maps() {
    let dir = folder();
    let map = |name: &str, cells: Vec<i16>, step: f64| {
        let path = inside(&dir, name);
        let transform = Some([500_000.0, step, 0.0, 4_020_000.0, 0.0, -step]);
        Raster { transform, crs: Some("EPSG:32617"), ..Raster::new((2, 2), vec![cells]) }.write(&path);
        path
    };
    let (like, out) = (fixture("jacksboro.tif"), inside(&dir, "out.csv"));
    let density = map("density.tif", vec![1, 0, 1, 0], 10_000.0);
    let land = ["--like", &like, "--crs", "EPSG:32617", "--bbox", "500000,4000000,520000,4020000", "--overwrite"];
    let result = synthesize(&out, &[&land[..], &["--density-map", &density]].concat());
    let peaks = super::Csv::read(inside(&dir, "out_peaks.csv"));
    assert_eq!(result["peaks"], peaks.rows.len());
    for row in peaks.columns(&["x"]) {
        assert!(row[0].parse::<f64>().expect("a number") < 510_000.0, "{row:?}");
    }
    let small = map("small.tif", vec![1, 0, 1, 0], 100.0);
    let refused = |options: &[&str], code: i32, words: &str| {
        Run::new(&[&["synthesize", &out, "--tree-only"], &land[..], options].concat()).expect(code, words);
    };
    refused(&["--elevation-map", &small], 3, "small.tif: the map does not cover the land");
    refused(&["--density-map", &like], 3, "jacksboro.tif: the map is in EPSG:4326 and the land in EPSG:32617");
    refused(&["--type-map", &inside(&dir, "absent.tif")], 3, "absent.tif: no such file");
    refused(&["--like", &like], 2, "--type-map");
}

#[test]
fn what_is_refused() {
    let dir = folder();
    let (like, out, stats) = (fixture("jacksboro.tif"), inside(&dir, "out.gpkg"), inside(&dir, "stats.json"));
    Run::done(&["stats", &like, "-o", &stats]);
    let empty = inside(&dir, "empty.json");
    Run::done(&["stats", &like, "-o", &empty, "--min-prominence", "9000m"]);
    let text = fs::read_to_string(&empty).expect("the file");
    // A root always counts: take it away.
    let mut document: Value = serde_json::from_str(&text).expect("JSON");
    document["domains"][0]["peak_count"] = 0.into();
    fs::write(&empty, document.to_string()).expect("written");
    let before = listing(dir.path());
    let refused = |options: &[&str], code: i32, words: &str| {
        let run = Run::new(&[&["synthesize", &out], options].concat());
        run.expect(code, words);
        run.check(listing(dir.path()) == before, "nothing left behind");
    };
    refused(&["--like", &like], 2, "out.gpkg is no raster: give a .tif for terrain, or --tree-only");
    refused(&["--like", &like, "--tree-only", "--slope", "0.4"], 2, "--tree-only makes no terrain");
    refused(&["--like", &like, "--tree-only", "--tree", "x.gpkg"], 2, "--tree");
    refused(&["--tree-only"], 2, "--like");
    let tree = |options: &[&str], code: i32, words: &str| refused(&[&["--tree-only"], options].concat(), code, words);
    tree(&["--like", &inside(&dir, "absent.tif")], 3, "absent.tif: no such file");
    tree(&["--like", &empty], 3, "empty.json: the statistics of 'whole' hold no peaks");
    tree(&["--like", &stats], 2, "--bbox");
    tree(&["--like", &stats, "--domain", "x", "--bbox", "0,0,9,9"], 2, "no domain is called 'x'");
    tree(&["--like", &like, "--peaks", "0"], 2, "there would be no peaks");
    tree(&["--like", &like, "--peaks", "9000000000"], 3, "memory");
    tree(&["--like", &stats, "--bbox", "0,0,600,600", "--peaks", "300"], 2, "have no room");
    tree(&["--like", &stats, "--bbox", "0,0,60,60"], 2, "there would be no peaks");
    tree(&["--like", &like, "--bbox", "1,1,0,2"], 2, "expected the least x and y");
    tree(&["--like", &like, "--bbox", "1,1,2"], 2, "four numbers");
    tree(&["--like", &like, "--bbox", "0,80,1,95"], 2, "beyond a pole");
    tree(&["--like", &like, "--bbox", "-170,-80,170,80"], 3, "coarser --resolution");
    tree(&["--like", &like, "--crs", "EPSG:32617"], 2, "--bbox");
    tree(&["--like", &like, "--crs", "nonsense"], 2, "nonsense");
    tree(&["--like", &like, "--resolution", "0m"], 2, "--resolution");
    tree(&["--like", &like, "--ridge-exponent", "3"], 2, "--ridge-exponent");
    Run::new(&["synthesize", &inside(&dir, "out.tif"), "--tree-only", "--like", &like]).expect(2, "out.tif");
}
