//! Where the finer raster goes: a format of GDAL's, or a container.

use crate::codec::{Bound, Cells};
use crate::error::Result;
use crate::io::raster::stored::{Format, Record, StoredTarget};
use crate::oro::{Chunk, Description, Place, Writer, encode_chunk};
use crate::pipeline::archive::{ByteStream, Target, description_of, tile_side_of};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Rows that the blocks of written files have, mostly.
const BLOCK: usize = 256;

/// A raster that is being written, strip by strip from the top.
pub(super) enum Sink {
    /// Through GDAL.
    Raster(Box<StoredTarget>, Format),
    /// As a container that keeps every bit.
    Container(Box<Writer<ByteStream<'static>>>, PathBuf),
}

/// How to write.
#[derive(Clone, Copy, Debug)]
pub(super) struct Output<'a> {
    pub(super) path: &'a Path,
    pub(super) overwrite: bool,
    /// GDAL's name of the format; after the extension where there is none.
    pub(super) format: Option<&'a str>,
    /// Options of the format, key and value.
    pub(super) options: &'a [(String, String)],
}

impl Output<'_> {
    fn is_container(&self) -> bool {
        self.format.is_none() && self.path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("oro"))
    }

    /// Begins to write a raster of one band of single precision.
    ///
    /// # Errors
    /// When the output exists and may not be replaced, cannot be written, or its format cannot hold the raster.
    pub(super) fn begin(&self, record: &Record) -> Result<Sink> {
        if self.is_container() {
            let description = description_of(record, &[Bound::Lossless], tile_side_of(record));
            description.check()?;
            let target = Target::File { path: self.path.to_path_buf(), overwrite: self.overwrite };
            let writer = Writer::new(ByteStream::begin(target)?, description);
            return Ok(Sink::Container(Box::new(writer.map_err(|e| e.at_path(self.path))?), self.path.to_path_buf()));
        }
        let format = Format::of(self.path, self.format)?;
        let target = StoredTarget::begin(self.path, self.overwrite, &format, self.options, record)?;
        Ok(Sink::Raster(Box::new(target), format))
    }
}

impl Sink {
    /// Strips are a multiple of so many rows; only the last may have fewer.
    pub(super) fn rows(&self) -> usize {
        match self {
            Self::Raster(..) => BLOCK,
            Self::Container(writer, _) => writer.description().tile_side,
        }
    }

    /// What is written.
    pub(super) fn format(&self) -> &str {
        match self {
            Self::Raster(_, format) => &format.name,
            Self::Container(..) => "oro",
        }
    }

    /// What a user should know of how it is written.
    pub(super) fn notes(&self, options: &[(String, String)]) -> Vec<String> {
        match self {
            Self::Raster(target, format) => {
                let mut notes = target.notes.clone();
                if !format.keeps_cells(options) {
                    notes.push(format!("the format {} may keep elevations less exactly than they are", format.name));
                }
                notes
            }
            Self::Container(..) => vec![],
        }
    }

    /// Writes all columns of some rows.
    ///
    /// # Errors
    /// When they cannot be written.
    pub(super) fn write(&mut self, row: usize, width: usize, cells: &mut [f32]) -> Result<()> {
        let rows = cells.len() / width;
        match self {
            Self::Raster(target, _) => {
                target.write(0, [0, row, width, rows], cells)?;
                target.settle(0)
            }
            Self::Container(writer, path) => {
                let chunks = chunks(writer.description(), row, width, cells)?;
                chunks.iter().try_for_each(|chunk| writer.push(chunk)).map_err(|error| error.at_path(path))
            }
        }
    }

    /// Ends the file and gives it its name; returns the files and what to know of them.
    ///
    /// # Errors
    /// When the last of it cannot be written.
    pub(super) fn finish(self) -> Result<(Vec<PathBuf>, Vec<String>)> {
        match self {
            Self::Raster(target, _) => target.finish(),
            Self::Container(writer, path) => {
                writer.finish().map_err(|error| error.at_path(&path))?.0.finish()?;
                Ok((vec![path], vec![]))
            }
        }
    }
}

/// The tiles of whole rows of tiles, encoded.
fn chunks(description: &Description, row: usize, width: usize, cells: &[f32]) -> Result<Vec<Chunk>> {
    let side = description.tile_side;
    let tiles = (0..(cells.len() / width).div_ceil(side)).flat_map(|r| (0..width.div_ceil(side)).map(move |c| (r, c)));
    let tiles: Vec<(usize, usize)> = tiles.collect();
    let encode = |&(r, c): &(usize, usize)| {
        let lines = cells.chunks_exact(width).skip(r * side).take(side);
        let own: Vec<f32> = lines.flat_map(|line| line[c * side..width.min((c + 1) * side)].iter().copied()).collect();
        encode_chunk(description, Place { col: c, row: row / side + r, band: 0 }, &Cells::F32(own))
    };
    // All are waited for, so that the first failure in the raster is the one that is told.
    let chunks: Vec<Result<Chunk>> = tiles.par_iter().map(encode).collect();
    chunks.into_iter().collect()
}
