//! What to do, and what was done.

use super::super::land::Land;
use super::super::surveying::own_geographic;
use super::drawn::DrawnTree;
use super::kept::read;
use super::shape::TerrainShape;
use super::write::{RasterOutput, TerrainTarget};
use crate::crs::Crs;
use crate::error::Result;
use crate::io::raster::parse_crs;
use crate::synthesis::terrain::{Skeleton, raise};
use crate::watch::Watch;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// What to do.
#[derive(Clone, Debug)]
pub struct TerrainJob {
    /// The tree: layers that `orograph peaks` wrote, or a text.
    pub tree: PathBuf,
    /// Where to write.
    pub output: RasterOutput,
    /// CRS of a tree that has none.
    pub crs: Option<String>,
    /// The land: least x, least y, greatest x, greatest y; all that is drawn unless given.
    pub bbox: Option<[f64; 4]>,
    /// Side of a cell in metres.
    pub resolution_m: f64,
    /// How the terrain is shaped.
    pub shape: TerrainShape,
    /// Bytes of memory that may be used; what is free unless given.
    pub memory: Option<u64>,
    /// The options that change results, for the metadata.
    pub command: String,
}

/// What was done.
#[derive(Clone, Debug)]
pub struct TerrainReport {
    /// Rows and columns.
    pub size: (usize, usize),
    /// Width and height of a cell in metres.
    pub cell_m: [f64; 2],
    /// Peaks of the tree.
    pub peaks: usize,
    /// Its saddles.
    pub saddles: usize,
    /// Pairs of ridges that meet higher than the tree has it.
    pub crossings: usize,
    /// Least and greatest elevation in metres.
    pub range_m: (f32, f32),
    /// The CRS.
    pub crs: Option<String>,
    /// GDAL's name of the format that was written.
    pub format: String,
    /// The files written.
    pub outputs: Vec<PathBuf>,
    /// How long reading, raising and writing took.
    pub times: [Duration; 3],
}

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the tree, the map, the output or the options; then no file has changed.
pub fn run(job: &TerrainJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<TerrainReport> {
    let begun = Instant::now();
    let mut tree = read(&job.tree)?;
    if tree.crs.is_none() {
        tree.crs = job.crs.as_deref().map(parse_crs).transpose()?;
    } else if job.crs.is_some() {
        warn("--crs is for trees without a CRS; the tree's own stays");
    }
    let land = land(job, &tree)?;
    let to_geographic = own_geographic(land.crs.as_ref())?;
    let cell_m = land.cell_m(&land.metric(to_geographic.as_ref())?);
    let skeleton = tree.placed(&land, cell_m, warn).map_err(|error| error.at_path(&job.tree))?;
    let options = job.shape.options(&skeleton, &land, None, job.memory, watch)?;
    let metadata = vec![
        ("OROGRAPH_COMMAND".to_string(), job.command.clone()),
        ("OROGRAPH_VERSION".to_string(), env!("CARGO_PKG_VERSION").to_string()),
    ];
    let target = TerrainTarget::begin(&job.output, &land, &metadata)?;
    let read = begun.elapsed();
    let begun = Instant::now();
    let raised = raise(&skeleton, &options, watch)?;
    tell_crossings(&skeleton, &land, &raised.crossings, warn);
    let range_m = raised.relief.z_m().iter().fold((f32::INFINITY, f32::NEG_INFINITY), |r, &z| (r.0.min(z), r.1.max(z)));
    let made = begun.elapsed();
    let begun = Instant::now();
    let format = target.format.clone();
    let outputs = target.write(raised.relief, watch, warn)?;
    Ok(TerrainReport {
        size: land.size(),
        cell_m,
        peaks: skeleton.peaks.len(),
        saddles: skeleton.saddles.len(),
        crossings: raised.crossings.len(),
        range_m,
        crs: land.crs.as_ref().map(|crs| crs.label().to_string()),
        format,
        outputs,
        times: [read, made, begun.elapsed()],
    })
}

/// The land of a tree: all that is drawn, with half a cell around it, unless given.
fn land(job: &TerrainJob, tree: &DrawnTree) -> Result<Land> {
    let crs: Option<Crs> = tree.crs.clone();
    if let Some(bbox) = job.bbox {
        return Land::covering(bbox, crs, job.resolution_m);
    }
    let [west, south, east, north] = tree.bbox();
    // A tree of one peak has no size.
    let probe = Land::covering([west, south, west + 1.0, south + 1.0], crs.clone(), job.resolution_m)?;
    let half = probe.transform.0[1] / 2.0;
    Land::covering([west - half, south - half, east + half, north + half], crs, job.resolution_m)
}

/// Most pairs of crossing ridges that are named.
const NAMED: usize = 5;

/// Says which ridges cross.
pub(in super::super) fn tell_crossings(
    skeleton: &Skeleton,
    land: &Land,
    crossings: &[[u32; 2]],
    warn: &mut dyn FnMut(&str),
) {
    for pair in crossings.iter().take(NAMED) {
        let [a, b] = pair.map(|ridge| {
            let peak = &skeleton.peaks[skeleton.ridges[ridge as usize].peak as usize];
            let (x, y) = land.transform.centre(peak.row as f64, peak.col as f64);
            format!("{x:.6}, {y:.6}")
        });
        warn(&format!("the ridges up to the peaks at {a} and {b} cross: the terrain joins these higher than the tree"));
    }
    if crossings.len() > NAMED {
        warn(&format!("and {} more pairs of ridges cross", crossings.len() - NAMED));
    }
}
