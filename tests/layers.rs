//! The house has floors: a module uses only lower layers, its own folder, and the siblings listed here.
//!
//! A test reads the paths that begin at the crate's root (`crate::name`, `super::...` that climbs that far) in every
//! file of `src/`, comments aside. Other house rules that a machine can see are checked with them.

use std::collections::BTreeSet;
use std::path::Path;

/// Modules at the crate's root, their layer, and the modules of the same layer that they may use.
const LAYERS: &[(&str, u8, &[&str])] = &[
    ("components", 0, &[]),
    ("error", 0, &[]),
    ("interval", 0, &[]),
    ("rng", 0, &[]),
    ("units", 0, &["error"]),
    ("watch", 0, &["error"]),
    ("grid", 1, &[]),
    ("crs", 1, &["grid"]),
    ("codec", 2, &[]),
    ("io", 2, &[]),
    ("linalg", 2, &[]),
    ("noise", 2, &[]),
    ("orometry", 3, &[]),
    ("dictionary", 3, &[]),
    ("construction", 3, &["dictionary"]),
    ("erosion", 3, &[]),
    ("tin", 3, &[]),
    ("plot", 3, &[]),
    ("classify", 3, &["orometry"]),
    ("amplify", 3, &["dictionary", "construction", "erosion"]),
    ("synthesis", 3, &["orometry", "tin", "erosion"]),
    ("figures", 4, &[]),
    ("oro", 4, &[]),
    ("pipeline", 5, &[]),
    ("cli", 6, &[]),
    ("main", 6, &["cli"]),
];

/// Foreign crates behind one door: the name and the modules that may say it.
const DOORS: &[(&str, &[&str])] = &[
    ("gdal", &["io"]),
    ("gdal_sys", &["io"]),
    ("geographiclib_rs", &["crs"]),
    ("tiny_skia", &["plot"]),
    ("ttf_parser", &["plot"]),
    ("dejavu", &["plot"]),
    ("clap", &["cli", "main"]),
    ("rstar", &["orometry", "pipeline"]),
    ("spade", &["tin"]),
    ("crc32c", &["oro"]),
    ("sha2", &["oro"]),
    ("pulp", &["codec", "construction", "linalg"]),
    ("libc", &["main"]),
    ("matrixmultiply", &["linalg"]),
];

/// Macros that only these modules may call.
const MACROS: &[(&str, &[&str])] = &[
    ("println", &["cli", "main"]),
    ("eprintln", &["cli", "main"]),
    ("print", &["cli", "main"]),
    ("eprint", &["cli", "main"]),
    ("todo", &[]),
    ("unimplemented", &[]),
    ("dbg", &[]),
];

/// Names that say nothing of what is inside.
const EMPTY_NAMES: &[&str] = &["util", "utils", "helper", "helpers", "common", "misc"];

const MAX_LINES: usize = 700;

/// Words, and single characters of everything else; `::` is one token.
fn tokens(text: &str) -> Vec<String> {
    let mut found: Vec<String> = vec![];
    for line in text.lines() {
        // Comments may point anywhere. A `//` in a string cuts the line's rest off, which hides nothing of interest.
        let line = line.split("//").next().unwrap_or("");
        let mut word = String::new();
        for c in line.chars().chain([' ']) {
            if c.is_alphanumeric() || c == '_' {
                word.push(c);
                continue;
            }
            if !word.is_empty() {
                found.push(std::mem::take(&mut word));
            }
            if c == ':' && found.last().is_some_and(|t| t == ":") {
                *found.last_mut().expect("just seen") = "::".into();
            } else if !c.is_whitespace() {
                found.push(c.to_string());
            }
        }
    }
    found
}

/// The names that follow a path's beginning at position `at`: one, or those at the first level of braces.
fn names_at(tokens: &[String], at: usize) -> Vec<&str> {
    let Some(first) = tokens.get(at) else { return vec![] };
    if first != "{" {
        return vec![first];
    }
    let mut names = vec![];
    let mut depth = 0;
    let mut begins = false;
    for token in &tokens[at..] {
        match token.as_str() {
            "{" => {
                depth += 1;
                begins = depth == 1;
            }
            "}" => {
                depth -= 1;
                if depth == 0 {
                    break;
                }
            }
            "," => begins = depth == 1,
            name => {
                if std::mem::take(&mut begins) {
                    names.push(name);
                }
            }
        }
    }
    names
}

