//! `orograph amplify`: what its files hold, and what it refuses.

use super::rasters::{Raster, facts, terrain};
use super::{Run, fixture, folder, inside, listing};
use gdal::Metadata;
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// Writes terrain of 30 m cells in metres, and returns its elevations.
fn dem(
    dir: &TempDir,
    name: &str,
    (cols, rows): (usize, usize),
    change: impl Fn(&mut Raster<f32>),
) -> (String, Vec<f32>) {
    let cells: Vec<f32> = terrain(cols, rows).into_iter().map(|v| (v * 2000.0) as f32).collect();
    let mut raster = Raster::new((cols, rows), vec![cells]);
    change(&mut raster);
    let path = inside(dir, name);
    raster.write(&path);
    (path, raster.bands.swap_remove(0))
}

/// Terrain with a void that tiles cut through and many small ones, as `input.tif`.
fn riddled(dir: &TempDir) -> (String, Vec<f32>) {
    dem(dir, "input.tif", (300, 520), |raster| {
        raster.nodata = Some(-1.0);
        let cells = &mut raster.bands[0];
        (0..cells.len())
            .filter(|i| (i % 300).abs_diff(130) < 25 && (i / 300).abs_diff(250) < 30)
            .for_each(|i| cells[i] = -1.0);
        (0..40).for_each(|i| cells[i * 3677 + 99] = -1.0);
    })
}

/// With an exemplar, or with what was learned from one.
fn amplify(input: &str, output: &str, exemplar: &str, options: &[&str]) -> Value {
    let from = if exemplar.ends_with(".learned") { "--learned" } else { "--exemplar" };
    Run::done(&[&["amplify", input, output, from, exemplar, "--json"], options].concat()).json()
}

/// What is learned from terrain of 200 x 200 cells, once for all runs of a test, and the exemplar itself.
fn taught(dir: &TempDir, mode: &str) -> (String, String) {
    let (exemplar, _) = dem(dir, "exemplar.tif", (200, 200), |_| {});
    let kept = inside(dir, &format!("{mode}.learned"));
    Run::done(&["learn", "--multires", &exemplar, &kept, "--mode", mode, "--cell", "7.5m", "--factor", "4"]);
    (kept, exemplar)
}

/// Elevations of a raster of single precision.
fn cells(path: &str) -> ((usize, usize), Vec<f32>) {
    let found = facts(path);
    assert_eq!(found.bands[0].kind, "Float32");
    (found.size, found.bands[0].bits.iter().map(|&bits| f32::from_bits(bits as u32)).collect())
}

/// The greatest difference between a cell that is not `void` and the mean of its fine cells.
fn deviation(coarse: &[f32], cols: usize, fine: &[f32], factor: usize, void: Option<f32>) -> f64 {
    let mut most: f64 = 0.0;
    for (cell, &height) in coarse.iter().enumerate() {
        let (row, col) = (cell / cols * factor, cell % cols * factor);
        let own = (0..factor * factor).map(|i| fine[(row + i / factor) * cols * factor + col + i % factor]);
        match void == Some(height) {
            true => assert!(own.clone().all(|fine| fine == height), "a void stays one"),
            false => {
                assert!(own.clone().all(|fine| Some(fine) != void), "no other cell becomes one");
                let mean = own.map(f64::from).sum::<f64>() / (factor * factor) as f64;
                most = most.max((mean - f64::from(height)).abs());
            }
        }
    }
    most
}

#[test]
fn grids_are_aligned_and_means_kept() {
    let dir = folder();
    let (exemplar, _) = dem(&dir, "exemplar.tif", (130, 120), |_| {});
    let (large, _) = dem(&dir, "large.tif", (240, 200), |_| {});
    let (input, coarse) = dem(&dir, "input.tif", (50, 41), |raster| {
        raster.more = |dataset| {
            dataset.rasterband(1).expect("a band").set_description("ground").expect("a description");
        };
    });
    for factor in [2, 3, 4, 8] {
        let out = inside(&dir, &format!("x{factor}.tif"));
        let number = factor.to_string();
        let exemplar = if factor == 8 { &large } else { &exemplar };
        let document = amplify(&input, &out, exemplar, &["--factor", &number]);
        let (size, fine) = cells(&out);
        assert_eq!(size, (50 * factor, 41 * factor));
        let found = deviation(&coarse, 50, &fine, factor, None);
        let told = document["result"]["deviation_m"].as_f64().expect("a length");
        assert!(found <= 0.01 && (found - told).abs() < 1e-6, "factor {factor}: {found} m, {told} m");
        assert_eq!(document["result"]["cells_with_data"], 50 * 41 * factor * factor);
        let (before, after) = (facts(&input), facts(&out));
        let step = 30.0 / factor as f64;
        let known = [500_000.0, step, 0.0, 5_200_000.0, 0.0, -step].map(f64::to_bits);
        assert_eq!(after.transform, Some(known));
        assert_eq!((after.crs, &after.bands[0].description), (before.crs, &before.bands[0].description));
    }
}

