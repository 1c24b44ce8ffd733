//! Terrain written as a raster.

use super::super::land::Land;
use crate::erosion::Relief;
use crate::error::Result;
use crate::grid::SampleType;
use crate::io::raster::stored::{BandRecord, Format, Item, Record, StoredTarget};
use crate::watch::Watch;
use std::path::{Path, PathBuf};

/// Rows that are written at once: as high as the blocks of the files.
const ROWS: usize = 256;

/// A raster file to be written.
#[derive(Clone, Debug)]
pub struct RasterOutput {
    /// The file.
    pub path: PathBuf,
    /// Whether an existing one may be replaced.
    pub overwrite: bool,
    /// GDAL's name of the format; after the file's extension unless given.
    pub format: Option<String>,
    /// Options of the format, key and value.
    pub options: Vec<(String, String)>,
}

/// A raster file on its way.
pub(in super::super) struct TerrainTarget {
    target: StoredTarget,
    /// GDAL's name of its format.
    pub(in super::super) format: String,
}

impl TerrainTarget {
    /// Begins a file for the terrain of some land; `items` are its metadata.
    ///
    /// # Errors
    /// An output that exists, cannot be written to, or has a format that cannot hold elevations.
    pub(in super::super) fn begin(output: &RasterOutput, land: &Land, items: &[(String, String)]) -> Result<Self> {
        let format = Format::of(&output.path, output.format.as_deref())?;
        let item = |(key, value): &(String, String)| Item { key: key.clone(), value: value.clone(), ..Item::default() };
        let band = BandRecord {
            nodata: Some(u64::from(NODATA.to_bits())),
            unit: "m".into(),
            description: "elevation".into(),
            ..BandRecord::new(SampleType::F32)
        };
        let record = Record {
            width: land.cols,
            height: land.rows,
            bands: vec![band],
            transform: Some(land.transform),
            crs: land.crs.as_ref().map(|crs| crs.wkt.clone()),
            metadata: items.iter().map(item).collect(),
            ..Record::default()
        };
        let target = StoredTarget::begin(&output.path, output.overwrite, &format, &output.options, &record)?;
        Ok(Self { target, format: format.name })
    }

    /// Writes the terrain and finishes the file; returns the files.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(in super::super) fn write(
        mut self,
        relief: Relief,
        watch: &Watch,
        warn: &mut dyn FnMut(&str),
    ) -> Result<Vec<PathBuf>> {
        let (rows, cols) = (relief.rows(), relief.cols());
        watch.begin("writing terrain", rows as u64);
        let mut z_m = relief.into_z_m();
        for (strip, cells) in z_m.chunks_mut(ROWS * cols).enumerate() {
            let height = cells.len() / cols;
            self.target.write(0, [0, strip * ROWS, cols, height], cells)?;
            watch.advance(height as u64)?;
        }
        self.target.notes.iter().for_each(|note| warn(note));
        let (outputs, notes) = self.target.finish()?;
        notes.iter().for_each(|note| warn(note));
        Ok(outputs)
    }
}

/// What cells without terrain hold; there are none.
const NODATA: f32 = -9999.0;

/// Whether a name is that of a raster rather than of layers.
pub fn is_raster(path: &Path) -> bool {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    !["gpkg", "geojson", "json", "fgb", "csv", "shp"].contains(&extension.as_str())
}
