//! Values that look like nodata although nobody declared them so.

use crate::grid::{AnyGrid, Elevations, Key};
use crate::with_grid;

/// A value that looks like undeclared nodata.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sentinel {
    /// The stored value.
    pub value: f64,
    /// How many cells have it.
    pub cells: u64,
}

/// Values that programs write where there is no data.
const USUAL: [f64; 14] = [
    -32768.0,
    -32767.0,
    -9999.0,
    -99999.0,
    -999.0,
    -9998.0,
    32767.0,
    65535.0,
    9999.0,
    -2147483648.0,
    -3.402_823_466_385_288_6e38,
    -3.402_82e38,
    1e20,
    -1e10,
];

/// How far, in stored units, a usual value must lie from all others to be suspect.
const GAP: f64 = 500.0;

/// Looks at the extremes of a grid: a usual nodata value far away from all other values is suspect.
pub(super) fn find_sentinel(grid: &AnyGrid, elevations: &Elevations, least: i64, greatest: i64) -> Option<Sentinel> {
    [least, greatest].into_iter().find_map(|key| {
        let value = elevations.value(key);
        // Single precision keeps some of them only nearly.
        if !USUAL.iter().any(|&usual| (value - usual).abs() <= usual.abs() * 1e-6) {
            return None;
        }
        let (cells, next) = with_grid!(grid, grid => neighbour_of_extreme(grid.cells(), key, key == least));
        let next = next?;
        ((elevations.value(next) - value).abs() > GAP).then_some(Sentinel { value, cells })
    })
}

/// How many cells have the extreme key, and the next key after it.
fn neighbour_of_extreme<K: Key>(cells: &[K], extreme: i64, is_least: bool) -> (u64, Option<i64>) {
    let extreme = K::from_i64(extreme);
    let mut count = 0;
    let mut next: Option<K> = None;
    for &key in cells {
        if key == extreme {
            count += 1;
        } else if key != K::VOID && next.is_none_or(|next| if is_least { key < next } else { key > next }) {
            next = Some(key);
        }
    }
    (count, next.map(K::to_i64))
}
