//! The files that a scene names, in the scene's CRS.

use super::resample::{CellPlaces, Cells, Kernel, cover, resample, same_in_effect};
use super::sparse;
use crate::construction::scene::{Line, LineQuery, RasterQuery, Sources, SparseSource};
use crate::crs::{Crs, CrsKind};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::{GeoTransform, HeightRows, Heights};
use crate::io::lines::read_lines;
use crate::io::raster::stored::Record;
use crate::io::raster::{RasterOptions, RasterSource, parse_crs};
use crate::io::transform::Reprojection;
use crate::pipeline::archive::{is_container, open_dem};
use crate::pipeline::memory;
use crate::units::LengthUnit;
use crate::watch::Watch;
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Bytes a cell that a raster takes while an image is made of it.
const BYTES_PER_CELL: u64 = 40;
/// Bytes a cell that the image keeps.
const KEPT_BYTES_PER_CELL: u64 = 10;
/// Cells around a part that is cropped, so that what lies between samples does not depend on it.
const MARGIN: f64 = 3.0;

/// Opens the files of a scene: paths are relative to the scene's own.
///
/// A raster whose CRS is another one than the scene's is resampled into it, by cubic splines, with cells as wide as the
/// narrower side of its own. A scene without a CRS takes that of the first raster or layer that has one.
pub(super) struct Files<'a> {
    folder: PathBuf,
    memory: Option<u64>,
    watch: &'a Watch,
    known: RefCell<Known>,
}

/// What has become known while files were opened.
#[derive(Default)]
pub(super) struct Known {
    /// The scene's CRS.
    pub(super) crs: Option<Crs>,
    /// The files, each once, in the order in which they were opened.
    pub(super) inputs: Vec<PathBuf>,
    /// What a user should know of how they were read.
    pub(super) notes: Vec<String>,
    /// The finest of the rasters that lie where they say.
    pub(super) finest: Option<Cell>,
    /// Bytes that images of them keep.
    kept_bytes: u64,
}

/// A cell of a raster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Its narrower side in metres.
    pub side_m: f64,
    /// A corner of one, in the scene's CRS.
    pub corner: [f64; 2],
}

impl Known {
    /// Keeps the finer one of what is known and a raster's cells.
    fn refine(&mut self, transform: &GeoTransform) {
        let t = &transform.0;
        let side = |x: f64, y: f64| (x * x + y * y).sqrt();
        let cell = Cell { side_m: side(t[1], t[4]).min(side(t[2], t[5])), corner: [t[0], t[3]] };
        if self.finest.is_none_or(|finest| cell.side_m < finest.side_m) {
            self.finest = Some(cell);
        }
    }
}

impl<'a> Files<'a> {
    /// Files beside `scene`, in the CRS that it names.
    ///
    /// # Errors
    /// For a CRS that PROJ does not know, or whose unit is not the metre.
    pub(super) fn new(scene: &Path, crs: Option<&str>, memory: Option<u64>, watch: &'a Watch) -> Result<Self> {
        let crs = crs.map(parse_crs).transpose().map_err(|e| Error::new(ErrorKind::Input, e.message()))?;
        if let Some(crs) = &crs {
            in_metres(crs)?;
        }
        let folder = scene.parent().map(Path::to_path_buf).unwrap_or_default();
        Ok(Self { folder, memory, watch, known: RefCell::new(Known { crs, ..Known::default() }) })
    }

    /// What has become known.
    pub(super) fn into_known(self) -> Known {
        self.known.into_inner()
    }

    /// A path of the scene as a path of this process; names that are GDAL's own stay.
    fn resolve(&self, path: &str) -> PathBuf {
        let is_gdals = path.starts_with("/vsi") || path.contains(':');
        if is_gdals { PathBuf::from(path) } else { self.folder.join(path) }
    }

    fn note(&self, text: String) {
        self.known.borrow_mut().notes.push(text);
    }

    fn opened(&self, path: &Path) {
        let inputs = &mut self.known.borrow_mut().inputs;
        if !inputs.iter().any(|known| known == path) {
            inputs.push(path.to_path_buf());
        }
    }

    fn crs(&self) -> Option<Crs> {
        self.known.borrow().crs.clone()
    }

