//! Where scenes get rasters and lines from.

use crate::error::Result;
use crate::grid::Heights;
use std::collections::BTreeMap;
use std::sync::Arc;

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
    /// Heights in metres of a raster's band (counted from 1), with its georeference in the scene's CRS.
    ///
    /// # Errors
    /// Where the file is missing or no raster.
    fn heights(&self, path: &str, band: usize) -> Result<Arc<dyn Heights>>;

    /// Lines of a layer, of the only one without a name, in the scene's CRS.
    ///
    /// # Errors
    /// Where the file is missing or has no such layer.
    fn lines(&self, path: &str, layer: Option<&str>) -> Result<Vec<Line>>;
}
