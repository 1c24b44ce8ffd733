//! Reads vector layers: points, lines and polygons with some of their attributes, in the CRS that is wanted.
//!
//! Coordinates are always x, y (easting or longitude first), whatever order the CRS itself declares.

use super::messages::quiet;
use crate::error::{Error, ErrorKind, Result};
use gdal::errors::GdalError;
use gdal::spatial_ref::{AxisMappingStrategy, CoordTransform, SpatialRef};
use gdal::vector::{Geometry as OgrGeometry, LayerAccess, OGRFieldType, OGRwkbGeometryType as Wkb};
use gdal::{Dataset, DatasetOptions, GdalOpenFlags, Metadata};
use geo::{Coord, Geometry, LineString, MultiLineString, MultiPoint, MultiPolygon, Point, Polygon};
use std::path::Path;

/// An attribute of a feature.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Nothing: null, absent, or an empty text.
    Null,
    /// A number; integers beyond 2^53 are rounded.
    Number(f64),
    /// A text; dates and lists come as GDAL writes them.
    Text(String),
}

impl Value {
    /// The number, if it is one.
    pub fn number(&self) -> Option<f64> {
        if let Self::Number(number) = self { Some(*number) } else { None }
    }

    /// The text, if it is one.
    pub fn text(&self) -> Option<&str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }
}

/// A feature with the attributes that were asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// Feature id, where the format has one.
    pub fid: Option<u64>,
    /// The geometry in two dimensions; `None` where it is null or empty.
    pub geometry: Option<Geometry<f64>>,
    /// The attributes, in the order of [`Layer::fields`].
    pub values: Vec<Value>,
}

/// A vector layer in memory.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Its name.
    pub name: String,
    /// The CRS of the coordinates as WKT2:2019: the target when one was given, else the layer's own.
    pub crs_wkt: Option<String>,
    /// Names of the attributes, as they were asked for.
    pub fields: Vec<String>,
    /// The features in the order of the file.
    pub features: Vec<Feature>,
    /// Number of features left out, because their coordinates are not finite or have no image in the target CRS.
    pub unplaced: usize,
}

impl Layer {
    /// Position of an attribute in [`Feature::values`].
    pub fn field(&self, name: &str) -> Option<usize> {
        self.fields.iter().position(|field| field == name)
    }
}

/// A layer as a listing shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LayerSummary {
    /// Its name.
    pub name: String,
    /// Whether its features have geometries (tables of styles or metadata have none).
    pub has_geometry: bool,
    /// Number of features.
    pub features: u64,
    /// Names of its attributes.
    pub fields: Vec<String>,
}

/// The vector layers of a dataset, in its own order.
///
/// # Errors
/// When the dataset is missing or GDAL cannot open it as vectors.
pub fn list_layers(path: impl AsRef<Path>) -> Result<Vec<LayerSummary>> {
    let path = path.as_ref();
    let dataset = open(path)?;
    Ok(dataset
        .layers()
        .map(|layer| LayerSummary {
            name: layer.name(),
            has_geometry: has_geometry(&layer),
            features: layer.feature_count(),
            fields: layer.defn().fields().map(|field| field.name()).collect(),
        })
        .collect())
}

/// An item of a dataset's metadata, where it is there.
///
/// # Errors
/// When the dataset is missing or GDAL cannot open it as vectors.
pub fn metadata_item(path: impl AsRef<Path>, key: &str) -> Result<Option<String>> {
    Ok(open(path.as_ref())?.metadata_item(key, ""))
}

/// Reads one layer with the attributes `fields`, reprojected to `target_wkt` if that is given.
///
/// Without a layer's name the dataset must have exactly one layer with geometries.
///
/// # Errors
/// When the dataset, the layer or a field is missing (the message lists what is there), when a geometry is of a
/// kind without straight edges, when the layer has no CRS to reproject from, or when reading ends early.
pub fn read_layer(
    path: impl AsRef<Path>,
    layer: Option<&str>,
    fields: &[&str],
    target_wkt: Option<&str>,
) -> Result<Layer> {
    let path = path.as_ref();
    let dataset = open(path)?;
    let mut source = choose_layer(&dataset, layer).map_err(|e| e.at_path(path))?;
    let name = source.name();
    read_features(&mut source, &name, fields, target_wkt).map_err(|e| e.at_place(format!("layer {name}")).at_path(path))
}

