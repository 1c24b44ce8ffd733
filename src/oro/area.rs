//! A row of chunks in the file: the tiles of a raster, or those of its overview.

use super::chunk::{ChunkBytes, stored_length};
use super::index::Index;
use super::source::RangeRead;
use super::sparse::Sparse;
use super::tiling::{Place, Tiling};
use crate::codec::{BandRule, SEGMENTS};
use crate::error::{Error, ErrorKind, Result};
use std::ops::Range;
use std::sync::Arc;

/// Chunks that lie no further apart are read in one request.
const GAP: u64 = 64 << 10;
/// Chunks are read together up to so many bytes; a single one may be larger.
const MAX_RUN: u64 = 16 << 20;

/// Chunks with what is needed to find and to decode them.
#[derive(Debug)]
pub(super) struct Area {
    /// How chunks are patches, where they are no cells.
    pub(super) sparse: Option<Arc<Sparse>>,
    pub(super) tiling: Tiling,
    pub(super) rules: Vec<BandRule>,
    pub(super) start: u64,
    pub(super) index: Index,
}

/// Chunks that one request reads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) range: Range<u64>,
    pub(super) chunks: Vec<u64>,
}

impl Area {
    pub(super) fn place(&self, chunk: u64) -> Place {
        self.tiling.place(chunk, self.rules.len())
    }

    pub(super) fn chunk(&self, place: Place) -> u64 {
        self.tiling.chunk(place, self.rules.len())
    }

    /// Whether the place is one of the area's.
    pub(super) fn contains(&self, place: Place) -> bool {
        self.tiling.contains(place.col, place.row) && place.band < self.rules.len()
    }

    /// Where the first segments of a chunk stand in the file.
    pub(super) fn range(&self, chunk: u64, segments: usize) -> Range<u64> {
        let start = self.start + self.index.offset(chunk);
        start..start + stored_length(&self.index.lengths(chunk), segments)
    }

    /// Requests for the first segments of chunks in ascending order: neighbours together.
    pub(super) fn runs(&self, chunks: impl IntoIterator<Item = u64>, segments: usize) -> Vec<Run> {
        let mut runs: Vec<Run> = vec![];
        for chunk in chunks {
            let range = self.range(chunk, segments);
            match runs.last_mut() {
                Some(run) if range.start - run.range.end <= GAP && range.end - run.range.start <= MAX_RUN => {
                    run.range.end = range.end;
                    run.chunks.push(chunk);
                }
                _ => runs.push(Run { range, chunks: vec![chunk] }),
            }
        }
        runs
    }

    /// Reads a run.
    pub(super) fn read(&self, source: &impl RangeRead, run: &Run, segments: usize) -> Result<Vec<ChunkBytes>> {
        let bytes = read_range(source, &run.range)?;
        let part = |chunk: u64| {
            let range = self.range(chunk, segments);
            let start = (range.start - run.range.start) as usize;
            let place = self.place(chunk);
            ChunkBytes {
                place,
                shape: self.tiling.shape(place.col, place.row),
                side: self.tiling.side,
                rule: self.rules[place.band],
                sparse: self.sparse.clone(),
                lengths: self.index.lengths(chunk),
                bytes: bytes[start..start + (range.end - range.start) as usize].to_vec(),
            }
        };
        Ok(run.chunks.iter().map(|&chunk| part(chunk)).collect())
    }

    /// What the area takes in the file.
    pub(super) fn bytes(&self) -> Range<u64> {
        self.range(0, 0).start..self.range(self.index.chunks() - 1, SEGMENTS).end
    }
}

/// Reads a range that is known to lie in the file.
pub(super) fn read_range(source: &impl RangeRead, range: &Range<u64>) -> Result<Vec<u8>> {
    if range.is_empty() {
        return Ok(vec![]);
    }
    let length = usize::try_from(range.end - range.start)
        .map_err(|_| Error::new(ErrorKind::Unsupported, "more bytes in one piece than this machine can hold"))?;
    let bytes = source.read_at(range.start, length)?;
    if bytes.len() == length {
        return Ok(bytes);
    }
    let message = format!("{} bytes came when {length} were asked for at offset {}", bytes.len(), range.start);
    Err(Error::new(ErrorKind::Input, message))
}
