//! An opened raster: everything that is known before a cell is read.

use super::super::messages::{failure, quiet};
use super::crs::{describe, parse_crs};
use super::stored::MemoryRaster;
use crate::crs::{Crs, CrsKind};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::{Elevations, GeoTransform, SampleType, window_of};
use crate::units::LengthUnit;
use gdal::raster::{GdalDataType, RasterBand};
use gdal::{Dataset, DatasetOptions, GdalOpenFlags};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How to read a raster; what is `None` is taken from the file.
#[derive(Clone, Debug, Default)]
pub struct RasterOptions {
    /// Number of the band, from 1; the first unless given.
    pub band: Option<usize>,
    /// Value of the cells without data; replaces a declared one.
    pub nodata: Option<f64>,
    /// CRS of a raster that has none.
    pub crs: Option<String>,
    /// Unit of the elevations.
    pub vertical_unit: Option<LengthUnit>,
    /// First column, first row, columns, rows.
    pub window: Option<[usize; 4]>,
    /// Least x, least y, greatest x, greatest y in the raster's CRS.
    pub bbox: Option<[f64; 4]>,
}

/// How a band marks cells without data.
#[derive(Clone, Debug, PartialEq)]
pub struct NoData {
    /// The value that means nodata; NaN always does.
    pub value: Option<f64>,
    /// Whether a mask band or an alpha band marks them too.
    pub mask: bool,
}

/// One band of a raster file, opened but not read.
#[derive(Debug)]
pub struct RasterSource {
    /// The file.
    pub path: PathBuf,
    /// The raster in memory that is read in the file's place, where it had to be unpacked first.
    pub(super) unpacked: Option<Arc<MemoryRaster>>,
    /// GDAL's short name of the format.
    pub driver: String,
    /// Number of the band, from 1.
    pub band: usize,
    /// Number of bands in the file.
    pub bands: usize,
    /// Columns and rows of the file.
    pub file_size: (usize, usize),
    /// First column and first row that are read, and how many of each.
    pub window: [usize; 4],
    /// Columns and rows of the file's blocks.
    pub block: (usize, usize),
    /// Meaning of the values.
    pub elevations: Elevations,
    /// Nodata of the band.
    pub nodata: NoData,
    /// Where the cells of the window are, rows from north to south and columns from west to east.
    pub transform: GeoTransform,
    /// Whether the file says where its cells are.
    pub is_georeferenced: bool,
    /// Whether the file's rows run from south to north and are turned round.
    pub flips_rows: bool,
    /// Whether the file's columns run from east to west and are turned round.
    pub flips_cols: bool,
    /// Whether the columns span 360 degrees.
    pub wraps: bool,
    /// The CRS.
    pub crs: Option<Crs>,
    /// What a user should know of how the file is read.
    pub notes: Vec<String>,
}

/// Opens a raster for reading.
pub(super) fn open_dataset(path: &Path) -> Result<Dataset> {
    quiet();
    let options = DatasetOptions {
        open_flags: GdalOpenFlags::GDAL_OF_RASTER
            | GdalOpenFlags::GDAL_OF_READONLY
            | GdalOpenFlags::GDAL_OF_VERBOSE_ERROR,
        ..DatasetOptions::default()
    };
    let text = path.to_string_lossy();
    // Virtual file systems and connection strings (NETCDF:"file":variable) are GDAL's to resolve.
    let is_plain = !text.starts_with("/vsi") && !text.contains(':') && !text.trim_start().starts_with('<');
    if is_plain {
        match std::fs::metadata(path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Err(Error::new(ErrorKind::Input, "no such file").at_path(path));
            }
            Err(error) => return Err(Error::new(ErrorKind::Input, error.to_string()).at_path(path)),
            Ok(data) if data.is_file() && data.len() == 0 => {
                return Err(Error::new(ErrorKind::Corrupt, "the file is empty").at_path(path));
            }
            Ok(_) => {}
        }
    }
    Dataset::open_ex(path, options)
        .map_err(|error| failure(ErrorKind::Input, "GDAL cannot open it as a raster", path, &error))
}

impl RasterSource {
    /// Opens a band of a raster.
    ///
    /// # Errors
    /// Missing, unreadable and empty files, a band that is not there, a type or a georeference that is not
    /// supported, a window outside of the raster.
    pub fn open(path: &Path, options: &RasterOptions) -> Result<Self> {
        let dataset = open_dataset(path)?;
        Self::describe(&dataset, path, options).map_err(|error| error.at_path(path))
    }

    /// Opens a band of a raster that a file was unpacked to; `path` is that file.
    ///
    /// # Errors
    /// As [`RasterSource::open`].
    pub fn open_unpacked(path: &Path, raster: MemoryRaster, options: &RasterOptions) -> Result<Self> {
        let dataset = open_dataset(raster.path())?;
        let mut source = Self::describe(&dataset, path, options).map_err(|error| error.at_path(path))?;
        source.unpacked = Some(Arc::new(raster));
        Ok(source)
    }