    /// Opens a raster, or the part of it that is wanted.
    fn open(&self, path: &Path, options: RasterOptions, crop: Option<[f64; 4]>) -> Result<RasterSource> {
        // A container is decoded as it is opened.
        let Some(crop) = crop.filter(|_| !is_container(path)) else {
            return open_dem(path, &options, self.memory, self.watch);
        };
        let whole = RasterSource::open(path, &options)?;
        let corners = match (&whole.crs, self.crs()) {
            (Some(own), Some(scene)) if !same_in_effect(&places_of(&whole), own, &scene)? => {
                let steps = || (0..=16).map(|i| f64::from(i) / 16.0);
                let at = |u: f64, v: f64| (crop[0] + u * (crop[2] - crop[0]), crop[1] + v * (crop[3] - crop[1]));
                let (mut x, mut y): (Vec<f64>, Vec<f64>) = steps().flat_map(|u| steps().map(move |v| at(u, v))).unzip();
                Reprojection::new(&scene, own)?.project(&mut x, &mut y);
                x.into_iter().zip(y).filter(|(x, y)| x.is_finite() && y.is_finite()).collect()
            }
            _ => vec![(crop[0], crop[1]), (crop[0], crop[3]), (crop[2], crop[1]), (crop[2], crop[3])],
        };
        let [col, row, cols, rows] = whole.window;
        let pixels: Vec<(f64, f64)> = corners.iter().map(|&(x, y)| whole.transform.pixel(x, y)).collect();
        let range = |values: &mut dyn Iterator<Item = f64>, count: usize| {
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
            let from = (low - MARGIN).floor().clamp(0.0, count as f64) as usize;
            (from, (high + MARGIN).ceil().clamp(0.0, count as f64) as usize)
        };
        let (left, right) = range(&mut pixels.iter().map(|p| p.1), cols);
        let (top, bottom) = range(&mut pixels.iter().map(|p| p.0), rows);
        if left + 1 >= right || top + 1 >= bottom {
            return Err(Error::new(ErrorKind::Input, "nothing of it lies in crop").at_path(path));
        }
        // Rows and columns are counted from the north and the west here, in the file perhaps not.
        let in_file = |flips: bool, from: usize, to: usize, count: usize| if flips { count - to } else { from };
        let window = [
            col + in_file(whole.flips_cols, left, right, cols),
            row + in_file(whole.flips_rows, top, bottom, rows),
            right - left,
            bottom - top,
        ];
        RasterSource::open(path, &RasterOptions { window: Some(window), ..options })
    }

    /// The scene's CRS, taken from a raster or layer where the scene has none.
    fn adopt(&self, own: &Crs, middle: Option<(f64, f64)>) -> Result<Crs> {
        if let Some(crs) = self.crs() {
            return Ok(crs);
        }
        in_metres(own).map_err(|error| {
            let zone = middle.and_then(|(x, y)| own.geographic_degrees(x, y)).map_or("EPSG:32632".into(), utm);
            let message = format!(
                "{}; scenes are in metres: give this one a CRS, for example \"crs\": \"{zone}\", and files are brought into it",
                error.message()
            );
            Error::new(ErrorKind::Input, message)
        })?;
        self.known.borrow_mut().crs = Some(own.clone());
        Ok(own.clone())
    }

    fn read(&self, source: &RasterSource) -> Result<Vec<f64>> {
        let needed = self.known.borrow().kept_bytes
            + source.cells() * (BYTES_PER_CELL + source.key_bytes())
            + source.unpacked_bytes();
        let remedy = "cut the raster with crop";
        memory::admit_or(needed, self.memory.unwrap_or_else(memory::free_bytes), remedy)
            .map_err(|error| error.at_path(&source.path))?;
        let dem = source.read(self.watch)?;
        for note in &dem.notes {
            // A band is always named here, and what it says of lengths does not matter.
            if !note.contains("--band") && !note.contains("distances") {
                self.note(format!("{}: {note}", source.path.display()));
            }
        }
        if let Some(sentinel) = &dem.sentinel {
            self.note(format!("{}: {sentinel}", source.path.display()));
        }
        self.known.borrow_mut().kept_bytes += source.cells() * KEPT_BYTES_PER_CELL;
        Ok(dem.heights_m())
    }
}

