//! The program as a user runs it: exit codes, messages, files.

#![cfg(feature = "program")]

mod amplify;
mod archive;
mod archive_failures;
mod archive_info;
mod archive_maps;
mod classify;
mod examples;
mod failures;
mod interrupt;
mod learned;
#[path = "../mesh_files/mod.rs"]
mod mesh_files;
mod outputs;
mod rasters;
mod readme;
mod scene;
mod scene_failures;
#[path = "../schema/mod.rs"]
mod schema;
mod sketches;
mod sparse;
mod synthesize;
mod terrain;
mod tin;

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

const PROGRAM: &str = env!("CARGO_BIN_EXE_orograph");

/// The repository, where `fixtures/` is.
fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn fixture(name: &str) -> String {
    root().join("fixtures").join(name).display().to_string()
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder for the test")
}

/// A path inside a folder, as an argument.
fn inside(dir: &TempDir, name: &str) -> String {
    dir.path().join(name).display().to_string()
}

/// Names of the files in a folder.
fn listing(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder is there");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Makes a folder seen under another name.
#[cfg(unix)]
fn link(from: &Path, to: &Path) {
    std::os::unix::fs::symlink(from, to).expect("a link to the fixtures");
}

/// Makes a copy of a folder, where links are not for everybody.
#[cfg(not(unix))]
fn link(from: &Path, to: &Path) {
    fs::create_dir(to).expect("a folder for the fixtures");
    for name in listing(from) {
        fs::copy(from.join(&name), to.join(&name)).expect("a copy of a fixture");
    }
}

/// One run of the program, over.
struct Run {
    arguments: Vec<String>,
    cwd: PathBuf,
    output: Output,
}

impl Run {
    /// Runs the program in the repository.
    fn new(arguments: &[&str]) -> Self {
        Self::in_folder(&root(), arguments)
    }

    fn in_folder(cwd: &Path, arguments: &[&str]) -> Self {
        let mut command = Command::new(PROGRAM);
        let output = command.current_dir(cwd).args(arguments).stdin(Stdio::null()).output();
        Self {
            arguments: arguments.iter().map(ToString::to_string).collect(),
            cwd: cwd.to_path_buf(),
            output: output.expect("the program starts"),
        }
    }

    /// Runs it in the repository and expects success.
    fn done(arguments: &[&str]) -> Self {
        let run = Self::new(arguments);
        run.expect(0, "");
        run
    }

    /// Expects an exit code, and words on standard error.
    fn expect(&self, code: i32, words: &str) {
        self.check(self.output.status.code() == Some(code), &format!("exit code {code}"));
        self.check(self.stderr().contains(words), &format!("'{words}' on standard error"));
    }

    fn check(&self, holds: bool, expected: &str) {
        assert!(
            holds,
            "expected {expected} of orograph {}\nin {}\n{}\n--- stdout\n{}\n--- stderr\n{}",
            self.arguments.join(" "),
            self.cwd.display(),
            self.output.status,
            self.stdout(),
            self.stderr()
        );
    }

    fn stdout(&self) -> String {
        String::from_utf8_lossy(&self.output.stdout).into_owned()
    }

    fn stderr(&self) -> String {
        String::from_utf8_lossy(&self.output.stderr).into_owned()
    }

    /// Standard output as one JSON document and nothing else.
    fn json(&self) -> Value {
        let document = serde_json::from_slice(&self.output.stdout);
        self.check(document.is_ok(), "one JSON document on standard output");
        document.expect("checked")
    }
}

/// A CSV file: its header, and its rows by field.
struct Csv {
    header: Vec<String>,
    rows: Vec<BTreeMap<String, String>>,
}

impl Csv {
    fn read(path: impl AsRef<Path>) -> Self {
        let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.as_ref().display()));
        let mut lines = text.lines();
        let header = split(lines.next().expect("a header"));
        let rows = lines.map(|line| {
            let values = split(line);
            assert_eq!(values.len(), header.len(), "{line}");
            header.iter().cloned().zip(values).collect()
        });
        let rows = rows.collect();
        Self { header, rows }
    }

    /// A few fields of each row.
    fn columns(&self, names: &[&str]) -> Vec<Vec<&str>> {
        self.rows.iter().map(|row| names.iter().map(|&name| row[name].as_str()).collect()).collect()
    }
}

/// The fields of a line; commas in quotes part nothing.
fn split(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            _ => fields.last_mut().expect("never empty").push(c),
        }
    }
    fields
}
