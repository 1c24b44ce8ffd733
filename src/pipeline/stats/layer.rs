//! The statistics of a layer of peaks: read its rows and count them.

use super::super::regions::Regions;
use super::super::surveying::own_geographic;
use super::super::tags::TagLayer;
use super::input::PeaksFile;
use super::job::StatsJob;
use crate::crs::{Crs, CrsKind, ToGeographic};
use crate::error::{Error, ErrorKind, Result};
use crate::io::features::{Feature, Layer, Value, metadata_item, read_layer};
use crate::io::raster::parse_crs;
use crate::orometry::distributions::{
    Definitions, Domain, Input, InputKind, PeakMeasures, Selection, StatsDocument, region_names,
};
use crate::units::parse_length_m;
use geo::Geometry;

/// The peaks of a layer, read.
pub(in super::super) struct LayerPeaks {
    /// Those that have an elevation and a prominence.
    pub(in super::super) peaks: Vec<PeakMeasures>,
    /// The CRS of the layer, or the one that was assigned to a layer without.
    pub(in super::super) crs: Option<Crs>,
    /// The least prominence in metres that the peaks were chosen by, where that is known.
    pub(in super::super) threshold_m: Option<f64>,
}

impl LayerPeaks {
    /// Reads a layer; peaks below `min_prominence_m` are left out, and `crs` is that of a layer without one.
    ///
    /// # Errors
    /// When it cannot be read, or its CRS is none.
    pub(in super::super) fn read(
        file: &PeaksFile,
        crs: Option<&str>,
        min_prominence_m: Option<f64>,
        note: &mut dyn FnMut(String),
    ) -> Result<Self> {
        let wanted = fields(file.unit.0);
        let is_there = |field: &&str| file.layer.fields.iter().any(|name| name == field);
        let there: Vec<&str> = wanted.iter().map(String::as_str).filter(is_there).collect();
        let layer = read_layer(&file.path, Some(&file.layer.name), &there, None)?;
        let crs = layer.crs_wkt.as_deref().or(crs).map(parse_crs).transpose()?;
        let mut peaks = Rows { layer: &layer, unit: file.unit }.read(note, file);
        let own_threshold_m = threshold_m(file)?;
        if let Some(least_m) = min_prominence_m {
            if own_threshold_m.is_some_and(|own_m| own_m > least_m) {
                note(format!(
                    "{}: its peaks have a prominence of {} m or more; it knows none between that and {least_m} m",
                    file.path.display(),
                    own_threshold_m.unwrap_or_default()
                ));
            }
            peaks.retain(|peak| peak.prominence_m >= least_m);
        }
        let threshold_m = match (min_prominence_m, own_threshold_m) {
            (Some(given_m), Some(own_m)) => Some(given_m.max(own_m)),
            (given_m, own_m) => given_m.or(own_m),
        };
        Ok(Self { peaks, crs, threshold_m })
    }
}

/// Measures a layer of peaks.
pub(super) fn measure(job: &StatsJob, file: &PeaksFile, note: &mut dyn FnMut(String)) -> Result<StatsDocument> {
    let read = LayerPeaks::read(file, job.raster.crs.as_deref(), job.min_prominence_m, note)?;
    let LayerPeaks { peaks: mut rows, crs, threshold_m } = read;
    if crs.is_none() && !job.disks.is_empty() && rows.iter().any(|peak| peak.lon.is_some()) {
        return Err(Error::usage("--disk: the layer does not say in which CRS its peaks are: assign it with --crs")
            .at_path(&file.path));
    }
    place(&mut rows, crs.as_ref())?;
    let mut selections = vec![Selection::Whole];
    selections.extend(tag(job.regions.as_ref(), crs.as_ref(), &mut rows, note)?.into_iter().map(Selection::Region));
    selections.extend(job.disks(crs.as_ref())?);
    let domains = selections
        .iter()
        .map(|selection| Domain::measure(selection, &rows, job.radius_m(), None, None))
        .collect::<Result<Vec<_>>>()?;
    let input = Input {
        path: file.path.display().to_string(),
        kind: InputKind::Peaks,
        crs: crs.map(|crs| crs.label().to_string()),
    };
    Ok(StatsDocument::new(input, Definitions::new(threshold_m, job.radius_m()), domains))
}

/// The names of the fields that are read, where lengths are in a unit.
fn fields(unit: &str) -> Vec<String> {
    let lengths = ["elevation", "prominence", "saddle_distance", "isolation"].map(|name| format!("{name}_{unit}"));
    let others = [
        "prominence_certain",
        "saddle_azimuth",
        "isolation_azimuth",
        "isolation_certain",
        "region",
        "x",
        "y",
        "lon",
        "lat",
    ];
    lengths.into_iter().chain(others.map(str::to_string)).collect()
}

/// The least prominence in metres that the layer's peaks were chosen by, where the file tells.
fn threshold_m(file: &PeaksFile) -> Result<Option<f64>> {
    let command = metadata_item(&file.path, "OROGRAPH_COMMAND")?.unwrap_or_default();
    let mut words = command.split(' ').skip_while(|word| *word != "--min-prominence").skip(1);
    Ok(words.next().and_then(|word| parse_length_m(word).ok()))
}

