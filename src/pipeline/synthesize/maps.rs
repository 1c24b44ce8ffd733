//! Rasters that steer synthesis, brought onto the land.

use super::super::land::Land;
use super::super::land_map::LandMap;
use crate::error::Result;
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
        Ok(Controls {
            density: read(self.density)?,
            elevation: read(self.elevation)?,
            kind: read(self.kind)?,
            ..Controls::default()
        })
    }

    fn map(&self, path: &Path, land: &Land, watch: &Watch) -> Result<ControlMap> {
        let map = LandMap::read(path, land, self.memory, watch)?;
        let (rows, cols) = (land.rows.min(LOOKS), land.cols.min(LOOKS));
        let mut values = Vec::with_capacity(rows * cols);
        for row in 0..rows {
            for col in 0..cols {
                // The middle of the part of the land that this value stands for.
                let middle = |i: usize, parts: usize, all: usize| (i as f64 + 0.5) * all as f64 / parts as f64 - 0.5;
                let (x, y) = land.transform.centre(middle(row, rows, land.rows), middle(col, cols, land.cols));
                values.push(map.value(map.cell(x, y)?));
            }
        }
        Ok(ControlMap::new(rows, cols, values))
    }
}
