//! The divide tree pruned at a prominence threshold, with the parents of its peaks.

use super::divide::{DivideForest, Join, NO_CELL, PeakNumber};
use crate::components::root;
use crate::grid::neighbours::is_above;
use crate::grid::{Cell, Elevations, Key};
use rayon::prelude::*;

/// A peak of the pruned tree; the tree's peaks are in the order of their index in the raster.
#[derive(Clone, Debug)]
pub(super) struct PrunedPeak<K> {
    pub(super) number: PeakNumber,
    pub(super) cell: Cell,
    pub(super) key: K,
    /// In metres; for a root not yet known.
    pub(super) prominence_m: f64,
    pub(super) prominence_min_m: f64,
    pub(super) certain: bool,
    /// The edge at which the peak ends; `None` for a root.
    pub(super) edge: Option<PrunedEdge<K>>,
    /// Positions in the pruned tree.
    pub(super) island_parent: Option<u32>,
    pub(super) line_parent: Option<u32>,
    pub(super) prominence_parent: Option<u32>,
}

/// An edge of the pruned tree: the join of the peak that ends there, and the groups that it leads to.
#[derive(Clone, Copy, Debug)]
pub(super) struct PrunedEdge<K> {
    pub(super) join: Join<K>,
    /// Position of the group on the ended peak's side.
    pub(super) near: u32,
    /// Position of the group on the other side.
    pub(super) far: u32,
}

/// Height of a peak's key above a saddle's, or above the base level where that is higher, in metres.
///
/// It never grows as the saddle rises, not even by rounding: the lesser of the two heights counts, so the one above the
/// base level, which is rounded otherwise, ends where the saddle reaches that level.
pub(super) fn prominence_m<K: Key>(elevations: &Elevations, base_level_m: Option<f64>, peak: K, saddle: K) -> f64 {
    let above_saddle = elevations.height_m(peak.to_i64(), saddle.to_i64());
    base_level_m.map_or(above_saddle, |base| above_saddle.min(elevations.elevation_m(peak.to_i64()) - base))
}

/// Prunes a forest at `threshold_m`: peaks of a lower prominence are taken into the group of the topmost peak that
/// they are joined to. Roots always stay.
///
/// `key_of` gives the key of a cell.
pub(super) fn prune<K: Key>(
    forest: &DivideForest<K>,
    key_of: impl Fn(Cell) -> K + Sync,
    elevations: &Elevations,
    base_level_m: Option<f64>,
    threshold_m: f64,
) -> Vec<PrunedPeak<K>> {
    let prominence = |peak: K, saddle: K| prominence_m(elevations, base_level_m, peak, saddle);
    let keep = |number: usize| {
        let (join, key, cell) = (&forest.joins[number], forest.keys[number], forest.cells[number]);
        let is_root = join.saddle == NO_CELL;
        let prominence_m = if is_root { f64::NAN } else { prominence(key, join.key) };
        let touch = forest.touches[number];
        (is_root || prominence_m >= threshold_m).then(|| PrunedPeak {
            number: number as PeakNumber,
            cell,
            key,
            prominence_m,
            prominence_min_m: match touch {
                NO_CELL => prominence_m,
                // Beside the unknown; also where a base level lies above the peak.
                touch if touch == cell => 0.0,
                touch => prominence(key, key_of(touch)),
            },
            certain: touch == NO_CELL,
            edge: (!is_root).then_some(PrunedEdge { join: *join, near: 0, far: 0 }),
            island_parent: None,
            line_parent: None,
            prominence_parent: None,
        })
    };
    let mut peaks: Vec<PrunedPeak<K>> = (0..forest.cells.len()).into_par_iter().filter_map(keep).collect();
    peaks.par_sort_unstable_by_key(|peak| peak.cell);
    find_groups(forest, &mut peaks);
    find_parents(&mut peaks);
    peaks
}

