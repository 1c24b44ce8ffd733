//! What is to be done, what was done, and doing it.

use super::exemplar::name;
use super::glance::{Figures, Glance};
use super::learned::{Learned, Said};
use super::likeness::median_slope;
use super::mode::Mode;
use super::sink::Output;
use super::strips::Making;
use super::teach::{Aim, Teaching};
use super::terrain::Terrain;
use crate::amplify::Plane;
use crate::error::{Error, ErrorKind, Result};
use crate::io::output::Output as PageOutput;
use crate::io::raster::stored::StoredOptions;
use crate::units::LengthUnit;
use crate::watch::Watch;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Rows and columns in the middle of the input of which slopes are compared.
const MIDDLE: usize = 1024;
/// Terrains that are made in one run, at most: all files are open until the last is done.
const MOST_OUTPUTS: usize = 100;

/// Where what is learned comes from.
#[derive(Clone, Debug)]
pub enum Source {
    /// It is learned from exemplars.
    Teaching(Teaching),
    /// It was learned before, and is kept in a file.
    Learned {
        /// The file.
        path: PathBuf,
        /// What was said beside it: refused where it is not what the file was learned with.
        said: Vec<Said>,
    },
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
    /// The elevations in metres of black and of white, where the input is a hand-drawn map of greys.
    pub sketch_m: Option<[f64; 2]>,
    /// What is learned, or was.
    pub source: Source,
    /// Seed of the terrain that is drawn in [`Mode::Realistic`].
    pub seed: u64,
    /// How many terrains to make, with this seed and those that follow it; 1 unless in [`Mode::Realistic`].
    pub count: usize,
    /// Where to write. Where there are several, each has its number before the extension, from 1.
    pub output: PathBuf,
    /// Where to write a page with pictures, charts and numbers, of the first terrain.
    pub page: Option<PathBuf>,
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
    /// Cells of each output with data.
    pub cells: u64,
    /// Pairs of atoms of each step in [`Mode::Paper`].
    pub atoms: Vec<usize>,
    /// Greatest difference in metres between an input cell and the mean of its output cells, in any output.
    pub deviation_m: f64,
    /// The format that was written.
    pub format: String,
    /// The numbers of the page.
    pub figures: Option<Figures>,
    /// The files written, the page last.
    pub outputs: Vec<PathBuf>,
    /// Seed of each output, in the order of the files.
    pub seeds: Vec<u64>,
    /// How long learning took, and making and writing all outputs.
    pub times: [Duration; 2],
}

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the input, the exemplars, the output or the options; then no file has changed.
pub fn run(job: &AmplifyJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<AmplifyReport> {
    let begun = Instant::now();
    let (kept, factor, mode) = match &job.source {
        Source::Teaching(teaching) => {
            teaching.check()?;
            (None, teaching.factor, teaching.mode)
        }
        Source::Learned { path, said } => {
            let (learned, _) = Learned::read(path, job.memory, watch)?;
            learned.agree(path, said)?;
            let (factor, mode) = (learned.method.factor(), learned.mode);
            (Some((learned, path)), factor, mode)
        }
    };
    let paths = paths(job, mode)?;
    let terrain = match job.sketch_m {
        Some(heights_m) => Terrain::open_sketch(&job.input, &job.raster, heights_m)?,
        None => Terrain::open(&job.input, &job.raster, job.unit.as_ref())?,
    };
    terrain.notes().for_each(|note| warn(note));
    let [rows, cols] = terrain.size();
    if [rows, cols].iter().any(|side| side.saturating_mul(factor) > i32::MAX as usize) {
        let message =
            format!("{cols} x {rows} cells would become more than 2^31 in a row or column; take a smaller --factor");
        return Err(Error::new(ErrorKind::Unsupported, message).at_path(&job.input));
    }
    let record = terrain.finer_record(factor);
    // All are begun before anything is learned, and given their names after the last is made.
    let mut sinks = vec![];
    for path in &paths {
        let output = Output { path, overwrite: job.overwrite, format: job.format.as_deref(), options: &job.options };
        sinks.push(output.begin(&record)?);
    }
    let page = job.page.as_ref().map(|path| PageOutput::begin(path, job.overwrite)).transpose()?;
    sinks[0].notes(&job.options).iter().for_each(|note| warn(note));
    let cell = terrain.cell.divided(factor);
    let slope = middle_slope(&terrain)?;
    let learned = match (kept, &job.source) {
        (Some((learned, path)), _) => {
            learned.remarks(path, cell, slope).iter().for_each(|text| warn(text));
            learned
        }
        (None, Source::Teaching(teaching)) => {
            let aim = Aim { input: terrain.cell, made: cell, slope, memory: job.memory };
            teaching.learn(&aim, watch, warn)?
        }
        (None, Source::Learned { .. }) => unreachable!("it was read"),
    };
    let learning = begun.elapsed();

    let begun = Instant::now();
    let void = record.bands[0].nodata_value().map_or(f32::NAN, |value| value as f32);
    let seed = if mode.draws_in_learning() { learned.seed } else { job.seed };
    let seeds: Vec<u64> = (0..sinks.len() as u64).map(|number| seed.wrapping_add(number)).collect();
    let (mut cells, mut deviation) = (0, 0.0f64);
    let mut glance = page.as_ref().map(|_| Glance::new(terrain.size(), factor));
    for (number, (&seed, sink)) in seeds.iter().zip(&mut sinks).enumerate() {
        let making = Making { terrain: &terrain, method: &learned.method, void, seed, memory: job.memory, watch };
        let made = making.run(sink, glance.as_mut().filter(|_| number == 0)).map_err(|error| match error.kind() {
            ErrorKind::Output | ErrorKind::Interrupted => error,
            _ => error.at_path(&job.input),
        })?;
        if made.cells == 0 {
            let message = format!("all {} cells are nodata; check --band and --nodata", rows * cols);
            return Err(Error::new(ErrorKind::Input, message).at_path(&job.input));
        }
        cells = made.cells;
        deviation = deviation.max(made.deviation);
    }
    let format = sinks[0].format().to_string();
    let page = page.zip(glance).map(|(output, glance)| {
        let facts = facts(job, &learned, &terrain, (seed, deviation * terrain.unit_m()));
        let title = format!("{}, {factor} times finer", name(&job.input));
        let (figures, html) = glance.page(&terrain, &title, facts)?;
        std::fs::write(output.path(), html).map_err(|error| {
            let message = format!("the page cannot be written ({error}); is there room left?");
            Error::new(ErrorKind::Output, message).at_path(output.target())
        })?;
        Ok::<_, Error>((output, figures))
    });
    let page = page.transpose()?;
    let (mut outputs, mut notes): (Vec<PathBuf>, Vec<String>) = (vec![], vec![]);
    for sink in sinks {
        let (written, own) = sink.finish()?;
        outputs.extend(written);
        notes.extend(own);
    }
    let figures = match page {
        None => None,
        Some((output, figures)) => {
            outputs.push(output.target().to_path_buf());
            output.finish()?;
            Some(figures)
        }
    };
    notes.iter().for_each(|note| warn(note));
    Ok(AmplifyReport {
        size: [record.height, record.width],
        cell_m: [cell.across_m, cell.down_m],
        cells,
        atoms: learned.method.atoms(),
        deviation_m: deviation * terrain.unit_m(),
        format,
        figures,
        outputs,
        seeds,
        times: [learning, begun.elapsed()],
    })
}

/// What a page says at its head.
fn facts(
    job: &AmplifyJob,
    learned: &Learned,
    terrain: &Terrain,
    (seed, deviation_m): (u64, f64),
) -> Vec<(String, String)> {
    let [rows, cols] = terrain.size();
    let factor = learned.method.factor();
    let exemplars = match &job.source {
        Source::Teaching(_) => learned.names(),
        Source::Learned { path, .. } => format!("{}, learned before: {}", learned.names(), name(path)),
    };
    let mode = match learned.mode {
        Mode::Accurate => "accurate: the best estimate of the true heights",
        Mode::Realistic => "realistic: one of the terrains that there may be",
        Mode::Paper => "paper: patches of the exemplars in place of the input's",
    };
    let facts = [
        ("input", format!("{}: {cols} x {rows} cells of {}", name(&job.input), terrain.cell)),
        ("output", {
            let cell = terrain.cell.divided(factor);
            format!("{}: {} x {} cells of {cell}", name(&job.output), cols * factor, rows * factor)
        }),
        ("exemplars", exemplars),
        ("mode", format!("{mode}; seed {seed}")),
        ("means of cells are off by at most", format!("{deviation_m} m")),
    ];
    facts.map(|(name, words)| (name.to_string(), words)).to_vec()
}

/// Where each terrain is written: `OUT.tif`, or `OUT-1.tif` and so on.
///
/// # Errors
/// A number of terrains that there cannot be.
fn paths(job: &AmplifyJob, mode: Mode) -> Result<Vec<PathBuf>> {
    if !(1..=MOST_OUTPUTS).contains(&job.count) {
        return Err(Error::usage(format!("--count {}: expected 1 to {MOST_OUTPUTS}", job.count)));
    }
    if job.count == 1 {
        return Ok(vec![job.output.clone()]);
    }
    if mode != Mode::Realistic {
        return Err(Error::usage("--count: other modes make one terrain; several terrains need --mode realistic"));
    }
    let stem = job.output.file_stem().unwrap_or_default();
    let name = |number: usize| {
        let mut name = stem.to_os_string();
        name.push(format!("-{number}"));
        if let Some(extension) = job.output.extension() {
            name.push(".");
            name.push(extension);
        }
        job.output.with_file_name(name)
    };
    Ok((1..=job.count).map(name).collect())
}

/// The median slope in the middle of the input.
fn middle_slope(terrain: &Terrain) -> Result<Option<f64>> {
    let size = terrain.size();
    let part = size.map(|side| side.min(MIDDLE));
    let mut heights = terrain.read([(size[0] - part[0]) / 2, (size[1] - part[1]) / 2], part)?;
    heights.iter_mut().for_each(|height| *height *= terrain.unit_m());
    Ok(median_slope(&Plane::new(part[0], part[1], heights), terrain.cell))
}
