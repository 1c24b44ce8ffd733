//! From a DEM's file to its survey: what every job on the peaks of a DEM begins with.

use super::layers::{Frame, LengthOutput};
use super::memory;
use super::metric::{AnyMetric, Distance, metric_of};
use super::spikes;
use crate::crs::{Crs, CrsKind};
use crate::error::{Error, Result};
use crate::io::raster::{Dem, RasterSource};
use crate::io::transform::OwnGeographic;
use crate::orometry::{Survey, SurveyOptions, survey};
use crate::watch::Watch;
use crate::with_metric;
use std::time::{Duration, Instant};

/// How to survey a DEM.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surveying<'a> {
    /// What to measure.
    pub(super) options: &'a SurveyOptions,
    /// How to measure distances.
    pub(super) distance: Distance,
    /// Bytes of memory that may be used; what is free unless given.
    pub(super) memory: Option<u64>,
}

/// A DEM with its survey.
pub(super) struct Surveyed {
    pub(super) dem: Dem,
    pub(super) survey: Survey,
    /// What turns projected coordinates into longitudes and latitudes.
    pub(super) to_geographic: Option<OwnGeographic>,
    /// How long reading and measuring took.
    pub(super) times: [Duration; 2],
}

impl Surveyed {
    /// Where the cells lie.
    pub(super) fn frame(&self, unit: LengthOutput) -> Frame<'_> {
        Frame::new(&self.dem, self.to_geographic.as_ref(), unit)
    }
}

impl Surveying<'_> {
    /// Refuses a raster whose survey would not fit into memory.
    ///
    /// # Errors
    /// With the estimate and what to do.
    pub(super) fn admit(&self, source: &RasterSource) -> Result<()> {
        let needed = memory::survey_bytes(source.cells(), source.key_bytes()) + source.unpacked_bytes();
        memory::admit(needed, self.memory.unwrap_or_else(memory::free_bytes))
            .map_err(|error| error.at_path(&source.path))
    }

    /// Reads and surveys; warns of what looks wrong.
    ///
    /// # Errors
    /// Anything that is wrong with the input or the options, or an interrupt.
    pub(super) fn run(&self, source: &RasterSource, watch: &Watch, note: &mut dyn FnMut(String)) -> Result<Surveyed> {
        let begun = Instant::now();
        let dem = source.read(watch)?;
        let read = begun.elapsed();
        self.warn_of_input(&dem, note);
        let begun = Instant::now();
        let at_input = |error: Error| error.at_path(&source.path);
        let to_geographic = own_geographic(dem.crs.as_ref())?;
        let metric = metric_of(&dem, self.distance, to_geographic.as_ref()).map_err(at_input)?;
        let found = with_metric!(&metric, metric => survey(&dem.grid, &dem.elevations, metric, self.options, watch))
            .map_err(at_input)?;
        self.warn_of_result(&dem, &metric, &found, note);
        drop(metric);
        Ok(Surveyed { dem, survey: found, to_geographic, times: [read, begun.elapsed()] })
    }

    fn warn_of_input(&self, dem: &Dem, note: &mut dyn FnMut(String)) {
        for text in &dem.notes {
            note(text.clone());
        }
        if let Some(sentinel) = &dem.sentinel {
            note(sentinel.to_string());
        }
        let stretches = dem.crs.as_ref().and_then(|crs| crs.projection.as_deref()).is_some_and(|projection| {
            let plain = projection.to_ascii_lowercase();
            plain.contains("mercator") && !plain.contains("transverse") && !plain.contains("oblique")
                || plain.contains("pseudo")
                || plain.contains("equirectangular")
        });
        if stretches && self.distance == Distance::Crs {
            note(
                "the projection stretches distances much away from its true scale; measure them with --distance geodesic"
                    .into(),
            );
        }
    }

    fn warn_of_result(&self, dem: &Dem, metric: &AnyMetric<'_>, found: &Survey, note: &mut dyn FnMut(String)) {
        // Beside cells of an undeclared sentinel everything stands out; that was said already.
        let spikes = if dem.sentinel.is_some() { Vec::new() } else { spikes::find(dem, metric, &found.peaks) };
        if let Some(first) = spikes.first() {
            let others = if spikes.len() > 1 { format!(" (and {} more)", spikes.len() - 1) } else { String::new() };
            note(format!(
                "the cell at row {}, column {}{others} stands {:.0} m above all its neighbours, which looks like a fault of the data: \
                 mend the DEM, or give --nodata {} if that value means nodata; nothing is removed here",
                first.row, first.col, first.drop_m, first.value
            ));
        }
        let certain = found.peaks.iter().filter(|peak| peak.prominence_certain).count();
        if found.peaks.len() >= 10 && certain * 2 < found.peaks.len() && !self.options.certain_only {
            note(format!(
                "only {certain} of {} prominences are certain: terrain beyond the edge or in voids could lower the others down to prominence_min",
                found.peaks.len()
            ));
        }
    }
}

/// The transformation to longitudes and latitudes, where coordinates are projected.
pub(super) fn own_geographic(crs: Option<&Crs>) -> Result<Option<OwnGeographic>> {
    crs.filter(|crs| matches!(crs.kind, CrsKind::Projected { .. })).map(OwnGeographic::new).transpose()
}
