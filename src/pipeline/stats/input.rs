//! What an input is: a DEM, a layer of peaks, or a statistics file.

use super::super::archive::open_dem;
use crate::error::{Error, ErrorKind, Result};
use crate::io::features::{LayerSummary, list_layers};
use crate::io::raster::{RasterOptions, RasterSource};
use crate::io::text::read_text;
use crate::orometry::distributions::{STATS_FORMAT, StatsDocument};
use crate::watch::Watch;
use std::path::{Path, PathBuf};

/// An input, opened.
pub(in super::super) enum InputFile {
    /// A raster of elevations.
    Dem(Box<RasterSource>),
    /// A file with a layer of peaks.
    Peaks(PeaksFile),
    /// Statistics, read.
    Document(Box<StatsDocument>),
}

/// A file with a layer of peaks.
pub(in super::super) struct PeaksFile {
    /// The file.
    pub(in super::super) path: PathBuf,
    /// The layer.
    pub(super) layer: LayerSummary,
    /// Unit of its lengths: the end of the names of their fields, and the metres in one.
    pub(super) unit: (&'static str, f64),
}

/// How inputs are read.
pub(in super::super) struct Reading<'a> {
    /// How to read a DEM; its CRS also is that of a layer of peaks without one.
    pub(in super::super) raster: &'a RasterOptions,
    /// Name of the layer of peaks, where there are several.
    pub(in super::super) layer: Option<&'a str>,
    /// Bytes of memory that may be used; what is free unless given.
    pub(in super::super) memory: Option<u64>,
}

/// Extensions of files that hold layers rather than rasters; a GeoPackage may hold either.
const VECTORS: [&str; 10] = ["gpkg", "geojson", "json", "fgb", "csv", "shp", "gml", "kml", "sqlite", "parquet"];

impl InputFile {
    /// Opens an input and looks what it is.
    ///
    /// # Errors
    /// When it is missing, or cannot be read as what it seems to be.
    pub(in super::super) fn open(path: &Path, reading: &Reading<'_>, watch: &Watch) -> Result<Self> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        if extension == "json" {
            let text = read_text(path)?;
            // GeoJSON has this extension too.
            if text.contains(STATS_FORMAT) || !text.contains("\"Feature") {
                let document = StatsDocument::from_json(&text).map_err(|error| error.at_path(path))?;
                return Ok(Self::Document(Box::new(document)));
            }
        }
        let dem = || open_dem(path, reading.raster, reading.memory, watch).map(|source| Self::Dem(Box::new(source)));
        if !VECTORS.contains(&extension.as_str()) {
            return dem();
        }
        let layers = list_layers(path)?;
        if extension == "gpkg" && layers.iter().all(|layer| layer.fields.is_empty()) {
            return dem();
        }
        PeaksFile::choose(path, layers, reading.layer).map(Self::Peaks)
    }
}

/// Whether an input has been measured already.
pub(super) fn is_document(input: &InputFile) -> bool {
    matches!(input, InputFile::Document(_))
}

impl PeaksFile {
    /// Chooses the layer of a file: the one that is named, else `peaks`, else the only one with elevations and
    /// prominences.
    fn choose(path: &Path, layers: Vec<LayerSummary>, wanted: Option<&str>) -> Result<Self> {
        let mut there: Vec<String> = layers.iter().map(|layer| layer.name.clone()).collect();
        if there.is_empty() {
            there.push("none".into());
        }
        let refuse = |message: String| Error::new(ErrorKind::Input, message).at_path(path);
        let named: Vec<LayerSummary> =
            layers.into_iter().filter(|layer| wanted.is_none_or(|wanted| layer.name == wanted)).collect();
        if let (Some(wanted), true) = (wanted, named.is_empty()) {
            return Err(refuse(format!("there is no layer '{wanted}': it has {}", there.join(", "))));
        }
        let mut fit: Vec<(LayerSummary, (&'static str, f64))> =
            named.into_iter().filter_map(|layer| unit_of(&layer).map(|unit| (layer, unit))).collect();
        let position = fit.iter().position(|(layer, _)| layer.name == "peaks");
        let (layer, unit) = match (position, fit.len()) {
            (Some(position), _) => fit.swap_remove(position),
            (None, 1) => fit.remove(0),
            (None, 0) => {
                return Err(refuse(format!(
                    "there is no layer of peaks, with the fields elevation_m and prominence_m (or _ft): it has the layers {}; \
                     make one with orograph peaks",
                    there.join(", ")
                )));
            }
            _ => {
                let names: Vec<&str> = fit.iter().map(|(layer, _)| layer.name.as_str()).collect();
                return Err(refuse(format!(
                    "several layers may hold the peaks: choose one with --layer: {}",
                    names.join(", ")
                )));
            }
        };
        Ok(Self { path: path.to_path_buf(), layer, unit })
    }
}

/// The unit in which a layer has elevations and prominences; `None` where it lacks one of them.
fn unit_of(layer: &LayerSummary) -> Option<(&'static str, f64)> {
    let has = |name: String| layer.fields.contains(&name);
    [("m", 1.0), ("ft", crate::units::FOOT_M)]
        .into_iter()
        .find(|(suffix, _)| has(format!("elevation_{suffix}")) && has(format!("prominence_{suffix}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(name: &str, fields: &[&str]) -> LayerSummary {
        let fields = fields.iter().map(ToString::to_string).collect();
        LayerSummary { name: name.into(), has_geometry: true, features: 1, fields }
    }

    #[test]
    fn the_layer_of_peaks_is_found() {
        let metres = ["prominence_m", "elevation_m"];
        let choose = |layers, wanted| PeaksFile::choose(Path::new("a.gpkg"), layers, wanted);
        let all = vec![
            layer("a", &metres),
            layer("saddles", &["elevation_m"]),
            layer("peaks", &["elevation_ft", "prominence_ft"]),
        ];
        let found = choose(all.clone(), None).unwrap();
        assert_eq!((found.layer.name.as_str(), found.unit), ("peaks", ("ft", 0.3048)));
        assert_eq!(choose(all.clone(), Some("a")).unwrap().unit, ("m", 1.0));
        assert_eq!(choose(all[..2].to_vec(), None).unwrap().layer.name, "a");
        for (layers, wanted, words) in [
            (all.clone(), Some("b"), "no layer 'b': it has a, saddles, peaks"),
            (all[1..2].to_vec(), None, "no layer of peaks"),
            (vec![], None, "it has the layers none"),
            (vec![layer("a", &metres), layer("b", &metres)], None, "--layer: a, b"),
        ] {
            let error = choose(layers, wanted).err().unwrap();
            assert!(error.kind() == ErrorKind::Input && error.to_string().contains(words), "{error}");
        }
    }
}
