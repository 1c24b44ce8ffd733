//! What goes wrong with containers: damage, full disks, outputs that exist.

use super::rasters::{Raster, facts, terrain};
use super::{PROGRAM, Run, fixture, folder, inside, listing};
use orograph::oro::{Place, Reader};
use std::fs;
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// A container of 5 x 4 tiles of 64 cells, with the raster that went into it.
fn container(dir: &TempDir, nodata: Option<f64>) -> (String, String) {
    let (before, oro) = (inside(dir, "before.tif"), inside(dir, "a.oro"));
    let band: Vec<i16> = terrain(300, 250).into_iter().map(|v| (v * 9000.0) as i16).collect();
    Raster { nodata, ..Raster::new((300, 250), vec![band]) }.write(&before);
    Run::done(&["encode", &before, &oro, "--tile-size", "64"]);
    (before, oro)
}

/// Changes a byte of a tile's chunk.
fn damage(oro: &str, place: Place) {
    let mut bytes = fs::read(oro).expect("the container");
    let reader = Reader::open(bytes.clone()).expect("a container");
    let chunk = reader.chunk(place, 0).expect("the chunk").bytes;
    let at = bytes.windows(chunk.len()).position(|window| window == chunk).expect("the chunk is in the file");
    bytes[at + chunk.len() / 2] ^= 0x10;
    fs::write(oro, bytes).expect("written");
}

#[test]
fn inputs_that_are_no_containers() {
    let dir = folder();
    let path = |name: &str| inside(&dir, name);
    let (_, oro) = container(&dir, None);
    let whole = fs::read(&oro).expect("the container");
    fs::write(path("empty.oro"), "").expect("a file");
    fs::write(path("text.oro"), "just words, and a few more of them, so that it is long enough to be one\n")
        .expect("a file");
    fs::write(path("cut.oro"), &whole[..whole.len() * 6 / 10]).expect("a file");
    fs::copy(fixture("jacksboro.tif"), path("tif.oro")).expect("a copy");
    let before = listing(dir.path());
    for name in ["absent.oro", "empty.oro", "text.oro", "cut.oro", "tif.oro"] {
        let (input, out) = (path(name), path("out.tif"));
        for arguments in [
            &["decode", &input, &out][..],
            &["verify", &input],
            &["info", &input],
            &["encode", &input, &path("out.oro")],
            &["peaks", &input, &path("out.csv")],
        ] {
            let run = Run::new(arguments);
            run.expect(3, name);
            run.check(listing(dir.path()) == before, "the folder as it was");
        }
    }
    for (name, says) in [
        ("absent.oro", "no such file"),
        ("empty.oro", "0 bytes are too few for an .oro file"),
        ("text.oro", "this is no .oro file"),
        ("tif.oro", "this is no .oro file"),
        ("cut.oro", "it was cut off, or never finished"),
    ] {
        Run::new(&["verify", &path(name)]).expect(3, says);
    }
    let run = Run::new(&["decode", &path("cut.oro"), &path("out.tif"), "--json"]);
    run.expect(3, "");
    assert_eq!(run.json()["error"]["kind"], "corrupt");
    Run::new(&["encode", &fixture("absent.tif"), &path("out.oro")]).expect(3, "absent.tif: no such file");
}

#[test]
fn outputs_that_exist_or_cannot_be() {
    let dir = folder();
    let (before, oro) = container(&dir, None);
    let path = |name: &str| inside(&dir, name);
    for (verb, input, name) in [("encode", &before, "b.oro"), ("decode", &oro, "b.tif"), ("decode", &oro, "b.asc")] {
        let out = path(name);
        fs::write(&out, "precious").expect("a file");
        Run::new(&[verb, input, &out]).expect(4, "the output exists already; replace it with --overwrite");
        assert_eq!(fs::read(&out).expect("still there"), b"precious");
        Run::new(&[verb, input, &out, "--overwrite", "--memory", "1M"]).expect(3, "MiB of memory");
        assert_eq!(fs::read(&out).expect("still there"), b"precious");
        Run::done(&[verb, input, &out, "--overwrite"]);
        assert_ne!(fs::read(&out).expect("still there"), b"precious");
        Run::new(&[verb, input, &path(&format!("absent/{name}"))]).expect(4, "absent does not exist");
    }
    // A companion of the output that is somebody else's.
    fs::write(path("c.prj"), "precious").expect("a file");
    Run::new(&["decode", &oro, &path("c.asc")]).expect(4, "c.prj: the output comes with this file");
    assert_eq!(fs::read(path("c.prj")).expect("still there"), b"precious");
    assert!(fs::metadata(path("c.asc")).is_err());
    Run::new(&["encode", &before, &path("c.tif")]).expect(2, "the output is an .oro file: name it so");
    for (options, words) in [
        (&["--tile-size", "100"][..], "multiple of 64"),
        (&["--tile-size", "8192"], "up to 4096"),
        (&["--band", "3"], "no band 3"),
        (&["--window", "1,2,3"], "expected four numbers"),
        (&["--vertical-unit", "parsec"], "not a known unit"),
    ] {
        Run::new(&[&["encode", &before, &path("d.oro")], options].concat()).expect(2, words);
    }
    assert!(fs::metadata(path("d.oro")).is_err());
}

