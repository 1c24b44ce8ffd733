//! Where scenes get rasters, lines and sparse terrains from.

use crate::dictionary::SparseTerrain;
use crate::error::Result;
use crate::grid::{GeoTransform, Heights};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A raster that a scene asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RasterQuery<'a> {
    /// The path as the file has it.
    pub path: &'a str,
    /// Number of the band, from 1.
    pub band: usize,
    /// Whether it lies where its georeference says: then in the scene's CRS, otherwise anywhere, cell for cell.
    pub is_placed: bool,
    /// The part that is wanted: least x and y, greatest x and y in the scene's CRS. More may be given.
    pub crop: Option<[f64; 4]>,
}

/// Lines that a scene asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineQuery<'a> {
    /// The path as the file has it.
    pub path: &'a str,
    /// The layer; the only one unless given.
    pub layer: Option<&'a str>,
    /// Condition on the fields, as `WHERE` of SQL has it.
    pub filter: Option<&'a str>,
}

/// A line of a vector layer, in the scene's CRS.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// Points `[x, y, z]` in metres; z is NaN where the layer has none.
    pub points: Vec<[f64; 3]>,
    /// Numeric fields by name.
    pub fields: BTreeMap<String, f64>,
}

/// Opens what a scene names. Paths are as the file has them; whoever implements this takes them relative to it.
pub trait Sources {
    /// Heights in metres of a raster's band, with its georeference, if it has one; in the scene's CRS if it is placed.
    ///
    /// # Errors
    /// Where the file is missing or no raster.
    fn heights(&self, query: &RasterQuery<'_>) -> Result<Arc<dyn Heights>>;

    /// Weights of the cells of `heights`, which `query` had asked for but for its path and band: of a raster that is
    /// placed at the places of these cells, of others cell for cell.
    ///
    /// # Errors
    /// Where the file is missing or no raster.
    fn weights(&self, query: &RasterQuery<'_>, heights: &dyn Heights) -> Result<Arc<dyn Heights>>;

    /// Lines in the scene's CRS.
    ///
    /// # Errors
    /// Where the file is missing or has no such layer.
    fn lines(&self, query: &LineQuery<'_>) -> Result<Vec<Line>>;

    /// A terrain of sparse primitives, and where its cells lie in the scene's CRS.
    ///
    /// # Errors
    /// Where the file is missing or holds no such terrain.
    fn sparse(&self, path: &str) -> Result<SparseSource>;
}

/// A terrain of sparse primitives from a file.
#[derive(Clone, Debug)]
pub struct SparseSource {
    /// The terrain, in the file's own values.
    pub terrain: SparseTerrain,
    /// From its columns and rows to the scene's CRS.
    pub places: GeoTransform,
    /// Metres are the file's values times this,
    pub scale_m: f64,
    /// plus this.
    pub offset_m: f64,
}
