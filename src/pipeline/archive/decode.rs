//! The job behind `orograph decode`: from a container to a raster of any format.

use super::super::memory;
use super::batch::Area;
use super::compare::Written;
use super::container::{ContainerOptions, ContainerSource};
use super::stream::{ByteStream, Target};
use crate::codec::Cells;
use crate::error::{Error, ErrorKind, Result};
use crate::io::raster::stored::{Format, StoredTarget};
use crate::watch::Watch;
use crate::with_cells;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// What to do.
#[derive(Clone, Debug)]
pub struct DecodeJob {
    /// The container.
    pub input: PathBuf,
    /// What to read of it.
    pub part: ContainerOptions,
    /// GDAL's name of the format to write, or [`RAW`]; after the output's extension unless given.
    pub format: Option<String>,
    /// Options of the format, key and value.
    pub options: Vec<(String, String)>,
    /// Whether to go on where tiles are damaged.
    pub keep_going: bool,
    /// Bytes of memory that may be used; about a gigabyte unless given.
    pub memory: Option<u64>,
}

/// The format of bare cells: band by band, row by row, little-endian.
pub const RAW: &str = "raw";

/// What was done.
#[derive(Debug)]
pub struct DecodeReport {
    /// Columns, rows and bands.
    pub size: (usize, usize, usize),
    /// The format that was written.
    pub format: String,
    /// The files written.
    pub outputs: Vec<PathBuf>,
    /// The damaged tiles, in the order in which they were met; their cells are voids.
    pub damaged: Vec<String>,
    /// How long it took.
    pub time: Duration,
}

/// What to do where less memory would do.
const REMEDY: &str = "cut the raster with --window or --bbox, or take fewer threads";

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the input, the output or the options; then no file has changed.
pub fn run(job: &DecodeJob, target: Target<'_>, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<DecodeReport> {
    let begun = Instant::now();
    let source = ContainerSource::open(&job.input, &job.part)?;
    let is_raw = job.format.as_ref().is_some_and(|format| format.eq_ignore_ascii_case(RAW));
    let mut decoding = Decoding { source: &source, keep_going: job.keep_going, damaged: Vec::new(), watch };
    let (format, outputs) = if is_raw {
        if !job.options.is_empty() {
            return Err(Error::usage("--co: the raw format has no options"));
        }
        (RAW.to_string(), decoding.write_raw(target, job.memory)?)
    } else {
        let Target::File { path, overwrite } = target else {
            return Err(Error::usage("standard output takes the raw format only: give --of raw, or name a file"));
        };
        let format = Format::of(&path, job.format.as_deref())?;
        let budget = memory::batch_budget(job.memory, &source.plan().needs(), REMEDY)
            .map_err(|error| error.at_path(&job.input))?;
        let file = StoredTarget::begin(&path, overwrite, &format, &job.options, &source.record)?;
        file.notes.iter().for_each(|note| warn(note));
        let (outputs, mut notes) = decoding.write(file, budget)?.finish()?;
        if !format.keeps_cells(&job.options) {
            notes.extend(decoding.compare(&path, &format.name, budget)?);
        }
        notes.iter().for_each(|note| warn(note));
        (format.name, outputs)
    };
    let size = (source.record.width, source.record.height, source.record.bands.len());
    Ok(DecodeReport { size, format, outputs, damaged: decoding.damaged, time: begun.elapsed() })
}

struct Decoding<'a> {
    source: &'a ContainerSource,
    keep_going: bool,
    damaged: Vec<String>,
    watch: &'a Watch,
}

/// The cells of a batch, band by band, with the damage found.
type Batch = (Vec<Cells>, Vec<String>);

