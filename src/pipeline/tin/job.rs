//! What is to be done, what was done, and doing it.

use super::super::archive::open_dem;
use super::super::memory;
use super::lines::{LineSource, read_lines};
use super::place::Placed;
use super::write::{MeshFormat, Provenance, Target};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::GeoTransform;
use crate::io::raster::{Dem, RasterOptions, RasterSource};
use crate::tin::{Breaklines, Heights, Mesh, RefineOptions, refine, regular};
use crate::watch::Watch;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// How exact a mesh is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exactness {
    /// All cells are vertices.
    Regular,
    /// Vertices are chosen.
    Refined {
        /// Greatest vertical distance in metres of a cell from the mesh.
        max_error_m: f64,
        /// Greatest number of vertices, whatever the error.
        max_vertices: Option<usize>,
    },
}

/// What to do.
#[derive(Clone, Debug)]
pub struct TinJob {
    /// The DEM.
    pub input: PathBuf,
    /// How to read it.
    pub raster: RasterOptions,
    /// Where to write; the extension decides on the format.
    pub output: PathBuf,
    /// Whether an existing output may be replaced.
    pub overwrite: bool,
    /// How exact the mesh is to be.
    pub exactness: Exactness,
    /// Lines that are to be edges.
    pub lines: Option<LineSource>,
    /// Bytes of memory that may be used; what is free unless given.
    pub memory: Option<u64>,
    /// The options that change results, for the metadata.
    pub command: String,
}

