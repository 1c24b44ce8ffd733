//! Ranges: the peaks of a class, or of what is to be classified.

use super::super::stats::{InputFile, LayerPeaks, Reading, place, tag};
use super::super::tags::TagLayer;
use crate::crs::{Crs, CrsKind};
use crate::error::{Error, ErrorKind, Result};
use crate::io::raster::RasterOptions;
use crate::orometry::distributions::PeakMeasures;
use crate::watch::Watch;
use std::path::PathBuf;

/// A layer of peaks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PeaksInput {
    /// The class of all its peaks; those of its regions unless given.
    pub class: Option<String>,
    /// The file.
    pub path: PathBuf,
}

/// A layer of peaks, read.
pub(super) struct ReadLayer {
    /// Its peaks, with places and regions.
    pub(super) peaks: Vec<PeakMeasures>,
    /// Its CRS.
    pub(super) crs: Option<Crs>,
    /// The least prominence in metres that they were chosen by, where that is known.
    pub(super) threshold_m: Option<f64>,
    /// The regions that they stand in.
    pub(super) regions: Vec<String>,
}

/// How layers are read.
pub(super) struct LayerOptions<'a> {
    /// Name of the layer, where a file has several.
    pub(super) layer: Option<&'a str>,
    /// CRS of layers that have none.
    pub(super) crs: Option<&'a str>,
    /// Polygons that part the peaks; the regions that they have unless given.
    pub(super) regions: Option<&'a TagLayer>,
    /// Least prominence in metres.
    pub(super) min_prominence_m: Option<f64>,
}

/// Peaks that belong together, and the ground they stand on.
pub(super) struct Range {
    /// Name of the class or the region.
    pub(super) name: String,
    /// The peaks.
    pub(super) peaks: Vec<PeakMeasures>,
    /// The CRS of their coordinates.
    pub(super) crs: Option<Crs>,
}

impl LayerOptions<'_> {
    /// Reads a layer.
    ///
    /// # Errors
    /// When it cannot be read, is no layer of peaks, or has a peak without a place.
    pub(super) fn read(&self, input: &PeaksInput, watch: &Watch, note: &mut dyn FnMut(String)) -> Result<ReadLayer> {
        let raster = RasterOptions { crs: self.crs.map(String::from), ..RasterOptions::default() };
        let reading = Reading { raster: &raster, layer: self.layer, memory: None };
        let refuse = |message: &str| Error::new(ErrorKind::Input, message).at_path(&input.path);
        let InputFile::Peaks(file) = InputFile::open(&input.path, &reading, watch)? else {
            return Err(refuse("it is no layer of peaks: make one with orograph peaks"));
        };
        let LayerPeaks { mut peaks, crs, threshold_m } =
            LayerPeaks::read(&file, self.crs, self.min_prominence_m, note)?;
        place(&mut peaks, crs.as_ref())?;
        if !peaks.iter().all(|peak| has_place(peak, crs.as_ref())) {
            return Err(refuse("there are peaks without a place: no disk can hold them"));
        }
        let regions = tag(self.regions, crs.as_ref(), &mut peaks, note).map_err(|error| error.at_path(&input.path))?;
        Ok(ReadLayer { peaks, crs, threshold_m, regions })
    }
}

impl ReadLayer {
    /// The peaks of its regions, one range for each, without those that stand in none.
    pub(super) fn by_region(self) -> Vec<Range> {
        let Self { peaks, crs, regions, .. } = self;
        let own = |name: &String| peaks.iter().filter(|peak| peak.region.as_ref() == Some(name)).cloned().collect();
        regions.iter().map(|name| Range { name: name.clone(), peaks: own(name), crs: crs.clone() }).collect()
    }

    /// All of its peaks as one range.
    pub(super) fn whole(self, name: String) -> Range {
        Range { name, peaks: self.peaks, crs: self.crs }
    }
}

/// Whether a peak has coordinates that disks are laid in.
fn has_place(peak: &PeakMeasures, crs: Option<&Crs>) -> bool {
    match crs.map(|crs| &crs.kind) {
        Some(CrsKind::Geographic { .. }) => peak.lon.is_some() && peak.lat.is_some(),
        _ => peak.x.is_finite() && peak.y.is_finite(),
    }
}
