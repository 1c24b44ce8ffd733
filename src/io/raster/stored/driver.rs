//! The formats that rasters can be written in: which one a name means, what it can hold, how it is best written.
#![allow(unsafe_code, reason = "the safe bindings create no signed bytes")]

use super::record::Record;
use crate::error::{Error, ErrorKind, Result};
use crate::grid::SampleType;
use crate::io::messages::{failure, quiet};
use gdal::cpl::CslStringList;
use gdal::{Dataset, Driver, DriverManager, DriverType, Metadata};
use gdal_sys::GDALDataType;
use std::ffi::CString;
use std::path::Path;

/// A format of GDAL's that can be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Format {
    /// GDAL's short name.
    pub name: String,
    /// Whether cells can be written bit by bit; otherwise a finished raster is copied.
    pub(super) is_written_in_parts: bool,
}

/// Formats that hold no cells of their own.
const WITHOUT_CELLS: [&str; 4] = ["VRT", "MEM", "DERIVED", "WMS"];

/// Formats that keep all cells of the types that they have.
const FAITHFUL: [&str; 5] = ["GTiff", "COG", "ENVI", "EHdr", "HFA"];

impl Format {
    /// The format of a name, or else the one that a file's extension stands for.
    ///
    /// # Errors
    /// A usage error when there is none that this GDAL can write.
    pub fn of(path: &Path, name: Option<&str>) -> Result<Self> {
        quiet();
        let driver = match name {
            Some(name) => DriverManager::get_driver_by_name(name).map_err(|_| {
                Error::usage(format!("--of {name}: this GDAL has no such format; gdalinfo --formats lists them"))
            })?,
            None => {
                // Some formats have no extension, which is not to say that a name without one means them.
                let found = path
                    .extension()
                    .and_then(|_| DriverManager::get_output_driver_for_dataset_name(path, DriverType::Raster));
                found.ok_or_else(|| {
                    let message = "its extension stands for no raster format that this GDAL writes; name one with --of";
                    Error::usage(message).at_path(path)
                })?
            }
        };
        let short = driver.short_name();
        let can = |what: &str| driver.metadata_item(what, "").is_some();
        let (create, copy) = (can("DCAP_CREATE"), can("DCAP_CREATECOPY"));
        if !can("DCAP_RASTER") || !(create || copy) || WITHOUT_CELLS.contains(&short.as_str()) {
            return Err(Error::usage(format!(
                "{short} is no format that rasters can be written in; name another with --of"
            )));
        }
        Ok(Self { name: short, is_written_in_parts: create })
    }

    /// Whether the format is known to keep all cells with these options. Of many others some types do not come back as
    /// they went in, for which nothing but a look at the file helps.
    pub fn keeps_cells(&self, options: &[(String, String)]) -> bool {
        let loses = |(key, value): &(String, String)| {
            let (key, value) = (key.to_ascii_uppercase(), value.to_ascii_uppercase());
            let compresses =
                key == "COMPRESS" && ["JPEG", "WEBP", "LERC", "JXL"].iter().any(|name| value.contains(name));
            compresses || ["NBITS", "DISCARD_LSB"].contains(&key.as_str())
        };
        FAITHFUL.contains(&self.name.as_str()) && !options.iter().any(loses)
    }

    /// GeoTIFF.
    pub(super) fn geotiff() -> Self {
        Self { name: "GTiff".into(), is_written_in_parts: true }
    }

    /// Looks whether the format holds cells of the record's types.
    ///
    /// # Errors
    /// With the types that it does hold.
    pub fn admit(&self, record: &Record) -> Result<()> {
        let driver = self.driver()?;
        let Some(types) = driver.metadata_item("DMD_CREATIONDATATYPES", "") else { return Ok(()) };
        for band in &record.bands {
            let name = band.sample.name();
            let holds = types.split_whitespace().any(|known| known == name)
                || band.sample == SampleType::I8 && self.has_option("PIXELTYPE")?;
            if !holds {
                return Err(Error::new(
                    ErrorKind::Unsupported,
                    format!("the format {} holds no cells of {name}, but {types}; choose another with --of", self.name),
                ));
            }
        }
        Ok(())
    }

    pub(super) fn driver(&self) -> Result<Driver> {
        DriverManager::get_driver_by_name(&self.name).map_err(|_| {
            Error::new(ErrorKind::Unsupported, format!("this GDAL was built without the format {}", self.name))
        })
    }

    /// Whether the format has an option for creating files.
    fn has_option(&self, option: &str) -> Result<bool> {
        let options = self.driver()?.metadata_item("DMD_CREATIONOPTIONLIST", "").unwrap_or_default();
        Ok(options.contains(&format!("name='{option}'")) || options.contains(&format!("name=\"{option}\"")))
    }

