//! What a record says, said in a file.
#![allow(unsafe_code, reason = "the safe bindings do not set the unit of a band")]

use super::georeference::spatial_ref;
use super::metadata;
use super::record::{BandRecord, Item, Record};
use crate::io::messages::take_failures;
use gdal::errors::GdalError;
use gdal::raster::RasterBand;
use gdal::{Dataset, Metadata};
use gdal_sys::CPLErr;
use std::ffi::CString;

/// Writes all that the record says. What a format cannot keep is told, and no reason to fail.
pub(super) fn describe(dataset: &mut Dataset, record: &Record, notes: &mut Vec<String>) {
    let format = dataset.driver().short_name();
    let mut keep = |what: &str, result: std::result::Result<(), GdalError>| {
        let said = take_failures();
        if result.is_err() || !said.is_empty() {
            let detail = if said.is_empty() { String::new() } else { format!(": {}", said.join("; ")) };
            notes.push(format!("the format {format} does not keep {what}{detail}"));
        }
    };
    if let Some(wkt) = &record.crs {
        let srs = spatial_ref(wkt, record.epoch);
        keep("the CRS", srs.and_then(|srs| dataset.set_spatial_ref(&srs)));
    }
    if let Some(transform) = &record.transform {
        keep("the geotransform", dataset.set_geo_transform(&transform.0));
    }
    let meaning = if record.is_point { "Point" } else { "Area" };
    let mut items = vec![Item { key: metadata::AREA_OR_POINT.into(), value: meaning.into(), ..Item::default() }];
    // One call a domain: the last one wins.
    items.extend(record.metadata.iter().filter(|item| item.domain.is_empty()).cloned());
    items.extend(record.metadata.iter().filter(|item| !item.domain.is_empty()).cloned());
    keep("the metadata", metadata::write(dataset, &items));
    for (number, band) in (1..).zip(&record.bands) {
        match dataset.rasterband(number) {
            Ok(mut raster) => describe_band(&mut raster, number, band, &mut keep),
            Err(error) => keep(&format!("band {number}"), Err(error)),
        }
    }
    let nodata = |band: &BandRecord| band.nodata;
    let has_one = dataset.driver().short_name() == "GTiff";
    if has_one && record.bands.iter().any(|band| nodata(band) != nodata(&record.bands[0])) {
        notes.push(
            "a GeoTIFF has one nodata value for all bands, and these differ; write them one by one with --band".into(),
        );
    }
}

fn describe_band(
    raster: &mut RasterBand<'_>,
    number: usize,
    band: &BandRecord,
    keep: &mut impl FnMut(&str, std::result::Result<(), GdalError>),
) {
    let of = |what: &str| format!("the {what} of band {number}");
    if let Some(nodata) = band.nodata_value() {
        keep(&of("nodata value"), raster.set_no_data_value(Some(nodata)));
    }
    if let Some(scale) = band.scale {
        keep(&of("scale"), raster.set_scale(scale));
    }
    if let Some(offset) = band.offset {
        keep(&of("offset"), raster.set_offset(offset));
    }
    if !band.unit.is_empty() {
        keep(&of("unit"), set_unit(raster, &band.unit));
    }
    if !band.description.is_empty() {
        keep(&of("description"), raster.set_description(&band.description));
    }
    if !band.metadata.is_empty() {
        keep(&of("metadata"), metadata::write(raster, &band.metadata));
    }
}

fn set_unit(raster: &RasterBand<'_>, unit: &str) -> std::result::Result<(), GdalError> {
    let unit = CString::new(unit)?;
    // SAFETY: the band lives as long as the borrow, and the text is copied.
    let result = unsafe { gdal_sys::GDALSetRasterUnitType(raster.c_rasterband(), unit.as_ptr()) };
    if result > CPLErr::CE_Warning {
        return Err(GdalError::CplError { class: result, number: 0, msg: String::new() });
    }
    Ok(())
}
