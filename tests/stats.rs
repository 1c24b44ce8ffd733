//! `orograph stats`, as a user runs it.

#![cfg(feature = "program")]

mod schema;

use schema::validate;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Many cones of several heights on a plane that rises eastwards, on 60 x 60 cells of 100 m in UTM zone 32; one void.
fn terrain(dir: &Path, name: &str, lift: f64) {
    let mut text =
        "ncols 60\nnrows 60\nxllcorner 497000\nyllcorner 5097000\ncellsize 100\nNODATA_value -9999\n".to_string();
    let cones: Vec<(i32, i32, f64)> =
        (0..25).map(|i| (4 + i * 37 % 53, 3 + i * 23 % 55, 700.0 + lift + f64::from(i * 71 % 400))).collect();
    for row in 0..60_i32 {
        for col in 0..60_i32 {
            let cone =
                |&(r, c, top): &(i32, i32, f64)| top - 60.0 * f64::from((row - r).pow(2) + (col - c).pow(2)).sqrt();
            let height = cones.iter().map(cone).fold(300.0 + f64::from(col), f64::max);
            text.push_str(&if (row, col) == (59, 59) { "-9999 ".to_string() } else { format!("{height:.2} ") });
        }
        text.push('\n');
    }
    fs::write(dir.join(name), text).unwrap();
    // Two halves that meet in the middle column of cells, and one far away.
    let rectangle = |name: &str, x0: f64, x1: f64| {
        format!(
            r#"{{"type":"Feature","properties":{{"title":"{name}"}},"geometry":{{"type":"Polygon","coordinates":
            [[[{x0},45.9],[{x1},45.9],[{x1},46.2],[{x0},46.2],[{x0},45.9]]]}}}}"#
        )
    };
    // x = 500000 is the meridian of 9 degrees.
    let features = [rectangle("west", 8.5, 9.0), rectangle("east, far", 9.0, 9.5), rectangle("Andes", -70.0, -69.0)];
    let collection = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","));
    fs::write(dir.join("regions.geojson"), collection).unwrap();
}

fn orograph(dir: &Path, words: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_orograph")).current_dir(dir).args(words.split(' ')).output().unwrap()
}

/// What a successful run prints, and what it says on standard error.
fn done(dir: &Path, words: &str) -> (String, String) {
    let run = orograph(dir, words);
    let said = String::from_utf8(run.stderr).unwrap();
    assert!(run.status.success(), "{words}: {said}");
    (String::from_utf8(run.stdout).unwrap(), said)
}

fn read_json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

const CRS: &str = "--crs EPSG:32632";

