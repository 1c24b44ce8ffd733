//! What `orograph info` says of containers.

use super::rasters::{Raster, terrain};
use super::schema::validate;
use super::{Run, fixture, folder, inside, listing, root};
use orograph::oro::{Reader, SectionType};
use serde_json::Value;
use std::fs;

#[test]
fn what_a_container_says() {
    let dir = folder();
    let oro = inside(&dir, "a.oro");
    Run::done(&["encode", &fixture("jacksboro.tif"), &oro, "--tile-size", "64"]);
    let document = Run::done(&["info", &oro, "--json"]).json();
    assert_eq!((&document["verb"], &document["inputs"][0]), (&"info".into(), &oro.as_str().into()));
    let result = &document["result"];
    let bytes = fs::metadata(&oro).expect("the file").len();
    assert_eq!(result["bytes"], bytes);
    assert_eq!((&result["cols"], &result["rows"]), (&403.into(), &344.into()));
    assert_eq!(result["tiles"], serde_json::json!({ "across": 7, "down": 6 }));
    assert_eq!(result["bits_per_cell"], bytes as f64 * 8.0 / (403.0 * 344.0));
    assert_eq!(result["levels"][2]["cols"], 101);
    assert_eq!(result["crs"]["authority"], "EPSG:4326");
    assert_eq!((&result["bands"][0]["lossless"], &result["bands"][0]["unit"]), (&true.into(), &"m".into()));
    let reader = Reader::open(fs::read(&oro).expect("bytes")).expect("a container");
    let sections: Vec<&str> = reader.sections().iter().map(|section| section.section.name()).collect();
    let told: Vec<&str> =
        result["sections"].as_array().expect("sections").iter().map(|s| s["name"].as_str().expect("a name")).collect();
    assert_eq!(told, sections);
    assert!(reader.sections().iter().any(|section| section.section == SectionType::Overview));
    let text = Run::done(&["info", &oro]).stdout();
    for words in ["7 x 6 of 64 x 64 cells", "band: Int16, lossless", "crs: EPSG:4326", "section: META"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    Run::new(&["info", &oro, "--band", "1"]).expect(2, "--band: an .oro file is shown as a whole");
}

/// Holds what is said of a container against the specification's schema.
fn assert_described(oro: &str) -> Value {
    let document = Run::done(&["info", oro, "--json"]).json();
    let schema: Value =
        serde_json::from_str(include_str!("../../format-spec/info.schema.json")).expect("the schema is JSON");
    validate(&document, &schema, &schema, oro);
    document
}

#[test]
fn documents_fit_the_schema() {
    // The conformance vectors have a bit of everything.
    let vectors = root().join("format-spec/vectors/accept");
    let names: Vec<String> = listing(&vectors).into_iter().filter(|name| name.ends_with(".oro")).collect();
    assert!(names.len() > 50, "{} vectors", names.len());
    for name in names {
        assert_described(&vectors.join(name).display().to_string());
    }

    let dir = folder();
    let oro = inside(&dir, "a.oro");
    for (name, options) in [
        ("jacksboro.tif", &["--tile-size", "64", "--max-error", "5m"][..]),
        ("scaled.tif", &["--lossless"]),
        ("rotated.tif", &["--lossless"]),
        ("no_crs.tif", &["--lossless"]),
        ("nan.tif", &["--max-error", "0.5"]),
    ] {
        Run::done(&[&["encode", &fixture(name), &oro, "--overwrite"], options].concat());
        assert_described(&oro);
    }
    // Numbers for which JSON has no words.
    let (before, cells) = (inside(&dir, "before.tif"), terrain(30, 20));
    for nodata in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let band = cells.iter().map(|&cell| cell as f32).collect();
        Raster { nodata: Some(nodata), ..Raster::new((30, 20), vec![band]) }.write(&before);
        Run::done(&["encode", &before, &oro, "--overwrite", "--lossless"]);
        let said = assert_described(&oro)["result"]["bands"][0]["nodata"].clone();
        assert_eq!(said, nodata.to_string().to_lowercase());
    }
}
