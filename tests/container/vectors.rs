//! The conformance vectors of `format-spec/vectors`: each is read as its description says, or rejected.
//!
//! `write_vectors` makes those that are missing, and changes none that is there:
//! `cargo test --no-default-features --test container -- --ignored`. Vectors that `released.sha256` lists stay as they
//! are for ever; `tools/vectors` makes the others anew.

use crate::{accepted, rejected};
use orograph::codec::Bound;
use orograph::error::ErrorKind;
use orograph::oro::{CellMeaning, FaultPlace, MetadataItem, Place, Reader, Window};
use orograph::watch::Watch;
use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("format-spec/vectors").join(name)
}

fn quoted(text: &str) -> String {
    let escaped = text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n");
    format!("\"{escaped}\"")
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

fn or_null<T>(value: Option<T>, text: impl Fn(T) -> String) -> String {
    value.map_or("null".into(), text)
}

fn items(items: &[MetadataItem]) -> String {
    let item =
        |item: &MetadataItem| format!("[{}, {}, {}]", quoted(&item.domain), quoted(&item.key), quoted(&item.value));
    format!("[{}]", items.iter().map(item).collect::<Vec<_>>().join(", "))
}

/// What a file is expected to say, without the first line of its description.
fn expectation(file: &[u8]) -> String {
    let reader = Reader::open(file).expect("opens");
    let description = reader.description();
    let mut lines = vec![format!(
        "\"width\": {}, \"height\": {}, \"tile_side\": {}",
        description.width, description.height, description.tile_side
    )];
    let georeference = &description.georeference;
    if let Some(transform) = georeference.transform {
        lines.push(format!("\"geotransform\": {:?}", transform.0));
    }
    if let Some(crs) = &georeference.crs {
        lines.push(format!("\"crs\": {}", quoted(crs)));
    }
    if let Some(epoch) = georeference.epoch {
        lines.push(format!("\"epoch\": {epoch:?}"));
    }
    let meaning = if georeference.cells_are == CellMeaning::Point { "point" } else { "area" };
    lines.push(format!("\"cells_are\": \"{meaning}\""));
    let number = |value: f64| format!("{value:?}");
    let bands = description.bands.iter().map(|band| {
        let sample = band.rule.sample;
        let nodata = band.rule.nodata.map(|bits| bits.to_le_bytes());
        let error = match band.rule.bound {
            Bound::MaxError(error) => Some(error),
            Bound::Lossless => None,
        };
        format!(
            "  {{\"type\": \"{}\", \"nodata\": {}, \"max_error\": {}, \"scale\": {}, \"offset\": {}, \"unit\": {}, \
             \"description\": {}, \"metadata\": {}}}",
            format!("{sample:?}").to_lowercase(),
            or_null(nodata, |bytes| quoted(&hex(&bytes[..sample.bytes()]))),
            or_null(error, number),
            or_null(band.scale, number),
            or_null(band.offset, number),
            quoted(&band.unit),
            quoted(&band.description),
            items(&band.metadata)
        )
    });
    lines.push(format!("\"bands\": [\n{}\n ]", bands.collect::<Vec<_>>().join(",\n")));
    lines.push(format!("\"metadata\": {}", items(&description.metadata)));
    let over = reader.sections().iter().any(|section| section.section.name() == "OVER");
    let report = reader.check(&Watch::default()).expect("is read");
    let overview = match report.is_sound() {
        true if over => "\"sound\"",
        true => "null",
        false => "\"damaged\"",
    };
    let in_overview = |place| matches!(place, FaultPlace::Overview(..) | FaultPlace::Section(_));
    assert!(report.faults.iter().all(|fault| in_overview(fault.place)), "{report:?}");
    lines.push(format!("\"overview\": {overview}"));
    let levels = [0, 1, 3, 6, 8].into_iter().filter(|&level| level <= description.last_level()).map(|level| {
        let (width, height) = description.level_size(level);
        let window = Window { col: 0, row: 0, width, height };
        let hashes = (0..description.bands.len()).map(|band| {
            let cells = reader.window(band, level, window).expect("is read");
            quoted(&hex(&Sha256::digest(cells.to_le_bytes())))
        });
        format!("  \"{level}\": [{}]", hashes.collect::<Vec<_>>().join(", "))
    });
    lines.push(format!("\"sha256\": {{\n{}\n }}", levels.collect::<Vec<_>>().join(",\n")));
    format!(" {}\n}}\n", lines.join(",\n "))
}

/// The vectors of a folder: name, file, description.
fn stored(name: &str) -> Vec<(String, Vec<u8>, String)> {
    let mut vectors = vec![];
    for entry in std::fs::read_dir(folder(name)).expect("the vectors are there") {
        let path = entry.expect("is read").path();
        if path.extension().is_some_and(|extension| extension == "oro") {
            let description = std::fs::read_to_string(path.with_extension("json")).expect("has a description");
            let name = path.file_stem().expect("has a name").to_string_lossy().into_owned();
            vectors.push((name, std::fs::read(&path).expect("is read"), description));
        }
    }
    vectors.sort();
    vectors
}

#[test]
fn accepted_files_are_read_as_described() {
    let vectors = stored("accept");
    assert!(vectors.len() >= 50, "{} vectors", vectors.len());
    for (name, file, description) in vectors {
        let (_, expected) = description.split_once(",\n").expect("a first line");
        let found = std::panic::catch_unwind(|| expectation(&file)).unwrap_or_else(|_| panic!("{name} is not read"));
        assert_eq!(found, expected, "{name}");
    }
}

/// What was released is read for ever, hence nobody may touch it.
#[test]
fn released_vectors_stay_as_they_are() {
    let list = include_str!("../../format-spec/vectors/released.sha256");
    let mut features = 0;
    for line in list.lines() {
        let (hash, name) = line.split_once("  ").expect("a hash and a name");
        let bytes = std::fs::read(folder(name)).unwrap_or_else(|error| panic!("{name} is gone: {error}"));
        assert_eq!(hex(&Sha256::digest(&bytes)), hash, "{name} has changed, and was released");
        features += usize::from(name.starts_with("accept/") && name.ends_with(".oro"));
    }
    assert!(features >= 60, "{features} accepted files were released");
}

#[test]
fn rejected_files_are_rejected() {
    let vectors = stored("reject");
    assert!(vectors.len() >= 50, "{} vectors", vectors.len());
    for (name, file, description) in vectors {
        let opened = Reader::open(file.as_slice());
        let error = if description.contains("\"rejected\": \"file\"") {
            opened.map(|_| ()).expect_err(&name)
        } else {
            let reader = opened.unwrap_or_else(|error| panic!("{name}: {error}"));
            reader.tile(Place::default(), 0).map(|_| ()).expect_err(&name)
        };
        assert!(matches!(error.kind(), ErrorKind::Corrupt | ErrorKind::Unsupported), "{name}: {error}");
    }
}

/// Every requirement on what to reject has a vector.
#[test]
fn requirements_have_vectors() {
    let specification = include_str!("../../format-spec/oro.md");
    let mut required: Vec<&str> =
        specification.lines().filter_map(|line| line.strip_prefix("**R-")?.get(..3)).collect();
    required.sort_unstable();
    let numbers: Vec<String> = (1..=required.len()).map(|number| format!("{number:03}")).collect();
    assert_eq!(required, numbers, "requirements are numbered without gaps");
    let vectors = stored("reject");
    for number in required {
        // What must not be rejected is among the accepted ones.
        let found = vectors.iter().any(|(name, ..)| name.starts_with(&format!("r{number}-")));
        assert!(found || number == "022", "no vector for R-{number}");
    }
}

#[test]
#[ignore = "writes files: run by hand when there are new vectors"]
fn write_vectors() {
    for (name, about, file) in accepted::vectors() {
        let (oro, json) = paths("accept", name);
        if !oro.exists() {
            std::fs::write(oro, &file).expect("is written");
            let description = format!("{{\n \"about\": {},\n{}", quoted(about), expectation(&file));
            std::fs::write(json, description).expect("is written");
        }
    }
    // Real DEMs, made by the program and put there by hand.
    for name in ["real-lossless", "real-bound"] {
        let (oro, json) = paths("accept", name);
        if !json.exists() {
            let file = std::fs::read(oro).expect("is there");
            let about = "Jacksboro, Tennessee (SRTM), as `orograph encode` wrote it when version 1 was released";
            std::fs::write(json, format!("{{\n \"about\": {},\n{}", quoted(about), expectation(&file)))
                .expect("is written");
        }
    }
    for (name, about, file) in rejected::vectors() {
        let (oro, json) = paths("reject", name);
        if !oro.exists() {
            std::fs::write(oro, &file).expect("is written");
            let what = if Reader::open(file.as_slice()).is_err() { "file" } else { "tile" };
            let requirement = format!("R-{}", &name[1..4]);
            let description = format!(
                "{{\n \"about\": {},\n \"requirement\": \"{requirement}\",\n \"rejected\": \"{what}\"\n}}\n",
                quoted(about)
            );
            std::fs::write(json, description).expect("is written");
        }
    }
}

fn paths(kind: &str, name: &str) -> (PathBuf, PathBuf) {
    std::fs::create_dir_all(folder(kind)).expect("is made");
    let path = folder(kind).join(name);
    (path.with_extension("oro"), path.with_extension("json"))
}
