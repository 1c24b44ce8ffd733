//! `orograph info`.

use super::container_info;
use super::progress::watched;
use super::report::Reporter;
use super::shared::{CommonOptions, InputOptions};
use super::teaching::{learned_json, learned_text};
use crate::crs::{Crs, CrsKind};
use crate::error::{Error, Result};
use crate::io::raster::{Dem, RasterSource};
use crate::pipeline::amplify::{describe as describe_learned, is_learned};
use crate::pipeline::archive::is_container;
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Tell what a raster is: georeference, size, nodata, units, statistics.
///
/// Of an .oro file: georeference, size, bands and how exact they are, bits a cell, levels, tiles and sections. Of a
/// .learned file: mode, factor, cells, steps and exemplars.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  orograph info fixtures/jacksboro.tif\n  \
                        orograph encode fixtures/jacksboro.tif jacksboro.oro\n  \
                        orograph info jacksboro.oro")]
pub(super) struct Info {
    /// Elevation model: any raster that GDAL reads, or an .oro file; or a .learned file.
    #[arg(value_name = "FILE")]
    input: PathBuf,
    /// Do not read the cells: no statistics.
    #[arg(long)]
    no_statistics: bool,
    #[command(flatten)]
    raster: InputOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

impl Info {
    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        reporter.input(&self.input);
        if is_container(&self.input) {
            if let Some(option) = self.raster.words().first() {
                return Err(Error::usage(format!("{option}: an .oro file is shown as a whole, without statistics")));
            }
            let (result, text) = container_info::describe(&self.input)?;
            reporter.say(&text)?;
            return Ok(result);
        }
        if is_learned(&self.input) {
            if let Some(option) = self.raster.words().first() {
                return Err(Error::usage(format!(
                    "{option}: it is for rasters, and this is what learn --multires keeps"
                )));
            }
            let summary = watched(reporter, |watch, _| describe_learned(&self.input, None, watch))?;
            reporter.say(&format!("what amplify has learned\n{}", learned_text(&summary, None)))?;
            let mut result = json!({ "format": "learned" });
            if let (Value::Object(all), Value::Object(own)) = (&mut result, learned_json(&summary)) {
                all.extend(own);
            }
            return Ok(result);
        }
        let source = RasterSource::open(&self.input, &self.raster.meant()?)?;
        let dem = if self.no_statistics { None } else { Some(watched(reporter, |watch, _| source.read(watch))?) };
        for note in &source.notes {
            reporter.warn(note);
        }
        if let Some(sentinel) = dem.as_ref().and_then(|dem| dem.sentinel) {
            reporter.warn(&sentinel.to_string());
        }
        let result = describe(&source, dem.as_ref());
        reporter.say(&text(&result))?;
        Ok(result)
    }
}

fn describe(source: &RasterSource, dem: Option<&Dem>) -> Value {
    let [_, _, cols, rows] = source.window;
    let corner = |row: f64, col: f64| {
        let (x, y) = source.transform.centre(row - 0.5, col - 0.5);
        json!([x, y])
    };
    let crs = source.crs.as_ref().map(crs_json);
    let e = &source.elevations;
    let statistics = dem.and_then(|dem| dem.extremes).map(|extremes| {
        json!({
            "cells_with_data": extremes.cells,
            "cells_without_data": source.cells() - extremes.cells,
            "least_m": e.elevation_m(extremes.least).min(e.elevation_m(extremes.greatest)),
            "greatest_m": e.elevation_m(extremes.greatest).max(e.elevation_m(extremes.least)),
        })
    });
    json!({
        "format": source.driver,
        "bands": source.bands,
        "band": source.band,
        "cols": cols,
        "rows": rows,
        "block": [source.block.0, source.block.1],
        "type": e.sample_type.name(),
        "scale": e.scale,
        "offset": e.offset,
        "vertical_unit": { "name": e.unit.name, "metres": e.unit.metres },
        "nodata": source.nodata.value.map(|value| if value.is_nan() { json!("nan") } else { json!(value) }),
        "mask_band": source.nodata.mask,
        "crs": crs,
        "georeferenced": source.is_georeferenced,
        "geotransform": source.transform.0,
        "corners": { "upper_left": corner(0.0, 0.0), "lower_right": corner(rows as f64, cols as f64) },
        "columns_wrap": source.wraps,
        "statistics": statistics,
    })
}

/// A CRS for a JSON document.
pub(super) fn crs_json(crs: &Crs) -> Value {
    let (kind, unit) = match &crs.kind {
        CrsKind::Geographic { degrees, .. } => ("geographic", json!({ "degrees": degrees })),
        CrsKind::Projected { metres, .. } => ("projected", json!({ "metres": metres })),
        CrsKind::Local { metres } => ("local", json!({ "metres": metres })),
    };
    let ellipsoid = crs.ellipsoid().map(|e| json!({ "a_m": e.a_m, "flattening": e.flattening }));
    json!({ "name": crs.name, "authority": crs.authority, "kind": kind, "unit": unit, "ellipsoid": ellipsoid })
}

fn text(result: &Value) -> String {
    use std::fmt::Write;
    let mut text = String::new();
    let Value::Object(map) = result else { return text };
    for (key, value) in map {
        let key = key.replace('_', " ");
        match value {
            Value::Object(inner) => {
                let _ = writeln!(text, "{key}:");
                for (name, value) in inner {
                    let _ = writeln!(text, "  {}: {}", name.replace('_', " "), plain(value));
                }
            }
            _ => {
                let _ = writeln!(text, "{key}: {}", plain(value));
            }
        }
    }
    text
}

fn plain(value: &Value) -> String {
    match value {
        Value::Null => "none".into(),
        Value::String(text) => text.clone(),
        Value::Array(items) => items.iter().map(plain).collect::<Vec<_>>().join(", "),
        Value::Bool(yes) => if *yes { "yes" } else { "no" }.into(),
        Value::Object(map) => {
            map.iter().map(|(k, v)| format!("{} {}", k.replace('_', " "), plain(v))).collect::<Vec<_>>().join(", ")
        }
        number => number.to_string(),
    }
}