/// Other threads and less memory mean other tiles and strips.
#[test]
fn bytes_depend_on_neither_threads_nor_memory() {
    let dir = folder();
    let (learned, exemplar) = taught(&dir, "accurate");
    let (input, coarse) = dem(&dir, "input.tif", (300, 520), |raster| {
        raster.nodata = Some(-1.0);
        let cells = &mut raster.bands[0];
        // A void that tiles cut through, one at the edge, and single cells.
        (0..cells.len())
            .filter(|i| (i % 300).abs_diff(130) < 25 && (i / 300).abs_diff(250) < 30)
            .for_each(|i| cells[i] = -1.0);
        (0..6).for_each(|i| cells[i] = -1.0);
        (0..40).for_each(|i| cells[i * 3677 + 99] = -1.0);
    });
    let mut known: Option<Vec<u8>> = None;
    for options in [["-j", "1", "--memory", "4G"], ["-j", "3", "--memory", "4G"], ["-j", "1", "--memory", "180M"]] {
        let out = inside(&dir, "out.tif");
        amplify(&input, &out, &learned, &[&options[..], &["--overwrite"]].concat());
        let bytes = fs::read(&out).expect("the output");
        assert!(known.get_or_insert_with(|| bytes.clone()) == &bytes, "{options:?}");
    }
    let (size, fine) = cells(&inside(&dir, "out.tif"));
    assert_eq!(size, (1200, 2080));
    let found = deviation(&coarse, 300, &fine, 4, Some(-1.0));
    assert!(found <= 0.01, "{found} m");
    // A container holds the same cells.
    let (packed, out) = (inside(&dir, "out.oro"), inside(&dir, "again.tif"));
    amplify(&input, &packed, &learned, &[]);
    Run::done(&["decode", &packed, &out]);
    assert!(cells(&out).1 == fine, "the same cells");
    Run::done(&["verify", &packed]);
    // And can be the input and the exemplar.
    let (stored, from_stored) = (inside(&dir, "input.oro"), inside(&dir, "stored.tif"));
    Run::done(&["encode", &input, &stored, "--lossless"]);
    amplify(&stored, &from_stored, &exemplar, &["--factor", "4"]);
    assert!(cells(&from_stored).1 == fine, "the same cells");
}

/// Terrain is drawn for cells, not for tiles.
#[test]
fn realistic_terrain_depends_on_the_seed_alone() {
    let dir = folder();
    let (learned, _) = taught(&dir, "realistic");
    let (input, coarse) = riddled(&dir);
    let realistic = |name: &str, options: &[&str]| {
        let out = inside(&dir, name);
        let document = amplify(&input, &out, &learned, &[&["--overwrite"], options].concat());
        (out, document)
    };
    let mut known: Option<Vec<u8>> = None;
    for options in [["-j", "1", "--memory", "4G"], ["-j", "3", "--memory", "4G"], ["-j", "1", "--memory", "220M"]] {
        let (out, document) = realistic("out.tif", &[&options[..], &["--seed", "8"]].concat());
        assert_eq!(document["result"]["seeds"], serde_json::json!([8]));
        let bytes = fs::read(&out).expect("the output");
        assert!(known.get_or_insert_with(|| bytes.clone()) == &bytes, "{options:?}");
    }
    // Several at once are those that each seed gives on its own.
    let (_, document) = realistic("several.tif", &["--seed", "7", "--count", "3"]);
    assert_eq!(document["result"]["seeds"], serde_json::json!([7, 8, 9]));
    let paths = [1, 2, 3].map(|number| inside(&dir, &format!("several-{number}.tif")));
    assert_eq!(document["outputs"], serde_json::json!(paths));
    let [first, second, third] = paths.each_ref().map(|path| cells(path).1);
    assert!(fs::read(&paths[1]).expect("the output") == known.expect("made"), "the second seed is 8");
    for other in [&first, &third] {
        let equal = second.iter().zip(other).filter(|(a, b)| a == b && **a != -1.0).count();
        assert!(equal < second.len() / 100, "{equal} cells are the same");
    }
    for fine in [&first, &second, &third] {
        let found = deviation(&coarse, 300, fine, 4, Some(-1.0));
        assert!(found <= 0.01, "{found} m");
    }
}

