//! Names: the named point of a layer that is nearest to a peak.

use super::layers::Frame;
use super::metric::Distance;
use super::tags::{NameLayer, text_of};
use crate::crs::{Crs, CrsKind, Ellipsoid, Geodesics, ToGeographic};
use crate::error::{Error, ErrorKind, Result};
use crate::io::features::Layer;
use geo::Geometry;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::path::{Path, PathBuf};

/// Named points in the CRS of a DEM.
#[derive(Debug)]
pub struct Names {
    path: PathBuf,
    distance_m: f64,
    /// By feature id.
    names: Vec<String>,
    /// Places with the name that they stand for: several where a feature has several points.
    points: Vec<((f64, f64), usize)>,
}

/// How distances are measured between places that need not be the centres of cells.
pub(super) enum Ground<'a> {
    /// In the plane, with so many metres in one unit of the coordinates.
    Plane(f64),
    /// On the ellipsoid, between longitudes and latitudes in units of so many degrees, or plane coordinates that
    /// `to_geographic` turns into degrees.
    Ellipsoid { ellipsoid: Ellipsoid, degrees: f64, to_geographic: Option<&'a dyn ToGeographic> },
}

/// A place ready for measuring.
#[derive(Clone, Copy, Debug)]
struct Spot {
    /// Metres in the plane, or degrees of longitude and latitude.
    flat: (f64, f64),
    /// Metres; straight lines are no longer than distances.
    space: [f64; 3],
}

impl<'a> Ground<'a> {
    /// The ground under a DEM.
    pub(super) fn of(frame: &Frame<'a>, distance: Distance) -> Self {
        match (frame.crs_kind(), frame.to_geographic()) {
            (Some(&CrsKind::Geographic { ellipsoid, degrees }), _) => {
                Self::Ellipsoid { ellipsoid, degrees, to_geographic: None }
            }
            (Some(&CrsKind::Projected { ellipsoid, .. }), Some(to_geographic)) if distance == Distance::Geodesic => {
                Self::Ellipsoid { ellipsoid, degrees: 1.0, to_geographic: Some(to_geographic) }
            }
            (Some(&(CrsKind::Projected { metres, .. } | CrsKind::Local { metres })), _) => Self::Plane(metres),
            (None, _) => Self::Plane(1.0),
        }
    }

    /// The places of coordinates; `None` where there is none.
    fn spots(&self, points: impl Iterator<Item = (f64, f64)>) -> Vec<Option<Spot>> {
        match self {
            Self::Plane(metres) => {
                let spot =
                    |(x, y): (f64, f64)| Spot { flat: (x * metres, y * metres), space: [x * metres, y * metres, 0.0] };
                points.map(|point| Some(spot(point))).collect()
            }
            Self::Ellipsoid { ellipsoid, degrees, to_geographic } => {
                let (mut lon, mut lat): (Vec<f64>, Vec<f64>) = points.map(|(x, y)| (x * degrees, y * degrees)).unzip();
                if let Some(to_geographic) = to_geographic {
                    to_geographic.to_geographic(&mut lon, &mut lat);
                }
                let spot = |(lon, lat): (f64, f64)| {
                    let sound = lon.is_finite() && (-90.0..=90.0).contains(&lat);
                    sound.then(|| Spot { flat: (lon, lat), space: ellipsoid.in_space(lon, lat) })
                };
                lon.into_iter().zip(lat).map(spot).collect()
            }
        }
    }

    fn distance_m(&self, solver: Option<&Geodesics>, a: &Spot, b: &Spot) -> f64 {
        match solver {
            None => (a.flat.0 - b.flat.0).hypot(a.flat.1 - b.flat.1),
            Some(solver) => {
                let apart = (a.flat.0 - b.flat.0).abs() % 360.0;
                solver.distance_m(a.flat.1, b.flat.1, apart.min(360.0 - apart))
            }
        }
    }

    fn solver(&self) -> Option<Geodesics> {
        match self {
            Self::Plane(_) => None,
            Self::Ellipsoid { ellipsoid, .. } => Some(ellipsoid.geodesics()),
        }
    }
}

impl Names {
    /// Reads the points of a layer into a CRS; those without a name are passed over.
    ///
    /// # Errors
    /// When the layer cannot be read, or has no point with a name.
    pub fn read(layer: &NameLayer, crs: Option<&Crs>, note: &mut dyn FnMut(String)) -> Result<Self> {
        let read = layer.layer.read(crs, note)?;
        Self::of(read, layer.distance_m, &layer.layer.path, &layer.layer.field, note)
    }

