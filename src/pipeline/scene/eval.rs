//! The job behind `orograph scene eval`: a scene as a raster.

use super::places::{CellOptions, SceneCells, nothing};
use super::read::{DetailOption, SceneFile};
use crate::construction::Tree;
use crate::error::{Error, ErrorKind, Result};
use crate::grid::SampleType;
use crate::io::raster::stored::{BandRecord, Format, Record, StoredTarget};
use crate::pipeline::memory;
use crate::watch::Watch;
use std::ops::Range;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Rows of a strip are a multiple of this, if there is room: as high as the blocks of the files that are written.
const BLOCK: usize = 256;
/// Bytes of a strip where no memory is named; more makes nothing faster.
const STRIP_BYTES: u64 = 64 << 20;
/// Bytes a cell that a strip takes: elevations, and what is written of them, one being made while one is written.
const BYTES_PER_CELL: u64 = 2 * (8 + 8);

/// What to do.
#[derive(Clone, Debug)]
pub struct EvalJob {
    /// The scene.
    pub scene: PathBuf,
    /// Where to write.
    pub output: PathBuf,
    /// Whether an existing output may be replaced.
    pub overwrite: bool,
    /// GDAL's name of the format; after the output's extension unless given.
    pub format: Option<String>,
    /// Options of the format, key and value.
    pub options: Vec<(String, String)>,
    /// The cells that are wanted.
    pub cells: CellOptions,
    /// A layer of the scene in place of its terrain.
    pub layer: Option<String>,
    /// Where the level of detail comes from, if not from the scene.
    pub detail: Option<DetailOption>,
    /// Type of the cells: [`SampleType::F32`] or [`SampleType::F64`].
    pub sample: SampleType,
    /// Value of cells without terrain.
    pub nodata: f64,
    /// Bytes of memory that may be used; what is free unless given.
    pub memory: Option<u64>,
}