#[test]
fn realistic_terrain_of_all_sizes() {
    let dir = folder();
    let (learned, _) = taught(&dir, "realistic");
    for size in [(1, 1), (1, 7), (9, 1), (2, 3)] {
        let name = format!("{}x{}.tif", size.0, size.1);
        let (input, coarse) = dem(&dir, &name, size, |_| {});
        let out = inside(&dir, &format!("fine-{name}"));
        amplify(&input, &out, &learned, &[]);
        let found = deviation(&coarse, size.0, &cells(&out).1, 4, None);
        assert!(found <= 0.01, "{name}: {found} m");
    }
    let (flat, _) = dem(&dir, "flat.tif", (30, 20), |raster| raster.bands[0].fill(12.5));
    let out = inside(&dir, "fine-flat.tif");
    amplify(&flat, &out, &learned, &[]);
    assert!(cells(&out).1.iter().all(|&height| height == 12.5), "flat land stays flat");
}

/// Other threads and less memory mean other tiles and strips.
#[test]
fn the_papers_way_depends_on_neither_threads_nor_memory() {
    let dir = folder();
    let (exemplar, _) = dem(&dir, "exemplar.tif", (200, 200), |_| {});
    let (input, coarse) = riddled(&dir);
    let paper = |name: &str, options: &[&str]| {
        let out = inside(&dir, name);
        let document = amplify(&input, &out, &exemplar, &[&["--mode", "paper", "--overwrite"], options].concat());
        (out, document["result"]["atoms"].clone())
    };
    for (patches, atoms) in [
        (&[][..], 169 * 169),
        (&["--patch", "12", "--step", "7", "--atoms", "20", "--seed", "3", "--unsigned"], 20),
        (&["--patch", "5", "--patches", "4000", "--sparsity", "2"], 61 * 61),
    ] {
        let mut known: Option<Vec<u8>> = None;
        for options in [["-j", "1", "--memory", "4G"], ["-j", "3", "--memory", "4G"], ["-j", "1", "--memory", "140M"]] {
            let (out, found) = paper("out.tif", &[&options[..], patches].concat());
            assert_eq!(found, serde_json::json!([atoms]));
            let bytes = fs::read(&out).expect("the output");
            assert!(known.get_or_insert_with(|| bytes.clone()) == &bytes, "{options:?}");
        }
        let (size, fine) = cells(&inside(&dir, "out.tif"));
        assert_eq!(size, (1200, 2080));
        // Voids stay, no other cell becomes one, and heights are about the input's.
        let found = deviation(&coarse, 300, &fine, 4, Some(-1.0));
        let most = coarse.iter().fold(0.0f32, |most, &height| most.max(height));
        assert!(found > 0.01 && found < f64::from(most) / 4.0, "{found} m of {most}");
    }
    let (_, atoms) = paper("steps.tif", &["--by", "2", "--patch", "4"]);
    assert_eq!(atoms, serde_json::json!([93 * 93, 193 * 193]));
}

#[test]
fn the_papers_way_with_all_sizes() {
    let dir = folder();
    let (exemplar, _) = dem(&dir, "exemplar.tif", (200, 200), |_| {});
    for (size, factor) in [((1, 1), 11), ((1, 7), 4), ((9, 1), 2), ((2, 3), 64)] {
        let name = format!("{}x{}.tif", size.0, size.1);
        let (input, coarse) = dem(&dir, &name, size, |_| {});
        let out = inside(&dir, &format!("fine-{name}"));
        let number = factor.to_string();
        amplify(&input, &out, &exemplar, &["--mode", "paper", "--factor", &number, "--patch", "3"]);
        let (found, fine) = cells(&out);
        assert_eq!(found, (size.0 * factor, size.1 * factor));
        let least = coarse.iter().fold(f32::MAX, |least, &height| least.min(height));
        assert!(fine.iter().all(|&height| (height - least).abs() < 4000.0), "{name}");
    }
    let (flat, _) = dem(&dir, "flat.tif", (30, 20), |raster| raster.bands[0].fill(12.5));
    let out = inside(&dir, "fine-flat.tif");
    amplify(&flat, &out, &exemplar, &["--mode", "paper"]);
    assert!(cells(&out).1.iter().all(|&height| height == 12.5), "flat land stays flat");
}

