//! Options of verbs that raise terrain on a divide tree.

use super::shared::creation_option;
use super::wrong_value;
use crate::error::{Error, Result};
use crate::pipeline::terrain::{RasterOutput, TerrainShape};
use crate::units::parse_length_m;
use clap::Args;
use std::path::{Path, PathBuf};

/// How terrain is shaped, and what its file is like.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Terrain")]
pub(super) struct ShapeOptions {
    /// Raster of how high the land is in the mean, over all of it: any coarse DEM.
    #[arg(long, value_name = "RASTER")]
    ground_map: Option<PathBuf>,
    /// Elevation of the plains where there is no --ground-map; that of the lowest saddle unless given.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true, conflicts_with = "ground_map")]
    floor: Option<String>,
    /// Slope of the ground below the ridges, rise over run; 0.5, or as steep as a DEM of --like, unless given.
    #[arg(long, value_name = "SLOPE")]
    slope: Option<f64>,
    /// Slope of the detail between ridges and valleys, rise over run, 0 for none; 0.2, or as a DEM of --like has it with
    /// --slope left out, unless given.
    #[arg(long, value_name = "SLOPE")]
    roughness: Option<f64>,
    /// How much the slope between ridges and valleys changes per metre, 0 for none: small hills grow round; 0.0005, or as a
    /// DEM of --like has it with --slope left out, unless given.
    #[arg(long, value_name = "1/M")]
    curvature: Option<f64>,
    /// How much rivers wear the ground down between ridges and valley floors, up to 10: 0.2 for furrows, 1 for gullies;
    /// not at all unless given.
    #[arg(long, value_name = "STRENGTH")]
    erosion: Option<f64>,
    /// GDAL's name of the terrain's format; after the extension unless given.
    #[arg(long = "of", value_name = "FORMAT")]
    format: Option<String>,
    /// Option of the terrain's format; may be given several times.
    #[arg(long = "co", value_name = "KEY=VALUE")]
    options: Vec<String>,
}

/// The side of cells in metres that `--resolution` says.
pub(super) fn resolution_m(text: &str) -> Result<f64> {
    let resolution_m = parse_length_m(text).map_err(|error| wrong_value("--resolution", &error))?;
    if resolution_m.is_nan() || resolution_m <= 0.0 {
        return Err(Error::usage(format!("--resolution {text}: expected more than 0")));
    }
    Ok(resolution_m)
}

impl ShapeOptions {
    /// Whether anything is said of terrain.
    pub(super) fn is_given(&self) -> bool {
        self.ground_map.is_some()
            || self.floor.is_some()
            || self.slope.is_some()
            || self.roughness.is_some()
            || self.curvature.is_some()
            || self.erosion.is_some()
            || self.format.is_some()
            || !self.options.is_empty()
    }

    /// The raster that is to be written.
    pub(super) fn output(&self, path: &Path, overwrite: bool) -> Result<RasterOutput> {
        Ok(RasterOutput {
            path: path.to_path_buf(),
            overwrite,
            format: self.format.clone(),
            options: self.options.iter().map(creation_option).collect::<Result<_>>()?,
        })
    }

    /// How terrain is shaped.
    pub(super) fn shape(&self, seed: u64) -> Result<TerrainShape> {
        let floor = self.floor.as_deref();
        if let Some(slope) = self.slope.filter(|slope| !(*slope > 0.0 && *slope <= 10.0)) {
            return Err(Error::usage(format!("--slope {slope}: expected a rise over a run between 0 and 10")));
        }
        if let Some(roughness) = self.roughness.filter(|roughness| !(0.0..=1.0).contains(roughness)) {
            return Err(Error::usage(format!("--roughness {roughness}: expected a rise over a run from 0 to 1")));
        }
        if let Some(curvature) = self.curvature.filter(|curvature| !(0.0..=0.1).contains(curvature)) {
            return Err(Error::usage(format!("--curvature {curvature}: expected a slope per metre from 0 to 0.1")));
        }
        if let Some(erosion) = self.erosion.filter(|erosion| !(0.0..=10.0).contains(erosion)) {
            return Err(Error::usage(format!("--erosion {erosion}: expected a strength from 0 to 10")));
        }
        Ok(TerrainShape {
            ground_map: self.ground_map.clone(),
            floor_m: floor.map(|text| parse_length_m(text).map_err(|e| wrong_value("--floor", &e))).transpose()?,
            slope: self.slope,
            roughness: self.roughness,
            curvature: self.curvature,
            erosion: self.erosion,
            seed,
        })
    }

    /// The options as words of a command, those that change results.
    pub(super) fn words(&self) -> Vec<String> {
        let mut words = vec![];
        let mut put = |option: &str, value: Option<String>| {
            words.extend(value.into_iter().flat_map(|value| [option.to_string(), value]));
        };
        put("--ground-map", self.ground_map.as_ref().map(|path| path.display().to_string()));
        put("--floor", self.floor.clone());
        put("--slope", self.slope.map(|slope| slope.to_string()));
        put("--roughness", self.roughness.map(|roughness| roughness.to_string()));
        put("--curvature", self.curvature.map(|curvature| curvature.to_string()));
        put("--erosion", self.erosion.map(|erosion| erosion.to_string()));
        words
    }
}
