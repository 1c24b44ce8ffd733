//! Formats by extension, and the files that a set of layers becomes.

use super::table::Table;
use super::{csv, ogr};
use crate::crs::Crs;
use crate::error::{Error, Result};
use crate::io::output::Output;
use crate::watch::Watch;
use std::path::{Path, PathBuf};

/// A vector format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// One file with all layers, their styles and metadata.
    GeoPackage,
    /// One file a layer; lines as WKT.
    Csv,
    /// One file a layer.
    GeoJson,
    /// One file a layer.
    FlatGeobuf,
}

impl Format {
    /// The format that a file's extension stands for.
    ///
    /// # Errors
    /// A usage error that names the known extensions.
    pub fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        match extension.as_str() {
            "gpkg" => Ok(Self::GeoPackage),
            "csv" => Ok(Self::Csv),
            "geojson" | "json" => Ok(Self::GeoJson),
            "fgb" => Ok(Self::FlatGeobuf),
            _ => Err(Error::usage(format!(
                "the extension '{extension}' is not that of a vector format that is written here: expected .gpkg, .csv, .geojson or .fgb"
            ))
            .at_path(path)),
        }
    }
}

/// The files that some layers will be written to; all of them appear at once when they are finished.
pub struct Writer {
    format: Format,
    outputs: Vec<Output>,
}

impl Writer {
    /// Prepares to write layers of the given names: one file for all, or one each (`OUT_LAYER.csv`; `OUT.csv` when
    /// there is one layer).
    ///
    /// # Errors
    /// An unknown extension, or outputs that exist already or cannot be written.
    pub fn begin(target: &Path, layers: &[&str], overwrite: bool) -> Result<Self> {
        let format = Format::of(target)?;
        let targets = match (format, layers) {
            (Format::GeoPackage, _) | (_, [_]) => vec![target.to_path_buf()],
            _ => layers.iter().map(|layer| named(target, layer)).collect(),
        };
        let outputs = targets.iter().map(|target| Output::begin(target, overwrite)).collect::<Result<_>>()?;
        Ok(Self { format, outputs })
    }

    /// The files that will be there.
    pub fn targets(&self) -> Vec<PathBuf> {
        self.outputs.iter().map(|output| output.target().to_path_buf()).collect()
    }

    /// Writes the layers, in the order of the names given before, and puts the files in their places.
    ///
    /// `metadata` goes into formats that have room for it.
    ///
    /// # Errors
    /// A full disk or another failure to write, or an interrupt; then no file is changed.
    pub fn write(
        self,
        layers: &[&dyn Table],
        crs: Option<&Crs>,
        metadata: &[(String, String)],
        watch: &Watch,
    ) -> Result<()> {
        watch.begin("writing", layers.iter().map(|layer| layer.rows() as u64).sum());
        match self.format {
            Format::GeoPackage => ogr::write(&self.outputs[0], "GPKG", layers, crs, metadata, watch)?,
            Format::Csv => {
                for (output, layer) in self.outputs.iter().zip(layers) {
                    csv::write(output, *layer, watch)?;
                }
            }
            Format::GeoJson | Format::FlatGeobuf => {
                let driver = if self.format == Format::GeoJson { "GeoJSON" } else { "FlatGeobuf" };
                for (output, layer) in self.outputs.iter().zip(layers) {
                    ogr::write(output, driver, &[*layer], crs, metadata, watch)?;
                }
            }
        }
        self.outputs.into_iter().try_for_each(Output::finish)
    }
}

/// `OUT_LAYER.ext` for `OUT.ext`.
fn named(target: &Path, layer: &str) -> PathBuf {
    let stem = target.file_stem().unwrap_or_default().to_string_lossy();
    let extension = target.extension().unwrap_or_default().to_string_lossy();
    target.with_file_name(format!("{stem}_{layer}.{extension}"))
}