/// The names at the crate's root that a file uses; `depth` is how deep its module lies (1 for `src/grid/mod.rs`).
fn used(tokens: &[String], depth: usize) -> BTreeSet<&str> {
    let mut names = BTreeSet::new();
    let mut i = 0;
    while i < tokens.len() {
        let follows = |at: usize| tokens.get(at).is_some_and(|t| t == "::");
        if tokens[i] == "crate" && follows(i + 1) {
            names.extend(names_at(tokens, i + 2));
        } else if tokens[i] == "super" && follows(i + 1) && (i == 0 || tokens[i - 1] != "::") {
            let mut climbed = 0;
            while tokens.get(i).is_some_and(|t| t == "super") && follows(i + 1) {
                climbed += 1;
                i += 2;
            }
            // A unit test's module lies one deeper: its names are then no modules of the root, and harmless.
            if climbed >= depth {
                names.extend(names_at(tokens, i));
            }
            continue;
        }
        i += 1;
    }
    names
}

/// Breaches of the rules in one file; `path` is relative to `src`, with `/`.
fn breaches(path: &str, text: &str) -> Vec<String> {
    let parts: Vec<&str> = path.trim_end_matches(".rs").split('/').collect();
    let module = parts[0];
    let depth = parts.iter().filter(|&&part| part != "mod").count();
    let tokens = tokens(text);
    let mut found = vec![];

    for part in &parts {
        if EMPTY_NAMES.contains(part) {
            found.push(format!("{path}: a module named '{part}' says nothing of what is inside"));
        }
    }
    for pair in tokens.windows(2) {
        if pair[0] == "mod" && EMPTY_NAMES.contains(&pair[1].as_str()) {
            found.push(format!("{path}: a module named '{}' says nothing of what is inside", pair[1]));
        }
    }
    let lines = text.lines().count();
    if lines > MAX_LINES {
        found.push(format!("{path}: {lines} lines, more than {MAX_LINES}"));
    }

    for (i, token) in tokens.iter().enumerate() {
        let next = tokens.get(i + 1).map_or("", String::as_str);
        let inside = i > 0 && tokens[i - 1] == "::";
        let imported = i > 0 && tokens[i - 1] == "use";
        for (name, rooms) in DOORS {
            if token == name && (next == "::" || imported) && !inside && !rooms.contains(&module) {
                found.push(format!("{path}: says {name}::, which only {rooms:?} may"));
            }
        }
        for (name, rooms) in MACROS {
            if token == name && next == "!" && !rooms.contains(&module) {
                found.push(format!("{path}: calls {name}!, which {rooms:?} alone may"));
            }
        }
    }

    if module == "lib" {
        return found;
    }
    let Some(&(_, layer, siblings)) = LAYERS.iter().find(|(name, ..)| *name == module) else {
        found.push(format!("{path}: the module '{module}' has no layer in tests/layers.rs"));
        return found;
    };
    for name in used(&tokens, depth) {
        // Anything else at the root is a macro.
        let Some(&(_, other, _)) = LAYERS.iter().find(|(known, ..)| *known == name) else { continue };
        if name != module && other >= layer && !siblings.contains(&name) {
            found.push(format!("{path}: layer {layer} uses {name} of layer {other}"));
        }
    }
    found
}

/// All files of a folder with their paths relative to `root`.
fn files(root: &Path, folder: &Path, found: &mut Vec<(String, String)>) {
    for entry in std::fs::read_dir(folder).expect("the folder can be read") {
        let path = entry.expect("the entry can be read").path();
        if path.is_dir() {
            files(root, &path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let relative = path.strip_prefix(root).expect("inside").to_string_lossy().replace('\\', "/");
            found.push((relative, std::fs::read_to_string(&path).expect("the file can be read")));
        }
    }
}

#[test]
fn the_house_is_in_order() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut all = vec![];
    files(&src, &src, &mut all);
    assert!(all.len() > 10, "the sources are found");
    let mut found: Vec<String> = all.iter().flat_map(|(path, text)| breaches(path, text)).collect();
    found.sort();
    assert!(found.is_empty(), "{} breaches:\n{}", found.len(), found.join("\n"));
}

