//! What is to be done, what was done, and doing it.

use super::exemplar::{self, Wanted};
use super::glance::{Figures, Glance};
use super::likeness::median_slope;
use super::method::Method;
use super::sink::Output;
use super::strips::Making;
use super::terrain::Terrain;
use crate::amplify::{Cascade, Paper, PatchModel, Plane, check_factor};
use crate::error::{Error, ErrorKind, Result};
use crate::io::output::Output as PageOutput;
use crate::io::raster::stored::StoredOptions;
use crate::units::LengthUnit;
use crate::watch::Watch;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Rows and columns in the middle of the input of which slopes are compared.
const MIDDLE: usize = 1024;
/// Terrains that are made in one run, at most: all files are open until the last is done.
const MOST_OUTPUTS: usize = 100;

/// What a finer terrain is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Mode {
    /// The best estimate of the true heights.
    Accurate,
    /// One of the terrains that there may be, as rough as true ones; another for each seed.
    Realistic,
    /// What paper 001 makes of it (section 5.3): patches of the exemplars in place of the input's. It keeps no means.
    Paper,
}

impl Mode {
    /// Bytes that an exemplar's cell takes while it is learned from: at all scales, with what steps make of it; or as it
    /// is, with sums.
    fn bytes_per_exemplar_cell(self) -> u64 {
        match self {
            Self::Accurate | Self::Realistic => 96,
            Self::Paper => 32,
        }
    }
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
    /// DEMs to learn from.
    pub exemplars: Vec<PathBuf>,
    /// How many times finer the cells become.
    pub factor: usize,
    /// What the result is to be.
    pub mode: Mode,
    /// How terrain is described by patches in [`Mode::Paper`]; its seed is not looked at.
    pub model: PatchModel,
    /// Seed of what is drawn: in [`Mode::Accurate`] the patches of large exemplars that are learned from, in
    /// [`Mode::Realistic`] the terrain, in [`Mode::Paper`] the atoms that learning begins with.
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
    match job.mode {
        Mode::Accurate | Mode::Realistic => check_factor(job.factor)?,
        Mode::Paper => job.model.steps(job.factor).map(drop)?,
    }
    let paths = paths(job)?;
    let terrain = match job.sketch_m {
        Some(heights_m) => Terrain::open_sketch(&job.input, &job.raster, heights_m)?,
        None => Terrain::open(&job.input, &job.raster, job.unit.as_ref())?,
    };
    terrain.notes().iter().for_each(|note| warn(note));
    let [rows, cols] = terrain.size();
    if [rows, cols].iter().any(|side| side.saturating_mul(job.factor) > i32::MAX as usize) {
        let message =
            format!("{cols} x {rows} cells would become more than 2^31 in a row or column; take a smaller --factor");
        return Err(Error::new(ErrorKind::Unsupported, message).at_path(&job.input));
    }
    let record = terrain.finer_record(job.factor);
    // All are begun before anything is learned, and given their names after the last is made.
    let mut sinks = vec![];
    for path in &paths {
        let output = Output { path, overwrite: job.overwrite, format: job.format.as_deref(), options: &job.options };
        sinks.push(output.begin(&record)?);
    }
    let page = job.page.as_ref().map(|path| PageOutput::begin(path, job.overwrite)).transpose()?;
    sinks[0].notes(&job.options).iter().for_each(|note| warn(note));
    let method = learned(job, &terrain, watch, warn)?;
    let atoms = match &method {
        Method::Paper(paper) => paper.atoms(),
        Method::Cascade(cascade) => {
            if cascade.borrowed_steps() > 0 {
                warn(&format!(
                    "the exemplars are too small for {} of the coarsest steps; what finer ones have learned is taken there",
                    cascade.borrowed_steps()
                ));
            }
            vec![]
        }
    };
    let learned = begun.elapsed();

