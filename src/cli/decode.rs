//! `orograph decode`.

use super::progress::watched;
use super::report::Reporter;
use super::shared::{CommonOptions, MemoryOptions, OutputOptions, creation_option, part_of};
use crate::error::{Error, Result};
use crate::pipeline::archive::decode::{DecodeJob, DecodeReport, run};
use crate::pipeline::archive::{ContainerOptions, Target};
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Get a raster out of an .oro container: the whole, a part, or a coarser level.
///
/// The format follows from the output's extension, or from --of; `--of raw` writes bare cells, band by band and row by
/// row, little-endian, and also to standard output (-). A coarser level holds every 2nd, 4th, 8th ... cell of every
/// 2nd, 4th, 8th ... row, not averages.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  orograph encode fixtures/jacksboro.tif jacksboro.oro\n  \
                        orograph decode jacksboro.oro jacksboro.tif\n  \
                        orograph decode jacksboro.oro quarter.tif --level 2")]
pub(super) struct Decode {
    /// Container: an .oro file.
    #[arg(value_name = "IN.oro")]
    input: PathBuf,
    /// Output: any raster format that GDAL writes, or - for standard output.
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// GDAL's name of the output's format, or raw; after the extension unless given.
    #[arg(long = "of", value_name = "FORMAT")]
    format: Option<String>,
    /// Option of the output's format; may be given several times.
    #[arg(long = "co", value_name = "KEY=VALUE")]
    options: Vec<String>,
    /// Band to write, from 1; may be given several times. All unless given.
    #[arg(long = "band", value_name = "N")]
    bands: Vec<usize>,
    /// Write a part: first column, first row, columns, rows, counted at full resolution whatever the level.
    #[arg(long, value_name = "COL,ROW,WIDTH,HEIGHT", value_delimiter = ',', num_args = 1)]
    window: Option<Vec<usize>>,
    /// Write the cells inside a box, in the raster's CRS.
    #[arg(long, value_name = "XMIN,YMIN,XMAX,YMAX", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    bbox: Option<Vec<f64>>,
    /// Write a coarser level: every 2^N-th cell of every 2^N-th row.
    #[arg(long, value_name = "N", default_value_t = 0)]
    level: u8,
    /// Go on where tiles are damaged: their cells become nodata, or 0 where there is none; the exit code is then 1.
    #[arg(long)]
    keep_going: bool,
    #[command(flatten)]
    out: OutputOptions,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Decode {
    fn meant(&self) -> Result<DecodeJob> {
        let (window, bbox) = part_of(self.window.as_deref(), self.bbox.as_deref())?;
        let part =
            ContainerOptions { bands: self.bands.clone(), window, bbox, level: self.level, ..Default::default() };
        Ok(DecodeJob {
            input: self.input.clone(),
            part,
            format: self.format.clone(),
            options: self.options.iter().map(creation_option).collect::<Result<_>>()?,
            keep_going: self.keep_going,
            memory: self.memory.bytes()?,
        })
    }

    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        reporter.input(&self.input);
        let job = self.meant()?;
        let is_stream = self.output.as_os_str() == "-";
        if is_stream && reporter.is_json() {
            return Err(Error::usage("--json and the output - cannot be given together: both go to standard output"));
        }
        let report = watched(reporter, |watch, reporter| {
            let mut stdout = std::io::stdout();
            let target = match is_stream {
                true => Target::Stream(&mut stdout),
                false => Target::File { path: self.output.clone(), overwrite: self.out.overwrite },
            };
            run(&job, target, watch, &mut |text| reporter.warn(text))
        })?;
        for fault in &report.damaged {
            reporter.warn(&format!("damaged, and left without data: {fault}"));
        }
        if !report.damaged.is_empty() {
            reporter.answer = 1;
        }
        reporter.outputs(&report.outputs);
        if is_stream {
            // Standard output is taken.
            reporter.remark(text(&report).trim_end());
        } else {
            reporter.say(&text(&report))?;
        }
        Ok(json(&report, self.level))
    }
}

fn text(report: &DecodeReport) -> String {
    let (cols, rows, bands) = report.size;
    let several = if bands > 1 { format!(" in {bands} bands") } else { String::new() };
    let seconds = report.time.as_secs_f64();
    format!("{cols} x {rows} cells{several} as {}, {seconds:.1} s\n", report.format)
}

fn json(report: &DecodeReport, level: u8) -> Value {
    let (cols, rows, bands) = report.size;
    json!({
        "cols": cols,
        "rows": rows,
        "bands": bands,
        "level": level,
        "format": report.format,
        "damaged": report.damaged,
        "seconds": report.time.as_secs_f64(),
    })
}
