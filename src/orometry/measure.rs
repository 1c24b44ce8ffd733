//! The survey: from a grid to the peaks with all their measures.
//!
//! The steps, each in a file of its own: the divide tree of the whole raster (`divide`, from `tile` and `forest`),
//! its pruning and the parents (`prune`), isolation (`isolation`, on `pyramid`), the lines (`ridge`).

use super::divide::{DivideForest, NO_CELL};
use super::isolation::{Isolations, Search};
use super::lowest::Lowest;
use super::prune::{PrunedPeak, prune};
use super::ridge::{Ridges, Steps};
use super::survey::{Isolation, KeySaddle, Peak, Survey, SurveyOptions, TreeEdge};
use crate::crs::{Metric, Place};
use crate::error::Result;
use crate::grid::{AnyGrid, Cell, Elevations, Grid, Key};
use crate::watch::Watch;
use crate::with_grid;
use rayon::prelude::*;

/// Surveys a raster: finds its peaks and its divide tree, and measures them.
///
/// The result depends on the grid and the options alone, not on [`SurveyOptions::tile`] or the number of threads.
///
/// # Errors
/// When the watch was cancelled, or the raster has too many peaks to number them.
///
/// # Complexity
/// One pass over the cells, then `n log n` in the number of passes between basins; the isolation of a peak takes
/// about the logarithm of its distance in cells.
pub fn survey<M: Metric + ?Sized>(
    grid: &AnyGrid,
    elevations: &Elevations,
    metric: &M,
    options: &SurveyOptions,
    watch: &Watch,
) -> Result<Survey> {
    with_grid!(grid, grid => survey_keys(grid, elevations, metric, options, watch))
}

fn survey_keys<K: Key, M: Metric + ?Sized>(
    grid: &Grid<K>,
    elevations: &Elevations,
    metric: &M,
    options: &SurveyOptions,
    watch: &Watch,
) -> Result<Survey> {
    let forest = DivideForest::grow(grid, options.nodata_is_sea, options.tile.max(1), watch)?;
    let key_of = |cell| grid.key(cell);
    let mut pruned = prune(&forest, key_of, elevations, options.base_level_m, options.min_prominence_m);
    let roots = Roots { grid, elevations, metric, options };
    roots.measure(&forest, &mut pruned);
    let ids = give_ids(&pruned);
    let mut peaks = measure_peaks(grid, elevations, metric, options, &pruned, &ids, watch)?;
    relate_to_greatest(&mut peaks);
    watch.check()?;
    let edges = draw_edges(grid, elevations, metric, options, &forest, &pruned, &ids, watch)?;
    let highest = pruned.iter().map(|peak| (peak.key, std::cmp::Reverse(peak.cell))).max().map(|top| top.1.0);
    // A root other than the highest has no prominence but its lower bound.
    peaks.retain(|peak| {
        let is_other_root = peak.is_root && Some(peak.cell) != highest;
        let prominence_m = if is_other_root { peak.prominence_min_m } else { peak.prominence_m };
        prominence_m >= options.min_prominence_m
    });
    peaks.retain(|peak| passes_filters(peak, options));
    peaks.par_sort_unstable_by_key(|peak| peak.id);
    Ok(Survey { peaks, edges, local_peaks: forest.cells.len() as u64 })
}

fn passes_filters(peak: &Peak, options: &SurveyOptions) -> bool {
    let Some(isolation) = &peak.isolation else { return !options.certain_only || peak.prominence_certain };
    isolation.isolation_m.is_none_or(|isolation_m| isolation_m >= options.min_isolation_m)
        && (!options.certain_only || (peak.prominence_certain && isolation.certain))
}

/// The prominences of the tops of components, which have no key saddle.
struct Roots<'a, K, M: ?Sized> {
    grid: &'a Grid<K>,
    elevations: &'a Elevations,
    metric: &'a M,
    options: &'a SurveyOptions,
}

