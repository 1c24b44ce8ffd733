//! What a clipped or voided DEM can know: the graph with the virtual cell, and islands by flood fill.

use super::sweep::{Components, Raster};
use orograph::grid::Cell;
use std::collections::{BTreeMap, BTreeSet};

/// For every cell whether it is adjacent to the virtual cell: on the raster's border, or beside an unknown void.
pub fn touching(raster: &Raster, nodata_is_sea: bool) -> Vec<bool> {
    raster
        .cells()
        .map(|cell| {
            raster.around(cell).into_iter().any(|n| match n {
                None => true,
                Some(n) => raster.is_void(n) && !nodata_is_sea,
            })
        })
        .collect()
}

/// For every peak the cell at which it ends when there is one more cell above all others, adjacent to those that
/// `touching` names; the peak itself where that touches. Peaks that never end are absent.
pub fn ends_with_virtual_cell(raster: &Raster, touching: &[bool]) -> BTreeMap<Cell, Cell> {
    let count = raster.cells().count();
    let virtual_cell = count;
    let mut components = Components::new(count + 1);
    let mut ends = BTreeMap::new();
    for &s in &raster.order {
        let above = raster.neighbours_above(s);
        if above.is_empty() && touching[s as usize] {
            // Without the virtual cell this is a peak; with it, it never was one.
            ends.insert(s, s);
        }
        let mut tops: BTreeSet<usize> = above.iter().map(|&n| components.top(n as usize)).collect();
        if touching[s as usize] {
            tops.insert(components.top(virtual_cell));
        }
        let above_all = |&p: &usize, &q: &usize| {
            if p == virtual_cell || (q != virtual_cell && raster.is_above(p as Cell, q as Cell)) {
                std::cmp::Ordering::Less
            } else {
                std::cmp::Ordering::Greater
            }
        };
        let Some(&winner) = tops.iter().min_by(|p, q| above_all(p, q)) else { continue };
        for top in tops {
            if top != winner {
                ends.insert(top as Cell, s);
                components.join(winner, top);
            }
        }
        components.join(winner, s as usize);
    }
    ends
}

/// Whether the island of a peak, the component of the cells above its key saddle that holds it, has a cell that is
/// adjacent to the virtual cell.
pub fn island_touches(raster: &Raster, peak: Cell, saddle: Cell, touching: &[bool]) -> bool {
    let mut island = BTreeSet::from([peak]);
    let mut todo = vec![peak];
    while let Some(cell) = todo.pop() {
        if touching[cell as usize] {
            return true;
        }
        for n in raster.neighbours(cell) {
            if raster.is_above(n, saddle) && island.insert(n) {
                todo.push(n);
            }
        }
    }
    false
}