pub(super) fn open(path: &Path) -> Result<Dataset> {
    quiet();
    let text = path.to_string_lossy();
    // Names such as /vsizip/... or PG:... are GDAL's own and not of the file system.
    let is_local = !text.starts_with("/vsi") && !text.contains(':');
    if is_local && !path.exists() {
        return Err(Error::new(ErrorKind::Input, "no such file; check the path").at_path(path));
    }
    let options = DatasetOptions {
        open_flags: GdalOpenFlags::GDAL_OF_READONLY | GdalOpenFlags::GDAL_OF_VECTOR,
        ..DatasetOptions::default()
    };
    Dataset::open_ex(path, options).map_err(|e| {
        let reason = match e {
            GdalError::NullPointer { msg, .. } if msg.trim().is_empty() => "no driver recognises it".to_string(),
            GdalError::NullPointer { msg, .. } => msg.trim().to_string(),
            other => other.to_string(),
        };
        let message = format!("GDAL cannot read vector layers from it ({reason}); try ogrinfo on it");
        Error::new(ErrorKind::Input, message).at_path(path)
    })
}

fn has_geometry(layer: &gdal::vector::Layer<'_>) -> bool {
    layer.defn().geometry_type() != Wkb::wkbNone
}

pub(super) fn choose_layer<'a>(dataset: &'a Dataset, wanted: Option<&str>) -> Result<gdal::vector::Layer<'a>> {
    let names: Vec<String> = dataset.layers().map(|layer| layer.name()).collect();
    let there = if names.is_empty() { "it has none".to_string() } else { format!("it has {}", names.join(", ")) };
    if let Some(wanted) = wanted {
        let index = names
            .iter()
            .position(|name| name == wanted)
            .ok_or_else(|| Error::new(ErrorKind::Input, format!("there is no layer '{wanted}': {there}")))?;
        return dataset.layer(index).map_err(|e| Error::new(ErrorKind::Corrupt, e.to_string()));
    }
    let mut spatial: Vec<_> = dataset.layers().filter(has_geometry).collect();
    match (spatial.pop(), spatial.len()) {
        (Some(layer), 0) => Ok(layer),
        (None, _) => Err(Error::new(ErrorKind::Input, format!("there is no layer with geometries: {there}"))),
        (Some(_), _) => {
            Err(Error::new(ErrorKind::Input, format!("there are several layers; name the one to read: {there}")))
        }
    }
}

fn read_features(
    source: &mut gdal::vector::Layer<'_>,
    name: &str,
    fields: &[&str],
    target_wkt: Option<&str>,
) -> Result<Layer> {
    let columns = fields.iter().map(|field| Column::find(source, field)).collect::<Result<Vec<_>>>()?;
    let own = own_crs(source);
    let target = target_wkt.map(parse_crs).transpose()?;
    let transform = match (&own, &target) {
        (Some(own), Some(target)) if own != target => Some(transform_between(own, target)?),
        (None, Some(_)) => {
            return Err(Error::new(
                ErrorKind::Input,
                "the layer has no CRS, so it cannot be reprojected; assign one, for example with ogr2ogr -a_srs",
            ));
        }
        _ => None,
    };
    let crs_wkt = target.as_ref().or(own.as_ref()).map(wkt2).transpose()?;
    let announced = source.feature_count();
    let mut layer = Layer {
        name: name.to_string(),
        crs_wkt,
        fields: fields.iter().map(|&field| field.to_string()).collect(),
        features: Vec::new(),
        unplaced: 0,
    };
    let mut read = 0_u64;
    let reader = GeometryReader { transform };
    for feature in source.features() {
        read += 1;
        // `Feature::geometry` would hand out a null pointer where there is no geometry.
        let geometry = match feature.geometry_by_index(0).ok().map(|g| reader.read(g)).transpose() {
            Ok(geometry) => geometry.flatten(),
            Err(Misread::Unplaced) => {
                layer.unplaced += 1;
                continue;
            }
            Err(Misread::Unsupported(kind)) => {
                let fid = feature.fid().map_or_else(|| read.to_string(), |fid| fid.to_string());
                return Err(Error::new(
                    ErrorKind::Unsupported,
                    format!(
                        "feature {fid} is a {kind}; make straight lines of it, for example with ogr2ogr -nlt CONVERT_TO_LINEAR"
                    ),
                ));
            }
        };
        let values = columns.iter().map(|column| column.value(&feature)).collect();
        layer.features.push(Feature { fid: feature.fid(), geometry, values });
    }
    // GDAL ends the iteration without a word when the file is damaged.
    if read < announced {
        return Err(Error::new(
            ErrorKind::Corrupt,
            format!(
                "{announced} features are announced but only {read} can be read; repair it, for example with ogr2ogr"
            ),
        ));
    }
    Ok(layer)
}

