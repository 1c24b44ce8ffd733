//! `orograph tin`: what its files hold, and what it refuses.

use super::mesh_files::{MeshFile, read_glb, read_obj, read_ply};
use super::{Run, fixture, folder, inside, listing};
use gdal::Dataset;
use gdal::vector::LayerAccess;
use orograph::io::features::{list_layers, metadata_item, read_layer};
use orograph::tin::{Mesh, scan};
use serde_json::Value;
use std::fs;

/// Runs it on a fixture and returns its result.
fn tin(input: &str, output: &str, options: &[&str]) -> Value {
    Run::done(&[&["tin", input, output, "--json"], options].concat()).json()["result"].clone()
}

fn read(path: &str) -> MeshFile {
    let bytes = fs::read(path).expect("the output");
    match path.rsplit_once('.') {
        Some((_, "obj")) => read_obj(&bytes),
        Some((_, "ply")) => read_ply(&bytes),
        _ => read_glb(&bytes),
    }
}

/// Elevations of a fixture's band as stored, its size, and the geotransform.
fn cells(path: &str) -> (Vec<f64>, (usize, usize), [f64; 6]) {
    orograph::io::messages::quiet();
    let dataset = Dataset::open(path).expect("the fixture opens");
    let (cols, rows) = dataset.raster_size();
    let band = dataset.rasterband(1).expect("a band");
    let void = band.no_data_value();
    let values = band.read_as::<f64>((0, 0), (cols, rows), (cols, rows), None).expect("cells");
    let values = values.data().iter().map(|&v| if Some(v) == void { f64::NAN } else { v }).collect();
    (values, (rows, cols), dataset.geo_transform().expect("a geotransform"))
}

/// The greatest distance of a cell from a mesh in coordinates of a raster with square cells whose rows run southwards;
/// cells that no triangle covers are infinitely far.
fn worst(mesh: &MeshFile, path: &str) -> f64 {
    let (z, (rows, cols), t) = cells(path);
    let place = |v: &[f64; 3]| [(v[0] - t[0]) / t[1] - 0.5, (v[1] - t[3]) / t[5] - 0.5, v[2]];
    let mut mesh = Mesh { vertices: mesh.vertices.iter().map(place).collect(), triangles: mesh.triangles.clone() };
    mesh.turn_over();
    let surface = scan(&mesh, rows, cols);
    let apart = z.iter().zip(&surface).filter(|(z, _)| !z.is_nan());
    apart.map(|(z, s)| if s.is_nan() { f64::INFINITY } else { (z - s).abs() }).fold(0.0, f64::max)
}

/// Writes the fixture that is most like terrain in a projection, as if its cells were squares of 90 m.
fn projected(dir: &tempfile::TempDir) -> String {
    let (z, (rows, cols), _) = cells(&fixture("jacksboro.tif"));
    let path = inside(dir, "projected.tif");
    let cells: Vec<i16> = z.iter().map(|&z| z as i16).collect();
    let transform = Some([500_000.0, 90.0, 0.0, 4_050_000.0, 0.0, -90.0]);
    super::rasters::Raster { transform, ..super::rasters::Raster::new((cols, rows), vec![cells]) }.write(&path);
    path
}

#[test]
fn no_cell_is_further_off() {
    let dir = folder();
    let dem = projected(&dir);
    let out = inside(&dir, "out.ply");
    for (options, bound_m) in
        [(&["--max-error", "10m"][..], 10.0), (&["--max-error", "100ft"], 30.48), (&["--regular"], 0.0)]
    {
        let result = tin(&dem, &out, &[options, &["--overwrite"]].concat());
        let mesh = read(&out);
        let found = worst(&mesh, &dem);
        assert!(found <= bound_m + 1e-6, "{options:?}: {found} m");
        assert!((result["error_m"].as_f64().expect("an error") - found).abs() < 1e-6, "{options:?}: {found} m");
        assert_eq!(result["vertices"], mesh.vertices.len());
        assert_eq!(result["triangles"], mesh.triangles.len());
        assert_eq!(result["cells_with_data"], 403 * 344);
    }
    let result = tin(&dem, &out, &["--max-vertices", "500", "--overwrite"]);
    assert_eq!(result["vertices"], 500);
    let (found, told) = (worst(&read(&out), &dem), result["error_m"].as_f64().expect("an error"));
    assert!((found - told).abs() < 1e-6 && told > 30.0, "{found} m, {told} m");
}