impl<K: Key, M: Metric + ?Sized> Roots<'_, K, M> {
    fn measure(&self, forest: &DivideForest<K>, peaks: &mut [PrunedPeak<K>]) {
        let mut lowest = None;
        // Nothing is unknown on a whole globe without voids, although no way leads across its poles. Only there are all
        // cells looked at.
        let all_known = self.grid.wraps()
            && self.metric.is_whole_globe(self.grid.rows() as i64)
            && (self.options.nodata_is_sea || !self.grid.cells().contains(&K::VOID));
        for peak in peaks.iter_mut().filter(|peak| peak.edge.is_none()) {
            let elevation_m = self.elevations.elevation_m(peak.key.to_i64());
            let touch = forest.touches[peak.number as usize];
            peak.prominence_m = match self.options.base_level_m {
                Some(base) => elevation_m - base,
                None if elevation_m > 0.0 => elevation_m,
                None => {
                    let least = lowest.get_or_insert_with(|| Lowest::new(self.grid)).key(peak.cell);
                    self.elevations.height_m(peak.key.to_i64(), least.to_i64())
                }
            };
            peak.certain = touch == NO_CELL || all_known;
            if peak.certain {
                peak.prominence_min_m = peak.prominence_m;
            }
        }
    }
}

/// Ids by position in the pruned tree: by prominence, then by index. Roots other than the dataset's highest are
/// ordered by the lower end of their interval.
pub(super) fn give_ids<K: Key>(peaks: &[PrunedPeak<K>]) -> Vec<u32> {
    let highest = (0..peaks.len()).max_by_key(|&i| (peaks[i].key, std::cmp::Reverse(peaks[i].cell)));
    let weight = |i: usize| {
        let is_other_root = peaks[i].edge.is_none() && Some(i) != highest;
        if is_other_root { peaks[i].prominence_min_m } else { peaks[i].prominence_m }
    };
    let mut order: Vec<usize> = (0..peaks.len()).collect();
    order.par_sort_unstable_by(|&i, &j| weight(j).total_cmp(&weight(i)).then(peaks[i].cell.cmp(&peaks[j].cell)));
    let mut ids = vec![0; peaks.len()];
    for (id, i) in (1..).zip(order) {
        ids[i] = id;
    }
    ids
}

/// How many peaks are measured between two looks at the watch.
const BATCH: usize = 256;

fn measure_peaks<K: Key, M: Metric + ?Sized>(
    grid: &Grid<K>,
    elevations: &Elevations,
    metric: &M,
    options: &SurveyOptions,
    pruned: &[PrunedPeak<K>],
    ids: &[u32],
    watch: &Watch,
) -> Result<Vec<Peak>> {
    watch.begin("measuring peaks", pruned.len() as u64);
    let isolations = options.isolation.then(|| Isolations::new(grid, metric, options.nodata_is_sea));
    let place = |cell: Cell| -> Place {
        let (row, col) = grid.place(cell);
        (row as i64, col as i64)
    };
    let measured: Vec<Vec<Peak>> = pruned
        .par_chunks(BATCH)
        .zip(ids.par_chunks(BATCH))
        .map_init(Search::default, |search, (batch, batch_ids)| {
            watch.advance(batch.len() as u64)?;
            let peaks = batch.iter().zip(batch_ids).map(|(peak, &id)| {
                let isolation = isolations.as_ref().map(|isolations| isolations.measure(peak.cell, search));
                measure_peak(&place, elevations, metric, pruned, ids, peak, id, isolation)
            });
            Ok(peaks.collect())
        })
        .collect::<Result<_>>()?;
    Ok(measured.into_iter().flatten().collect())
}

