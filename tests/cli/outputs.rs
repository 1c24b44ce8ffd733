//! What the outputs hold.

use super::{Csv, Run, fixture, folder, inside, listing, root};
use gdal::vector::LayerAccess;
use gdal::vector::sql::Dialect;
use gdal::{Dataset, DatasetOptions, GdalOpenFlags};
use orograph::io::features::{list_layers, metadata_item, read_layer};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;

const LAYERS: [(&str, &[&str]); 4] = [
    (
        "peaks",
        &[
            "id",
            "name",
            "region",
            "row",
            "col",
            "elevation_m",
            "prominence_m",
            "prominence_min_m",
            "prominence_certain",
            "is_root",
            "key_saddle",
            "key_saddle_elevation_m",
            "saddle_distance_m",
            "saddle_azimuth",
            "island_parent",
            "prominence_parent",
            "line_parent",
            "isolation_m",
            "isolation_min_m",
            "isolation_certain",
            "isolation_azimuth",
            "higher_row",
            "higher_col",
            "dominance",
            "relative_prominence",
            "relative_elevation",
            "relevance",
            "x",
            "y",
            "lon",
            "lat",
        ],
    ),
    ("saddles", &["id", "row", "col", "elevation_m"]),
    ("divide_tree", &["peak_a", "peak_b", "saddle", "saddle_elevation_m", "length_m", "prominence_m"]),
    ("isolation", &["peak", "isolation_m"]),
];

/// The peaks of a fixture, through a CSV file.
fn peaks(name: &str, options: &[&str]) -> Csv {
    let dir = folder();
    let out = inside(&dir, "out.csv");
    Run::done(&[&["peaks", &fixture(name), &out, "--layers", "peaks"], options].concat());
    assert_eq!(listing(dir.path()), ["out.csv"], "one layer is one file under the name given");
    Csv::read(&out)
}

#[test]
fn a_geopackage_is_the_same_to_the_byte() {
    let dir = folder();
    let dem = fixture("jacksboro.tif");
    let made = [("a.gpkg", "-j1"), ("b.gpkg", "-j2"), ("c.gpkg", "-j1"), ("d.gpkg", "-j3")].map(|(name, threads)| {
        let out = inside(&dir, name);
        Run::done(&["peaks", &dem, &out, threads]);
        fs::read(out).expect("the output")
    });
    for other in &made[1..] {
        assert!(*other == made[0], "the bytes differ");
    }
}

#[test]
fn a_geopackage_holds_layers_styles_and_metadata() {
    let dir = folder();
    let out = inside(&dir, "out.gpkg");
    let run = Run::done(&["peaks", "fixtures/jacksboro.tif", &out, "--json"]);
    let result = run.json()["result"].clone();
    let layers: Vec<_> = list_layers(&out).expect("layers").into_iter().filter(|layer| layer.has_geometry).collect();
    assert_eq!(layers.len(), LAYERS.len(), "{layers:?}");
    for (layer, (name, fields)) in layers.iter().zip(LAYERS) {
        assert_eq!(layer.name, name);
        assert_eq!(layer.fields, fields, "{name}");
    }
    let count = |name: &str| layers.iter().find(|layer| layer.name == name).map(|layer| layer.features);
    assert_eq!(count("peaks"), result["peaks"].as_u64());
    assert_eq!(count("divide_tree"), result["edges"].as_u64());
    assert_eq!(count("saddles"), Some(183), "every peak but the root ends at one");
    let styles = read_layer(&out, Some("layer_styles"), &["f_table_name", "useAsDefault", "styleQML"], None);
    let styles = styles.expect("styles").features;
    let styled: BTreeSet<&str> = styles.iter().filter_map(|style| style.values[0].text()).collect();
    assert_eq!(styled, LAYERS.map(|(name, _)| name).into());
    assert_eq!(styles.len(), LAYERS.len());
    for style in &styles {
        assert_eq!(style.values[1].number(), Some(1.0), "a default");
        assert!(style.values[2].text().is_some_and(|qml| qml.contains("<renderer-v2")), "{style:?}");
    }
    for (key, words) in [
        ("OROGRAPH_COMMAND", "orograph peaks fixtures/jacksboro.tif --min-prominence 30m"),
        ("OROGRAPH_VERSION", env!("CARGO_PKG_VERSION")),
        ("OROGRAPH_INPUT", "fixtures/jacksboro.tif"),
    ] {
        assert_eq!(metadata_item(&out, key).expect("metadata").as_deref(), Some(words), "{key}");
    }
}