#[test]
fn a_dem_by_region_and_disk() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    terrain(at, "dem.asc", 0.0);
    let words = format!(
        "stats dem.asc {CRS} -o s.json -o s.csv -o s.svg -o s.png --regions regions.geojson --region-field title --disk 500000,5100000,1km"
    );
    let (printed, said) = done(at, &words);
    assert_eq!(printed, "written: s.json\nwritten: s.csv\nwritten: s.svg\nwritten: s.png\n");
    assert!(said.contains("regions without a cell of the DEM, left out: 1"), "{said}");
    let document = read_json(&at.join("s.json"));
    let schema: Value = serde_json::from_str(include_str!("../format-spec/stats.schema.json")).unwrap();
    validate(&document, &schema, &schema, "document");
    let domains = document["domains"].as_array().unwrap();
    let names: Vec<_> = domains.iter().map(|domain| domain["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["whole", "west", "east, far", "500000,5100000,1km"]);
    assert_eq!(document["input"], json!({ "path": "dem.asc", "kind": "dem", "crs": "EPSG:32632" }));
    let number = |domain: usize, pointer: &str| domains[domain].pointer(pointer).and_then(Value::as_f64).unwrap();
    assert_eq!((number(0, "/terrain/cells"), number(0, "/terrain/void_cells")), (3599.0, 1.0));
    assert!((number(0, "/area_km2") - 35.99).abs() < 1e-9);
    assert_eq!((number(1, "/terrain/cells"), number(2, "/terrain/cells")), (1800.0, 1799.0));
    assert_eq!(number(3, "/terrain/cells"), 316.0, "cells whose centres are within 10 cells of a corner");
    let peaks = [0, 1, 2].map(|domain| number(domain, "/peak_count"));
    assert!(peaks[0] > 8.0 && peaks[1] > 0.0 && peaks[2] > 0.0 && peaks[0] == peaks[1] + peaks[2], "{peaks:?}");
    check_table(&fs::read_to_string(at.join("s.csv")).unwrap(), domains);
    let svg = fs::read_to_string(at.join("s.svg")).unwrap();
    assert!(svg.starts_with("<svg") || svg.starts_with("<?xml"), "{}", &svg[..40]);
    for words in ["Key-saddle direction", ">dem<", ">west<", ">east, far<", ">500000,5100000,1km<"] {
        assert!(svg.contains(words), "{words}");
    }
    assert_eq!(fs::read(at.join("s.png")).unwrap()[1..4], *b"PNG");
    let (table, _) = done(at, &format!("stats dem.asc {CRS} -q"));
    assert!(
        table.starts_with(&format!("whole: {} peaks with a prominence of at least 30 m on 36", peaks[0])),
        "{table}"
    );
    assert_eq!(table.lines().count(), 2 + 11 + 2);
}

/// The counts of the table are those of the document, and shares make one.
fn check_table(table: &str, domains: &[Value]) {
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("domain,bin_set,metric,from,to,count,share"));
    let mut sums: Vec<(String, f64, f64)> = vec![];
    for line in lines {
        let cells: Vec<&str> = line.rsplitn(5, ',').collect();
        let (key, count, share) = (cells[4].to_string(), cells[1], cells[0]);
        if sums.last().is_none_or(|last| last.0 != key) {
            sums.push((key, 0.0, 0.0));
        }
        let last = sums.last_mut().unwrap();
        last.1 += count.parse::<f64>().unwrap();
        last.2 += share.parse::<f64>().unwrap();
    }
    let mut expected = vec![];
    for domain in domains {
        let name = domain["name"].as_str().unwrap();
        let name = if name.contains(',') { format!("\"{name}\"") } else { name.to_string() };
        for set in ["paper", "fine"] {
            for (metric, statistics) in domain["metrics"].as_object().unwrap() {
                if !statistics[set].is_null() {
                    let missing = statistics["missing"].as_f64().unwrap();
                    expected.push((format!("{name},{set},{metric}"), domain["peak_count"].as_f64().unwrap() - missing));
                }
            }
        }
        let cells = domain["terrain"]["cells"].as_f64().unwrap();
        expected.push((format!("{name},fine,hypsometry"), cells));
        expected
            .push((format!("{name},fine,slope"), cells - domain["terrain"]["slope_missing_cells"].as_f64().unwrap()));
    }
    assert_eq!(sums.len(), expected.len());
    for ((key, count, _), (expected_key, expected_count)) in sums.iter().zip(&expected) {
        assert_eq!((key, count), (expected_key, expected_count));
    }
    for (key, count, share) in sums {
        assert!((share - if count > 0.0 { 1.0 } else { 0.0 }).abs() < 1e-9, "{key}: {share}");
    }
}

#[test]
fn an_input_and_itself_are_no_distance_apart() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    terrain(at, "dem.asc", 0.0);
    done(at, &format!("stats dem.asc {CRS} -q -o s.json"));
    for output in ["p.gpkg", "p.csv --layers peaks", "p.geojson --layers peaks", "ft.gpkg --output-unit ft"] {
        done(at, &format!("peaks dem.asc {output} {CRS} -q"));
    }
    for other in ["dem.asc", "s.json", "p.gpkg", "p.csv", "p.geojson", "ft.gpkg"] {
        let (printed, said) = done(at, &format!("stats dem.asc {other} {CRS} --json --bins fine"));
        let document: Value = serde_json::from_str(&printed).unwrap();
        let comparison = &document["result"]["comparisons"][0];
        assert_eq!(comparison["domains"], json!(["whole", "whole"]));
        let metrics = comparison["metrics"].as_array().unwrap();
        let has_terrain = ["dem.asc", "s.json"].contains(&other);
        assert_eq!(metrics.len(), if has_terrain { 13 } else { 11 }, "{other}");
        for metric in metrics {
            for of in ["emd", "largest_bin_difference", "total_variation"] {
                assert!(metric[of].as_f64().unwrap() < 1e-12, "{other}: {metric}");
            }
        }
        let statistics = &document["result"]["statistics"][1];
        assert_eq!(statistics["domains"][0]["terrain"].is_null(), !has_terrain);
        assert_eq!(statistics["domains"][0]["area_km2"].is_null(), !has_terrain);
        let known = other.ends_with("gpkg") || has_terrain;
        assert_eq!(statistics["definitions"]["prominence_threshold_m"], if known { json!(30.0) } else { Value::Null });
        assert_eq!(said, "", "{other}");
    }
}

