//! The one door to elevation models for jobs that measure or draw them: rasters that GDAL reads, and containers.

use super::super::memory;
use super::container::{ContainerOptions, ContainerSource, is_container};
use crate::codec::Bound;
use crate::error::Result;
use crate::io::raster::stored::MemoryTarget;
use crate::io::raster::{RasterOptions, RasterSource};
use crate::watch::Watch;
use crate::with_cells;
use std::path::Path;

/// Opens a band of a raster; one in a container is decoded into memory first.
///
/// # Errors
/// As [`RasterSource::open`]; a container that is damaged, or larger than the memory that may be used.
pub fn open_dem(path: &Path, options: &RasterOptions, memory: Option<u64>, watch: &Watch) -> Result<RasterSource> {
    if !is_container(path) {
        return RasterSource::open(path, options);
    }
    let part = ContainerOptions {
        bands: vec![options.band.unwrap_or(1)],
        window: options.window,
        bbox: options.bbox,
        ..ContainerOptions::default()
    };
    let source = ContainerSource::open(path, &part)?;
    let bands = source.description().bands.len();
    let bound = source.description().bands[part.bands[0] - 1].rule.bound;
    let record = &source.record;
    let plan = source.plan();
    let raw = record.width as u64 * record.height as u64 * plan.cell_bytes as u64;
    let budget = memory.unwrap_or_else(memory::free_bytes);
    let remedy = "cut the raster with --window or --bbox";
    let budget = memory::admit_or(raw, budget, remedy)
        .and_then(|()| memory::batch_budget(Some(budget.saturating_sub(raw)), &plan.needs(), remedy))
        .map_err(|error| error.at_path(path))?;
    let mut target = MemoryTarget::begin(record)?;
    watch.begin("decoding", record.width as u64 * record.height as u64);
    for area in plan.batches(budget) {
        let mut cells = source.read(0, area, &mut Err)?;
        with_cells!(&mut cells, values => target.write(0, area, values))?;
        watch.advance(area[2] as u64 * area[3] as u64)?;
    }
    // The band and the part have been taken already.
    let rest = RasterOptions { band: None, window: None, bbox: None, ..options.clone() };
    let mut source = RasterSource::open_unpacked(path, target.finish()?, &rest)?;
    source.bands = bands;
    if let Bound::MaxError(error) = bound {
        let error_m = error * source.elevations.scale.abs() * source.elevations.unit.metres;
        source.notes.push(format!("the file's elevations may be up to {error_m} m from the original's"));
    }
    if bands > 1 && options.band.is_none() {
        source.notes.push(format!("the file has {bands} bands; reading band 1 (choose with --band)"));
    }
    Ok(source)
}
