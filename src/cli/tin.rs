//! `orograph tin`.

use super::exactness::{ExactnessOptions, error_text_m};
use super::progress::watched;
use super::report::Reporter;
use super::shared::{CommonOptions, InputOptions, MemoryOptions, OutputOptions};
use crate::error::Result;
use crate::pipeline::tin::{LineSource, TinJob, TinReport, run};
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Triangulate a DEM: few triangles where it is smooth, many where it is rough, none where it has no data.
///
/// No cell is further from the triangles, straight up or down, than --max-error. Cells beside voids are vertices, so
/// coasts keep their shape. Meshes (.obj, .ply, .glb) are in metres: in the raster's own projection, or, where it has
/// longitudes and latitudes, on a plane that touches the Earth in its middle. .obj and .glb are relative to an origin
/// that they state, for the programs that read them have single precision; .ply has the coordinates as they are. A .gpkg
/// has a layer of triangles with z, in the raster's own CRS, styled for QGIS.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  orograph tin fixtures/jacksboro.tif jacksboro.glb --max-error 10m\n  \
                        orograph tin fixtures/jacksboro.tif triangles.gpkg --max-vertices 2000")]
pub(super) struct Tin {
    /// Elevation model: any raster that GDAL reads, or an .oro file.
    #[arg(value_name = "DEM")]
    input: PathBuf,
    /// Output: .obj, .ply, .glb or .gpkg.
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    exactness: ExactnessOptions,
    /// Lines that are to be edges: ridges, rivers, roads; outlines of polygons too. Any vector layer that GDAL reads.
    #[arg(long, value_name = "FILE", conflicts_with = "regular")]
    lines: Option<PathBuf>,
    /// Layers of the lines, with commas between them; divide_tree where there is one, else all.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "lines")]
    line_layers: Option<Vec<String>>,
    #[command(flatten)]
    raster: InputOptions,
    #[command(flatten)]
    out: OutputOptions,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Tin {
    fn meant(&self) -> Result<TinJob> {
        let lines = self.lines.as_ref().map(|path| LineSource { path: path.clone(), layers: self.line_layers.clone() });
        Ok(TinJob {
            input: self.input.clone(),
            raster: self.raster.meant()?,
            output: self.output.clone(),
            overwrite: self.out.overwrite,
            exactness: self.exactness.meant()?,
            lines,
            memory: self.memory.bytes()?,
            command: self.words().join(" "),
        })
    }

    /// The command without what changes no result.
    fn words(&self) -> Vec<String> {
        let mut words = vec!["orograph".into(), "tin".into(), self.input.display().to_string()];
        let mut put = |option: &str, value: Option<String>| {
            if let Some(value) = value {
                words.extend([option.to_string(), value]);
            }
        };
        put("--lines", self.lines.as_ref().map(|path| path.display().to_string()));
        put("--line-layers", self.line_layers.as_ref().map(|layers| layers.join(",")));
        words.extend(self.exactness.words());
        words.extend(self.raster.words());
        words
    }

    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        reporter.input(&self.input);
        if let Some(lines) = &self.lines {
            reporter.input(lines);
        }
        let job = self.meant()?;
        let report = watched(reporter, |watch, reporter| run(&job, watch, &mut |text| reporter.warn(text)))?;
        reporter.outputs(std::slice::from_ref(&job.output));
        let [read, triangulated, written] = report.times.map(|time| time.as_secs_f64());
        reporter.remark(&format!("read {read:.3} s, triangulated {triangulated:.3} s, written {written:.3} s"));
        reporter.say(&text(&report))?;
        Ok(json(&report))
    }
}

fn text(report: &TinReport) -> String {
    let ((rows, cols, _), (vertices, triangles)) = (report.size, report.mesh);
    let share = 100.0 * vertices as f64 / report.size.2 as f64;
    let mut text = format!(
        "{vertices} vertices ({share:.1} % of the cells) and {triangles} triangles of {cols} x {rows} cells, greatest error {} m\n",
        error_text_m(report.error_m)
    );
    let [x, y, _] = report.origin;
    if x != 0.0 || y != 0.0 {
        text += &format!("coordinates are relative to {x}, {y}\n");
    }
    if report.plane.is_some() {
        text += "coordinates are metres east and north of the raster's middle\n";
    }
    text
}

fn json(report: &TinReport) -> Value {
    let [read, triangulated, written] = report.times.map(|time| time.as_secs_f64());
    json!({
        "rows": report.size.0,
        "cols": report.size.1,
        "cells_with_data": report.size.2,
        "vertices": report.mesh.0,
        "triangles": report.mesh.1,
        "error_m": report.error_m,
        "cells_left_out": report.uncovered,
        "line_edges": report.line_edges,
        "origin": report.origin,
        "plane": report.plane,
        "seconds": { "read": read, "triangulate": triangulated, "write": written },
    })
}
