//! The job behind `orograph scene mesh`: a scene as triangles.

use super::super::tin::{Exactness, Made, MeshFormat, Placed, Provenance, Target, place, triangulate};
use super::places::{CellOptions, SceneCells, nothing};
use super::read::{DetailOption, SceneFile};
use crate::error::{Error, Result};
use crate::pipeline::memory;
use crate::tin::{Breaklines, Heights};
use crate::watch::Watch;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// What to do.
#[derive(Clone, Debug)]
pub struct MeshJob {
    /// The scene.
    pub scene: PathBuf,
    /// Where to write; the extension decides on the format.
    pub output: PathBuf,
    /// Whether an existing output may be replaced.
    pub overwrite: bool,
    /// The points at which the scene is evaluated: vertices are some of them, or all.
    pub cells: CellOptions,
    /// A layer of the scene in place of its terrain.
    pub layer: Option<String>,
    /// Where the level of detail comes from, if not from the scene.
    pub detail: Option<DetailOption>,
    /// How exact the mesh is to be.
    pub exactness: Exactness,
    /// Bytes of memory that may be used; what is free unless given.
    pub memory: Option<u64>,
    /// The options that change results, for the metadata.
    pub command: String,
}

/// What was done.
#[derive(Clone, Debug)]
pub struct MeshReport {
    /// The files that the scene names.
    pub inputs: Vec<PathBuf>,
    /// The points at which it was evaluated.
    pub cells: SceneCells,
    /// Points with terrain.
    pub defined: u64,
    /// Vertices and triangles of the mesh.
    pub mesh: (usize, usize),
    /// Greatest vertical distance in metres of a point from the mesh.
    pub error_m: f64,
    /// What was taken away from all coordinates.
    pub origin: [f64; 3],
    /// How long reading and evaluating, triangulating and writing took.
    pub times: [Duration; 3],
}

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the scene, its files, the output or the options; then no file has changed.
pub fn run(job: &MeshJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<MeshReport> {
    let begun = Instant::now();
    let format = MeshFormat::of(&job.output)?;
    let file = SceneFile::open(&job.scene, job.memory, watch)?;
    file.notes.iter().for_each(|note| warn(note));
    let tree = file.tree(job.layer.as_deref(), job.detail)?;
    let cells = SceneCells::of(&file, &tree, &job.cells, watch)?;
    let at = |error: Error| if error.path().is_some() { error } else { error.at_path(&job.scene) };
    let (rows, cols) = (cells.lattice.rows, cells.lattice.cols);
    Heights::admit(rows, cols).map_err(at)?;
    let budget = job.memory.unwrap_or_else(memory::free_bytes);
    let is_regular = job.exactness == Exactness::Regular;
    let needed = memory::mesh_bytes(rows as u64 * cols as u64, 8, is_regular) + tree.bytes() as u64;
    memory::admit_or(needed, budget, "take a coarser --resolution or a smaller --bbox").map_err(at)?;
    let target = Target::begin(&job.output, format, job.overwrite)?;
    watch.begin("evaluating", rows as u64);
    let z_m = tree.elevations_m(&cells.lattice, watch)?;
    let defined = z_m.iter().filter(|z| !z.is_nan()).count() as u64;
    if defined == 0 {
        return Err(nothing(&file));
    }
    let heights = Heights::new(rows, cols, z_m).map_err(at)?;
    let read = begun.elapsed();

    let begun = Instant::now();
    let vertices = memory::mesh_vertices(budget - needed);
    let breaklines = Breaklines::new(&[], &heights);
    let made = triangulate(&heights, &breaklines, job.exactness, vertices, watch).map_err(at)?;
    let Made { mut mesh, error_m, uncovered } = made;
    drop(heights);
    if uncovered > 0 {
        warn(&format!("{uncovered} cells with terrain stand alone, or in lines of one cell's width, and are left out"));
    }
    // A scene is in metres.
    let placed = if format == MeshFormat::GeoPackage { Placed::Kept } else { Placed::Metres(1.0) };
    place(&mut mesh, &cells.transform, &placed).map_err(at)?;
    let triangulated = begun.elapsed();

    let begun = Instant::now();
    watch.begin("writing", 1);
    let origin = placed.origin(format, &mesh);
    let (command, crs) = (job.command.as_str(), file.crs.as_ref());
    let provenance = Provenance { command, input: &job.scene, crs, placed: &placed, origin, error_m };
    target.write(&mesh, &provenance, watch)?;
    Ok(MeshReport {
        inputs: file.inputs.clone(),
        cells,
        defined,
        mesh: (mesh.vertices.len(), mesh.triangles.len()),
        error_m,
        origin,
        times: [read, triangulated, begun.elapsed()],
    })
}