#[test]
fn formats_hold_one_mesh() {
    let dir = folder();
    let dem = projected(&dir);
    let out = |extension: &str| inside(&dir, &format!("out.{extension}"));
    let mut known: Option<MeshFile> = None;
    for (extension, within) in [("ply", 0.0), ("obj", 1e-8), ("glb", 0.002)] {
        let path = out(extension);
        let result = tin(&dem, &path, &["--max-error", "20m"]);
        let mut mesh = read(&path);
        let origin: Vec<f64> = result["origin"].as_array().expect("x, y, z").iter().filter_map(Value::as_f64).collect();
        for vertex in &mut mesh.vertices {
            (0..3).for_each(|i| vertex[i] += origin[i]);
        }
        let stated = format!("origin: {} {} {} (to be added to all coordinates)", origin[0], origin[1], origin[2]);
        match extension {
            "glb" => {
                let extras = &mesh.document["extras"];
                assert_eq!(extras["origin"], result["origin"]);
                assert_eq!((&extras["unit"], &extras["crs"]), (&"metre".into(), &"EPSG:32632".into()));
            }
            _ => assert!(mesh.remarks.contains(&stated), "{:?}", mesh.remarks),
        }
        assert_eq!(origin[0] == 0.0, extension == "ply", "PLY has coordinates as they are");
        let known = known.get_or_insert_with(|| MeshFile {
            vertices: mesh.vertices.clone(),
            triangles: mesh.triangles.clone(),
            ..MeshFile::default()
        });
        assert_eq!(known.triangles, mesh.triangles, "{extension}");
        let near = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).all(|i| (a[i] - b[i]).abs() <= within);
        assert!(known.vertices.iter().zip(&mesh.vertices).all(near), "{extension}");
    }
    let known = known.expect("a mesh");
    let upright = Mesh { vertices: known.vertices, triangles: known.triangles };
    assert_eq!(upright.check(), Ok(()), "counter-clockwise from above");
}

#[test]
fn a_layer_of_triangles() {
    let dir = folder();
    let out = inside(&dir, "out.gpkg");
    let dem = "fixtures/jacksboro.tif";
    let result = tin(dem, &out, &["--max-error", "40m"]);
    let layers: Vec<_> = list_layers(&out).expect("layers").into_iter().filter(|layer| layer.has_geometry).collect();
    assert_eq!(layers.len(), 1);
    assert_eq!((layers[0].name.as_str(), Some(layers[0].features)), ("triangles", result["triangles"].as_u64()));
    assert_eq!(layers[0].fields, ["elevation_m", "elevation_min_m", "elevation_max_m"]);
    let styles = read_layer(&out, Some("layer_styles"), &["f_table_name", "styleQML"], None).expect("styles").features;
    assert_eq!(styles[0].values[0].text(), Some("triangles"));
    assert!(styles[0].values[1].text().is_some_and(|qml| qml.contains("SimpleFill")));
    let command = metadata_item(&out, "OROGRAPH_COMMAND").expect("metadata");
    assert_eq!(command.as_deref(), Some("orograph tin fixtures/jacksboro.tif --max-error 40m"));
    let dataset = Dataset::open_ex(
        &out,
        gdal::DatasetOptions { open_flags: gdal::GdalOpenFlags::GDAL_OF_VECTOR, ..Default::default() },
    );
    let dataset = dataset.expect("the GeoPackage opens");
    let mut layer = dataset.layer_by_name("triangles").expect("the layer");
    let (_, (rows, cols), t) = cells(&fixture("jacksboro.tif"));
    let mut area = 0.0;
    for feature in layer.features() {
        let geometry = feature.geometry().expect("a geometry");
        assert_eq!(geometry.geometry_type(), gdal::vector::OGRwkbGeometryType::wkbPolygon25D);
        let mut ring = Vec::new();
        geometry.get_geometry(0).get_points(&mut ring);
        assert_eq!((ring.len(), ring[0]), (4, ring[3]), "a ring of three corners");
        let mean = (ring[0].2 + ring[1].2 + ring[2].2) / 3.0;
        let told = feature.field_as_double(0).expect("a field").expect("a value");
        assert!((told - mean).abs() < 1e-9, "{told} {mean}");
        area += geometry.area();
    }
    // Between the centres of the outermost cells.
    let wanted = ((rows - 1) * (cols - 1)) as f64 * t[1] * -t[5];
    assert!((area / wanted - 1.0).abs() < 1e-9, "{area}, not {wanted}");
}

