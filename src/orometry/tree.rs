//! A divide tree that is given: its peaks are measured as those of a raster are.

use super::crowd::Crowd;
use super::divide::{DivideForest, PeakNumber};
use super::measure::{give_ids, measure_peak, relate_to_greatest};
use super::prune::prune;
use super::survey::{Isolation, Survey, TreeEdge};
use crate::components::root;
use crate::crs::{Metric, Place};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::{Cell, Elevations, SampleType};
use std::collections::BTreeMap;

/// Where the ridges of two peaks of a given tree meet.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenPass {
    /// Positions of the two peaks.
    pub peaks: [u32; 2],
    /// The saddle's cell.
    pub cell: Cell,
    /// The saddle's elevation in metres.
    pub elevation_m: f64,
    /// For each of the peaks the cells at which the ridge bends on its way there from the saddle, without these two.
    pub bends: [Vec<Cell>; 2],
}

impl GivenPass {
    /// Where two straight ridges meet.
    pub fn straight(peaks: [u32; 2], cell: Cell, elevation_m: f64) -> Self {
        Self { peaks, cell, elevation_m, bends: [vec![], vec![]] }
    }
}

/// How many ridges may meet at one saddle.
const MOST_AT_ONE: usize = 100;

/// A divide tree on the cells of a raster, which need not exist.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenTree {
    /// Number of columns of the raster.
    pub cols: usize,
    /// Number of its rows.
    pub rows: usize,
    /// Cells and elevations in metres of the peaks.
    pub peaks: Vec<(Cell, f64)>,
    /// The passes between them: one less than peaks.
    pub passes: Vec<GivenPass>,
}

impl GivenTree {
    /// Checks that it is a tree, all in one piece, its peaks on cells of their own, with every saddle below both of its
    /// peaks. Several ridges may meet at one saddle.
    ///
    /// # Errors
    /// `Corrupt`, with the first fault.
    pub fn check(&self) -> Result<()> {
        let wrong = |message: String| Err(Error::new(ErrorKind::Corrupt, message));
        if self.peaks.len() != self.passes.len() + 1 {
            return wrong(format!("{} peaks and {} saddles make no tree", self.peaks.len(), self.passes.len()));
        }
        let mut saddles: Vec<Cell> = self.passes.iter().map(|pass| pass.cell).collect();
        saddles.sort_unstable();
        if let Some(crowd) = saddles.chunk_by(|a, b| a == b).find(|crowd| crowd.len() > MOST_AT_ONE) {
            return wrong(format!("{} ridges meet at the saddle in cell {}", crowd.len(), crowd[0]));
        }
        saddles.dedup();
        let mut cells: Vec<Cell> = self.peaks.iter().map(|peak| peak.0).chain(saddles).collect();
        cells.sort_unstable();
        if let Some(pair) = cells.windows(2).find(|pair| pair[0] == pair[1]) {
            return wrong(format!("two peaks, or a peak and a saddle, are in cell {}", pair[0]));
        }
        let bends = self.passes.iter().flat_map(|pass| pass.bends.iter().flatten());
        if cells.last().into_iter().chain(bends).any(|&cell| cell >= self.rows as u64 * self.cols as u64) {
            return wrong("a peak, a saddle or a bend lies outside of the raster".into());
        }
        if let Some(peak) = self.peaks.iter().find(|peak| !peak.1.is_finite()) {
            return wrong(format!("{} is not the elevation of a peak", peak.1));
        }
        let mut component: Vec<u32> = (0..).take(self.peaks.len()).collect();
        for pass in &self.passes {
            let Some([p, q]) = self.ends(pass) else {
                return wrong(format!("a saddle is between peaks {:?}, which are not there", pass.peaks));
            };
            // A saddle that is NaN is below nothing.
            if !(pass.elevation_m < p.1 && pass.elevation_m < q.1) {
                return wrong(format!(
                    "a saddle at {} m is not below its peaks at {} and {} m",
                    pass.elevation_m, p.1, q.1
                ));
            }
            let [a, b] = pass.peaks.map(|peak| root(&mut component, peak));
            if a == b {
                return wrong(format!("ridges close a ring at the saddle in cell {}", pass.cell));
            }
            component[a as usize] = b;
        }
        Ok(())
    }

    fn ends(&self, pass: &GivenPass) -> Option<[(Cell, f64); 2]> {
        let [a, b] = pass.peaks.map(|peak| self.peaks.get(peak as usize).copied());
        Some([a?, b?])
    }

    fn place(&self, cell: Cell) -> Place {
        let cols = self.cols as u64;
        ((cell / cols) as i64, (cell % cols) as i64)
    }
}

