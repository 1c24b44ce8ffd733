//! `orograph info` of an .oro container.

use super::container_text::{band_lines, bands_json, number, size_text};
use super::info::crs_json;
use super::sparse::{dictionary_json, dictionary_lines};
use crate::error::Result;
use crate::io::raster::parse_crs;
use crate::io::raster::stored::Item;
use crate::oro::CellMeaning;
use crate::pipeline::archive::{ContainerOptions, ContainerSource};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

/// What a container is: nothing of its tiles is read.
pub(super) fn describe(path: &Path) -> Result<(Value, String)> {
    let source = ContainerSource::open(path, &ContainerOptions::default())?;
    let (reader, description) = (source.reader(), source.description());
    let tiling = description.tiling();
    let cells = description.width as f64 * description.height as f64 * description.bands.len() as f64;
    let place = &description.georeference;
    // A CRS that PROJ does not know is shown as it is.
    let crs =
        place.crs.as_deref().map(|wkt| parse_crs(wkt).map_or_else(|_| json!({ "wkt": wkt }), |crs| crs_json(&crs)));
    let corner = |row: f64, col: f64| {
        place.transform.map(|t| {
            let (x, y) = t.centre(row - 0.5, col - 0.5);
            json!([number(x), number(y)])
        })
    };
    let last = description.last_level();
    let levels: Vec<Value> = (0..=last)
        .map(|level| {
            let (cols, rows) = description.level_size(level);
            json!({
                "level": level,
                "cols": cols,
                "rows": rows,
                "geotransform": description.level_transform(level).map(|t| t.0.map(number)),
            })
        })
        .collect();
    let sections: Vec<Value> = reader
        .sections()
        .iter()
        .map(|section| json!({ "name": section.section.name(), "offset": section.offset, "bytes": section.length }))
        .collect();
    let items = |items: &[Item]| -> Vec<Value> {
        let item = |item: &Item| json!({ "domain": item.domain, "key": item.key, "value": item.value });
        items.iter().map(item).collect()
    };
    let mut bands = bands_json(description, None);
    for (band, record) in bands.iter_mut().zip(&source.record.bands) {
        band["metadata"] = json!(items(&record.metadata));
    }
    let hash: String = reader.hash().iter().map(|byte| format!("{byte:02x}")).collect();
    let mut result = json!({
        "format": "oro",
        "format_version": reader.version(),
        "bytes": reader.file_length(),
        "cols": description.width,
        "rows": description.height,
        "bits_per_cell": reader.file_length() as f64 * 8.0 / cells,
        "bands": bands,
        "crs": crs,
        "epoch": place.epoch,
        "geotransform": place.transform.map(|t| t.0.map(number)),
        "corners": {
            "upper_left": corner(0.0, 0.0),
            "lower_right": corner(description.height as f64, description.width as f64),
        },
        "cells_are": if place.cells_are == CellMeaning::Point { "points" } else { "areas" },
        "metadata": items(&source.record.metadata),
        "tile_size": description.tile_side,
        "tiles": { "across": tiling.across(), "down": tiling.down() },
        "levels": levels,
        "cell_bytes": reader.chunk_bytes(),
        "segment_bytes": reader.segment_bytes(),
        "sections": sections,
        "hash": hash,
    });
    if let Some(dictionary) = reader.dictionary() {
        result["dictionary"] = dictionary_json(description, dictionary);
    }
    let text = text(&result, &source);
    Ok((result, text))
}

fn text(result: &Value, source: &ContainerSource) -> String {
    let (reader, description) = (source.reader(), source.description());
    let tiling = description.tiling();
    let mut text = String::new();
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "{name}: {value}");
    };
    let bits = result["bits_per_cell"].as_f64().unwrap_or_default();
    line("format", format!("oro, version {}", reader.version()));
    let bands = description.bands.len();
    let several = if bands > 1 { format!(" in {bands} bands") } else { String::new() };
    line("size", format!("{} x {} cells{several}", description.width, description.height));
    line("bytes", format!("{}, {bits:.3} bits a cell", size_text(reader.file_length())));
    line("tiles", format!("{} x {} of {} x {2} cells", tiling.across(), tiling.down(), description.tile_side));
    let levels: Vec<String> = (0..=description.last_level())
        .map(|level| description.level_size(level))
        .map(|(cols, rows)| format!("{cols} x {rows}"))
        .collect();
    line("levels", levels.join(", "));
    for band in band_lines(description, None).lines() {
        match band.split_once(": ") {
            Some((name, rest)) => line(name, rest.to_string()),
            None => line("band", band.to_string()),
        }
    }
    for found in
        reader.dictionary().map(|found| dictionary_lines(description, found)).iter().flat_map(|text| text.lines())
    {
        if let Some((name, rest)) = found.split_once(": ") {
            line(name, rest.to_string());
        }
    }
    for (number, band) in (1..).zip(&description.bands) {
        let mut words = Vec::new();
        words.extend((!band.description.is_empty()).then(|| band.description.clone()));
        words.extend((!band.unit.is_empty()).then(|| format!("in {}", band.unit)));
        words.extend(band.scale.map(|scale| format!("scale {scale}")));
        words.extend(band.offset.map(|offset| format!("offset {offset}")));
        if !words.is_empty() {
            line(&format!("values of band {number}"), words.join(", "));
        }
    }
    let crs = &result["crs"];
    let name = ["authority", "name", "wkt"].iter().find_map(|key| crs[key].as_str()).unwrap_or("none");
    line("crs", name.to_string());
    if let Some(epoch) = description.georeference.epoch {
        line("epoch", epoch.to_string());
    }
    match &description.georeference.transform {
        Some(transform) => line("geotransform", transform.0.map(|v| v.to_string()).join(", ")),
        None => line("geotransform", "none".into()),
    }
    line("cells are", result["cells_are"].as_str().unwrap_or_default().to_string());
    for item in &source.record.metadata {
        let domain = if item.domain.is_empty() { String::new() } else { format!("{} ", item.domain) };
        line("metadata", format!("{domain}{}={}", item.key, item.value));
    }
    let segments = reader.segment_bytes().map(|bytes| bytes.to_string()).join(" + ");
    line("cell bytes", format!("{}, coarse to fine {segments}", reader.chunk_bytes()));
    for section in reader.sections() {
        line("section", format!("{}, {} bytes at {}", section.section.name(), section.length, section.offset));
    }
    text
}
