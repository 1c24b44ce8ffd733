//! The statistics file, `stats.json`, as `format-spec/stats.md` describes it.

use super::domain::Domain;
use super::layout::Layout;
use crate::error::{Error, ErrorKind, Result};
use serde::{Deserialize, Serialize};

/// Value of `format`.
pub const STATS_FORMAT: &str = "orograph-stats";
/// Value of `version`: the version of the format that this program writes, and the only one that it reads.
pub const STATS_VERSION: u32 = 1;
/// The radius R in metres unless another is given (the best trade-off in Argudo et al. 2019, section 4.2).
pub const DEFAULT_RADIUS_M: f64 = 30_000.0;

/// A statistics file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StatsDocument {
    /// Always [`STATS_FORMAT`].
    pub format: String,
    /// Always [`STATS_VERSION`].
    pub version: u32,
    /// Name and version of the program that wrote the file.
    pub program: String,
    /// What was measured.
    pub input: Input,
    /// Under which definitions.
    pub definitions: Definitions,
    /// The domains: the whole first, where it is there, then regions and disks in the order asked for.
    pub domains: Vec<Domain>,
}

/// What a document's numbers were measured on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Path as it was given.
    pub path: String,
    /// DEM or peaks.
    pub kind: InputKind,
    /// Authority and code of the CRS, or its name; `None` without a CRS.
    pub crs: Option<String>,
}

/// Kind of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InputKind {
    /// A raster of elevations: there are statistics of the terrain.
    Dem,
    /// A layer of peaks.
    Peaks,
}

/// The definitions that numbers depend on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Definitions {
    /// Least prominence of a peak in metres; `None` where it is not known.
    pub prominence_threshold_m: Option<f64>,
    /// The radius R in metres that distances are divided by.
    pub radius_m: f64,
    /// What normalised elevation is: `range`, `(h - min h) / (max h - min h)` over the domain's peaks.
    pub normalised_elevation: String,
    /// What relative elevation, prominence and relevance are relative to: `domain`, the domain's peaks.
    pub relative_to: String,
    /// What directions are: `clockwise_from_north`.
    pub directions: String,
    /// How slopes are computed: `horn`.
    pub slope: String,
}

impl Definitions {
    /// The definitions of this program.
    pub fn new(prominence_threshold_m: Option<f64>, radius_m: f64) -> Self {
        Self {
            prominence_threshold_m,
            radius_m,
            normalised_elevation: "range".into(),
            relative_to: "domain".into(),
            directions: "clockwise_from_north".into(),
            slope: "horn".into(),
        }
    }
}

/// What must be right before anything else is looked at.
#[derive(Deserialize)]
struct Head {
    format: Option<String>,
    version: Option<serde_json::Value>,
}

impl StatsDocument {
    /// A document of this program's making.
    pub fn new(input: Input, definitions: Definitions, domains: Vec<Domain>) -> Self {
        Self {
            format: STATS_FORMAT.into(),
            version: STATS_VERSION,
            program: concat!("orograph ", env!("CARGO_PKG_VERSION")).into(),
            input,
            definitions,
            domains,
        }
    }

    /// Reads a document.
    ///
    /// Counts may have been edited: they need not add up to the peaks ([`Domain::check_sums`] tells). Fields that are
    /// not known are ignored.
    ///
    /// # Errors
    /// `Input` when the text is no statistics file, `Unsupported` for another version, `Corrupt` when a field is
    /// missing, edges do not increase, or lists have the wrong length.
    pub fn from_json(text: &str) -> Result<Self> {
        let input = |message: String| Error::new(ErrorKind::Input, message);
        let head: Head = serde_json::from_str(text).map_err(|e| input(format!("not a statistics file: {e}")))?;
        if head.format.as_deref() != Some(STATS_FORMAT) {
            let found = head.format.map_or("no \"format\"".into(), |f| format!("\"format\": \"{f}\""));
            return Err(input(format!(
                "not a statistics file: expected \"format\": \"{STATS_FORMAT}\", found {found}"
            )));
        }
        let version = head.version.unwrap_or_default();
        if version.as_u64() != Some(u64::from(STATS_VERSION)) {
            return Err(Error::new(
                ErrorKind::Unsupported,
                format!(
                    "statistics of version {version}: this program reads version {STATS_VERSION}; measure them anew"
                ),
            ));
        }
        let document: Self = serde_json::from_str(text)
            .map_err(|e| Error::new(ErrorKind::Corrupt, format!("broken statistics: {e}")))?;
        document.check()?;
        Ok(document)
    }

    /// The document as text: fields in the order of the specification, lists of numbers on one line.
    pub fn to_json(&self) -> String {
        Layout::write(self)
    }

