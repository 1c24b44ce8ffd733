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
    match Packed::open(path, options)? {
        Some(packed) => packed.unpack(0, memory, watch),
        None => RasterSource::open(path, options),
    }
}

/// As [`open_dem`] for a job that can do with less: of a container the coarsest level is decoded that has as many rows
/// and columns as `needed` says of the raster, which it may see with coarser cells than it has. Returns how many rows
/// and columns the raster has whatever the level.
///
/// # Errors
/// As [`open_dem`] and `needed`.
pub fn open_dem_coarse(
    path: &Path,
    options: &RasterOptions,
    memory: Option<u64>,
    watch: &Watch,
    needed: &dyn Fn(&RasterSource) -> Result<(usize, usize)>,
) -> Result<(RasterSource, (usize, usize))> {
    let Some(packed) = Packed::open(path, options)? else {
        let source = RasterSource::open(path, options)?;
        let [_, _, cols, rows] = source.window;
        return Ok((source, (rows, cols)));
    };
    let size = packed.size();
    let mut level = packed.coarsest((GLANCE, GLANCE));
    if level > 0 {
        let glance = packed.unpack(level, memory, watch)?;
        level = packed.coarsest(needed(&glance)?);
    }
    Ok((packed.unpack(level, memory, watch)?, size))
}

/// Rows and columns that are enough to know what a raster is.
const GLANCE: usize = 64;

/// A band of a container, with what is to be read of it.
struct Packed<'a> {
    path: &'a Path,
    options: &'a RasterOptions,
    part: ContainerOptions,
    whole: ContainerSource,
}

impl<'a> Packed<'a> {
    /// Opens a container; returns nothing for other files.
    fn open(path: &'a Path, options: &'a RasterOptions) -> Result<Option<Self>> {
        if !is_container(path) {
            return Ok(None);
        }
        let part = ContainerOptions {
            bands: vec![options.band.unwrap_or(1)],
            window: options.window,
            bbox: options.bbox,
            ..ContainerOptions::default()
        };
        let whole = ContainerSource::open(path, &part)?;
        Ok(Some(Self { path, options, part, whole }))
    }

    /// Rows and columns of what is read.
    fn size(&self) -> (usize, usize) {
        (self.whole.record.height, self.whole.record.width)
    }

    /// The coarsest level that has so many rows and columns, or more.
    fn coarsest(&self, (rows, cols): (usize, usize)) -> u8 {
        let (height, width) = self.size();
        let has_enough = |level: &u8| height >> level >= rows.max(1) && width >> level >= cols.max(1);
        (0..=self.whole.description().last_level()).take_while(has_enough).last().unwrap_or(0)
    }

    /// Decodes a level into memory, and opens it as a raster that lies where the whole does.
    fn unpack(&self, level: u8, memory: Option<u64>, watch: &Watch) -> Result<RasterSource> {
        let coarse = ContainerOptions { level, ..self.part.clone() };
        let mut source = ContainerSource::open(self.path, &coarse)?;
        if level > 0 {
            // Samples stand for the cells around them, as those of an overview do: the edges stay where they are, and
            // no sample is shown further off than half of what it stands for.
            let (rows, cols) = self.size();
            let [y, x] = [rows as f64 / source.record.height as f64, cols as f64 / source.record.width as f64];
            source.record.transform = self.whole.record.transform.map(|transform| transform.scaled(y, x));
        }
        let bands = source.description().bands.len();
        let bound = source.description().bands[self.part.bands[0] - 1].rule.bound;
        let record = &source.record;
        let plan = source.plan();
        let raw = record.width as u64 * record.height as u64 * plan.cell_bytes as u64;
        let budget = memory.unwrap_or_else(memory::free_bytes);
        let remedy = "cut the raster with --window or --bbox";
        let budget = memory::admit_or(raw, budget, remedy)
            .and_then(|()| memory::batch_budget(Some(budget.saturating_sub(raw)), &plan.needs(), remedy))
            .map_err(|error| error.at_path(self.path))?;
        let mut target = MemoryTarget::begin(record)?;
        watch.begin("decoding", record.width as u64 * record.height as u64);
        for area in plan.batches(budget) {
            let mut cells = source.read(0, area, &mut Err)?;
            with_cells!(&mut cells, values => target.write(0, area, values))?;
            watch.advance(area[2] as u64 * area[3] as u64)?;
        }
        // The band and the part have been taken already.
        let rest = RasterOptions { band: None, window: None, bbox: None, ..self.options.clone() };
        let mut source = RasterSource::open_unpacked(self.path, target.finish()?, &rest)?;
        source.bands = bands;
        if let Bound::MaxError(error) = bound {
            let error_m = error * source.elevations.scale.abs() * source.elevations.unit.metres;
            source.notes.push(format!("the file's elevations may be up to {error_m} m from the original's"));
        }
        if bands > 1 && self.options.band.is_none() {
            source.notes.push(format!("the file has {bands} bands; reading band 1 (choose with --band)"));
        }
        Ok(source)
    }
}
