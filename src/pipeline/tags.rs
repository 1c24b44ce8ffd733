//! What other layers say of peaks: the region that each stands in, the name of the nearest named point.

use super::layers::{Frame, PeakTags};
use super::metric::Distance;
use super::names::{Ground, Names};
use super::regions::Regions;
use crate::crs::{Crs, CrsKind};
use crate::error::Result;
use crate::io::features::{Layer, Value, read_layer};
use crate::orometry::Peak;
use std::path::{Path, PathBuf};

/// A field of a vector layer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TagLayer {
    /// The dataset.
    pub path: PathBuf,
    /// Name of the layer; may be left out where there is only one.
    pub layer: Option<String>,
    /// Name of the field.
    pub field: String,
}

/// Named points, and how far their names reach.
#[derive(Clone, Debug, PartialEq)]
pub struct NameLayer {
    /// The points.
    pub layer: TagLayer,
    /// Greatest distance in metres between a peak and the point that names it.
    pub distance_m: f64,
}

/// What to tag peaks with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TagOptions {
    /// Polygons whose names are regions.
    pub regions: Option<TagLayer>,
    /// Points whose names are those of peaks.
    pub names: Option<NameLayer>,
}

impl TagLayer {
    /// Reads the layer with its field in the CRS `crs`, and tells what a user should know of that.
    pub(super) fn read(&self, crs: Option<&Crs>, note: &mut dyn FnMut(String)) -> Result<Layer> {
        read_onto(&self.path, self.layer.as_deref(), &[&self.field], crs, note)
    }
}

/// Reads a layer with some fields in the CRS `crs`, and tells what a user should know of that.
pub(super) fn read_onto(
    path: &Path,
    layer: Option<&str>,
    fields: &[&str],
    crs: Option<&Crs>,
    note: &mut dyn FnMut(String),
) -> Result<Layer> {
    let target = crs.filter(|crs| !matches!(crs.kind, CrsKind::Local { .. })).map(|crs| crs.wkt.as_str());
    let layer = read_layer(path, layer, fields, target)?;
    if target.is_none() && layer.crs_wkt.is_some() {
        note(format!(
            "{}: the layer has a CRS and what it tags has none on Earth: coordinates are taken as they are (assign one with --crs)",
            path.display()
        ));
    }
    if layer.unplaced > 0 {
        let features = if layer.unplaced == 1 { "feature has" } else { "features have" };
        note(format!(
            "{}: {} {features} no place in the CRS of what they tag, and are left out",
            path.display(),
            layer.unplaced
        ));
    }
    Ok(layer)
}

/// The text of an attribute; `None` where it is null or blank.
pub(super) fn text_of(value: Option<&Value>) -> Option<String> {
    match value? {
        Value::Null => None,
        Value::Number(number) => Some(number.to_string()),
        Value::Text(text) => (!text.trim().is_empty()).then(|| text.clone()),
    }
}

/// The layers that tag peaks, read and ready.
#[derive(Debug)]
pub struct Tagger {
    regions: Option<Regions>,
    names: Option<Names>,
}

impl Tagger {
    /// Reads the layers into the CRS of a DEM.
    ///
    /// # Errors
    /// When a layer or its field is missing, holds nothing that could tag a peak, or cannot be brought into the CRS.
    pub fn read(options: &TagOptions, crs: Option<&Crs>, note: &mut dyn FnMut(String)) -> Result<Self> {
        let regions = options.regions.as_ref().map(|layer| Regions::read(layer, crs, note)).transpose()?;
        let names = options.names.as_ref().map(|layer| Names::read(layer, crs, note)).transpose()?;
        Ok(Self { regions, names })
    }

    /// The tags of the peaks, one each; none at all where there are no layers.
    pub fn tag(
        &self,
        peaks: &[Peak],
        frame: &Frame<'_>,
        distance: Distance,
        note: &mut dyn FnMut(String),
    ) -> Vec<PeakTags> {
        if self.regions.is_none() && self.names.is_none() {
            return Vec::new();
        }
        let mut tags = vec![PeakTags::default(); peaks.len()];
        let points: Vec<(f64, f64)> = peaks.iter().map(|peak| frame.point(peak.cell)).collect();
        if let Some(regions) = &self.regions {
            let found = regions.tag(&points, &|i| format!("peak {}", peaks[i].id), note);
            tags.iter_mut().zip(found).for_each(|(tags, region)| tags.region = region.map(str::to_string));
        }
        if let Some(names) = &self.names {
            let found = names.assign(&points, &Ground::of(frame, distance), note);
            tags.iter_mut().zip(found).for_each(|(tags, name)| tags.name = name.map(str::to_string));
        }
        tags
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_attributes() {
        assert_eq!(text_of(Some(&Value::Number(7.0))).as_deref(), Some("7"));
        assert_eq!(text_of(Some(&Value::Text("Ela".into()))).as_deref(), Some("Ela"));
        assert_eq!(
            (text_of(Some(&Value::Text(" \t".into()))), text_of(Some(&Value::Null)), text_of(None)),
            (None, None, None)
        );
    }
}
