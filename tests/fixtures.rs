//! The reference on the fixtures whose answers were worked out by hand.
//!
//! The files are read here with plain GDAL calls: what `io` makes of them is for its own tests to say.

#![cfg(feature = "program")]

mod reference;

use gdal::Dataset;
use orograph::crs::{Ellipsoid, Geodesic, Metric, Planar};
use orograph::grid::{Cell, Elevations, GeoTransform, Grid, Key, SampleType};
use orograph::units::LengthUnit;
use reference::{Answer, Frame, Options, RefPeak};
use serde_json::Value;
use std::path::PathBuf;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures")
}

/// A fixture as far as the reference needs it; keys are 32-bit, which holds 16-bit integers and floats.
struct Fixture {
    grid: Grid<i32>,
    elevations: Elevations,
    transform: GeoTransform,
    degrees: bool,
}

fn open(name: &str) -> Fixture {
    let dataset = Dataset::open(folder().join(format!("{name}.tif"))).expect("the fixture opens");
    let band = dataset.rasterband(1).expect("a band");
    let (cols, rows) = dataset.raster_size();
    let float = name == "nan";
    let elevations = Elevations {
        sample_type: if float { SampleType::F32 } else { SampleType::I16 },
        scale: band.scale().unwrap_or(1.0),
        offset: band.offset().unwrap_or(0.0),
        unit: LengthUnit::from_name(&band.unit()).unwrap_or_else(LengthUnit::metre),
    };
    let values = band.read_as::<f32>((0, 0), (cols, rows), (cols, rows), None).expect("cells");
    let nodata = band.no_data_value();
    let mut keys: Vec<i32> = values
        .data()
        .iter()
        .map(|&v| match v {
            v if v.is_nan() || Some(f64::from(v)) == nodata => i32::VOID,
            v if float => i32::from_i64(elevations.key_of(v)),
            v => v as i32,
        })
        .collect();
    let mut transform = GeoTransform(dataset.geo_transform().expect("a geotransform"));
    if transform.0[5] > 0.0 && transform.is_axis_parallel() {
        keys = keys.chunks(cols).rev().flatten().copied().collect();
        transform = transform.flipped_rows(rows);
    }
    let degrees = dataset.spatial_ref().is_ok_and(|srs| srs.is_geographic());
    Fixture { grid: Grid::new(rows, cols, degrees, keys), elevations, transform, degrees }
}

fn by_reference(fixture: &Fixture) -> Answer {
    let (rows, cols) = (fixture.grid.rows(), fixture.grid.cols());
    let metric: Box<dyn Metric> = if fixture.degrees {
        let made = Geodesic::new(&Ellipsoid::WGS84, &fixture.transform, 1.0, rows, cols, true);
        Box::new(made.expect("a globe"))
    } else {
        Box::new(Planar::new(&fixture.transform, 1.0))
    };
    let frame = Frame { metric: &*metric, before: (9, 9), size: (rows + 18, cols + 18) };
    let options = Options { min_prominence_m: 1.0, frame: (!fixture.degrees).then_some(frame), ..Options::default() };
    reference::survey(&fixture.grid, &fixture.elevations, &*metric, &options)
}

/// A row of a peak under the names of the output's columns.
fn row(fixture: &Fixture, peak: &RefPeak) -> Value {
    let place = |cell: Cell| fixture.grid.place(cell);
    let cell = |cell: Option<Cell>| cell.map(|c| vec![place(c).0, place(c).1]);
    let (row, col) = place(peak.cell);
    let (x, y) = fixture.transform.centre(row as f64, col as f64);
    let isolation = peak.isolation.as_ref().expect("isolation was asked for");
    serde_json::json!({
        "id": peak.id, "row": row, "col": col, "x": x, "y": y, "lon": x, "lat": y,
        "elevation_m": peak.elevation_m,
        "prominence_m": peak.prominence_m,
        "prominence_min_m": peak.prominence_min_m,
        "prominence_certain": peak.prominence_certain,
        "is_root": peak.is_root,
        "key_saddle": cell(peak.key_saddle),
        "key_saddle_elevation_m": peak.key_saddle_elevation_m,
        "saddle_distance_m": peak.saddle_distance_m,
        "saddle_azimuth": peak.saddle_azimuth,
        "island_parent": peak.island_parent,
        "line_parent": peak.line_parent,
        "prominence_parent": peak.prominence_parent,
        "isolation_m": isolation.isolation_m,
        "isolation_min_m": isolation.isolation_min_m,
        "isolation_certain": isolation.certain,
        "higher": cell(isolation.higher),
        "isolation_azimuth": isolation.azimuth,
    })
}

/// Equal, numbers to 1e-9 of their size.
fn same(got: &Value, want: &Value) -> bool {
    match (got.as_f64(), want.as_f64()) {
        (Some(g), Some(w)) => (g - w).abs() <= 1e-9 * w.abs().max(1.0),
        _ => got == want,
    }
}

#[test]
fn answers_by_hand() {
    let text = std::fs::read_to_string(folder().join("ANSWERS.json")).expect("the answers");
    let answers: Value = serde_json::from_str(&text).expect("JSON");
    for (name, want) in answers["fixtures"].as_object().expect("fixtures by name") {
        let fixture = open(name);
        let got = by_reference(&fixture);
        let peaks = want["peaks"].as_array().expect("peaks");
        assert_eq!(got.peaks.len(), peaks.len(), "{name}: {:#?}", got.peaks);
        for (peak, want) in got.peaks.iter().zip(peaks) {
            let row = row(&fixture, peak);
            for (field, value) in want.as_object().expect("fields by name") {
                assert!(same(&row[field], value), "{name}, peak {}: {field} is {}, not {value}", peak.id, row[field]);
            }
        }
        let edges = want["divide_tree"].as_array().expect("edges");
        assert_eq!(got.edges.len(), edges.len(), "{name}");
        for (edge, want) in got.edges.iter().zip(edges) {
            let path: Vec<_> = edge.path.iter().map(|&c| [fixture.grid.place(c).0, fixture.grid.place(c).1]).collect();
            let got = serde_json::json!({
                "peak_a": edge.peak_a, "peak_b": edge.peak_b, "saddle": edge.saddle, "path": path
            });
            for (field, value) in want.as_object().expect("fields by name") {
                assert_eq!(&got[field], value, "{name}: {field} of the edge over saddle {}", edge.saddle);
            }
        }
    }
}