/// Finds the groups that the ends of the edges belong to.
fn find_groups<K: Key>(forest: &DivideForest<K>, peaks: &mut [PrunedPeak<K>]) {
    const NONE: u32 = u32::MAX;
    let mut group = vec![NONE; forest.cells.len()];
    for (position, peak) in (0..).zip(peaks.iter()) {
        group[peak.number as usize] = position;
    }
    let mut way = Vec::new();
    // From a peak that was taken in, the other side of its join is in the same group; tops rise along the way.
    let mut group_of = |mut number: PeakNumber| {
        way.clear();
        while group[number as usize] == NONE {
            way.push(number);
            number = forest.joins[number as usize].far;
        }
        for &passed in &way {
            group[passed as usize] = group[number as usize];
        }
        group[number as usize]
    };
    for peak in peaks {
        if let Some(edge) = &mut peak.edge {
            edge.near = group_of(edge.join.near);
            edge.far = group_of(edge.join.far);
        }
    }
}

/// Positions of the peaks that end at edges, in the order of the sweep.
pub(super) fn sweep_order<K: Key>(peaks: &[PrunedPeak<K>]) -> Vec<u32> {
    let mut order: Vec<(K, Cell, u8, u32)> = (0..)
        .zip(peaks)
        .filter_map(|(i, peak)| peak.edge.map(|edge| (edge.join.key, edge.join.saddle, edge.join.nth, i)))
        .collect();
    order.sort_unstable_by(|p, q| (q.0, p.1, p.2).cmp(&(p.0, q.1, q.2)));
    order.into_iter().map(|(.., i)| i).collect()
}

/// Finds the parents by growing the tree edge by edge, each component hanging from its top.
fn find_parents<K: Key>(peaks: &mut [PrunedPeak<K>]) {
    let order = |peak: &PrunedPeak<K>| (peak.key, peak.cell);
    let mut component: Vec<u32> = (0..peaks.len() as u32).collect();
    // The next group on the way to the top of the component; a top leads to itself.
    let mut upwards: Vec<u32> = component.clone();
    for ended in sweep_order(peaks) {
        let this = peaks[ended as usize].clone();
        let edge = this.edge.expect("the order holds ended peaks only");
        let island_parent = root(&mut component, edge.far);
        let mut at = edge.far;
        while !is_above(order(&peaks[at as usize]), order(&this)) {
            at = upwards[at as usize];
        }
        let line_parent = at;
        // The prominence of the component's top is not known yet, if that is a root: it is looked at last.
        while at != island_parent && peaks[at as usize].prominence_m <= this.prominence_m {
            at = upwards[at as usize];
        }
        let peak = &mut peaks[ended as usize];
        peak.island_parent = Some(island_parent);
        peak.line_parent = Some(line_parent);
        peak.prominence_parent = Some(at);
        // Hang the ended component from the other one: turn round the way from the edge up to its top.
        let (mut at, mut from) = (edge.near, edge.far);
        loop {
            let next = upwards[at as usize];
            upwards[at as usize] = from;
            if next == at {
                break;
            }
            (from, at) = (at, next);
        }
        component[ended as usize] = island_parent;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::SampleType;
    use crate::units::LengthUnit;

    #[test]
    fn prominence_does_not_grow_as_the_saddle_rises_to_the_base_level() {
        let feet = LengthUnit { name: "ft".into(), metres: 0.3048 };
        let elevations = Elevations { unit: feet, ..Elevations::metres(SampleType::I16) };
        for peak in 0..200_i16 {
            for base in 0..=peak {
                let base_m = elevations.elevation_m(base.into());
                let at = |saddle: i16| prominence_m(&elevations, Some(base_m), peak, saddle);
                assert!(at(base - 1) >= at(base) && at(base) >= at(base + 1), "{peak} ft above {base} ft");
                assert!((at(base) - f64::from(peak - base) * 0.3048).abs() < 1e-12);
            }
        }
    }
}