/// An attribute that is read.
struct Column {
    index: usize,
    is_number: bool,
}

impl Column {
    fn find(layer: &gdal::vector::Layer<'_>, name: &str) -> Result<Self> {
        let there: Vec<_> = layer.defn().fields().map(|field| (field.name(), field.field_type())).collect();
        let index = there.iter().position(|(field, _)| field == name).ok_or_else(|| {
            let names: Vec<&str> = there.iter().map(|(field, _)| field.as_str()).collect();
            let list = if names.is_empty() { "none".to_string() } else { names.join(", ") };
            Error::new(ErrorKind::Input, format!("there is no field '{name}': the layer has {list}"))
        })?;
        let is_number =
            matches!(there[index].1, OGRFieldType::OFTInteger | OGRFieldType::OFTInteger64 | OGRFieldType::OFTReal);
        Ok(Self { index, is_number })
    }

    fn value(&self, feature: &gdal::vector::Feature<'_>) -> Value {
        // The text tells an attribute that was never set, which GDAL would report as the number 0.
        match feature.field_as_string(self.index) {
            Ok(Some(text)) if !text.is_empty() => {
                if !self.is_number {
                    return Value::Text(text);
                }
                feature.field_as_double(self.index).ok().flatten().map_or(Value::Null, Value::Number)
            }
            _ => Value::Null,
        }
    }
}

/// The CRS of a layer, if it has one.
///
/// A GeoPackage must name one for every layer: by its specification (1.3, clause 1.1.2.1.2) these two stand for none.
pub(super) fn own_crs(layer: &gdal::vector::Layer<'_>) -> Option<SpatialRef> {
    let is_none = |name: String| matches!(name.as_str(), "Undefined geographic SRS" | "Undefined Cartesian SRS");
    layer.spatial_ref().filter(|crs| !crs.name().is_some_and(is_none)).map(in_xy_order)
}

fn in_xy_order(mut crs: SpatialRef) -> SpatialRef {
    crs.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
    crs
}

pub(super) fn parse_crs(wkt: &str) -> Result<SpatialRef> {
    SpatialRef::from_wkt(wkt)
        .map(in_xy_order)
        .map_err(|e| Error::new(ErrorKind::Input, format!("the target CRS is not valid WKT ({e})")))
}

pub(super) fn transform_between(from: &SpatialRef, to: &SpatialRef) -> Result<CoordTransform> {
    CoordTransform::new(from, to).map_err(|e| {
        let name = |crs: &SpatialRef| crs.name().unwrap_or_else(|| "an unnamed CRS".into());
        Error::new(
            ErrorKind::Unsupported,
            format!("PROJ knows no way from {} to {} ({e}); reproject it with ogr2ogr", name(from), name(to)),
        )
    })
}

pub(super) fn wkt2(crs: &SpatialRef) -> Result<String> {
    const FORMAT: &str = "OSR_WKT_FORMAT";
    let failed = |e: GdalError| Error::new(ErrorKind::Input, format!("the CRS cannot be written ({e})"));
    // The safe binding has no format argument; the option is the thread's own and is taken back.
    gdal::config::set_thread_local_config_option(FORMAT, "WKT2_2019").map_err(failed)?;
    let wkt = crs.to_wkt();
    gdal::config::clear_thread_local_config_option(FORMAT).map_err(failed)?;
    wkt.map_err(failed)
}

/// Why a geometry could not be read.
enum Misread {
    /// Not finite, or no image in the target CRS.
    Unplaced,
    /// Of a kind that has no counterpart here.
    Unsupported(String),
}

/// Makes `geo` geometries of GDAL's, reprojected on the way.
struct GeometryReader {
    transform: Option<CoordTransform>,
}

impl GeometryReader {
    fn read(&self, source: &OgrGeometry) -> std::result::Result<Option<Geometry<f64>>, Misread> {
        if source.is_empty() {
            return Ok(None);
        }
        let parts = 0..source.geometry_count();
        let geometry = match gdal::vector::geometry_type_flatten(source.geometry_type()) {
            Wkb::wkbPoint => Geometry::Point(self.point(source)?),
            Wkb::wkbLineString => Geometry::LineString(self.line(source)?),
            Wkb::wkbPolygon => Geometry::Polygon(self.polygon(source)?),
            Wkb::wkbMultiPoint => Geometry::MultiPoint(MultiPoint(
                parts.map(|i| self.point(&source.get_geometry(i))).collect::<std::result::Result<_, _>>()?,
            )),
            Wkb::wkbMultiLineString => Geometry::MultiLineString(MultiLineString(
                parts.map(|i| self.line(&source.get_geometry(i))).collect::<std::result::Result<_, _>>()?,
            )),
            Wkb::wkbMultiPolygon => Geometry::MultiPolygon(MultiPolygon(
                parts.map(|i| self.polygon(&source.get_geometry(i))).collect::<std::result::Result<_, _>>()?,
            )),
            _ => return Err(Misread::Unsupported(source.geometry_name())),
        };
        Ok(Some(geometry))
    }

