//! The job behind `orograph encode --sparse`: from a raster to a container of patches.

use super::super::archive::{ByteStream, Target, description_of, tile_side_of};
use super::learn::read_dictionary;
use super::model::{Model, ModelOptions};
use super::read::Band;
use crate::codec::{Bound, SEGMENTS};
use crate::dictionary::Raster;
use crate::error::{Error, ErrorKind, Result};
use crate::grid::SampleType;
use crate::io::raster::stored::StoredOptions;
use crate::oro::{Chunk, Description, Summary, Writer, encode_patch_chunk};
use crate::units::LengthUnit;
use crate::watch::Watch;
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// What to do.
#[derive(Clone, Debug)]
pub struct SparseJob {
    /// The raster.
    pub input: PathBuf,
    /// What to read of it: one band.
    pub raster: StoredOptions,
    /// Unit of the values; replaces a declared one.
    pub unit: Option<LengthUnit>,
    /// How to describe it.
    pub model: ModelOptions,
    /// A container with the dictionary to use; one is learned from the raster unless given.
    pub dictionary: Option<PathBuf>,
    /// Side of the tiles in cells; what suits the raster unless given.
    pub tile_side: Option<usize>,
    /// Bytes of memory that may be used; what is free unless given.
    pub memory: Option<u64>,
}

/// What was done.
#[derive(Debug)]
pub struct SparseReport {
    /// What the container holds.
    pub description: Description,
    /// What was written.
    pub summary: Summary,
    /// Bytes of the cells as they are.
    pub raw_bytes: u64,
    /// The model, with what was found of its errors.
    pub model: Model,
    /// Bytes of the segments of all tiles: means, terms, voids.
    pub segment_bytes: [u64; SEGMENTS],
    /// How long it took.
    pub time: Duration,
}

/// Runs the job; returns nothing when nobody reads the stream any more.
///
/// # Errors
/// Anything that is wrong with the input, the output or the options; then no file has changed.
pub fn run(
    job: &SparseJob,
    target: Target<'_>,
    watch: &Watch,
    warn: &mut dyn FnMut(&str),
) -> Result<Option<SparseReport>> {
    let begun = Instant::now();
    let at_input = |error: Error| error.at_path(&job.input);
    let given = job.dictionary.as_deref().map(read_dictionary).transpose()?;
    let Band { mut record, values, notes } = Band::read(&job.input, &job.raster, job.memory, watch)?;
    notes.iter().for_each(|note| warn(note));
    let [band] = record.bands.as_mut_slice() else { return Err(Error::usage("one band is described")) };
    if let Some(unit) = &job.unit {
        band.unit.clone_from(&unit.name);
    }
    let raw_bytes = values.len() as u64 * band.sample.bytes() as u64;
    let raster = Raster::new(record.height, record.width, &values).map_err(at_input)?;
    let has_voids = values.iter().any(|value| value.is_nan());
    // The declared value if it stays what it is, as most do; voids are NaN otherwise.
    let nodata = band.nodata.map(|bits| band.sample.value_of_bits(bits)).filter(|&v| f64::from(v as f32) == v);
    let nodata = nodata.map(|value| (value as f32).to_bits()).filter(|_| has_voids);
    let model = Model::new(&raster, &job.model, given.as_ref(), nodata, watch).map_err(at_input)?;
    (band.sample, band.nodata) = (SampleType::F32, nodata.map(u64::from));
    let bound = if model.largest_error > 0.0 { Bound::MaxError(model.largest_error) } else { Bound::Lossless };
    let tile_side = job.tile_side.unwrap_or_else(|| tile_side_of(&record));
    let description = description_of(&record, &[bound], tile_side);
    description.check()?;

    let name = target.name();
    let at_file = |error: Error| match error.kind() {
        ErrorKind::Output => error.at_path(&name),
        ErrorKind::Interrupted => error,
        _ => error.at_path(&job.input),
    };
    let stream = ByteStream::begin(target)?;
    let is_closed = stream.is_closed();
    let chunks = chunks_of(&description, &model, &values, watch).map_err(at_input)?;
    let mut segment_bytes = [0; SEGMENTS];
    for chunk in &chunks {
        segment_bytes.iter_mut().zip(chunk.lengths).for_each(|(sum, length)| *sum += u64::from(length));
    }
    let written = Writer::sparse(stream, description.clone(), model.dictionary.clone()).and_then(|mut writer| {
        chunks.iter().try_for_each(|chunk| writer.push(chunk))?;
        writer.finish()
    });
    let (stream, mut summary) = match written {
        Err(_) if is_closed.load(Ordering::Relaxed) => return Ok(None),
        written => written.map_err(at_file)?,
    };
    stream.finish()?;
    summary.largest_errors = vec![model.largest_error];
    Ok(Some(SparseReport { description, summary, raw_bytes, model, segment_bytes, time: begun.elapsed() }))
}

/// The chunks of all tiles, in their order.
fn chunks_of(description: &Description, model: &Model, values: &[f32], watch: &Watch) -> Result<Vec<Chunk>> {
    let tiling = description.tiling();
    watch.begin("encoding", tiling.tiles());
    let chunk = |chunk: u64| {
        let place = tiling.place(chunk, 1);
        let shape = tiling.shape(place.col, place.row);
        let (left, top) = (place.col * tiling.side, place.row * tiling.side);
        let mut tile = model.tile(left..left + shape.width, top..top + shape.height);
        let rows = values.chunks_exact(description.width).skip(top).take(shape.height);
        let voids: Vec<bool> = rows.flat_map(|row| row[left..left + shape.width].iter().map(|v| v.is_nan())).collect();
        if voids.contains(&true) {
            tile.voids = voids;
        }
        let chunk = encode_patch_chunk(description, &model.dictionary, place, &tile)?;
        watch.advance(1)?;
        Ok(chunk)
    };
    let chunks: Vec<Result<Chunk>> = (0..tiling.tiles()).into_par_iter().map(chunk).collect();
    chunks.into_iter().collect()
}

impl SparseReport {
    /// Bits that a cell takes in the file.
    pub fn bits_per_cell(&self) -> f64 {
        self.summary.bytes as f64 * 8.0 / (self.description.width as f64 * self.description.height as f64)
    }
}