impl Sources for Files<'_> {
    fn heights(&self, query: &RasterQuery<'_>) -> Result<Arc<dyn Heights>> {
        let path = self.resolve(query.path);
        let options = RasterOptions { band: Some(query.band), ..RasterOptions::default() };
        let source = self.open(&path, options, query.crop)?;
        self.opened(&path);
        let at = |error: Error| error.at_path(&path);
        let places = places_of(&source);
        if !query.is_placed || !source.is_georeferenced {
            let values = self.read(&source)?;
            return Ok(Arc::new(HeightRows::new(places.cols, values, None)));
        }
        let middle = places.transform.centre(places.rows as f64 / 2.0 - 0.5, places.cols as f64 / 2.0 - 0.5);
        let way = match (&source.crs, self.crs()) {
            (Some(own), _) => {
                let scene = self.adopt(own, Some(middle)).map_err(at)?;
                (!same_in_effect(&places, own, &scene).map_err(at)?).then(|| (own.clone(), scene))
            }
            (None, Some(scene)) => {
                let label = scene.label();
                self.note(format!("{}: it has no CRS, and is taken to be in the scene's, {label}", path.display()));
                None
            }
            (None, None) => {
                self.note(format!("{}: it has no CRS; its unit is taken to be the metre", path.display()));
                None
            }
        };
        let covered = way.as_ref().map(|(own, scene)| cover(&places, own, scene)).transpose().map_err(at)?;
        let values = self.read(&source)?;
        let (places, values) = match (covered, way) {
            (Some(covered), Some((own, scene))) => {
                let cells =
                    Cells { rows: places.rows, cols: places.cols, values: &values, transform: places.transform };
                let resampled = resample(&cells, &covered, Some((&scene, &own)), Kernel::Cubic, self.watch)?;
                let cell = covered.transform.0[1];
                let (file, own, scene) = (path.display(), own.label(), scene.label());
                self.note(format!("{file}: resampled from {own} to {scene}, in cells of {cell:.3} m"));
                (covered, resampled)
            }
            _ => (places, values),
        };
        self.known.borrow_mut().refine(&places.transform);
        Ok(Arc::new(HeightRows::new(places.cols, values, Some(places.transform))))
    }

    fn weights(&self, query: &RasterQuery<'_>, heights: &dyn Heights) -> Result<Arc<dyn Heights>> {
        let path = self.resolve(query.path);
        // Weights have no unit, whatever the file says: metres stay as they are.
        let vertical_unit = Some(LengthUnit::metre());
        let options = RasterOptions { band: Some(query.band), vertical_unit, ..RasterOptions::default() };
        let source = self.open(&path, options, query.crop)?;
        self.opened(&path);
        let at = |error: Error| error.at_path(&path);
        let values = self.read(&source)?;
        let own = places_of(&source);
        let Some(transform) = heights.georeference().filter(|_| query.is_placed && source.is_georeferenced) else {
            return Ok(Arc::new(HeightRows::new(own.cols, values, None)));
        };
        let places = CellPlaces { rows: heights.rows(), cols: heights.cols(), transform };
        let way = match (&source.crs, self.crs()) {
            (Some(crs), Some(scene)) if !same_in_effect(&own, crs, &scene).map_err(at)? => Some((scene, crs.clone())),
            _ => None,
        };
        if way.is_none() && own == places {
            return Ok(Arc::new(HeightRows::new(own.cols, values, Some(transform))));
        }
        let cells = Cells { rows: own.rows, cols: own.cols, values: &values, transform: own.transform };
        let way = way.as_ref().map(|(scene, own)| (scene, own));
        let values = resample(&cells, &places, way, Kernel::Linear, self.watch)?;
        Ok(Arc::new(HeightRows::new(places.cols, values, Some(transform))))
    }

    fn sparse(&self, path: &str) -> Result<SparseSource> {
        let path = self.resolve(path);
        let source = sparse::open(&path)?;
        self.opened(&path);
        let at = |error: Error| error.at_path(&path);
        let Record { width, height, bands, transform, crs, .. } = &source.record;
        let Some(transform) = *transform else {
            return Err(at(Error::new(ErrorKind::Input, "it does not say where its cells are")));
        };
        let places = CellPlaces { rows: *height, cols: *width, transform };
        if let Some(wkt) = crs {
            let own = parse_crs(wkt).map_err(at)?;
            let middle = transform.centre(*height as f64 / 2.0, *width as f64 / 2.0);
            let scene = self.adopt(&own, Some(middle)).map_err(at)?;
            if !same_in_effect(&places, &own, &scene).map_err(at)? {
                let message = format!(
                    "its CRS is {}, and the scene's is {}; discs are not resampled: give it to an image, as its heights",
                    own.label(),
                    scene.label()
                );
                return Err(at(Error::new(ErrorKind::Unsupported, message)));
            }
        }
        // A container has at least one band.
        let band = &bands[0];
        let unit = match band.unit.trim() {
            "" => LengthUnit::metre(),
            name => LengthUnit::from_name(name).ok_or_else(|| {
                at(Error::new(ErrorKind::Unsupported, format!("its unit '{name}' is not a length that is known")))
            })?,
        };
        let (scale, offset) = (band.scale.unwrap_or(1.0), band.offset.unwrap_or(0.0));
        self.known.borrow_mut().refine(&transform);
        Ok(SparseSource {
            terrain: sparse::read(&source)?,
            places: transform,
            scale_m: scale * unit.metres,
            offset_m: offset * unit.metres,
        })
    }

    fn lines(&self, query: &LineQuery<'_>) -> Result<Vec<Line>> {
        let path = self.resolve(query.path);
        let scene = self.crs();
        let mut found = read_lines(&path, query.layer, query.filter, scene.as_ref().map(|crs| crs.wkt.as_str()))?;
        self.opened(&path);
        if let (None, Some(wkt)) = (&scene, &found.crs_wkt) {
            let own = parse_crs(wkt)?;
            let middle = found.lines.first().and_then(|line| line.points.first()).map(|p| (p[0], p[1]));
            self.adopt(&own, middle).map_err(|error| error.at_path(&path))?;
        }
        if !found.has_crs && scene.is_some() {
            self.note(format!("{}: the layer has no CRS, and is taken to be in the scene's", path.display()));
        }
        if found.unplaced > 0 {
            let n = found.unplaced;
            self.note(format!("{}: {n} lines have no place in the scene's CRS and are left out", path.display()));
        }
        let line = |line: crate::io::lines::LineFeature| Line {
            points: line.points,
            fields: line.numbers.into_iter().collect(),
        };
        Ok(found.lines.drain(..).map(line).collect())
    }
}