#[allow(clippy::too_many_arguments, reason = "one row of the result needs all that is known")]
pub(super) fn measure_peak<K: Key, M: Metric + ?Sized>(
    place: &impl Fn(Cell) -> Place,
    elevations: &Elevations,
    metric: &M,
    pruned: &[PrunedPeak<K>],
    ids: &[u32],
    peak: &PrunedPeak<K>,
    id: u32,
    isolation: Option<Isolation>,
) -> Peak {
    let key_saddle = peak.edge.map(|edge| {
        let vector = metric.vector(place(peak.cell), place(edge.join.saddle));
        KeySaddle {
            cell: edge.join.saddle,
            elevation_m: elevations.elevation_m(edge.join.key.to_i64()),
            distance_m: vector.distance_m,
            azimuth: vector.azimuth,
        }
    });
    let elevation_m = elevations.elevation_m(peak.key.to_i64());
    let id_of = |position: u32| ids[position as usize];
    // Along the way up only the top of the component may turn out not to have the greater prominence.
    let prominence_parent = peak.prominence_parent.filter(|&p| pruned[p as usize].prominence_m > peak.prominence_m);
    Peak {
        id,
        cell: peak.cell,
        elevation_m,
        prominence_m: peak.prominence_m,
        prominence_min_m: peak.prominence_min_m,
        prominence_certain: peak.certain,
        is_root: peak.edge.is_none(),
        key_saddle,
        island_parent: peak.island_parent.map(id_of),
        prominence_parent: prominence_parent.map(id_of),
        line_parent: peak.line_parent.map(id_of),
        isolation,
        dominance: (elevation_m > 0.0).then(|| peak.prominence_m / elevation_m),
        relative_prominence: None,
        relative_elevation: None,
        relevance: None,
    }
}

/// Fills in what relates the peaks to the greatest prominence and elevation among them (Argudo et al. 2019, 4.1).
pub(super) fn relate_to_greatest(peaks: &mut [Peak]) {
    let greatest = |of: fn(&Peak) -> f64| peaks.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
    let prominence_m = greatest(|peak| peak.prominence_m);
    let elevation_m = greatest(|peak| peak.elevation_m);
    for peak in peaks {
        peak.relative_prominence = (prominence_m > 0.0).then(|| peak.prominence_m / prominence_m);
        peak.relative_elevation = (elevation_m > 0.0).then(|| peak.elevation_m / elevation_m);
        peak.relevance = match (peak.relative_prominence, peak.relative_elevation) {
            (Some(p), Some(e)) if p >= 0.0 && e >= 0.0 => Some((p * e).sqrt()),
            _ => None,
        };
    }
}

#[allow(clippy::too_many_arguments, reason = "one row of the result needs all that is known")]
fn draw_edges<K: Key, M: Metric + ?Sized>(
    grid: &Grid<K>,
    elevations: &Elevations,
    metric: &M,
    options: &SurveyOptions,
    forest: &DivideForest<K>,
    pruned: &[PrunedPeak<K>],
    ids: &[u32],
    watch: &Watch,
) -> Result<Vec<TreeEdge>> {
    let lines =
        options.ridges.then(|| (Ridges::new(grid, forest, pruned), Steps::new(metric, grid.rows(), grid.cols())));
    let mut edges: Vec<TreeEdge> = pruned
        .par_iter()
        .enumerate()
        .filter_map(|(i, peak)| peak.edge.map(|edge| (i, peak, edge)))
        .map(|(i, peak, edge)| {
            watch.check()?;
            let (a, b) = if edge.join.near_is_a { (edge.near, edge.far) } else { (edge.far, edge.near) };
            let path = lines.as_ref().map_or_else(Vec::new, |(ridges, _)| ridges.path(&edge));
            Ok(TreeEdge {
                peak_a: ids[a as usize],
                peak_b: ids[b as usize],
                saddle: ids[i],
                saddle_cell: edge.join.saddle,
                saddle_elevation_m: elevations.elevation_m(edge.join.key.to_i64()),
                prominence_m: peak.prominence_m,
                length_m: lines.as_ref().map_or(f64::NAN, |(_, steps)| steps.length_m(&path)),
                path,
            })
        })
        .collect::<Result<_>>()?;
    edges.par_sort_unstable_by_key(|edge| edge.saddle);
    Ok(edges)
}
