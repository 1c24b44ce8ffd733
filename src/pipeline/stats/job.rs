//! What to do, and what was done.

use super::super::metric::Distance;
use super::super::tags::TagLayer;
use super::input::{InputFile, Reading, is_document};
use super::output::Outputs;
use super::{dem, layer};
use crate::crs::{Crs, CrsKind};
use crate::error::{Error, Result};
use crate::io::raster::RasterOptions;
use crate::orometry::distributions::{
    BinSet, Comparison, DEFAULT_RADIUS_M, Disk, Domain, Selection, StatsDocument, compare_documents,
};
use crate::watch::Watch;
use std::path::PathBuf;

/// What to do.
#[derive(Clone, Debug)]
pub struct StatsJob {
    /// One input, or two that are compared: DEMs, layers of peaks, statistics files.
    pub inputs: Vec<PathBuf>,
    /// Where to write; the extensions say what. May be empty.
    pub outputs: Vec<PathBuf>,
    /// Whether existing outputs may be replaced.
    pub overwrite: bool,
    /// How to read a DEM; its CRS also is that of a layer of peaks without one.
    pub raster: RasterOptions,
    /// Name of the layer of peaks, where there are several.
    pub layer: Option<String>,
    /// How to measure distances on a DEM.
    pub distance: Distance,
    /// Least prominence of the peaks that are counted: 30 m on a DEM and that of the layer unless given.
    pub min_prominence_m: Option<f64>,
    /// The radius R in metres that distances are divided by; that of the statistics file compared with, else 30 km.
    pub radius_m: Option<f64>,
    /// The bins that are compared and drawn.
    pub bins: BinSet,
    /// Polygons whose peaks and cells are counted apart.
    pub regions: Option<TagLayer>,
    /// Disks whose peaks and cells are counted apart.
    pub disks: Vec<DiskWords>,
    /// Names of the domains that are drawn, or compared where there are two inputs.
    pub domains: Vec<String>,
    /// Bytes of memory that may be used; what is free unless given.
    pub memory: Option<u64>,
}

/// A disk as a user writes it.
#[derive(Clone, Debug, PartialEq)]
pub struct DiskWords {
    /// The text, which names the domain.
    pub name: String,
    /// Longitude or easting.
    pub x: f64,
    /// Latitude or northing.
    pub y: f64,
    /// Radius in metres.
    pub radius_m: f64,
}

/// What was done.
#[derive(Debug)]
pub struct StatsReport {
    /// The statistics of each input.
    pub documents: Vec<StatsDocument>,
    /// How far the domains of the second input are from those of the first; nothing for one input.
    pub comparisons: Vec<DomainComparison>,
    /// The files written.
    pub outputs: Vec<PathBuf>,
}

/// How far two domains are from each other.
#[derive(Clone, Debug)]
pub struct DomainComparison {
    /// Name of the domain of the first input.
    pub first: String,
    /// Name of the domain of the second input.
    pub second: String,
    /// One for each metric.
    pub metrics: Vec<Comparison>,
}

/// Least prominence of a DEM's peaks unless another is given, in metres.
const DEFAULT_MIN_PROMINENCE_M: f64 = 30.0;

impl StatsJob {
    /// The least prominence of a DEM's peaks in metres.
    pub(super) fn min_prominence_m(&self) -> f64 {
        self.min_prominence_m.unwrap_or(DEFAULT_MIN_PROMINENCE_M)
    }

    /// The radius R in metres.
    pub(super) fn radius_m(&self) -> f64 {
        self.radius_m.unwrap_or(DEFAULT_RADIUS_M)
    }

    /// The disks on an input with this CRS.
    pub(super) fn disks(&self, crs: Option<&Crs>) -> Result<Vec<Selection>> {
        self.disks.iter().map(|words| words.meant(crs)).collect()
    }
}

