//! An opened raster: its record, and windows of its cells.

use super::super::crs::parse_crs;
use super::super::source::{is_signed_byte, no_bands, open_dataset, sample_type_of};
use super::super::strips::strip_bounds;
use super::cell::{self, StoredCell};
use super::georeference::{epoch_of, ground_control_points, wkt_of};
use super::mask::Mask;
use super::metadata;
use super::record::{BandRecord, Record};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::{GeoTransform, SampleType, window_of};
use crate::io::messages::{failure, take_failures};
use gdal::errors::GdalError;
use gdal::raster::{ColorInterpretation, RasterBand};
use gdal::{Dataset, Metadata};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// How what is said of a colour table begins, for those who make use of it.
pub const PALETTE_NOTE: &str = "the colour table";

/// What to read of a raster; what is empty or `None` is taken from the file.
#[derive(Clone, Debug, Default)]
pub struct StoredOptions {
    /// Numbers of the bands, from 1; all unless given, but for an alpha band.
    pub bands: Vec<usize>,
    /// Value of the cells without data; replaces those declared.
    pub nodata: Option<f64>,
    /// CRS that replaces the file's.
    pub crs: Option<String>,
    /// First column, first row, columns, rows.
    pub window: Option<[usize; 4]>,
    /// Least x, least y, greatest x, greatest y in the raster's CRS.
    pub bbox: Option<[f64; 4]>,
}

/// Bands of a raster file, opened but not read.
pub struct StoredSource {
    /// The file.
    pub path: PathBuf,
    /// GDAL's short name of the format.
    pub driver: String,
    /// What is read of it.
    pub record: Record,
    /// What a user should know of how the file is read.
    pub notes: Vec<String>,
    /// First column and first row that are read.
    corner: [usize; 2],
    bands: Vec<SourceBand>,
    /// Columns and rows of the file's blocks.
    block: (usize, usize),
    /// Datasets that no thread uses just now.
    idle: Mutex<Vec<Dataset>>,
}

/// A band that is read.
struct SourceBand {
    /// Number in the file, from 1.
    number: usize,
    mask: Option<Mask>,
    palette: Option<Vec<[u8; 4]>>,
}

impl StoredSource {
    /// Opens a raster.
    ///
    /// # Errors
    /// Missing, unreadable and empty files, bands that are not there or of a type that cannot be stored, a window
    /// outside of the raster.
    pub fn open(path: &Path, options: &StoredOptions) -> Result<Self> {
        let dataset = open_dataset(path)?;
        let mut source = Self::describe(&dataset, path, options).map_err(|error| error.at_path(path))?;
        source.idle = Mutex::new(vec![dataset]);
        Ok(source)
    }

    fn describe(dataset: &Dataset, path: &Path, options: &StoredOptions) -> Result<Self> {
        let mut notes = Vec::new();
        let size = dataset.raster_size();
        let transform = dataset.geo_transform().ok().map(GeoTransform);
        if options.bbox.is_some() && transform.is_none() {
            return Err(Error::usage("--bbox: the file does not say where its cells are; use --window"));
        }
        let [col, row, width, height] =
            window_of(&transform.unwrap_or(GeoTransform::PIXELS), size, options.window, options.bbox)?;
        let is_part = (width, height) != size;
        let mut metadata = metadata::read(dataset);
        if is_part && metadata::drop_places(&mut metadata) {
            notes.push("the metadata RPC and GEOLOCATION are of the whole raster and left out of a part".into());
        }
        if transform.is_none() && ground_control_points(dataset) > 0 {
            notes.push(
                "the file is placed by ground control points, which are not kept; warp it first with gdalwarp to keep its place"
                    .into(),
            );
        }
        let (crs, epoch) = crs_of(dataset, options.crs.as_deref(), &mut notes)?;
        let numbers = numbers_of(dataset, &options.bands, &mut notes)?;
        let keeps_alpha = numbers.iter().any(|&number| is_alpha(dataset, number));
        let mut bands = Vec::new();
        let mut records = Vec::new();
        let mut block = (1, 1);
        for &number in &numbers {
            let band = dataset
                .rasterband(number)
                .map_err(|error| failure(ErrorKind::Corrupt, "the band cannot be opened", path, &error))?;
            let at_band = |error: Error| error.at_place(format!("band {number}"));
            let record = record_of(&band, number, options.nodata, &mut notes).map_err(at_band)?;
            let mask = mask_of(&band, &record, keeps_alpha, number, &mut notes).map_err(at_band)?;
            block = band.block_size();
            records.push(BandRecord { nodata: mask.map_or(record.nodata, |mask| Some(mask.nodata)), ..record });
            bands.push(SourceBand { number, mask, palette: palette_of(&band) });
        }
        Ok(Self {
            path: path.to_path_buf(),
            driver: dataset.driver().short_name(),
            record: Record {
                width,
                height,
                bands: records,
                // Only a part has another one: the bits stay as they are.
                transform: transform.map(|t| if col + row > 0 { t.window(row as f64, col as f64) } else { t }),
                crs,
                epoch,
                is_point: dataset
                    .metadata_item(metadata::AREA_OR_POINT, "")
                    .is_some_and(|item| item.eq_ignore_ascii_case("Point")),
                metadata,
            },
            notes,
            corner: [col, row],
            bands,
            block,
            idle: Mutex::default(),
        })
    }

