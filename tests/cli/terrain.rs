//! `orograph terrain`: trees there and back, and what it refuses.

use super::{Run, fixture, folder, inside, listing};
use gdal::vector::LayerAccess;
use gdal::vector::sql::Dialect;
use gdal::{Dataset, DatasetOptions, GdalOpenFlags};
use serde_json::Value;
use std::fs;

/// Changes a file with a statement.
fn change(path: &str, statement: &str) {
    let flags = GdalOpenFlags::GDAL_OF_UPDATE | GdalOpenFlags::GDAL_OF_VECTOR;
    let options = DatasetOptions { open_flags: flags, ..DatasetOptions::default() };
    let dataset = Dataset::open_ex(path, options).expect("the file");
    drop(dataset.execute_sql(statement, None, Dialect::DEFAULT).expect("a statement"));
    dataset.close().expect("written");
}

/// Elevations and prominences of the peaks of a raster, the highest first.
fn peaks(raster: &str, at_least: &str, out: &str) -> Vec<(i64, i64)> {
    Run::done(&["peaks", raster, out, "--min-prominence", at_least, "--overwrite"]);
    let dataset = Dataset::open(out).expect("the layers");
    let mut layer = dataset.layer_by_name("peaks").expect("a layer");
    let decimetres = |value: Option<f64>| (value.expect("a number") * 10.0).round() as i64;
    let names = ["elevation_m", "prominence_m"].map(|name| layer.defn().field_index(name).expect("a field"));
    let mut found: Vec<(i64, i64)> = layer
        .features()
        .map(|feature| {
            let [elevation, prominence] = names.map(|i| decimetres(feature.field_as_double(i).expect("a field")));
            (elevation, prominence)
        })
        .collect();
    found.sort_unstable();
    found
}

#[test]
fn there_and_back() {
    let dir = folder();
    let (tree, again, out) = (inside(&dir, "tree.gpkg"), inside(&dir, "again.gpkg"), inside(&dir, "out.tif"));
    let real = peaks(&fixture("jacksboro.tif"), "60m", &tree);
    let run = Run::done(&["terrain", &tree, &out, "--resolution", "90m", "--roughness", "0", "--json"]);
    let result: Value = run.json()["result"].clone();
    assert_eq!(result["peaks"], real.len());
    assert_eq!(result["crossing_ridges"], 0);
    let made = peaks(&out, "60m", &again);
    // Peaks at the edge count from the lowest ground, which is another.
    let lost: Vec<_> = real.iter().filter(|peak| !made.contains(peak)).collect();
    assert!(lost.len() <= 1 + real.len() / 20, "{lost:?} of {real:?} are not among {made:?}");
    let info = Dataset::open(&out).expect("a raster");
    assert!(info.spatial_ref().is_ok(), "the CRS came with the tree");
    // A peak that is raised in the layer is raised in the terrain.
    change(&tree, "UPDATE peaks SET elevation_m = 2000 WHERE id = 1");
    Run::done(&["terrain", &tree, &out, "--resolution", "90m", "--overwrite"]);
    assert_eq!(peaks(&out, "60m", &again).last().map(|peak| peak.0), Some(20_000));
}

#[test]
fn the_same_bytes_whatever_the_threads() {
    let dir = folder();
    let tree = inside(&dir, "tree.gpkg");
    Run::done(&["peaks", &fixture("jacksboro.tif"), &tree]);
    let made = [("a.tif", "-j1", "3"), ("b.tif", "-j3", "3"), ("c.tif", "-j2", "4")].map(|(name, threads, seed)| {
        let out = inside(&dir, name);
        Run::done(&["terrain", &tree, &out, "--resolution", "60m", "--seed", seed, threads]);
        fs::read(out).expect("the output")
    });
    assert!(made[0] == made[1] && made[0] != made[2]);
}

#[test]
fn a_ground_map_makes_the_mean() {
    let dir = folder();
    let (tree, out, dem) = (inside(&dir, "tree.gpkg"), inside(&dir, "out.tif"), fixture("jacksboro.tif"));
    Run::done(&["peaks", &dem, &tree]);
    Run::done(&["terrain", &tree, &out, "--resolution", "60m", "--ground-map", &dem]);
    let mean = |path: &str| {
        let dataset = Dataset::open(path).expect("a raster");
        let band = dataset.rasterband(1).expect("a band");
        band.read_band_as::<f32>().map(|cells| cells.data().iter().sum::<f32>() / cells.len() as f32).expect("cells")
    };
    assert!((mean(&out) - mean(&dem)).abs() < 40.0, "{} for {}", mean(&out), mean(&dem));
}

