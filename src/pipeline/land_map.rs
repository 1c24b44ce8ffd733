//! A raster that says something of land that is to be made.

use super::archive::open_dem;
use super::land::Land;
use crate::error::{Error, ErrorKind, Result};
use crate::io::raster::{Dem, RasterOptions};
use crate::watch::Watch;
use std::path::{Path, PathBuf};

/// The raster, read.
pub(super) struct LandMap {
    path: PathBuf,
    dem: Dem,
}

impl LandMap {
    /// Reads a raster.
    ///
    /// # Errors
    /// A raster that cannot be read or is in another CRS than the land.
    pub(super) fn read(path: &Path, land: &Land, memory: Option<u64>, watch: &Watch) -> Result<Self> {
        let dem = open_dem(path, &RasterOptions::default(), memory, watch)?.read(watch)?;
        if let (Some(own), Some(crs)) = (&dem.crs, &land.crs)
            && own.wkt != crs.wkt
            && (own.authority.is_none() || own.authority != crs.authority)
        {
            let message = format!(
                "the map is in {} and the land in {}: bring it there, for example with gdalwarp",
                own.label(),
                crs.label()
            );
            return Err(Error::new(ErrorKind::Input, message).at_path(path));
        }
        Ok(Self { path: path.to_path_buf(), dem })
    }

    /// The cell at a place of the land; land may go on for a cell beyond the map, since it ends with a whole cell.
    ///
    /// # Errors
    /// A place where the map has nothing.
    pub(super) fn cell(&self, x: f64, y: f64) -> Result<u64> {
        let size = [self.dem.grid.rows(), self.dem.grid.cols()];
        let (row, col) = self.dem.transform.pixel(x, y);
        let near = |at: f64, count: usize| {
            let is_near = at > -1.0 && at < count as f64 + 1.0;
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "inside of the map")]
            is_near.then(|| at.clamp(0.0, count as f64 - 0.5) as u64)
        };
        near(row, size[0]).zip(near(col, size[1])).map(|(row, col)| row * size[1] as u64 + col).ok_or_else(|| {
            let message = format!("the map does not cover the land: it has nothing at {x}, {y}");
            Error::new(ErrorKind::Input, message).at_path(&self.path)
        })
    }

    /// The value of a cell as the file means it, whatever the unit; NaN for a void.
    pub(super) fn value(&self, cell: u64) -> f64 {
        if self.dem.grid.is_void(cell) {
            return f64::NAN;
        }
        let elevations = &self.dem.elevations;
        elevations.value(self.dem.grid.key(cell)) * elevations.scale + elevations.offset
    }

    /// The elevation of a cell in metres; NaN for a void.
    pub(super) fn elevation_m(&self, cell: u64) -> f64 {
        if self.dem.grid.is_void(cell) { f64::NAN } else { self.dem.elevations.elevation_m(self.dem.grid.key(cell)) }
    }
}
