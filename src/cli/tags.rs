//! Options of verbs that look at polygons and named points.

use super::wrong_value;
use crate::error::{Error, Result};
use crate::pipeline::{NameLayer, TagLayer};
use crate::units::parse_length_m;
use clap::Args;
use std::path::PathBuf;

/// Options of verbs that tell regions apart.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Regions")]
pub(super) struct RegionOptions {
    /// Polygons whose names are regions: any vector layer that GDAL reads.
    #[arg(long, value_name = "FILE")]
    regions: Option<PathBuf>,
    /// Field that names the regions.
    #[arg(long, value_name = "FIELD", default_value = "name", requires = "regions")]
    region_field: String,
    /// Layer of the polygons, where the file has several.
    #[arg(long, value_name = "LAYER", requires = "regions")]
    region_layer: Option<String>,
}

impl RegionOptions {
    /// What the options mean.
    pub(super) fn meant(&self) -> Option<TagLayer> {
        tag_layer(self.regions.as_ref(), self.region_layer.as_ref(), &self.region_field)
    }

    /// The options as words of a command, those that were given.
    pub(super) fn words(&self) -> Vec<String> {
        self.meant().map_or(vec![], |layer| words("--regions", "--region", &layer))
    }
}

/// Options of verbs that name peaks.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Names")]
pub(super) struct NameOptions {
    /// Points that give their names to the nearest peaks: any vector layer that GDAL reads.
    #[arg(long, value_name = "FILE")]
    names: Option<PathBuf>,
    /// Field that holds the names.
    #[arg(long, value_name = "FIELD", default_value = "name", requires = "names")]
    name_field: String,
    /// Layer of the points, where the file has several.
    #[arg(long, value_name = "LAYER", requires = "names")]
    name_layer: Option<String>,
    /// Greatest distance between a peak and the point that names it.
    #[arg(long, value_name = "LENGTH", default_value = "300m", requires = "names", allow_hyphen_values = true)]
    name_distance: String,
}

impl NameOptions {
    /// What the options mean.
    pub(super) fn meant(&self) -> Result<Option<NameLayer>> {
        let Some(layer) = tag_layer(self.names.as_ref(), self.name_layer.as_ref(), &self.name_field) else {
            return Ok(None);
        };
        let distance_m = parse_length_m(&self.name_distance).map_err(|error| wrong_value("--name-distance", &error))?;
        if distance_m < 0.0 {
            return Err(Error::usage(format!("--name-distance {}: expected 0 or more", self.name_distance)));
        }
        Ok(Some(NameLayer { layer, distance_m }))
    }

    /// The options as words of a command, those that were given.
    pub(super) fn words(&self) -> Vec<String> {
        let Some(layer) = tag_layer(self.names.as_ref(), self.name_layer.as_ref(), &self.name_field) else {
            return vec![];
        };
        let mut words = words("--names", "--name", &layer);
        words.extend(["--name-distance".into(), self.name_distance.clone()]);
        words
    }
}

fn tag_layer(path: Option<&PathBuf>, layer: Option<&String>, field: &str) -> Option<TagLayer> {
    path.map(|path| TagLayer { path: path.clone(), layer: layer.cloned(), field: field.to_string() })
}

fn words(option: &str, stem: &str, layer: &TagLayer) -> Vec<String> {
    let mut words = vec![option.to_string(), layer.path.display().to_string()];
    words.extend([format!("{stem}-field"), layer.field.clone()]);
    if let Some(name) = &layer.layer {
        words.extend([format!("{stem}-layer"), name.clone()]);
    }
    words
}
