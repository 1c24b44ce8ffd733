//! The definitions of orometry, spelled out slowly: what the fast algorithm has to agree with.
//!
//! Nothing here is clever. All cells are sorted and swept from above to below with a union-find; certificates come
//! from a second sweep with the virtual cell and from flood fills; isolation looks at every cell. The only things
//! shared with the crate are the raster itself, the meaning of its keys and the metric.
//!
//! Where the definitions leave room, this is how they are read here:
//! - A root's component that touches nothing unknown (an island in a sea of known voids) is certain, like every root
//!   of a whole globe without unknown voids; its lower bound is then its prominence.
//! - "Greatest prominence of the dataset" is the greatest `prominence_m` of the peaks of the pruned tree, with a row or
//!   without.
//! - A ridge line is the walk as defined, edge by edge; where two edges share a stretch it goes there and back.

#![allow(dead_code, unreachable_pub, reason = "each test binary has the reference as a module and uses its own part")]

mod certificate;
mod isolation;
mod ridge;
mod sweep;
mod tree;

use orograph::crs::Metric;
use orograph::grid::{Cell, Elevations, Grid, Key};
use std::collections::BTreeMap;
use sweep::{Join, Raster, Sweep};

/// What is asked.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// Prominence threshold in metres.
    pub min_prominence_m: f64,
    /// `--base-level` in metres.
    pub base_level_m: Option<f64>,
    /// `--nodata-is-sea`.
    pub nodata_is_sea: bool,
    /// Whether isolation is measured.
    pub isolation: bool,
    /// Whether the ridge lines are drawn.
    pub ridges: bool,
    /// The outside of the raster, for the lower bound of the isolation.
    pub frame: Option<Frame<'a>>,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Self {
            min_prominence_m: 0.0,
            base_level_m: None,
            nodata_is_sea: false,
            isolation: true,
            ridges: true,
            frame: None,
        }
    }
}

/// Cells around the raster that are looked at as unknown ones; without it those next to the raster only.
///
/// A metric may know no more of the outside than its first ring, so a wider frame brings a metric of its own: that of
/// the larger raster.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    /// Metric of the larger raster.
    pub metric: &'a dyn Metric,
    /// Rows and columns by which the larger raster begins before the raster.
    pub before: (i64, i64),
    /// Rows and columns of the larger raster.
    pub size: (usize, usize),
}

/// A peak with all its measures; the fields are those of [`orograph::orometry::Peak`], flat.
#[derive(Clone, Debug, PartialEq)]
pub struct RefPeak {
    pub id: u32,
    pub cell: Cell,
    pub elevation_m: f64,
    pub prominence_m: f64,
    pub prominence_min_m: f64,
    pub prominence_certain: bool,
    pub is_root: bool,
    pub key_saddle: Option<Cell>,
    pub key_saddle_elevation_m: Option<f64>,
    pub saddle_distance_m: Option<f64>,
    pub saddle_azimuth: Option<f64>,
    pub island_parent: Option<u32>,
    pub prominence_parent: Option<u32>,
    pub line_parent: Option<u32>,
    pub isolation: Option<RefIsolation>,
    pub dominance: Option<f64>,
    pub relative_prominence: Option<f64>,
    pub relative_elevation: Option<f64>,
    pub relevance: Option<f64>,
}

/// How far a peak is from higher ground.
#[derive(Clone, Debug, PartialEq)]
pub struct RefIsolation {
    pub isolation_m: Option<f64>,
    pub isolation_min_m: Option<f64>,
    pub certain: bool,
    pub azimuth: f64,
    pub higher: Option<Cell>,
}

/// An edge of the pruned divide tree.
#[derive(Clone, Debug, PartialEq)]
pub struct RefEdge {
    pub peak_a: u32,
    pub peak_b: u32,
    pub saddle: u32,
    pub saddle_cell: Cell,
    pub saddle_elevation_m: f64,
    pub prominence_m: f64,
    pub path: Vec<Cell>,
}

/// Peaks by id, edges by the id of the peak that ends there.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Answer {
    pub peaks: Vec<RefPeak>,
    pub edges: Vec<RefEdge>,
}