#[test]
fn longitudes_and_latitudes_become_metres() {
    let dir = folder();
    let out = inside(&dir, "out.glb");
    let result = tin(&fixture("jacksboro.tif"), &out, &["--regular"]);
    assert!(result["plane"].as_str().is_some_and(|plane| plane.starts_with("+proj=stere +lat_0=36.5")), "{result}");
    let mesh = read(&out);
    let extent = |i: usize| {
        let all = || mesh.vertices.iter().map(|v| v[i]);
        all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min)
    };
    // 402 x 343 cells of 3 seconds: along the southern edge, and along a meridian.
    assert!((extent(0) - 30_033.0).abs() < 5.0, "{} m wide", extent(0));
    assert!((extent(1) - 31_730.0).abs() < 5.0, "{} m high", extent(1));
    let run = Run::new(&["tin", &fixture("globe.tif"), &inside(&dir, "globe.glb"), "--regular"]);
    run.expect(3, "more than 10 degrees from its middle");
    run.check(run.stderr().contains("gdalwarp"), "what to do");
    let run = Run::done(&["tin", &fixture("globe.tif"), &inside(&dir, "globe.gpkg"), "--regular"]);
    run.expect(0, "cut open");
}

#[test]
fn voids_feet_and_rotations() {
    let dir = folder();
    let out = inside(&dir, "out.ply");
    tin(&fixture("void.tif"), &out, &["--max-error", "1000km"]);
    let (z, (_, cols), t) = cells(&fixture("void.tif"));
    let place = |v: &[f64; 3]| ((v[1] - t[3]) / t[5] - 0.5) as usize * cols + ((v[0] - t[0]) / t[1] - 0.5) as usize;
    for vertex in read(&out).vertices {
        assert_eq!(z[place(&vertex)], vertex[2], "a vertex is a cell, and none is a void");
    }
    tin(&fixture("feet.tif"), &out, &["--regular", "--overwrite"]);
    let feet = cells(&fixture("feet.tif")).0;
    for (vertex, feet) in read(&out).vertices.iter().zip(feet) {
        assert!((vertex[2] - feet * 0.3048).abs() < 1e-9, "metres");
    }
    for name in ["rotated.tif", "south_up.tif", "no_crs.tif", "scaled.tif"] {
        tin(&fixture(name), &out, &["--regular", "--overwrite"]);
        let mesh = read(&out);
        let mesh = Mesh { vertices: mesh.vertices, triangles: mesh.triangles };
        assert_eq!(mesh.check(), Ok(()), "{name}: counter-clockwise from above");
    }
}

