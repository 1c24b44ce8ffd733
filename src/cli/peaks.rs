//! `orograph peaks`.

use super::progress::watched;
use super::report::Reporter;
use super::shared::{CommonOptions, InputOptions, MemoryOptions, OutputOptions};
use super::tags::{NameOptions, RegionOptions};
use super::wrong_value;
use crate::error::{Error, Result};
use crate::orometry::SurveyOptions;
use crate::pipeline::layers::{LengthOutput, NAMES};
use crate::pipeline::peaks::{PeaksJob, PeaksReport, run};
use crate::pipeline::{Distance, TagOptions};
use crate::units::parse_length_m;
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Find the peaks of a DEM with their prominence, isolation and divide tree.
///
/// OUT.gpkg holds the layers peaks, saddles, divide_tree and isolation, styled for QGIS. With the extension .csv,
/// .geojson or .fgb each layer becomes a file of its own, OUT_LAYER.csv, or OUT.csv where --layers names just one.
/// Lengths take a unit (30m, 100ft, 1.5km); a bare number is metres.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Example:\n  orograph peaks fixtures/jacksboro.tif peaks.gpkg --min-prominence 30m")]
pub(super) struct Peaks {
    /// Elevation model: any raster that GDAL reads, or an .oro file.
    #[arg(value_name = "DEM")]
    input: PathBuf,
    /// Output: .gpkg, .csv, .geojson or .fgb.
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Least prominence of a peak.
    #[arg(long, value_name = "LENGTH", default_value = "30m", allow_hyphen_values = true)]
    min_prominence: String,
    /// Least isolation of the peaks that are written; the highest has none and is always written.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    min_isolation: Option<String>,
    /// Count saddles below this elevation as if they were at it.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    base_level: Option<String>,
    /// Cells without data are sea: known, and lower than everything.
    #[arg(long)]
    nodata_is_sea: bool,
    /// Only peaks whose prominence and isolation nothing beyond the edge or in voids could change.
    #[arg(long)]
    certain_only: bool,
    /// Do not measure isolation.
    #[arg(long)]
    no_isolation: bool,
    /// Where distances are measured: in the CRS's own way (crs), or always on the ellipsoid (geodesic).
    #[arg(long, value_name = "HOW", value_parser = ["crs", "geodesic"], default_value = "crs")]
    distance: String,
    /// Layers to write, with commas between them; all unless given.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    layers: Option<Vec<String>>,
    /// Unit of lengths in the output, and in its field names.
    #[arg(long, value_name = "UNIT", value_parser = ["m", "ft"], default_value = "m")]
    output_unit: String,
    #[command(flatten)]
    regions: RegionOptions,
    #[command(flatten)]
    names: NameOptions,
    #[command(flatten)]
    raster: InputOptions,
    #[command(flatten)]
    out: OutputOptions,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Peaks {
    fn meant(&self) -> Result<PeaksJob> {
        let length = |option: &str, text: &str| parse_length_m(text).map_err(|error| wrong_value(option, &error));
        let min_prominence_m = length("--min-prominence", &self.min_prominence)?;
        if min_prominence_m < 0.0 {
            return Err(Error::usage(format!("--min-prominence {}: expected 0 or more", self.min_prominence)));
        }
        let min_isolation_m = self.min_isolation.as_deref().map(|text| length("--min-isolation", text)).transpose()?;
        if min_isolation_m.is_some() && self.no_isolation {
            return Err(Error::usage("--min-isolation and --no-isolation cannot be given together"));
        }
        let layers = match &self.layers {
            Some(layers) => layers.clone(),
            None => NAMES
                .iter()
                .filter(|name| !(self.no_isolation && **name == "isolation"))
                .map(ToString::to_string)
                .collect(),
        };
        if let Some(unknown) = layers.iter().find(|layer| !NAMES.contains(&layer.as_str())) {
            return Err(Error::usage(format!(
                "--layers: there is no layer '{unknown}'; there are {}",
                NAMES.join(", ")
            )));
        }
        let wants = |layer: &str| layers.iter().any(|l| l == layer);
        if self.no_isolation && wants("isolation") {
            return Err(Error::usage("--no-isolation: the layer isolation cannot be written without it"));
        }
        let base_level_m = self.base_level.as_deref().map(|text| length("--base-level", text)).transpose()?;
        Ok(PeaksJob {
            input: self.input.clone(),
            raster: self.raster.meant()?,
            output: self.output.clone(),
            overwrite: self.out.overwrite,
            survey: SurveyOptions {
                min_prominence_m,
                base_level_m,
                nodata_is_sea: self.nodata_is_sea,
                isolation: !self.no_isolation,
                ridges: wants("divide_tree"),
                min_isolation_m: min_isolation_m.unwrap_or(0.0),
                certain_only: self.certain_only,
                ..SurveyOptions::default()
            },
            distance: if self.distance == "geodesic" { Distance::Geodesic } else { Distance::Crs },
            tags: TagOptions { regions: self.regions.meant(), names: self.names.meant()? },
            layers,
            unit: if self.output_unit == "ft" { LengthOutput::Feet } else { LengthOutput::Metres },
            memory: self.memory.bytes()?,
            command: self.words().join(" "),
        })
    }

    /// The command without what changes no result.
    fn words(&self) -> Vec<String> {
        let mut words = vec!["orograph".into(), "peaks".into(), self.input.display().to_string()];
        let mut put = |option: &str, value: Option<&str>| {
            words.push(option.to_string());
            words.extend(value.map(ToString::to_string));
        };
        put("--min-prominence", Some(&self.min_prominence));
        for (option, value) in [("--min-isolation", &self.min_isolation), ("--base-level", &self.base_level)] {
            if value.is_some() {
                put(option, value.as_deref());
            }
        }
        for (option, given) in [
            ("--nodata-is-sea", self.nodata_is_sea),
            ("--certain-only", self.certain_only),
            ("--no-isolation", self.no_isolation),
        ] {
            if given {
                put(option, None);
            }
        }
        if self.distance != "crs" {
            put("--distance", Some(&self.distance));
        }
        if self.output_unit != "m" {
            put("--output-unit", Some(&self.output_unit));
        }
        words.extend(self.regions.words());
        words.extend(self.names.words());
        words.extend(self.raster.words());
        words
    }

    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        reporter.input(&self.input);
        let job = self.meant()?;
        let report = watched(reporter, |watch, reporter| run(&job, watch, &mut |text| reporter.warn(text)))?;
        reporter.outputs(&report.outputs);
        let [read, measured, written] = report.times.map(|time| time.as_secs_f64());
        reporter.remark(&format!("read {read:.3} s, measured {measured:.3} s, written {written:.3} s"));
        if !reporter.is_json() {
            reporter.say(&text(&job, &report))?;
        }
        Ok(json(&job, &report))
    }
}