impl Answer {
    /// The row of the peak at a cell.
    pub fn at(&self, cell: Cell) -> Option<&RefPeak> {
        self.peaks.iter().find(|p| p.cell == cell)
    }
}

/// Everything that is known of one peak of the sweep, before any pruning.
#[derive(Clone, Debug)]
struct Measured {
    prominence_m: f64,
    prominence_min_m: f64,
    /// The prominence by which the peak is filtered and ordered.
    order_m: f64,
    /// The join that ends it, by position; `None` for a root.
    join: Option<usize>,
}

/// Measures a DEM by the definitions.
pub fn survey<K: Key>(grid: &Grid<K>, elevations: &Elevations, metric: &dyn Metric, options: &Options) -> Answer {
    let raster = Raster::new(grid);
    let sweep = sweep::sweep(&raster);
    // On a whole globe without unknown voids nothing is left that could be higher than the roots.
    let all_known =
        raster.wraps && metric.is_whole_globe(raster.rows) && (options.nodata_is_sea || !raster.has_voids());
    let touching = certificate::touching(&raster, options.nodata_is_sea);
    let ends = certificate::ends_with_virtual_cell(&raster, &touching);
    let measured = measure(&raster, &sweep, elevations, all_known, &ends, options.base_level_m);
    let kept = |peak: Cell| measured[&peak].order_m >= options.min_prominence_m;
    let contracted = |join: &Join| measured[&join.ended].prominence_m < options.min_prominence_m;
    let tree = tree::prune(&raster, &sweep, contracted);

    // Ids over all groups; a group without a row keeps its id, as others may name it.
    let mut groups = tree.groups();
    groups.sort_by(|p, q| {
        measured[q].order_m.partial_cmp(&measured[p].order_m).expect("prominences are numbers").then(p.cmp(q))
    });
    let ids: BTreeMap<Cell, u32> = groups.iter().enumerate().map(|(i, &peak)| (peak, i as u32 + 1)).collect();

    let rows: Vec<Cell> = groups.iter().copied().filter(|&peak| kept(peak)).collect();
    let greatest_m = groups.iter().map(|p| measured[p].prominence_m).fold(f64::NEG_INFINITY, f64::max);
    let highest_m = sweep.peaks.first().map_or(f64::NAN, |&p| elevations.elevation_m(raster.key(p)));
    let peaks = rows
        .iter()
        .map(|&peak| {
            let m = &measured[&peak];
            let join = m.join.map(|j| &sweep.joins[j]);
            let way = join.map(|join| tree.way_to_island_parent(join));
            let elevation_m = elevations.elevation_m(raster.key(peak));
            let toward = join.map(|join| metric.vector(raster.place(peak), raster.place(join.saddle)));
            let relative_prominence = (greatest_m > 0.0).then(|| m.prominence_m / greatest_m);
            let relative_elevation = (highest_m > 0.0).then(|| elevation_m / highest_m);
            RefPeak {
                id: ids[&peak],
                cell: peak,
                elevation_m,
                prominence_m: m.prominence_m,
                prominence_min_m: m.prominence_min_m,
                prominence_certain: match join {
                    Some(join) => !certificate::island_touches(&raster, peak, join.saddle, &touching),
                    None => all_known || !ends.contains_key(&peak),
                },
                is_root: join.is_none(),
                key_saddle: join.map(|join| join.saddle),
                key_saddle_elevation_m: join.map(|join| elevations.elevation_m(raster.key(join.saddle))),
                saddle_distance_m: toward.map(|v| v.distance_m),
                saddle_azimuth: toward.map(|v| v.azimuth),
                island_parent: join.map(|join| ids[&join.winner]),
                prominence_parent: way
                    .as_ref()
                    .and_then(|way| way.iter().find(|q| measured[q].prominence_m > m.prominence_m).map(|q| ids[q])),
                line_parent: way
                    .as_ref()
                    .and_then(|way| way.iter().find(|&&q| raster.is_above(q, peak)).map(|q| ids[q])),
                isolation: options.isolation.then(|| isolation::isolation(&raster, metric, peak, options)),
                dominance: (elevation_m > 0.0).then(|| m.prominence_m / elevation_m),
                relative_prominence,
                relative_elevation,
                relevance: match (relative_prominence, relative_elevation) {
                    (Some(p), Some(e)) if p >= 0.0 && e >= 0.0 => Some((p * e).sqrt()),
                    _ => None,
                },
            }
        })
        .collect();

    let mut edges: Vec<RefEdge> = tree
        .edges()
        .map(|join| RefEdge {
            peak_a: ids[&tree.group(join.a)],
            peak_b: ids[&tree.group(join.b)],
            saddle: ids[&join.ended],
            saddle_cell: join.saddle,
            saddle_elevation_m: elevations.elevation_m(raster.key(join.saddle)),
            prominence_m: measured[&join.ended].prominence_m,
            path: if options.ridges { ridge::path(&raster, &tree, join) } else { vec![] },
        })
        .collect();
    edges.sort_by_key(|edge| edge.saddle);
    Answer { peaks, edges }
}

