//! `orograph classify`: what it learns, what it tells, what it refuses.

use super::{Csv, Run, fixture, folder, inside, listing};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// Peaks of a real range, and those of one that was made after it.
fn layers(dir: &TempDir) -> [String; 2] {
    let [real, made] = ["real.gpkg", "made.gpkg"].map(|name| inside(dir, name));
    Run::done(&["peaks", &fixture("jacksboro.tif"), &real]);
    Run::done(&["synthesize", &made, "--tree-only", "--like", &real]);
    [format!("real={real}"), format!("made={made}")]
}

/// Two squares, in the west and in the east of the range.
fn regions(dir: &TempDir) -> String {
    let path = inside(dir, "regions.geojson");
    let square = |name: &str, west: f64, east: f64| {
        format!(
            r#"{{"type":"Feature","properties":{{"name":"{name}"}},"geometry":{{"type":"Polygon","coordinates":
               [[[{west},36.4],[{east},36.4],[{east},36.8],[{west},36.8],[{west},36.4]]]}}}}"#
        )
    };
    let features = [square("west", -84.5, -84.25), square("east", -84.25, -84.0)].join(",");
    fs::write(&path, format!(r#"{{"type":"FeatureCollection","features":[{features}]}}"#)).expect("written");
    path
}

#[test]
fn a_made_range_and_its_model() {
    let dir = folder();
    let [real, made] = layers(&dir);
    let (model, disks) = (inside(&dir, "model.json"), inside(&dir, "disks.csv"));
    let train = |output: &str, more: &[&str]| {
        let call = ["classify", "train", output, "--peaks", &real, "--peaks", &made, "--disk-radius", "5km"];
        Run::done(&[&call[..], &["--trees", "40", "--json"], more].concat()).json()["result"].clone()
    };
    let result = train(&model, &["--disks", &disks]);
    assert_eq!((&result["classes"][0]["name"], &result["classes"][1]["name"]), (&"real".into(), &"made".into()));
    assert_eq!((&result["cuts"], &result["trees"]), (&8.into(), &40.into()));
    assert_eq!(result["conditions"]["min_prominence_m"], 30.0);
    // The one is made after the other, so this need not be good; out of bag, where neighbours were seen, it is.
    assert!(result["out_of_bag"]["accuracy"].as_f64().expect("a number") > 0.9, "{result}");
    let answers = result["held_out"]["answers"].as_u64().expect("a number");
    // What is told follows from the table.
    let confusion = &result["held_out"]["confusion"];
    let counts = |i: usize, j: usize| confusion[i][j].as_u64().expect("a count");
    assert_eq!(counts(0, 0) + counts(0, 1) + counts(1, 0) + counts(1, 1), answers);
    let right = (counts(0, 0) + counts(1, 1)) as f64 / answers as f64;
    assert_eq!(result["held_out"]["accuracy"].as_f64(), Some(right));
    let table = Csv::read(&disks);
    let of = |class: &str| table.rows.iter().filter(|row| row["class"] == class).count();
    assert_eq!(result["classes"][0]["disks"], of("real"));
    assert_eq!(table.header.len(), 5 + 8 + 176);
    let tested = (1..=8).map(|cut| table.rows.iter().filter(|row| row[&format!("cut_{cut}")] == "test").count());
    assert_eq!(tested.sum::<usize>() as u64, answers);

    // The same bytes for a seed, whatever the threads, and others for another.
    let again = inside(&dir, "again.json");
    for (more, is_same) in
        [(["-j1", "--seed", "0"], true), (["-j3", "--seed", "0"], true), (["-j2", "--seed", "1"], false)]
    {
        train(&again, &[&more[..], &["--overwrite"]].concat());
        let [a, b] = [&model, &again].map(|path| fs::read(path).expect("the model"));
        assert_eq!(a == b, is_same, "{more:?}");
    }

    let path = |named: &str| named.split_once('=').expect("a name").1.to_string();
    let ask = |more: &[&str]| {
        Run::done(&[&["classify", "predict", &model, "--json"], more].concat()).json()["result"]["answers"].clone()
    };
    for (named, class) in [(&real, "real"), (&made, "made")] {
        let answers = ask(&[&path(named)]);
        assert_eq!((&answers[0]["name"], &answers[0]["class"]), (&"whole".into(), &class.into()), "{answers}");
        let probabilities = answers[0]["probabilities"].as_object().expect("a map");
        let sum: f64 = probabilities.values().map(|value| value.as_f64().expect("a number")).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{answers}");
        assert_eq!(answers[0]["disks"], of(class), "the same disks as in training");
    }
    let places = ask(&[&path(&real), "--disk", "-84.25,36.6", "--disk", "0,0", "--regions", &regions(&dir)]);
    let names: Vec<&Value> = places.as_array().expect("answers").iter().map(|answer| &answer["name"]).collect();
    assert_eq!(names, ["-84.25,36.6", "0,0", "west", "east"]);
    assert_eq!((&places[0]["class"], &places[0]["disks"]), (&"real".into(), &1.into()));
    assert_eq!((&places[1]["class"], &places[1]["disks"]), (&Value::Null, &0.into()));
    assert_eq!((&places[2]["class"], &places[3]["class"]), (&"real".into(), &"real".into()));
    let run = Run::done(&["classify", "predict", &model, &path(&made)]);
    run.check(run.stdout().starts_with("whole  ") && run.stdout().contains("disks: made "), "a line for people");
}

#[test]
fn regions_are_classes() {
    let dir = folder();
    let peaks = inside(&dir, "peaks.csv");
    Run::done(&["peaks", &fixture("jacksboro.tif"), &peaks, "--regions", &regions(&dir)]);
    let peaks = inside(&dir, "peaks_peaks.csv");
    let train = |name: &str, more: &[&str]| {
        let output = inside(&dir, name);
        let call = ["classify", "train", &output, "--peaks", &peaks, "--disk-radius", "4km", "--min-peaks", "6"];
        let crs = ["--crs", "EPSG:4326", "--trees", "20", "--json"];
        Run::done(&[&call[..], &crs, more].concat()).json()["result"].clone()
    };
    // Those that the peaks have, and the same given anew.
    let own = train("own.json", &[]);
    let given = train("given.json", &["--regions", &regions(&dir)]);
    let names = |result: &Value| -> Vec<String> {
        let classes = result["classes"].as_array().expect("classes").iter();
        classes.map(|class| class["name"].as_str().expect("a name").to_string()).collect()
    };
    assert_eq!((names(&own), names(&given)), (vec!["east".into(), "west".into()], vec!["west".into(), "east".into()]));
    assert_eq!(own["classes"][0]["disks"], given["classes"][1]["disks"]);
}

#[test]
fn what_is_refused() {
    let dir = folder();
    let [real, made] = layers(&dir);
    let (model, out) = (inside(&dir, "model.json"), inside(&dir, "out.json"));
    let both = ["--peaks", &real, "--peaks", &made, "--disk-radius", "5km", "--trees", "3"];
    Run::done(&[&["classify", "train", &model], &both[..]].concat());
    let before = listing(dir.path());
    let refused = |words: &[&str], code: i32, said: &str| {
        let run = Run::new(&[&["classify"], words].concat());
        run.expect(code, said);
        run.check(listing(dir.path()) == before, "nothing left behind");
    };
    let train = |more: &[&str], code: i32, said: &str| refused(&[&["train", &out], more].concat(), code, said);
    train(&[], 2, "--peaks");
    train(&["--peaks", &real], 2, "only 'real'");
    train(&["--peaks", &real, "--peaks", real.trim_start_matches("real=")], 3, "stand in no regions");
    train(&["--peaks", &real, "--peaks", "x=absent.gpkg"], 3, "absent.gpkg");
    train(&["--peaks", &real, "--peaks", &format!("x={}", fixture("cone.tif"))], 3, "no layer of peaks");
    train(&["--peaks", &real, "--peaks", &made, "--disk-radius", "1m"], 3, "the class 'real' has no disk");
    train(&["--peaks", &real, "--peaks", &made, "--disk-radius", "0m"], 2, "--disk-radius");
    train(&["--peaks", &real, "--peaks", &made, "--disk-radius", "x"], 2, "--disk-radius");
    train(&["--peaks", &real, "--peaks", &made, "--trees", "0"], 2, "--trees 0");
    train(&["--peaks", &real, "--peaks", "=x"], 2, "expected NAME=FILE");
    train(&["--peaks", &real, "--peaks", &made, "--regions", "x.gpkg"], 2, "--peaks without a name");
    train(&["--peaks", &real, "--peaks", &made, "--disks", "x.tif"], 2, "x.tif: this output is a .csv file");
    refused(&[&["train", &model], &both[..]].concat(), 4, "model.json");
    let predict = |model: &str, more: &[&str], code: i32, said: &str| {
        refused(&[&["predict", model, real.trim_start_matches("real=")], more].concat(), code, said);
    };
    predict(&model, &["--disk", "1"], 2, "--disk 1: expected two numbers");
    predict(&model, &["--disk", "1,nan"], 2, "--disk 1,nan");
    predict(&model, &["--disk", "1,95"], 2, "latitude is 95");
    predict(&out, &[], 3, "out.json: no such file");
    refused(&["predict", &model, &fixture("cone.tif")], 3, "no layer of peaks");
}

#[test]
fn damaged_models() {
    let dir = folder();
    let [real, made] = layers(&dir);
    let model = inside(&dir, "model.json");
    let peaks = real.trim_start_matches("real=").to_string();
    Run::done(&[
        "classify",
        "train",
        &model,
        "--peaks",
        &real,
        "--peaks",
        &made,
        "--disk-radius",
        "5km",
        "--trees",
        "2",
    ]);
    let text = fs::read_to_string(&model).expect("the model");
    let good: Value = serde_json::from_str(&text).expect("JSON");
    let with = |pointer: &str, value: Value| {
        let mut damaged = good.clone();
        *damaged.pointer_mut(pointer).expect("it is there") = value;
        damaged.to_string()
    };
    for (text, said) in [
        (with("/version", 2.into()), "a classifier of version 2: this program reads version 1"),
        (with("/format", "orograph-stats".into()), "not a classifier"),
        (text[..text.len() / 2].to_string(), "not a classifier"),
        (String::new(), "not a classifier"),
        (with("/features/0/bins", 21.into()), "not those that this program measures"),
        (with("/classes", serde_json::json!([good["classes"][0]])), "1 classes: expected at least 2"),
        (with("/classes/1/name", "real".into()), "two classes are called 'real'"),
        (with("/conditions/disk_radius_m", (-1.0).into()), "the radius is -1"),
        (with("/conditions/min_prominence_m", (-1.0).into()), "the least prominence is -1"),
        (with("/forest", Value::Array(vec![])), "there is no tree"),
        (with("/forest/1/0/right", 0.into()), "tree 1, node "),
        (with("/forest/0/0/feature", 176.into()), "tree 0, node 0: it asks for feature 176"),
        (with("/forest/0/0/threshold", Value::Null), "broken classifier"),
    ] {
        fs::write(&model, text).expect("written");
        Run::new(&["classify", "predict", &model, &peaks]).expect(3, said);
    }
}