#[test]
fn bad_lines_are_caught() {
    let long = "\n".repeat(MAX_LINES + 1);
    for (path, text, part) in [
        ("grid/raster.rs", "use crate::orometry::Survey;", "layer 1 uses orometry of layer 3"),
        ("grid/raster.rs", "use crate::{\n    error::{Error, Result},\n    crs::Metric,\n};", "uses crs of layer 1"),
        ("grid/raster.rs", "let x = crate::io::open();", "layer 1 uses io"),
        ("grid/raster.rs", "use super::super::pipeline::run;", "layer 1 uses pipeline"),
        ("grid/mod.rs", "use super::pipeline::run;", "layer 1 uses pipeline"),
        ("units.rs", "use super::grid::Cell;", "layer 0 uses grid"),
        ("plot/map/scale.rs", "use crate::orometry::Peak;", "layer 3 uses orometry of layer 3"),
        ("dictionary/atom.rs", "use crate::construction::Node;", "layer 3 uses construction"),
        ("pipeline/run.rs", "use crate::cli::Progress;", "layer 5 uses cli"),
        ("orometry/tile.rs", "use gdal::Dataset;", "says gdal::"),
        ("orometry/tile.rs", "use gdal;", "says gdal::"),
        ("cli/info.rs", "fn f() -> gdal_sys::CPLErr {}", "says gdal_sys::"),
        ("orometry/tile.rs", "geographiclib_rs::Geodesic::wgs84()", "says geographiclib_rs::"),
        ("io/mod.rs", "use tiny_skia::Pixmap;", "says tiny_skia::"),
        ("pipeline/run.rs", "#[derive(clap::Parser)]", "says clap::"),
        ("crs/mod.rs", "use rstar::RTree;", "says rstar::"),
        ("dictionary/learn.rs", "matrixmultiply::sgemm(1, 1, 1);", "says matrixmultiply::"),
        ("pipeline/run.rs", "use spade::Point2;", "says spade::"),
        ("io/mod.rs", "println!(\"x\");", "calls println!"),
        ("cli/mod.rs", "todo!()", "calls todo!"),
        ("lib.rs", "dbg!(1);", "calls dbg!"),
        ("grid/utils.rs", "", "named 'utils'"),
        ("common/mod.rs", "", "named 'common'"),
        ("grid/mod.rs", "mod misc;", "named 'misc'"),
        ("grid/raster.rs", &long, "701 lines"),
        ("shapes.rs", "", "has no layer"),
    ] {
        let found = breaches(path, text);
        assert!(found.iter().any(|line| line.contains(part)), "{path}: '{text}' gave {found:?}, not '{part}'");
    }
}

#[test]
fn good_lines_pass() {
    for (path, text) in [
        ("grid/raster.rs", "use crate::error::Error;\nuse super::key::Key;\npub(super) fn f() {}"),
        ("grid/raster.rs", "// see crate::pipeline, println!, todo!()\n/// [`crate::cli`]\n"),
        ("crs/planar.rs", "use crate::grid::{self, GeoTransform};\nuse crate::crs::Metric;"),
        ("orometry/measure.rs", "mod tests {\n    use super::super::survey::Peak;\n}\nuse rstar::RTree;"),
        ("orometry/measure.rs", "crate::with_grid!(any, grid => grid.rows())"),
        ("io/raster/open.rs", "use gdal::raster::Buffer;\nuse super::super::messages::quiet;\nuse crate::grid::Grid;"),
        ("io/mod.rs", "self::gdal_messages::gdal();\nlet gdal = 1; other::gdal::x();"),
        ("synthesis/grow.rs", "use crate::{orometry::Survey, tin::Tin, erosion, dictionary_of_words};"),
        ("cli/info.rs", "use clap::Args; println!(); eprintln!(); crate::pipeline::run();"),
        ("main.rs", "use orograph::cli; fn main() { eprintln!() }"),
        ("lib.rs", "pub mod grid; pub use crate::grid::Grid;"),
    ] {
        assert_eq!(breaches(path, text), Vec::<String>::new(), "{path}: {text}");
    }
}
