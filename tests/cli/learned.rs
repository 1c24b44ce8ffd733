//! `orograph learn --multires` and `amplify --learned`: what is kept makes the same terrain.

use super::rasters::{Raster, terrain};
use super::{Run, folder, inside, listing, root};
use std::fs;
use tempfile::TempDir;

/// Terrain of cells in metres, 30 of them or as `change` says.
fn dem(dir: &TempDir, name: &str, size: (usize, usize), change: impl Fn(&mut Raster<f32>)) -> String {
    let cells: Vec<f32> = terrain(size.0, size.1).into_iter().map(|v| (v * 2000.0) as f32).collect();
    let mut raster = Raster::new(size, vec![cells]);
    change(&mut raster);
    let path = inside(dir, name);
    raster.write(&path);
    path
}

fn bytes(path: &str) -> Vec<u8> {
    fs::read(path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// What was learned gives what exemplars give, with the same options.
#[test]
fn the_same_terrain_as_of_exemplars() {
    let dir = folder();
    let exemplar = dem(&dir, "exemplar.tif", (150, 140), |_| {});
    let other = dem(&dir, "other.tif", (130, 120), |raster| raster.bands[0].iter_mut().for_each(|v| *v *= 1.5));
    let input = dem(&dir, "input.tif", (45, 40), |raster| {
        raster.nodata = Some(-1.0);
        raster.bands[0][77] = -1.0;
    });
    for (name, learning, making) in [
        ("accurate", &["--seed", "3"][..], &[][..]),
        ("realistic", &["--mode", "realistic"], &["--seed", "8"]),
        ("paper", &["--mode", "paper", "--patch", "4", "--by", "2", "--unsigned"], &[]),
        ("atoms", &["--mode", "paper", "--atoms", "40", "--seed", "2", "--sparsity", "2"], &["--atoms", "40"]),
    ] {
        let [kept, of_kept, of_exemplars] =
            ["learned", "kept.tif", "taught.tif"].map(|end| inside(&dir, &format!("{name}.{end}")));
        let all =
            [&["learn", "--multires", &exemplar, &other, &kept, "--cell", "15m", "--factor", "2", "--json"], learning];
        let learned = Run::done(&all.concat()).json();
        assert_eq!(learned["result"]["bytes"], bytes(&kept).len());
        let made = Run::done(&[&["amplify", &input, &of_kept, "--learned", &kept, "--json"], making].concat()).json();
        let all = [
            &["amplify", &input, &of_exemplars, "--exemplar", &exemplar, &other, "--factor", "2", "--json"],
            learning,
            making,
        ];
        // An option cannot be said twice.
        let mut all = all.concat();
        if name == "atoms" {
            all.truncate(all.len() - 2);
        }
        let taught = Run::done(&all).json();
        assert!(bytes(&of_kept) == bytes(&of_exemplars), "{name}: the same bytes");
        assert_eq!(made["inputs"], serde_json::json!([input, kept]));
        for key in ["atoms", "seeds", "deviation_m", "cells_with_data"] {
            assert_eq!(made["result"][key], taught["result"][key], "{name}: {key}");
        }
        assert_eq!(made["warnings"], serde_json::json!([]));
    }
}

#[test]
fn threads_make_no_difference_to_what_is_kept() {
    let dir = folder();
    let exemplar = dem(&dir, "exemplar.tif", (120, 110), |_| {});
    for mode in ["accurate", "realistic", "paper"] {
        let kept = ["1", "2"].map(|threads| {
            let path = inside(&dir, &format!("{mode}-{threads}.learned"));
            Run::done(&["learn", "--multires", &exemplar, &path, "--mode", mode, "--factor", "2", "-j", threads]);
            bytes(&path)
        });
        assert!(kept[0] == kept[1], "{mode}");
    }
}

/// Where longitudes are shorter than latitudes, the warning says what to learn for.
#[test]
fn cells_that_are_not_square() {
    let dir = folder();
    let geographic = |raster: &mut Raster<f32>| {
        raster.transform = Some([7.0, 1.0 / 3600.0, 0.0, 46.0, 0.0, -1.0 / 3600.0]);
        raster.crs = Some("EPSG:4326");
    };
    let exemplar = dem(&dir, "exemplar.tif", (150, 140), |_| {});
    let input = dem(&dir, "input.tif", (45, 40), geographic);
    let [square, long, of_kept, of_exemplars] =
        ["square.learned", "long.learned", "kept.tif", "taught.tif"].map(|name| inside(&dir, name));
    Run::done(&["learn", "--multires", &exemplar, &square, "--cell", "15m", "--factor", "2"]);
    let run = Run::done(&["amplify", &input, &of_kept, "--learned", &square]);
    run.check(
        run.stderr().contains("square.learned was learned for cells of 15.00 m, as wide as high, and"),
        "both sizes",
    );
    let words = run.stderr();
    let cell = words.split("learn again with --cell ").nth(1).and_then(|rest| rest.lines().next()).expect("a size");
    Run::done(&["learn", "--multires", &exemplar, &long, "--cell", cell, "--factor", "2"]);
    let run = Run::done(&["amplify", &input, &of_kept, "--learned", &long, "--overwrite"]);
    run.check(!run.stderr().contains("warning"), "no warning");
    Run::done(&["amplify", &input, &of_exemplars, "--exemplar", &exemplar, "--factor", "2"]);
    assert!(bytes(&of_kept) == bytes(&of_exemplars), "the same bytes");
    // Without --cell it is learned for the finest exemplar's own.
    let finer = dem(&dir, "finer.tif", (140, 130), |raster| {
        geographic(raster);
        raster.transform = Some([7.0, 1.0 / 7200.0, 0.0, 46.0, 0.0, -1.0 / 7200.0]);
    });
    let own = inside(&dir, "own.learned");
    let document =
        Run::done(&["learn", "--multires", &exemplar, &finer, &own, "--factor", "2", "--mode", "paper", "--json"])
            .json();
    let [across, down] = ["across", "down"].map(|side| document["result"]["cell_m"][side].as_f64().expect("a length"));
    assert!((10.0..11.0).contains(&across) && (15.0..16.0).contains(&down), "{across} x {down} m");
}

#[test]
fn another_kind_of_terrain_is_told_again() {
    let dir = folder();
    let exemplar = dem(&dir, "flat.tif", (120, 110), |raster| raster.bands[0].iter_mut().for_each(|v| *v /= 50.0));
    let input = dem(&dir, "input.tif", (40, 40), |_| {});
    let [kept, out, page] = ["flat.learned", "out.tif", "page.html"].map(|name| inside(&dir, name));
    Run::done(&["learn", "--multires", &exemplar, &kept, "--mode", "paper", "--cell", "7.5m"]);
    let run = Run::done(&["amplify", &input, &out, "--learned", &kept, "--report", &page]);
    run.check(run.stderr().contains("flat.learned, exemplar flat.tif: its terrain is of another kind"), "the warning");
    let page = String::from_utf8(bytes(&page)).expect("a page");
    assert!(page.contains("flat.tif, learned before: flat.learned"), "the page says what it was learned from");
    // The folder is nobody's business.
    let text = dir.path().display().to_string();
    assert!(!bytes(&kept).windows(text.len()).any(|window| window == text.as_bytes()), "no path is kept");
}

#[test]
fn info_tells_what_it_is() {
    let kept = root().join("fixtures/learned/paper.learned").display().to_string();
    let document = Run::done(&["info", &kept, "--json"]).json();
    let result = &document["result"];
    assert_eq!(
        (&result["format"], &result["mode"], &result["factor"]),
        (&"learned".into(), &"paper".into(), &4.into())
    );
    assert_eq!(result["exemplars"][0]["name"], "Écrins.tif");
    assert_eq!(result["bytes"], bytes(&kept).len());
    let text = Run::done(&["info", &kept]);
    for words in ["mode paper, 4 times finer", "cells of 10 x 10 m", "exemplar Écrins.tif: 300 x 400 cells"] {
        text.check(text.stdout().contains(words), words);
    }
    Run::new(&["info", &kept, "--band", "1"]).expect(2, "--band: it is for rasters");
}

#[test]
fn refusals() {
    let dir = folder();
    let exemplar = dem(&dir, "exemplar.tif", (60, 60), |_| {});
    let kept = inside(&dir, "kept.learned");
    Run::done(&["learn", "--multires", &exemplar, &kept, "--mode", "paper", "--patch", "4", "--factor", "2"]);
    let whole = bytes(&kept);
    let damaged = |name: &str, change: &dyn Fn(&mut Vec<u8>)| {
        let path = inside(&dir, name);
        let mut bytes = whole.clone();
        change(&mut bytes);
        fs::write(&path, bytes).expect("a file");
        path
    };
    let cut = damaged("cut.learned", &|bytes| bytes.truncate(whole.len() / 2));
    let flipped = damaged("flipped.learned", &|bytes| bytes[whole.len() / 2] ^= 4);
    let [packed, absent, out, new] =
        ["packed.oro", "absent.learned", "out.tif", "new.learned"].map(|name| inside(&dir, name));
    Run::done(&["encode", &exemplar, &packed, "--lossless"]);
    let before = listing(dir.path());
    for (options, code, words) in [
        (&["--learned", &cut][..], 3, "cut.learned: "),
        (&["--learned", &flipped], 3, "flipped.learned: it is damaged"),
        (&["--learned", &packed], 3, "packed.oro: it is an .oro container"),
        (&["--learned", &exemplar], 3, "exemplar.tif: it is not what orograph learn --multires keeps"),
        (&["--learned", &absent], 3, "absent.learned: it cannot be read"),
        (&["--learned", &kept, "--exemplar", &exemplar], 2, "--exemplar"),
        (&[], 2, "--exemplar"),
        (&["--learned", &kept, "--factor", "4"], 2, "--factor 4: kept.learned was learned with --factor 2"),
        (&["--learned", &kept, "--mode", "accurate"], 2, "--mode accurate: kept.learned was learned with --mode paper"),
        (&["--learned", &kept, "--unsigned"], 2, "--unsigned: kept.learned was learned without --unsigned"),
        (&["--learned", &kept, "--count", "2"], 2, "several terrains need --mode realistic"),
        (&["--learned", &kept, "--memory", "1"], 3, "memory"),
    ] {
        let run = Run::new(&[&["amplify", &exemplar, &out], options].concat());
        run.expect(code, words);
        run.check(listing(dir.path()) == before, "the folder as it was");
    }
    Run::done(&["amplify", &exemplar, &out, "--learned", &kept, "--mode", "paper", "--factor", "2", "--patch", "4"]);
    let before = listing(dir.path());
    for (files, options, code, words) in [
        ([&exemplar, &new], &["--multires", "--iterations", "4"][..], 2, "--iterations: it is for dictionaries"),
        ([&exemplar, &new], &["--multires", "--constrained"], 2, "--constrained: it is for dictionaries"),
        ([&exemplar, &new], &["--multires", "--band", "1"], 2, "--band: it is for dictionaries"),
        ([&exemplar, &new], &["--multires", "--window", "0,0,9,9"], 2, "--window: it is for dictionaries"),
        ([&exemplar, &new], &["--multires", "--patch", "4"], 2, "--patch: it is for --mode paper only"),
        ([&exemplar, &new], &["--multires", "--mode", "realistic", "--seed", "2"], 2, "--seed: nothing is drawn"),
        ([&exemplar, &new], &["--multires", "--factor", "11"], 2, "--factor 11: expected"),
        ([&exemplar, &new], &["--multires", "--cell", "0m"], 2, "--cell 0m: expected a length above 0"),
        ([&exemplar, &new], &["--multires", "--cell", "1,2,3"], 2, "--cell: "),
        ([&exemplar, &packed], &["--multires"], 2, "packed.oro: with --multires the output is a .learned file"),
        ([&exemplar, &kept], &["--multires"], 4, "kept.learned: the output exists already"),
        ([&absent, &new], &["--multires"], 3, "absent.learned: "),
        ([&exemplar, &new], &[], 2, "new.learned: the output is an .oro file"),
        ([&exemplar, &inside(&dir, "new.oro")], &["--factor", "2"], 2, "--multires"),
        ([&exemplar, &inside(&dir, "new.oro")], &["--unsigned"], 2, "--unsigned: it is for --multires"),
    ] {
        let run = Run::new(&[&["learn", files[0], files[1]], options].concat());
        run.expect(code, words);
        run.check(listing(dir.path()) == before, "the folder as it was");
    }
    assert!(bytes(&kept) == whole, "what was there is as it was");
    Run::done(&["learn", "--multires", &exemplar, &kept, "--mode", "paper", "--factor", "2", "--overwrite"]);
    assert!(bytes(&kept) != whole, "and replaced when it may be");
}
