//! `orograph scene`: what its outputs hold.

use super::rasters::{Raster, facts};
use super::{Run, fixture, folder, inside};
use gdal::Dataset;
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// Writes a scene and returns its path.
pub(super) fn scene(dir: &TempDir, name: &str, text: &str) -> String {
    let text = format!(r#"{{"format": "orograph-scene", "version": 1, {text}}}"#);
    fs::write(dir.path().join(name), text).expect("the scene is written");
    inside(dir, name)
}

/// Evaluates a scene and returns the result; the output is `out.tif` in the folder.
fn eval(dir: &TempDir, scene: &str, options: &[&str]) -> Value {
    let out = inside(dir, "out.tif");
    Run::done(&[&["scene", "eval", scene, &out, "--overwrite", "--json"], options].concat()).json()["result"].clone()
}

/// Cells of a file's band, NaN where there is no data.
fn cells(path: &str) -> Vec<f64> {
    orograph::io::messages::quiet();
    let dataset = Dataset::open(path).expect("it opens");
    let band = dataset.rasterband(1).expect("a band");
    let void = band.no_data_value();
    let size = dataset.raster_size();
    let values = band.read_as::<f64>((0, 0), size, size, None).expect("cells");
    values.data().iter().map(|&v| if Some(v) == void { f64::NAN } else { v }).collect()
}

/// The value of a file at a place.
fn at(path: &str, [x, y]: [f64; 2]) -> f64 {
    let dataset = Dataset::open(path).expect("it opens");
    let t = dataset.geo_transform().expect("a geotransform");
    let (col, row) = (((x - t[0]) / t[1]).floor() as usize, ((y - t[3]) / t[5]).floor() as usize);
    cells(path)[row * dataset.raster_size().0 + col]
}

/// 40 x 30 cells of 30 m in EPSG:32632, which rise by 1 m a cell eastwards and 2 m southwards; a void at (3, 4).
fn plane() -> Raster<f32> {
    let cells = (0..1200).map(|i| if i == 123 { -1.0 } else { (i % 40 + 2 * (i / 40)) as f32 }).collect();
    Raster { nodata: Some(-1.0), ..Raster::new((40, 30), vec![cells]) }
}

const PLANE: &str = r#""root": {"image": {"heights": "plane.tif"}}"#;

#[test]
fn what_is_not_edited_stays_as_it_was() {
    let dir = folder();
    plane().write(&inside(&dir, "plane.tif"));
    let path = scene(&dir, "plane.json", PLANE);
    let before = cells(&inside(&dir, "plane.tif"));
    for options in [&["--like", &inside(&dir, "plane.tif")][..], &["--bbox", "500000,5199100,501200,5200000"], &[]] {
        let result = eval(&dir, &path, options);
        assert_eq!((result["rows"].as_u64(), result["cols"].as_u64()), (Some(30), Some(40)), "{options:?}");
        let found = cells(&inside(&dir, "out.tif"));
        for (i, (a, b)) in found.iter().zip(&before).enumerate() {
            assert!(a == b || (a.is_nan() && b.is_nan()), "{options:?}, cell {i}: {a} {b}");
        }
        assert_eq!(result["cells_with_terrain"], 1199);
        assert_eq!(result["crs"], "EPSG:32632", "a scene without a CRS has that of its raster");
    }
    let facts = facts(&inside(&dir, "out.tif"));
    assert_eq!(facts.bands[0].kind, "Float32");
    assert_eq!((facts.bands[0].unit.as_str(), facts.bands[0].nodata), ("m", Some((-32768.0_f64).to_bits())));
    assert!(facts.crs.expect("a CRS").contains("32632"));
}

#[test]
fn bytes_depend_on_neither_threads_nor_memory() {
    let dir = folder();
    let path = fixture("scenes/valley.json");
    let cut = ["--resolution", "20m", "--bbox", "738000,4044000,752000,4052000"];
    eval(&dir, &path, &[&cut[..], &["-j", "1"]].concat());
    let known = fs::read(inside(&dir, "out.tif")).expect("the output");
    // Strips of a few rows.
    for options in [&["-j", "3"][..], &["--memory", "112M"]] {
        eval(&dir, &path, &[&cut[..], options].concat());
        assert_eq!(fs::read(inside(&dir, "out.tif")).expect("the output"), known, "{options:?}");
    }
}

#[test]
fn feet_become_metres_and_other_crs_the_scenes() {
    let dir = folder();
    let feet = fixture("feet.tif");
    let path =
        scene(&dir, "feet.json", &format!(r#""root": {{"image": {{"heights": "{}"}}}}"#, feet.replace('\\', "/")));
    eval(&dir, &path, &["--like", &feet]);
    for (found, stored) in cells(&inside(&dir, "out.tif")).iter().zip(cells(&feet)) {
        assert!((found - stored * 0.3048).abs() < 1e-3, "{found} m of {stored} ft");
    }

    // Longitudes and latitudes as heights: what comes out says where it is.
    let degrees: Vec<f64> = (0..60 * 60).map(|i| 46.9 - f64::from(i / 60) * 0.005).collect();
    let transform = Some([9.0, 0.005, 0.0, 46.9025, 0.0, -0.005]);
    Raster { transform, crs: Some("EPSG:4326"), ..Raster::new((60, 60), vec![degrees]) }
        .write(&inside(&dir, "lat.tif"));
    let image = r#""root": {"image": {"heights": "lat.tif", "interpolation": "bicubic"}}"#;
    let path = scene(&dir, "lat.json", &format!(r#""crs": "EPSG:32632", {image}"#));
    let run = Run::done(&["scene", "eval", &path, &inside(&dir, "lat_out.tif"), "--double"]);
    run.check(run.stderr().contains("resampled from EPSG:4326 to EPSG:32632"), "a word about resampling");
    // 46.75 degrees north near the central meridian, by PROJ's cs2cs.
    let found = at(&inside(&dir, "lat_out.tif"), [510_005.7, 5_177_391.5]);
    assert!((found - 46.75).abs() < 0.002, "{found}");
    // Without a CRS of its own a scene cannot be in degrees; the message names one that would do.
    let path = scene(&dir, "no_crs.json", image);
    Run::new(&["scene", "eval", &path, &inside(&dir, "x.tif")]).expect(3, "\"crs\": \"EPSG:32632\"");
}

#[test]
fn weights_may_lie_on_another_grid() {
    let dir = folder();
    plane().write(&inside(&dir, "plane.tif"));
    // The western half weighs 1, the eastern 0, in cells of 60 m.
    let share = (0..300).map(|i| u8::from(i % 20 < 10)).collect();
    let transform = Some([500_000.0, 60.0, 0.0, 5_200_000.0, 0.0, -60.0]);
    Raster { transform, ..Raster::new((20, 15), vec![share]) }.write(&inside(&dir, "share.tif"));
    let path = scene(&dir, "half.json", r#""root": {"image": {"heights": "plane.tif", "weights": "share.tif"}}"#);
    eval(&dir, &path, &["--like", &inside(&dir, "plane.tif")]);
    let found = cells(&inside(&dir, "out.tif"));
    let row = &found[15 * 40..16 * 40];
    assert!(row[2..19].iter().all(|v| !v.is_nan()) && row[21..].iter().all(|v| v.is_nan()), "{row:?}");
}

#[test]
fn only_what_is_cropped_is_read() {
    let dir = folder();
    plane().write(&inside(&dir, "plane.tif"));
    let crop = r#""root": {"image": {"heights": "plane.tif", "crop": [500300, 5199400, 500600, 5199700]}}"#;
    let path = scene(&dir, "crop.json", crop);
    let result = eval(&dir, &path, &["--like", &inside(&dir, "plane.tif")]);
    let defined = result["cells_with_terrain"].as_u64().expect("a count");
    assert!((100..=400).contains(&defined), "{defined}");
    let (found, before) = (cells(&inside(&dir, "out.tif")), cells(&inside(&dir, "plane.tif")));
    assert!(found.iter().zip(&before).all(|(a, b)| a.is_nan() || a == b));
    assert_eq!(found[15 * 40 + 15], before[15 * 40 + 15]);
}

#[test]
fn a_river_is_carved_as_its_fields_say_and_a_road_lies_level() {
    let dir = folder();
    let ground = scene(
        &dir,
        "ground.json",
        &format!(
            r#""crs": "EPSG:32616", "root": {{"image": {{"heights": "{}", "interpolation": "bicubic"}}}}"#,
            fixture("jacksboro.tif").replace('\\', "/")
        ),
    );
    let cut = ["--resolution", "10m", "--bbox", "735000,4043000,741000,4049000"];
    eval(&dir, &ground, &cut);
    let before = cells(&inside(&dir, "out.tif"));
    eval(&dir, &fixture("scenes/valley.json"), &cut);
    let after = cells(&inside(&dir, "out.tif"));
    let river = orograph::io::lines::read_lines(
        fixture("scenes/lines.gpkg").as_ref(),
        Some("rivers"),
        None,
        Some(&orograph::io::raster::parse_crs("EPSG:32616").expect("a CRS").wkt),
    )
    .expect("the rivers");
    let (mut beds, mut elsewhere) = (vec![], 0);
    for line in &river.lines {
        let depth = line.numbers.iter().find(|(name, _)| name == "depth_m").expect("a depth").1;
        for p in &line.points {
            let (col, row) = ((p[0] - 735_000.0) / 10.0, (4_049_000.0 - p[1]) / 10.0);
            if (0.0..600.0).contains(&col) && (0.0..600.0).contains(&row) {
                let i = row as usize * 600 + col as usize;
                beds.push((before[i] - after[i]) / depth);
            }
        }
    }
    assert!(beds.len() > 20, "{} points of rivers", beds.len());
    // Evened and never rising the bed is not exactly so deep below the ground everywhere.
    beds.sort_by(f64::total_cmp);
    let middle = beds[beds.len() / 2];
    assert!((0.7..1.8).contains(&middle) && beds[beds.len() / 10] > 0.3, "{beds:?}");
    for (a, b) in before.iter().zip(&after) {
        elsewhere += usize::from(a == b);
    }
    assert!(elsewhere > before.len() / 2, "{elsewhere} cells stay");
}

#[test]
fn layers_and_levels_of_detail() {
    let dir = folder();
    let path = fixture("scenes/valley.json");
    let cut = ["--resolution", "60m", "--bbox", "740000,4040000,760000,4060000"];
    let whole = eval(&dir, &path, &cut);
    let water = eval(&dir, &path, &[&cut[..], &["--layer", "water"]].concat());
    let count = |result: &Value| result["cells_with_terrain"].as_u64().expect("a count");
    assert!(count(&water) * 10 < count(&whole) && count(&water) > 100, "{water} {whole}");
    Run::new(&["scene", "eval", &path, &inside(&dir, "x.tif"), "--layer", "sand"]).expect(2, "it has road, water");

    let path = fixture("scenes/ranges.json");
    let rough = |options: &[&str]| {
        eval(&dir, &path, &[&["--resolution", "40m", "--bbox", "-2000,-2000,2000,2000"][..], options].concat());
        let z = cells(&inside(&dir, "out.tif"));
        z.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum::<f64>()
    };
    let (coarse, fine, all) = (rough(&["--detail", "0.1"]), rough(&["--detail", "0.5"]), rough(&["--detail", "1"]));
    assert!(coarse < fine && fine < all, "{coarse} {fine} {all}");
    assert_eq!(rough(&["--detail-around", "0,0,90000,99999"]), all);
}

#[test]
fn check_names_what_is_wrong_by_its_place() {
    let dir = folder();
    plane().write(&inside(&dir, "plane.tif"));
    let text = r#""nodes": {"spare": {"disc": {"radius_m": 10}}, "hill": {"disc": {"base_m": 900, "radius_m": 60}}},
        "root": {"replace": {"a": {"image": {"heights": "plane.tif"}}, "b": {"blend": [
            {"place": {"node": {"ref": "hill"}, "move_m": [500500, 5199500]}},
            {"place": {"node": {"ref": "hill"}, "move_m": [600000, 5199500]}}]}}}"#;
    let path = scene(&dir, "faults.json", text);
    let run = Run::new(&["scene", "check", &path, "--json"]);
    run.expect(1, "");
    let result = &run.json()["result"];
    let findings = result["findings"].as_array().expect("findings");
    let told = |remark: &str| -> Vec<&str> {
        let some = findings.iter().filter(|finding| finding["remark"] == remark);
        some.map(|finding| finding["place"].as_str().expect("a place")).collect()
    };
    assert_eq!(told("unused"), ["$.nodes.spare"]);
    assert_eq!(told("hidden"), ["$.root.replace.b.blend[1].place"]);
    assert_eq!((&result["primitives"], &result["kinds"]["place"]), (&2.into(), &2.into()));
    assert_eq!(result["crs"], "EPSG:32632");

    let endless = scene(&dir, "endless.json", r#""root": {"disc": {"base_m": 3}}"#);
    let run = Run::done(&["scene", "check", &endless]);
    run.check(run.stdout().contains("note: $.root.disc: endless"), "the endless node's place");
    run.check(run.stdout().contains("elevation: 3.00 to 3.00 m"), "its elevation");
    let nothing = scene(&dir, "nothing.json", r#""root": {"disc": {"radius_m": 5}}"#);
    let run = Run::new(&["scene", "check", &nothing, "--bbox", "100,100,200,200"]);
    run.expect(1, "");
    run.check(run.stdout().contains("fault: $.root: undefined"), "no terrain");
}

#[test]
fn a_mesh_is_no_further_from_the_scene_than_asked() {
    let dir = folder();
    let path = fixture("scenes/craters.json");
    let out = inside(&dir, "craters.ply");
    let options = ["--resolution", "30m", "--max-error", "2m", "--json"];
    let result = Run::done(&[&["scene", "mesh", &path, &out][..], &options].concat()).json()["result"].clone();
    let bytes = fs::read(&out).expect("the mesh");
    let mesh = super::mesh_files::read_ply(&bytes);
    assert_eq!(result["vertices"], mesh.vertices.len());
    let error_m = result["error_m"].as_f64().expect("an error");
    assert!(error_m <= 2.0 && mesh.vertices.len() < 20_000, "{error_m} m, {} vertices", mesh.vertices.len());
    // Vertices are points of the terrain.
    eval(&dir, &path, &["--resolution", "30m", "--double"]);
    let dataset = Dataset::open(inside(&dir, "out.tif")).expect("it opens");
    let (t, cols) = (dataset.geo_transform().expect("a geotransform"), dataset.raster_size().0);
    let z = cells(&inside(&dir, "out.tif"));
    for v in &mesh.vertices {
        let (col, row) = (((v[0] - t[0]) / t[1]) as usize, ((v[1] - t[3]) / t[5]) as usize);
        assert!((z[row * cols + col] - v[2]).abs() < 1e-6, "{v:?}");
    }
    let run = Run::new(&["scene", "mesh", &path, &inside(&dir, "x.glb")]);
    run.expect(2, "--max-error");
}

#[test]
fn a_sparse_file_is_a_node() {
    let dir = folder();
    let cells = super::rasters::terrain(96, 80).iter().map(|v| (v * 400.0) as f32).collect();
    Raster::new((96, 80), vec![cells]).write(&inside(&dir, "dem.tif"));
    let oro = inside(&dir, "sparse.oro");
    Run::done(&["encode", &inside(&dir, "dem.tif"), &oro, "--sparse", "--atoms", "32"]);
    Run::done(&["decode", &oro, &inside(&dir, "decoded.tif")]);
    let path = scene(&dir, "sparse.json", r#""root": {"sparse": {"terrain": "sparse.oro"}}"#);
    let result = eval(&dir, &path, &["--like", &inside(&dir, "dem.tif")]);
    let (found, decoded) = (self::cells(&inside(&dir, "out.tif")), self::cells(&inside(&dir, "decoded.tif")));
    // At the centres of its own cells the node is what a decoder makes, but for rounding.
    let apart = found.iter().zip(&decoded).filter(|(a, _)| !a.is_nan()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 0.05, "{apart} m");
    assert!(result["cells_with_terrain"].as_u64().expect("a count") > 96 * 80 * 9 / 10, "{result}");
    let finer = eval(&dir, &path, &["--resolution", "10m"]);
    assert_eq!(finer["cols"], 288);
    let as_image = scene(&dir, "no.json", r#""root": {"sparse": {"terrain": "dem.tif"}}"#);
    Run::new(&["scene", "check", &as_image]).expect(3, "$.root.sparse.terrain");
}

#[test]
fn a_picture_is_the_same_for_any_threads() {
    let dir = folder();
    let path = fixture("scenes/valley.json");
    let draw = |name: &str, options: &[&str]| {
        let out = inside(&dir, name);
        let result =
            Run::done(&[&["scene", "render", &path, &out, "--size", "160x90", "--json"], options].concat()).json();
        (fs::read(&out).expect("the picture"), result["result"].clone())
    };
    let (one, result) = draw("one.png", &["-j", "1"]);
    assert_eq!(draw("three.png", &["-j", "3"]).0, one);
    assert_eq!((&one[..8], &one[16..24]), (&b"\x89PNG\r\n\x1a\n"[..], &[0, 0, 0, 160, 0, 0, 0, 90][..]));
    assert_eq!((&result["rays"], &result["exhausted"]), (&(160 * 90).into(), &0.into()));
    // From above the ground, towards it; the water has a colour of its own.
    let view = ["--camera", "745000,4046000,+400", "--look-at", "750000,4052000,+0", "--sun", "120,30"];
    let (seen, _) = draw("seen.png", &view);
    let (red, _) = draw("red.png", &[&view[..], &["--colour", "water=ff0000"]].concat());
    assert!(seen != one && red != seen);
    assert_eq!(draw("same.png", &[&view[..], &["--colour", "water=4076A0"]].concat()).0, seen);
}