/// The rows of a layer of peaks.
struct Rows<'a> {
    layer: &'a Layer,
    unit: (&'static str, f64),
}

impl Rows<'_> {
    /// The measures of all peaks that have an elevation and a prominence.
    fn read(&self, note: &mut dyn FnMut(String), file: &PeaksFile) -> Vec<PeakMeasures> {
        let rows: Vec<PeakMeasures> = self.layer.features.iter().filter_map(|feature| self.peak(feature)).collect();
        let lost = self.layer.features.len() - rows.len() + self.layer.unplaced;
        if lost > 0 {
            note(format!("{}: left out rows without an elevation or a prominence: {lost}", file.path.display()));
        }
        rows
    }

    fn peak(&self, feature: &Feature) -> Option<PeakMeasures> {
        let value = |name: &str| feature.values.get(self.layer.field(name)?);
        let number = |name: &str| value(name).and_then(number);
        let length_m = |name: &str| number(&format!("{name}_{}", self.unit.0)).map(|length| length * self.unit.1);
        let point = match &feature.geometry {
            Some(Geometry::Point(point)) => Some(point.x_y()),
            _ => None,
        };
        let (x, y) = number("x").zip(number("y")).or(point).unwrap_or((f64::NAN, f64::NAN));
        let (lon, lat) = number("lon").zip(number("lat")).unzip();
        Some(PeakMeasures {
            x,
            y,
            lon,
            lat,
            region: value("region").and_then(Value::text).map(str::to_string),
            elevation_m: length_m("elevation")?,
            prominence_m: length_m("prominence")?,
            prominence_certain: value("prominence_certain").is_some_and(is_true),
            saddle_distance_m: length_m("saddle_distance"),
            saddle_azimuth: number("saddle_azimuth"),
            isolation_m: length_m("isolation"),
            isolation_azimuth: number("isolation_azimuth"),
            isolation_certain: value("isolation_certain").is_some_and(is_true),
        })
    }
}

/// The number that a value is, or that its text stands for: in CSV all is text.
fn number(value: &Value) -> Option<f64> {
    let number = match value {
        Value::Null => None,
        Value::Number(number) => Some(*number),
        Value::Text(text) => text.trim().parse().ok(),
    };
    number.filter(|number| number.is_finite())
}

fn is_true(value: &Value) -> bool {
    match value {
        Value::Null => false,
        Value::Number(number) => *number != 0.0,
        Value::Text(text) => matches!(text.trim().to_ascii_lowercase().as_str(), "true" | "t" | "yes" | "1"),
    }
}

/// Gives longitudes and latitudes to the peaks of a layer that has none, where its CRS does.
pub(in super::super) fn place(peaks: &mut [PeakMeasures], crs: Option<&Crs>) -> Result<()> {
    let Some(crs) = crs.filter(|_| peaks.iter().any(|peak| peak.lon.is_none())) else { return Ok(()) };
    let (mut lon, mut lat): (Vec<f64>, Vec<f64>) = match crs.kind {
        CrsKind::Geographic { degrees, .. } => peaks.iter().map(|peak| (peak.x * degrees, peak.y * degrees)).unzip(),
        CrsKind::Projected { .. } => peaks.iter().map(|peak| (peak.x, peak.y)).unzip(),
        CrsKind::Local { .. } => return Ok(()),
    };
    if let Some(to_geographic) = own_geographic(Some(crs))? {
        to_geographic.to_geographic(&mut lon, &mut lat);
    }
    for (peak, (lon, lat)) in peaks.iter_mut().zip(lon.into_iter().zip(lat)) {
        if lon.is_finite() && lat.is_finite() {
            (peak.lon, peak.lat) = (Some(lon), Some(lat));
        }
    }
    Ok(())
}

/// Tags the peaks with the regions that were asked for, else leaves them those that they have; returns the names of
/// the regions that peaks stand in.
pub(in super::super) fn tag(
    wanted: Option<&TagLayer>,
    crs: Option<&Crs>,
    peaks: &mut [PeakMeasures],
    note: &mut dyn FnMut(String),
) -> Result<Vec<String>> {
    let Some(wanted) = wanted else { return Ok(region_names(peaks)) };
    let regions = Regions::read(wanted, crs, note)?;
    if peaks.iter().any(|peak| !(peak.x.is_finite() && peak.y.is_finite())) {
        return Err(Error::new(
            ErrorKind::Input,
            "peaks without a place stand in no region: they have neither points nor x and y",
        ));
    }
    let points: Vec<(f64, f64)> = peaks.iter().map(|peak| (peak.x, peak.y)).collect();
    let found = regions.tag(&points, &|i| format!("the peak at {}, {}", points[i].0, points[i].1), note);
    let found: Vec<Option<String>> = found.into_iter().map(|name| name.map(str::to_string)).collect();
    peaks.iter_mut().zip(found).for_each(|(peak, name)| peak.region = name);
    let there = region_names(peaks);
    let names: Vec<String> = regions.names().into_iter().map(str::to_string).collect();
    let empty = names.iter().filter(|name| !there.contains(name)).count();
    if empty > 0 {
        note(format!("regions without a peak, left out: {empty}"));
    }
    Ok(names.into_iter().filter(|name| there.contains(name)).collect())
}