#[test]
fn parts_feet_and_narrow_rasters() {
    let dir = folder();
    let (learned, exemplar) = taught(&dir, "accurate");
    for size in [(1, 1), (1, 7), (9, 1), (2, 3)] {
        let name = format!("{}x{}.tif", size.0, size.1);
        let (input, coarse) = dem(&dir, &name, size, |_| {});
        let out = inside(&dir, &format!("fine-{name}"));
        amplify(&input, &out, &learned, &[]);
        let found = deviation(&coarse, size.0, &cells(&out).1, 4, None);
        assert!(found <= 0.01, "{name}: {found} m");
    }
    let (flat, _) = dem(&dir, "flat.tif", (30, 20), |raster| raster.bands[0].fill(12.5));
    let out = inside(&dir, "fine-flat.tif");
    amplify(&flat, &out, &learned, &[]);
    assert!(cells(&out).1.iter().all(|&height| height == 12.5), "flat land stays flat");
    // Values keep their unit; a part lies where it lay.
    let out = inside(&dir, "feet.tif");
    let feet = fixture("feet.tif");
    amplify(&feet, &out, &fixture("jacksboro.tif"), &["--factor", "2"]);
    assert_eq!(facts(&out).bands[0].unit, facts(&feet).bands[0].unit);
    let (input, coarse) = dem(&dir, "input.tif", (40, 30), |_| {});
    let out = inside(&dir, "part.tif");
    amplify(&input, &out, &exemplar, &["--factor", "2", "--window", "5,6,7,8"]);
    let (size, fine) = cells(&out);
    let part: Vec<f32> = (0..56).map(|i| coarse[(6 + i / 7) * 40 + 5 + i % 7]).collect();
    assert_eq!(size, (14, 16));
    assert!(deviation(&part, 7, &fine, 2, None) <= 0.01);
    let transform = facts(&out).transform.expect("a place").map(f64::from_bits);
    assert_eq!(transform, [500_150.0, 15.0, 0.0, 5_199_820.0, 0.0, -15.0]);
}

/// At 60 degrees north cells of equal degrees are half as wide as high: exemplars get such cells.
#[test]
fn longitudes_in_the_north() {
    let dir = folder();
    let (exemplar, _) = dem(&dir, "exemplar.tif", (200, 200), |_| {});
    let step = 1.0 / 900.0;
    let (input, coarse) = dem(&dir, "input.tif", (60, 50), |raster| {
        raster.crs = Some("EPSG:4326");
        raster.transform = Some([10.0, step, 0.0, 60.0, 0.0, -step]);
    });
    for mode in ["accurate", "realistic", "paper"] {
        let out = inside(&dir, &format!("{mode}.tif"));
        let document = amplify(&input, &out, &exemplar, &["--factor", "4", "--mode", mode]);
        let cell = &document["result"]["cell_m"];
        let [across, down] = ["across", "down"].map(|side| cell[side].as_f64().expect("a length"));
        assert!((across - 15.5).abs() < 0.1 && (down - 30.95).abs() < 0.1, "{mode}: {cell}");
        let (size, fine) = cells(&out);
        assert_eq!(size, (240, 200));
        let transform = facts(&out).transform.expect("a place").map(f64::from_bits);
        assert_eq!(transform, [10.0, step / 4.0, 0.0, 60.0, 0.0, -step / 4.0]);
        let found = deviation(&coarse, 60, &fine, 4, None);
        assert!(found <= if mode == "paper" { 250.0 } else { 0.01 }, "{mode}: {found} m");
        let warnings = document["warnings"].to_string();
        assert!(warnings.contains("cells of 30.00 m are larger than those of 15."), "{mode}: {warnings}");
        if mode == "paper" {
            // Cells of 30 m become such cells, with rows as columns, too: patches of both.
            let places = |side_m: f64| 200.0 * 30.0 / side_m - 31.0;
            let wanted = 2.0 * places(down) * places(across);
            let atoms = document["result"]["atoms"][0].as_f64().expect("a number");
            assert!((atoms / wanted - 1.0).abs() < 0.02, "{atoms} for {wanted}");
        }
    }
    // An exemplar with just the cells that are made is not said to have larger ones.
    let (alike, _) = dem(&dir, "alike.tif", (200, 200), |raster| {
        raster.crs = Some("EPSG:4326");
        raster.transform = Some([10.0, 1.0 / 3600.0, 0.0, 60.0, 0.0, -1.0 / 3600.0]);
    });
    let document = amplify(&input, &inside(&dir, "alike-out.tif"), &alike, &["--mode", "paper"]);
    assert!(!document["warnings"].to_string().contains("are larger"), "{}", document["warnings"]);
}

