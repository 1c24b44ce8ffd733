//! `orograph encode`.

use super::container_text::{band_lines, bands_json, size_text};
use super::progress::watched;
use super::report::Reporter;
use super::shared::{CommonOptions, MemoryOptions, OutputOptions, named_oro, unit_of};
use super::sparse::{PatchOptions, StoredInput, sparse_json, sparse_text};
use super::wrong_value;
use crate::error::{Error, Result};
use crate::pipeline::archive::encode::{EncodeJob, EncodeReport, run};
use crate::pipeline::archive::{Promise, Target};
use crate::pipeline::sparse::encode::{self as sparse, SparseJob};
use crate::units::parse_length_m;
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Put a raster into an .oro container: as small as it gets, with an error that is never exceeded.
///
/// Integers come back bit for bit unless --max-error allows more; floats need one of the two options. Cells without
/// data come back as they were in any case. Type, scale, offset, unit, nodata, CRS, epoch, geotransform and metadata
/// are kept; colour tables and statistics are not. Every tile is decoded and compared before it is written.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  orograph encode fixtures/jacksboro.tif jacksboro.oro\n  \
                        orograph encode fixtures/jacksboro.tif small.oro --max-error 2m\n  \
                        orograph encode fixtures/jacksboro.tif sparse.oro --sparse --atoms 64")]
pub(super) struct Encode {
    /// Raster: any that GDAL reads, or another .oro file.
    #[arg(value_name = "DEM")]
    input: PathBuf,
    /// Output: an .oro file, or - for standard output.
    #[arg(value_name = "OUT.oro")]
    output: PathBuf,
    /// Keep every bit of every cell.
    #[arg(long, conflicts_with_all = ["max_error", "sparse"])]
    lossless: bool,
    /// Greatest error of a cell; a bare number is metres, or the band's own unit where that is no length.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true, conflicts_with = "sparse")]
    max_error: Option<String>,
    /// Describe the terrain as patches of a dictionary (the sparse profile): small and rebuilt at any resolution, with
    /// the error that comes of it. 32-bit floats of one band are kept.
    #[arg(long)]
    sparse: bool,
    #[command(flatten)]
    patches: PatchOptions,
    /// A dictionary that orograph learn made, or another .oro file of the sparse profile; learned from the raster
    /// unless given.
    #[arg(long, value_name = "FILE.oro", requires = "sparse", conflicts_with = "atoms", help_heading = "Patches")]
    dictionary: Option<PathBuf>,
    /// Side of the tiles in cells: a multiple of 64 up to 4096 [default: about 1024 with no narrow tile at the edges, less for longitudes and latitudes coarser than 1']
    #[arg(long, value_name = "CELLS")]
    tile_size: Option<usize>,
    #[command(flatten)]
    raster: StoredInput,
    #[command(flatten)]
    out: OutputOptions,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Encode {
    fn meant(&self) -> Result<EncodeJob> {
        let promise = match &self.max_error {
            Some(text) => promise_of(text)?,
            None if self.lossless => Promise::Lossless,
            None => Promise::Unsaid,
        };
        self.patches.only_with(self.sparse, "--sparse")?;
        Ok(EncodeJob {
            input: self.input.clone(),
            raster: self.raster.meant()?,
            unit: unit_of(self.raster.vertical_unit.as_deref())?,
            promise,
            tile_side: self.tile_size,
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
        if !is_stream {
            named_oro(&self.output)?;
        }
        let sparse = self.sparse.then(|| self.sparse_job(&job));
        let told = watched(reporter, |watch, reporter| {
            let mut stdout = std::io::stdout();
            let target = match is_stream {
                true => Target::Stream(&mut stdout),
                false => Target::File { path: self.output.clone(), overwrite: self.out.overwrite },
            };
            let warn = &mut |text: &str| reporter.warn(text);
            match &sparse {
                Some(sparse) => Ok(sparse::run(sparse, target, watch, warn)?
                    .map(|report| (sparse_text(&report), sparse_json(&report)))),
                None => Ok(run(&job, target, watch, warn)?.map(|report| (text(&report), json(&report)))),
            }
        })?;
        let Some((text, json)) = told else { return Ok(Value::Null) };
        if is_stream {
            // Standard output is taken.
            reporter.remark(text.trim_end());
        } else {
            reporter.outputs(std::slice::from_ref(&self.output));
            reporter.say(&text)?;
        }
        Ok(json)
    }

    fn sparse_job(&self, job: &EncodeJob) -> SparseJob {
        SparseJob {
            input: job.input.clone(),
            raster: job.raster.clone(),
            unit: job.unit.clone(),
            model: self.patches.meant(),
            dictionary: self.dictionary.clone(),
            tile_side: job.tile_side,
            memory: job.memory,
        }
    }
}

fn promise_of(text: &str) -> Result<Promise> {
    if let Ok(number) = text.trim().parse() {
        return Ok(Promise::MaxError { number, metres: None });
    }
    let metres = parse_length_m(text).map_err(|error| wrong_value("--max-error", &error))?;
    Ok(Promise::MaxError { number: metres, metres: Some(metres) })
}

fn text(report: &EncodeReport) -> String {
    let description = &report.description;
    let tiles = description.tiling().tiles();
    let mut text = format!(
        "{} x {} cells in {} {}: {} of {} ({:.1} times smaller), {:.3} bits a cell, {:.1} s\n",
        description.width,
        description.height,
        tiles,
        if tiles == 1 { "tile" } else { "tiles" },
        size_text(report.summary.bytes),
        size_text(report.raw_bytes),
        report.raw_bytes as f64 / report.summary.bytes as f64,
        report.bits_per_cell(),
        report.time.as_secs_f64(),
    );
    text += &band_lines(description, Some(&report.summary.largest_errors));
    text
}

fn json(report: &EncodeReport) -> Value {
    let description = &report.description;
    json!({
        "cols": description.width,
        "rows": description.height,
        "tile_size": description.tile_side,
        "tiles": description.tiling().tiles(),
        "cells": report.cells(),
        "bytes": report.summary.bytes,
        "cell_bytes": report.summary.chunk_bytes,
        "raw_bytes": report.raw_bytes,
        "ratio": report.raw_bytes as f64 / report.summary.bytes as f64,
        "bits_per_cell": report.bits_per_cell(),
        "lossless": report.is_lossless(),
        "bands": bands_json(description, Some(&report.summary.largest_errors)),
        "seconds": report.time.as_secs_f64(),
    })
}
