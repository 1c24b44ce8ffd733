//! CRSs as text, with the epoch that their text does not hold; ground control points.
#![allow(
    unsafe_code,
    reason = "the safe bindings know no coordinate epochs, and write the WKT that GDAL is configured for"
)]

use crate::error::{Error, ErrorKind, Result};
use crate::io::messages::take_failures;
use gdal::Dataset;
use gdal::errors::GdalError;
use gdal::spatial_ref::{AxisMappingStrategy, SpatialRef};
use std::ffi::CStr;
use std::ptr;

/// The CRS as WKT2:2019 on one line.
pub(super) fn wkt_of(srs: &SpatialRef) -> Result<String> {
    let options = [c"FORMAT=WKT2_2019".as_ptr(), c"MULTILINE=NO".as_ptr(), ptr::null()];
    let mut text = ptr::null_mut();
    // SAFETY: the options end with a null pointer, and GDAL writes one pointer.
    let result = unsafe { gdal_sys::OSRExportToWktEx(srs.to_c_hsrs(), &raw mut text, options.as_ptr()) };
    let wkt = if text.is_null() {
        String::new()
    } else {
        // SAFETY: GDAL has made a text that ends with a zero byte, and it is freed once.
        unsafe {
            let wkt = CStr::from_ptr(text).to_string_lossy().into_owned();
            gdal_sys::VSIFree(text.cast());
            wkt
        }
    };
    if result != gdal_sys::OGRErr::OGRERR_NONE || wkt.is_empty() {
        let message =
            format!("the CRS cannot be written as WKT2; assign one with --crs. {}", take_failures().join("; "));
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    Ok(wkt)
}

/// Epoch of the coordinates as a decimal year, where the CRS has one.
pub(super) fn epoch_of(srs: &SpatialRef) -> Option<f64> {
    // SAFETY: the CRS lives as long as the borrow.
    let epoch = unsafe { gdal_sys::OSRGetCoordinateEpoch(srs.to_c_hsrs()) };
    // 0 stands for none.
    (epoch != 0.0 && epoch.is_finite()).then_some(epoch)
}

/// The CRS of a text and an epoch, for coordinates in the order x, y.
pub(super) fn spatial_ref(wkt: &str, epoch: Option<f64>) -> std::result::Result<SpatialRef, GdalError> {
    let mut srs = SpatialRef::from_wkt(wkt)?;
    srs.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
    if let Some(epoch) = epoch {
        // SAFETY: the CRS lives as long as the borrow.
        unsafe { gdal_sys::OSRSetCoordinateEpoch(srs.to_c_hsrs(), epoch) };
    }
    Ok(srs)
}

/// Number of the points that place a raster without a geotransform.
pub(super) fn ground_control_points(dataset: &Dataset) -> usize {
    // SAFETY: the dataset lives as long as the borrow.
    let count = unsafe { gdal_sys::GDALGetGCPCount(dataset.c_dataset()) };
    usize::try_from(count).unwrap_or_default()
}