    let begun = Instant::now();
    let void = record.bands[0].nodata_value().map_or(f32::NAN, |value| value as f32);
    let seeds: Vec<u64> = (0..sinks.len() as u64).map(|number| job.seed.wrapping_add(number)).collect();
    let (mut cells, mut deviation) = (0, 0.0f64);
    let mut glance = page.as_ref().map(|_| Glance::new(terrain.size(), job.factor));
    for (number, (&seed, sink)) in seeds.iter().zip(&mut sinks).enumerate() {
        let making = Making { terrain: &terrain, method: &method, void, seed, memory: job.memory, watch };
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
    let cell = terrain.cell.divided(job.factor);
    let page = page.zip(glance).map(|(output, glance)| {
        let facts = facts(job, &terrain, deviation * terrain.unit_m());
        let (figures, html) = glance.page(&terrain, &title(job), facts)?;
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
        atoms,
        deviation_m: deviation * terrain.unit_m(),
        format,
        figures,
        outputs,
        seeds,
        times: [learned, begun.elapsed()],
    })
}

/// A page's title.
fn title(job: &AmplifyJob) -> String {
    format!("{}, {} times finer", name(&job.input), job.factor)
}

/// What a page says at its head.
fn facts(job: &AmplifyJob, terrain: &Terrain, deviation_m: f64) -> Vec<(String, String)> {
    let [rows, cols] = terrain.size();
    let exemplars: Vec<String> = job.exemplars.iter().map(|path| name(path)).collect();
    let mode = match job.mode {
        Mode::Accurate => "accurate: the best estimate of the true heights",
        Mode::Realistic => "realistic: one of the terrains that there may be",
        Mode::Paper => "paper: patches of the exemplars in place of the input's",
    };
    let facts = [
        ("input", format!("{}: {cols} x {rows} cells of {}", name(&job.input), terrain.cell)),
        ("output", {
            let cell = terrain.cell.divided(job.factor);
            format!("{}: {} x {} cells of {cell}", name(&job.output), cols * job.factor, rows * job.factor)
        }),
        ("exemplars", exemplars.join(", ")),
        ("mode", format!("{mode}; seed {}", job.seed)),
        ("means of cells are off by at most", format!("{deviation_m} m")),
    ];
    facts.map(|(name, words)| (name.to_string(), words)).to_vec()
}

/// A file's name without its folder.
fn name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// Where each terrain is written: `OUT.tif`, or `OUT-1.tif` and so on.
///
/// # Errors
/// A number of terrains that there cannot be.
fn paths(job: &AmplifyJob) -> Result<Vec<PathBuf>> {
    if !(1..=MOST_OUTPUTS).contains(&job.count) {
        return Err(Error::usage(format!("--count {}: expected 1 to {MOST_OUTPUTS}", job.count)));
    }
    if job.count == 1 {
        return Ok(vec![job.output.clone()]);
    }
    if job.mode != Mode::Realistic {
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

/// What the exemplars teach.
fn learned(job: &AmplifyJob, terrain: &Terrain, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<Method> {
    let wanted = Wanted {
        input: terrain.cell,
        factor: job.factor,
        slope: middle_slope(terrain)?,
        bytes_per_cell: job.mode.bytes_per_exemplar_cell(),
        memory: job.memory,
    };
    let mut exemplars = vec![];
    for path in &job.exemplars {
        exemplars.extend(exemplar::read(path, &wanted, watch, warn)?);
    }
    let is_square = terrain.cell.is_square();
    let method = match job.mode {
        Mode::Accurate => Cascade::learn(&exemplars, job.factor, is_square, job.seed, watch).map(Method::Cascade),
        Mode::Realistic => Cascade::learn_textured(&exemplars, job.factor, is_square, watch).map(Method::Cascade),
        Mode::Paper => {
            let model = PatchModel { seed: job.seed, ..job.model.clone() };
            Paper::learn(exemplars, job.factor, &model, watch).map(Method::Paper)
        }
    };
    method.map_err(|error| match job.exemplars.first() {
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