/// The sea is a void: it stays as it is to the cell, nothing else becomes it, and land at the coast is as high as before.
#[test]
fn coasts_stay() {
    let dir = folder();
    let (exemplar, _) = dem(&dir, "exemplar.tif", (200, 200), |_| {});
    let island = |raster: &mut Raster<f32>| {
        raster.nodata = Some(-9999.0);
        let cells = &mut raster.bands[0];
        // Bays and headlands, a lone rock, and a strait as wide as a cell.
        let is_sea = |i: usize| {
            let (x, y) = ((i % 90) as f64 - 45.0, (i / 90) as f64 - 40.0);
            let shore = 30.0 + 6.0 * (x / 4.0).sin() + 5.0 * (y / 3.0).cos();
            (x * x + y * y > shore * shore && i != 3 * 90 + 4) || i % 90 == 50
        };
        (0..cells.len()).for_each(|i| cells[i] = if is_sea(i) { -9999.0 } else { cells[i] - 600.0 });
    };
    let (input, coarse) = dem(&dir, "input.tif", (90, 80), island);
    let land = coarse.iter().filter(|&&height| height != -9999.0);
    let (least, most) = land.clone().fold((f32::MAX, f32::MIN), |(a, b), &v| (a.min(v), b.max(v)));
    for mode in ["accurate", "realistic", "paper"] {
        for factor in ["3", "4"] {
            let out = inside(&dir, &format!("{mode}-{factor}.tif"));
            let document = amplify(&input, &out, &exemplar, &["--factor", factor, "--mode", mode]);
            let factor: usize = factor.parse().expect("a number");
            let (_, fine) = cells(&out);
            assert_eq!(document["result"]["cells_with_data"], land.clone().count() * factor * factor);
            // `deviation` compares voids cell by cell.
            let found = deviation(&coarse, 90, &fine, factor, Some(-9999.0));
            assert!(found <= if mode == "paper" { 250.0 } else { 0.01 }, "{mode} {factor}: {found} m");
            // No cell is drawn down to the sea's value.
            let room = (most - least) / 2.0;
            let near = |height: f32| height == -9999.0 || (least - room..most + room).contains(&height);
            assert!(fine.iter().all(|&height| near(height)), "{mode} {factor}");
        }
    }
}

/// What cannot teach, in each mode: smaller than a patch, level, or all voids; beside one that can, it does no harm.
#[test]
fn exemplars_that_teach_nothing() {
    let dir = folder();
    let (exemplar, _) = dem(&dir, "exemplar.tif", (150, 150), |_| {});
    let (input, coarse) = dem(&dir, "input.tif", (40, 30), |_| {});
    let (small, _) = dem(&dir, "small.tif", (5, 4), |_| {});
    let (flat, _) = dem(&dir, "flat.tif", (150, 150), |raster| raster.bands[0].fill(3.0));
    let (holed, _) = dem(&dir, "holed.tif", (150, 150), |raster| {
        raster.nodata = Some(-1.0);
        // No patch and no neighbourhood is free of voids.
        (0..150 * 150).filter(|i| i % 150 % 4 == 0 || i / 150 % 4 == 0).for_each(|i| raster.bands[0][i] = -1.0);
    });
    for mode in ["accurate", "realistic", "paper"] {
        for (poor, words) in [(&small, "small.tif: "), (&flat, "flat.tif: "), (&holed, "holed.tif: ")] {
            let out = inside(&dir, "out.tif");
            let words = match mode {
                "paper" if poor == &small => format!("{words}the exemplars are smaller than a patch: 5 x 4 cells"),
                _ => format!("{words}the exemplars teach nothing"),
            };
            let before = listing(dir.path());
            let run = Run::new(&["amplify", &input, &out, "--exemplar", poor, "--mode", mode]);
            run.expect(3, &words);
            run.check(listing(dir.path()) == before, "the folder as it was");
        }
        let out = inside(&dir, &format!("{mode}.tif"));
        amplify(&input, &out, &exemplar, &["--exemplar", &small, &flat, &holed, "--mode", mode]);
        let found = deviation(&coarse, 40, &cells(&out).1, 4, None);
        assert!(found <= if mode == "paper" { 250.0 } else { 0.01 }, "{mode}: {found} m");
    }
}

#[test]
fn other_kinds_of_terrain_are_told() {
    let dir = folder();
    let (exemplar, _) =
        dem(&dir, "exemplar.tif", (200, 200), |raster| raster.bands[0].iter_mut().for_each(|v| *v /= 50.0));
    let (input, _) = dem(&dir, "input.tif", (60, 60), |_| {});
    let document = amplify(&input, &inside(&dir, "out.tif"), &exemplar, &[]);
    assert!(document["warnings"].to_string().contains("of another kind"), "{}", document["warnings"]);
}