    /// The names of a layer that holds them as its only field.
    fn of(layer: Layer, distance_m: f64, path: &Path, field: &str, note: &mut dyn FnMut(String)) -> Result<Self> {
        let (mut nameless, mut pointless) = (0, 0);
        let mut named = Vec::new();
        for (place, feature) in layer.features.into_iter().enumerate() {
            let points: Vec<(f64, f64)> = match feature.geometry {
                Some(Geometry::Point(point)) => vec![point.x_y()],
                Some(Geometry::MultiPoint(points)) => points.0.iter().map(|point| point.x_y()).collect(),
                _ => {
                    pointless += 1;
                    continue;
                }
            };
            match text_of(feature.values.first()) {
                Some(name) => named.push((feature.fid.unwrap_or(place as u64), name, points)),
                None => nameless += 1,
            }
        }
        if named.is_empty() {
            return Err(Error::new(
                ErrorKind::Input,
                format!(
                    "there is no point with a name in the field '{field}' ({nameless} without a name, {pointless} \
                     features of other kinds); choose layer and field with --name-layer and --name-field"
                ),
            )
            .at_place(format!("layer {}", layer.name))
            .at_path(path));
        }
        if pointless > 0 {
            note(format!("{}: left out features that are no points: {pointless}", path.display()));
        }
        // Stable: the order of the file among equal ids.
        named.sort_by_key(|(fid, ..)| *fid);
        let points = named.iter().enumerate().flat_map(|(i, (.., points))| points.iter().map(move |&point| (point, i)));
        let points = points.collect();
        let names = named.into_iter().map(|(_, name, _)| name).collect();
        Ok(Self { path: path.to_path_buf(), distance_m, names, points })
    }