    /// Opens what the cells are read from.
    pub(super) fn dataset(&self) -> Result<Dataset> {
        open_dataset(self.unpacked.as_ref().map_or(&self.path, |raster| raster.path()))
    }

    /// Bytes of memory that the raster takes before it is read.
    pub fn unpacked_bytes(&self) -> u64 {
        let bytes = self.cells() * self.elevations.sample_type.bytes() as u64;
        if self.unpacked.is_some() { bytes } else { 0 }
    }

    fn describe(dataset: &Dataset, path: &Path, options: &RasterOptions) -> Result<Self> {
        let mut notes = Vec::new();
        let bands = dataset.raster_count();
        if bands == 0 {
            return Err(no_bands(dataset));
        }
        let number = options.band.unwrap_or(1);
        if number == 0 || number > bands {
            return Err(Error::usage(format!("there is no band {number}: the file has bands 1 to {bands}")));
        }
        if bands > 1 && options.band.is_none() {
            notes.push(format!("the file has {bands} bands; reading band 1 (choose with --band)"));
        }
        let band = dataset
            .rasterband(number)
            .map_err(|error| failure(ErrorKind::Corrupt, "the band cannot be opened", path, &error))?;
        let place = |error: Error| error.at_place(format!("band {number}"));
        let crs = crs_of(dataset, options, &mut notes)?;
        let elevations = elevations_of(&band, options, crs.as_ref(), &mut notes).map_err(place)?;
        let (cols, rows) = dataset.raster_size();
        let stated = dataset.geo_transform().ok().map(GeoTransform);
        let is_georeferenced = stated.is_some();
        let whole = stated.unwrap_or(GeoTransform::PIXELS);
        if !whole.is_invertible() {
            return Err(Error::new(
                ErrorKind::Unsupported,
                format!("the geotransform {:?} maps different cells to one place", whole.0),
            ));
        }
        if !is_georeferenced {
            notes.push(
                "the file does not say where its cells are: distances are in cells, as if they were metres".into(),
            );
        } else if crs.is_none() {
            notes.push("the file has no CRS: distances come from its geotransform, as if its unit were the metre (assign one with --crs)".into());
        }
        let mut window = window_of(&whole, (cols, rows), options.window, options.bbox)?;
        let (wraps, repeats) = spans_globe(crs.as_ref(), &whole, window[2]);
        if repeats {
            notes.push("the last column repeats the first (360 degrees further east); it is left out".into());
            window[2] -= 1;
        }
        let mut transform = whole.window(window[1] as f64, window[0] as f64);
        let flips_rows = transform.is_axis_parallel() && transform.0[5] > 0.0;
        let flips_cols = transform.is_axis_parallel() && transform.0[1] < 0.0;
        if flips_rows {
            transform = transform.flipped_rows(window[3]);
            notes.push("the file's rows run from south to north; rows are counted from the north here".into());
        }
        if flips_cols {
            transform = transform.flipped_cols(window[2]);
            notes.push("the file's columns run from east to west; columns are counted from the west here".into());
        }
        let flags =
            band.mask_flags().map_err(|error| failure(ErrorKind::Corrupt, "the mask cannot be read", path, &error))?;
        let mask = !flags.is_all_valid() && (flags.is_per_dataset() || flags.is_alpha());
        Ok(Self {
            path: path.to_path_buf(),
            unpacked: None,
            driver: dataset.driver().short_name(),
            band: number,
            bands,
            file_size: (cols, rows),
            window,
            block: band.block_size(),
            elevations,
            nodata: NoData { value: options.nodata.or_else(|| band.no_data_value()), mask },
            transform,
            is_georeferenced,
            flips_rows,
            flips_cols,
            wraps,
            crs,
            notes,
        })
    }

    /// Number of cells that will be read.
    pub fn cells(&self) -> u64 {
        self.window[2] as u64 * self.window[3] as u64
    }

    /// Bytes that a key of this band takes in memory.
    pub fn key_bytes(&self) -> u64 {
        match self.elevations.sample_type.bytes() {
            1 => 2,
            bytes => bytes as u64,
        }
    }
}

pub(super) fn no_bands(dataset: &Dataset) -> Error {
    use gdal::Metadata;
    let inner: Vec<String> = dataset
        .metadata_domain("SUBDATASETS")
        .unwrap_or_default()
        .iter()
        .filter_map(|item| item.split_once("_NAME=").map(|(_, name)| name.to_string()))
        .collect();
    let remedy = if inner.is_empty() {
        "it is not an elevation model".to_string()
    } else {
        format!("it holds several rasters; name one of them: {}", inner.join(", "))
    };
    Error::new(ErrorKind::Input, format!("the file has no raster band of its own: {remedy}"))
}

