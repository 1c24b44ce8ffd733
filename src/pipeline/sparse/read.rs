//! A band as single-precision values, voids as NaN.

use super::super::archive::Input;
use super::super::memory;
use crate::codec::Cells;
use crate::error::{Error, ErrorKind, Result};
use crate::io::raster::stored::{BandRecord, Record, StoredOptions};
use crate::watch::Watch;
use crate::with_cells;
use std::path::Path;

/// Bytes that a raster's cell takes while it is described: the cell, its patches (16 where each begins half a side after
/// the one before), what they are made of, and in learning a second copy of them. Found: 40 for two atoms a patch.
const BYTES_PER_CELL: u64 = 56;
/// Cells that are read at once.
const STRIP_CELLS: usize = 1 << 22;

/// A band of a raster in memory.
pub(super) struct Band {
    /// What the file says of it; one band.
    pub(super) record: Record,
    /// The values, scaled, row by row.
    pub(super) values: Vec<f32>,
    /// What a user should know of how it was read.
    pub(super) notes: Vec<String>,
}

impl Band {
    /// Reads the one band that the options name, or the file's only one.
    ///
    /// # Errors
    /// When it cannot be read, there are several bands and none is named, or the memory is too small.
    pub(super) fn read(path: &Path, options: &StoredOptions, memory: Option<u64>, watch: &Watch) -> Result<Self> {
        let input = Input::open(path, options)?;
        let mut record = input.record().clone();
        let [band] = record.bands.as_mut_slice() else {
            let bands = record.bands.len();
            let message = format!("{bands} bands, and a dictionary describes one: choose it with --band");
            return Err(Error::usage(message).at_path(path));
        };
        let cells = record.width as u64 * record.height as u64;
        let remedy = "cut the raster with --window or --bbox";
        memory::admit_or(cells.saturating_mul(BYTES_PER_CELL), memory.unwrap_or_else(memory::free_bytes), remedy)
            .map_err(|error| error.at_path(path))?;
        let mut values = Vec::with_capacity(cells as usize);
        let rows = (STRIP_CELLS / record.width).max(1);
        watch.begin("reading", record.height as u64);
        for row in (0..record.height).step_by(rows) {
            let height = rows.min(record.height - row);
            let cells = input.read(0, [0, row, record.width, height])?;
            push(&mut values, &cells, band);
            watch.advance(height as u64)?;
        }
        if let Some(cell) = values.iter().position(|value| value.is_infinite()) {
            let place = format!("row {}, column {}", cell / record.width, cell % record.width);
            let message = "an infinite value, which no patch describes; mark it as nodata";
            return Err(Error::new(ErrorKind::Input, message).at_path(path).at_place(place));
        }
        (band.scale, band.offset) = (None, None);
        let notes = input.notes().to_vec();
        Ok(Self { record, values, notes })
    }
}

/// Appends the values of cells as they are meant.
#[expect(clippy::useless_conversion, reason = "one of the types is a double already")]
fn push(values: &mut Vec<f32>, cells: &Cells, band: &BandRecord) {
    let void = band.nodata.map(|bits| bits.to_le_bytes());
    let (scale, offset) = (band.scale.unwrap_or(1.0), band.offset.unwrap_or(0.0));
    let is_scaled = band.scale.is_some() || band.offset.is_some();
    with_cells!(cells, cells => {
        values.extend(cells.iter().map(|&cell| {
            let bytes = cell.to_le_bytes();
            if void.is_some_and(|void| void[..bytes.len()] == bytes) {
                return f32::NAN;
            }
            let value = f64::from(cell);
            (if is_scaled { value * scale + offset } else { value }) as f32
        }));
    });
}
