//! `orograph classify train`.

use super::super::progress::watched;
use super::super::report::Reporter;
use super::super::shared::{CommonOptions, OutputOptions};
use super::super::tags::RegionOptions;
use super::super::wrong_value;
use super::width;
use crate::classify::{Confusion, ForestOptions};
use crate::error::{Error, Result};
use crate::pipeline::classify::{PeaksInput, TrainJob, TrainReport, train};
use crate::units::parse_length_m;
use clap::Args;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;

/// Learn to tell ranges apart, and test it on ground that was not learned from.
///
/// Disks are laid over each range on a regular grid, half a radius apart. To test, the end of every range is cut off
/// in eight directions in turn: the fifth of its disks that lies farthest out is classified by a forest grown on those
/// that share no ground with it. The table adds up all eight. Out of bag each disk is classified by the trees that did
/// not see it, which is told too easily, as they saw its neighbours. MODEL.json is grown on all disks. Lengths take a
/// unit (30m, 100ft, 1.5km); a bare number is metres.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  \
    orograph peaks fixtures/jacksboro.tif real.gpkg\n  \
    orograph synthesize made.gpkg --tree-only --like real.gpkg\n  \
    orograph classify train model.json --peaks real=real.gpkg --peaks made=made.gpkg --disk-radius 5km")]
pub(super) struct Train {
    /// Output: the classifier.
    #[arg(value_name = "MODEL.json")]
    output: PathBuf,
    /// Layer of peaks that `orograph peaks` wrote, all of one class, as often as needed. Without NAME= its classes are
    /// the regions that its peaks stand in.
    #[arg(long, value_name = "NAME=PEAKS.gpkg", required = true)]
    peaks: Vec<String>,
    /// Radius of the disks.
    #[arg(long, value_name = "LENGTH", default_value = "10km", allow_hyphen_values = true)]
    disk_radius: String,
    /// Fewest peaks of a disk.
    #[arg(long, value_name = "N", default_value_t = 10)]
    min_peaks: usize,
    /// Least prominence of the peaks that count; the greatest of those that the layers were made with unless given.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    min_prominence: Option<String>,
    /// Number of trees.
    #[arg(long, value_name = "N", default_value_t = 200)]
    trees: usize,
    /// Equal seeds make equal classifiers.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Write the disks with their classes, their parts in each cut and their features as a table, too.
    #[arg(long, value_name = "DISKS.csv")]
    disks: Option<PathBuf>,
    /// Layer of the peaks, where files have several.
    #[arg(long, value_name = "LAYER")]
    layer: Option<String>,
    /// CRS of layers that have none: EPSG:2056, WKT, a PROJ string.
    #[arg(long, value_name = "CRS")]
    crs: Option<String>,
    #[command(flatten)]
    regions: RegionOptions,
    #[command(flatten)]
    out: OutputOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

/// Most trees of a forest.
const MOST_TREES: usize = 100_000;

impl Train {
    fn meant(&self) -> Result<TrainJob> {
        let length = |option: &str, text: &str| parse_length_m(text).map_err(|error| wrong_value(option, &error));
        let disk_radius_m = length("--disk-radius", &self.disk_radius)?;
        if !(disk_radius_m.is_finite() && disk_radius_m > 0.0) {
            return Err(Error::usage(format!("--disk-radius {}: expected more than 0", self.disk_radius)));
        }
        let min_prominence_m =
            self.min_prominence.as_deref().map(|text| length("--min-prominence", text)).transpose()?;
        if min_prominence_m.is_some_and(|m| m < 0.0) {
            return Err(Error::usage("--min-prominence: expected 0 or more"));
        }
        if !(1..=MOST_TREES).contains(&self.trees) {
            return Err(Error::usage(format!("--trees {}: expected 1 to {MOST_TREES}", self.trees)));
        }
        for (path, extension) in [(Some(&self.output), "json"), (self.disks.as_ref(), "csv")] {
            if let Some(path) = path.filter(|path| !path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension)))
            {
                return Err(Error::usage(format!("this output is a .{extension} file: name it so")).at_path(path));
            }
        }
        Ok(TrainJob {
            peaks: self.peaks.iter().map(|text| input(text)).collect::<Result<_>>()?,
            layer: self.layer.clone(),
            crs: self.crs.clone(),
            regions: self.regions.meant(),
            disk_radius_m,
            min_peaks: self.min_peaks,
            min_prominence_m,
            forest: ForestOptions { trees: self.trees, seed: self.seed },
            output: self.output.clone(),
            disks: self.disks.clone(),
            overwrite: self.out.overwrite,
        })
    }

    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        let job = self.meant()?;
        job.peaks.iter().for_each(|input| reporter.input(&input.path));
        let report = watched(reporter, |watch, reporter| train(&job, watch, &mut |text| reporter.warn(text)))?;
        reporter.outputs(&report.outputs);
        reporter.say(&text(&report))?;
        Ok(json(&report))
    }
}