impl Decoding<'_> {
    /// Writes all batches: while one is written, the next is decoded.
    fn write(&mut self, mut file: StoredTarget, budget: u64) -> Result<StoredTarget> {
        let batches = self.source.plan().batches(budget);
        self.watch.begin("decoding", self.source.record.height as u64 * self.source.record.width as u64);
        let bands: Vec<usize> = (0..self.source.record.bands.len()).collect();
        let mut coming = batches.first().map(|&area| self.read(area, &bands)).transpose()?;
        for (i, &area) in batches.iter().enumerate() {
            let Some((mut cells, damaged)) = coming.take() else { break };
            self.damaged.extend(damaged);
            let next = || batches.get(i + 1).map(|&area| self.read(area, &bands)).transpose();
            let write = || {
                for (band, cells) in cells.iter_mut().enumerate() {
                    with_cells!(cells, values => file.write(band, area, values))?;
                }
                Ok(())
            };
            let (read, written): (_, Result<()>) = rayon::join(next, write);
            written?;
            coming = read?;
        }
        Ok(file)
    }

    /// Reads a file that has been written, and tells whether its cells are others than those that went into it.
    fn compare(&self, path: &Path, format: &str, budget: u64) -> Result<Option<String>> {
        let record = &self.source.record;
        let unknown = |reason: &str| {
            format!(
                "whether the format {format} keeps the cells is not known: the file cannot be read again ({reason})"
            )
        };
        let mut written = match Written::open(path, record) {
            Ok(written) if written.size() == (record.width, record.height) => written,
            Ok(_) => return Ok(Some(unknown("it has another size"))),
            Err(error) => return Ok(Some(unknown(error.message()))),
        };
        let bands: Vec<usize> = (0..record.bands.len()).collect();
        self.watch.begin("comparing", record.height as u64 * record.width as u64);
        for area in self.source.plan().batches(budget) {
            let (cells, _) = self.read(area, &bands)?;
            for (band, cells) in cells.iter().enumerate() {
                if let Err(error) = written.compare(band, area, cells) {
                    return Ok(Some(unknown(error.message())));
                }
            }
        }
        Ok(written.said(format))
    }

    /// Writes bare cells: band by band, each in rows of tiles, for a stream cannot go back.
    fn write_raw(&mut self, target: Target<'_>, memory: Option<u64>) -> Result<Vec<PathBuf>> {
        let record = &self.source.record;
        let widest = record.bands.iter().map(|band| band.sample.bytes()).max().unwrap_or(1);
        let mut plan = self.source.plan();
        plan.cell_bytes = widest;
        // A row has to be whole before it is written.
        let mut needs = plan.needs();
        needs.least = plan.row_bytes();
        let budget = memory::batch_budget(memory, &needs, REMEDY).map_err(|error| error.at_path(&self.source.path))?;
        let outputs = match &target {
            Target::File { path, .. } => vec![path.clone()],
            Target::Stream(_) => Vec::new(),
        };
        let mut stream = ByteStream::begin(target)?;
        let is_closed = stream.is_closed();
        let batches = plan.batches(budget);
        self.watch.begin("decoding", record.height as u64 * record.width as u64 * record.bands.len() as u64);
        for band in 0..record.bands.len() {
            for &area in &batches {
                let (cells, damaged) = self.read(area, &[band])?;
                self.damaged.extend(damaged);
                let written = cells.iter().try_for_each(|cells| stream.write_all(&cells.to_le_bytes()));
                match written {
                    Err(_) if is_closed.load(Ordering::Relaxed) => return Ok(outputs),
                    Err(error) => return Err(stream.failed(&error)),
                    Ok(()) => {}
                }
            }
        }
        match stream.finish() {
            Err(_) if is_closed.load(Ordering::Relaxed) => {}
            finished => finished?,
        }
        Ok(outputs)
    }

    fn read(&self, area: Area, bands: &[usize]) -> Result<Batch> {
        self.watch.check()?;
        let mut faults = Vec::new();
        let mut damaged = |fault: Error| {
            if !self.keep_going {
                return Err(with_remedy(&fault));
            }
            let text = fault.to_string();
            // A tile that two batches share is told once.
            if !self.damaged.contains(&text) && !faults.contains(&text) {
                faults.push(text);
            }
            Ok(())
        };
        let cells = bands.iter().map(|&band| self.source.read(band, area, &mut damaged)).collect::<Result<Vec<_>>>()?;
        self.watch.advance(area[2] as u64 * area[3] as u64)?;
        Ok((cells, faults))
    }
}

fn with_remedy(fault: &Error) -> Error {
    let message = format!("{}; --keep-going saves all other tiles", fault.message());
    let error = Error::new(ErrorKind::Corrupt, message);
    match fault.place() {
        Some(place) => error.at_place(place),
        None => error,
    }
}
