//! Regions: the polygon of a layer that a place stands in.

use super::tags::{TagLayer, read_onto, text_of};
use crate::crs::{Crs, CrsKind};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::GeoTransform;
use crate::io::features::{Layer, Value};
use crate::orometry::distributions::CellSet;
use geo::{BoundingRect, Geometry, Intersects, MultiPolygon, Point};
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Rectangle};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Named polygons in the CRS of a DEM.
///
/// A place on an outline is inside. Polygons may overlap: a place belongs to the one with the lowest feature id.
#[derive(Debug)]
pub struct Regions {
    path: PathBuf,
    /// By feature id.
    shapes: Vec<Shape>,
    tree: RTree<GeomWithData<Rectangle<[f64; 2]>, usize>>,
    /// A full turn in units of the coordinates, where they are longitudes.
    turn: Option<f64>,
}

/// A polygon of one or more parts.
#[derive(Debug)]
struct Shape {
    name: String,
    parts: MultiPolygon<f64>,
}

impl Regions {
    /// Reads the polygons of a layer into a CRS.
    ///
    /// # Errors
    /// When the layer cannot be read, or has no polygon with a name.
    pub fn read(layer: &TagLayer, crs: Option<&Crs>, note: &mut dyn FnMut(String)) -> Result<Self> {
        let read = layer.read(crs, note)?;
        Self::of(read, crs, &layer.path, Some(&layer.field), note)
    }

    /// Reads the polygons of a file, whatever their names, into a CRS: they are one region.
    ///
    /// # Errors
    /// When the file cannot be read, has several layers, or no polygon.
    pub fn read_nameless(path: &Path, crs: Option<&Crs>, note: &mut dyn FnMut(String)) -> Result<Self> {
        let mut layer = read_onto(path, None, &[], crs, note)?;
        layer.features.iter_mut().for_each(|feature| feature.values = vec![Value::Text("all".into())]);
        Self::of(layer, crs, path, None, note)
    }

    /// The regions of a layer that holds the names as its only field.
    fn of(
        layer: Layer,
        crs: Option<&Crs>,
        path: &Path,
        field: Option<&str>,
        note: &mut dyn FnMut(String),
    ) -> Result<Self> {
        let (mut nameless, mut shapeless) = (0, 0);
        let mut shapes = Vec::new();
        for (place, feature) in layer.features.into_iter().enumerate() {
            let parts = match feature.geometry {
                Some(Geometry::Polygon(polygon)) => MultiPolygon(vec![polygon]),
                Some(Geometry::MultiPolygon(polygons)) => polygons,
                _ => {
                    shapeless += 1;
                    continue;
                }
            };
            match text_of(feature.values.first()) {
                Some(name) => shapes.push((feature.fid.unwrap_or(place as u64), Shape { name, parts })),
                None => nameless += 1,
            }
        }
        if shapes.is_empty() {
            let message = field.map_or_else(
                || format!("there is no polygon ({shapeless} features of other kinds)"),
                |field| {
                    format!(
                        "there is no polygon with a name in the field '{field}' ({nameless} without a name, {shapeless} \
                         features of other kinds); choose layer and field with --region-layer and --region-field"
                    )
                },
            );
            return Err(Error::new(ErrorKind::Input, message).at_place(format!("layer {}", layer.name)).at_path(path));
        }
        for (count, what) in [(nameless, "polygons without a name"), (shapeless, "features that are no polygons")] {
            if count > 0 {
                note(format!("{}: left out {what}: {count}", path.display()));
            }
        }
        // Stable: the order of the file among equal ids.
        shapes.sort_by_key(|(fid, _)| *fid);
        let shapes: Vec<Shape> = shapes.into_iter().map(|(_, shape)| shape).collect();
        let envelopes = shapes.iter().enumerate().filter_map(|(i, shape)| {
            let rectangle = shape.parts.bounding_rect()?;
            let (low, high) = (rectangle.min(), rectangle.max());
            Some(GeomWithData::new(Rectangle::from_corners([low.x, low.y], [high.x, high.y]), i))
        });
        let tree = RTree::bulk_load(envelopes.collect());
        let turn = match crs.map(|crs| &crs.kind) {
            Some(CrsKind::Geographic { degrees, .. }) => Some(360.0 / degrees),
            _ => None,
        };
        Ok(Self { path: path.to_path_buf(), shapes, tree, turn })
    }

