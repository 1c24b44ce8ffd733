//! What is encoded: a raster of any format, or a container once more.

use super::batch::Area;
use super::container::{ContainerOptions, ContainerSource, is_container};
use crate::codec::Cells;
use crate::error::Result;
use crate::io::raster::stored::{Record, StoredOptions, StoredSource};
use crate::with_cells;
use std::path::Path;

/// An opened input.
pub(in crate::pipeline) enum Input {
    Stored(Box<StoredSource>),
    Container(Box<ContainerSource>),
}

impl Input {
    /// Opens an input.
    ///
    /// # Errors
    /// As its kind.
    pub(in crate::pipeline) fn open(path: &Path, options: &StoredOptions) -> Result<Self> {
        if !is_container(path) {
            return StoredSource::open(path, options).map(|source| Self::Stored(Box::new(source)));
        }
        let StoredOptions { bands, nodata, crs, window, bbox } = options.clone();
        let options = ContainerOptions { bands, nodata, crs, window, bbox, level: 0 };
        ContainerSource::open(path, &options).map(|source| Self::Container(Box::new(source)))
    }

    /// What is read of it.
    pub(in crate::pipeline) fn record(&self) -> &Record {
        match self {
            Self::Stored(source) => &source.record,
            Self::Container(source) => &source.record,
        }
    }

    /// What a user should know of how it is read.
    pub(in crate::pipeline) fn notes(&self) -> &[String] {
        match self {
            Self::Stored(source) => &source.notes,
            Self::Container(_) => &[],
        }
    }

    /// Reads an area of a band, on all threads.
    ///
    /// # Errors
    /// When it cannot be read or is damaged.
    pub(in crate::pipeline) fn read(&self, band: usize, area: Area) -> Result<Cells> {
        match self {
            Self::Stored(source) => {
                let mut cells = Cells::zeros(source.record.bands[band].sample, area[2] * area[3]);
                with_cells!(&mut cells, values => source.read(band, area, values))?;
                Ok(cells)
            }
            Self::Container(source) => source.read(band, area, &mut Err),
        }
    }
}
