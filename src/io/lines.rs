//! Reads the lines of a vector layer with their elevations and numbers: rivers, roads.
//!
//! Coordinates are always x, y (easting or longitude first), whatever order the CRS itself declares.

use super::features::{choose_layer, open, own_crs, parse_crs, transform_between, wkt2};
use super::messages::take_failures;
use crate::error::{Error, ErrorKind, Result};
use gdal::spatial_ref::CoordTransform;
use gdal::vector::{
    Feature, Geometry, LayerAccess, OGRFieldType, OGRwkbGeometryType as Wkb, geometry_type_flatten, geometry_type_has_z,
};
use std::path::Path;

/// A line, or one part of a line of several; also the outline of a polygon.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineFeature {
    /// Points `[x, y, z]`; z is NaN where the layer has none. No point is at the place of the one before it.
    pub points: Vec<[f64; 3]>,
    /// Numeric fields that are not null: names and values.
    pub numbers: Vec<(String, f64)>,
}

/// The lines of a layer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineLayer {
    /// The CRS of the coordinates as WKT2:2019: the target if one was given, else the layer's own.
    pub crs_wkt: Option<String>,
    /// Whether the layer says what its own CRS is.
    pub has_crs: bool,
    /// The lines in the order of the file.
    pub lines: Vec<LineFeature>,
    /// Number of features left out, because their coordinates are not finite or have no image in the target CRS.
    pub unplaced: usize,
}

/// Reads the lines of a layer, the only one with geometries unless named, that meet a condition (`WHERE` of SQL),
/// reprojected to `target_wkt` if that is given; a layer without a CRS stays as it is.
///
/// # Errors
/// When the dataset or the layer is missing, the condition is none, or a geometry is a curve without straight edges.
pub fn read_lines(
    path: &Path,
    layer: Option<&str>,
    filter: Option<&str>,
    target_wkt: Option<&str>,
) -> Result<LineLayer> {
    let dataset = open(path)?;
    let mut source = choose_layer(&dataset, layer).map_err(|e| e.at_path(path))?;
    let name = source.name();
    let at = |error: Error| error.at_place(format!("layer {name}")).at_path(path);
    if let Some(filter) = filter {
        take_failures();
        source.set_attribute_filter(filter).map_err(|_| {
            let said = take_failures().join("; ");
            at(Error::new(ErrorKind::Input, format!("'{filter}' is no condition on its fields: {said}")))
        })?;
    }
    let own = own_crs(&source);
    let target = target_wkt.map(parse_crs).transpose()?;
    let transform = match (&own, &target) {
        (Some(own), Some(target)) if own != target => Some(transform_between(own, target).map_err(at)?),
        _ => None,
    };
    let crs_wkt = own.as_ref().and(target.as_ref()).or(own.as_ref()).map(wkt2).transpose()?;
    let mut found = LineLayer { crs_wkt, has_crs: own.is_some(), ..LineLayer::default() };
    let columns: Vec<(usize, String)> = source
        .defn()
        .fields()
        .enumerate()
        .filter(|(_, field)| {
            matches!(field.field_type(), OGRFieldType::OFTInteger | OGRFieldType::OFTInteger64 | OGRFieldType::OFTReal)
        })
        .map(|(i, field)| (i, field.name()))
        .collect();
    for feature in source.features() {
        // `Feature::geometry` would hand out a null pointer where there is no geometry.
        let Ok(geometry) = feature.geometry_by_index(0) else { continue };
        let numbers = numbers_of(&feature, &columns);
        let mut parts = vec![];
        gather(geometry, &mut parts).map_err(at)?;
        for mut points in parts {
            if place(&mut points, transform.as_ref()).is_none() {
                found.unplaced += 1;
                continue;
            }
            points.dedup_by(|next, before| next[..2] == before[..2]);
            if points.len() > 1 {
                found.lines.push(LineFeature { points, numbers: numbers.clone() });
            }
        }
    }
    Ok(found)
}

/// The numbers of a feature, nulls left out.
fn numbers_of(feature: &Feature<'_>, columns: &[(usize, String)]) -> Vec<(String, f64)> {
    let number = |index: usize| {
        // The text tells an attribute that was never set, which GDAL would report as the number 0.
        let text = feature.field_as_string(index).ok().flatten().filter(|text| !text.is_empty());
        text.and_then(|_| feature.field_as_double(index).ok().flatten())
    };
    columns.iter().filter_map(|(index, name)| Some((name.clone(), number(*index)?))).collect()
}

