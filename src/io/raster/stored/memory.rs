//! A raster in memory that GDAL opens like a file: for what has to be unpacked before it can be read.

use super::cell::{self, StoredCell};
use super::describe::describe;
use super::driver::Format;
use super::record::Record;
use crate::error::{Error, ErrorKind, Result};
use crate::io::messages::{failure, quiet, take_failures};
use gdal::Dataset;
use gdal::errors::GdalError;
use gdal::vsi::unlink_mem_file;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Number of the next raster.
static NEXT: AtomicUsize = AtomicUsize::new(0);

/// A raster in memory; it is gone when this is dropped.
#[derive(Debug)]
pub struct MemoryRaster {
    path: PathBuf,
}

impl MemoryRaster {
    /// What GDAL opens it as.
    pub(in crate::io::raster) fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for MemoryRaster {
    fn drop(&mut self) {
        // Where it was never made there is nothing to remove.
        let _ = unlink_mem_file(&self.path);
    }
}

/// A raster on its way into memory.
pub struct MemoryTarget {
    // Closed before the file goes.
    dataset: Dataset,
    raster: MemoryRaster,
}

impl MemoryTarget {
    /// Makes room for a raster of which the record tells.
    ///
    /// # Errors
    /// When there is not enough memory.
    pub fn begin(record: &Record) -> Result<Self> {
        quiet();
        take_failures();
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let raster = MemoryRaster { path: PathBuf::from(format!("/vsimem/orograph-{number}.tif")) };
        let format = Format::geotiff();
        let options = format.options(record, &[("COMPRESS".into(), "NONE".into())])?;
        let mut dataset = format.create(&raster.path, &raster.path, record, &options)?;
        // What GeoTIFF does not keep matters to nobody here.
        describe(&mut dataset, record, &mut Vec::new());
        Ok(Self { dataset, raster })
    }

    /// Writes a window (column, row, columns, rows) of a band, counted from 0.
    ///
    /// # Errors
    /// When the memory does not suffice.
    pub fn write<T: StoredCell>(&mut self, band: usize, window: [usize; 4], cells: &mut [T]) -> Result<()> {
        let wrong = |error: GdalError| self.failed(&error);
        cell::write(&self.dataset.rasterband(band + 1).map_err(wrong)?, window, cells).map_err(wrong)
    }

    /// Ends writing.
    ///
    /// # Errors
    /// When the memory does not suffice.
    pub fn finish(mut self) -> Result<MemoryRaster> {
        self.dataset.flush_cache().map_err(|error| self.failed(&error))?;
        let Self { dataset, raster } = self;
        let closed = dataset.close();
        let said = take_failures();
        match closed {
            Ok(()) if said.is_empty() => Ok(raster),
            _ => Err(Error::new(ErrorKind::Unsupported, format!("it cannot be unpacked: {}", said.join("; ")))),
        }
    }

    fn failed(&self, error: &GdalError) -> Error {
        failure(ErrorKind::Unsupported, "it cannot be unpacked", &self.raster.path, error)
    }
}