#[test]
fn two_inputs() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    terrain(at, "low.asc", 0.0);
    terrain(at, "high.asc", 250.0);
    let (table, _) = done(at, &format!("stats low.asc high.asc {CRS}"));
    assert!(table.starts_with("low.asc whole: ") && table.contains("\nhigh.asc whole: "), "{table}");
    assert_eq!(table.lines().count(), 3 + 10, "{table}");
    let regions = "--regions regions.geojson --region-field title";
    done(at, &format!("stats low.asc high.asc {CRS} {regions} -o d.csv -o d.svg --bins fine"));
    let distances = fs::read_to_string(at.join("d.csv")).unwrap();
    assert_eq!(distances.lines().count(), 1 + 3 * 13, "three pairs of domains: {distances}");
    let row = distances.lines().find(|line| line.starts_with("whole,whole,fine,elevation,")).unwrap();
    let emd: f64 = row.split(',').nth(4).unwrap().parse().unwrap();
    assert!((200.0..300.0).contains(&emd), "lifted by 250 m: {row}");
    assert!(distances.contains("\n\"east, far\",\"east, far\",fine,slope,"), "{distances}");
    assert!(fs::read_to_string(at.join("d.svg")).unwrap().contains("EMD"));
    let words = format!("stats low.asc high.asc {CRS} {regions} --json --domain west --domain whole -q");
    let document: Value = serde_json::from_str(&done(at, &words).0).unwrap();
    assert_eq!(document["result"]["comparisons"][0]["domains"], json!(["west", "whole"]));
    assert_eq!(document["result"]["comparisons"].as_array().unwrap().len(), 1);
    // What is compared with a file takes its radius from there, and a difference in the threshold is told.
    done(at, &format!("stats low.asc {CRS} --radius 5km --min-prominence 60 -o r.json -q"));
    let (printed, said) = done(at, &format!("stats high.asc r.json {CRS} --json"));
    let document: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(document["result"]["statistics"][0]["definitions"]["radius_m"], 5000.0);
    assert!(said.contains("30 m in the one and 60 m in the other"), "{said}");
}

#[test]
fn layers_know_their_regions_and_thresholds() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    terrain(at, "dem.asc", 0.0);
    let regions = "--regions regions.geojson --region-field title";
    done(at, &format!("peaks dem.asc p.gpkg {CRS} {regions} --min-prominence 40m -q"));
    let names = |words: &str| -> Vec<String> {
        let document: Value = serde_json::from_str(&done(at, words).0).unwrap();
        let domains = document["result"]["statistics"][0]["domains"].as_array().unwrap().clone();
        domains.iter().map(|d| format!("{} {}", d["name"].as_str().unwrap(), d["peak_count"])).collect()
    };
    let (tagged, asked) = (names("stats p.gpkg --json -q"), names(&format!("stats p.gpkg {regions} --json -q")));
    assert_eq!(tagged.len(), 3);
    assert_eq!([&tagged[0], &tagged[2], &tagged[1]], [&asked[0], &asked[1], &asked[2]], "by name, and by feature");
    let (_, said) = done(at, "stats p.gpkg --min-prominence 20m --disk 9,46.05,2km");
    assert!(said.contains("have a prominence of 40 m or more"), "{said}");
    let (high, _) = done(at, "stats p.gpkg --min-prominence 200m --json");
    let (from_dem, _) = done(at, &format!("stats dem.asc {CRS} --min-prominence 200m --json -q"));
    let domain =
        |text: &str| serde_json::from_str::<Value>(text).unwrap()["result"]["statistics"][0]["domains"][0].clone();
    assert_eq!(domain(&high)["metrics"], domain(&from_dem)["metrics"], "a higher threshold takes rows away, no more");
}