    /// The name of each peak, where one is near enough.
    ///
    /// A name goes to one peak and a peak has one name: pairs are made by rising distance; of equal ones those of the
    /// peak that comes first, then of the feature with the lower id.
    pub(super) fn assign(
        &self,
        peaks: &[(f64, f64)],
        ground: &Ground<'_>,
        note: &mut dyn FnMut(String),
    ) -> Vec<Option<&str>> {
        let solver = ground.solver();
        let spots = ground.spots(self.points.iter().map(|(point, _)| *point));
        let tree: Vec<_> = spots
            .iter()
            .zip(&self.points)
            .filter_map(|(spot, (_, name))| spot.map(|spot| GeomWithData::new(spot.space, (spot, *name))))
            .collect();
        let tree = RTree::bulk_load(tree);
        // Wide enough for all that rounding takes away.
        let reach_m = self.distance_m * (1.0 + 1e-9) + 1e-5;
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (i, peak) in ground.spots(peaks.iter().copied()).iter().enumerate() {
            let Some(peak) = peak else { continue };
            for entry in tree.locate_within_distance(peak.space, reach_m * reach_m) {
                let (spot, name) = &entry.data;
                let distance_m = ground.distance_m(solver.as_ref(), peak, spot);
                if distance_m <= self.distance_m {
                    pairs.push((distance_m, i, *name));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut given = vec![None; peaks.len()];
        let mut taken = vec![false; self.names.len()];
        for (_, peak, name) in pairs {
            if given[peak].is_none() && !taken[name] {
                given[peak] = Some(self.names[name].as_str());
                taken[name] = true;
            }
        }
        if !peaks.is_empty() && given.iter().all(Option::is_none) {
            note(format!(
                "{}: no peak has one of the {} named points within {} m; check that they lie where the DEM does, or raise --name-distance",
                self.path.display(),
                self.names.len(),
                self.distance_m
            ));
        }
        given
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::features::{Feature, Value};
    use proptest::prelude::*;

    fn names(points: &[(u64, &str, (f64, f64))], distance_m: f64) -> Names {
        let features = points.iter().map(|&(fid, name, point)| Feature {
            fid: Some(fid),
            geometry: Some(Geometry::Point(point.into())),
            values: vec![if name.is_empty() { Value::Null } else { Value::Text(name.into()) }],
        });
        Names::of(layer(features.collect()), distance_m, Path::new("p.gpkg"), "name", &mut |_| ()).unwrap()
    }

    fn layer(features: Vec<Feature>) -> Layer {
        Layer { name: "summits".into(), crs_wkt: None, fields: vec!["name".into()], features, unplaced: 0 }
    }

    fn given(names: &Names, peaks: &[(f64, f64)], ground: &Ground<'_>) -> Vec<String> {
        let found = names.assign(peaks, ground, &mut |_| ());
        found.into_iter().map(|name| name.unwrap_or("-").to_string()).collect()
    }

    const DEGREES: Ground<'_> = Ground::Ellipsoid { ellipsoid: Ellipsoid::WGS84, degrees: 1.0, to_geographic: None };

    #[test]
    fn pairs_by_rising_distance() {
        let names = names(&[(1, "A", (100.0, 0.0)), (2, "B", (160.0, 0.0)), (3, "", (0.0, 0.0))], 150.0);
        // The second peak is nearer to A than the first, which has to be content with nothing.
        assert_eq!(given(&names, &[(0.0, 0.0), (90.0, 0.0), (300.0, 0.0)], &Ground::Plane(1.0)), ["-", "A", "B"]);
        assert_eq!(given(&names, &[(0.0, 0.0), (90.0, 0.0)], &Ground::Plane(0.3048)), ["B", "A"], "feet are shorter");
    }

    #[test]
    fn ties_go_to_the_lower_peak_and_then_the_lower_feature() {
        let around = names(&[(9, "nine", (1.0, 0.0)), (4, "four", (-1.0, 0.0)), (6, "six", (0.0, 1.0))], 1.0);
        assert_eq!(given(&around, &[(0.0, 0.0), (0.0, 0.0)], &Ground::Plane(1.0)), ["four", "six"]);
    }

    #[test]
    fn a_feature_of_several_points_names_one_peak() {
        let points = geo::MultiPoint(vec![(0.0, 0.0).into(), (50.0, 0.0).into()]);
        let feature =
            Feature { fid: None, geometry: Some(Geometry::MultiPoint(points)), values: vec![Value::Text("M".into())] };
        let names = Names::of(layer(vec![feature]), 9.0, Path::new("p"), "name", &mut |_| ()).unwrap();
        assert_eq!(given(&names, &[(3.0, 0.0), (51.0, 0.0)], &Ground::Plane(1.0)), ["-", "M"]);
    }

    #[test]
    fn metres_on_the_ellipsoid_from_any_longitude() {
        // A degree of longitude is 111.3 km at the equator and 19.4 km at 80 degrees north.
        let names = names(&[(1, "E", (-179.999, 0.0)), (2, "N", (20.0, 80.0))], 300.0);
        assert_eq!(given(&names, &[(180.0, 0.0), (20.015, 80.0)], &DEGREES), ["E", "N"]);
        assert_eq!(given(&names, &[(179.998, 0.0), (380.016, 80.0)], &DEGREES), ["-", "-"]);
        assert_eq!(given(&names, &[(180.001, 0.0), (380.001, 80.0)], &DEGREES), ["E", "N"]);
    }

    #[test]
    fn faults_and_warnings() {
        let feature = |geometry| Feature { fid: None, geometry, values: vec![Value::Null] };
        let of = |features, note: &mut dyn FnMut(String)| Names::of(layer(features), 1.0, Path::new("p"), "name", note);
        let error = of(vec![feature(None)], &mut |_| ()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Input);
        assert!(error.message().contains("--name-field"), "{error}");
        let mut notes = vec![];
        let named =
            Feature { values: vec![Value::Text("A".into())], ..feature(Some(Geometry::Point((9.0, 9.0).into()))) };
        let names = of(vec![feature(None), named], &mut |note| notes.push(note)).unwrap();
        names.assign(&[(0.0, 0.0)], &Ground::Plane(1.0), &mut |note| notes.push(note));
        assert!(notes[0].ends_with("no points: 1") && notes[1].contains("--name-distance"), "{notes:?}");
    }

    proptest! {
        #[test]
        fn as_looking_at_all_pairs(
            points in prop::collection::vec((0_i8..20, 0_i8..20), 1..12), peaks in prop::collection::vec((0_i8..20, 0_i8..20), 1..12),
        ) {
            let spread = |v: &[(i8, i8)]| v.iter().map(|&(x, y)| (179.99 + f64::from(x) * 1e-3, f64::from(y) * 1e-3)).collect::<Vec<_>>();
            let (points, peaks) = (spread(&points), spread(&peaks));
            let called: Vec<String> = (0..points.len()).map(|i| format!("n{i}")).collect();
            let listed: Vec<_> = points.iter().enumerate().map(|(i, &p)| (i as u64, called[i].as_str(), p)).collect();
            let solver = Ellipsoid::WGS84.geodesics();
            let mut pairs = vec![];
            for (i, a) in peaks.iter().enumerate() {
                for (j, b) in points.iter().enumerate() {
                    pairs.push((solver.distance_m(a.1, b.1, (a.0 - b.0).abs()), i, j));
                }
            }
            pairs.sort_by(|a, b| a.partial_cmp(b).unwrap());
            let (mut slowly, mut taken) = (vec!["-".to_string(); peaks.len()], vec![false; points.len()]);
            for (_, i, j) in pairs.into_iter().filter(|pair| pair.0 <= 500.0) {
                if slowly[i] == "-" && !taken[j] {
                    slowly[i] = called[j].clone();
                    taken[j] = true;
                }
            }
            prop_assert_eq!(given(&names(&listed, 500.0), &peaks, &DEGREES), slowly);
        }
    }
}
