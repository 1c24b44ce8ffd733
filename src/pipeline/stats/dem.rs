//! The statistics of a DEM: survey it, then count its peaks and its cells.

use super::super::layers::LengthOutput;
use super::super::regions::Regions;
use super::super::surveying::{Surveyed, Surveying};
use super::job::StatsJob;
use crate::crs::ToGeographic;
use crate::error::Result;
use crate::io::raster::RasterSource;
use crate::orometry::SurveyOptions;
use crate::orometry::distributions::{
    CellSet, CellShape, Definitions, Domain, Input, InputKind, PeakMeasures, Selection, StatsDocument, measure_terrain,
};
use crate::watch::Watch;

/// Measures a DEM.
pub(super) fn measure(
    job: &StatsJob,
    source: &RasterSource,
    watch: &Watch,
    note: &mut dyn FnMut(String),
) -> Result<StatsDocument> {
    let options = SurveyOptions { min_prominence_m: job.min_prominence_m(), ridges: false, ..SurveyOptions::default() };
    let surveying = Surveying { options: &options, distance: job.distance, memory: job.memory };
    surveying.admit(source)?;
    // What is wrong with them is told before the work begins.
    let crs = source.crs.as_ref();
    let disks = job.disks(crs)?;
    let regions = job.regions.as_ref().map(|layer| Regions::read(layer, crs, note)).transpose()?;
    let surveyed = surveying.run(source, watch, note)?;
    let peaks = peaks(&surveyed, regions.as_ref(), note);
    let dem = &surveyed.dem;
    let size = (dem.grid.rows(), dem.grid.cols());
    let mut domains = vec![(Selection::Whole, CellSet::whole(size.0, size.1))];
    let found = regions.map_or(Vec::new(), |regions| regions.cells(&dem.transform, size));
    let there = |cells: &CellSet| cells.count() > 0;
    let away = found.iter().filter(|(_, cells)| !there(cells)).count();
    if away > 0 {
        note(format!("regions without a cell of the DEM, left out: {away}"));
    }
    domains.extend(
        found.into_iter().filter(|(_, cells)| there(cells)).map(|(name, cells)| (Selection::Region(name), cells)),
    );
    let kind = crs.map(|crs| &crs.kind);
    let to_geographic = surveyed.to_geographic.as_ref().map(|to| to as &dyn ToGeographic);
    for selection in disks {
        let Selection::Disk(name, disk) = &selection else { continue };
        let cells = CellSet::disk(disk, kind, &dem.transform, size, to_geographic)?;
        if !there(&cells) {
            note(format!("the disk {name} holds no cell of the DEM"));
        }
        domains.push((selection, cells));
    }
    let shape = CellShape::new(kind, &dem.transform, size.0)?;
    let (selections, cells): (Vec<_>, Vec<_>) = domains.into_iter().unzip();
    let terrain = measure_terrain(&dem.grid, &dem.elevations, &shape, &cells, watch)?;
    let domains = selections
        .iter()
        .zip(terrain)
        .map(|(selection, terrain)| {
            Domain::measure(selection, in_reach(selection, &peaks), job.radius_m(), Some(terrain), None)
        })
        .collect::<Result<Vec<_>>>()?;
    let input = Input {
        path: source.path.display().to_string(),
        kind: InputKind::Dem,
        crs: crs.map(|crs| crs.label().to_string()),
    };
    Ok(StatsDocument::new(input, Definitions::new(Some(options.min_prominence_m), job.radius_m()), domains))
}

/// The measures of the surveyed peaks, with their places and regions.
fn peaks(surveyed: &Surveyed, regions: Option<&Regions>, note: &mut dyn FnMut(String)) -> Vec<PeakMeasures> {
    let found = &surveyed.survey.peaks;
    let frame = surveyed.frame(LengthOutput::Metres);
    let points: Vec<(f64, f64)> = found.iter().map(|peak| frame.point(peak.cell)).collect();
    let lon_lat = frame.lon_lat(found.iter().map(|peak| peak.cell));
    let known = |(lon, lat): (f64, f64)| (lon.is_finite() && lat.is_finite()).then_some((lon, lat));
    let mut peaks: Vec<PeakMeasures> = found
        .iter()
        .zip(points.iter().zip(lon_lat))
        .map(|(peak, (&point, lon_lat))| PeakMeasures::from(peak).at(point, known(lon_lat)))
        .collect();
    if let Some(regions) = regions {
        let names = regions.tag(&points, &|i| format!("peak {}", found[i].id), note);
        peaks.iter_mut().zip(names).for_each(|(peak, name)| peak.region = name.map(str::to_string));
    }
    peaks
}

/// The peaks to select from: none for a region without any, which is no error where it has cells.
fn in_reach<'a>(selection: &Selection, peaks: &'a [PeakMeasures]) -> &'a [PeakMeasures] {
    match selection {
        Selection::Region(name) if !peaks.iter().any(|peak| peak.region.as_ref() == Some(name)) => &[],
        _ => peaks,
    }
}
