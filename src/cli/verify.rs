//! `orograph verify`.

use super::container_text::size_text;
use super::progress::watched;
use super::report::Reporter;
use super::shared::CommonOptions;
use crate::error::Result;
use crate::oro::{CheckReport, Fault, FaultPlace};
use crate::pipeline::archive::verify::run;
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Check an .oro container: every checksum, every tile, the hash of the whole.
///
/// Each damaged tile is named. The exit code is 0 when nothing is wrong and 1 when something is;
/// `orograph decode --keep-going` saves what is left.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  orograph encode fixtures/jacksboro.tif jacksboro.oro\n  \
                        orograph verify jacksboro.oro")]
pub(super) struct Verify {
    /// Container: an .oro file.
    #[arg(value_name = "FILE")]
    input: PathBuf,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Verify {
    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        reporter.input(&self.input);
        let report = watched(reporter, |watch, _| run(&self.input, watch))?;
        if !report.is_sound() {
            reporter.answer = 1;
        }
        reporter.say(&text(&report))?;
        Ok(json(&report))
    }
}

fn text(report: &CheckReport) -> String {
    let size = size_text(report.bytes);
    if report.is_sound() {
        return format!("sound: {size}, tiles: {}\n", report.chunks);
    }
    let mut text: String = report.faults.iter().map(|fault| format!("{fault}\n")).collect();
    text += &format!("damaged: {size}, tiles: {}, faults: {}\n", report.chunks, report.faults.len());
    text
}

fn json(report: &CheckReport) -> Value {
    let fault = |fault: &Fault| {
        let mut value = json!({
            "place": fault.place.to_string(),
            "offset": fault.offset,
            "message": fault.message,
        });
        if let FaultPlace::Tile(place, _) = fault.place {
            value["tile"] = json!({ "col": place.col, "row": place.row, "band": place.band + 1 });
        }
        value
    };
    json!({
        "sound": report.is_sound(),
        "bytes": report.bytes,
        "tiles": report.chunks,
        "faults": report.faults.iter().map(fault).collect::<Vec<_>>(),
    })
}