/// What was done.
#[derive(Clone, Debug)]
pub struct EvalReport {
    /// The scene.
    pub inputs: Vec<PathBuf>,
    /// The cells.
    pub cells: SceneCells,
    /// Cells with terrain.
    pub defined: u64,
    /// Least and greatest elevation of them in metres.
    pub range_m: (f64, f64),
    /// The CRS.
    pub crs: Option<String>,
    /// The format that was written.
    pub format: String,
    /// The files written.
    pub outputs: Vec<PathBuf>,
    /// How long reading the scene, and evaluating and writing it took.
    pub times: [Duration; 2],
}

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the scene, its files, the output or the options; then no file has changed.
pub fn run(job: &EvalJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<EvalReport> {
    let begun = Instant::now();
    let format = Format::of(&job.output, job.format.as_deref())?;
    let file = SceneFile::open(&job.scene, job.memory, watch)?;
    file.notes.iter().for_each(|note| warn(note));
    let tree = file.tree(job.layer.as_deref(), job.detail)?;
    let cells = SceneCells::of(&file, &tree, &job.cells, watch)?;
    let record = record(job, &file, &cells)?;
    let rows = strip_rows(job, &tree, cells.lattice.cols)?;
    let mut target = StoredTarget::begin(&job.output, job.overwrite, &format, &job.options, &record)?;
    target.notes.iter().for_each(|note| warn(note));
    let read = begun.elapsed();

    let begun = Instant::now();
    let found = match job.sample {
        SampleType::F64 => write::<f64>(job, &tree, &cells, rows, &mut target, watch)?,
        _ => write::<f32>(job, &tree, &cells, rows, &mut target, watch)?,
    };
    if found.defined == 0 {
        return Err(nothing(&file));
    }
    let (outputs, notes) = target.finish()?;
    notes.iter().for_each(|note| warn(note));
    if !format.keeps_cells(&job.options) {
        warn(&format!("the format {} may keep elevations less exactly than they are", format.name));
    }
    Ok(EvalReport {
        inputs: file.inputs,
        cells,
        defined: found.defined,
        range_m: found.range_m,
        crs: file.crs.map(|crs| crs.label().to_string()),
        format: format.name,
        outputs,
        times: [read, begun.elapsed()],
    })
}

/// What the file says of itself.
fn record(job: &EvalJob, file: &SceneFile, cells: &SceneCells) -> Result<Record> {
    let bits = match job.sample {
        SampleType::F64 => job.nodata.to_bits(),
        _ => u64::from((job.nodata as f32).to_bits()),
    };
    if job.sample == SampleType::F32 && !job.nodata.is_nan() && f64::from(job.nodata as f32) != job.nodata {
        return Err(Error::usage(format!("--nodata {}: single precision has no such number", job.nodata)));
    }
    let name = job.layer.as_deref().unwrap_or("elevation");
    let band = BandRecord {
        nodata: Some(bits),
        unit: "m".into(),
        description: name.to_string(),
        ..BandRecord::new(job.sample)
    };
    Ok(Record {
        width: cells.lattice.cols,
        height: cells.lattice.rows,
        bands: vec![band],
        transform: Some(cells.transform),
        crs: file.crs.as_ref().map(|crs| crs.wkt.clone()),
        ..Record::default()
    })
}

/// Rows that are evaluated at a time.
fn strip_rows(job: &EvalJob, tree: &Tree, cols: usize) -> Result<usize> {
    let row = cols as u64 * BYTES_PER_CELL;
    let kept = tree.bytes() as u64;
    let budget = job.memory.unwrap_or_else(memory::free_bytes);
    memory::admit_or(kept + row + (64 << 20), budget, "take larger cells or a smaller --bbox")?;
    let room = (budget - kept).min(job.memory.unwrap_or(STRIP_BYTES)).min(STRIP_BYTES * 8);
    let rows = (room / row).max(1) as usize;
    Ok(if rows > BLOCK { rows / BLOCK * BLOCK } else { rows })
}

/// What was found while a scene was written.
#[derive(Clone, Copy)]
struct Found {
    defined: u64,
    range_m: (f64, f64),
}

/// A type that elevations are written in.
trait Cell: crate::io::raster::stored::StoredCell {
    fn of(value: f64) -> Self;
    fn value(self) -> f64;
}

impl Cell for f32 {
    fn of(value: f64) -> Self {
        value as Self
    }
    fn value(self) -> f64 {
        f64::from(self)
    }
}

impl Cell for f64 {
    fn of(value: f64) -> Self {
        value
    }
    fn value(self) -> f64 {
        self
    }
}

/// Evaluates strip by strip: while one is written, the next is made.
fn write<T: Cell>(
    job: &EvalJob,
    tree: &Tree,
    cells: &SceneCells,
    rows: usize,
    target: &mut StoredTarget,
    watch: &Watch,
) -> Result<Found> {
    let lattice = &cells.lattice;
    let strips: Vec<Range<usize>> =
        (0..lattice.rows).step_by(rows).map(|row| row..lattice.rows.min(row + rows)).collect();
    watch.begin("evaluating", lattice.rows as u64);
    let make = |strip: &Range<usize>| tree.elevations_of_rows_m(lattice, strip.clone(), watch);
    let mut found = Found { defined: 0, range_m: (f64::INFINITY, f64::NEG_INFINITY) };
    let mut coming = strips.first().map(make).transpose()?;
    for (i, strip) in strips.iter().enumerate() {
        let Some(values) = coming.take() else { break };
        let mut out: Vec<T> = Vec::with_capacity(values.len());
        let void = T::of(job.nodata);
        for value in values {
            let own = T::of(value);
            if value.is_nan() {
                out.push(void);
                continue;
            }
            if own == void {
                let message = format!(
                    "the elevation {} m is that of cells without terrain; choose another with --nodata",
                    job.nodata
                );
                return Err(Error::new(ErrorKind::Unsupported, message).at_path(&job.scene));
            }
            found.defined += 1;
            let (low, high) = found.range_m;
            found.range_m = (low.min(own.value()), high.max(own.value()));
            out.push(own);
        }
        let next = || strips.get(i + 1).map(make).transpose();
        let mut write = || target.write(0, [0, strip.start, lattice.cols, strip.len()], &mut out);
        let (next, written) = rayon::join(next, &mut write);
        written?;
        coming = next?;
    }
    Ok(found)
}