/// Measures the peaks of a given tree: prominences, parents, ids as on a raster, and isolations to the nearest higher
/// *peak*, as nothing is known of the ground between them. Everything is certain.
///
/// # Errors
/// As [`GivenTree::check`].
///
/// # Complexity
/// `n log n`.
pub fn survey_tree<M: Metric + ?Sized>(tree: &GivenTree, metric: &M) -> Result<Survey> {
    tree.check()?;
    let elevations = Elevations::metres(SampleType::F64);
    let key = |elevation_m: f64| elevations.key_of(elevation_m);
    let (cells, keys): (Vec<Cell>, Vec<i64>) = tree.peaks.iter().map(|&(cell, m)| (cell, key(m))).unzip();
    let above_first = |[p, q]: [u32; 2]| {
        let order = |peak: u32| (std::cmp::Reverse(keys[peak as usize]), cells[peak as usize]);
        if order(p) < order(q) { [p, q] } else { [q, p] }
    };
    // Passes of one saddle are told apart by their number there.
    let mut pass_at: BTreeMap<(Cell, u8), &GivenPass> = BTreeMap::new();
    let mut passes: Vec<(i64, Cell, u8, [PeakNumber; 2])> = Vec::with_capacity(tree.passes.len());
    for pass in &tree.passes {
        let cell = pass.cell;
        let nth = pass_at.range((cell, 0)..=(cell, u8::MAX)).next_back().map_or(0, |((_, last), _)| last + 1);
        pass_at.insert((cell, nth), pass);
        passes.push((key(pass.elevation_m), cell, nth, above_first(pass.peaks)));
    }
    let forest = DivideForest::of_passes(cells.clone(), keys.clone(), &passes);
    // Where nothing is unknown no other key is asked for.
    let mut pruned = prune(&forest, |_| i64::MIN, &elevations, None, 0.0);
    let lowest_m = tree.passes.iter().map(|pass| pass.elevation_m).fold(f64::INFINITY, f64::min);
    for peak in pruned.iter_mut().filter(|peak| peak.edge.is_none()) {
        let elevation_m = elevations.elevation_m(peak.key);
        peak.prominence_m = if elevation_m > 0.0 { elevation_m } else { elevation_m - lowest_m.min(elevation_m) };
        peak.prominence_min_m = peak.prominence_m;
    }
    let ids = give_ids(&pruned);
    let places: Vec<(Place, f64)> =
        pruned.iter().map(|peak| (tree.place(peak.cell), elevations.elevation_m(peak.key))).collect();
    let isolations = peak_isolations((tree.rows, tree.cols), metric, &places);
    let place = |cell: Cell| tree.place(cell);
    let mut peaks: Vec<_> = pruned
        .iter()
        .zip(&ids)
        .zip(&isolations)
        .map(|((peak, &id), nearest)| {
            let isolation = isolation(metric, place(peak.cell), nearest.map(|(m, i)| (m, pruned[i].cell)), &place);
            measure_peak(&place, &elevations, metric, &pruned, &ids, peak, id, Some(isolation))
        })
        .collect();
    relate_to_greatest(&mut peaks);
    peaks.sort_unstable_by_key(|peak| peak.id);
    let mut edges: Vec<TreeEdge> = pruned
        .iter()
        .zip(&ids)
        .filter_map(|(peak, &id)| {
            let edge = peak.edge?;
            let (a, b) = if edge.join.near_is_a { (edge.near, edge.far) } else { (edge.far, edge.near) };
            let pass = pass_at.get(&(edge.join.saddle, edge.join.nth))?;
            let [from, to] = [a, b].map(|peak| pruned[peak as usize].cell);
            let is_turned = tree.peaks[pass.peaks[0] as usize].0 != from;
            let [back, on] = [usize::from(is_turned), usize::from(!is_turned)].map(|side| &pass.bends[side]);
            let mut path = vec![from];
            path.extend(back.iter().rev());
            path.push(pass.cell);
            path.extend(on);
            path.push(to);
            Some(TreeEdge {
                peak_a: ids[a as usize],
                peak_b: ids[b as usize],
                saddle: id,
                saddle_cell: edge.join.saddle,
                saddle_elevation_m: elevations.elevation_m(edge.join.key),
                prominence_m: peak.prominence_m,
                length_m: path.windows(2).map(|step| metric.distance_m(place(step[0]), place(step[1]))).sum(),
                path,
            })
        })
        .collect();
    edges.sort_unstable_by_key(|edge| edge.saddle);
    Ok(Survey { peaks, edges, local_peaks: tree.peaks.len() as u64 })
}

fn isolation<M: Metric + ?Sized>(
    metric: &M,
    from: Place,
    nearest: Option<(f64, Cell)>,
    place: &impl Fn(Cell) -> Place,
) -> Isolation {
    let isolation_m = nearest.map(|(isolation_m, _)| isolation_m);
    Isolation {
        isolation_m,
        isolation_min_m: isolation_m,
        certain: true,
        azimuth: nearest.map_or(f64::NAN, |(_, cell)| metric.vector(from, place(cell)).azimuth),
        higher: nearest.map(|(_, cell)| cell),
    }
}

/// For each of some peaks with their elevations, on a raster that does not wrap, the distance in metres to the nearest
/// that is strictly higher, and its position; of equals the higher one, then the first. `None` where none is higher.
pub fn peak_isolations<M: Metric + ?Sized>(
    size: (usize, usize),
    metric: &M,
    peaks: &[(Place, f64)],
) -> Vec<Option<(f64, usize)>> {
    let mut falling: Vec<usize> = (0..peaks.len()).collect();
    falling.sort_by(|&i, &j| peaks[j].1.total_cmp(&peaks[i].1));
    let mut crowd = Crowd::new(size, metric, peaks.len());
    let mut found = vec![None; peaks.len()];
    // Peaks of one elevation do not see each other.
    for equals in falling.chunk_by(|&i, &j| peaks[i].1 == peaks[j].1) {
        for &i in equals {
            let nearest = crowd.nearest(peaks[i].0, 0.0, f64::INFINITY);
            found[i] = nearest.map(|(isolation_m, number)| (isolation_m, falling[number as usize]));
        }
        equals.iter().for_each(|&i| crowd.add(peaks[i].0));
    }
    found
}