/// What was done.
#[derive(Clone, Debug)]
pub struct TinReport {
    /// Rows, columns and cells with data.
    pub size: (usize, usize, u64),
    /// Vertices and triangles of the mesh.
    pub mesh: (usize, usize),
    /// Greatest vertical distance in metres of a cell from the mesh.
    pub error_m: f64,
    /// Cells with data that no triangle covers.
    pub uncovered: u64,
    /// Edges along the given lines, before refinement parted them.
    pub line_edges: usize,
    /// What was taken away from all coordinates.
    pub origin: [f64; 3],
    /// The plane of the coordinates as a PROJ string, where it is not that of the raster's CRS.
    pub plane: Option<String>,
    /// How long reading, triangulating and writing took.
    pub times: [Duration; 3],
}

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the inputs, the output or the options; then no file has changed.
pub fn run(job: &TinJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<TinReport> {
    let format = MeshFormat::of(&job.output)?;
    let source = open_dem(&job.input, &job.raster, job.memory, watch)?;
    let at_input = |error: Error| if error.kind() == ErrorKind::Usage { error } else { error.at_path(&job.input) };
    let [_, _, cols, rows] = source.window;
    Heights::admit(rows, cols).map_err(at_input)?;
    let target = Target::begin(&job.output, format, job.overwrite)?;
    let placed = Placed::of(&source, format).map_err(at_input)?;
    let vertices = admit(job, &source).map_err(at_input)?;

    let begun = Instant::now();
    let lines = job.lines.as_ref().map(|lines| read_lines(lines, &source, warn)).transpose()?.unwrap_or_default();
    let dem = source.read(watch)?;
    warn_of_input(&dem, warn);
    let cells = dem.extremes.map_or(0, |extremes| extremes.cells);
    let (transform, heights) = (dem.transform, heights_of(dem)?);
    let read = begun.elapsed();

    let begun = Instant::now();
    let breaklines = Breaklines::new(&lines, &heights);
    if !lines.is_empty() && breaklines.is_empty() {
        warn("none of the lines lies on the raster: are they those of another place?");
    }
    let made = triangulate(&heights, &breaklines, job.exactness, vertices, watch).map_err(at_input)?;
    let Made { mut mesh, error_m, uncovered } = made;
    drop(heights);
    if uncovered > 0 {
        warn(&format!("{uncovered} cells with data stand alone, or in lines of one cell's width, and are left out"));
    }
    place(&mut mesh, &transform, &placed).map_err(at_input)?;
    let triangulated = begun.elapsed();

    let begun = Instant::now();
    watch.begin("writing", 1);
    let origin = placed.origin(format, &mesh);
    let (command, crs) = (job.command.as_str(), source.crs.as_ref());
    let provenance = Provenance { command, input: &source.path, crs, placed: &placed, origin, error_m };
    target.write(&mesh, &provenance, watch)?;
    Ok(TinReport {
        size: (rows, cols, cells),
        mesh: (mesh.vertices.len(), mesh.triangles.len()),
        error_m,
        uncovered,
        line_edges: breaklines.edges().len(),
        origin,
        plane: placed.plane_definition().map(str::to_string),
        times: [read, triangulated, begun.elapsed()],
    })
}

/// A mesh in columns and rows.
pub(in crate::pipeline) struct Made {
    pub(in crate::pipeline) mesh: Mesh,
    /// Greatest vertical distance in metres of a cell from the mesh.
    pub(in crate::pipeline) error_m: f64,
    /// Cells with data that no triangle covers.
    pub(in crate::pipeline) uncovered: u64,
}

/// A mesh as exact as it is to be, of at most so many vertices as there is memory for.
///
/// # Errors
/// Where these do not suffice, no three cells are neighbours of each other, or the job is cancelled.
pub(in crate::pipeline) fn triangulate(
    heights: &Heights,
    breaklines: &Breaklines,
    exactness: Exactness,
    vertices: usize,
    watch: &Watch,
) -> Result<Made> {
    let made = match exactness {
        Exactness::Regular => whole(heights),
        Exactness::Refined { max_error_m, max_vertices } => {
            let limit = max_vertices.map_or(vertices, |limit| limit.min(vertices));
            let options = RefineOptions { max_error_m, max_vertices: Some(limit) };
            let made = refine(heights, breaklines, options, watch)?;
            if made.error_m > max_error_m && limit == vertices && max_vertices != Some(limit) {
                return Err(out_of_memory(vertices));
            }
            Made { mesh: made.mesh, error_m: made.error_m, uncovered: made.uncovered }
        }
    };
    if made.mesh.triangles.is_empty() {
        let message = "there is nothing to triangulate: no three cells with data that are neighbours of each other";
        return Err(Error::new(ErrorKind::Input, message));
    }
    Ok(made)
}

/// The mesh of all cells.
fn whole(heights: &Heights) -> Made {
    let mesh = regular(heights);
    let data = heights.z_m().iter().filter(|z| !z.is_nan()).count();
    Made { uncovered: (data - mesh.vertices.len()) as u64, mesh, error_m: 0.0 }
}

/// Refuses work that would not fit into memory; returns how many vertices would.
fn admit(job: &TinJob, source: &RasterSource) -> Result<usize> {
    let budget = job.memory.unwrap_or_else(memory::free_bytes);
    let regular = job.exactness == Exactness::Regular;
    let needed = memory::mesh_bytes(source.cells(), source.key_bytes(), regular) + source.unpacked_bytes();
    memory::admit(needed, budget)?;
    Ok(memory::mesh_vertices(budget - needed))
}

fn out_of_memory(vertices: usize) -> Error {
    Error::new(
        ErrorKind::Unsupported,
        format!(
            "the mesh needs more than the {vertices} vertices that the memory has room for; allow a larger --max-error, say \
             --max-vertices, cut the raster with --window or --bbox, or raise --memory"
        ),
    )
}

fn warn_of_input(dem: &Dem, warn: &mut dyn FnMut(&str)) {
    for note in &dem.notes {
        warn(note);
    }
    if let Some(sentinel) = &dem.sentinel {
        warn(&sentinel.to_string());
    }
    if dem.grid.wraps() {
        warn("the raster goes round the globe: the mesh is cut open between its last column and its first");
    }
}

/// The elevations of a DEM, whose cells are given up for them.
fn heights_of(dem: Dem) -> Result<Heights> {
    let (rows, cols) = (dem.grid.rows(), dem.grid.cols());
    Heights::new(rows, cols, dem.heights_m())
}

/// Makes coordinates of columns and rows.
///
/// # Errors
/// Places that have no image in the plane.
pub(in crate::pipeline) fn place(mesh: &mut Mesh, transform: &GeoTransform, placed: &Placed) -> Result<()> {
    let t = &transform.0;
    // Where rows are counted downwards, what was counter-clockwise among columns and rows no longer is.
    if t[1] * t[5] - t[2] * t[4] < 0.0 {
        mesh.turn_over();
    }
    for vertex in &mut mesh.vertices {
        (vertex[0], vertex[1]) = transform.centre(vertex[1], vertex[0]);
    }
    placed.place(mesh)
}
