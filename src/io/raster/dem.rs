//! An elevation model in memory.

use super::suspect::Sentinel;
use crate::crs::Crs;
use crate::grid::{AnyGrid, Elevations, GeoTransform, Key};
use crate::with_grid;

/// The least and greatest key of the cells that are not void.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extremes {
    /// Least key.
    pub least: i64,
    /// Greatest key.
    pub greatest: i64,
    /// Cells that are not void.
    pub cells: u64,
}

/// One band of a raster as an elevation model: rows from north to south, columns from west to east.
#[derive(Debug)]
pub struct Dem {
    /// The cells.
    pub grid: AnyGrid,
    /// What the keys mean.
    pub elevations: Elevations,
    /// Where the cells are.
    pub transform: GeoTransform,
    /// The CRS, if the file has one or one was assigned.
    pub crs: Option<Crs>,
    /// Whether the file says where its cells are at all.
    pub is_georeferenced: bool,
    /// Extremes of the cells; `None` where all are void.
    pub extremes: Option<Extremes>,
    /// A value that looks like nodata without being declared so.
    pub sentinel: Option<Sentinel>,
    /// What a user should know of how the file was read.
    pub notes: Vec<String>,
}

impl Dem {
    /// Elevations in metres, row by row; NaN for voids.
    pub fn heights_m(&self) -> Vec<f64> {
        with_grid!(&self.grid, grid => metres(grid.cells(), &self.elevations))
    }
}

/// Elevations in metres; NaN for voids.
fn metres<K: Key>(cells: &[K], elevations: &Elevations) -> Vec<f64> {
    let metres = |key: &K| if *key == K::VOID { f64::NAN } else { elevations.elevation_m(key.to_i64()) };
    cells.iter().map(metres).collect()
}