#[test]
fn refusals() {
    let dir = folder();
    let (exemplar, _) = dem(&dir, "exemplar.tif", (200, 200), |_| {});
    let (input, _) = dem(&dir, "input.tif", (40, 40), |_| {});
    let (small, _) = dem(&dir, "small.tif", (20, 20), |_| {});
    let (flat, _) = dem(&dir, "flat.tif", (200, 200), |raster| raster.bands[0].fill(3.0));
    let (voids, _) = dem(&dir, "voids.tif", (40, 40), |raster| {
        raster.bands[0].fill(3.0);
        raster.nodata = Some(3.0);
    });
    let (infinite, _) = dem(&dir, "infinite.tif", (40, 40), |raster| raster.bands[0][85] = f32::INFINITY);
    let two = inside(&dir, "two.tif");
    Raster::new((30, 30), vec![vec![1.0f32; 900], vec![2.0; 900]]).write(&two);
    let out = inside(&dir, "out.tif");
    let before = listing(dir.path());
    for (input, exemplar, options, code, words) in [
        (&input, &small, &[][..], 3, "small.tif: the exemplars teach nothing"),
        (&input, &flat, &[], 3, "flat.tif: the exemplars teach nothing"),
        (&input, &voids, &[], 3, "voids.tif: all 1600 cells are nodata"),
        (&input, &inside(&dir, "absent.tif"), &[], 3, "absent.tif: no such file"),
        (&inside(&dir, "absent.tif"), &exemplar, &[], 3, "absent.tif: no such file"),
        (&voids, &exemplar, &[], 3, "voids.tif: all 1600 cells are nodata"),
        (&infinite, &exemplar, &[], 3, "infinite.tif: row 2, column 5: an infinite elevation"),
        (&two, &exemplar, &[], 2, "two.tif: 2 bands, and one is made finer"),
        (&input, &exemplar, &["--factor", "11"], 2, "--factor 11: expected 2 to 256"),
        (&input, &exemplar, &["--factor", "1"], 2, "--factor 1: expected 2 to 256"),
        (&input, &exemplar, &["--vertical-unit", "parsecs"], 2, "parsecs"),
        (&input, &exemplar, &["--mode", "fast"], 2, "accurate"),
        (&input, &flat, &["--mode", "realistic"], 3, "flat.tif: the exemplars teach nothing"),
        (&input, &exemplar, &["--count", "2"], 2, "several terrains need --mode realistic"),
        (&input, &exemplar, &["--mode", "realistic", "--count", "0"], 2, "--count 0: expected 1 to 100"),
        (&input, &small, &["--mode", "paper"], 3, "small.tif: the exemplars are smaller than a patch: 20 x 20 cells"),
        (&input, &flat, &["--mode", "paper"], 3, "flat.tif: the exemplars teach nothing"),
        (&input, &exemplar, &["--mode", "paper", "--factor", "257"], 2, "--factor 257: expected 2 to 256"),
        (&input, &exemplar, &["--mode", "paper", "--by", "3"], 2, "--by 3"),
        (&input, &exemplar, &["--mode", "paper", "--patch", "65"], 2, "--patch 65: expected 3 to 64"),
        (&input, &exemplar, &["--mode", "paper", "--step", "6"], 2, "--step: discs of side 8"),
        (&input, &exemplar, &["--mode", "paper", "--unsigned", "--sparsity", "2"], 2, "--sparsity 1 only"),
        (&input, &exemplar, &["--mode", "paper", "--count", "2"], 2, "several terrains need --mode realistic"),
        (&input, &exemplar, &["--patch", "8"], 2, "--patch: it is for --mode paper only"),
        (&input, &exemplar, &["--step", "8"], 2, "--step: it is for --mode paper only"),
        (&input, &exemplar, &["--sparsity", "1"], 2, "--sparsity: it is for --mode paper only"),
        (&input, &exemplar, &["--mode", "realistic", "--unsigned"], 2, "--unsigned: it is for --mode paper only"),
        (&input, &exemplar, &["--mode", "realistic", "--atoms", "9"], 2, "--atoms: it is for --mode paper only"),
        (&input, &exemplar, &["--patches", "9"], 2, "--patches: it is for --mode paper only"),
        (&input, &exemplar, &["--mode", "paper", "--patches", "0"], 2, "--patches 0: expected 1 to 1048576"),
        (&input, &exemplar, &["--by", "2"], 2, "--by: it is for --mode paper only"),
        (&input, &exemplar, &["--memory", "1M"], 3, "raise --memory"),
        (&input, &exemplar, &["--of", "nonsense"], 2, "no such format"),
    ] {
        let run = Run::new(&[&["amplify", input, &out, "--exemplar", exemplar], options].concat());
        run.expect(code, words);
        run.check(listing(dir.path()) == before, "the folder as it was");
    }
    Run::new(&["amplify", &input, &out]).expect(2, "--exemplar");
    // One of several outputs is in the way.
    let (taken, plain) = (inside(&dir, "several-2.tif"), inside(&dir, "several.tif"));
    fs::write(&taken, b"mine").expect("a file");
    let several = ["amplify", &input, &plain, "--exemplar", &exemplar, "--mode", "realistic", "--count", "2"];
    let before = listing(dir.path());
    let run = Run::new(&several);
    run.expect(4, "several-2.tif");
    run.check(listing(dir.path()) == before, "the folder as it was");
    Run::new(&["amplify", &input, &small, "--exemplar", &exemplar]).expect(4, "--overwrite");
    Run::new(&["amplify", &input, &inside(&dir, "out.xyzzy"), "--exemplar", &exemplar]).expect(2, "--of");
}

