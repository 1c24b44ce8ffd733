//! Peaks that look like faults of the data: a single cell far above all its neighbours.

use crate::crs::Metric;
use crate::io::raster::Dem;
use crate::orometry::Peak;

/// A single cell that stands out implausibly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spike {
    /// Row of the cell.
    pub(super) row: usize,
    /// Column of the cell.
    pub(super) col: usize,
    /// The value stored there.
    pub(super) value: f64,
    /// Height above its topmost neighbour in metres.
    pub(super) drop_m: f64,
}

/// Rise over run, and height in metres, from which both on a drop to every neighbour is suspect: a needle, or a cell
/// far above what summits of coarse rasters have.
const SUSPECT: [(f64, f64); 2] = [(4.0, 100.0), (0.5, 1000.0)];

/// Finds the peaks that drop implausibly to every one of their neighbours.
pub(super) fn find(dem: &Dem, metric: &impl Metric, peaks: &[Peak]) -> Vec<Spike> {
    crate::with_grid!(&dem.grid, grid => {
        let spike_at = |peak: &Peak| {
            let (row, col) = grid.place(peak.cell);
            let (_, top) = grid.neighbours(peak.cell).max_by_key(|&(_, n)| (grid.key(n), std::cmp::Reverse(n)))?;
            let key = |cell| crate::grid::Key::to_i64(grid.key(cell));
            let drop_m = dem.elevations.height_m(key(peak.cell), key(top));
            // Measured only where it may matter.
            let is_suspect = drop_m > SUSPECT[0].1 && {
                // The furthest neighbour: next to a pole those in the same row are hardly apart.
                let run_m = grid
                    .neighbours(peak.cell)
                    .map(|(_, n)| grid.place(n))
                    .map(|(r, c)| metric.distance_m((row as i64, col as i64), (r as i64, c as i64)))
                    .fold(0.0, f64::max);
                SUSPECT.iter().any(|&(slope, tall_m)| drop_m > tall_m && drop_m > slope * run_m)
            };
            let value = dem.elevations.value(key(peak.cell));
            is_suspect.then_some(Spike { row, col, value, drop_m })
        };
        peaks.iter().filter_map(spike_at).collect()
    })
}
