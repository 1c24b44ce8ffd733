//! The job behind `orograph verify`: whether a container is what it says.

use super::super::memory;
use super::container::open;
use crate::error::Result;
use crate::oro::{CheckReport, ChunkBytes, Fault, Look, Reader};
use crate::watch::Watch;
use rayon::prelude::*;
use std::fs::File;
use std::path::Path;

/// Reads a container from end to end, and decodes every tile, on all threads. The report does not depend on them.
///
/// # Errors
/// When it cannot be opened or read; damage inside is no error but a fault in the report.
pub fn run(path: &Path, watch: &Watch) -> Result<CheckReport> {
    let reader = open(path)?;
    let at_once = tiles_at_once(&reader);
    let each = |chunks: &[ChunkBytes], look: &Look<'_>| -> Vec<Fault> {
        // What threads find is put into the order of the chunks.
        chunks.chunks(at_once).flat_map(|some| some.par_iter().flat_map_iter(look).collect::<Vec<_>>()).collect()
    };
    reader.check_by(watch, &each).map_err(|error| error.at_path(path))
}

/// How many tiles may be decoded at the same time: all that threads can take, unless tiles are so large that the memory
/// holds only a few.
fn tiles_at_once(reader: &Reader<File>) -> usize {
    let tile = (reader.description().tile_side as u64).pow(2) * memory::CODEC_BYTES_PER_CELL;
    let fit = usize::try_from(memory::free_bytes() / tile).unwrap_or(usize::MAX).max(1);
    if fit < rayon::current_num_threads() { fit } else { usize::MAX }
}