#[test]
fn the_same_bytes_whatever_the_threads() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    terrain(at, "dem.asc", 0.0);
    let run = |threads: u32| {
        let words = format!(
            "stats dem.asc {CRS} --regions regions.geojson --region-field title -q -j {threads} --overwrite -o s.json -o s.csv -o s.svg -o s.png"
        );
        done(at, &words);
        ["s.json", "s.csv", "s.svg", "s.png"].map(|name| fs::read(at.join(name)).unwrap())
    };
    let first = run(1);
    assert!(first == run(2) && first == run(1), "bytes differ");
}

#[test]
fn wrong_calls_and_inputs() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    terrain(at, "dem.asc", 0.0);
    done(at, &format!("stats dem.asc {CRS} -q -o s.json"));
    done(at, &format!("peaks dem.asc p.gpkg {CRS} -q --layers saddles"));
    done(at, &format!("peaks dem.asc p.csv {CRS} -q --layers peaks"));
    fs::write(at.join("broken.json"), r#"{"format": "orograph-stats", "version": 1}"#).unwrap();
    fs::write(at.join("other.json"), "{}").unwrap();
    fs::write(at.join("new.json"), r#"{"format": "orograph-stats", "version": 7}"#).unwrap();
    fs::write(at.join("text.tif"), "no raster").unwrap();
    let before = fs::read_dir(at).unwrap().count();
    for (words, code, message) in [
        ("stats", 2, "INPUT"),
        ("stats dem.asc dem.asc dem.asc", 2, "unexpected"),
        ("stats dem.asc -o s.txt", 2, "expected .json (statistics), .csv (table), .svg or .png (chart)"),
        ("stats dem.asc dem.asc -o d.json", 2, "d.json: a statistics file is of one input"),
        ("stats dem.asc -o a.csv -o a.csv", 2, "named twice"),
        ("stats dem.asc --disk 9,46", 2, "--disk: '9,46' is not a disk"),
        ("stats dem.asc --crs EPSG:4326 --disk 9,146,3km", 2, "latitude"),
        ("stats dem.asc --radius 0", 2, "--radius"),
        ("stats dem.asc --min-prominence -3", 2, "--min-prominence"),
        ("stats s.json --radius 10km", 2, "--radius: statistics files are taken as they are"),
        ("stats p.csv --disk 9,46,3km", 2, "assign it with --crs"),
        ("stats dem.asc -o c.svg --domain Jura", 2, "no domain is called 'Jura': whole"),
        ("stats dem.asc s.json --radius 10km", 2, "measure both with the same"),
        ("stats absent.tif", 3, "absent.tif: no such file"),
        ("stats absent.gpkg", 3, "absent.gpkg: no such file"),
        ("stats absent.json", 3, "absent.json: no such file"),
        ("stats text.tif", 3, "text.tif"),
        ("stats p.gpkg", 3, "there is no layer of peaks"),
        ("stats p.csv --layer towns", 3, "there is no layer 'towns': it has p"),
        ("stats broken.json", 3, "broken statistics"),
        ("stats other.json", 3, "not a statistics file"),
        ("stats new.json", 3, "version 7"),
        ("stats dem.asc --regions absent.gpkg", 3, "absent.gpkg"),
        ("stats dem.asc --memory 1M", 3, "--memory"),
        ("stats dem.asc -o s.json", 4, "s.json: the output exists already"),
        ("stats dem.asc -o c.svg -o absent/s.json", 4, "does not exist"),
    ] {
        let run = orograph(at, words);
        let said = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(code), "{words}: {said}");
        assert!(said.contains(message), "{words}: {said}");
        assert_eq!(fs::read_dir(at).unwrap().count(), before, "{words} left something behind");
    }
}
