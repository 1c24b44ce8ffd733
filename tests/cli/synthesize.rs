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

/// A polygon in longitudes and latitudes.
fn square(path: &str, west: f64, south: f64, east: f64, north: f64) {
    let ring = format!("[[{west},{south}],[{east},{south}],[{east},{north}],[{west},{north}],[{west},{south}]]");
    let geometry = format!(r#"{{"type":"Polygon","coordinates":[{ring}]}}"#);
    let feature = format!(r#"{{"type":"Feature","properties":{{}},"geometry":{geometry}}}"#);
    fs::write(path, format!(r#"{{"type":"FeatureCollection","features":[{feature}]}}"#)).expect("written");
}

/// The rows of a layer, as texts.
fn rows(path: &str, layer: &str, fields: &[&str]) -> Vec<String> {
    let layer = read_layer(path, Some(layer), fields, None).expect("the layer");
    layer.features.iter().map(|feature| format!("{:?} {:?}", feature.values, feature.geometry)).collect()
}

#[test]
fn copy_and_complete() {
    let dir = folder();
    let (like, real, out) = (fixture("jacksboro.tif"), inside(&dir, "real.gpkg"), inside(&dir, "out.gpkg"));
    let middle = inside(&dir, "middle.geojson");
    let [west, south, east, north] = [-84.32, 36.52, -84.17, 36.66];
    square(&middle, west, south, east, north);
    Run::done(&["peaks", &like, &real]);
    let options = ["--like", &like, "--keep", &real, "--keep-within", &middle];
    let result = synthesize(&out, &options);
    let count = |name: &str| result[name].as_u64().expect("a number");
    assert!(count("kept_peaks") > 20 && count("kept_ridges") > 15, "{result}");
    assert!(count("kept_ridges") < count("kept_peaks"));
    assert_eq!(result["ranges"][0]["peaks"].as_u64(), Some(count("peaks") - count("kept_peaks")), "new ones alone");
    assert!((165..205).contains(&count("peaks")), "about as many as there were: {}", count("peaks"));
    // In the polygon are the kept peaks and no others, each within half a cell of where it was, and as prominent.
    let half = 0.51 * 30.0 / 111_319.5;
    let points = |path: &str| -> Vec<[f64; 4]> {
        let layer = read_layer(path, Some("peaks"), &["x", "y", "elevation_m", "prominence_m"], None).expect("peaks");
        let number = |value: &orograph::io::features::Value| value.number().expect("a number");
        layer.features.iter().map(|feature| [0, 1, 2, 3].map(|i| number(&feature.values[i]))).collect()
    };
    let inside_of =
        |p: &&[f64; 4], by: f64| p[0] > west + by && p[0] < east - by && p[1] > south + by && p[1] < north - by;
    let (made, told) = (points(&out), points(&real));
    let same = |a: &[f64; 4], b: &[f64; 4]| (a[0] - b[0]).abs() < half && (a[1] - b[1]).abs() < half && a[2] == b[2];
    for peak in made.iter().filter(|peak| inside_of(peak, half)) {
        assert!(told.iter().any(|other| same(peak, other)), "{peak:?} is new");
    }
    let kept: Vec<&[f64; 4]> = told.iter().filter(|peak| inside_of(peak, half)).collect();
    let found: Vec<&[f64; 4]> =
        kept.iter().map(|peak| made.iter().find(|other| same(peak, other)).expect("every peak")).collect();
    let alike = kept.iter().zip(&found).filter(|(a, b)| a[3] == b[3]).count();
    assert!(alike * 10 >= kept.len() * 9, "{alike} of {}", kept.len());
    // The same bytes for any number of threads; on land in another CRS the same peaks are kept, but for the outline's.
    let again = inside(&dir, "again.gpkg");
    Run::done(&[&["synthesize", &again, "--tree-only", "-j3"], &options[..]].concat());
    assert!(fs::read(&out).expect("bytes") == fs::read(&again).expect("bytes"));
    let land = ["--crs", "EPSG:32616", "--bbox", "731000,4037000,761000,4068000", "--overwrite"];
    let elsewhere = synthesize(&again, &[&options[..], &land].concat());
    assert!(elsewhere["kept_peaks"].as_u64().expect("a number").abs_diff(count("kept_peaks")) <= 2, "{elsewhere}");
}

#[test]
fn all_is_kept() {
    let dir = folder();
    let like = fixture("jacksboro.tif");
    let trees = ["a.gpkg", "b.gpkg", "c.gpkg"].map(|name| inside(&dir, name));
    synthesize(&trees[0], &["--like", &like, "--peaks", "150"]);
    for pair in trees.windows(2) {
        let result = synthesize(&pair[1], &["--like", &like, "--keep", &pair[0], "--peaks", "150", "--seed", "5"]);
        assert_eq!((&result["kept_peaks"], &result["kept_ridges"]), (&150.into(), &149.into()));
        assert_eq!(result["kept_peaks_with_another_prominence"], 0);
    }
    let [a, b, c] = trees;
    let fields = ["id", "elevation_m", "prominence_m", "isolation_m", "island_parent"];
    assert_eq!(rows(&a, "peaks", &fields), rows(&b, "peaks", &fields));
    assert_eq!(rows(&a, "saddles", &["elevation_m"]), rows(&b, "saddles", &["elevation_m"]));
    // What had one bend is drawn cell by cell, and so it stays.
    assert_eq!(rows(&b, "divide_tree", &["peak_a", "peak_b"]), rows(&c, "divide_tree", &["peak_a", "peak_b"]));
    assert_eq!(rows(&b, "divide_tree", &["peak_a", "peak_b"]).len(), 149);
    let refused = |options: &[&str], code: i32, words: &str| {
        let out = inside(&dir, "out.gpkg");
        Run::new(&[&["synthesize", &out, "--tree-only", "--like", &like], options].concat()).expect(code, words);
    };
    refused(&["--keep", &a, "--peaks", "149"], 2, "--peaks 149 is fewer than the 150 peaks that are kept");
    refused(&["--keep", &inside(&dir, "absent.gpkg")], 3, "absent.gpkg: no such file");
    refused(&["--keep-within", &a], 2, "--keep");
    refused(&["--keep", &a, "--keep-within", &a], 3, "there are several layers");
    let (far, small) = (inside(&dir, "far.geojson"), inside(&dir, "small.geojson"));
    square(&far, 10.0, 40.0, 11.0, 41.0);
    refused(&["--keep", &a, "--keep-within", &far], 3, "far.geojson: none of its polygons lies on the land");
    square(&small, -84.2, 36.6, -84.199, 36.601);
    refused(&["--keep", &a, "--keep-within", &small], 3, "nothing to keep");
    let west = ["--bbox", "-84.41,36.45,-84.2,36.73"];
    let out = inside(&dir, "west.gpkg");
    let run = Run::done(&[&["synthesize", &out, "--tree-only", "--like", &like, "--keep", &a], &west[..]].concat());
    run.expect(0, "peaks outside of the land, left out:");
    let text = inside(&dir, "tree.txt");
    let drawn = |peaks: &str, options: &[&str], words: &str| {
        fs::write(&text, peaks).expect("written");
        refused(&[&["--keep", &text], options].concat(), 3, words);
    };
    drawn("Peaks 1\n1 0.1 0.2 3000 1 1\n", &[], "none of its 1 peaks lies on the land");
    let metres = ["--crs", "EPSG:32616", "--bbox", "0,0,20000,20000"];
    let two = "Peaks 2\n1 0.05 0.05 3000 1 1\n2 0.05001 0.05 3010 1 1\n";
    drawn(two, &metres, "peak 2 and peak 1 lie in one cell");
    let level =
        "Peaks 2\n1 0.05 0.05 3000 1 1\n2 0.1 0.05 3010 1 1\nPromSaddles 1\n1 0.08 0.05 3000 1 1\nEdges 1\n1 2 1\n";
    drawn(level, &metres, "not below its peaks");
    drawn(&level.replace("0.05 3000 1 1\nEdges", "0.05 3005 1 1\nEdges"), &metres, "above peak 1");
}

/// Three peaks that somebody drew, without ridges: they stand, and are joined.
#[test]
fn peaks_from_a_text() {
    let dir = folder();
    let (stats, text, out) = (inside(&dir, "stats.json"), inside(&dir, "tree.txt"), inside(&dir, "out.gpkg"));
    Run::done(&["stats", &fixture("jacksboro.tif"), "-o", &stats]);
    let peaks = "1 0.05 0.05 4000 0 0\n2 0.12 0.05 3900 0 0\n3 0.1 0.15 3500 0 0\n";
    let saddles = "PromSaddles 1\n1 0.08 0.06 2500 0 0\nEdges 1\n1 2 1\n";
    fs::write(&text, format!("Peaks 3\n{peaks}{saddles}")).expect("written");
    let land = ["--like", &stats, "--bbox", "0,0,20000,20000", "--keep", &text, "--peaks", "60"];
    let result = synthesize(&out, &land);
    assert_eq!((&result["peaks"], &result["kept_peaks"], &result["kept_ridges"]), (&60.into(), &3.into(), &1.into()));
    let layer = read_layer(&out, Some("peaks"), &["elevation_m", "prominence_m"], None).expect("the layer");
    let number = |i: usize, k: usize| layer.features[i].values[k].number().expect("a number");
    let find = |feet: f64| (0..60).find(|&i| (number(i, 0) - feet * 0.3048).abs() < 1e-6).expect("the peak");
    assert!((number(find(3900.0), 1) - 1400.0 * 0.3048).abs() < 1e-6);
    assert!(number(find(4000.0), 1) > 100.0 && number(find(3500.0), 1) > 0.0);
}

#[test]
fn terrain_with_kept_peaks() {
    let dir = folder();
    let (like, real, out) = (fixture("jacksboro.tif"), inside(&dir, "real.gpkg"), inside(&dir, "out.tif"));
    let (middle, found) = (inside(&dir, "middle.geojson"), inside(&dir, "found.gpkg"));
    square(&middle, -84.32, 36.52, -84.17, 36.66);
    Run::done(&["peaks", &like, &real, "--min-prominence", "60m"]);
    let options = ["--keep", &real, "--keep-within", &middle, "--resolution", "60m", "--roughness", "0", "--json"];
    let run = Run::done(&[&["synthesize", &out, "--like", &like, "--min-prominence", "60m"], &options[..]].concat());
    let kept = run.json()["result"]["kept_peaks"].as_u64().expect("a number");
    Run::done(&["peaks", &out, &found, "--min-prominence", "60m"]);
    let elevations = |path: &str| -> Vec<[f64; 3]> {
        let layer = read_layer(path, Some("peaks"), &["x", "y", "elevation_m"], None).expect("peaks");
        let number = |value: &orograph::io::features::Value| value.number().expect("a number");
        layer.features.iter().map(|feature| [0, 1, 2].map(|i| number(&feature.values[i]))).collect()
    };
    let made = elevations(&found);
    let is_kept = |p: &&[f64; 3]| p[0] > -84.32 && p[0] < -84.17 && p[1] > 36.52 && p[1] < 36.66;
    let same = |a: &[f64; 3], b: &[f64; 3]| (a[0] - b[0]).abs() < 6e-4 && (a[1] - b[1]).abs() < 6e-4 && a[2] == b[2];
    let again = elevations(&real).iter().filter(is_kept).filter(|a| made.iter().any(|b| same(a, b))).count() as u64;
    assert!(kept > 10 && again * 100 >= kept * 92, "{again} of {kept}");
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