    /// The options for creating a file: those given, and for GeoTIFF what serves elevations best.
    pub(super) fn options(&self, record: &Record, given: &[(String, String)]) -> Result<CslStringList> {
        let mut options: Vec<(String, String)> = given.to_vec();
        let gives = |key: &str| given.iter().any(|(known, _)| known.eq_ignore_ascii_case(key));
        let mut add = |option: &str| {
            if let Some((key, value)) = option.split_once('=').filter(|(key, _)| !gives(key)) {
                options.push((key.into(), value.into()));
            }
        };
        if self.name == "GTiff" {
            let known = self.driver()?.metadata_item("DMD_CREATIONOPTIONLIST", "").unwrap_or_default();
            let is_float = record.bands.iter().any(|band| band.sample.is_float());
            if !gives("COMPRESS") {
                // What is unpacked is for work: quick to write and to read.
                match known.contains("<Value>ZSTD</Value>") {
                    true => ["COMPRESS=ZSTD", "ZSTD_LEVEL=1"].iter().for_each(|option| add(option)),
                    false => add("COMPRESS=DEFLATE"),
                }
                add(if is_float { "PREDICTOR=3" } else { "PREDICTOR=2" });
            }
            // The bytes do not depend on it.
            add(&format!("NUM_THREADS={}", rayon::current_num_threads()));
            add("TILED=YES");
            add("BIGTIFF=IF_SAFER");
            if record.bands.len() > 1 {
                add("INTERLEAVE=BAND");
            }
        }
        let is_signed_byte = record.bands.first().is_some_and(|band| band.sample == SampleType::I8);
        if is_signed_byte && !knows_int8() {
            add("PIXELTYPE=SIGNEDBYTE");
        }
        let mut list = CslStringList::new();
        for (key, value) in &options {
            list.add_name_value(key, value)
                .map_err(|_| Error::usage(format!("--co {key}={value} is no option: expected KEY=VALUE")))?;
        }
        Ok(list)
    }

    /// Creates a file for a raster whose bands are all of one type.
    pub(super) fn create(
        &self,
        path: &Path,
        target: &Path,
        record: &Record,
        options: &CslStringList,
    ) -> Result<Dataset> {
        let driver = self.driver()?;
        let wrong = |message: &str| Error::new(ErrorKind::Unsupported, message).at_path(target);
        let sample = record.bands.first().map_or(SampleType::U8, |band| band.sample);
        let side = |n: usize| i32::try_from(n).map_err(|_| wrong("a side is too long for GDAL"));
        let (width, height, bands) = (side(record.width)?, side(record.height)?, side(record.bands.len())?);
        let name = path.to_str().and_then(|text| CString::new(text).ok());
        let name = name.ok_or_else(|| wrong("GDAL takes file names in UTF-8 only"))?;
        // SAFETY: name and options outlive the call.
        let dataset = unsafe {
            gdal_sys::GDALCreate(
                driver.c_driver(),
                name.as_ptr(),
                width,
                height,
                bands,
                type_of(sample),
                options.as_ptr(),
            )
        };
        if dataset.is_null() {
            let error = gdal::errors::GdalError::NullPointer { method_name: "GDALCreate", msg: String::new() };
            return Err(failure(ErrorKind::Output, "it cannot be created", target, &error));
        }
        // SAFETY: the handle is new, and nobody else has it.
        Ok(unsafe { Dataset::from_c_dataset(dataset) })
    }
}

/// Whether this GDAL has a type of signed bytes.
fn knows_int8() -> bool {
    // SAFETY: the function looks a name up in a table.
    unsafe { gdal_sys::GDALGetDataTypeByName(c"Int8".as_ptr()) != GDALDataType::GDT_Unknown }
}

/// GDAL's number of a type.
fn type_of(sample: SampleType) -> GDALDataType::Type {
    match sample {
        // SAFETY: the function looks a name up in a table.
        SampleType::I8 if knows_int8() => unsafe { gdal_sys::GDALGetDataTypeByName(c"Int8".as_ptr()) },
        SampleType::U8 | SampleType::I8 => GDALDataType::GDT_Byte,
        SampleType::U16 => GDALDataType::GDT_UInt16,
        SampleType::I16 => GDALDataType::GDT_Int16,
        SampleType::U32 => GDALDataType::GDT_UInt32,
        SampleType::I32 => GDALDataType::GDT_Int32,
        SampleType::F32 => GDALDataType::GDT_Float32,
        SampleType::F64 => GDALDataType::GDT_Float64,
    }
}
