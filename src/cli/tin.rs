//! `orograph tin`.

use super::progress::watched;
use super::report::Reporter;
use super::shared::{CommonOptions, InputOptions, MemoryOptions, OutputOptions};
use super::wrong_value;
use crate::error::{Error, Result};
use crate::pipeline::tin::{Exactness, LineSource, TinJob, TinReport, run};
use crate::units::parse_length_m;
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
    /// Greatest vertical distance of a cell from the mesh.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    max_error: Option<String>,
    /// Greatest number of vertices; where they run out the error is larger, and is told.
    #[arg(long, value_name = "N")]
    max_vertices: Option<usize>,
    /// All cells are vertices, in squares of two triangles.
    #[arg(long, conflicts_with_all = ["max_error", "max_vertices", "lines"])]
    regular: bool,
    /// Lines that are to be edges: ridges, rivers, roads; outlines of polygons too. Any vector layer that GDAL reads.
    #[arg(long, value_name = "FILE")]
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
            exactness: self.exactness()?,
            lines,
            memory: self.memory.bytes()?,
            command: self.words().join(" "),
        })
    }

    fn exactness(&self) -> Result<Exactness> {
        if self.regular {
            return Ok(Exactness::Regular);
        }
        let max_error_m = match &self.max_error {
            Some(text) => parse_length_m(text).map_err(|error| wrong_value("--max-error", &error))?,
            // As exact as it gets with so many.
            None if self.max_vertices.is_some() => 0.0,
            None => {
                return Err(Error::usage(
                    "how exact is the mesh to be? Give --max-error (10m), --max-vertices, or --regular for all cells",
                ));
            }
        };
        if max_error_m < 0.0 {
            let given = self.max_error.as_deref().unwrap_or_default();
            return Err(Error::usage(format!("--max-error {given}: expected 0 or more")));
        }
        Ok(Exactness::Refined { max_error_m, max_vertices: self.max_vertices })
    }

    /// The command without what changes no result.
    fn words(&self) -> Vec<String> {
        let mut words = vec!["orograph".into(), "tin".into(), self.input.display().to_string()];
        let mut put = |option: &str, value: Option<String>| {
            if let Some(value) = value {
                words.extend([option.to_string(), value]);
            }
        };
        put("--max-error", self.max_error.clone());
        put("--max-vertices", self.max_vertices.map(|n| n.to_string()));
        put("--lines", self.lines.as_ref().map(|path| path.display().to_string()));
        put("--line-layers", self.line_layers.as_ref().map(|layers| layers.join(",")));
        if self.regular {
            words.push("--regular".into());
        }
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
        reporter.say(&text(&job, &report))?;
        Ok(json(&report))
    }
}

fn text(job: &TinJob, report: &TinReport) -> String {
    let ((rows, cols, _), (vertices, triangles)) = (report.size, report.mesh);
    let share = 100.0 * vertices as f64 / report.size.2 as f64;
    let mut text = format!(
        "{vertices} vertices ({share:.1} % of the cells) and {triangles} triangles of {cols} x {rows} cells, greatest error {} m\n",
        round(report.error_m)
    );
    let [x, y, _] = report.origin;
    if x != 0.0 || y != 0.0 {
        text += &format!("coordinates are relative to {x}, {y}\n");
    }
    if report.plane.is_some() {
        text += "coordinates are metres east and north of the raster's middle\n";
    }
    text + &format!("written: {}\n", job.output.display())
}

/// Rounded up, so that what is told is no less than what is.
fn round(error_m: f64) -> f64 {
    (error_m * 1000.0 - 1e-6).ceil().max(0.0) / 1000.0
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
