//! `orograph scene mesh`.

use super::super::exactness::{ExactnessOptions, error_text_m};
use super::super::progress::watched;
use super::super::report::Reporter;
use super::super::shared::{MemoryOptions, OutputOptions};
use super::{CellArguments, CommonOptions, DetailArguments};
use crate::error::Result;
use crate::pipeline::scene::mesh::{MeshJob, MeshReport, run};
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Make a mesh of a scene: few triangles where it is smooth, many where it is rough.
///
/// The scene is evaluated at a grid of points. With --max-error vertices are some of them, and none of the others is
/// further from the triangles, straight up or down; with --regular all of them are. Coordinates are metres of the
/// scene's CRS; .obj and .glb are relative to an origin that they state.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  orograph scene mesh fixtures/scenes/valley.json valley.glb --resolution 60m --max-error 5m\n  \
                        orograph scene mesh fixtures/scenes/craters.json craters.ply --resolution 40m --regular"
)]
pub(super) struct Mesh {
    /// Scene: a JSON file.
    #[arg(value_name = "SCENE.json")]
    scene: PathBuf,
    /// Output: .obj, .ply, .glb or .gpkg.
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    exactness: ExactnessOptions,
    #[command(flatten)]
    cells: CellArguments,
    #[command(flatten)]
    detail: DetailArguments,
    /// Make a layer of the scene, such as its water, in place of the terrain.
    #[arg(long, value_name = "NAME", help_heading = "Output")]
    layer: Option<String>,
    #[command(flatten)]
    out: OutputOptions,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Mesh {
    fn meant(&self) -> Result<MeshJob> {
        Ok(MeshJob {
            scene: self.scene.clone(),
            output: self.output.clone(),
            overwrite: self.out.overwrite,
            cells: self.cells.meant()?,
            layer: self.layer.clone(),
            detail: self.detail.meant()?,
            exactness: self.exactness.meant()?,
            memory: self.memory.bytes()?,
            command: self.words().join(" "),
        })
    }

    /// The command without what changes no result.
    fn words(&self) -> Vec<String> {
        let mut words = vec!["orograph".into(), "scene".into(), "mesh".into(), self.scene.display().to_string()];
        words.extend(self.layer.clone().map(|layer| ["--layer".into(), layer]).into_iter().flatten());
        words.extend(self.exactness.words());
        words.extend(self.cells.words());
        words.extend(self.detail.words());
        words
    }

    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        reporter.input(&self.scene);
        let job = self.meant()?;
        let report = watched(reporter, |watch, reporter| run(&job, watch, &mut |text| reporter.warn(text)))?;
        report.inputs.iter().for_each(|input| reporter.input(input));
        reporter.outputs(std::slice::from_ref(&job.output));
        let [read, triangulated, written] = report.times.map(|time| time.as_secs_f64());
        reporter.remark(&format!("evaluated {read:.3} s, triangulated {triangulated:.3} s, written {written:.3} s"));
        reporter.say(&text(&report))?;
        Ok(json(&report))
    }
}

fn text(report: &MeshReport) -> String {
    let ((vertices, triangles), lattice) = (report.mesh, &report.cells.lattice);
    let share = 100.0 * vertices as f64 / report.defined as f64;
    let error_m = error_text_m(report.error_m);
    let mut text = format!(
        "{vertices} vertices ({share:.1} % of the points) and {triangles} triangles of {} x {} points every {} m, greatest error {error_m} m\n",
        lattice.cols, lattice.rows, lattice.dx
    );
    let [x, y, _] = report.origin;
    if x != 0.0 || y != 0.0 {
        text += &format!("coordinates are relative to {x}, {y}\n");
    }
    text
}

fn json(report: &MeshReport) -> Value {
    let [read, triangulated, written] = report.times.map(|time| time.as_secs_f64());
    json!({
        "rows": report.cells.lattice.rows,
        "cols": report.cells.lattice.cols,
        "points_with_terrain": report.defined,
        "vertices": report.mesh.0,
        "triangles": report.mesh.1,
        "error_m": report.error_m,
        "origin": report.origin,
        "seconds": { "evaluate": read, "triangulate": triangulated, "write": written },
    })
}
