//! The input: one band, read window by window as heights.

use super::cell_size::CellSize;
use super::sketch::{self, Greys};
use crate::crs::Crs;
use crate::error::{Error, ErrorKind, Result};
use crate::grid::{GeoTransform, SampleType};
use crate::io::raster::parse_crs;
use crate::io::raster::stored::{BandRecord, PALETTE_NOTE, Record, StoredOptions};
use crate::pipeline::archive::Input;
use crate::units::LengthUnit;
use crate::with_cells;
use std::path::{Path, PathBuf};

/// An opened DEM.
pub(super) struct Terrain {
    path: PathBuf,
    input: Input,
    /// What is said of it: by the file, and of a sketch by the job.
    record: Record,
    /// What greys stand for, where it is a sketch.
    greys: Option<Greys>,
    /// Metres in a unit of its elevations.
    unit_m: f64,
    /// Size of its cells.
    pub(super) cell: CellSize,
}

impl Terrain {
    /// Opens the one band that the options name, or the file's only one; `unit` replaces what is said of its
    /// elevations' unit.
    ///
    /// # Errors
    /// When it cannot be opened, there are several bands and none is named, or its unit is not known.
    pub(super) fn open(path: &Path, options: &StoredOptions, unit: Option<&LengthUnit>) -> Result<Self> {
        let input = Input::open(path, options)?;
        let record = input.record().clone();
        Self::of(path, input, record, None, unit)
    }

    /// Opens a sketch: a drawn map whose greys stand for elevations in metres, those of black and of white.
    ///
    /// # Errors
    /// As [`Terrain::open`] and [`sketch::open`].
    pub(super) fn open_sketch(path: &Path, options: &StoredOptions, heights_m: [f64; 2]) -> Result<Self> {
        let (input, record, greys) = sketch::open(path, options, heights_m)?;
        Self::of(path, input, record, Some(greys), None)
    }

    fn of(path: &Path, input: Input, record: Record, greys: Option<Greys>, unit: Option<&LengthUnit>) -> Result<Self> {
        let [band] = record.bands.as_slice() else {
            let bands = record.bands.len();
            let message = format!("{bands} bands, and one is made finer: choose it with --band");
            return Err(Error::usage(message).at_path(path));
        };
        let crs = record.crs.as_deref().map(parse_crs).transpose().map_err(|error| error.at_path(path))?;
        let stated = match unit {
            Some(unit) => Some(unit.clone()),
            None => {
                let vertical = crs.as_ref().and_then(|crs| crs.vertical_unit.as_deref()).unwrap_or("m");
                LengthUnit::from_name(if band.unit.trim().is_empty() { vertical } else { &band.unit })
            }
        };
        let unit_m = stated.map(|unit| unit.metres).ok_or_else(|| {
            let message = format!(
                "its unit '{}' is not a length that is known; say in what its elevations are with --vertical-unit m",
                band.unit
            );
            Error::new(ErrorKind::Unsupported, message).at_path(path)
        })?;
        let transform = record.transform.unwrap_or(GeoTransform::PIXELS);
        let cell = CellSize::of(&transform, crs.as_ref(), record.height, record.width);
        if !(cell.across_m > 0.0 && cell.down_m > 0.0 && cell.across_m.is_finite() && cell.down_m.is_finite()) {
            let message = format!("the geotransform {:?} gives cells no size", transform.0);
            return Err(Error::new(ErrorKind::Unsupported, message).at_path(path));
        }
        Ok(Self { path: path.to_path_buf(), unit_m, cell, input, record, greys })
    }

    /// Rows and columns.
    pub(super) fn size(&self) -> [usize; 2] {
        [self.record.height, self.record.width]
    }

    /// Where its cells lie, if that is known.
    pub(super) fn transform(&self) -> Option<GeoTransform> {
        self.record.transform
    }

    /// The system of its coordinates, if that is known.
    ///
    /// # Errors
    /// When it cannot be made out.
    pub(super) fn crs(&self) -> Result<Option<Crs>> {
        let crs = self.record.crs.as_deref().map(parse_crs).transpose();
        crs.map_err(|error| error.at_path(&self.path))
    }

    /// What a user should know of how it is read.
    pub(super) fn notes(&self) -> impl Iterator<Item = &String> {
        // The palette of a sketch is made use of.
        let is_void = |note: &&String| self.greys.is_some() && note.starts_with(PALETTE_NOTE);
        self.input.notes().iter().filter(move |note| !is_void(note))
    }

    /// Metres in a unit of its elevations.
    pub(super) fn unit_m(&self) -> f64 {
        self.unit_m
    }

    /// Elevations in the input's own unit, NaN for voids: rows from `row`, columns from `col`.
    ///
    /// # Errors
    /// When they cannot be read, or one is infinite.
    pub(super) fn read(&self, [row, col]: [usize; 2], [rows, cols]: [usize; 2]) -> Result<Vec<f64>> {
        let cells = self.input.read(0, [col, row, cols, rows])?;
        let band = &self.input.record().bands[0];
        let void = band.nodata.map(|bits| bits.to_le_bytes());
        let (scale, offset) = (band.scale.unwrap_or(1.0), band.offset.unwrap_or(0.0));
        let height = |cell: f64| match &self.greys {
            Some(greys) => greys.elevation_m(cell).unwrap_or(f64::NAN),
            None => cell * scale + offset,
        };
        #[expect(clippy::useless_conversion, reason = "one of the types is a double already")]
        let heights: Vec<f64> = with_cells!(&cells, cells => cells
            .iter()
            .map(|&cell| {
                let bytes = cell.to_le_bytes();
                let is_void = void.is_some_and(|void| void[..bytes.len()] == bytes);
                if is_void { f64::NAN } else { height(f64::from(cell)) }
            })
            .collect());
        if let Some(cell) = heights.iter().position(|height| height.is_infinite()) {
            let place = format!("row {}, column {}", row + cell / cols, col + cell % cols);
            let message = "an infinite elevation; mark it as nodata with --nodata";
            return Err(Error::new(ErrorKind::Input, message).at_path(&self.path).at_place(place));
        }
        Ok(heights)
    }

    /// What a finer raster of it says of itself: single precision in the same unit, at the same place.
    pub(super) fn finer_record(&self, factor: usize) -> Record {
        let record = &self.record;
        let band = &record.bands[0];
        // A value that single precision does not have stands for voids no better than NaN.
        let nodata = band.nodata_value().map(|value| value as f32).filter(|value| value.is_finite());
        let is_declared = band.nodata.is_some();
        let parts = 1.0 / factor as f64;
        Record {
            width: record.width * factor,
            height: record.height * factor,
            bands: vec![BandRecord {
                nodata: is_declared.then(|| u64::from(nodata.unwrap_or(f32::NAN).to_bits())),
                unit: band.unit.clone(),
                description: band.description.clone(),
                ..BandRecord::new(SampleType::F32)
            }],
            transform: record.transform.map(|transform| transform.scaled(parts, parts)),
            crs: record.crs.clone(),
            epoch: record.epoch,
            is_point: record.is_point,
            metadata: vec![],
        }
    }
}
