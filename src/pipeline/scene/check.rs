//! The job behind `orograph scene check`: what a scene holds, and what of it is without use or without bounds.

use super::read::SceneFile;
use crate::construction::{Area, Detail, Lattice, NodeId, Point, THRESHOLD, Tiling, Tree, Want};
use crate::error::{Error, Result};
use crate::interval::Interval;
use crate::watch::Watch;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// Tiles in a row and a column, of which bounds are asked.
const TILES: usize = 32;
/// Samples in a row and a column.
const SAMPLES: usize = 256;
/// Levels of detail at which is looked what shows.
const LEVELS: u32 = 10;
/// Side in metres of what is looked at of a scene without any box.
const ANYWHERE_M: f64 = 1000.0;

/// What to do.
#[derive(Clone, Debug)]
pub struct CheckJob {
    /// The scene.
    pub scene: PathBuf,
    /// The part that is looked at, in the scene's CRS; all that is bounded unless given.
    pub bbox: Option<[f64; 4]>,
    /// Bytes of memory that may be used; what is free unless given.
    pub memory: Option<u64>,
}

/// What is to be said of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Remark {
    /// Nothing refers to it.
    Unused,
    /// It contributes nothing wherever was looked: it lies beside what it is put on, or below what covers it.
    Hidden,
    /// No terrain is defined at all.
    Undefined,
    /// It has no box.
    Endless,
    /// Somewhere there is no bound of its slope, or of its weight's.
    Unbounded,
}

impl Remark {
    /// The remark's name in documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unused => "unused",
            Self::Hidden => "hidden",
            Self::Undefined => "undefined",
            Self::Endless => "endless",
            Self::Unbounded => "unbounded",
        }
    }

    /// Whether it is a fault, not just something to know.
    pub fn is_fault(self) -> bool {
        matches!(self, Self::Unused | Self::Hidden | Self::Undefined)
    }
}

/// A remark about a node.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What is to be said.
    pub remark: Remark,
    /// The node's place in the file.
    pub place: String,
    /// The same in words.
    pub message: String,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct CheckReport {
    /// The files that the scene names.
    pub inputs: Vec<PathBuf>,
    /// The scene's CRS.
    pub crs: Option<String>,
    /// Names of its layers.
    pub layers: Vec<String>,
    /// Nodes in use by kind, as the scene names kinds, and their number.
    pub kinds: BTreeMap<String, usize>,
    /// Primitives and operators in use.
    pub counts: (usize, usize),
    /// Bytes of memory that all nodes take.
    pub bytes: usize,
    /// Least x and y, greatest x and y in the scene's CRS outside of which nothing is defined; may be endless.
    pub support: [f64; 4],
    /// The part that was looked at.
    pub looked_at: [f64; 4],
    /// Bounds of the elevation in metres there.
    pub elevation: Interval,
    /// Bound of the slope where the terrain is defined, metres per metre; may be infinite.
    pub slope: f64,
    /// Share of samples with terrain.
    pub defined: f64,
    /// Least and greatest elevation in metres of the samples, and the steepest slope; if any has terrain.
    pub found: Option<(f64, f64, f64)>,
    /// Remarks, faults first.
    pub findings: Vec<Finding>,
}

