//! A range to be like: a DEM, a layer of peaks, or a statistics file.

use super::super::metric::{Distance, cell_m, metric_of, metric_on};
use super::super::stats::{InputFile, LayerPeaks, PeaksFile, Reading};
use super::super::surveying::{Surveying, own_geographic};
use crate::crs::{Crs, Metric, Place};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::GeoTransform;
use crate::io::raster::{RasterOptions, RasterSource};
use crate::orometry::distributions::{DEFAULT_RADIUS_M, Domain, PeakMeasures, Selection};
use crate::orometry::{SurveyOptions, peak_isolations};
use crate::synthesis::terrain::Likeness;
use crate::synthesis::{Extent, Target};
use crate::watch::Watch;
use std::path::Path;

/// A range, measured.
pub(super) struct Range {
    /// Its statistics; isolations of what was measured here are those to the nearest higher peak.
    pub(super) domain: Domain,
    /// What its distances are divided by, in metres.
    pub(super) radius_m: f64,
    /// Least prominence in metres of its peaks, where that is known.
    pub(super) threshold_m: Option<f64>,
    /// What synthesis takes of it.
    pub(super) target: Target,
    /// Where it is, unless it is a statistics file.
    pub(super) place: Option<RangePlace>,
    /// How steep it is, where it is a DEM and that was asked for.
    pub(super) likeness: Option<Likeness>,
}

/// Where a range is.
pub(super) struct RangePlace {
    /// The CRS of its coordinates.
    pub(super) crs: Option<Crs>,
    /// Least x, least y, greatest x, greatest y.
    pub(super) bbox: [f64; 4],
}

/// How to read ranges.
#[derive(Clone, Copy)]
pub(super) struct RangeOptions<'a> {
    /// Least prominence in metres of the peaks that count; 30 m for a DEM unless given.
    pub(super) min_prominence_m: Option<f64>,
    /// Name of the layer of peaks, where a file has several.
    pub(super) layer: Option<&'a str>,
    /// The domain of a statistics file; its first unless given.
    pub(super) domain: Option<&'a str>,
    /// Bytes of memory that may be used.
    pub(super) memory: Option<u64>,
    /// Least side in metres of the cells on which likeness is measured, if it is.
    pub(super) likeness_side_m: Option<f64>,
}

/// Rows or columns, whichever are more, of the raster that the peaks of a layer are put on to be measured.
const LAYER_CELLS: f64 = 16384.0;

impl RangeOptions<'_> {
    /// Reads a range, and measures it where it is no statistics file.
    ///
    /// # Errors
    /// What is wrong with the file; a range without peaks.
    pub(super) fn read(&self, path: &Path, watch: &Watch, note: &mut dyn FnMut(String)) -> Result<Range> {
        let raster = RasterOptions::default();
        let reading = Reading { raster: &raster, layer: self.layer, memory: self.memory };
        let range = match InputFile::open(path, &reading, watch)? {
            InputFile::Dem(source) => self.dem(&source, watch, note),
            InputFile::Peaks(file) => self.layer(&file, note),
            InputFile::Document(document) => {
                let radius_m = document.definitions.radius_m;
                let threshold_m = document.definitions.prominence_threshold_m;
                document.domain(self.domain).and_then(|domain| Range::of(domain.clone(), radius_m, threshold_m, None))
            }
        };
        range.map_err(|error| error.at_path(path))
    }

    fn dem(&self, source: &RasterSource, watch: &Watch, note: &mut dyn FnMut(String)) -> Result<Range> {
        let threshold_m = self.min_prominence_m.unwrap_or(SurveyOptions::default().min_prominence_m);
        let options = SurveyOptions {
            min_prominence_m: threshold_m,
            isolation: false,
            ridges: false,
            ..SurveyOptions::default()
        };
        let surveying = Surveying { options: &options, distance: Distance::Crs, memory: self.memory };
        surveying.admit(source)?;
        let surveyed = surveying.run(source, watch, note)?;
        let dem = &surveyed.dem;
        let size = (dem.grid.rows(), dem.grid.cols());
        let metric = metric_of(dem, Distance::Crs, surveyed.to_geographic.as_ref())?;
        let place = |cell: u64| ((cell / size.1 as u64) as i64, (cell % size.1 as u64) as i64);
        let places: Vec<Place> = surveyed.survey.peaks.iter().map(|peak| place(peak.cell)).collect();
        let mut peaks: Vec<PeakMeasures> = surveyed.survey.peaks.iter().map(PeakMeasures::from).collect();
        let rises_m = isolate(&mut peaks, &places, size, &metric);
        let cells = dem.extremes.map_or(0, |extremes| extremes.cells);
        let filled = cells as f64 / (size.0 as f64 * size.1 as f64);
        let area_km2 = Extent::new(size.0, size.1, &metric).area_km2() * filled;
        let corners = [(0, 0), (0, size.1), (size.0, 0), size].map(|(row, col)| corner(&dem.transform, row, col));
        let place = RangePlace { crs: dem.crs.clone(), bbox: bounds(corners.into_iter()) };
        let likeness = self
            .likeness_side_m
            .map(|side_m| Likeness::of(&dem.heights_m(), [size.0, size.1], cell_m(size.0, &metric), side_m));
        let range = Range::measured(&peaks, rises_m, area_km2, Some(threshold_m), place)?;
        Ok(Range { likeness, ..range })
    }

    fn layer(&self, file: &PeaksFile, note: &mut dyn FnMut(String)) -> Result<Range> {
        let LayerPeaks { mut peaks, crs, threshold_m } = LayerPeaks::read(file, None, self.min_prominence_m, note)?;
        let before = peaks.len();
        peaks.retain(|peak| peak.x.is_finite() && peak.y.is_finite());
        if peaks.len() < before {
            note(format!("left out peaks without a place: {}", before - peaks.len()));
        }
        if peaks.is_empty() {
            return Err(Error::new(ErrorKind::Input, "the layer holds no peaks: there is nothing to be like"));
        }
        let bbox = bounds(peaks.iter().map(|peak| (peak.x, peak.y)));
        let [width, height] = [bbox[2] - bbox[0], bbox[3] - bbox[1]];
        let cell = if width.max(height) > 0.0 { width.max(height) / LAYER_CELLS } else { 1.0 };
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "so many cells and one more at most"
        )]
        let [cols, rows] = [width, height].map(|length| (length / cell).ceil() as usize + 1);
        let transform = GeoTransform([bbox[0] - cell / 2.0, cell, 0.0, bbox[3] + cell / 2.0, 0.0, -cell]);
        let to_geographic = own_geographic(crs.as_ref())?;
        let metric = metric_on(&transform, (rows, cols), false, crs.as_ref(), Distance::Crs, to_geographic.as_ref())?;
        #[allow(clippy::cast_possible_truncation, reason = "inside of the raster")]
        let place = |peak: &PeakMeasures| {
            let (row, col) = transform.pixel(peak.x, peak.y);
            ((row.floor() as i64).clamp(0, rows as i64 - 1), (col.floor() as i64).clamp(0, cols as i64 - 1))
        };
        let places: Vec<Place> = peaks.iter().map(place).collect();
        let rises_m = isolate(&mut peaks, &places, (rows, cols), &metric);
        let area_km2 = Extent::new(rows, cols, &metric).area_km2();
        // A layer that does not tell by what its peaks were chosen shows it.
        let least_m = peaks.iter().map(|peak| peak.prominence_m).fold(f64::INFINITY, f64::min);
        let threshold_m = threshold_m.or(Some(least_m).filter(|m| m.is_finite()));
        Range::measured(&peaks, rises_m, area_km2, threshold_m, RangePlace { crs, bbox })
    }
}