fn text(job: &PeaksJob, report: &PeaksReport) -> String {
    use std::fmt::Write;
    let unit = job.unit;
    let suffix = unit.suffix();
    let mut text = String::new();
    let peaks = &report.survey.peaks;
    let _ = writeln!(
        text,
        "{} peaks with a prominence of at least {} {suffix} (of {} local peaks in {} x {} cells)",
        peaks.len(),
        unit.of(job.survey.min_prominence_m),
        report.survey.local_peaks,
        report.size.1,
        report.size.0
    );
    let _ = writeln!(
        text,
        "{:>4} {:>12} {:>12} {:>14}  {:<24} name",
        "id",
        format!("elevation {suffix}"),
        "prominence",
        "isolation km",
        "x y"
    );
    for (i, peak) in peaks.iter().take(10).enumerate() {
        let isolation_km = peak.isolation.as_ref().and_then(|isolation| isolation.isolation_m);
        let uncertain = if peak.prominence_certain { ' ' } else { '?' };
        let (x, y) = report.points[i];
        let name = report.tags.get(i).and_then(|tags| tags.name.as_deref()).unwrap_or("");
        let line = format!(
            "{:>4} {:>12} {:>11}{uncertain} {:>14}  {:<24} {name}",
            peak.id,
            round(unit.of(peak.elevation_m)),
            round(unit.of(peak.prominence_m)),
            isolation_km.map_or("-".into(), |m| format!("{:.3}", m / 1000.0)),
            format!("{} {}", coordinate(x), coordinate(y)),
        );
        let _ = writeln!(text, "{}", line.trim_end());
    }
    if peaks.iter().take(10).any(|peak| !peak.prominence_certain) {
        let _ = writeln!(text, "? terrain beyond the edge or in voids could make it lower: see prominence_min");
    }
    text
}

fn round(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}

/// Degrees to five decimals, larger coordinates to none.
fn coordinate(value: f64) -> String {
    if value.abs() < 1000.0 { format!("{value:.5}") } else { format!("{value:.0}") }
}

fn json(job: &PeaksJob, report: &PeaksReport) -> Value {
    let finite = |value: f64| value.is_finite().then_some(value);
    let top: Vec<Value> = report
        .survey
        .peaks
        .iter()
        .take(10)
        .enumerate()
        .map(|(i, peak)| {
            let tags = report.tags.get(i);
            let isolation = peak.isolation.as_ref();
            json!({
                "id": peak.id,
                "name": tags.and_then(|tags| tags.name.clone()),
                "region": tags.and_then(|tags| tags.region.clone()),
                "row": peak.cell / report.size.1 as u64,
                "col": peak.cell % report.size.1 as u64,
                "elevation_m": peak.elevation_m,
                "prominence_m": peak.prominence_m,
                "prominence_min_m": peak.prominence_min_m,
                "prominence_certain": peak.prominence_certain,
                "is_root": peak.is_root,
                "isolation_m": isolation.and_then(|isolation| isolation.isolation_m),
                "isolation_certain": isolation.map(|isolation| isolation.certain),
                "x": report.points[i].0,
                "y": report.points[i].1,
                "lon": finite(report.lon_lat[i].0),
                "lat": finite(report.lon_lat[i].1),
            })
        })
        .collect();
    let peaks = &report.survey.peaks;
    let [read, measured, written] = report.times.map(|time| time.as_secs_f64());
    json!({
        "rows": report.size.0,
        "cols": report.size.1,
        "cells_with_data": report.size.2,
        "min_prominence_m": job.survey.min_prominence_m,
        "local_peaks": report.survey.local_peaks,
        "peaks": peaks.len(),
        "roots": peaks.iter().filter(|peak| peak.is_root).count(),
        "certain_prominences": peaks.iter().filter(|peak| peak.prominence_certain).count(),
        "edges": report.survey.edges.len(),
        "named": job.tags.names.as_ref().map(|_| report.tags.iter().filter(|tags| tags.name.is_some()).count()),
        "in_regions": job.tags.regions.as_ref().map(|_| report.tags.iter().filter(|tags| tags.region.is_some()).count()),
        "top": top,
        "seconds": { "read": read, "measure": measured, "write": written },
    })
}