/// Runs the job.
///
/// # Errors
/// Whatever is wrong with the scene and its files, or with the box.
pub fn run(job: &CheckJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<CheckReport> {
    let file = SceneFile::open(&job.scene, job.memory, watch)?;
    file.notes.iter().for_each(|note| warn(note));
    let tree = &file.scene.tree;
    let area = looked_at(&file, job.bbox)?;
    let mut roots: Vec<&Tree> = vec![tree];
    roots.extend(file.scene.layers.iter().map(|(_, layer)| layer));
    let in_use: BTreeSet<NodeId> = roots.iter().flat_map(|root| root.reachable()).collect();
    let mut places: BTreeMap<NodeId, &str> = BTreeMap::new();
    for (id, place) in file.scene.places.iter().filter(|(id, _)| in_use.contains(id)) {
        places.entry(*id).or_insert(place);
    }

    watch.begin("checking", 4);
    let tiles = tiles_of(&area);
    let mut findings = unused(&file);
    findings.extend(hidden(&roots, &places, &tiles));
    watch.advance(1)?;
    findings.extend(endless(tree, &places));
    let bounds: Vec<_> = tiles.par_iter().map(|tile| *tree.plan(tile, Want::ALL).bounds()).collect();
    let seen: Vec<_> = bounds.iter().filter(|bounds| !bounds.is_nothing()).collect();
    let ranges = seen.iter().map(|bounds| bounds.elevation);
    let elevation = ranges.reduce(Interval::hull).unwrap_or(Interval::ZERO);
    let slope = seen.iter().fold(0.0_f64, |slope, bounds| slope.max(bounds.terrain_slope()));
    watch.advance(1)?;
    if slope.is_infinite() {
        let loose = tiles.iter().zip(&bounds).filter(|(_, bounds)| bounds.terrain_slope().is_infinite());
        let loose: Vec<Area> = loose.map(|(tile, _)| *tile).collect();
        findings.extend(unbounded(tree, &places, &loose));
    }
    watch.advance(1)?;
    let (defined, found) = samples(tree, &area)?;
    watch.advance(1)?;
    if found.is_none() {
        let message = "no terrain is defined where was looked: no weight of at least 1/2";
        findings.push(Finding { remark: Remark::Undefined, place: "$.root".into(), message: message.into() });
    }
    findings.sort_by_key(|finding| !finding.remark.is_fault());

    let mut kinds: BTreeMap<String, usize> = BTreeMap::new();
    // A raster that is turned, or a terrain of discs, is a primitive in a warp at one place.
    for place in places.values().collect::<BTreeSet<_>>() {
        *kinds.entry(kind_of(place).to_string()).or_default() += 1;
    }
    let primitives = in_use.iter().filter(|&&id| tree.is_primitive(id)).count();
    Ok(CheckReport {
        inputs: file.inputs.clone(),
        crs: file.crs.as_ref().map(|crs| crs.label().to_string()),
        layers: file.scene.layers.iter().map(|(name, _)| name.clone()).collect(),
        kinds,
        counts: (primitives, in_use.len() - primitives),
        bytes: tree.bytes(),
        support: in_crs(&tree.support(), &file),
        looked_at: in_crs(&area, &file),
        elevation,
        slope,
        defined,
        found,
        findings,
    })
}

/// The kind of a node by its place: the last member that it names.
fn kind_of(place: &str) -> &str {
    let plain = place.split(", ").next().unwrap_or(place);
    plain.rsplit('.').next().unwrap_or(plain)
}

/// A box in the scene's CRS.
fn in_crs(area: &Area, file: &SceneFile) -> [f64; 4] {
    let [x, y] = file.scene.origin;
    [area.x.min + x, area.y.min + y, area.x.max + x, area.y.max + y]
}

/// What to look at: the box that is given, that of the scene, or that of all its nodes that have one.
fn looked_at(file: &SceneFile, bbox: Option<[f64; 4]>) -> Result<Area> {
    let tree = &file.scene.tree;
    let [ox, oy] = file.scene.origin;
    if let Some([x0, y0, x1, y1]) = bbox {
        if x0 >= x1 || y0 >= y1 || ![x0, y0, x1, y1].iter().all(|v| v.is_finite()) {
            let message = format!("--bbox {x0},{y0},{x1},{y1}: expected xmin,ymin,xmax,ymax in the scene's CRS");
            return Err(Error::usage(message));
        }
        return Ok(Area::of(&[[x0 - ox, y0 - oy], [x1 - ox, y1 - oy]]));
    }
    let is_bounded = |area: &Area| {
        !area.is_empty() && [area.x.min, area.x.max, area.y.min, area.y.max].iter().all(|v| v.is_finite())
    };
    if is_bounded(&tree.support()) {
        return Ok(tree.support());
    }
    // Nodes in warps lie elsewhere, but the warps themselves are nodes too.
    let all = tree.reachable().into_iter().map(|id| tree.support_of(id)).filter(is_bounded);
    let all = all.fold(Area::EMPTY, |all, area| all.hull(&area));
    let anywhere = Area::of(&[[0.0, 0.0], [ANYWHERE_M, ANYWHERE_M]]);
    Ok(if is_bounded(&all) { all } else { anywhere })
}

fn tiles_of(area: &Area) -> Vec<Area> {
    let cut = |range: Interval, i: usize| range.min + range.width() * (i as f64 / TILES as f64);
    let tile = |k: usize| {
        let (i, j) = (k / TILES, k % TILES);
        Area::of(&[[cut(area.x, j), cut(area.y, i)], [cut(area.x, j + 1), cut(area.y, i + 1)]])
    };
    (0..TILES * TILES).map(tile).collect()
}

fn unused(file: &SceneFile) -> Vec<Finding> {
    let names = file.scene.unused.iter();
    let finding = |name: &String| Finding {
        remark: Remark::Unused,
        place: format!("$.nodes.{name}"),
        message: "nothing refers to it".into(),
    };
    names.map(finding).collect()
}

/// Nodes that contribute nothing to any tile at any level of detail; of those below each other the topmost.
fn hidden(roots: &[&Tree], places: &BTreeMap<NodeId, &str>, tiles: &[Area]) -> Vec<Finding> {
    let mut shown: BTreeSet<NodeId> = BTreeSet::new();
    for root in roots {
        let levels = (0..=LEVELS).map(|i| Detail::Constant(f64::from(i) / f64::from(LEVELS)));
        let trees: Vec<Tree> = levels.map(|level| root.with_detail(level)).collect();
        let minds = trees.len();
        let found: BTreeSet<NodeId> = (0..tiles.len() * minds)
            .into_par_iter()
            .map(|k| trees[k % minds].plan(&tiles[k / minds], Want::ALL).nodes().collect::<BTreeSet<_>>())
            .reduce(BTreeSet::new, |mut all, mut some| {
                all.append(&mut some);
                all
            });
        shown.extend(found);
    }
    let mut findings = vec![];
    let mut told: BTreeSet<NodeId> = BTreeSet::new();
    for root in roots {
        for id in root.reachable().into_iter().filter(|id| shown.contains(id)) {
            for child in root.children(id) {
                if !shown.contains(&child) && told.insert(child) {
                    let place = places.get(&child).copied().unwrap_or("$.root").to_string();
                    let message = "it contributes nothing: it lies beside what it is put on, or another covers it";
                    findings.push(Finding { remark: Remark::Hidden, place, message: message.into() });
                }
            }
        }
    }
    findings
}

/// Primitives without a box, if the scene has none either.
fn endless(tree: &Tree, places: &BTreeMap<NodeId, &str>) -> Vec<Finding> {
    let is_endless = |area: Area| [area.x.min, area.x.max, area.y.min, area.y.max].iter().any(|v| v.is_infinite());
    if tree.support().is_empty() || !is_endless(tree.support()) {
        return vec![];
    }
    let ids = tree.reachable().into_iter();
    let ids = ids.filter(|&id| {
        let area = tree.support_of(id);
        tree.is_primitive(id) && !area.is_empty() && is_endless(area)
    });
    ids.filter_map(|id| places.get(&id))
        .map(|place| Finding {
            remark: Remark::Endless,
            place: (*place).to_string(),
            message: "it reaches everywhere, so the scene has no box of its own: evaluate it with --bbox".into(),
        })
        .collect()
}

/// The lowest nodes without bounds of slopes in the tiles in which the terrain has none.
fn unbounded(tree: &Tree, places: &BTreeMap<NodeId, &str>, tiles: &[Area]) -> Vec<Finding> {
    // Lines of one curve are told as one.
    let mut tiles_of: BTreeMap<&str, usize> = BTreeMap::new();
    for tile in tiles {
        let mut told: BTreeSet<&str> = BTreeSet::new();
        let ids: BTreeSet<NodeId> = tree.plan(tile, Want::ALL).nodes().collect();
        let is_loose = |id: NodeId| {
            let bounds = tree.bounds_of(id, tile);
            bounds.slope.is_infinite() || bounds.weight_slope.is_infinite()
        };
        let loose: BTreeSet<NodeId> = ids.into_iter().filter(|&id| is_loose(id)).collect();
        for &id in &loose {
            if !tree.children(id).iter().any(|child| loose.contains(child)) {
                let place = places.get(&id).copied().unwrap_or("$.root");
                told.insert(place.split(", ").next().unwrap_or(place));
            }
        }
        told.into_iter().for_each(|place| *tiles_of.entry(place).or_default() += 1);
    }
    let finding = |(place, count): (&str, usize)| {
        let reason = match kind_of(place) {
            "image" => "its weight ends with a jump; fade_cells lets it fall",
            "curve" => "a bend, a corner or an end is narrower than radius_m",
            "contour" => "its profiles do not agree at the centre",
            "weigh" => "a weight that depends on a slope has no bound",
            "blend" => "weights of its nodes fall to 0 here",
            _ => "the border of one of its nodes is a jump",
        };
        let share = 100.0 * count as f64 / (TILES * TILES) as f64;
        let message = format!("no bound of slope in {share:.1} % of the tiles ({reason}); drawing takes longer there");
        Finding { remark: Remark::Unbounded, place: place.to_string(), message }
    };
    tiles_of.into_iter().map(finding).collect()
}

/// A sampled point: elevation, slope, and whether there is terrain.
#[derive(Clone, Copy, Default)]
struct Sampled {
    elevation_m: f64,
    slope: f64,
    is_defined: bool,
}

/// Least and greatest elevation in metres, and the steepest slope.
type Extremes = (f64, f64, f64);

/// Share of samples with terrain, and the extremes of these.
fn samples(tree: &Tree, area: &Area) -> Result<(f64, Option<Extremes>)> {
    let (dx, dy) = (area.x.width() / SAMPLES as f64, area.y.width() / SAMPLES as f64);
    let lattice =
        Lattice { x0: area.x.min + dx / 2.0, y0: area.y.max - dy / 2.0, dx, dy: -dy, cols: SAMPLES, rows: SAMPLES };
    let make = |point: &Point| {
        let f = &point.elevation;
        let slope = (f.dx * f.dx + f.dy * f.dy).sqrt();
        Sampled { elevation_m: f.value + 0.0, slope, is_defined: point.weight.value >= THRESHOLD }
    };
    let all = tree.evaluate(&lattice, Tiling::default(), true, &Watch::default(), make)?;
    let defined: Vec<&Sampled> = all.iter().filter(|sample| sample.is_defined).collect();
    let share = defined.len() as f64 / all.len() as f64;
    let found = defined.iter().fold(None, |found: Option<Extremes>, sample| {
        let (low, high, steep) = found.unwrap_or((f64::INFINITY, f64::NEG_INFINITY, 0.0));
        Some((low.min(sample.elevation_m), high.max(sample.elevation_m), steep.max(sample.slope)))
    });
    Ok((share, found))
}
