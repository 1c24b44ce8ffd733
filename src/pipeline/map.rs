//! The job behind `orograph map`: from a DEM and the layers of its survey to a picture.

use super::archive::open_dem_coarse;
use super::memory;
use super::overlay::{ReadOverlay, read_overlay};
use crate::crs::{Crs, Ellipsoid};
use crate::error::{Error, ErrorKind, Result};
use crate::io::output::Output;
use crate::io::raster::{RasterOptions, RasterSource, Reduced};
use crate::plot::map::{Map, MapOptions, Overlay, Relief, draw};
use crate::watch::Watch;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Samples of a coarse level for each pixel, down and across: a level's cells are no means, so the mean is of these.
const SAMPLES: usize = 4;

/// Where the sea is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Sea {
    /// Up to elevation 0 on Earth, nowhere else.
    #[default]
    OnEarth,
    /// Nowhere.
    None,
    /// Up to an elevation in metres.
    UpTo(f64),
}

/// What to draw.
#[derive(Clone, Debug)]
pub struct MapJob {
    /// The DEM.
    pub input: PathBuf,
    /// How to read it.
    pub raster: RasterOptions,
    /// The file with the layers to draw on it.
    pub layers: Option<PathBuf>,
    /// Names of the layers to draw, if they are there.
    pub shown: Vec<String>,
    /// Names of those without which there is to be no map.
    pub required: Vec<String>,
    /// Where to write: a PNG file.
    pub output: PathBuf,
    /// Whether an existing output may be replaced.
    pub overwrite: bool,
    /// Width of the picture in pixels.
    pub width_px: u32,
    /// Title above the map.
    pub title: Option<String>,
    /// Where the data is from; the DEM's file name unless given, nothing if it is empty.
    pub source: Option<String>,
    /// Where the sea is.
    pub sea: Sea,
    /// Whether cells without data are sea.
    pub nodata_is_sea: bool,
    /// How many times heights are exaggerated in the shading; `None` to suit the relief.
    pub exaggeration: Option<f64>,
    /// Bytes of memory that may be used; what is free unless given.
    pub memory: Option<u64>,
}

/// What was drawn.
#[derive(Clone, Debug)]
pub struct MapReport {
    /// Rows and columns of the DEM.
    pub size: (usize, usize),
    /// Rows and columns that were drawn, after averaging.
    pub drawn: (usize, usize),
    /// Width and height of the picture.
    pub picture: (u32, u32),
    /// Peaks on the map, and how many of them there was room for.
    pub peaks: (usize, usize),
    /// Elevation in metres up to which there is sea.
    pub sea_level_m: Option<f64>,
    /// How long reading, drawing and writing took.
    pub times: [Duration; 3],
}

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the inputs, the output or the options; then no file has changed.
pub fn run(job: &MapJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<MapReport> {
    check_extension(&job.output)?;
    let at_input = |error: Error| if error.kind() == ErrorKind::Usage { error } else { error.at_path(&job.input) };
    let mut options = MapOptions {
        width_px: job.width_px,
        title: job.title.clone().filter(|text| !text.trim().is_empty()),
        source: job.source.clone().or_else(|| file_name(&job.input)).filter(|text| !text.trim().is_empty()),
        sea_level_m: None,
        exaggeration: job.exaggeration,
    };
    let relief_size = |options: &MapOptions, source: &RasterSource| {
        let [_, _, cols, rows] = source.window;
        options.relief_size(rows, cols, &source.transform, source.crs.as_ref()).map_err(at_input)
    };
    let needed = |source: &RasterSource| {
        let (height, width) = relief_size(&options, source)?;
        Ok((SAMPLES * height, SAMPLES * width))
    };
    let (source, size) = open_dem_coarse(&job.input, &job.raster, job.memory, watch, &needed)?;
    let crs = source.crs.as_ref();
    let sea_level_m = sea_level_m(job, crs)?;
    options.sea_level_m = sea_level_m;
    let (height, width) = relief_size(&options, &source)?;
    let output = Output::begin(&job.output, job.overwrite)?;
    let needed = memory::map_bytes(height as u64 * width as u64);
    let budget = job.memory.unwrap_or_else(memory::free_bytes);
    memory::admit_or(needed, budget, "ask for a smaller --width").map_err(|error| error.at_path(&job.output))?;

    let begun = Instant::now();
    let read = job.layers.as_deref().map(|path| layers(job, path, crs)).transpose()?.unwrap_or_default();
    let reduced = source.read_reduced(2 * height, 2 * width, watch)?;
    warn_of_inputs(&source, &reduced, &read, warn);
    let read_time = begun.elapsed();
    let begun = Instant::now();
    let drawn = (reduced.rows, reduced.cols);
    let relief = relief(reduced, crs, if job.nodata_is_sea { sea_level_m } else { None }).map_err(at_input)?;
    let map = draw(&relief, &read.overlay, &options).map_err(at_input)?;
    watch.check()?;
    if read.overlay != Overlay::default() && !map.has_overlay {
        warn("nothing of the layers lies on the map: are they those of another DEM?");
    }
    let drawn_time = begun.elapsed();
    let begun = Instant::now();
    write(output, &map)?;
    Ok(MapReport {
        size,
        drawn,
        picture: map.size,
        peaks: (map.peaks_there, map.peaks_drawn),
        sea_level_m,
        times: [read_time, drawn_time, begun.elapsed()],
    })
}

fn check_extension(output: &Path) -> Result<()> {
    let extension = output.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("png") => Ok(()),
        Some(other) => Err(Error::usage(format!("a map cannot be written as .{other}; name a .png file"))),
        None => Err(Error::usage("the output has no extension; name a .png file")),
    }
    .map_err(|error| error.at_path(output))
}

