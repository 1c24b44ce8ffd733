//! A container as an input: some of its bands, a part of it, one of its levels.

use super::batch::{Area, Plan, paste};
use super::record::record_of;
use crate::codec::{Cells, TOP_LEVEL};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::{GeoTransform, window_of};
use crate::io::raster::parse_crs;
use crate::io::raster::stored::Record;
use crate::oro::{Description, MAGIC, Reader, Window};
use rayon::prelude::*;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// What to read of a container.
#[derive(Clone, Debug, Default)]
pub struct ContainerOptions {
    /// Numbers of the bands, from 1; all unless given.
    pub bands: Vec<usize>,
    /// Value of the cells without data; replaces those of the container.
    pub nodata: Option<f64>,
    /// CRS that replaces the container's.
    pub crs: Option<String>,
    /// First column, first row, columns, rows: cells of level 0.
    pub window: Option<[usize; 4]>,
    /// Least x, least y, greatest x, greatest y in the raster's CRS.
    pub bbox: Option<[f64; 4]>,
    /// The level: every `2^level`-th cell of every `2^level`-th row.
    pub level: u8,
}

/// An open container.
#[derive(Debug)]
pub struct ContainerSource {
    /// The file.
    pub path: PathBuf,
    /// What is read of it.
    pub record: Record,
    reader: Reader<File>,
    /// Indexes of the bands that are read.
    bands: Vec<usize>,
    level: u8,
    /// First column and first row that are read, in the level's own cells.
    corner: [usize; 2],
}

/// Whether a file is an `.oro` container: by its first bytes, or by its name where it cannot be read.
pub fn is_container(path: &Path) -> bool {
    let mut first = [0; MAGIC.len()];
    let is_named_so = || path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("oro"));
    File::open(path).is_ok_and(|mut file| file.read_exact(&mut first).is_ok() && first == MAGIC) || is_named_so()
}

impl ContainerSource {
    /// Opens a container.
    ///
    /// # Errors
    /// Missing, damaged and newer files, bands and levels that are not there, a window outside of the raster.
    pub fn open(path: &Path, options: &ContainerOptions) -> Result<Self> {
        Self::describe(open(path)?, path, options).map_err(|error| error.at_path(path))
    }

    fn describe(reader: Reader<File>, path: &Path, options: &ContainerOptions) -> Result<Self> {
        let description = reader.description();
        let count = description.bands.len();
        if let Some(number) = options.bands.iter().find(|&&number| number == 0 || number > count) {
            return Err(Error::usage(format!("there is no band {number}: the file has bands 1 to {count}")));
        }
        let bands: Vec<usize> = match &options.bands[..] {
            [] => (0..count).collect(),
            numbers => numbers.iter().map(|number| number - 1).collect(),
        };
        let level = options.level;
        if level > description.last_level() {
            let last = description.last_level();
            return Err(Error::usage(format!("--level {level}: the raster has levels 0 to {last}")));
        }
        let transform = description.georeference.transform;
        if options.bbox.is_some() && transform.is_none() {
            return Err(Error::usage("--bbox: the file does not say where its cells are; use --window"));
        }
        let whole = transform.unwrap_or(GeoTransform::PIXELS);
        let size = (description.width, description.height);
        let [col, row, width, height] = window_of(&whole, size, options.window, options.bbox)?;
        // The samples of the level that lie in the window.
        let samples = |from: usize, length: usize| {
            let step = 1 << level;
            let first = from.div_ceil(step);
            (first, (from + length).div_ceil(step) - first)
        };
        let ((left, width), (top, height)) = (samples(col, width), samples(row, height));
        if width == 0 || height == 0 {
            return Err(Error::usage(format!("the window holds no cell of level {level}; take a finer one")));
        }
        let mut record = record_of(description);
        if (width, height) != size {
            // They tie columns and rows to places.
            record.metadata.retain(|item| !["RPC", "GEOLOCATION"].contains(&item.domain.as_str()));
        }
        record.transform = description
            .level_transform(level)
            .map(|t| if left + top > 0 { t.window(top as f64, left as f64) } else { t });
        record.bands = bands.iter().map(|&band| record.bands[band].clone()).collect();
        (record.width, record.height) = (width, height);
        if let Some(text) = &options.crs {
            (record.crs, record.epoch) = (Some(parse_crs(text)?.wkt), None);
        }
        if let Some(value) = options.nodata {
            for band in &mut record.bands {
                let wrong =
                    || Error::usage(format!("--nodata {value} is no value of its type, {}", band.sample.name()));
                band.nodata = Some(band.sample.bits_of(value).ok_or_else(wrong)?);
            }
        }
        Ok(Self { path: path.to_path_buf(), record, reader, bands, level, corner: [left, top] })
    }

