//! What to do, and what was done.

use super::super::land::Land;
use super::super::layers::{DivideTreeLayer, Frame, IsolationLayer, LengthOutput, NAMES, PeaksLayer, SaddlesLayer};
use super::super::memory;
use super::super::metric::AnyMetric;
use super::super::regions::Regions;
use super::super::surveying::own_geographic;
use super::super::terrain::{RasterOutput, TerrainLike, TerrainShape, TerrainTarget, read_kept, tell_crossings};
use super::maps::Maps;
use super::range::{Range, RangeOptions};
use crate::erosion::Relief;
use crate::error::{Error, ErrorKind, Result};
use crate::io::output::Output;
use crate::io::raster::parse_crs;
use crate::io::vector::{Table, Writer};
use crate::orometry::distributions::{BinSet, CellSet, Comparison, Domain, PeakMeasures, Selection, compare};
use crate::orometry::{Survey, survey_tree};
use crate::synthesis::terrain::{Raised, Skeleton, TerrainOptions, raise};
use crate::synthesis::{Extent, Synthesis, SynthesisOptions, Target, peak_counts, synthesize};
use crate::watch::Watch;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// What to do.
#[derive(Clone, Debug)]
pub struct SynthesizeJob {
    /// The ranges to be like: DEMs, layers of peaks, statistics files.
    pub like: Vec<PathBuf>,
    /// Name of the layer of peaks, where a file has several.
    pub layer: Option<String>,
    /// The domain of a statistics file; its first unless given.
    pub domain: Option<String>,
    /// Least prominence in metres of the ranges' peaks; 30 m on a DEM and that of a layer unless given.
    pub min_prominence_m: Option<f64>,
    /// Where to write the layers of the tree, if anywhere.
    pub tree: Option<PathBuf>,
    /// Whether existing layers may be replaced.
    pub overwrite: bool,
    /// The terrain to raise on the tree, if any.
    pub terrain: Option<TerrainPart>,
    /// The land to fill: least x, least y, greatest x, greatest y; that of the first range unless given.
    pub bbox: Option<[f64; 4]>,
    /// The CRS of the land; that of the first range unless given.
    pub crs: Option<String>,
    /// Side of the land's cells in metres, on which peaks and saddles stand.
    pub resolution_m: f64,
    /// Number of peaks; by the density of the ranges unless given.
    pub peaks: Option<usize>,
    /// A raster of how many peaks there are beside other places.
    pub density_map: Option<PathBuf>,
    /// A raster of how high the land is beside other places.
    pub elevation_map: Option<PathBuf>,
    /// A raster of the numbers, from 1, of the ranges to be like.
    pub type_map: Option<PathBuf>,
    /// What of a tree is kept, if anything.
    pub keep: Option<KeepPart>,
    /// How to synthesise.
    pub options: SynthesisOptions,
    /// Bytes of memory that may be used; what is free unless given.
    pub memory: Option<u64>,
    /// The options that change results, for the metadata.
    pub command: String,
}

/// What of a tree is kept.
#[derive(Clone, Debug)]
pub struct KeepPart {
    /// The tree: layers that `orograph peaks` wrote, or a text.
    pub tree: PathBuf,
    /// Polygons of the part to keep, in which no new peaks stand; all of the tree is kept unless given.
    pub within: Option<PathBuf>,
}

/// The terrain of a synthesis.
#[derive(Clone, Debug)]
pub struct TerrainPart {
    /// Where to write.
    pub output: RasterOutput,
    /// How it is shaped: where it is not said, as steep and as rough as the ranges that are DEMs.
    pub shape: TerrainShape,
}

/// What was done.
#[derive(Debug)]
pub struct SynthesizeReport {
    /// The survey of the tree.
    pub survey: Survey,
    /// Rows and columns of the land.
    pub size: (usize, usize),
    /// Area of the land in square kilometres.
    pub area_km2: f64,
    /// How far the peaks like each range are from it.
    pub ranges: Vec<RangeReport>,
    /// Peaks that were kept.
    pub kept_peaks: usize,
    /// Ridges that were kept.
    pub kept_ridges: usize,
    /// Kept peaks with another prominence than in the tree that they come from.
    pub altered: usize,
    /// New peaks that found no room at the isolation that was drawn for them.
    pub misplaced: usize,
    /// New peaks that could not have a prominence that was drawn.
    pub misjudged: usize,
    /// The files written.
    pub outputs: Vec<PathBuf>,
    /// How terrain was raised, if it was.
    pub raised: Option<TerrainOptions>,
    /// How long measuring the ranges, making the tree, raising terrain and writing took.
    pub times: [Duration; 4],
}

