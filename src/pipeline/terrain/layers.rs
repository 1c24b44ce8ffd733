//! A divide tree read from the layers that `orograph peaks` writes.

use super::drawn::{DrawnLine, DrawnSpot, DrawnTree};
use crate::error::{Error, ErrorKind, Result};
use crate::io::features::{Feature, Layer, list_layers, read_layer};
use crate::io::raster::parse_crs;
use crate::units::FOOT_M;
use geo::Geometry;
use std::path::Path;

/// Reads the layers `peaks`, `saddles` and `divide_tree`, in their own CRS or in that of `target_wkt`.
///
/// # Errors
/// A file without them, points without an elevation, lines that are none.
pub(super) fn read_layers(path: &Path, target_wkt: Option<&str>) -> Result<DrawnTree> {
    let refuse = |message: String| Error::new(ErrorKind::Input, message).at_path(path);
    let there = list_layers(path)?;
    let names: Vec<&str> = there.iter().map(|layer| layer.name.as_str()).collect();
    if let Some(missing) = ["peaks", "saddles", "divide_tree"].into_iter().find(|name| !names.contains(name)) {
        let names = if names.is_empty() { "none".to_string() } else { names.join(", ") };
        return Err(refuse(format!(
            "there is no layer '{missing}' (it has {names}): expected the layers that orograph peaks writes into a .gpkg"
        )));
    }
    let spots = |name: &str| -> Result<(Layer, Vec<DrawnSpot>)> {
        let fields =
            &there.iter().find(|layer| layer.name == name).map(|layer| layer.fields.clone()).unwrap_or_default();
        let units = [("elevation_m", 1.0), ("elevation_ft", FOOT_M)];
        let Some((field, metres)) = units.into_iter().find(|(field, _)| fields.iter().any(|own| own == field)) else {
            return Err(refuse(format!("layer {name} has neither elevation_m nor elevation_ft")));
        };
        let layer = read_layer(path, Some(name), &[field], target_wkt)?;
        let kind = name.trim_end_matches('s');
        let spot = |(number, feature): (usize, &Feature)| -> Result<DrawnSpot> {
            let name = named(kind, feature, number);
            let Some(Geometry::Point(point)) = &feature.geometry else {
                return Err(refuse(format!("{name} is no point")));
            };
            let Some(elevation) = feature.values[0].number().filter(|elevation| elevation.is_finite()) else {
                return Err(refuse(format!("{name} has no elevation: fill in {field}")));
            };
            Ok(DrawnSpot { at: point.x_y(), elevation_m: elevation * metres, name })
        };
        let spots = layer.features.iter().enumerate().map(spot).collect::<Result<Vec<_>>>()?;
        Ok((layer, spots))
    };
    let (layer, peaks) = spots("peaks")?;
    let wkt = layer.crs_wkt;
    let (layer, saddles) = spots("saddles")?;
    let lines = read_layer(path, Some("divide_tree"), &[], target_wkt)?;
    if layer.crs_wkt != wkt || lines.crs_wkt != wkt {
        return Err(refuse("its layers are in different CRSs".into()));
    }
    let line = |(number, feature): (usize, &Feature)| -> Result<DrawnLine> {
        let name = named("line", feature, number);
        let points: Vec<(f64, f64)> = match &feature.geometry {
            Some(Geometry::LineString(line)) => line.coords().map(|at| (at.x, at.y)).collect(),
            Some(Geometry::MultiLineString(lines)) => {
                lines.iter().flat_map(|line| line.coords()).map(|at| (at.x, at.y)).collect()
            }
            _ => vec![],
        };
        if points.len() < 2 {
            return Err(refuse(format!("{name} of layer divide_tree is no line")));
        }
        Ok(DrawnLine { points, name })
    };
    let lines = lines.features.iter().enumerate().map(line).collect::<Result<Vec<_>>>()?;
    Ok(DrawnTree { crs: wkt.as_deref().map(parse_crs).transpose()?, peaks, saddles, lines })
}

/// A feature's name for people: by its id where it has one, else by its place in the layer.
fn named(kind: &str, feature: &Feature, number: usize) -> String {
    feature.fid.map_or_else(|| format!("{kind} {}", number + 1), |fid| format!("{kind} {fid}"))
}