    /// The colour table of a band, counted from 0 in the record: red, green, blue and opacity of each of its numbers.
    ///
    /// # Panics
    /// When there is no such band.
    pub fn palette(&self, band: usize) -> Option<&[[u8; 4]]> {
        self.bands[band].palette.as_deref()
    }

    /// Rows that the file's blocks have: what is read at multiples of them is unpacked once.
    pub fn block_rows(&self) -> usize {
        self.block.1.max(1)
    }

    /// Reads a window (column, row, columns, rows) of a band, both counted from 0 in the record, on all threads.
    ///
    /// # Errors
    /// A damaged or truncated file, with the rows where it fails; a cell that cannot be told from a masked one.
    ///
    /// # Panics
    /// When there is no such band, or the cells do not fit the window.
    pub fn read<T: StoredCell>(&self, band: usize, window: [usize; 4], cells: &mut [T]) -> Result<()> {
        let [col, row, width, height] = window;
        assert_eq!(cells.len(), width * height, "a place for each cell");
        let from = self.corner[1] + row;
        let strip = (super::super::read::STRIP_CELLS / width.max(1) / self.block_rows()).max(1) * self.block_rows();
        let mut rest = cells;
        let mut strips = Vec::new();
        for pair in strip_bounds(from, from + height, strip).windows(2) {
            let (lines, tail) = rest.split_at_mut((pair[1] - pair[0]) * width);
            strips.push(([self.corner[0] + col, pair[0], width, pair[1] - pair[0]], lines));
            rest = tail;
        }
        // All are looked at, so that the first failure in the file is the one that is told.
        let results: Vec<Result<()>> =
            strips.into_par_iter().map(|(window, lines)| self.read_strip(&self.bands[band], window, lines)).collect();
        results.into_iter().collect()
    }

    fn read_strip<T: StoredCell>(&self, band: &SourceBand, window: [usize; 4], cells: &mut [T]) -> Result<()> {
        let dataset = self.take()?;
        let result = self.read_from(&dataset, band, window, cells);
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(dataset);
        result
    }

    fn read_from<T: StoredCell>(
        &self,
        dataset: &Dataset,
        band: &SourceBand,
        window: [usize; 4],
        cells: &mut [T],
    ) -> Result<()> {
        let [col, row, width, height] = window;
        let place = || format!("band {}, rows {row} to {}", band.number, row + height - 1);
        let wrong = |error: GdalError| {
            let what = "the cells cannot be read (is the file damaged or cut short?)";
            failure(ErrorKind::Corrupt, what, &self.path, &error).at_place(place())
        };
        // What was said on this thread before is not about these cells.
        take_failures();
        let raster = dataset.rasterband(band.number).map_err(wrong)?;
        cell::read(&raster, window, cells).map_err(wrong)?;
        let mut is_unique = true;
        if let Some(rule) = band.mask {
            let mut mask = vec![0; cells.len()];
            let size = (width, height);
            let valid = raster.open_mask_band().map_err(wrong)?;
            valid.read_into_slice::<u8>((col as isize, row as isize), size, size, &mut mask, None).map_err(wrong)?;
            is_unique = rule.apply(cells, &mask);
        }
        // Some drivers report a block that cannot be read and carry on with zeros.
        let said = take_failures();
        if !said.is_empty() {
            let message = format!("the cells cannot be read: {}", said.join("; "));
            return Err(Error::new(ErrorKind::Corrupt, message).at_path(&self.path).at_place(place()));
        }
        if !is_unique {
            let message = "a cell has the value that masked cells are given; name one that no cell has with --nodata";
            return Err(Error::new(ErrorKind::Unsupported, message).at_path(&self.path).at_place(place()));
        }
        Ok(())
    }

    fn take(&self) -> Result<Dataset> {
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        idle.map_or_else(|| open_dataset(&self.path), Ok)
    }
}