/// What a --peaks means: a class and a path, or a path alone.
fn input(text: &str) -> Result<PeaksInput> {
    match text.split_once('=') {
        // A folder may have this sign in its name; a class has no slash.
        Some((name, path)) if !name.contains(['/', '\\']) => match (name.trim(), path) {
            ("", _) | (_, "") => Err(Error::usage(format!("--peaks {text}: expected NAME=FILE, or a file alone"))),
            (name, path) => Ok(PeaksInput { class: Some(name.into()), path: path.into() }),
        },
        _ => Ok(PeaksInput { class: None, path: text.into() }),
    }
}

fn percent(share: Option<f64>) -> String {
    share.map_or("not known".into(), |share| format!("{:.1} %", 100.0 * share))
}

fn text(report: &TrainReport) -> String {
    let classes = &report.model.classes;
    let disks: usize = classes.iter().map(|class| class.disks).sum();
    let mut text = format!("{disks} disks of {} classes, {} trees\n", classes.len(), report.model.forest.trees().len());
    if report.held_out.total() > 0 {
        let wide = width(classes.iter().map(|class| class.name.as_str()), 8);
        let column = report.held_out.counts().iter().flatten().map(|count| count.to_string().len()).fold(3, usize::max);
        // Writing to a String cannot fail.
        let _ = write!(text, "held out: of each class (row), told to be of each (column)\n{:wide$}   disks", "");
        (1..=classes.len()).for_each(|number| {
            let _ = write!(text, "  {number:>column$}");
        });
        text.push('\n');
        for (i, (class, row)) in classes.iter().zip(report.held_out.counts()).enumerate() {
            let _ = write!(text, "{:wide$} {:>2} {:>5}", class.name, i + 1, class.disks);
            row.iter().for_each(|count| {
                let _ = write!(text, "  {count:>column$}");
            });
            text.push('\n');
        }
    }
    let _ = writeln!(
        text,
        "accuracy: held out {} (of {} answers, {} cuts), out of bag {}",
        percent(report.held_out.accuracy()),
        report.held_out.total(),
        report.cuts,
        percent(report.out_of_bag.accuracy())
    );
    text
}

fn json(report: &TrainReport) -> Value {
    let table =
        |table: &Confusion| json!({ "accuracy": table.accuracy(), "answers": table.total(), "confusion": table });
    json!({
        "classes": report.model.classes,
        "conditions": report.model.conditions,
        "trees": report.model.forest.trees().len(),
        "cuts": report.cuts,
        "held_out": table(&report.held_out),
        "out_of_bag": table(&report.out_of_bag),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_paths() {
        let meant = |text| input(text).map(|input| (input.class, input.path.display().to_string()));
        assert_eq!(meant("Alps=a.gpkg").unwrap(), (Some("Alps".into()), "a.gpkg".into()));
        assert_eq!(meant("Alps=x=1/a.gpkg").unwrap(), (Some("Alps".into()), "x=1/a.gpkg".into()));
        assert_eq!(meant("a.gpkg").unwrap(), (None, "a.gpkg".into()));
        assert_eq!(meant("./x=1/a.gpkg").unwrap(), (None, "./x=1/a.gpkg".into()));
        assert!(meant("=a.gpkg").is_err() && meant("Alps=").is_err());
    }
}