impl DiskWords {
    /// The disk on an input with this CRS.
    ///
    /// Coordinates are longitude and latitude in a geographic CRS, and in a projected one where they could be.
    pub(in super::super) fn meant(&self, crs: Option<&Crs>) -> Result<Selection> {
        let Self { name, x, y, radius_m } = self;
        let is_angle = x.abs() <= 360.0 && y.abs() <= 90.0;
        let disk = match crs.map(|crs| &crs.kind) {
            Some(CrsKind::Geographic { ellipsoid, .. }) => Disk::geographic(*x, *y, *radius_m, *ellipsoid)?,
            Some(CrsKind::Projected { ellipsoid, .. }) if is_angle => Disk::geographic(*x, *y, *radius_m, *ellipsoid)?,
            Some(CrsKind::Projected { metres, .. } | CrsKind::Local { metres }) => {
                Disk::planar(*x, *y, *radius_m, *metres)
            }
            None => Disk::planar(*x, *y, *radius_m, 1.0),
        };
        Ok(Selection::Disk(name.clone(), disk))
    }
}

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the inputs, the outputs or the options; then no file has changed.
pub fn run(job: &StatsJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<StatsReport> {
    let outputs = Outputs::begin(job)?;
    let reading = Reading { raster: &job.raster, layer: job.layer.as_deref(), memory: job.memory };
    let inputs = job.inputs.iter().map(|path| InputFile::open(path, &reading, watch)).collect::<Result<Vec<_>>>()?;
    if inputs.iter().all(is_document) {
        refuse_measuring(job)?;
    }
    // What is measured to be compared with a file is measured as that was.
    let known = inputs.iter().find_map(|input| match input {
        InputFile::Document(document) => Some(document.definitions.radius_m),
        _ => None,
    });
    let job = &StatsJob { radius_m: job.radius_m.or(known), ..job.clone() };
    let mut note = |text: String| warn(&text);
    let mut documents = Vec::new();
    for input in inputs {
        let mut document = match input {
            InputFile::Document(document) => *document,
            InputFile::Dem(source) => dem::measure(job, &source, watch, &mut note)?,
            InputFile::Peaks(file) => layer::measure(job, &file, &mut note)?,
        };
        distinguish(&mut document.domains);
        documents.push(document);
    }
    let comparisons = compare(job, &documents, &mut note)?;
    let outputs = outputs.write(job, &documents, &comparisons, watch)?;
    Ok(StatsReport { documents, comparisons, outputs })
}

/// Gives domains of the same name different ones: a region may be called as the whole is.
fn distinguish(domains: &mut [Domain]) {
    for i in 1..domains.len() {
        let name = domains[i].name.clone();
        let mut number = 2;
        while domains[..i].iter().any(|domain| domain.name == domains[i].name) {
            domains[i].name = format!("{name} ({number})");
            number += 1;
        }
    }
}

/// Refuses options that say how to measure where nothing is measured.
fn refuse_measuring(job: &StatsJob) -> Result<()> {
    let given = [
        ("--radius", job.radius_m.is_some()),
        ("--min-prominence", job.min_prominence_m.is_some()),
        ("--regions", job.regions.is_some()),
        ("--disk", !job.disks.is_empty()),
    ];
    match given.into_iter().find(|(_, given)| *given) {
        Some((option, _)) => Err(Error::usage(format!(
            "{option}: statistics files are taken as they are; give it when they are measured"
        ))),
        None => Ok(()),
    }
}

/// Compares the domains of two inputs: those asked for, or the first of each and then those of equal names.
fn compare(job: &StatsJob, documents: &[StatsDocument], note: &mut dyn FnMut(String)) -> Result<Vec<DomainComparison>> {
    let [a, b] = documents else { return Ok(Vec::new()) };
    let threshold = |document: &StatsDocument| document.definitions.prominence_threshold_m;
    if let (Some(m), Some(n)) = (threshold(a), threshold(b))
        && m != n
    {
        note(format!(
            "the least prominence is {m} m in the one and {n} m in the other, which alone makes the distributions differ; \
             measure both with the same --min-prominence"
        ));
    }
    let mut pairs: Vec<(&str, &str)> = Vec::new();
    match &job.domains[..] {
        [] => {
            pairs.push((&a.domain(None)?.name, &b.domain(None)?.name));
            for domain in a.domains.iter().skip(1) {
                if b.domains.iter().skip(1).any(|other| other.name == domain.name) {
                    pairs.push((&domain.name, &domain.name));
                }
            }
        }
        [both] => pairs.push((both, both)),
        [first, second, ..] => pairs.push((first, second)),
    }
    let compare = |(first, second): (&str, &str)| {
        Ok(DomainComparison {
            first: first.to_string(),
            second: second.to_string(),
            metrics: compare_documents((a, Some(first)), (b, Some(second)), job.bins)?,
        })
    };
    pairs.into_iter().map(compare).collect()
}
