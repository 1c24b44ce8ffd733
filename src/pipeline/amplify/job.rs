//! What is to be done, what was done, and doing it.

use super::exemplar::{self, Wanted};
use super::likeness::median_slope;
use super::sink::Output;
use super::strips::Making;
use super::terrain::Terrain;
use crate::amplify::{Cascade, Plane, steps_of};
use crate::error::{Error, ErrorKind, Result};
use crate::io::raster::stored::StoredOptions;
use crate::units::LengthUnit;
use crate::watch::Watch;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Rows and columns in the middle of the input of which slopes are compared.
const MIDDLE: usize = 1024;

/// What a finer terrain is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Mode {
    /// The best estimate of the true heights.
    Accurate,
}

/// What to do.
#[derive(Clone, Debug)]
pub struct AmplifyJob {
    /// The DEM.
    pub input: PathBuf,
    /// What to read of it: one band.
    pub raster: StoredOptions,
    /// Unit of its elevations; replaces a declared one.
    pub unit: Option<LengthUnit>,
    /// DEMs to learn from.
    pub exemplars: Vec<PathBuf>,
    /// How many times finer the cells become.
    pub factor: usize,
    /// What the result is to be.
    pub mode: Mode,
    /// Seed of what is drawn from the exemplars.
    pub seed: u64,
    /// Where to write.
    pub output: PathBuf,
    /// Whether an existing output may be replaced.
    pub overwrite: bool,
    /// GDAL's name of the format; after the output's extension unless given.
    pub format: Option<String>,
    /// Options of the format, key and value.
    pub options: Vec<(String, String)>,
    /// Bytes of memory that may be used; about a gigabyte unless given.
    pub memory: Option<u64>,
}

/// What was done.
#[derive(Clone, Debug)]
pub struct AmplifyReport {
    /// Rows and columns of the output.
    pub size: [usize; 2],
    /// Metres from one column and one row of the output to the next.
    pub cell_m: [f64; 2],
    /// Cells of the output with data.
    pub cells: u64,
    /// Greatest difference in metres between an input cell and the mean of its output cells.
    pub deviation_m: f64,
    /// The format that was written.
    pub format: String,
    /// The files written.
    pub outputs: Vec<PathBuf>,
    /// How long learning, and making and writing took.
    pub times: [Duration; 2],
}

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the input, the exemplars, the output or the options; then no file has changed.
pub fn run(job: &AmplifyJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<AmplifyReport> {
    let begun = Instant::now();
    let Mode::Accurate = job.mode;
    steps_of(job.factor)?;
    let terrain = Terrain::open(&job.input, &job.raster, job.unit.as_ref())?;
    terrain.notes().iter().for_each(|note| warn(note));
    let [rows, cols] = terrain.size();
    if [rows, cols].iter().any(|side| side.saturating_mul(job.factor) > i32::MAX as usize) {
        let message =
            format!("{cols} x {rows} cells would become more than 2^31 in a row or column; take a smaller --factor");
        return Err(Error::new(ErrorKind::Unsupported, message).at_path(&job.input));
    }
    let record = terrain.finer_record(job.factor);
    let output =
        Output { path: &job.output, overwrite: job.overwrite, format: job.format.as_deref(), options: &job.options };
    let mut sink = output.begin(&record)?;
    sink.notes(&job.options).iter().for_each(|note| warn(note));
    let cascade = learned(job, &terrain, watch, warn)?;
    if cascade.borrowed_steps() > 0 {
        warn(&format!(
            "the exemplars are too small for {} of the coarsest steps; what finer ones have learned is taken there",
            cascade.borrowed_steps()
        ));
    }
    let learned = begun.elapsed();

    let begun = Instant::now();
    let void = record.bands[0].nodata_value().map_or(f32::NAN, |value| value as f32);
    let making = Making { terrain: &terrain, cascade: &cascade, void, memory: job.memory, watch };
    let made = making.run(&mut sink).map_err(|error| match error.kind() {
        ErrorKind::Output | ErrorKind::Interrupted => error,
        _ => error.at_path(&job.input),
    })?;
    if made.cells == 0 {
        let message = format!("all {} cells are nodata; check --band and --nodata", rows * cols);
        return Err(Error::new(ErrorKind::Input, message).at_path(&job.input));
    }
    let format = sink.format().to_string();
    let (outputs, notes) = sink.finish()?;
    notes.iter().for_each(|note| warn(note));
    let cell = terrain.cell.divided(job.factor);
    Ok(AmplifyReport {
        size: [record.height, record.width],
        cell_m: [cell.across_m, cell.down_m],
        cells: made.cells,
        deviation_m: made.deviation * terrain.unit_m(),
        format,
        outputs,
        times: [learned, begun.elapsed()],
    })
}

/// What the exemplars teach.
fn learned(job: &AmplifyJob, terrain: &Terrain, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<Cascade> {
    let wanted = Wanted { input: terrain.cell, factor: job.factor, slope: middle_slope(terrain)?, memory: job.memory };
    let mut exemplars = vec![];
    for path in &job.exemplars {
        exemplars.extend(exemplar::read(path, &wanted, watch, warn)?);
    }
    let is_square = terrain.cell.is_square();
    Cascade::learn(&exemplars, job.factor, is_square, job.seed, watch).map_err(|error| match job.exemplars.first() {
        Some(path) if error.kind() == ErrorKind::Input => error.at_path(path),
        _ => error,
    })
}

/// The median slope in the middle of the input.
fn middle_slope(terrain: &Terrain) -> Result<Option<f64>> {
    let size = terrain.size();
    let part = size.map(|side| side.min(MIDDLE));
    let mut heights = terrain.read([(size[0] - part[0]) / 2, (size[1] - part[1]) / 2], part)?;
    heights.iter_mut().for_each(|height| *height *= terrain.unit_m());
    Ok(median_slope(&Plane::new(part[0], part[1], heights), terrain.cell))
}
