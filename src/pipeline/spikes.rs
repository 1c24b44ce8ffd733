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
    /// Its elevation in metres.
    pub(super) elevation_m: f64,
    /// Height above its topmost neighbour in metres.
    pub(super) drop_m: f64,
}

/// Height above all neighbours that no summit has from one cell to the next, in metres.
const IMPLAUSIBLE_M: f64 = 1000.0;

/// Height from which a slope of more than [`STEEP`] to every neighbour is suspect, in metres.
const TALL_M: f64 = 100.0;

/// Rise over run.
const STEEP: f64 = 4.0;

/// Finds the peaks that drop implausibly to every one of their neighbours.
pub(super) fn find(dem: &Dem, metric: &impl Metric, peaks: &[Peak]) -> Vec<Spike> {
    crate::with_grid!(&dem.grid, grid => {
        let spike_at = |peak: &Peak| {
            let (row, col) = grid.place(peak.cell);
            let (_, top) = grid.neighbours(peak.cell).max_by_key(|&(_, n)| (grid.key(n), std::cmp::Reverse(n)))?;
            let key = |cell| crate::grid::Key::to_i64(grid.key(cell));
            let drop_m = dem.elevations.height_m(key(peak.cell), key(top));
            // Measured only where it may matter.
            let is_suspect = drop_m > IMPLAUSIBLE_M || (drop_m > TALL_M && {
                let (r, c) = grid.place(top);
                drop_m > STEEP * metric.distance_m((row as i64, col as i64), (r as i64, c as i64))
            });
            is_suspect.then_some(Spike { row, col, elevation_m: peak.elevation_m, drop_m })
        };
        peaks.iter().filter_map(spike_at).collect()
    })
}
