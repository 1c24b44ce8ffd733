//! `orograph encode`.

use super::container_text::{band_lines, bands_json, size_text};
use super::progress::watched;
use super::report::Reporter;
use super::shared::{CommonOptions, MemoryOptions, OutputOptions, PartOptions, unit_of};
use super::wrong_value;
use crate::error::{Error, Result};
use crate::io::raster::stored::StoredOptions;
use crate::pipeline::archive::encode::{EncodeJob, EncodeReport, run};
use crate::pipeline::archive::{Promise, Target};
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
                        orograph encode fixtures/jacksboro.tif small.oro --max-error 2m")]
pub(super) struct Encode {
    /// Raster: any that GDAL reads, or another .oro file.
    #[arg(value_name = "DEM")]
    input: PathBuf,
    /// Output: an .oro file, or - for standard output.
    #[arg(value_name = "OUT.oro")]
    output: PathBuf,
    /// Keep every bit of every cell.
    #[arg(long, conflicts_with = "max_error")]
    lossless: bool,
    /// Greatest error of a cell; a bare number is metres, or the band's own unit where that is no length.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    max_error: Option<String>,
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

/// What to read of a raster that is kept as it is.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Input")]
struct StoredInput {
    /// Band to read, from 1; may be given several times. All unless given.
    #[arg(long = "band", value_name = "N")]
    bands: Vec<usize>,
    /// Value of cells without data; replaces a declared one.
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true)]
    nodata: Option<f64>,
    /// CRS that replaces the input's: EPSG:2056, WKT, a PROJ string.
    #[arg(long, value_name = "CRS")]
    crs: Option<String>,
    /// Unit of the elevations: m, ft, us-ft, dm, cm, ...; replaces a declared one.
    #[arg(long, value_name = "UNIT")]
    vertical_unit: Option<String>,
    #[command(flatten)]
    part: PartOptions,
}

impl Encode {
    fn meant(&self) -> Result<EncodeJob> {
        let (window, bbox) = self.raster.part.meant()?;
        let promise = match &self.max_error {
            Some(text) => promise_of(text)?,
            None if self.lossless => Promise::Lossless,
            None => Promise::Unsaid,
        };
        Ok(EncodeJob {
            input: self.input.clone(),
            raster: StoredOptions {
                bands: self.raster.bands.clone(),
                nodata: self.raster.nodata,
                crs: self.raster.crs.clone(),
                window,
                bbox,
            },
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
        if !is_stream && !self.output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("oro")) {
            return Err(Error::usage("the output is an .oro file: name it so").at_path(&self.output));
        }
        let report = watched(reporter, |watch, reporter| {
            let mut stdout = std::io::stdout();
            let target = match is_stream {
                true => Target::Stream(&mut stdout),
                false => Target::File { path: self.output.clone(), overwrite: self.out.overwrite },
            };
            run(&job, target, watch, &mut |text| reporter.warn(text))
        })?;
        let Some(report) = report else { return Ok(Value::Null) };
        if is_stream {
            // Standard output is taken.
            reporter.remark(text(&report).trim_end());
        } else {
            reporter.outputs(std::slice::from_ref(&self.output));
            reporter.say(&format!("{}written: {}\n", text(&report), self.output.display()))?;
        }
        Ok(json(&report))
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
