//! `orograph scene eval`.

use super::super::progress::watched;
use super::super::report::Reporter;
use super::super::shared::{MemoryOptions, OutputOptions, creation_option};
use super::{CellArguments, CommonOptions, DetailArguments};
use crate::error::Result;
use crate::grid::SampleType;
use crate::pipeline::scene::eval::{EvalJob, EvalReport, run};
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Make a raster of a scene: elevations in metres, nodata where no terrain is defined.
///
/// Files that lie in another CRS than the scene are brought into it; feet become metres. The raster is made strip by
/// strip, so it may be larger than memory; the scene's own rasters are kept in memory.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  orograph scene eval fixtures/scenes/valley.json valley.tif\n  \
                        orograph scene eval fixtures/scenes/craters.json part.tif --resolution 5m --bbox 0,0,900,900\n  \
                        orograph scene eval fixtures/scenes/ranges.json r.tif --resolution 50m --detail-around 0,0,9,9000")]
pub(super) struct Eval {
    /// Scene: a JSON file.
    #[arg(value_name = "SCENE.json")]
    scene: PathBuf,
    /// Output: any raster format that GDAL writes.
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    cells: CellArguments,
    #[command(flatten)]
    detail: DetailArguments,
    /// Make a layer of the scene, such as its water, in place of the terrain.
    #[arg(long, value_name = "NAME", help_heading = "Output")]
    layer: Option<String>,
    /// GDAL's name of the output's format; after the extension unless given.
    #[arg(long = "of", value_name = "FORMAT", help_heading = "Output")]
    format: Option<String>,
    /// Option of the output's format; may be given several times.
    #[arg(long = "co", value_name = "KEY=VALUE", help_heading = "Output")]
    options: Vec<String>,
    /// Write double precision.
    #[arg(long, help_heading = "Output")]
    double: bool,
    /// Value of cells without terrain.
    #[arg(long, value_name = "VALUE", default_value_t = -32768.0, allow_hyphen_values = true, help_heading = "Output")]
    nodata: f64,
    #[command(flatten)]
    out: OutputOptions,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Eval {
    fn meant(&self) -> Result<EvalJob> {
        Ok(EvalJob {
            scene: self.scene.clone(),
            output: self.output.clone(),
            overwrite: self.out.overwrite,
            format: self.format.clone(),
            options: self.options.iter().map(creation_option).collect::<Result<_>>()?,
            cells: self.cells.meant()?,
            layer: self.layer.clone(),
            detail: self.detail.meant()?,
            sample: if self.double { SampleType::F64 } else { SampleType::F32 },
            nodata: self.nodata,
            memory: self.memory.bytes()?,
        })
    }

    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        reporter.input(&self.scene);
        let job = self.meant()?;
        let report = watched(reporter, |watch, reporter| run(&job, watch, &mut |text| reporter.warn(text)))?;
        report.inputs.iter().for_each(|input| reporter.input(input));
        reporter.outputs(&report.outputs);
        let [read, evaluated] = report.times.map(|time| time.as_secs_f64());
        reporter.remark(&format!("read {read:.3} s, evaluated and written {evaluated:.3} s"));
        reporter.say(&text(&report))?;
        Ok(json(&report))
    }
}

fn text(report: &EvalReport) -> String {
    let lattice = &report.cells.lattice;
    let (cols, rows, cell) = (lattice.cols, lattice.rows, lattice.dx);
    let (low, high) = report.range_m;
    let seconds: f64 = report.times.iter().map(|time| time.as_secs_f64()).sum();
    let voids = cols as u64 * rows as u64 - report.defined;
    let mut text = format!("{cols} x {rows} cells of {cell} m as {}, {seconds:.1} s\n", report.format);
    text += &format!("{low:.2} to {high:.2} m, {voids} cells without terrain\n");
    text
}

fn json(report: &EvalReport) -> Value {
    let [read, evaluated] = report.times.map(|time| time.as_secs_f64());
    json!({
        "rows": report.cells.lattice.rows,
        "cols": report.cells.lattice.cols,
        "geotransform": report.cells.transform.0,
        "crs": report.crs,
        "cells_with_terrain": report.defined,
        "elevation_min_m": report.range_m.0,
        "elevation_max_m": report.range_m.1,
        "format": report.format,
        "seconds": { "read": read, "evaluate": evaluated },
    })
}
