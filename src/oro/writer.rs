//! Writes a container in one pass, to anything that takes bytes.

use super::chunk::{Chunk, stored_length};
use super::description::Description;
use super::dictionary::{self, Dictionary};
use super::directory::{self, Section, SectionType};
use super::footer::{Footer, HASH};
use super::header::{self, Profile};
use super::{index, metadata, overview};
use crate::codec::SEGMENTS;
use crate::error::{Error, ErrorKind, Result};
use sha2::{Digest, Sha256};
use std::io::Write;

/// Writes chunks in their order, then everything else. Nothing is read back or sought, so a pipe will do.
///
/// In memory it keeps 16 bytes for each chunk, the overview's bytes, and one row of the overview's tiles: all
/// together about a thousandth of the raster. Chunks come from [`super::encode_chunk`], which threads may call at
/// once; the file's bytes depend on nothing but cells and description.
#[derive(Debug)]
pub struct Writer<W> {
    out: W,
    sum: Sha256,
    written: u64,
    description: Description,
    lengths: Vec<[u32; SEGMENTS]>,
    overview: Option<overview::Builder>,
    dictionary: Option<Dictionary>,
    largest_errors: Vec<f64>,
}

/// What was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Length of the file.
    pub bytes: u64,
    /// How much of it are chunks: the cells themselves.
    pub chunk_bytes: u64,
    /// Number of chunks: tiles times bands.
    pub chunks: u64,
    /// Sections and their lengths.
    pub sections: Vec<Section>,
    /// The largest error of a cell in each band, in stored values.
    pub largest_errors: Vec<f64>,
}

impl<W: Write> Writer<W> {
    /// Begins a file.
    ///
    /// # Errors
    /// When a container cannot hold the raster, or the bytes cannot be written.
    pub fn new(out: W, description: Description) -> Result<Self> {
        Self::begin(out, description, None)
    }

    /// Begins a file of the sparse profile, whose chunks come from [`super::encode_patch_chunk`].
    ///
    /// # Errors
    /// As [`Writer::new`], and when the dictionary is none for such a raster.
    pub fn sparse(out: W, description: Description, dictionary: Dictionary) -> Result<Self> {
        Self::begin(out, description, Some(dictionary))
    }

    fn begin(out: W, description: Description, dictionary: Option<Dictionary>) -> Result<Self> {
        description.check()?;
        dictionary.iter().try_for_each(|dictionary| dictionary.check(&description))?;
        // Patches have the cells of any level without those between.
        let has_overview = description.has_overview() && dictionary.is_none();
        let overview = has_overview.then(|| overview::Builder::new(&description));
        let largest_errors = vec![0.0; description.bands.len()];
        let mut writer = Self {
            out,
            sum: Sha256::new(),
            written: 0,
            description,
            lengths: vec![],
            overview,
            dictionary,
            largest_errors,
        };
        writer.put(&header::write(Profile::WRITTEN))?;
        Ok(writer)
    }

    /// What is being written.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// Writes the next chunk: tiles row by row, in each tile band by band.
    ///
    /// # Errors
    /// When it is another's turn, or the bytes cannot be written.
    pub fn push(&mut self, chunk: &Chunk) -> Result<()> {
        let next = self.lengths.len() as u64;
        let (tiling, bands) = (self.description.tiling(), self.description.bands.len());
        let expected = tiling.place(next, bands);
        if next == self.description.chunks() || chunk.place != expected {
            let message = format!("the chunk of {} came when that of {expected} was next", chunk.place);
            return Err(Error::usage(message));
        }
        if stored_length(&chunk.lengths, SEGMENTS) != chunk.bytes.len() as u64 || chunk.lengths[0] == 0 {
            return Err(Error::usage("the chunk's lengths are not those of its bytes"));
        }
        self.put(&chunk.bytes)?;
        self.lengths.push(chunk.lengths);
        let largest = &mut self.largest_errors[chunk.place.band];
        *largest = largest.max(chunk.largest_error);
        self.overview.as_mut().map_or(Ok(()), |overview| overview.push(chunk.place, &chunk.top))
    }

    /// Writes the sections, the directory and the footer, and gives back what the bytes went to.
    ///
    /// # Errors
    /// When chunks are missing, or the bytes cannot be written.
    pub fn finish(mut self) -> Result<(W, Summary)> {
        let (chunks, expected) = (self.lengths.len() as u64, self.description.chunks());
        if chunks != expected {
            return Err(Error::usage(format!("{chunks} chunks were written of {expected}")));
        }
        let chunk_bytes = self.written - header::LENGTH as u64;
        let mut sections = vec![];
        let mut index = vec![];
        index::write(&mut index, &self.lengths);
        if let Some(overview) = self.overview.take() {
            index::write(&mut index, &overview.lengths);
            self.put_section(&mut sections, SectionType::Overview, &overview.bytes)?;
        }
        if let Some(dictionary) = self.dictionary.take() {
            self.put_section(&mut sections, SectionType::Dictionary, &dictionary::write(&dictionary))?;
        }
        let metadata = metadata::write(&self.description);
        self.put_section(&mut sections, SectionType::Metadata, &metadata)?;
        self.put_section(&mut sections, SectionType::Index, &index)?;

        let directory = directory::write(&sections);
        self.put(&directory)?;
        let mut hash = [0; HASH];
        hash.copy_from_slice(&self.sum.finalize_reset()[..HASH]);
        let footer = Footer {
            file_length: self.written + super::footer::LENGTH as u64,
            hash,
            directory_length: directory.len() as u16,
            profile: Profile::WRITTEN,
        };
        self.put(&footer.write(&directory))?;
        self.out.flush().map_err(|error| unwritable(&error))?;
        let summary =
            Summary { bytes: self.written, chunk_bytes, chunks, sections, largest_errors: self.largest_errors };
        Ok((self.out, summary))
    }

    fn put(&mut self, bytes: &[u8]) -> Result<()> {
        self.out.write_all(bytes).map_err(|error| unwritable(&error))?;
        self.sum.update(bytes);
        self.written += bytes.len() as u64;
        Ok(())
    }

    fn put_section(&mut self, sections: &mut Vec<Section>, section: SectionType, bytes: &[u8]) -> Result<()> {
        sections.push(Section {
            section,
            // The overview repeats what the tiles say.
            must_understand: section != SectionType::Overview,
            offset: self.written,
            length: bytes.len() as u64,
            checksum: crc32c::crc32c(bytes),
        });
        self.put(bytes)
    }
}

fn unwritable(error: &std::io::Error) -> Error {
    Error::new(ErrorKind::Output, format!("cannot be written: {error}"))
}