/// Elements that are opened and closed, in order; what needs no closing has none.
fn is_well_formed(html: &str) -> bool {
    let mut open: Vec<&str> = vec![];
    let mut left = html.strip_prefix("<!DOCTYPE html>").expect("a doctype");
    while let Some(start) = left.find('<') {
        let end = start + left[start..].find('>').expect("an end");
        let tag = &left[start + 1..end];
        left = &left[end + 1..];
        let name = tag.trim_start_matches('/').split([' ', '\n', '/']).next().expect("a name");
        match (tag.starts_with('/'), tag.ends_with('/')) {
            (true, _) if open.pop() != Some(name) => return false,
            (false, false) => open.push(name),
            _ => {}
        }
    }
    open.is_empty()
}

#[test]
fn a_page_that_can_be_mailed() {
    let dir = folder();
    let (learned, exemplar) = taught(&dir, "accurate");
    let (input, _) = dem(&dir, "a & b.tif", (220, 210), |raster| {
        raster.nodata = Some(-1.0);
        (0..40).for_each(|i| raster.bands[0][i * 577 + 99] = -1.0);
    });
    let (out, page) = (inside(&dir, "out.tif"), inside(&dir, "page.html"));
    let mut known: Option<String> = None;
    for threads in ["1", "3"] {
        let options = ["--report", &page, "-j", threads, "--overwrite"];
        let document = amplify(&input, &out, &learned, &options);
        assert_eq!(document["outputs"], serde_json::json!([out, page]));
        let html = fs::read_to_string(&page).expect("the page");
        assert!(known.get_or_insert_with(|| html.clone()) == &html, "the same bytes with other threads");
        assert!(is_well_formed(&html));
        // All is in it: two pictures, three charts, and no address but the name of SVG.
        assert_eq!(html.matches("src=\"data:image/png;base64,iVBORw0KGgo").count(), 2);
        assert_eq!((html.matches("src=").count(), html.matches("<svg ").count()), (2, 3));
        assert_eq!(html.matches("://").count(), html.matches("http://www.w3.org/2000/svg").count());
        assert!(html.contains("<h1>a &amp; b.tif, 4 times finer</h1>"));
        // Numbers are those of the document.
        let number = |value: &Value| value.as_f64().expect("a number");
        let result = &document["result"];
        assert!(html.contains(&format!("<td>{} m</td>", number(&result["deviation_m"]))));
        let report = &result["report"];
        assert_eq!(report["part"], serde_json::json!([9, 14, 192, 192]));
        for what in ["median_slope_deg", "steep_slope_deg"] {
            let [input, output] = ["input", "output"].map(|side| number(&report[side][what]));
            assert!(html.contains(&format!("<td>{input} degrees in the input, {output} degrees in the output</td>")));
        }
        let spectra = ["input", "output"].map(|side| report[side]["power_m2_by_wavelength_m"].as_array().expect("one"));
        assert!(spectra[1].len() == spectra[0].len() + 2, "two octaves more");
        for (i, point) in spectra[1].iter().enumerate() {
            let [wavelength, power] = [&point[0], &point[1]].map(number);
            let before = spectra[0].get(i).map_or("none".into(), |point| format!("{} m²", number(&point[1])));
            let words = format!("at {wavelength} m</th><td>{before} in the input, {power} m² in the output</td>");
            assert!(html.contains(&words), "{words}");
        }
    }
    // A page in the way is not replaced, and then nothing is written; a raster of a cell has one too.
    let (other, _) = dem(&dir, "cell.tif", (1, 1), |_| {});
    let before = listing(dir.path());
    let new = inside(&dir, "new.tif");
    let run = Run::new(&["amplify", &other, &new, "--exemplar", &exemplar, "--report", &page]);
    run.expect(4, "page.html");
    run.check(listing(dir.path()) == before, "the folder as it was");
    let small = inside(&dir, "cell.html");
    let document = amplify(&other, &new, &exemplar, &["--report", &small, "--mode", "paper"]);
    assert!(document["result"]["report"]["output"]["median_slope_deg"].is_f64(), "{document}");
    assert!(document["result"]["report"]["input"]["median_slope_deg"].is_null(), "{document}");
    assert!(is_well_formed(&fs::read_to_string(&small).expect("the page")));
}