#[test]
fn ridges_are_edges() {
    let dir = folder();
    let (dem, ridges, out) = (fixture("jacksboro.tif"), inside(&dir, "peaks.gpkg"), inside(&dir, "out.gpkg"));
    Run::done(&["peaks", &dem, &ridges]);
    let without = tin(&dem, &out, &["--max-error", "50m"]);
    let with = tin(&dem, &out, &["--max-error", "50m", "--lines", &ridges, "--overwrite"]);
    assert_eq!(without["line_edges"], 0);
    assert!(with["line_edges"].as_u64() > Some(1000), "{with}");
    assert!(with["vertices"].as_u64() > without["vertices"].as_u64(), "{with}");
    // The summit of the highest peak and its key saddle are on the ridges.
    let peaks = read_layer(&ridges, Some("saddles"), &[], None).expect("saddles").features;
    let Some(geo::Geometry::Point(saddle)) = &peaks[0].geometry else { panic!("a point") };
    let triangles = read_layer(&out, None, &[], None).expect("triangles").features;
    let has_corner = |feature: &orograph::io::features::Feature| match &feature.geometry {
        Some(geo::Geometry::Polygon(polygon)) => polygon.exterior().0.contains(&saddle.0),
        _ => false,
    };
    assert!(triangles.iter().any(has_corner), "a saddle is a vertex");
    let run = Run::new(&[
        "tin",
        &dem,
        &out,
        "--max-error",
        "50m",
        "--lines",
        &ridges,
        "--line-layers",
        "peaks",
        "--overwrite",
    ]);
    run.expect(3, "there are no lines in its layers: peaks");
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let dir = folder();
    for extension in ["obj", "ply", "glb", "gpkg"] {
        let made = ["1", "2", "3"].map(|threads| {
            let out = inside(&dir, &format!("{threads}.{extension}"));
            Run::done(&["tin", "fixtures/jacksboro.tif", &out, "--max-error", "20m", "-j", threads]);
            fs::read(out).expect("the output")
        });
        assert!(made[0] == made[1] && made[0] == made[2], "{extension}");
    }
}

#[test]
fn wrong_calls() {
    let dir = folder();
    let dem = fixture("jacksboro.tif");
    fs::write(dir.path().join("there.glb"), "precious").expect("a file");
    let before = listing(dir.path());
    for (input, output, options, code, words) in [
        ("jacksboro.tif", "out.glb", &[][..], 2, "how exact is the mesh to be?"),
        ("jacksboro.tif", "out.stl", &["--regular"], 2, "expected .obj, .ply, .glb or .gpkg"),
        ("jacksboro.tif", "out", &["--regular"], 2, "expected .obj, .ply, .glb or .gpkg"),
        ("jacksboro.tif", "out.glb", &["--max-error", "-1m"], 2, "--max-error -1m: expected 0 or more"),
        ("jacksboro.tif", "out.glb", &["--max-error", "fine"], 2, "--max-error"),
        ("jacksboro.tif", "out.glb", &["--regular", "--max-error", "1m"], 2, "cannot be used with"),
        ("jacksboro.tif", "out.glb", &["--max-error", "1m", "--line-layers", "x"], 2, "--lines"),
        ("jacksboro.tif", "out.glb", &["--max-vertices", "3"], 2, "4 vertices are needed"),
        ("jacksboro.tif", "out.glb", &["--max-error", "1m", "--lines", "absent.gpkg"], 3, "absent.gpkg: no such file"),
        ("jacksboro.tif", "there.glb", &["--max-error", "1m"], 4, "replace it with --overwrite"),
        ("jacksboro.tif", "no/out.glb", &["--max-error", "1m"], 4, "does not exist"),
        ("jacksboro.tif", "out.glb", &["--max-error", "1m", "--memory", "1M"], 3, "of memory and may use 1 MiB"),
        ("jacksboro.tif", "out.glb", &["--max-error", "1m", "--memory", "99M"], 3, "that the memory has room for"),
        ("one_row.tif", "out.glb", &["--max-error", "1m"], 3, "nothing to triangulate"),
        ("one_cell.tif", "out.gpkg", &["--regular"], 3, "nothing to triangulate"),
        ("absent.tif", "out.glb", &["--regular"], 3, "absent.tif: no such file"),
    ] {
        let run = Run::new(&[&["tin", &fixture(input), &inside(&dir, output)], options].concat());
        run.expect(code, words);
        run.check(run.stdout().is_empty(), "nothing on standard output");
        run.check(listing(dir.path()) == before, "the folder as it was");
    }
    assert_eq!(fs::read(dir.path().join("there.glb")).expect("still there"), b"precious");
    Run::done(&["tin", &dem, &inside(&dir, "there.glb"), "--max-error", "50m", "--overwrite"]);
}
