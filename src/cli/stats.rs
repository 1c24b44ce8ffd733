//! `orograph stats`.

use super::progress::watched;
use super::report::Reporter;
use super::shared::{CommonOptions, InputOptions, MemoryOptions, OutputOptions};
use super::stats_text::{distances, statistics};
use super::tags::RegionOptions;
use super::wrong_value;
use crate::error::{Error, Result};
use crate::orometry::distributions::{BinSet, parse_disk};
use crate::pipeline::Distance;
use crate::pipeline::stats::{DiskWords, StatsJob, StatsReport, run};
use crate::units::parse_length_m;
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Count the peaks of a DEM, or of a layer of peaks, in the histograms of Argudo et al. 2019; compare two.
///
/// An input is a DEM, a layer of peaks that `orograph peaks` wrote (.gpkg, .geojson, .fgb, .csv), or statistics that
/// this verb wrote (.json). A DEM also has slopes, hypsometry and an area. Two inputs are compared: Earth Mover's
/// Distances (round the circle for directions), largest differences of a bin, total variations. Without --output a
/// table is printed. Lengths take a unit (30m, 100ft, 1.5km); a bare number is metres.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  orograph stats fixtures/jacksboro.tif\n  \
    orograph stats fixtures/jacksboro.tif -o stats.json -o chart.svg --disk -84.3,36.4,15km")]
pub(super) struct Stats {
    /// DEM, layer of peaks or statistics file; two of them are compared.
    #[arg(value_name = "INPUT", required = true, num_args = 1..=2)]
    inputs: Vec<PathBuf>,
    /// Output, as often as needed: .json (statistics), .csv (the histograms, or the distances of two inputs), .svg or
    /// .png (chart).
    #[arg(short, long = "output", value_name = "FILE")]
    outputs: Vec<PathBuf>,
    /// Bins that are compared, drawn and printed: those of the paper's table 1, or finer ones. Files hold both.
    #[arg(long, value_name = "BINS", value_parser = ["paper", "fine"], default_value = "paper")]
    bins: String,
    /// Least prominence of the peaks that are counted: 30m for a DEM unless given, for a layer that of its peaks.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    min_prominence: Option<String>,
    /// Radius R that distances are divided by; longer ones count in the last bin. 30km unless given, or what a
    /// statistics file that is compared has.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    radius: Option<String>,
    /// Count the peaks within a radius of a place too, as often as needed: LON,LAT,RADIUS. In a projected CRS X,Y,RADIUS
    /// where the two are no longitude and latitude.
    #[arg(long = "disk", value_name = "X,Y,RADIUS", allow_hyphen_values = true)]
    disks: Vec<String>,
    /// Whole, region or disk to draw and to compare; given twice, that of the first and of the second input.
    #[arg(long = "domain", value_name = "NAME")]
    domains: Vec<String>,
    /// Layer of the peaks, where a file has several.
    #[arg(long, value_name = "LAYER")]
    layer: Option<String>,
    /// Where a DEM's distances are measured: in the CRS's own way (crs), or always on the ellipsoid (geodesic).
    #[arg(long, value_name = "HOW", value_parser = ["crs", "geodesic"], default_value = "crs")]
    distance: String,
    #[command(flatten)]
    regions: RegionOptions,
    #[command(flatten)]
    raster: InputOptions,
    #[command(flatten)]
    out: OutputOptions,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Stats {
    fn meant(&self) -> Result<StatsJob> {
        let length = |option: &str, text: &Option<String>| {
            text.as_deref().map(|text| parse_length_m(text).map_err(|error| wrong_value(option, &error))).transpose()
        };
        let min_prominence_m = length("--min-prominence", &self.min_prominence)?;
        if min_prominence_m.is_some_and(|m| m < 0.0) {
            return Err(Error::usage("--min-prominence: expected 0 or more"));
        }
        let radius_m = length("--radius", &self.radius)?;
        if radius_m.is_some_and(|m| m <= 0.0) {
            return Err(Error::usage("--radius: expected more than 0"));
        }
        let disk = |text: &String| {
            let (x, y, radius_m) = parse_disk(text).map_err(|error| wrong_value("--disk", &error))?;
            Ok(DiskWords { name: text.clone(), x, y, radius_m })
        };
        if self.inputs.len() == 2 && self.domains.len() > 2 {
            return Err(Error::usage("--domain: of two inputs one domain each is compared"));
        }
        Ok(StatsJob {
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
            overwrite: self.out.overwrite,
            raster: self.raster.meant()?,
            layer: self.layer.clone(),
            distance: if self.distance == "geodesic" { Distance::Geodesic } else { Distance::Crs },
            min_prominence_m,
            radius_m,
            bins: self.bins(),
            regions: self.regions.meant(),
            disks: self.disks.iter().map(disk).collect::<Result<_>>()?,
            domains: self.domains.clone(),
            memory: self.memory.bytes()?,
        })
    }

    fn bins(&self) -> BinSet {
        if self.bins == "fine" { BinSet::Fine } else { BinSet::Paper }
    }

    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        self.inputs.iter().for_each(|input| reporter.input(input));
        let job = self.meant()?;
        let report = watched(reporter, |watch, reporter| run(&job, watch, &mut |text| reporter.warn(text)))?;
        reporter.outputs(&report.outputs);
        if !reporter.is_json() {
            reporter.say(&self.text(&report))?;
        }
        Ok(json(&report, self.bins()))
    }

    fn text(&self, report: &StatsReport) -> String {
        let mut text = String::new();
        if report.outputs.is_empty() {
            match &report.documents[..] {
                [document] => text.push_str(&statistics(document, self.bins())),
                documents => text.push_str(&distances(documents, &report.comparisons, self.bins())),
            }
        }
        text
    }
}

fn json(report: &StatsReport, bins: BinSet) -> Value {
    let comparisons: Vec<Value> = report
        .comparisons
        .iter()
        .map(|pair| json!({ "domains": [pair.first, pair.second], "bins": bins.name(), "metrics": pair.metrics }))
        .collect();
    json!({ "statistics": report.documents, "comparisons": comparisons })
}
