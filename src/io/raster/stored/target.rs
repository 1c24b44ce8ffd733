//! A raster on its way into a file of any format.

use super::cell::{self, StoredCell};
use super::describe::describe;
use super::driver::Format;
use super::record::Record;
use crate::error::{Error, ErrorKind, Result};
use crate::io::messages::{failure, take_failures};
use crate::io::output_folder::OutputFolder;
use gdal::Dataset;
use gdal::errors::GdalError;
use std::path::{Path, PathBuf};

/// Name of the GeoTIFF from which formats are copied that cannot be written part by part.
const SCRATCH: &str = ".cells.tif";

/// A file that is being written; it gets its name when it is finished.
pub struct StoredTarget {
    folder: OutputFolder,
    dataset: Dataset,
    /// The format to copy to, with its options, where the cells go to a file of their own first.
    copied: Option<Copied>,
    /// What a user should know of how the file is written.
    pub notes: Vec<String>,
}

/// What a finished raster is copied to.
struct Copied {
    format: Format,
    options: Vec<(String, String)>,
    record: Record,
}

impl StoredTarget {
    /// Creates a file; `options` are the format's own.
    ///
    /// # Errors
    /// When the output exists and may not be replaced, its folder cannot be written to, or the format cannot hold the
    /// raster.
    pub fn begin(
        target: &Path,
        overwrite: bool,
        format: &Format,
        options: &[(String, String)],
        record: &Record,
    ) -> Result<Self> {
        let folder = OutputFolder::begin(target, overwrite)?;
        format.admit(record).map_err(|error| error.at_path(target))?;
        if let Some(other) = record.bands.iter().find(|band| band.sample != record.bands[0].sample) {
            let (first, other) = (record.bands[0].sample.name(), other.sample.name());
            let message =
                format!("bands of {first} and of {other} do not go into one file; write them one by one with --band");
            return Err(Error::new(ErrorKind::Unsupported, message).at_path(target));
        }
        // What was said of other files is not about this one.
        take_failures();
        let mut notes = Vec::new();
        let (mut dataset, copied) = if format.is_written_in_parts {
            let dataset = format.create(&folder.path(), target, record, &format.options(record, options)?)?;
            (dataset, None)
        } else {
            let scratch = Format::geotiff();
            let dataset = scratch.create(&folder.scratch(SCRATCH), target, record, &scratch.options(record, &[])?)?;
            (dataset, Some(Copied { format: format.clone(), options: options.to_vec(), record: record.clone() }))
        };
        describe(&mut dataset, record, &mut notes);
        let this = Self { folder, dataset, copied, notes };
        this.check(record)?;
        Ok(this)
    }

    /// Fails if the file is not as it was asked for.
    fn check(&self, record: &Record) -> Result<()> {
        let wrong = |error: GdalError| self.failed(&error);
        for (number, band) in (1..).zip(&record.bands) {
            let found = self.dataset.rasterband(number).map_err(wrong)?.band_type();
            if usize::from(found.bytes()) != band.sample.bytes() || found.is_floating() != band.sample.is_float() {
                let message = format!("the format would store {} as {}", band.sample.name(), found.name());
                return Err(Error::new(ErrorKind::Unsupported, message).at_path(self.folder.target()));
            }
        }
        Ok(())
    }

    fn failed(&self, error: &GdalError) -> Error {
        failure(ErrorKind::Output, "it cannot be written", self.folder.target(), error)
    }

    /// Fails if GDAL complained of a write that it reported as done.
    fn said_nothing(&self) -> Result<()> {
        let said = take_failures();
        if said.is_empty() {
            return Ok(());
        }
        let message = format!("it cannot be written: {}", said.join("; "));
        Err(Error::new(ErrorKind::Output, message).at_path(self.folder.target()))
    }

    /// Writes a window (column, row, columns, rows) of a band, counted from 0.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write<T: StoredCell>(&mut self, band: usize, window: [usize; 4], cells: &mut [T]) -> Result<()> {
        take_failures();
        let raster = self.dataset.rasterband(band + 1).map_err(|error| self.failed(&error))?;
        cell::write(&raster, window, cells).map_err(|error| self.failed(&error))?;
        self.said_nothing()
    }

    /// Writes what GDAL has kept of a band: whole blocks are not needed again, and only take memory.
    ///
    /// # Errors
    /// When they cannot be written.
    #[allow(unsafe_code, reason = "the bindings flush whole files only, with all that is said of them")]
    pub fn settle(&mut self, band: usize) -> Result<()> {
        take_failures();
        let raster = self.dataset.rasterband(band + 1).map_err(|error| self.failed(&error))?;
        // SAFETY: the band lives as long as its dataset, which is borrowed.
        unsafe { gdal_sys::GDALFlushRasterCache(raster.c_rasterband()) };
        // Its result says no more than the failures that were reported.
        self.said_nothing()
    }

    /// Ends the file and gives it its name; returns it and whatever came with it, and what to know of it.
    ///
    /// # Errors
    /// When the last of it cannot be written.
    pub fn finish(self) -> Result<(Vec<PathBuf>, Vec<String>)> {
        let Self { folder, mut dataset, copied, notes } = self;
        let wrong = |error: GdalError| failure(ErrorKind::Output, "it cannot be written", folder.target(), &error);
        // Before 3.7 GDAL does not return the failures of its last writes.
        let close = |dataset: Dataset| {
            dataset.close().map_err(wrong)?;
            let said = take_failures();
            if said.is_empty() {
                return Ok(());
            }
            let message = format!("it cannot be written: {}", said.join("; "));
            Err(Error::new(ErrorKind::Output, message).at_path(folder.target()))
        };
        take_failures();
        dataset.flush_cache().map_err(wrong)?;
        if let Some(Copied { format, options, record }) = copied {
            let options = format.options(&record, &options)?;
            let copy = dataset.create_copy(&format.driver()?, folder.path(), &options).map_err(wrong)?;
            close(copy)?;
            close(dataset)?;
            let scratch = folder.scratch(SCRATCH);
            for path in [folder.scratch(&format!("{SCRATCH}.aux.xml")), scratch] {
                // The companion need not be there.
                let _ = std::fs::remove_file(path);
            }
        } else {
            close(dataset)?;
        }
        Ok((folder.finish()?, notes))
    }
}
