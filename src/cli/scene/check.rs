//! `orograph scene check`.

use super::super::progress::watched;
use super::super::report::Reporter;
use super::super::shared::{MemoryOptions, four};
use super::CommonOptions;
use crate::error::Result;
use crate::pipeline::scene::check::{CheckJob, CheckReport, run};
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Tell what a scene holds, and which of its nodes are without use, without an effect, or without bounds.
///
/// Nodes are named by their path in the file, such as $.root.blend[2].image. The exit code is 1 where a node is unused
/// or contributes nothing, or where no terrain is defined at all; endless nodes and slopes without a bound are told, but
/// are no fault.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Example:\n  orograph scene check fixtures/scenes/valley.json")]
pub(super) struct Check {
    /// Scene: a JSON file.
    #[arg(value_name = "SCENE.json")]
    scene: PathBuf,
    /// The part to look at, in the scene's CRS; all that is bounded unless given.
    #[arg(long, value_name = "XMIN,YMIN,XMAX,YMAX", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    bbox: Option<Vec<f64>>,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Check {
    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        reporter.input(&self.scene);
        let bbox = four("--bbox", self.bbox.as_deref())?;
        let job = CheckJob { scene: self.scene.clone(), bbox, memory: self.memory.bytes()? };
        let report = watched(reporter, |watch, reporter| run(&job, watch, &mut |text| reporter.warn(text)))?;
        report.inputs.iter().for_each(|input| reporter.input(input));
        if report.findings.iter().any(|finding| finding.remark.is_fault()) {
            reporter.answer = 1;
        }
        reporter.say(&text(&report))?;
        Ok(json(&report))
    }
}

/// Coordinates with as few digits as they need; endless ones as such.
fn list(values: &[f64; 4]) -> String {
    let number = |v: &f64| if v.is_finite() { format!("{v:.1}") } else { "endless".into() };
    values.iter().map(number).collect::<Vec<_>>().join(", ")
}

fn text(report: &CheckReport) -> String {
    let (primitives, operators) = report.counts;
    let kib = report.bytes as f64 / 1024.0;
    let mut text = format!("{primitives} primitives and {operators} operators in {kib:.1} KiB\n");
    let kinds: Vec<String> = report.kinds.iter().map(|(kind, n)| format!("{n} {kind}")).collect();
    text += &format!("nodes: {}\n", kinds.join(", "));
    if !report.layers.is_empty() {
        text += &format!("layers: {}\n", report.layers.join(", "));
    }
    text += &format!("crs: {}\n", report.crs.as_deref().unwrap_or("none"));
    text += &format!("box: {}\n", list(&report.support));
    if report.looked_at != report.support {
        text += &format!("looked at: {}\n", list(&report.looked_at));
    }
    text += &format!("terrain in {:.1} % of it\n", 100.0 * report.defined);
    if let Some((low, high, steep)) = report.found {
        let bounds = report.elevation;
        text += &format!(
            "elevation: {low:.2} to {high:.2} m, within {:.2} to {:.2} m for certain\n",
            bounds.min, bounds.max
        );
        let bound = if report.slope.is_finite() { format!("at most {:.3}", report.slope) } else { "no bound".into() };
        text += &format!("slope: up to {steep:.3} m/m, {bound} for certain\n");
    }
    for finding in &report.findings {
        let mark = if finding.remark.is_fault() { "fault" } else { "note" };
        text += &format!("{mark}: {}: {}: {}\n", finding.place, finding.remark.name(), finding.message);
    }
    text
}

/// A number, or nothing where it is endless: JSON has no such number.
fn finite(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

fn json(report: &CheckReport) -> Value {
    let ends = |values: &[f64; 4]| values.iter().map(|&v| finite(v)).collect::<Vec<_>>();
    let findings: Vec<Value> = report
        .findings
        .iter()
        .map(|finding| {
            json!({
                "remark": finding.remark.name(),
                "is_fault": finding.remark.is_fault(),
                "place": finding.place,
                "message": finding.message,
            })
        })
        .collect();
    json!({
        "primitives": report.counts.0,
        "operators": report.counts.1,
        "kinds": report.kinds,
        "layers": report.layers,
        "bytes": report.bytes,
        "crs": report.crs,
        "bbox": ends(&report.support),
        "looked_at": ends(&report.looked_at),
        "share_with_terrain": report.defined,
        "elevation_min_m": report.found.map(|found| found.0),
        "elevation_max_m": report.found.map(|found| found.1),
        "elevation_bounds_m": [finite(report.elevation.min), finite(report.elevation.max)],
        "steepest_slope": report.found.map(|found| found.2),
        "slope_bound": finite(report.slope),
        "findings": findings,
    })
}
