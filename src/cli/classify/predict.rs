//! `orograph classify predict`.

use super::super::progress::watched;
use super::super::report::Reporter;
use super::super::shared::CommonOptions;
use super::super::tags::RegionOptions;
use super::width;
use crate::error::{Error, Result};
use crate::pipeline::classify::{Answer, PredictJob, PredictReport, predict};
use clap::Args;
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::PathBuf;

/// Tell which class the peaks of a layer are like, with the probability of each.
///
/// Disks are laid over the layer, or over each region, as they were when the classifier was trained; probabilities are
/// the mean of theirs. Single disks can be asked for instead; they have the radius of the training. A synthesised layer
/// can be put through too, but its isolations, which are those to the nearest higher peak, are somewhat longer.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  \
    orograph peaks fixtures/jacksboro.tif real.gpkg\n  \
    orograph synthesize made.gpkg --tree-only --like real.gpkg\n  \
    orograph classify train model.json --peaks real=real.gpkg --peaks made=made.gpkg --disk-radius 5km\n  \
    orograph classify predict model.json real.gpkg --disk -84.2,36.6")]
pub(super) struct Predict {
    /// Classifier that `orograph classify train` wrote.
    #[arg(value_name = "MODEL.json")]
    model: PathBuf,
    /// Layer of peaks that `orograph peaks` or `orograph synthesize` wrote.
    #[arg(value_name = "PEAKS.gpkg")]
    peaks: PathBuf,
    /// Ask of the disk around a place, as often as needed: LON,LAT. In a projected CRS X,Y where the two are no
    /// longitude and latitude.
    #[arg(long = "disk", value_name = "X,Y", allow_hyphen_values = true)]
    disks: Vec<String>,
    /// Layer of the peaks, where the file has several.
    #[arg(long, value_name = "LAYER")]
    layer: Option<String>,
    /// CRS of a layer that has none: EPSG:2056, WKT, a PROJ string.
    #[arg(long, value_name = "CRS")]
    crs: Option<String>,
    #[command(flatten)]
    regions: RegionOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Predict {
    fn meant(&self) -> Result<PredictJob> {
        Ok(PredictJob {
            model: self.model.clone(),
            peaks: self.peaks.clone(),
            layer: self.layer.clone(),
            crs: self.crs.clone(),
            regions: self.regions.meant(),
            disks: self.disks.iter().map(|text| disk(text)).collect::<Result<_>>()?,
        })
    }

    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        reporter.input(&self.model);
        reporter.input(&self.peaks);
        let job = self.meant()?;
        let report = watched(reporter, |watch, reporter| predict(&job, watch, &mut |text| reporter.warn(text)))?;
        reporter.say(&text(&report))?;
        Ok(json(&report))
    }
}

/// What a --disk means.
fn disk(text: &str) -> Result<(String, f64, f64)> {
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    let found = text.split_once(',').and_then(|(x, y)| number(x).zip(number(y)));
    found.map(|(x, y)| (text.to_string(), x, y)).ok_or_else(|| {
        Error::usage(format!("--disk {text}: expected two numbers, LON,LAT or X,Y; its radius is that of the training"))
    })
}

/// Classes with their probabilities, the most probable first.
fn ranked<'a>(report: &'a PredictReport, answer: &Answer) -> Vec<(&'a str, f64)> {
    let names = report.model.classes.iter().map(|class| class.name.as_str());
    let mut ranked: Vec<(&str, f64)> = names.zip(answer.probabilities.iter().copied()).collect();
    // Stable: equals in the order of the classes.
    ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
    ranked
}

fn text(report: &PredictReport) -> String {
    let wide = width(report.answers.iter().map(|answer| answer.name.as_str()), 4);
    let mut text = String::new();
    for answer in &report.answers {
        let likely: Vec<String> = ranked(report, answer)
            .iter()
            .filter(|(_, probability)| *probability > 0.0)
            .map(|(name, probability)| format!("{name} {:.1} %", 100.0 * probability))
            .collect();
        let likely = if likely.is_empty() { "no answer".into() } else { likely.join(", ") };
        let disks = if answer.disks == 1 { "disk" } else { "disks" };
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{:wide$}  {} {disks}: {likely}", answer.name, answer.disks);
    }
    text
}

fn json(report: &PredictReport) -> Value {
    let classes = &report.model.classes;
    let named = |values: Vec<Value>| -> Map<String, Value> {
        classes.iter().map(|class| class.name.clone()).zip(values).collect()
    };
    let answers: Vec<Value> = report
        .answers
        .iter()
        .map(|answer| {
            json!({
                "name": answer.name,
                "disks": answer.disks,
                "class": answer.class.map(|class| &classes[class].name),
                "probabilities": named(answer.probabilities.iter().map(|&probability| json!(probability)).collect()),
                "votes": named(answer.votes.iter().map(|&votes| json!(votes)).collect()),
            })
        })
        .collect();
    json!({ "conditions": report.model.conditions, "answers": answers })
}
