//! Lines from a vector file that are to be edges of a mesh.

use crate::crs::CrsKind;
use crate::error::{Error, ErrorKind, Result};
use crate::io::features::{list_layers, read_layer};
use crate::io::raster::RasterSource;
use geo::{Geometry, LineString};
use std::path::PathBuf;

/// The layer of the ridges in what `orograph peaks` writes; its other lines are none of the terrain's.
const RIDGES: &str = "divide_tree";

/// A file with lines.
#[derive(Clone, Debug)]
pub struct LineSource {
    /// The file.
    pub path: PathBuf,
    /// Names of the layers to read; `divide_tree` if there is one, else all, unless given.
    pub layers: Option<Vec<String>>,
}

/// Columns and rows of the points of lines, and of the outlines of polygons; whole numbers at the centres of cells.
///
/// # Errors
/// A file or layer that is missing or cannot be read, or that has neither lines nor polygons.
pub(super) fn read_lines(
    lines: &LineSource,
    source: &RasterSource,
    warn: &mut dyn FnMut(&str),
) -> Result<Vec<Vec<[f64; 2]>>> {
    let names = match &lines.layers {
        Some(names) => names.clone(),
        None => {
            let there = list_layers(&lines.path)?;
            let names: Vec<String> =
                there.into_iter().filter(|layer| layer.has_geometry).map(|layer| layer.name).collect();
            if names.iter().any(|name| name == RIDGES) { vec![RIDGES.to_string()] } else { names }
        }
    };
    let wkt = source.crs.as_ref().map(|crs| crs.wkt.as_str());
    let mut found: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut unplaced = 0;
    for name in &names {
        let layer = read_layer(&lines.path, Some(name), &[], wkt)?;
        unplaced += layer.unplaced;
        layer
            .features
            .iter()
            .filter_map(|feature| feature.geometry.as_ref())
            .for_each(|geometry| add(geometry, &mut found));
    }
    if found.is_empty() {
        let message = format!("there are no lines in its layers: {}", names.join(", "));
        return Err(Error::new(ErrorKind::Input, message).at_path(&lines.path));
    }
    if unplaced > 0 {
        warn(&format!("{unplaced} of the lines have no place in the CRS of the DEM and are left out"));
    }
    let turn = match source.crs.as_ref().map(|crs| &crs.kind) {
        Some(CrsKind::Geographic { degrees, .. }) => Some(360.0 / degrees),
        _ => None,
    };
    let [_, _, cols, rows] = source.window.map(|v| v as f64);
    let middle = source.transform.centre(rows / 2.0 - 0.5, cols / 2.0 - 0.5).0;
    let cells = |line: Vec<(f64, f64)>| -> Vec<[f64; 2]> {
        // Longitudes may be counted from anywhere.
        let shift = turn.map_or(0.0, |turn| ((middle - line[0].0) / turn).round() * turn);
        let pixel = |(x, y): (f64, f64)| source.transform.pixel(x + shift, y);
        line.into_iter().map(pixel).map(|(row, col)| [col - 0.5, row - 0.5]).collect()
    };
    Ok(found.into_iter().filter(|line| !line.is_empty()).map(cells).collect())
}

/// Adds the lines of a geometry.
fn add(geometry: &Geometry<f64>, found: &mut Vec<Vec<(f64, f64)>>) {
    let mut line = |line: &LineString<f64>| found.push(line.0.iter().map(|c| (c.x, c.y)).collect());
    match geometry {
        Geometry::LineString(one) => line(one),
        Geometry::MultiLineString(lines) => lines.0.iter().for_each(line),
        Geometry::Polygon(polygon) => std::iter::once(polygon.exterior()).chain(polygon.interiors()).for_each(line),
        Geometry::MultiPolygon(polygons) => {
            polygons.0.iter().flat_map(|p| std::iter::once(p.exterior()).chain(p.interiors())).for_each(line);
        }
        _ => {}
    }
}