#[test]
fn spatial_indexes_are_sound() {
    let dir = folder();
    let out = inside(&dir, "out.gpkg");
    Run::done(&["peaks", &fixture("jacksboro.tif"), &out, "--min-prominence", "0"]);
    let options = DatasetOptions {
        open_flags: GdalOpenFlags::GDAL_OF_READONLY | GdalOpenFlags::GDAL_OF_VECTOR,
        ..DatasetOptions::default()
    };
    let dataset = Dataset::open_ex(&out, options).expect("the GeoPackage opens");
    let asked = |query: &str| {
        let answer = dataset.execute_sql(query, None, Dialect::DEFAULT).ok().flatten();
        let mut answer = answer.unwrap_or_else(|| panic!("{query}: no answer"));
        let row = answer.features().next().unwrap_or_else(|| panic!("{query}: no row"));
        row.field_as_string(0).expect("a field").unwrap_or_default()
    };
    assert_eq!(asked("PRAGMA integrity_check"), "ok");
    for (name, _) in LAYERS {
        assert_eq!(asked(&format!("SELECT rtreecheck('rtree_{name}_geom')")), "ok", "{name}");
        let indexed = asked(&format!("SELECT count(*) FROM rtree_{name}_geom"));
        assert_eq!(indexed, asked(&format!("SELECT count(*) FROM {name}")), "{name}");
        // Each feature is in its box.
        let outside = format!(
            "SELECT count(*) FROM {name} t JOIN rtree_{name}_geom i ON i.id = t.fid WHERE ST_MinX(geom) < i.minx OR \
             ST_MaxX(geom) > i.maxx OR ST_MinY(geom) < i.miny OR ST_MaxY(geom) > i.maxy"
        );
        assert_eq!(asked(&outside), "0", "{name}");
    }
}

#[test]
fn a_file_a_layer() {
    let dir = folder();
    let dem = fixture("jacksboro.tif");
    let rows = |name: &str| Csv::read(inside(&dir, &format!("out_{name}.csv"))).rows.len();
    for extension in ["csv", "geojson", "fgb"] {
        let run = Run::done(&["peaks", &dem, &inside(&dir, &format!("out.{extension}")), "--json"]);
        for (i, (name, fields)) in LAYERS.into_iter().enumerate() {
            let file = inside(&dir, &format!("out_{name}.{extension}"));
            assert_eq!(run.json()["outputs"][i], file.as_str());
            if extension == "csv" {
                let mut header = Csv::read(&file).header;
                header.retain(|field| field != "wkt");
                assert_eq!(header, fields, "{name}");
                continue;
            }
            let layer = read_layer(&file, None, fields, None).expect("the layer");
            assert_eq!((layer.features.len(), layer.unplaced), (rows(name), 0), "{file}");
            assert!(layer.features.iter().all(|feature| feature.geometry.is_some()), "{file}");
        }
    }
    assert_eq!(listing(dir.path()).len(), 12);
    for extension in ["geojson", "fgb"] {
        let out = inside(&dir, &format!("one.{extension}"));
        Run::done(&["peaks", &dem, &out, "--layers", "saddles"]);
        let layer = read_layer(&out, None, &["id"], None).expect("the layer");
        assert_eq!(layer.features.len(), rows("saddles"));
    }
    assert_eq!(peaks("jacksboro.tif", &[]).header, LAYERS[0].1);
}

#[test]
fn feet() {
    let (metres, feet) = (peaks("jacksboro.tif", &[]), peaks("jacksboro.tif", &["--output-unit", "ft"]));
    assert_eq!(metres.rows.len(), feet.rows.len());
    let renamed = |field: &String| field.strip_suffix("_m").map_or(field.clone(), |stem| format!("{stem}_ft"));
    assert_eq!(metres.header.iter().map(renamed).collect::<Vec<_>>(), feet.header);
    for (m, ft) in metres.rows.iter().zip(&feet.rows) {
        for field in &metres.header {
            let (m, ft) = (&m[field], &ft[&renamed(field)]);
            if !field.ends_with("_m") || m.is_empty() {
                assert_eq!(m, ft, "{field}");
                continue;
            }
            let (m, ft): (f64, f64) = (m.parse().expect("a number"), ft.parse().expect("a number"));
            // Both are rounded to three decimals.
            assert!((m / 0.3048 - ft).abs() < 0.0005 * (1.0 + 1.0 / 0.3048) + 1e-9, "{field}: {m} m, {ft} ft");
        }
    }
}