    fn point(&self, source: &OgrGeometry) -> std::result::Result<Point<f64>, Misread> {
        self.coordinates(source)?.first().map(|&c| Point(c)).ok_or(Misread::Unplaced)
    }

    fn line(&self, source: &OgrGeometry) -> std::result::Result<LineString<f64>, Misread> {
        Ok(LineString(self.coordinates(source)?))
    }

    fn polygon(&self, source: &OgrGeometry) -> std::result::Result<Polygon<f64>, Misread> {
        let mut rings = (0..source.geometry_count()).map(|i| self.line(&source.get_geometry(i)));
        let outer = rings.next().unwrap_or_else(|| Ok(LineString(Vec::new())))?;
        Ok(Polygon::new(outer, rings.collect::<std::result::Result<_, _>>()?))
    }

    fn coordinates(&self, source: &OgrGeometry) -> std::result::Result<Vec<Coord<f64>>, Misread> {
        let mut points = Vec::new();
        source.get_points(&mut points);
        let (mut x, mut y): (Vec<f64>, Vec<f64>) = points.into_iter().map(|(x, y, _)| (x, y)).unzip();
        if let Some(transform) = &self.transform {
            transform.transform_coords(&mut x, &mut y, &mut []).map_err(|_| Misread::Unplaced)?;
        }
        if x.iter().chain(&y).any(|v| !v.is_finite()) {
            return Err(Misread::Unplaced);
        }
        Ok(x.into_iter().zip(y).map(|(x, y)| Coord { x, y }).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn written(dir: &tempfile::TempDir, text: &str) -> PathBuf {
        let path = dir.path().join("layer.geojson");
        std::fs::write(&path, text).unwrap();
        path
    }

    fn collection(features: &str) -> String {
        format!(r#"{{"type":"FeatureCollection","features":[{features}]}}"#)
    }

    const PEAKS: &str = r#"
        {"type":"Feature","id":7,"properties":{"name":"Piz Kesch","elevation_m":3418.5,"rank":1},
         "geometry":{"type":"Point","coordinates":[9.87,46.62,3418.0]}},
        {"type":"Feature","id":8,"properties":{"name":null,"elevation_m":2999},
         "geometry":{"type":"Point","coordinates":[9.9,46.7]}},
        {"type":"Feature","id":9,"properties":{"name":"nowhere"},"geometry":null}"#;

    #[test]
    fn points_with_attributes() {
        let dir = tempfile::tempdir().unwrap();
        let path = written(&dir, &collection(PEAKS));
        let layer = read_layer(&path, None, &["elevation_m", "name", "rank"], None).unwrap();
        assert_eq!((layer.features.len(), layer.unplaced), (3, 0));
        assert_eq!(layer.features[0].fid, Some(7));
        assert_eq!(layer.features[0].geometry, Some(Geometry::Point(Point::new(9.87, 46.62))));
        let kesch = [Value::Number(3418.5), Value::Text("Piz Kesch".into()), Value::Number(1.0)];
        assert_eq!(layer.features[0].values, kesch);
        assert_eq!(layer.features[1].values, [Value::Number(2999.0), Value::Null, Value::Null]);
        assert_eq!(layer.features[2].geometry, None);
        assert!(layer.crs_wkt.unwrap().starts_with("GEOGCRS["), "WKT2");
        assert_eq!(layer.fields[1], "name");
    }

    #[test]
    fn lines_and_polygons() {
        let dir = tempfile::tempdir().unwrap();
        let shape = |geometry: &str| format!(r#"{{"type":"Feature","properties":{{}},"geometry":{geometry}}}"#);
        let features = [
            shape(r#"{"type":"LineString","coordinates":[[0,0],[1,2]]}"#),
            shape(r#"{"type":"MultiLineString","coordinates":[[[0,0],[1,2]],[[3,3],[4,4],[5,4]]]}"#),
            shape(r#"{"type":"Polygon","coordinates":[[[0,0],[9,0],[9,9],[0,0]],[[5,1],[6,1],[6,2],[5,1]]]}"#),
            shape(r#"{"type":"MultiPolygon","coordinates":[[[[0,0],[9,0],[9,9],[0,0]]]]}"#),
            shape(r#"{"type":"MultiPoint","coordinates":[[0,0],[9,0]]}"#),
        ];
        let path = written(&dir, &collection(&features.join(",")));
        let layer = read_layer(&path, Some("layer"), &[], None).unwrap();
        let geometries: Vec<_> = layer.features.into_iter().filter_map(|f| f.geometry).collect();
        assert!(matches!(&geometries[0], Geometry::LineString(l) if l.0[1] == Coord { x: 1.0, y: 2.0 }));
        assert!(matches!(&geometries[1], Geometry::MultiLineString(l) if l.0[1].0.len() == 3));
        assert!(matches!(&geometries[2], Geometry::Polygon(p) if p.interiors().len() == 1));
        assert!(matches!(&geometries[3], Geometry::MultiPolygon(p) if p.0.len() == 1));
        assert!(matches!(&geometries[4], Geometry::MultiPoint(p) if p.0.len() == 2));
    }

    #[test]
    fn reprojects_with_easting_first() {
        let dir = tempfile::tempdir().unwrap();
        let path = written(&dir, &collection(PEAKS));
        let utm = wkt2(&SpatialRef::from_epsg(32632).unwrap()).unwrap();
        let layer = read_layer(&path, None, &[], Some(&utm)).unwrap();
        let Some(Geometry::Point(kesch)) = &layer.features[0].geometry else { panic!("a point") };
        // By `gdaltransform -s_srs EPSG:4326 -t_srs EPSG:32632`.
        assert!((kesch.x() - 566_609.589).abs() < 0.01 && (kesch.y() - 5_163_305.069).abs() < 0.01, "{kesch:?}");
        assert!(layer.crs_wkt.unwrap().starts_with("PROJCRS["));
        let same = SpatialRef::from_epsg(4326).unwrap().to_wkt().unwrap();
        let layer = read_layer(&path, None, &[], Some(&same)).unwrap();
        assert_eq!(layer.features[0].geometry, Some(Geometry::Point(Point::new(9.87, 46.62))), "no rounding");
    }

    #[test]
    fn places_without_an_image_are_counted() {
        let dir = tempfile::tempdir().unwrap();
        let behind = r#"{"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[170,5]}}"#;
        let path = written(&dir, &collection(&format!("{PEAKS},{behind}")));
        let hemisphere = SpatialRef::from_proj4("+proj=ortho +datum=WGS84").unwrap().to_wkt().unwrap();
        let layer = read_layer(&path, None, &[], Some(&hemisphere)).unwrap();
        assert_eq!((layer.features.len(), layer.unplaced), (3, 1));
    }

    #[test]
    fn errors_name_the_file_and_list_what_is_there() {
        let dir = tempfile::tempdir().unwrap();
        let missing = dir.path().join("absent.gpkg");
        let text = read_layer(&missing, None, &[], None).unwrap_err().to_string();
        assert!(text.contains("absent.gpkg") && text.contains("no such file"), "{text}");
        let path = written(&dir, &collection(PEAKS));
        let text = read_layer(&path, Some("saddles"), &[], None).unwrap_err().to_string();
        assert!(text.contains("'saddles'") && text.contains("it has layer"), "{text}");
        let error = read_layer(&path, None, &["prominence_m"], None).unwrap_err();
        let text = error.to_string();
        assert!(text.contains("layer.geojson: layer layer: there is no field 'prominence_m'"), "{text}");
        assert!(text.contains("name, elevation_m, rank"), "{text}");
        assert_eq!(error.kind(), ErrorKind::Input);
        let text = read_layer(&path, None, &[], Some("nonsense")).unwrap_err().to_string();
        assert!(text.contains("target CRS"), "{text}");
        std::fs::write(&path, "not a layer at all").unwrap();
        let text = read_layer(&path, None, &[], None).unwrap_err().to_string();
        assert!(text.contains("cannot read vector layers"), "{text}");
    }

    #[test]
    fn listing() {
        let dir = tempfile::tempdir().unwrap();
        let path = written(&dir, &collection(PEAKS));
        let layers = list_layers(&path).unwrap();
        assert_eq!(layers.len(), 1);
        assert_eq!((layers[0].name.as_str(), layers[0].features, layers[0].has_geometry), ("layer", 3, true));
        assert_eq!(layers[0].fields, ["name", "elevation_m", "rank"]);
    }
}
