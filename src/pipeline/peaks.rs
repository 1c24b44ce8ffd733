//! The job behind `orograph peaks`: from a DEM to the layers of its survey.

use super::layers::{DivideTreeLayer, Frame, IsolationLayer, LengthOutput, NAMES, PeakTags, PeaksLayer, SaddlesLayer};
use super::memory;
use super::metric::{AnyMetric, Distance, metric_of};
use super::spikes;
use super::tags::{TagOptions, Tagger};
use crate::crs::{Crs, CrsKind};
use crate::error::{Error, Result};
use crate::io::raster::{Dem, RasterOptions, RasterSource};
use crate::io::transform::OwnGeographic;
use crate::io::vector::{Table, Writer};
use crate::orometry::{Survey, SurveyOptions, survey};
use crate::watch::Watch;
use crate::with_metric;
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
    /// What a user should know.
    pub warnings: Vec<String>,
    /// How long reading, measuring and writing took.
    pub times: [Duration; 3],
}

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the input, the output or the options; then no file has changed.
pub fn run(job: &PeaksJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<PeaksReport> {
    let layer_names: Vec<&str> = NAMES.into_iter().filter(|name| job.layers.iter().any(|l| l == name)).collect();
    let source = RasterSource::open(&job.input, &job.raster)?;
    let writer = Writer::begin(&job.output, &layer_names, job.overwrite)?;
    let outputs = writer.targets();
    let needed = memory::survey_bytes(source.cells(), source.key_bytes());
    memory::admit(needed, job.memory.unwrap_or_else(memory::free_bytes)).map_err(|error| error.at_path(&job.input))?;
    let mut warnings = Vec::new();
    let mut note = |text: String| {
        warn(&text);
        warnings.push(text);
    };
    let tagger = Tagger::read(&job.tags, source.crs.as_ref(), &mut note)?;
    let begun = Instant::now();
    let dem = source.read(watch)?;
    let read = begun.elapsed();
    warn_of_input(&dem, job, &mut note);
    let begun = Instant::now();
    let at_input = |error: Error| error.at_path(&job.input);
    let to_geographic = own_geographic(dem.crs.as_ref())?;
    let metric = metric_of(&dem, job.distance, to_geographic.as_ref()).map_err(at_input)?;
    let found = with_metric!(&metric, metric => survey(&dem.grid, &dem.elevations, metric, &job.survey, watch))
        .map_err(at_input)?;
    warn_of_result(&dem, &metric, &found, job, &mut note);
    let frame = Frame::new(&dem, to_geographic.as_ref(), job.unit);
    let tags = tagger.tag(&found.peaks, &frame, job.distance, &mut note);
    let measured = begun.elapsed();
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
    writer.write(&views, dem.crs.as_ref(), &metadata(job, &dem, &source), watch)?;
    drop(tables);
    let lon_lat = frame.lon_lat(found.peaks.iter().take(10).map(|peak| peak.cell));
    let points = found.peaks.iter().take(10).map(|peak| frame.point(peak.cell)).collect();
    let cells = dem.extremes.map_or(0, |extremes| extremes.cells);
    Ok(PeaksReport {
        size: (dem.grid.rows(), dem.grid.cols(), cells),
        points,
        lon_lat,
        survey: found,
        tags,
        outputs,
        warnings,
        times: [read, measured, begun.elapsed()],
    })
}

/// The transformation to longitudes and latitudes, where coordinates are projected.
fn own_geographic(crs: Option<&Crs>) -> Result<Option<OwnGeographic>> {
    crs.filter(|crs| matches!(crs.kind, CrsKind::Projected { .. })).map(OwnGeographic::new).transpose()
}

fn warn_of_input(dem: &Dem, job: &PeaksJob, note: &mut impl FnMut(String)) {
    for text in &dem.notes {
        note(text.clone());
    }
    if let Some(sentinel) = &dem.sentinel {
        note(format!(
            "{} cells have the value {}, far from all others and not declared as nodata; if it means nodata, give --nodata {}",
            sentinel.cells, sentinel.value, sentinel.value
        ));
    }
    let stretches = dem.crs.as_ref().and_then(|crs| crs.projection.as_deref()).is_some_and(|projection| {
        let plain = projection.to_ascii_lowercase();
        plain.contains("mercator") && !plain.contains("transverse") && !plain.contains("oblique")
            || plain.contains("pseudo")
            || plain.contains("equirectangular")
    });
    if stretches && job.distance == Distance::Crs {
        note(
            "the projection stretches distances much away from its true scale; measure them with --distance geodesic"
                .into(),
        );
    }
}

fn warn_of_result(dem: &Dem, metric: &AnyMetric<'_>, found: &Survey, job: &PeaksJob, note: &mut impl FnMut(String)) {
    let spikes = spikes::find(dem, metric, &found.peaks);
    if let Some(first) = spikes.first() {
        let others = if spikes.len() > 1 { format!(" (and {} more)", spikes.len() - 1) } else { String::new() };
        note(format!(
            "the cell at row {}, column {}{others} stands {:.0} m above all its neighbours, which looks like a fault of the data; \
             if its value {} means nodata, give --nodata, else mend the DEM: nothing is removed here",
            first.row, first.col, first.drop_m, first.elevation_m
        ));
    }
    let certain = found.peaks.iter().filter(|peak| peak.prominence_certain).count();
    if found.peaks.len() >= 10 && certain * 2 < found.peaks.len() && !job.survey.certain_only {
        note(format!(
            "only {certain} of {} prominences are certain: terrain beyond the edge or in voids could lower the others down to prominence_min",
            found.peaks.len()
        ));
    }
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