#[test]
fn filters_only_take_rows_away() {
    let all = peaks("jacksboro.tif", &[]);
    let places = |csv: &Csv| -> BTreeSet<String> {
        csv.columns(&["row", "col", "elevation_m"]).iter().map(|cells| cells.join(" ")).collect()
    };
    let known: BTreeMap<(&str, &str), _> =
        all.rows.iter().map(|row| ((row["row"].as_str(), row["col"].as_str()), row)).collect();
    for options in
        [&["--min-isolation", "3km"][..], &["--certain-only"], &["--base-level", "400m"], &["--min-prominence", "100m"]]
    {
        let some = peaks("jacksboro.tif", options);
        assert!(places(&some).is_subset(&places(&all)), "{options:?}");
        assert!(!some.rows.is_empty() && some.rows.len() < all.rows.len(), "{options:?}: {}", some.rows.len());
        for row in &some.rows {
            let whole = known[&(row["row"].as_str(), row["col"].as_str())];
            let number = |text: &str| text.parse::<f64>().ok();
            let more = options[0] == "--base-level";
            let fields = if more { &["isolation_m"][..] } else { &["prominence_m", "isolation_m", "prominence_min_m"] };
            for &field in fields {
                assert_eq!(row[field], whole[field], "{options:?}: {field}");
            }
            match options[0] {
                "--min-isolation" => assert!(number(&row["isolation_m"]).is_none_or(|m| m >= 3000.0), "{row:?}"),
                "--certain-only" => {
                    assert_eq!((&*row["prominence_certain"], &*row["isolation_certain"]), ("true", "true"));
                }
                "--base-level" => assert!(number(&row["prominence_m"]) <= number(&whole["prominence_m"]), "{row:?}"),
                _ => assert!(number(&row["prominence_m"]) >= Some(100.0), "{row:?}"),
            }
        }
    }
}

/// Equal, numbers to the decimals that are written.
fn same(got: &str, want: &Value) -> bool {
    match want {
        Value::Null => got.is_empty(),
        Value::Number(want) => {
            let want = want.as_f64().expect("a float");
            got.parse::<f64>().is_ok_and(|got| (got - want).abs() <= 6e-4 + 1e-9 * want.abs())
        }
        Value::Bool(want) => got == if *want { "true" } else { "false" },
        other => panic!("{other} is no field of a table"),
    }
}

#[test]
fn answers_by_hand() {
    let text = fs::read_to_string(root().join("fixtures/ANSWERS.json")).expect("the answers");
    let answers: Value = serde_json::from_str(&text).expect("JSON");
    let fixtures = answers["fixtures"].as_object().expect("fixtures by name");
    for file in listing(&root().join("fixtures")) {
        if let Some(name) = file.strip_suffix(".tif").filter(|&name| name != "jacksboro") {
            assert!(fixtures.contains_key(name), "{name} has no answer");
        }
    }
    for (name, want) in fixtures {
        let dir = folder();
        Run::done(&["peaks", &fixture(&format!("{name}.tif")), &inside(&dir, "out.csv"), "--min-prominence", "1"]);
        let layer = |layer: &str| Csv::read(inside(&dir, &format!("out_{layer}.csv")));
        let (peaks, saddles, tree) = (layer("peaks"), layer("saddles"), layer("divide_tree"));
        let wanted = want["peaks"].as_array().expect("peaks");
        assert_eq!(peaks.rows.len(), wanted.len(), "{name}");
        for (row, want) in peaks.rows.iter().zip(wanted) {
            let cell_of = |row: &BTreeMap<String, String>, fields: [&str; 2]| fields.map(|field| row[field].clone());
            for (field, value) in want.as_object().expect("fields by name") {
                let cell = match field.as_str() {
                    "key_saddle" => {
                        let saddle = saddles.rows.iter().find(|saddle| saddle["id"] == row["id"]);
                        assert_eq!(row[field].is_empty(), saddle.is_none(), "{name}: a saddle for each that is named");
                        Some(saddle.map(|saddle| cell_of(saddle, ["row", "col"])))
                    }
                    "higher" => {
                        Some((!row["higher_row"].is_empty()).then(|| cell_of(row, ["higher_row", "higher_col"])))
                    }
                    _ => None,
                };
                match cell {
                    Some(cell) => {
                        let want = value.as_array().map(|pair| pair.iter().map(ToString::to_string).collect());
                        assert_eq!(cell.map(Vec::from), want, "{name}, peak {}: {field}", row["id"]);
                    }

                    None => {
                        assert!(
                            same(&row[field], value),
                            "{name}, peak {}: {field} {}, not {value}",
                            row["id"],
                            row[field]
                        );
                    }
                }
            }
        }
        let edges = want["divide_tree"].as_array().expect("edges");
        assert_eq!(tree.rows.len(), edges.len(), "{name}");
        for (row, want) in tree.rows.iter().zip(edges) {
            for field in ["peak_a", "peak_b", "saddle"] {
                assert!(same(&row[field], &want[field]), "{name}: {field} {}, not {}", row[field], want[field]);
            }
        }
    }
}

#[test]
fn a_geopackage_without_a_crs_has_none() {
    let dir = folder();
    let out = inside(&dir, "out.gpkg");
    Run::done(&["peaks", &fixture("no_crs.tif"), &out]);
    // The format has a word for this, which is not to be taken for longitudes and latitudes.
    let result = Run::done(&["stats", &out, "--disk", "500000,5200000,100km", "--json"]).json()["result"].clone();
    let statistics = &result["statistics"][0];
    assert_eq!(statistics["input"]["crs"], Value::Null);
    assert_eq!(statistics["domains"][1]["disk"]["geographic"], false);
}