    /// What the container says of the whole raster.
    pub fn description(&self) -> &Description {
        self.reader.description()
    }

    /// The container itself.
    pub fn reader(&self) -> &Reader<File> {
        &self.reader
    }

    /// How what is read is taken in batches of whole tiles.
    pub(super) fn plan(&self) -> Plan {
        Plan {
            corner: self.corner,
            size: [self.record.width, self.record.height],
            side: self.description().tile_side >> self.level.min(TOP_LEVEL),
            cell_bytes: self.record.bands.iter().map(|band| band.sample.bytes()).sum(),
        }
    }

    /// Reads an area of a band, both counted from 0 in the record, tile by tile on all threads. Damaged tiles are
    /// handed to `damaged` in the order of the file, and when that says `Ok` their cells are voids.
    ///
    /// # Errors
    /// When the file cannot be read, or `damaged` says so.
    pub(super) fn read(&self, band: usize, area: Area, damaged: &mut dyn FnMut(Error) -> Result<()>) -> Result<Cells> {
        let at_path = |error: Error| error.at_path(&self.path);
        // A coarse level is read from few tiles, which may be others than the raster's own.
        let tiles = if self.level >= TOP_LEVEL { vec![area] } else { self.plan().tiles(area) };
        let windows: Vec<Window> = tiles
            .iter()
            .map(|&[col, row, width, height]| Window {
                col: self.corner[0] + col,
                row: self.corner[1] + row,
                width,
                height,
            })
            .collect();
        let shelf = self.reader.shelf(self.bands[band], self.level, &windows);
        let pieces: Vec<Result<(Cells, Vec<Error>)>> = windows
            .par_iter()
            .map(|&window| {
                let mut faults = Vec::new();
                let mut note = |error: Error| {
                    faults.push(error);
                    Ok(())
                };
                let cells = self.reader.window_with(&shelf, self.bands[band], self.level, window, &mut note)?;
                Ok((cells, faults))
            })
            .collect();
        let mut cells = Cells::zeros(self.record.bands[band].sample, area[2] * area[3]);
        for (piece, &at) in pieces.into_iter().zip(&tiles) {
            let (piece, faults) = piece.map_err(at_path)?;
            for fault in faults {
                damaged(fault).map_err(at_path)?;
            }
            if at == area {
                return Ok(piece);
            }
            paste(&mut cells, area, &piece, at);
        }
        Ok(cells)
    }
}

/// Opens a container.
pub(super) fn open(path: &Path) -> Result<Reader<File>> {
    let unreadable = |error: std::io::Error| {
        let message = match error.kind() {
            std::io::ErrorKind::NotFound => "no such file".into(),
            _ => error.to_string(),
        };
        Error::new(ErrorKind::Input, message).at_path(path)
    };
    let file = File::open(path).map_err(unreadable)?;
    if file.metadata().map_err(unreadable)?.is_dir() {
        return Err(Error::new(ErrorKind::Input, "it is a folder").at_path(path));
    }
    Reader::open(file).map_err(|error| error.at_path(path))
}