fn crs_of(dataset: &Dataset, options: &RasterOptions, notes: &mut Vec<String>) -> Result<Option<Crs>> {
    let stated = dataset.spatial_ref().ok();
    match (&options.crs, stated) {
        (Some(text), None) => parse_crs(text).map(Some),
        (Some(text), Some(stated)) => {
            let (given, stated) = (parse_crs(text)?, describe(&stated)?);
            if given.wkt != stated.wkt {
                notes.push(format!("the file's CRS is {}; --crs {text} replaces it", stated.label()));
            }
            Ok(Some(given))
        }
        (None, Some(stated)) => describe(&stated).map(Some),
        (None, None) => Ok(None),
    }
}

pub(super) fn is_signed_byte(band: &RasterBand<'_>) -> bool {
    use gdal::Metadata;
    band.metadata_item("PIXELTYPE", "IMAGE_STRUCTURE").is_some_and(|item| item == "SIGNEDBYTE")
}

/// The type of a band's cells as GDAL gives them; the error says what is `expected` instead of others.
pub(super) fn sample_type_of(band: &RasterBand<'_>, expected: &str) -> Result<SampleType> {
    Ok(match band.band_type() {
        GdalDataType::UInt8 => SampleType::U8,
        GdalDataType::UInt16 => SampleType::U16,
        GdalDataType::Int16 => SampleType::I16,
        GdalDataType::UInt32 => SampleType::U32,
        GdalDataType::Int32 => SampleType::I32,
        GdalDataType::Float32 => SampleType::F32,
        GdalDataType::Float64 => SampleType::F64,
        // GDAL has had a type of its own for them since 3.7.
        other if other.name() == "Int8" => SampleType::I8,
        other => {
            return Err(Error::new(
                ErrorKind::Unsupported,
                format!("its type is {}; {expected} (convert with gdal_translate -ot)", other.name()),
            ));
        }
    })
}

fn elevations_of(
    band: &RasterBand<'_>,
    options: &RasterOptions,
    crs: Option<&Crs>,
    notes: &mut Vec<String>,
) -> Result<Elevations> {
    let sample_type = sample_type_of(band, "elevations are 8 to 32-bit integers, Float32 or Float64")?;
    if sample_type == SampleType::U8 && is_signed_byte(band) {
        return Err(Error::new(
            ErrorKind::Unsupported,
            "its type is Byte with PIXELTYPE=SIGNEDBYTE, which GDAL reads as unsigned before 3.7; convert it to Int16 first",
        ));
    }
    let (scale, offset) = (band.scale().unwrap_or(1.0), band.offset().unwrap_or(0.0));
    if scale == 0.0 || !scale.is_finite() || !offset.is_finite() {
        return Err(Error::new(
            ErrorKind::Corrupt,
            format!(
                "its scale is {scale} and its offset {offset}: expected a finite scale other than 0 and a finite offset"
            ),
        ));
    }
    if scale < 0.0 {
        notes.push(format!("the band's scale is {scale}: greater values are lower places"));
    }
    let stated = band.unit();
    let unit = match &options.vertical_unit {
        Some(unit) => unit.clone(),
        None if !stated.trim().is_empty() => LengthUnit::from_name(&stated).ok_or_else(|| {
            Error::new(
                ErrorKind::Unsupported,
                format!("its unit '{stated}' is not a length that is known; if these are elevations, say in what with --vertical-unit m"),
            )
        })?,
        None => match crs.and_then(|crs| crs.vertical_unit.as_deref()) {
            Some(name) => LengthUnit::from_name(name).ok_or_else(|| {
                Error::new(
                    ErrorKind::Unsupported,
                    format!("the vertical CRS's unit '{name}' is not a length that is known; say in what the elevations are with --vertical-unit"),
                )
            })?,
            None => LengthUnit::metre(),
        },
    };
    Ok(Elevations { sample_type, scale, offset, unit })
}

/// Whether the columns span 360 degrees within a hundredth of a cell, and whether the last one repeats the first.
fn spans_globe(crs: Option<&Crs>, transform: &GeoTransform, cols: usize) -> (bool, bool) {
    let Some(Crs { kind: CrsKind::Geographic { degrees, .. }, .. }) = crs else { return (false, false) };
    if !transform.is_axis_parallel() {
        return (false, false);
    }
    let step = (transform.0[1] * degrees).abs();
    let around = |cols: usize| (cols as f64 * step - 360.0).abs() < 0.01 * step;
    let repeats = cols > 3 && around(cols - 1);
    (around(cols) || repeats, repeats)
}
