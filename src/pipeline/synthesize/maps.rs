//! Rasters that steer synthesis, brought onto the land.

use super::super::archive::open_dem;
use super::land::Land;
use crate::error::{Error, ErrorKind, Result};
use crate::io::raster::{Dem, RasterOptions};
use crate::synthesis::{ControlMap, Controls};
use crate::watch::Watch;
use std::path::{Path, PathBuf};

/// The rasters of a job.
#[derive(Clone, Debug, Default)]
pub(super) struct Maps<'a> {
    pub(super) density: Option<&'a PathBuf>,
    pub(super) elevation: Option<&'a PathBuf>,
    pub(super) kind: Option<&'a PathBuf>,
    pub(super) memory: Option<u64>,
}

/// Most rows and columns that a map is looked at.
const LOOKS: usize = 1500;

impl Maps<'_> {
    /// Reads them.
    ///
    /// # Errors
    /// A raster that cannot be read, is in another CRS, or does not cover the land.
    pub(super) fn read(&self, land: &Land, watch: &Watch) -> Result<Controls> {
        let read = |path: Option<&PathBuf>| path.map(|path| self.map(path, land, watch)).transpose();
        Ok(Controls { density: read(self.density)?, elevation: read(self.elevation)?, kind: read(self.kind)? })
    }

    fn map(&self, path: &Path, land: &Land, watch: &Watch) -> Result<ControlMap> {
        let refuse = |message: String| Error::new(ErrorKind::Input, message).at_path(path);
        let dem = open_dem(path, &RasterOptions::default(), self.memory, watch)?.read(watch)?;
        if let (Some(own), Some(crs)) = (&dem.crs, &land.crs)
            && own.wkt != crs.wkt
            && (own.authority.is_none() || own.authority != crs.authority)
        {
            return Err(refuse(format!(
                "the map is in {} and the land in {}: bring it there, for example with gdalwarp",
                own.label(),
                crs.label()
            )));
        }
        let size = (dem.grid.rows(), dem.grid.cols());
        let (rows, cols) = (land.rows.min(LOOKS), land.cols.min(LOOKS));
        let mut values = Vec::with_capacity(rows * cols);
        for row in 0..rows {
            for col in 0..cols {
                // The middle of the part of the land that this value stands for.
                let middle = |i: usize, parts: usize, all: usize| (i as f64 + 0.5) * all as f64 / parts as f64 - 0.5;
                let (x, y) = land.transform.centre(middle(row, rows, land.rows), middle(col, cols, land.cols));
                let (at_row, at_col) = dem.transform.pixel(x, y);
                let is_inside = at_row >= 0.0 && at_col >= 0.0 && at_row < size.0 as f64 && at_col < size.1 as f64;
                if !is_inside {
                    return Err(refuse(format!("the map does not cover the land: it has nothing at {x}, {y}")));
                }
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "inside of the map")]
                let cell = at_row as u64 * size.1 as u64 + at_col as u64;
                values.push(value(&dem, cell));
            }
        }
        Ok(ControlMap::new(rows, cols, values))
    }
}

/// The value of a cell as the file means it, whatever the unit; NaN for a void.
fn value(dem: &Dem, cell: u64) -> f64 {
    if dem.grid.is_void(cell) {
        return f64::NAN;
    }
    dem.elevations.value(dem.grid.key(cell)) * dem.elevations.scale + dem.elevations.offset
}
