//! Metadata of a file, without what describes the file and not the raster.
#![allow(unsafe_code, reason = "the safe bindings set metadata item by item, and cannot set a domain that is one text")]

use super::record::Item;
use gdal::Metadata;
use gdal::cpl::CslStringList;
use gdal::errors::{GdalError, Result};
use gdal_sys::CPLErr;
use std::ffi::CString;

/// The item that says what a cell's value stands for; a [`super::Record`] has a field for it.
pub(super) const AREA_OR_POINT: &str = "AREA_OR_POINT";

/// Domains that say how a file is laid out, or that GDAL makes up.
const LAYOUT: [&str; 4] = ["IMAGE_STRUCTURE", "DERIVED_SUBDATASETS", "SUBDATASETS", "COLOR_PROFILE"];

/// Domains that tie columns and rows to places: untrue of a part of the raster.
const PLACES: [&str; 2] = ["RPC", "GEOLOCATION"];

/// The metadata of a dataset or a band. Statistics are left out: they need not be true of what is made of it.
pub(super) fn read(object: &impl Metadata) -> Vec<Item> {
    let mut items = Vec::new();
    let mut seen: Vec<String> = Vec::new();
    for domain in object.metadata_domains() {
        if LAYOUT.contains(&domain.as_str()) || seen.contains(&domain) {
            continue;
        }
        for text in object.metadata_domain(&domain).unwrap_or_default() {
            // A domain such as xml:XMP is one text.
            let is_text = domain.starts_with("xml:") || domain.starts_with("json:");
            let (key, value) = match text.split_once('=').filter(|_| !is_text) {
                Some((key, value)) => (key.to_string(), value.to_string()),
                None => (String::new(), text),
            };
            let is_untold = domain.is_empty() && (key.starts_with("STATISTICS_") || key == AREA_OR_POINT);
            if !is_untold {
                items.push(Item { domain: domain.clone(), key, value });
            }
        }
        seen.push(domain);
    }
    items
}

/// Removes what is untrue of a part of the raster; returns whether there was any.
pub(super) fn drop_places(items: &mut Vec<Item>) -> bool {
    let before = items.len();
    items.retain(|item| !PLACES.contains(&item.domain.as_str()));
    items.len() < before
}

/// Sets metadata; items of one domain stand together.
pub(super) fn write(object: &impl Metadata, items: &[Item]) -> Result<()> {
    for items in items.chunk_by(|a, b| a.domain == b.domain) {
        let mut texts = CslStringList::new();
        for Item { key, value, .. } in items {
            texts.add_string(&if key.is_empty() { value.clone() } else { format!("{key}={value}") })?;
        }
        let domain = CString::new(items[0].domain.as_str())?;
        // SAFETY: the object, the list and the text outlive the call, which copies what it is given.
        let result = unsafe { gdal_sys::GDALSetMetadata(object.gdal_object_ptr(), texts.as_ptr(), domain.as_ptr()) };
        // A warning says that the format keeps it beside the file.
        if result > CPLErr::CE_Warning {
            return Err(GdalError::CplError { class: result, number: 0, msg: String::new() });
        }
    }
    Ok(())
}