/// Where the cells of a raster are that is read.
pub(super) fn places_of(source: &RasterSource) -> CellPlaces {
    let [_, _, cols, rows] = source.window;
    CellPlaces { rows, cols, transform: source.transform }
}

/// Refuses a CRS whose unit is not the metre.
fn in_metres(crs: &Crs) -> Result<()> {
    let unit = match &crs.kind {
        CrsKind::Projected { metres, .. } | CrsKind::Local { metres } if *metres == 1.0 => return Ok(()),
        CrsKind::Projected { metres, .. } | CrsKind::Local { metres } => format!("units of {metres} m"),
        CrsKind::Geographic { .. } => "longitudes and latitudes".into(),
    };
    Err(Error::new(
        ErrorKind::Input,
        format!("the CRS {} has {unit}, and a scene is in metres: choose a projected CRS in metres", crs.label()),
    ))
}

/// The zone of UTM of a longitude and latitude.
fn utm((lon, lat): (f64, f64)) -> String {
    let zone = (((lon + 180.0) / 6.0).floor() as i64).clamp(0, 59) + 1;
    format!("EPSG:{}", if lat < 0.0 { 32700 } else { 32600 } + zone)
}

/// The transform of the cells of a lattice of so many metres whose north-western corner is at a place.
pub(super) fn north_up([x, y]: [f64; 2], cell_m: f64) -> GeoTransform {
    GeoTransform([x, cell_m, 0.0, y, 0.0, -cell_m])
}