    /// Checks everything that a reader relies on.
    ///
    /// # Errors
    /// Names the domain and the histogram with its fault.
    pub fn check(&self) -> Result<()> {
        let corrupt = |message: String, place: &str| Err(Error::new(ErrorKind::Corrupt, message).at_place(place));
        let radius_m = self.definitions.radius_m;
        if !(radius_m.is_finite() && radius_m > 0.0) {
            return corrupt(format!("the radius is {radius_m}: expected a positive number"), "definitions.radius_m");
        }
        if self.domains.is_empty() {
            return corrupt("there is no domain".into(), "domains");
        }
        for (i, domain) in self.domains.iter().enumerate() {
            let place = format!("domain '{}'", domain.name);
            if self.domains[..i].iter().any(|d| d.name == domain.name) {
                return corrupt("two domains have this name".into(), &place);
            }
            domain.check().map_err(|e| {
                let inner = e.place().map_or(String::new(), |p| format!(", {p}"));
                Error::new(e.kind(), e.message()).at_place(format!("{place}{inner}"))
            })?;
        }
        Ok(())
    }

    /// The domain of a name, or the first where none is given.
    ///
    /// # Errors
    /// A usage error that lists the names there are.
    pub fn domain(&self, name: Option<&str>) -> Result<&Domain> {
        let found = match name {
            Some(name) => self.domains.iter().find(|d| d.name == name),
            None => self.domains.first(),
        };
        found.ok_or_else(|| {
            let names: Vec<&str> = self.domains.iter().map(|d| d.name.as_str()).collect();
            Error::usage(format!("no domain is called '{}': {}", name.unwrap_or_default(), names.join(", ")))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CellSet, CellShape, Disk, PeakMeasures, Selection, measure_terrain};
    use super::*;
    use crate::grid::{AnyGrid, Elevations, GeoTransform, Grid, SampleType};
    use crate::watch::Watch;

    /// A document with a whole of 40 peaks, a disk, and terrain.
    pub(crate) fn sample() -> StatsDocument {
        let peak = |i: u32| {
            let part = f64::from(i) / 40.0;
            PeakMeasures {
                x: f64::from(i * 7 % 40),
                y: f64::from(i * 11 % 40),
                elevation_m: 900.0 + 3100.0 * part,
                prominence_m: if i == 39 { 3922.5 } else { 30.0 + 1900.0 * part.powi(4) },
                prominence_certain: i.is_multiple_of(3),
                saddle_distance_m: (i < 39).then_some(100.0 + 9000.0 * part),
                saddle_azimuth: (i < 39).then_some(359.0 * part),
                isolation_m: (i < 39).then_some(150.0 + 50_000.0 * part * part),
                isolation_azimuth: (i < 39).then_some(300.0 * part),
                isolation_certain: i.is_multiple_of(4),
                ..PeakMeasures::default()
            }
        };
        let peaks: Vec<PeakMeasures> = (0..40).map(peak).collect();
        let t = GeoTransform([0.0, 1.0, 0.0, 40.0, 0.0, -1.0]);
        let cells = (0..1600).map(|i: i32| ((i % 40) * (i / 40) - 30) as i16).collect();
        let grid = AnyGrid::Narrow(Grid::new(40, 40, false, cells));
        let shape = CellShape::new(None, &t, 40).unwrap();
        let disk = Disk::planar(20.0, 20.0, 9.0, 1.0);
        let sets = [CellSet::whole(40, 40), CellSet::disk(&disk, None, &t, (40, 40), None).unwrap()];
        let elevations = Elevations::metres(SampleType::I16);
        let mut terrain = measure_terrain(&grid, &elevations, &shape, &sets, &Watch::default()).unwrap().into_iter();
        let domains = [Selection::Whole, Selection::Disk("20,20,9m".into(), disk)]
            .iter()
            .map(|selection| Domain::measure(selection, &peaks, 30_000.0, terrain.next(), None).unwrap())
            .collect();
        let input = Input { path: "alps.tif".into(), kind: InputKind::Dem, crs: None };
        StatsDocument::new(input, Definitions::new(Some(30.0), DEFAULT_RADIUS_M), domains)
    }

    #[test]
    fn there_and_back() {
        let document = sample();
        document.check().unwrap();
        document.domains.iter().for_each(|d| d.check_sums().unwrap());
        let text = document.to_json();
        let back = StatsDocument::from_json(&text).unwrap();
        assert_eq!(back, document);
        assert_eq!(back.to_json(), text);
        assert!(text.starts_with("{\n  \"format\": \"orograph-stats\",\n  \"version\": 1,\n  \"program\": "), "{text}");
        assert!(text.contains("\"edges\": [0.0, 30.0, 60.0, 90.0, "), "lists of numbers on one line");
        // To hold a document against the schema: set OROGRAPH_STATS_SAMPLE=/tmp/sample.json, run this test, then
        // python -m jsonschema -i /tmp/sample.json format-spec/stats.schema.json (or the like) must be silent.
        if let Some(path) = std::env::var_os("OROGRAPH_STATS_SAMPLE") {
            std::fs::write(path, text).unwrap();
        }
    }

    #[test]
    fn the_fields_are_those_of_the_specification() {
        let written: serde_json::Value = serde_json::from_str(&sample().to_json()).unwrap();
        let schema = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/format-spec/stats.schema.json"));
        let schema: serde_json::Value = serde_json::from_str(schema).unwrap();
        let keys = |value: &serde_json::Value| -> Vec<String> { value.as_object().unwrap().keys().cloned().collect() };
        let domain = &written["domains"][1];
        for (found, described) in [
            (&written, &schema),
            (&written["definitions"], &schema["$defs"]["definitions"]),
            (&written["input"], &schema["$defs"]["input"]),
            (domain, &schema["$defs"]["domain"]),
            (&domain["disk"], &schema["$defs"]["disk"]),
            (&domain["extremes"], &schema["$defs"]["extremes"]),
            (&domain["metrics"], &schema["$defs"]["metrics"]),
            (&domain["metrics"]["dominance"], &schema["$defs"]["statistics"]),
            (&domain["metrics"]["dominance"]["fine"], &schema["$defs"]["histogram"]),
            (&domain["prominence_classes"][0], &schema["$defs"]["prominence_class"]),
            (&domain["prominence_classes"][0]["metrics"], &schema["$defs"]["histograms"]),
            (&domain["terrain"], &schema["$defs"]["terrain"]),
            (&domain["terrain"]["slope"], &schema["$defs"]["area_histogram"]),
        ] {
            assert_eq!(keys(found), keys(&described["properties"]));
        }
    }

    #[test]
    fn faults_are_told_apart() {
        let text = sample().to_json();
        let changed = |from: &str, to: &str| StatsDocument::from_json(&text.replacen(from, to, 1)).unwrap_err();
        let cases = [
            (StatsDocument::from_json("").unwrap_err(), ErrorKind::Input, "not a statistics file"),
            (StatsDocument::from_json("[1]").unwrap_err(), ErrorKind::Input, "not a statistics file"),
            (StatsDocument::from_json("{}").unwrap_err(), ErrorKind::Input, "no \"format\""),
            (changed("orograph-stats", "GeoJSON"), ErrorKind::Input, "found \"format\": \"GeoJSON\""),
            (
                changed("\"version\": 1", "\"version\": 2"),
                ErrorKind::Unsupported,
                "version 2: this program reads version 1",
            ),
            (changed("\"radius_m\": 30000.0", "\"radius_m\": 0.0"), ErrorKind::Corrupt, "radius"),
            (changed("\"dominance\"", "\"domminance\""), ErrorKind::Corrupt, "metric dominance is missing"),
            (changed("\"peak_count\": 40,", ""), ErrorKind::Corrupt, "peak_count"),
            (changed("0.05, 0.1, ", "0.1, 0.05, "), ErrorKind::Corrupt, "edges must increase"),
            (changed("[0.0, 30.0, ", "[1.0, 30.0, "), ErrorKind::Corrupt, "from 0 to 360"),
            (changed("\"20,20,9m\"", "\"whole\""), ErrorKind::Corrupt, "two domains"),
            (changed("\"domains\": [", "\"domains\": [], \"was\": ["), ErrorKind::Corrupt, "no domain"),
        ];
        for (error, kind, words) in cases {
            assert!(error.kind() == kind && error.to_string().contains(words), "{words}: {error}");
        }
        let mut short = sample();
        short.domains[0].metrics.get_mut(super::super::Measure::Relevance).fine.counts.pop();
        let error = StatsDocument::from_json(&short.to_json()).unwrap_err();
        assert_eq!(error.place(), Some("domain 'whole', metrics.relevance.fine"));
        assert!(error.message().contains("41 edges make 40 bins, but there are 39 counts"), "{error}");
    }

    #[test]
    fn edited_counts_and_new_fields_are_read() {
        let text = sample().to_json();
        let edited = text.replacen("\"program\"", "\"author\": {\"name\": [1, 2]}, \"program\"", 1);
        assert_eq!(StatsDocument::from_json(&edited).unwrap(), sample());
        let mut more = sample();
        more.domains[0].metrics.get_mut(super::super::Measure::Dominance).fine.counts[3] += 1000;
        let back = StatsDocument::from_json(&more.to_json()).unwrap();
        assert!(back.domains[0].check_sums().unwrap_err().message().contains("missing make not 40 peaks"));
        assert_eq!(back.domain(None).unwrap().name, "whole");
        assert!(back.domain(Some("east")).unwrap_err().message().contains("whole, 20,20,9m"));
    }
}
