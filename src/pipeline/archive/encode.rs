//! The job behind `orograph encode`: from a raster to a container.

use super::super::memory;
use super::batch::{Area, Plan, cut};
use super::input::Input;
use super::promise::Promise;
use super::record::description_of;
use super::stream::{ByteStream, Target};
use super::tile_side::tile_side_of;
use crate::codec::{Bound, Cells};
use crate::error::{Error, ErrorKind, Result};
use crate::io::raster::stored::StoredOptions;
use crate::oro::{Chunk, Description, Place, Summary, Writer, encode_chunk};
use crate::units::LengthUnit;
use crate::watch::Watch;
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// What to do.
#[derive(Clone, Debug)]
pub struct EncodeJob {
    /// The raster.
    pub input: PathBuf,
    /// What to read of it.
    pub raster: StoredOptions,
    /// Unit of the values; replaces a declared one.
    pub unit: Option<LengthUnit>,
    /// What is promised of the cells.
    pub promise: Promise,
    /// Side of the tiles in cells; what suits the raster unless given.
    pub tile_side: Option<usize>,
    /// Bytes of memory that may be used; what is free unless given.
    pub memory: Option<u64>,
}

/// What was done.
#[derive(Debug)]
pub struct EncodeReport {
    /// What the container holds.
    pub description: Description,
    /// What was written.
    pub summary: Summary,
    /// Bytes of the cells as they are.
    pub raw_bytes: u64,
    /// How long it took.
    pub time: Duration,
}

/// Runs the job; returns nothing when nobody reads the stream any more.
///
/// # Errors
/// Anything that is wrong with the input, the output or the options; then no file has changed.
pub fn run(
    job: &EncodeJob,
    target: Target<'_>,
    watch: &Watch,
    warn: &mut dyn FnMut(&str),
) -> Result<Option<EncodeReport>> {
    let begun = Instant::now();
    let input = Input::open(&job.input, &job.raster)?;
    input.notes().iter().for_each(|note| warn(note));
    let mut record = input.record().clone();
    if let Some(unit) = &job.unit {
        record.bands.iter_mut().for_each(|band| band.unit.clone_from(&unit.name));
    }
    let at_input = |error: Error| error.at_path(&job.input);
    let bounds = job.promise.bounds(&record, job.unit.as_ref(), &mut |text| warn(&text)).map_err(at_input)?;
    let tile_side = job.tile_side.unwrap_or_else(|| tile_side_of(&record));
    let description = description_of(&record, &bounds, tile_side);
    description.check()?;
    let plan = Plan {
        corner: [0, 0],
        size: [record.width, record.height],
        side: tile_side,
        cell_bytes: record.bands.iter().map(|band| band.sample.bytes()).sum(),
    };
    let budget = memory::batch_budget(
        job.memory,
        &plan.needs(),
        "cut the raster with --window or --bbox, or take smaller tiles or fewer threads",
    )?;
    let name = target.name();
    let at_file = |error: Error| match error.kind() {
        ErrorKind::Output => error.at_path(&name),
        ErrorKind::Interrupted => error,
        _ => error.at_path(&job.input),
    };
    let stream = ByteStream::begin(target)?;
    let is_closed = stream.is_closed();
    let encoding = Encoding { input: &input, description: &description, plan, watch };
    let encoded = Writer::new(stream, description.clone()).and_then(|writer| encoding.run(writer, budget));
    let (stream, summary) = match encoded {
        Err(_) if is_closed.load(Ordering::Relaxed) => return Ok(None),
        encoded => encoded.map_err(at_file)?,
    };
    stream.finish()?;
    let raw_bytes = record.width as u64 * record.height as u64 * plan.cell_bytes as u64;
    Ok(Some(EncodeReport { description, summary, raw_bytes, time: begun.elapsed() }))
}

struct Encoding<'a> {
    input: &'a Input,
    description: &'a Description,
    plan: Plan,
    watch: &'a Watch,
}

impl Encoding<'_> {
    fn run<'a>(&self, mut writer: Writer<ByteStream<'a>>, budget: u64) -> Result<(ByteStream<'a>, Summary)> {
        let batches = self.plan.batches(budget);
        self.watch.begin("encoding", self.description.chunks());
        let mut coming = batches.first().map(|&area| self.read(area)).transpose()?;
        for (i, &area) in batches.iter().enumerate() {
            let Some(cells) = coming.take() else { break };
            let next = || batches.get(i + 1).map(|&area| self.read(area)).transpose();
            let (chunks, read) = rayon::join(|| self.encode(area, &cells), next);
            for chunk in &chunks? {
                writer.push(chunk)?;
            }
            coming = read?;
        }
        writer.finish()
    }

    /// The cells of an area, band by band.
    fn read(&self, area: Area) -> Result<Vec<Cells>> {
        self.watch.check()?;
        (0..self.description.bands.len()).map(|band| self.input.read(band, area)).collect()
    }

    /// The chunks of an area, in their order.
    fn encode(&self, area: Area, cells: &[Cells]) -> Result<Vec<Chunk>> {
        let tiles = self.plan.tiles(area);
        let places: Vec<(Area, usize)> =
            tiles.into_iter().flat_map(|tile| (0..cells.len()).map(move |band| (tile, band))).collect();
        let chunk = |&(tile, band): &(Area, usize)| {
            let place = Place { col: tile[0] / self.plan.side, row: tile[1] / self.plan.side, band };
            let chunk = encode_chunk(self.description, place, &cut(&cells[band], area, tile))?;
            self.watch.advance(1)?;
            Ok(chunk)
        };
        // All are waited for, so that the first failure in the raster is the one that is told.
        let chunks: Vec<Result<Chunk>> = places.par_iter().map(chunk).collect();
        chunks.into_iter().collect()
    }
}

impl EncodeReport {
    /// Cells, all bands together.
    pub fn cells(&self) -> u64 {
        self.description.width as u64 * self.description.height as u64 * self.description.bands.len() as u64
    }

    /// Bits that a cell takes in the file.
    pub fn bits_per_cell(&self) -> f64 {
        self.summary.bytes as f64 * 8.0 / self.cells() as f64
    }

    /// Whether every band comes back bit for bit.
    pub fn is_lossless(&self) -> bool {
        self.description.bands.iter().all(|band| band.rule.bound == Bound::Lossless)
    }
}