    /// The polygons that hold a place, by feature id; of longitudes it does not matter where they are counted from.
    fn around(&self, (x, y): (f64, f64)) -> Vec<usize> {
        let mut found: Vec<usize> = self
            .turns()
            .into_iter()
            .flat_map(|turn| {
                let point = Point::new(x + turn, y);
                self.tree
                    .locate_all_at_point([point.x(), y])
                    .map(|entry| entry.data)
                    .filter(move |&i| self.shapes[i].parts.intersects(&point))
            })
            .collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The names of the regions, those of lower feature ids first.
    pub fn names(&self) -> Vec<&str> {
        let mut seen = HashSet::new();
        self.shapes.iter().map(|shape| shape.name.as_str()).filter(|name| seen.insert(*name)).collect()
    }

    /// The cells of each region on a grid of so many rows and columns, in the order of [`Regions::names`].
    ///
    /// A cell belongs to the same region as a peak in it would, but that on an outline it is only one side's.
    pub fn cells(&self, transform: &GeoTransform, (rows, cols): (usize, usize)) -> Vec<(String, CellSet)> {
        let none = || CellSet::from_rows(rows, cols, |_, _| ());
        let mut regions: Vec<(String, CellSet)> =
            self.names().into_iter().map(|name| (name.to_string(), none())).collect();
        let places: HashMap<String, usize> =
            regions.iter().enumerate().map(|(i, (name, _))| (name.clone(), i)).collect();
        let mut taken = none();
        for shape in &self.shapes {
            let mut cells = CellSet::polygon(&self.rings(shape, transform, (rows, cols)), transform, rows, cols);
            cells.take_away(&taken);
            taken.join(&cells);
            regions[places[&shape.name]].1.join(&cells);
        }
        regions
    }

    /// The rings of a shape wherever it touches a grid: longitudes may be counted from elsewhere there.
    fn rings(&self, shape: &Shape, transform: &GeoTransform, (rows, cols): (usize, usize)) -> Vec<Vec<(f64, f64)>> {
        let corner = |row: usize, col: usize| transform.centre(row as f64 - 0.5, col as f64 - 0.5).0;
        let corners = [corner(0, 0), corner(0, cols), corner(rows, 0), corner(rows, cols)];
        let (west, east) =
            corners.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
        let Some(bounds) = shape.parts.bounding_rect() else { return vec![] };
        let mut rings = vec![];
        for turn in self.turns() {
            if bounds.max().x + turn < west || bounds.min().x + turn > east {
                continue;
            }
            for polygon in &shape.parts.0 {
                for ring in std::iter::once(polygon.exterior()).chain(polygon.interiors()) {
                    rings.push(ring.0.iter().map(|c| (c.x + turn, c.y)).collect());
                }
            }
        }
        rings
    }

    /// What may be added to coordinates without moving the place.
    fn turns(&self) -> Vec<f64> {
        self.turn.map_or(vec![0.0], |turn| vec![0.0, -turn, turn])
    }

    /// The region of each place, where it stands in one; `called` is what a warning calls a place.
    pub fn tag(
        &self,
        points: &[(f64, f64)],
        called: &dyn Fn(usize) -> String,
        note: &mut dyn FnMut(String),
    ) -> Vec<Option<&str>> {
        let found: Vec<Vec<usize>> = points.par_iter().map(|&point| self.around(point)).collect();
        let name = |i: usize| self.shapes[i].name.as_str();
        let torn = |(_, found): &(usize, &Vec<usize>)| found.iter().any(|&i| name(i) != name(found[0]));
        let mut several = found.iter().enumerate().filter(torn);
        if let Some((first, shapes)) = several.next() {
            let count = 1 + several.count();
            let names: Vec<&str> = shapes.iter().map(|&i| name(i)).collect();
            note(format!(
                "{}: {} in several regions and got the one with the lowest feature id: {}{}",
                self.path.display(),
                if count == 1 { "1 peak stands".into() } else { format!("{count} peaks stand") },
                if count == 1 { String::new() } else { "the first is ".into() },
                format_args!("{} in {}", called(first), names.join(", ")),
            ));
        }
        if !points.is_empty() && found.iter().all(Vec::is_empty) {
            note(format!(
                "{}: no peak stands in any of the {} regions; check where they lie, and in which CRS",
                self.path.display(),
                self.shapes.len()
            ));
        }
        found.into_iter().map(|found| found.first().map(|&i| name(i))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::Ellipsoid;
    use crate::io::features::Feature;
    use geo::polygon;

    fn square(x0: f64, y0: f64, side: f64) -> Geometry<f64> {
        let (x1, y1) = (x0 + side, y0 + side);
        polygon![(x: x0, y: y0), (x: x1, y: y0), (x: x1, y: y1), (x: x0, y: y1)].into()
    }

    fn layer(features: Vec<(u64, &str, Option<Geometry<f64>>)>) -> Layer {
        let features = features.into_iter().map(|(fid, name, geometry)| {
            let value = if name.is_empty() { Value::Null } else { Value::Text(name.into()) };
            Feature { fid: Some(fid), geometry, values: vec![value] }
        });
        Layer {
            name: "ranges".into(),
            crs_wkt: None,
            fields: vec!["name".into()],
            features: features.collect(),
            unplaced: 0,
        }
    }

    fn regions(features: Vec<(u64, &str, Option<Geometry<f64>>)>, degrees: Option<f64>) -> (Regions, Vec<String>) {
        let mut notes = vec![];
        let crs = degrees.map(|degrees| Crs {
            wkt: String::new(),
            name: String::new(),
            authority: None,
            kind: CrsKind::Geographic { ellipsoid: Ellipsoid::WGS84, degrees },
            projection: None,
            vertical_unit: None,
        });
        let path = Path::new("r.gpkg");
        let regions =
            Regions::of(layer(features), crs.as_ref(), path, Some("name"), &mut |note| notes.push(note)).unwrap();
        (regions, notes)
    }

    fn tagged(regions: &Regions, points: &[(f64, f64)]) -> (Vec<Option<String>>, Vec<String>) {
        let mut notes = vec![];
        let found = regions.tag(points, &|i| format!("place {i}"), &mut |note| notes.push(note));
        (found.into_iter().map(|name| name.map(str::to_string)).collect(), notes)
    }

    #[test]
    fn holes_parts_and_outlines() {
        let ring = polygon!(exterior: [(x: 0., y: 0.), (x: 9., y: 0.), (x: 9., y: 9.), (x: 0., y: 9.)],
            interiors: [[(x: 3., y: 3.), (x: 6., y: 3.), (x: 6., y: 6.), (x: 3., y: 6.)]]);
        let far = polygon![(x: 20., y: 0.), (x: 21., y: 0.), (x: 21., y: 1.)];
        let both = Geometry::MultiPolygon(MultiPolygon(vec![ring, far]));
        let (regions, notes) = regions(vec![(3, "Alps", Some(both))], None);
        assert_eq!(notes, [""; 0]);
        let points = [(1.0, 1.0), (4.0, 4.0), (3.0, 4.0), (9.0, 9.0), (20.9, 0.5), (20.1, 0.9), (360.5, 1.0)];
        let (found, notes) = tagged(&regions, &points);
        let inside: Vec<bool> = found.iter().map(Option::is_some).collect();
        assert_eq!(inside, [true, false, true, true, true, false, false]);
        assert_eq!(notes, [""; 0]);
    }

    #[test]
    fn the_lowest_feature_id_wins_with_one_warning() {
        let features = vec![
            (8, "late", Some(square(0.0, 0.0, 9.0))),
            (2, "early", Some(square(4.0, 0.0, 9.0))),
            (5, "early", Some(square(5.0, 0.0, 1.0))),
        ];
        let (regions, _) = regions(features, None);
        let (found, notes) = tagged(&regions, &[(1.0, 1.0), (5.5, 0.5), (12.0, 1.0), (6.0, 1.0)]);
        let found: Vec<_> = found.iter().map(Option::as_deref).collect();
        assert_eq!(found, [Some("late"), Some("early"), Some("early"), Some("early")]);
        assert_eq!(notes.len(), 1, "{notes:?}");
        assert!(notes[0].contains("2 peaks stand") && notes[0].contains("place 1 in early, early, late"), "{notes:?}");
        let (_, notes) = tagged(&regions, &[(12.0, 1.0)]);
        assert_eq!(notes, [""; 0]);
    }

    #[test]
    fn longitudes_are_counted_from_anywhere() {
        let (regions, _) = regions(vec![(1, "Andes", Some(square(-75.0, -40.0, 10.0)))], Some(1.0));
        let (found, _) = tagged(&regions, &[(-70.0, -35.0), (290.0, -35.0), (-430.0, -35.0), (70.0, -35.0)]);
        assert_eq!(found.iter().filter(|found| found.is_some()).count(), 3, "{found:?}");
        assert_eq!(found[3], None);
        let (gon, _) = super::tests::regions(vec![(1, "Andes", Some(square(-80.0, -40.0, 10.0)))], Some(0.9));
        assert_eq!(tagged(&gon, &[(325.0, -35.0)]).0, [Some("Andes".into())], "400 gon are a turn");
    }

    #[test]
    fn cells_belong_to_one_region() {
        let features = vec![
            (8, "late", Some(square(-75.0, -40.0, 6.0))),
            (2, "early", Some(square(-72.0, -40.0, 6.0))),
            (9, "late", Some(square(-60.0, -40.0, 1.0))),
            (10, "elsewhere", Some(square(10.0, 10.0, 1.0))),
        ];
        let (regions, _) = regions(features, Some(1.0));
        let transform = GeoTransform([280.0, 1.0, 0.0, -30.0, 0.0, -1.0]);
        let cells = regions.cells(&transform, (12, 40));
        let counts: Vec<_> = cells.iter().map(|(name, cells)| (name.as_str(), cells.count())).collect();
        assert_eq!(counts, [("early", 36), ("late", 18 + 1), ("elsewhere", 0)]);
        assert_eq!(cells[1].1.runs(9).iter().map(|run| (run.start, run.end)).collect::<Vec<_>>(), [(5, 8), (20, 21)]);
        for (name, cells) in &cells {
            for row in 0..12 {
                for col in cells.runs(row).iter().cloned().flatten() {
                    let found = tagged(&regions, &[transform.centre(row as f64, col as f64)]).0;
                    assert_eq!(found[0].as_ref(), Some(name));
                }
            }
        }
    }

    #[test]
    fn what_is_left_out_is_counted() {
        let point = Geometry::Point((1.0, 1.0).into());
        let features = vec![
            (1, "", Some(square(0.0, 0.0, 1.0))),
            (2, "a town", Some(point.clone())),
            (3, "nowhere", None),
            (4, "Alps", Some(square(0.0, 0.0, 1.0))),
        ];
        let (regions, notes) = regions(features, None);
        assert!(notes[0].ends_with("without a name: 1") && notes[1].ends_with("no polygons: 2"), "{notes:?}");
        let (found, notes) = tagged(&regions, &[(5.0, 5.0)]);
        assert_eq!(found, [None]);
        assert!(notes[0].contains("no peak stands in any of the 1 regions"), "{notes:?}");
        let only_points = layer(vec![(1, "town", Some(point))]);
        let error = Regions::of(only_points, None, Path::new("r.gpkg"), Some("name"), &mut |_| ()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Input);
        assert!(error.to_string().contains("r.gpkg: layer ranges: there is no polygon"), "{error}");
    }
}
