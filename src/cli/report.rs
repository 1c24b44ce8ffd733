//! The only place that prints: results on standard output, everything else on standard error.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "this is where the program speaks")]

use super::shared::CommonOptions;
use crate::error::{Error, ErrorKind, Result};
use crate::io::messages;
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Speaks for one run of a verb.
pub(super) struct Reporter {
    verb: &'static str,
    json: bool,
    quiet: bool,
    /// Whether to say more.
    pub(super) verbose: bool,
    inputs: Vec<String>,
    outputs: Vec<String>,
    warnings: Vec<String>,
    /// Exit code of a run that did not fail.
    pub(super) answer: u8,
}

impl Reporter {
    pub(super) fn new(verb: &'static str, common: &CommonOptions) -> Self {
        Self {
            verb,
            json: common.json,
            quiet: common.quiet,
            verbose: common.verbose && !common.quiet,
            inputs: Vec::new(),
            outputs: Vec::new(),
            warnings: Vec::new(),
            answer: 0,
        }
    }

    /// Whether progress is to be shown.
    pub(super) fn shows_progress(&self) -> bool {
        !self.quiet
    }

    /// Whether the result is printed as JSON.
    pub(super) fn is_json(&self) -> bool {
        self.json
    }

    /// Names an input.
    pub(super) fn input(&mut self, path: &Path) {
        self.inputs.push(path.display().to_string());
    }

    /// Names the outputs; what people read ends with them.
    pub(super) fn outputs(&mut self, paths: &[PathBuf]) {
        self.outputs.extend(paths.iter().map(|path| path.display().to_string()));
    }

    /// A warning, printed at once.
    pub(super) fn warn(&mut self, text: &str) {
        self.warnings.push(text.to_string());
        if !self.quiet {
            eprintln!("warning: {text}");
        }
    }

    /// A remark for those who asked for more.
    pub(super) fn remark(&self, text: &str) {
        if self.verbose {
            eprintln!("{text}");
        }
    }

    /// A part of the result, for people; nothing where JSON is wanted.
    pub(super) fn say(&self, text: &str) -> Result<()> {
        if self.json { Ok(()) } else { print(text) }
    }

    /// Ends the run: prints the document, or which outputs were written, or the error, and returns the exit code.
    pub(super) fn finish(self, result: Result<Value>) -> u8 {
        let done = result.and_then(|result| {
            if self.json {
                let document = json!({
                    "verb": self.verb,
                    "version": env!("CARGO_PKG_VERSION"),
                    "inputs": self.inputs,
                    "outputs": self.outputs,
                    "result": result,
                    "warnings": self.warnings,
                });
                print(&format!("{document:#}\n"))
            } else {
                self.outputs.iter().try_for_each(|output| print(&format!("written: {output}\n")))
            }
        });
        match done {
            Ok(()) => self.answer,
            Err(error) => fail(self.verb, &error, self.json),
        }
    }
}

/// Prints to standard output. Whoever closed it has read enough: that is a success.
fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Error::new(ErrorKind::Output, format!("standard output cannot be written to: {error}")))
        }
        _ => Ok(()),
    }
}

fn fail(verb: &str, error: &Error, json: bool) -> u8 {
    if json {
        let document = json!({
            "verb": verb,
            "version": env!("CARGO_PKG_VERSION"),
            "error": {
                "kind": error.kind().name(),
                "message": error.message(),
                "path": error.path().map(|path| path.display().to_string()),
                "place": error.place(),
            },
        });
        // Standard output may be what failed.
        let _ = print(&format!("{document:#}\n"));
    }
    eprintln!("orograph {verb}: {error}");
    error.kind().exit_code()
}

/// Prints help where it was asked for, else what is wrong with a call.
pub(super) fn usage(error: &clap::Error, json: bool) -> u8 {
    use clap::error::ErrorKind as Clap;
    if matches!(error.kind(), Clap::DisplayHelp | Clap::DisplayVersion) {
        return print(&error.render().to_string()).map_or_else(|error| fail("help", &error, false), |()| 0);
    }
    if json {
        let text = error.render().to_string();
        let message = text.trim_start_matches("error: ").lines().next().unwrap_or_default().to_string();
        return fail("", &Error::usage(message), true);
    }
    eprint!("{}", error.render());
    ErrorKind::Usage.exit_code()
}

/// Prints the versions of the program and of what it stands on.
pub(super) fn version() -> u8 {
    let (gdal, proj) = messages::versions();
    let text = format!("orograph {}\nGDAL {gdal}\nPROJ {proj}\n", env!("CARGO_PKG_VERSION"));
    print(&text).map_or_else(|error| fail("version", &error, false), |()| 0)
}
