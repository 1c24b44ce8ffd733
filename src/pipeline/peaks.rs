//! The job behind `orograph peaks`: from a DEM to the layers of its survey.

use super::archive::open_dem;
use super::layers::{DivideTreeLayer, IsolationLayer, LengthOutput, NAMES, PeakTags, PeaksLayer, SaddlesLayer};
use super::metric::Distance;
use super::surveying::{Surveyed, Surveying};
use super::tags::{TagOptions, Tagger};
use crate::error::Result;
use crate::io::raster::{Dem, RasterOptions, RasterSource};
use crate::io::vector::{Table, Writer};
use crate::orometry::{Survey, SurveyOptions};
use crate::watch::Watch;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// What to do.
#[derive(Clone, Debug)]
pub struct PeaksJob {
    /// The DEM.
    pub input: PathBuf,
    /// How to read it.
    pub raster: RasterOptions,
    /// Where to write.
    pub output: PathBuf,
    /// Whether an existing output may be replaced.
    pub overwrite: bool,
    /// What to measure.
    pub survey: SurveyOptions,
    /// How to measure distances.
    pub distance: Distance,
    /// What to tag peaks with.
    pub tags: TagOptions,
    /// Names of the layers to write, in the order of [`NAMES`].
    pub layers: Vec<String>,
    /// Unit of lengths in the output.
    pub unit: LengthOutput,
    /// Bytes of memory that may be used; what is free unless given.
    pub memory: Option<u64>,
    /// The options that change results, for the metadata.
    pub command: String,
}

/// What was done.
#[derive(Debug)]
pub struct PeaksReport {
    /// The survey.
    pub survey: Survey,
    /// Tags of the peaks, one each, or none.
    pub tags: Vec<PeakTags>,
    /// Coordinates of the first ten peaks.
    pub points: Vec<(f64, f64)>,
    /// Longitudes and latitudes of the first ten peaks; NaN where there are none.
    pub lon_lat: Vec<(f64, f64)>,
    /// Rows, columns and cells with data.
    pub size: (usize, usize, u64),
    /// The files written.
    pub outputs: Vec<PathBuf>,
    /// How long reading, measuring and writing took.
    pub times: [Duration; 3],
}

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the input, the output or the options; then no file has changed.
pub fn run(job: &PeaksJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<PeaksReport> {
    let layer_names: Vec<&str> = NAMES.into_iter().filter(|name| job.layers.iter().any(|l| l == name)).collect();
    let source = open_dem(&job.input, &job.raster, job.memory, watch)?;
    let writer = Writer::begin(&job.output, &layer_names, job.overwrite)?;
    let outputs = writer.targets();
    let surveying = Surveying { options: &job.survey, distance: job.distance, memory: job.memory };
    surveying.admit(&source)?;
    let mut note = |text: String| warn(&text);
    let tagger = Tagger::read(&job.tags, source.crs.as_ref(), &mut note)?;
    let surveyed = surveying.run(&source, watch, &mut note)?;
    let Surveyed { dem, survey: found, .. } = &surveyed;
    let begun = Instant::now();
    let frame = surveyed.frame(job.unit);
    let tags = tagger.tag(&found.peaks, &frame, job.distance, &mut note);
    let [read, surveying] = surveyed.times;
    let measured = surveying + begun.elapsed();
    let begun = Instant::now();
    let tables: Vec<Box<dyn Table + '_>> = layer_names
        .iter()
        .map(|name| -> Box<dyn Table + '_> {
            match *name {
                "peaks" => Box::new(PeaksLayer::new(&frame, &found.peaks, &tags)),
                "saddles" => Box::new(SaddlesLayer::new(&frame, &found.peaks)),
                "divide_tree" => Box::new(DivideTreeLayer::new(&frame, &found.edges)),
                _ => Box::new(IsolationLayer::new(&frame, &found.peaks)),
            }
        })
        .collect();
    let views: Vec<&dyn Table> = tables.iter().map(AsRef::as_ref).collect();
    writer.write(&views, dem.crs.as_ref(), &metadata(job, dem, &source), watch)?;
    drop(tables);
    let lon_lat = frame.lon_lat(found.peaks.iter().take(10).map(|peak| peak.cell));
    let points = found.peaks.iter().take(10).map(|peak| frame.point(peak.cell)).collect();
    let cells = dem.extremes.map_or(0, |extremes| extremes.cells);
    Ok(PeaksReport {
        size: (dem.grid.rows(), dem.grid.cols(), cells),
        points,
        lon_lat,
        times: [read, measured, begun.elapsed()],
        survey: surveyed.survey,
        tags,
        outputs,
    })
}

/// What the output says of its origin: nothing that differs from run to run.
fn metadata(job: &PeaksJob, dem: &Dem, source: &RasterSource) -> Vec<(String, String)> {
    let text = |value: &str| value.to_string();
    vec![
        (text("OROGRAPH_COMMAND"), job.command.clone()),
        (text("OROGRAPH_VERSION"), text(env!("CARGO_PKG_VERSION"))),
        (text("OROGRAPH_INPUT"), source.path.display().to_string()),
        (text("OROGRAPH_INPUT_VERTICAL_UNIT"), dem.elevations.unit.name.clone()),
        (
            text("OROGRAPH_DEFINITIONS"),
            text(
                "8-neighbourhood; higher first, among equals the lower index; key saddle: where components of higher ground \
                 meet; isolation: distance between the centre of the peak and that of the nearest strictly higher cell",
            ),
        ),
    ]
}