/// Numbers of the bands to read.
fn numbers_of(dataset: &Dataset, wanted: &[usize], notes: &mut Vec<String>) -> Result<Vec<usize>> {
    let count = dataset.raster_count();
    if count == 0 {
        return Err(no_bands(dataset));
    }
    if let Some(number) = wanted.iter().find(|&&number| number == 0 || number > count) {
        return Err(Error::usage(format!("there is no band {number}: the file has bands 1 to {count}")));
    }
    if !wanted.is_empty() {
        return Ok(wanted.to_vec());
    }
    let (alpha, others): (Vec<usize>, Vec<usize>) = (1..=count).partition(|&number| is_alpha(dataset, number));
    if others.is_empty() {
        return Ok(alpha);
    }
    if let Some(number) = alpha.first() {
        notes.push(format!(
            "band {number} is an alpha band: cells where it is 0 become nodata in the others, and it is left out (name it with --band to keep it)"
        ));
    }
    Ok(others)
}

fn is_alpha(dataset: &Dataset, number: usize) -> bool {
    dataset.rasterband(number).is_ok_and(|band| band.color_interpretation() == ColorInterpretation::AlphaBand)
}

/// The colour table of a band.
fn palette_of(band: &RasterBand<'_>) -> Option<Vec<[u8; 4]>> {
    let table = band.color_table()?;
    let colour = |number: usize| {
        let entry = table.entry_as_rgb(number).map_or([0; 4], |entry| [entry.r, entry.g, entry.b, entry.a]);
        entry.map(|part| part.clamp(0, 255) as u8)
    };
    Some((0..table.entry_count()).map(colour).collect())
}

/// The CRS as WKT2 and the epoch of the coordinates.
fn crs_of(dataset: &Dataset, assigned: Option<&str>, notes: &mut Vec<String>) -> Result<(Option<String>, Option<f64>)> {
    let stated = dataset.spatial_ref().ok();
    let Some(text) = assigned else {
        return match stated {
            Some(stated) => Ok((Some(wkt_of(&stated)?), epoch_of(&stated))),
            None => Ok((None, None)),
        };
    };
    let given = parse_crs(text)?;
    if let Some(stated) = stated
        && wkt_of(&stated).ok().as_ref() != Some(&given.wkt)
    {
        notes.push(format!("the file's CRS is {}; --crs {text} replaces it", stated.name().unwrap_or_default()));
    }
    Ok((Some(given.wkt), None))
}

fn record_of(band: &RasterBand<'_>, number: usize, nodata: Option<f64>, notes: &mut Vec<String>) -> Result<BandRecord> {
    let sample = sample_of(band)?;
    let declared = nodata.or_else(|| band.no_data_value());
    let bits = declared.and_then(|value| sample.bits_of(value));
    if let (Some(value), None) = (declared, bits) {
        let name = sample.name();
        if nodata.is_some() {
            return Err(Error::usage(format!("--nodata {value} is no value of its type, {name}")));
        }
        notes.push(format!(
            "band {number} declares the nodata value {value}, which no cell of {name} can have: dropped"
        ));
    }
    if band.color_table().is_some() {
        notes.push(format!("{PALETTE_NOTE} of band {number} is left out"));
    }
    Ok(BandRecord {
        sample,
        nodata: bits,
        scale: band.scale(),
        offset: band.offset(),
        unit: band.unit(),
        description: band.description().unwrap_or_default(),
        metadata: metadata::read(band),
    })
}

fn sample_of(band: &RasterBand<'_>) -> Result<SampleType> {
    match sample_type_of(band, "bands of 8 to 32-bit integers, Float32 or Float64 can be stored")? {
        SampleType::U8 if is_signed_byte(band) => Ok(SampleType::I8),
        sample => Ok(sample),
    }
}

/// How cells are masked by more than their value.
fn mask_of(
    band: &RasterBand<'_>,
    record: &BandRecord,
    keeps_alpha: bool,
    number: usize,
    notes: &mut Vec<String>,
) -> Result<Option<Mask>> {
    let unreadable = |error: GdalError| Error::new(ErrorKind::Corrupt, format!("the mask cannot be read: {error}"));
    let flags = band.mask_flags().map_err(unreadable)?;
    if flags.is_all_valid() || !(flags.is_per_dataset() || flags.is_alpha()) {
        return Ok(None);
    }
    // An alpha band that is stored itself says all there is to say.
    if flags.is_alpha() && keeps_alpha {
        return Ok(None);
    }
    let mask = Mask::new(record.sample, record.nodata);
    let value = record.sample.value_of_bits(mask.nodata);
    notes.push(format!("cells that the mask of band {number} hides become nodata, with the value {value}"));
    Ok(Some(mask))
}