fn file_name(path: &Path) -> Option<String> {
    path.file_name().map(|name| name.to_string_lossy().into_owned())
}

/// The sea level that the job means.
fn sea_level_m(job: &MapJob, crs: Option<&Crs>) -> Result<Option<f64>> {
    // No figure of the Earth differs from another by a hundredth; other bodies do.
    let is_earth = crs.and_then(Crs::ellipsoid).is_none_or(|e| (e.a_m / Ellipsoid::WGS84.a_m - 1.0).abs() < 0.01);
    let level = match job.sea {
        Sea::OnEarth => is_earth.then_some(0.0),
        Sea::None => None,
        Sea::UpTo(level) => Some(level),
    };
    if job.nodata_is_sea && level.is_none() {
        return Err(Error::usage(
            "--nodata-is-sea: there is no sea on this map; say how high it is with --sea-level 0",
        ));
    }
    Ok(level)
}

fn layers(job: &MapJob, path: &Path, crs: Option<&Crs>) -> Result<ReadOverlay> {
    let shown: Vec<&str> = job.shown.iter().map(String::as_str).collect();
    let read = read_overlay(path, &shown, crs.map(|crs| crs.wkt.as_str()))?;
    if let Some(missing) = read.missing.iter().find(|name| job.required.contains(name)) {
        return Err(
            Error::new(ErrorKind::Input, format!("there is no layer {missing}; do not ask for it")).at_path(path)
        );
    }
    Ok(read)
}

fn warn_of_inputs(source: &RasterSource, reduced: &Reduced, read: &ReadOverlay, warn: &mut dyn FnMut(&str)) {
    for note in &source.notes {
        warn(note);
    }
    if let Some(sentinel) = &reduced.sentinel {
        warn(&sentinel.to_string());
    }
    if read.unplaced > 0 {
        warn(&format!("{} features of the layers have no place in the CRS of the DEM and are left out", read.unplaced));
    }
}

/// The relief to draw; its voids are filled with sea up to a level, if there is one.
fn relief(reduced: Reduced, crs: Option<&Crs>, sea_m: Option<f64>) -> Result<Relief> {
    let Reduced { rows, cols, mut elevation_m, transform, .. } = reduced;
    if let Some(sea_m) = sea_m {
        elevation_m.iter_mut().filter(|elevation| elevation.is_nan()).for_each(|elevation| *elevation = sea_m as f32);
    }
    Relief::new(rows, cols, elevation_m, transform, crs)
}

fn write(output: Output, map: &Map) -> Result<()> {
    std::fs::write(output.path(), &map.png).map_err(|error| {
        let message = format!("the picture cannot be written ({error}); is there room left?");
        Error::new(ErrorKind::Output, message).at_path(output.target())
    })?;
    output.finish()
}