#[test]
fn damaged_tiles() {
    let dir = folder();
    let (before, oro) = container(&dir, Some(-32768.0));
    Run::done(&["verify", &oro]).expect(0, "");
    damage(&oro, Place { col: 2, row: 1, band: 0 });
    damage(&oro, Place { col: 4, row: 3, band: 0 });
    let run = Run::new(&["verify", &oro]);
    run.expect(1, "");
    for words in ["tile column 2, row 1, band 1", "tile column 4, row 3, band 1", "damaged: "] {
        run.check(run.stdout().contains(words), words);
    }
    let document = Run::new(&["verify", &oro, "--json"]).json();
    let tile = serde_json::json!({ "col": 2, "row": 1, "band": 1 });
    let faults = document["result"]["faults"].as_array().expect("faults");
    assert!(document["result"]["sound"] == false && faults.iter().any(|fault| fault["tile"] == tile), "{document}");

    // Threads change nothing of what is told, nor its order.
    damage(&oro, Place { col: 0, row: 2, band: 0 });
    let told = |threads: &str| Run::new(&["verify", &oro, "-j", threads]).stdout();
    let one = told("1");
    let places: Vec<&str> = one.lines().filter_map(|line| line.split(", segment").next()).collect();
    let order = ["2, row 1", "0, row 2", "4, row 3"].map(|place| format!("tile column {place}, band 1"));
    assert_eq!(places[..3], order, "{one}");
    assert!(["2", "3", "8"].iter().all(|threads| told(threads) == one), "the same whatever the threads");
    damage(&oro, Place { col: 0, row: 2, band: 0 });
    assert!(!told("2").contains("row 2"), "sound again");

    let out = inside(&dir, "out.tif");
    let run = Run::new(&["decode", &oro, &out]);
    run.expect(3, "tile column 2, row 1, band 1");
    run.expect(3, "--keep-going saves all other tiles");
    assert!(fs::metadata(&out).is_err(), "nothing half");
    // A part that is sound needs no courage.
    Run::done(&["decode", &oro, &inside(&dir, "part.tif"), "--window", "0,0,128,250"]);
    let run = Run::new(&["decode", &oro, &out, "--keep-going"]);
    run.expect(1, "damaged, and left without data: tile column 2, row 1, band 1");
    run.expect(1, "tile column 4, row 3, band 1");
    let (was, is) = (facts(&before), facts(&out));
    for (i, (was, is)) in was.bands[0].bits.iter().zip(&is.bands[0].bits).enumerate() {
        let tile = (i % 300 / 64, i / 300 / 64);
        let void = i16::MIN as u64;
        assert_eq!(*is, if [(2, 1), (4, 3)].contains(&tile) { void } else { *was }, "cell {i}");
    }
    let run = Run::new(&["decode", &oro, &out, "--keep-going", "--overwrite", "--json"]);
    run.expect(1, "");
    assert_eq!(run.json()["result"]["damaged"].as_array().map(Vec::len), Some(2));
    let raw = Run::new(&["decode", &oro, "-", "--of", "raw", "--keep-going"]);
    raw.expect(1, "tile column 2, row 1");
    assert_eq!(raw.output.stdout.len(), 300 * 250 * 2);
}

/// Runs the program where no file may grow beyond so many blocks.
#[cfg(unix)]
fn cramped(blocks: usize, arguments: &[&str]) -> (Option<i32>, String) {
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    let output = Command::new("sh").args(["-c", &script, PROGRAM]).args(arguments).stdin(Stdio::null()).output();
    let output = output.expect("the shell starts");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[cfg(unix)]
#[test]
fn no_room() {
    let dir = folder();
    let (before, oro) = container(&dir, None);
    let there = listing(dir.path());
    for (verb, input, name, options) in [
        ("encode", &before, "b.oro", &[][..]),
        ("decode", &oro, "b.tif", &[]),
        ("decode", &oro, "b.tif", &["--co", "COMPRESS=NONE"]),
        ("decode", &oro, "b.asc", &[]),
        ("decode", &oro, "b.img", &[]),
        ("decode", &oro, "b.bil", &[]),
        ("decode", &oro, "b.bin", &["--of", "raw"]),
        ("decode", &oro, "b.cog", &["--of", "COG"]),
    ] {
        let out = inside(&dir, name);
        for blocks in [0, 1, 40, 100] {
            let (code, said) = cramped(blocks, &[&[verb, input.as_str(), &out], options].concat());
            assert_eq!(code, Some(4), "{name} {options:?} in {blocks} blocks: {said}");
            assert!(said.contains(&format!("{name}: ")) && !said.contains("panicked"), "{name}: {said}");
            assert_eq!(listing(dir.path()), there, "{name} {options:?}");
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_stream_that_is_full() {
    let dir = folder();
    let (before, oro) = container(&dir, None);
    for arguments in [&["encode", &before, "-"][..], &["decode", &oro, "-", "--of", "raw"]] {
        let full = fs::File::options().write(true).open("/dev/full").expect("/dev/full");
        let output = Command::new(PROGRAM).args(arguments).stdin(Stdio::null()).stdout(full).output();
        let output = output.expect("the program starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(4), "{arguments:?}: {said}");
        assert!(said.contains("standard output: "), "{said}");
    }
}