#[test]
fn texts() {
    let dir = folder();
    let write = |name: &str, text: &str| {
        let path = inside(&dir, name);
        fs::write(&path, text).expect("written");
        path
    };
    let spots = "Peaks 3\n1 0.02 0.02 3000 0 0\n2 0.05 0.02 2800 0 0\n3 0.03 0.05 2600 0 0\n\
                 PromSaddles 3\n1 0.035 0.018 1500 0 0\n2 0.042 0.036 1200 0 0\n3 0.024 0.036 1400 0 0\n";
    let out = inside(&dir, "out.tif");
    let tree = write("tree.txt", &format!("{spots}Edges 2\n1 2 1\n2 3 2\n"));
    let run = Run::done(&["terrain", &tree, &out, "--resolution", "60m"]);
    run.check(run.stderr().contains("left out: 1"), "a word on the third saddle");
    Run::done(&["terrain", &tree, &out, "--overwrite", "--crs", "EPSG:32632"]);
    let circle = write("circle.txt", &format!("{spots}Edges 3\n1 2 1\n2 3 2\n3 1 3\n"));
    let before = listing(dir.path());
    let refused = |tree: &str, options: &[&str], code: i32, words: &str| {
        let run = Run::new(&[&["terrain", tree, &inside(&dir, "new.tif")], options].concat());
        run.expect(code, words);
        run.check(listing(dir.path()) == before, "nothing left behind");
    };
    refused(&circle, &[], 3, "closes a circle of ridges");
    refused(&tree, &["--bbox", "0,0,3000,3000"], 3, "lies outside of the land");
    refused(&tree, &["--resolution", "9km"], 3, "lie in one cell");
    refused(&tree, &["--slope", "0"], 2, "--slope 0");
    refused(&tree, &["--roughness", "2"], 2, "--roughness 2");
    refused(&tree, &["--curvature", "0.5"], 2, "--curvature 0.5");
    refused(&tree, &["--erosion", "11"], 2, "--erosion 11");
    refused(&tree, &["--resolution", "0m"], 2, "--resolution");
    refused(&tree, &["--resolution", "1mm"], 3, "coarser --resolution");
    refused(&tree, &["--resolution", "1m", "--memory", "300M"], 3, "memory");
    refused(&tree, &["--ground-map", &fixture("void.tif")], 3, "does not cover the land");
    refused(&inside(&dir, "absent.txt"), &[], 3, "absent.txt: no such file");
    Run::new(&["terrain", &tree, &out]).expect(4, "exists");
    Run::new(&["terrain", &tree, &inside(&dir, "out.gpkg")]).expect(2, "no raster");
}

#[test]
fn trees_that_are_none() {
    let dir = folder();
    let (sound, tree, out) = (inside(&dir, "sound.gpkg"), inside(&dir, "tree.gpkg"), inside(&dir, "out.tif"));
    Run::done(&["peaks", &fixture("jacksboro.tif"), &sound, "--min-prominence", "90m"]);
    let refused = |statement: &str, words: &str| {
        fs::copy(&sound, &tree).expect("a copy");
        change(&tree, statement);
        Run::new(&["terrain", &tree, &out, "--resolution", "90m"]).expect(3, words);
        assert!(!listing(dir.path()).contains(&"out.tif".to_string()));
    };
    refused("UPDATE peaks SET elevation_m = NULL WHERE fid = 3", "peak 3 has no elevation");
    refused("UPDATE saddles SET elevation_m = 99999 WHERE fid = 2", "saddle 2 is 99999 m high, above peak");
    refused("DELETE FROM saddles WHERE fid = 2", "leads over no saddle");
    refused("UPDATE peaks SET geom = (SELECT geom FROM peaks WHERE fid = 2) WHERE fid = 1", "lie in one cell");
    refused("INSERT INTO divide_tree (geom) SELECT geom FROM divide_tree WHERE fid = 1", "both lead over saddle");
    refused("DELETE FROM peaks WHERE fid > 1", "begins and ends at peak 1");
    refused("DELETE FROM peaks", "there are no peaks");
    refused("DROP TABLE divide_tree", "there is no layer 'divide_tree'");
    let (cone, scrap) = (fixture("cone.tif"), inside(&dir, "scrap.txt"));
    fs::write(&scrap, "no tree").expect("written");
    Run::new(&["terrain", &cone, &out]).expect(3, "cone.tif");
    Run::new(&["terrain", &scrap, &out]).expect(3, "line 1");
}