/// Greys are heights, and the options say where they lie.
#[test]
fn sketches() {
    let dir = folder();
    let (exemplar, _) = dem(&dir, "exemplar.tif", (140, 140), |_| {});
    let size = (60, 40);
    let greys: Vec<u8> = terrain(60, 40).into_iter().map(|v| (v * 255.0) as u8).collect();
    let drawn = |name: &str| {
        let path = inside(&dir, name);
        let raster = Raster { transform: None, crs: None, ..Raster::new(size, vec![greys.clone()]) };
        raster.write(&path);
        path
    };
    let (tif, png) = (drawn("sketch.tif"), inside(&dir, "sketch.png"));
    let copy = gdal::DriverManager::get_driver_by_name("PNG").expect("GDAL writes PNG");
    let file = gdal::Dataset::open(&tif).expect("the sketch");
    file.create_copy(&copy, &png, &Default::default()).expect("a copy").close().expect("written");
    let place = ["--bbox", "500000,5200000,503000,5202000", "--crs", "EPSG:32632"];
    let sketch = ["--sketch", "--heights", "100m,1.12km"];
    let heights: Vec<f32> = greys.iter().map(|&grey| 100.0 + f32::from(grey) * (1020.0 / 255.0)).collect();
    for mode in ["accurate", "realistic", "paper"] {
        let out = inside(&dir, &format!("{mode}.tif"));
        let document = amplify(&png, &out, &exemplar, &[&sketch[..], &place, &["--mode", mode]].concat());
        assert_eq!(document["result"]["cell_m"], serde_json::json!({ "across": 12.5, "down": 12.5 }));
        let found = facts(&out);
        assert_eq!((found.size, &found.bands[0].unit[..]), ((240, 160), "m"));
        let transform = found.transform.expect("a place").map(f64::from_bits);
        assert_eq!(transform, [500_000.0, 12.5, 0.0, 5_202_000.0, 0.0, -12.5]);
        let off = deviation(&heights, 60, &cells(&out).1, 4, None);
        assert!(off <= if mode == "paper" { 250.0 } else { 0.01 }, "{mode}: {off} m");
        // As GeoTIFF it is the same.
        let again = inside(&dir, "again.tif");
        amplify(&tif, &again, &exemplar, &[&sketch[..], &place, &["--mode", mode, "--overwrite"]].concat());
        assert!(fs::read(&again).expect("the output") == fs::read(&out).expect("the output"), "{mode}");
    }
    // Sixteen bits, a place of its own, of which a box is a part.
    let wide = inside(&dir, "wide.tif");
    let cells_16: Vec<u16> = greys.iter().map(|&grey| u16::from(grey) * 257).collect();
    Raster::new(size, vec![cells_16]).write(&wide);
    let out = inside(&dir, "part.tif");
    let bbox = ["--bbox", "500000,5199700,500600,5200000", "--factor", "2"];
    amplify(&wide, &out, &exemplar, &[&sketch[..], &bbox].concat());
    let part: Vec<f32> = (0..200).map(|i| heights[i / 20 * 60 + i % 20]).collect();
    let (found, fine) = cells(&out);
    assert_eq!(found, (40, 20));
    assert!(deviation(&part, 20, &fine, 2, None) <= 0.01);

    let (float, _) = dem(&dir, "float.tif", (40, 40), |_| {});
    let before = listing(dir.path());
    for (input, options, words) in [
        (&tif, &sketch[..], "sketch.tif: the sketch does not say where it lies: say it with --bbox"),
        (&float, &sketch, "float.tif: a sketch has greys of 8 or 16 bits, and this is Float32"),
        (&tif, &[&sketch[..], &["--bbox", "3,0,1,2"]].concat(), "expected xmin,ymin,xmax,ymax"),
        (&tif, &["--sketch"], "--heights"),
        (&tif, &["--heights", "1,2"], "--sketch"),
        (&tif, &["--sketch", "--heights", "3000,200"], "--heights 3000,200: expected LOW,HIGH"),
        (&tif, &["--sketch", "--heights", "200"], "--heights 200: expected LOW,HIGH"),
        (&tif, &["--sketch", "--heights", "200,x"], "--heights"),
        (&tif, &[&sketch[..], &["--vertical-unit", "ft"]].concat(), "--vertical-unit"),
    ] {
        let run = Run::new(&[&["amplify", input, &inside(&dir, "new.tif"), "--exemplar", &exemplar], options].concat());
        run.expect(2, words);
        run.check(listing(dir.path()) == before, "the folder as it was");
    }
}