/// The points of all lines of a geometry, and of the outlines of polygons.
fn gather(geometry: &Geometry, found: &mut Vec<Vec<[f64; 3]>>) -> Result<()> {
    if geometry.is_empty() {
        return Ok(());
    }
    match geometry_type_flatten(geometry.geometry_type()) {
        Wkb::wkbLineString => {
            let has_z = geometry_type_has_z(geometry.geometry_type());
            let mut points = Vec::new();
            geometry.get_points(&mut points);
            found.push(points.into_iter().map(|(x, y, z)| [x, y, if has_z { z } else { f64::NAN }]).collect());
        }
        Wkb::wkbPolygon | Wkb::wkbMultiLineString | Wkb::wkbMultiPolygon | Wkb::wkbGeometryCollection => {
            for i in 0..geometry.geometry_count() {
                gather(&geometry.get_geometry(i), found)?;
            }
        }
        Wkb::wkbPoint | Wkb::wkbMultiPoint => {}
        _ => {
            return Err(Error::new(
                ErrorKind::Unsupported,
                format!(
                    "a feature is a {}; make straight lines of it, for example with ogr2ogr -nlt CONVERT_TO_LINEAR",
                    geometry.geometry_name()
                ),
            ));
        }
    }
    Ok(())
}

/// Brings points into the target CRS; `None` where one has no place there. Elevations stay.
fn place(points: &mut [[f64; 3]], transform: Option<&CoordTransform>) -> Option<()> {
    if let Some(transform) = transform {
        let (mut x, mut y): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (p[0], p[1])).unzip();
        transform.transform_coords(&mut x, &mut y, &mut []).ok()?;
        for (point, (x, y)) in points.iter_mut().zip(x.into_iter().zip(y)) {
            [point[0], point[1]] = [x, y];
        }
    }
    points.iter().all(|p| p[0].is_finite() && p[1].is_finite()).then_some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn written(dir: &tempfile::TempDir, features: &[(&str, &str)]) -> PathBuf {
        let feature = |(properties, geometry): &(&str, &str)| {
            format!(r#"{{"type":"Feature","properties":{properties},"geometry":{geometry}}}"#)
        };
        let features: Vec<String> = features.iter().map(feature).collect();
        let path = dir.path().join("lines.geojson");
        let text = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","));
        std::fs::write(&path, text).unwrap();
        path
    }

    const TWO: &[(&str, &str)] = &[
        (
            r#"{"name":"Inn","width":20,"depth":1.5}"#,
            r#"{"type":"LineString","coordinates":[[9,46,1800],[9,46,1800],[9.1,46,1790]]}"#,
        ),
        (
            r#"{"name":"Spöl","width":8}"#,
            r#"{"type":"MultiLineString","coordinates":[[[9,47],[9.1,47]],[[9.2,47],[9.3,47.1]]]}"#,
        ),
    ];

    #[test]
    fn parts_with_elevations_and_numbers() {
        let dir = tempfile::tempdir().unwrap();
        let path = written(&dir, TWO);
        let found = read_lines(&path, None, None, None).unwrap();
        assert_eq!((found.lines.len(), found.unplaced, found.has_crs), (3, 0, true));
        assert_eq!(found.lines[0].points, [[9.0, 46.0, 1800.0], [9.1, 46.0, 1790.0]], "no point twice");
        assert_eq!(found.lines[0].numbers, [("width".to_string(), 20.0), ("depth".to_string(), 1.5)]);
        assert!(found.lines[2].points[0][2].is_nan());
        assert_eq!(found.lines[2].numbers, [("width".to_string(), 8.0)], "a null is no number");
        let inn = read_lines(&path, Some("lines"), Some("name = 'Inn'"), None).unwrap();
        assert_eq!(inn.lines, found.lines[..1]);
    }

    #[test]
    fn reprojected_with_easting_first() {
        let dir = tempfile::tempdir().unwrap();
        let path = written(&dir, TWO);
        let utm = gdal::spatial_ref::SpatialRef::from_epsg(32632).unwrap().to_wkt().unwrap();
        let found = read_lines(&path, None, None, Some(&utm)).unwrap();
        let [x, y, z] = found.lines[0].points[0];
        // On the central meridian of zone 32.
        assert!((x - 500_000.0).abs() < 1e-3 && (y - 5_093_784.0).abs() < 1000.0 && z == 1800.0, "{x} {y} {z}");
    }

    #[test]
    fn conditions_and_layers_that_are_none() {
        let dir = tempfile::tempdir().unwrap();
        let path = written(&dir, TWO);
        let text = |layer, filter| read_lines(&path, layer, filter, None).unwrap_err().to_string();
        assert!(text(None, Some("height > 3")).contains("'height > 3' is no condition"), "{}", text(None, Some("x >")));
        assert!(text(Some("roads"), None).contains("no layer 'roads'"));
    }
}