impl Range {
    fn of(domain: Domain, radius_m: f64, threshold_m: Option<f64>, place: Option<RangePlace>) -> Result<Self> {
        let target = Target::of(&domain, radius_m, threshold_m)?;
        Ok(Self { domain, radius_m, threshold_m, target, place, likeness: None })
    }

    fn measured(
        peaks: &[PeakMeasures],
        rises_m: Vec<(f64, f64)>,
        area_km2: f64,
        threshold_m: Option<f64>,
        place: RangePlace,
    ) -> Result<Self> {
        let domain = Domain::measure(&Selection::Whole, peaks, DEFAULT_RADIUS_M, None, Some(area_km2))?;
        let range = Self::of(domain, DEFAULT_RADIUS_M, threshold_m, Some(place))?;
        Ok(Self { target: range.target.with_rises(rises_m), ..range })
    }
}

/// Puts the distance and direction of the nearest higher peak in place of those of higher ground; returns that distance, and
/// by how much that peak is higher, in metres.
fn isolate<M: Metric>(
    peaks: &mut [PeakMeasures],
    places: &[Place],
    size: (usize, usize),
    metric: &M,
) -> Vec<(f64, f64)> {
    let mut rises_m = vec![];
    let seen: Vec<(Place, f64)> = places.iter().zip(&*peaks).map(|(&place, peak)| (place, peak.elevation_m)).collect();
    for (i, nearest) in peak_isolations(size, metric, &seen).into_iter().enumerate() {
        let vector = nearest.map(|(_, higher)| metric.vector(places[i], places[higher]));
        let rise_m = |higher: usize| seen[higher].1 - seen[i].1;
        rises_m.extend(nearest.map(|(isolation_m, higher)| (isolation_m, rise_m(higher))));
        peaks[i].isolation_m = nearest.map(|(isolation_m, _)| isolation_m);
        peaks[i].isolation_azimuth = vector.map(|vector| vector.azimuth).filter(|azimuth| azimuth.is_finite());
    }
    rises_m
}

/// Coordinates of the corner of a cell.
fn corner(transform: &GeoTransform, row: usize, col: usize) -> (f64, f64) {
    transform.centre(row as f64 - 0.5, col as f64 - 0.5)
}

fn bounds(points: impl Iterator<Item = (f64, f64)>) -> [f64; 4] {
    let nothing = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    points.fold(nothing, |b, (x, y)| [b[0].min(x), b[1].min(y), b[2].max(x), b[3].max(y)])
}