/// How far the peaks like a range are from it.
#[derive(Debug)]
pub struct RangeReport {
    /// The range.
    pub path: PathBuf,
    /// Its own peaks.
    pub like_peaks: u64,
    /// Those that were made; kept ones do not count.
    pub peaks: u64,
    /// Statistics of those, isolations being those to higher peaks.
    pub domain: Domain,
    /// The distances between the distributions, in the fine bins.
    pub comparisons: Vec<Comparison>,
}

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the ranges, the maps, the output or the options; then no file has changed.
pub fn run(job: &SynthesizeJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<SynthesizeReport> {
    if job.like.len() > 1 && job.type_map.is_none() {
        return Err(Error::usage("--like is given several times: say with --type-map where the land is like which"));
    }
    // Looked at before all work, though the file begins when the land is known.
    if let Some(part) = &job.terrain {
        drop(Output::begin(&part.output.path, part.output.overwrite)?);
    }
    let writer = job.tree.as_ref().map(|path| Writer::begin(path, &NAMES, job.overwrite)).transpose()?;
    let mut outputs = writer.as_ref().map(Writer::targets).unwrap_or_default();
    let begun = Instant::now();
    let mut note = |text: String| warn(&text);
    // The ranges are what terrain is like, unless it is said how steep that is.
    let is_like = job.terrain.as_ref().is_some_and(|part| part.shape.slope.is_none());
    let reading = RangeOptions {
        min_prominence_m: job.min_prominence_m,
        layer: job.layer.as_deref(),
        domain: job.domain.as_deref(),
        memory: job.memory,
        likeness_side_m: is_like.then_some(job.resolution_m),
    };
    let ranges = job.like.iter().map(|path| reading.read(path, watch, &mut note)).collect::<Result<Vec<Range>>>()?;
    let first = ranges.first().ok_or_else(|| Error::usage("--like names no range"))?;
    let land = land(first, job)?;
    let maps = Maps {
        density: job.density_map.as_ref(),
        elevation: job.elevation_map.as_ref(),
        kind: job.type_map.as_ref(),
        memory: job.memory,
    };
    let mut controls = maps.read(&land, watch)?;
    if let Some(KeepPart { tree, within }) = &job.keep {
        let within = within.as_ref().map(|path| polygons(path, &land, &mut note)).transpose()?;
        controls.kept = read_kept(tree, &land, within, &mut note)?;
    }
    let measured = begun.elapsed();
    let begun = Instant::now();
    let to_geographic = own_geographic(land.crs.as_ref())?;
    let metric = land.metric(to_geographic.as_ref())?;
    let extent: Extent<'_, AnyMetric<'_>> = Extent::new(land.rows, land.cols, &metric);
    let targets: Vec<&Target> = ranges.iter().map(|range| &range.target).collect();
    let counts = peak_counts(&extent, &targets, &controls, job.peaks)?;
    let kept = controls.kept.peaks.len() as u64;
    let needed = memory::synthesis_bytes(counts.iter().map(|&count| count as u64).sum::<u64>() + kept);
    memory::admit_or(needed, job.memory.unwrap_or_else(memory::free_bytes), "give fewer peaks")?;
    let made = synthesize(&extent, &targets, &counts, &controls, &job.options, watch)?;
    let survey = survey_tree(&made.tree, &metric)?;
    let reports = report(job, &ranges, &made, &survey, extent.area_km2())?;
    let synthesised = begun.elapsed();
    let begun = Instant::now();
    let metadata = metadata(job, &ranges);
    let raised = match &job.terrain {
        Some(part) => {
            Some(raised(part, job, &ranges, &land, land.cell_m(&metric), &made, &metadata, watch, &mut note)?)
        }
        None => None,
    };
    let raising = begun.elapsed();
    let begun = Instant::now();
    if let Some(writer) = writer {
        let frame = Frame::of_raster(
            land.transform,
            land.cols,
            land.crs.as_ref(),
            to_geographic.as_ref(),
            LengthOutput::Metres,
        );
        let tables: [Box<dyn Table + '_>; 4] = [
            Box::new(PeaksLayer::new(&frame, &survey.peaks, &[])),
            Box::new(SaddlesLayer::new(&frame, &survey.peaks)),
            Box::new(DivideTreeLayer::new(&frame, &survey.edges)),
            Box::new(IsolationLayer::new(&frame, &survey.peaks)),
        ];
        let views: Vec<&dyn Table> = tables.iter().map(AsRef::as_ref).collect();
        writer.write(&views, land.crs.as_ref(), &metadata, watch)?;
    }
    let mut options = None;
    if let Some(Waiting { target, relief, options: chosen }) = raised {
        outputs.extend(target.write(relief, watch, &mut |text| note(text.to_string()))?);
        options = Some(chosen);
    }
    Ok(SynthesizeReport {
        size: land.size(),
        area_km2: extent.area_km2(),
        ranges: reports,
        kept_peaks: controls.kept.peaks.len(),
        kept_ridges: controls.kept.ridges.len(),
        altered: made.altered,
        misplaced: made.misplaced,
        misjudged: made.misjudged,
        outputs,
        raised: options,
        times: [measured, synthesised, raising, begun.elapsed()],
        survey,
    })
}

/// The land to fill: its box and its CRS are those of the range unless given.
fn land(range: &Range, job: &SynthesizeJob) -> Result<Land> {
    let place = range.place.as_ref();
    let own_crs = place.and_then(|place| place.crs.clone());
    let given = job.crs.as_deref().map(parse_crs).transpose()?;
    let is_elsewhere = given.as_ref().is_some_and(|given| own_crs.as_ref().is_none_or(|own| own.wkt != given.wkt));
    let bbox = match (job.bbox, place) {
        (Some(bbox), _) => bbox,
        (None, Some(place)) if !is_elsewhere => place.bbox,
        (None, Some(_)) => {
            return Err(Error::usage("--crs is not the range's own: say with --bbox which land to fill in it"));
        }
        (None, None) => {
            return Err(Error::usage(
                "statistics do not say where the range is: say with --bbox, in units of --crs or in metres, which land to fill",
            ));
        }
    };
    Land::covering(bbox, given.or(own_crs), job.resolution_m)
}

/// The cells of some land that lie in the polygons of a file.
fn polygons(path: &Path, land: &Land, note: &mut dyn FnMut(String)) -> Result<CellSet> {
    let regions = Regions::read_nameless(path, land.crs.as_ref(), note)?;
    let cells = regions.cells(&land.transform, land.size()).pop().map(|(_, cells)| cells);
    cells.filter(|cells| cells.count() > 0).ok_or_else(|| {
        let message = "none of its polygons lies on the land; check where they lie, and in which CRS";
        Error::new(ErrorKind::Input, message).at_path(path)
    })
}

/// Terrain that waits to be written.
struct Waiting {
    target: TerrainTarget,
    relief: Relief,
    options: TerrainOptions,
}

/// Raises terrain on a tree.
#[allow(clippy::too_many_arguments, reason = "a step of the job, with what it knows")]
fn raised(
    part: &TerrainPart,
    job: &SynthesizeJob,
    ranges: &[Range],
    land: &Land,
    cell_m: [f64; 2],
    made: &Synthesis,
    metadata: &[(String, String)],
    watch: &Watch,
    note: &mut dyn FnMut(String),
) -> Result<Waiting> {
    let target = TerrainTarget::begin(&part.output, land, metadata)?;
    let skeleton = Skeleton::of_tree(&made.tree, &|pass| made.kept_passes[pass].is_some(), cell_m, job.options.seed);
    // Whoever says how steep the ground is gets it as it is: nothing is chosen.
    let likes = ranges.iter().map(|range| range.likeness.as_ref()).collect();
    let like = TerrainLike { likes, kinds: &made.kinds };
    let options =
        part.shape.options(&skeleton, land, Some(&like).filter(|_| part.shape.slope.is_none()), job.memory, watch)?;
    let Raised { relief, crossings } = raise(&skeleton, &options, watch)?;
    tell_crossings(&skeleton, land, &crossings, &mut |text| note(text.to_string()));
    Ok(Waiting { target, relief, options })
}

/// Holds the new peaks against the ranges.
fn report(
    job: &SynthesizeJob,
    ranges: &[Range],
    made: &Synthesis,
    survey: &Survey,
    area_km2: f64,
) -> Result<Vec<RangeReport>> {
    let new = made.tree.peaks.iter().zip(&made.kinds).zip(&made.kept).filter(|(_, kept)| kept.is_none());
    let kind_of: std::collections::BTreeMap<u64, usize> = new.map(|((peak, &kind), _)| (peak.0, kind)).collect();
    let report = |(kind, (range, path)): (usize, (&Range, &PathBuf))| {
        let peaks: Vec<PeakMeasures> =
            survey.peaks.iter().filter(|peak| kind_of.get(&peak.cell) == Some(&kind)).map(PeakMeasures::from).collect();
        let domain = Domain::measure(&Selection::Whole, &peaks, range.radius_m, None, Some(area_km2))?;
        Ok(RangeReport {
            path: path.clone(),
            like_peaks: range.domain.peak_count,
            peaks: domain.peak_count,
            comparisons: compare(&range.domain, &domain, BinSet::Fine, range.radius_m)?,
            domain,
        })
    };
    ranges.iter().zip(&job.like).enumerate().map(report).collect()
}

/// What the output says of its origin: nothing that differs from run to run.
fn metadata(job: &SynthesizeJob, ranges: &[Range]) -> Vec<(String, String)> {
    let text = |value: &str| value.to_string();
    let mut command = job.command.clone();
    // Whoever counts the peaks wants to know which are missing, also where nobody said.
    let least_m = ranges.iter().filter_map(|range| range.threshold_m).reduce(f64::min);
    if let Some(least_m) = least_m.filter(|_| job.min_prominence_m.is_none()) {
        command.push_str(&format!(" --min-prominence {least_m}m"));
    }
    vec![
        (text("OROGRAPH_COMMAND"), command),
        (text("OROGRAPH_VERSION"), text(env!("CARGO_PKG_VERSION"))),
        (
            text("OROGRAPH_DEFINITIONS"),
            text("synthesised after Argudo et al. 2019; isolation: distance to the nearest strictly higher peak"),
        ),
    ]
}