/// The keys of all pairs (peak, key saddle) with a positive difference, roots aside: all that persistence knows.
pub fn pairs<K: Key>(grid: &Grid<K>) -> Vec<(i64, i64)> {
    let raster = Raster::new(grid);
    let joins = sweep::sweep(&raster).joins;
    let mut pairs: Vec<(i64, i64)> =
        joins.iter().map(|join| (raster.key(join.ended), raster.key(join.saddle))).filter(|(p, s)| p > s).collect();
    pairs.sort_unstable();
    pairs
}

/// The isolations of cells, whether they are peaks or not.
pub fn isolations<K: Key>(grid: &Grid<K>, metric: &dyn Metric, cells: &[Cell], options: &Options) -> Vec<RefIsolation> {
    let raster = Raster::new(grid);
    cells.iter().map(|&cell| isolation::isolation(&raster, metric, cell, options)).collect()
}

/// Prominence and its lower bound for every peak, by cell.
///
/// `ends` is where each peak ends in the graph with the virtual cell.
fn measure(
    raster: &Raster,
    sweep: &Sweep,
    elevations: &Elevations,
    all_known: bool,
    ends: &BTreeMap<Cell, Cell>,
    base_level_m: Option<f64>,
) -> BTreeMap<Cell, Measured> {
    // h(P) - max(h(s), B), the lesser of two differences that are rounded each in its own way.
    let above = |peak: Cell, cell: Cell| {
        let above_cell = elevations.height_m(raster.key(peak), raster.key(cell));
        base_level_m.map_or(above_cell, |base_m| above_cell.min(elevations.elevation_m(raster.key(peak)) - base_m))
    };
    let join_of: BTreeMap<Cell, usize> = sweep.joins.iter().enumerate().map(|(i, join)| (join.ended, i)).collect();
    assert_eq!(join_of.len(), sweep.joins.len(), "a peak ends once");
    let mut measured = BTreeMap::new();
    for &peak in &sweep.peaks {
        let join = join_of.get(&peak).copied();
        let prominence_m = if let Some(j) = join {
            above(peak, sweep.joins[j].saddle)
        } else {
            let elevation_m = elevations.elevation_m(raster.key(peak));
            match base_level_m {
                Some(base_m) => elevation_m - base_m,
                None if elevation_m > 0.0 => elevation_m,
                None => elevations.height_m(raster.key(peak), raster.key(sweep::lowest_beside(raster, peak))),
            }
        };
        let prominence_min_m = match ends.get(&peak) {
            _ if join.is_none() && all_known => prominence_m,
            Some(&end) if end == peak => 0.0,
            Some(&end) => above(peak, end),
            None => prominence_m,
        };
        let highest = sweep.peaks[0] == peak;
        let order_m = if join.is_none() && !highest { prominence_min_m } else { prominence_m };
        measured.insert(peak, Measured { prominence_m, prominence_min_m, order_m, join });
    }
    measured
}
