//! Opens a container and reads tiles.

use super::area::{Area, Run, read_range};
use super::chunk::ChunkBytes;
use super::description::Description;
use super::dictionary::{self, Dictionary};
use super::directory::{self, Section, SectionType};
use super::footer::{self, Footer};
use super::header;
use super::index::Index;
use super::source::RangeRead;
use super::sparse::Sparse;
use super::tiling::Place;
use super::window::Window;
use super::{bytes::Cursor, index, metadata, overview};
use crate::codec::{Cells, SEGMENTS, TOP_LEVEL, segments_for};
use crate::error::{Error, ErrorKind, Result};
use std::ops::Range;
use std::sync::Arc;

/// Bytes that are read from the end of a file to open it.
pub(super) const OPENING: usize = 64 << 10;

/// An open container.
///
/// Opening takes one request for the last 64 KiB, and a second one where index and metadata are larger than that; a
/// dictionary that is not among those bytes takes one more.
/// Afterwards each tile is one request, and so is a run of tiles that lie side by side in the file. A reader changes
/// nothing in itself, so threads may share it if they may share the source.
#[derive(Debug)]
pub struct Reader<R> {
    pub(super) source: R,
    pub(super) description: Description,
    pub(super) sections: Vec<Section>,
    pub(super) footer: Footer,
    pub(super) tiles: Area,
    pub(super) overview: Option<Area>,
}

impl<R: RangeRead> Reader<R> {
    /// Reads what there is to know before the first tile.
    ///
    /// # Errors
    /// [`ErrorKind::Corrupt`] when this is no container, or its directory, metadata or index are damaged;
    /// [`ErrorKind::Unsupported`] when a newer program is needed.
    pub fn open(source: R) -> Result<Self> {
        let length = source.len()?;
        if length < (header::LENGTH + footer::LENGTH) as u64 {
            let message = format!("{length} bytes are too few for an .oro file");
            return Err(Error::new(ErrorKind::Corrupt, message));
        }
        let tail = Tail::read(&source, length)?;
        if !Footer::ends(&tail.bytes) {
            return Err(endless(&source));
        }
        let (footer, directory) = Footer::read(&tail.bytes)?;
        footer.profile.check().map_err(|error| error.at_place("footer"))?;
        if footer.file_length != length {
            let message = format!("the file has {length} bytes and should have {}", footer.file_length);
            return Err(Error::new(ErrorKind::Corrupt, message).at_place("footer"));
        }
        // A small file is here as a whole, so its header is looked at too; else only `check` does that.
        if tail.start == 0 && header::read(&tail.bytes[..header::LENGTH])? != footer.profile {
            let message = "version or flags are not those of the footer";
            return Err(Error::new(ErrorKind::Corrupt, message).at_place("header"));
        }
        let sections = directory::read(directory, length - (footer::LENGTH + directory.len()) as u64)?;
        let find = |wanted: SectionType| sections.iter().find(|section| section.section == wanted);
        let needed = |wanted: SectionType| {
            let message = "the file has none";
            find(wanted).ok_or_else(|| Error::new(ErrorKind::Corrupt, message).at_place(wanted.place()))
        };
        let (meta, indx) = (needed(SectionType::Metadata)?, needed(SectionType::Index)?);
        let [metadata, index] = tail.sections(&source, [meta, indx])?;
        meta.check(&metadata)?;
        indx.check(&index)?;

        let start = header::LENGTH as u64;
        let chunk_bytes = sections.first().map_or(0, |section| section.offset) - start;
        let description = metadata::read(&metadata, chunk_bytes)?;
        let mut cursor = Cursor::new(&index, SectionType::Index.place());
        let rules: Vec<_> = description.bands.iter().map(|band| band.rule).collect();
        let sparse = match find(SectionType::Dictionary) {
            None => None,
            Some(section) => {
                let [bytes] = tail.sections(&source, [section])?;
                section.check(&bytes)?;
                let dictionary = dictionary::read(&bytes, &description)?;
                Some(Arc::new(Sparse { lattice: dictionary.lattice(&description), dictionary }))
            }
        };
        let tiles = Area {
            sparse,
            tiling: description.tiling(),
            start,
            index: Index::read(&mut cursor, description.chunks(), chunk_bytes)?,
            rules,
        };
        let overview = match find(SectionType::Overview) {
            None => None,
            Some(_) if tiles.sparse.is_some() => {
                let message = "there is a section OVER, which patches do not need";
                return Err(Error::new(ErrorKind::Corrupt, message).at_place(SectionType::Dictionary.place()));
            }
            Some(section) => {
                let tiling = overview::tiling(&description);
                let chunks = tiling.tiles() * description.bands.len() as u64;
                index::check_count(chunks, section.length)?;
                Some(Area {
                    sparse: None,
                    tiling,
                    start: section.offset,
                    index: Index::read(&mut cursor, chunks, section.length)?,
                    rules: tiles.rules.iter().map(|&rule| overview::rule(rule)).collect(),
                })
            }
        };
        cursor.end()?;
        Ok(Self { source, description, sections, footer, tiles, overview })
    }

    /// What the raster is.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// The sections of the file, in their order.
    pub fn sections(&self) -> &[Section] {
        &self.sections
    }

    /// The dictionary of a file of the sparse profile.
    pub fn dictionary(&self) -> Option<&Dictionary> {
        self.tiles.sparse.as_deref().map(|sparse| &sparse.dictionary)
    }

    /// Length of the file.
    pub fn file_length(&self) -> u64 {
        self.footer.file_length
    }

    /// Version of the format that the file is written in.
    pub fn version(&self) -> u16 {
        self.footer.profile.version
    }

    /// First 16 bytes of the SHA-256 of everything before the footer, as the file states it.
    pub fn hash(&self) -> [u8; footer::HASH] {
        self.footer.hash
    }

    /// What the chunks take in the file, with their checksums.
    pub fn chunk_bytes(&self) -> u64 {
        let Range { start, end } = self.tiles.bytes();
        end - start
    }

    /// What the chunks' segments take together, coarse to fine, without checksums.
    pub fn segment_bytes(&self) -> [u64; SEGMENTS] {
        self.tiles.index.segment_bytes()
    }

    /// The cells of a tile at a level from 0 to 6, in one request; those of a tile of patches, to which the patches of
    /// its neighbours belong, in a few.
    ///
    /// # Errors
    /// When the raster has no such tile, or its bytes are damaged.
    pub fn tile(&self, place: Place, level: u8) -> Result<Cells> {
        if self.tiles.sparse.is_some() && self.tiles.contains(place) && level <= TOP_LEVEL {
            let (shape, side) = (self.tiles.tiling.shape(place.col, place.row).at_level(level), self.tiles.tiling.side);
            let (col, row) = (place.col * (side >> level), place.row * (side >> level));
            return self.window(place.band, level, Window { col, row, width: shape.width, height: shape.height });
        }
        self.chunk(place, level)?.decode(level)
    }

    /// The bytes of a chunk, as many as a level needs, in one request; [`ChunkBytes::decode`] turns them into cells.
    ///
    /// # Errors
    /// When the raster has no such tile, or the source cannot be read.
    pub fn chunk(&self, place: Place, level: u8) -> Result<ChunkBytes> {
        self.chunks(&[place], level)?.pop().ok_or_else(|| Error::usage("no chunk was asked for"))
    }

    /// The bytes of many chunks, in the order of the file, with one request for those that lie side by side.
    ///
    /// # Errors
    /// When the raster has no such tile, or the source cannot be read.
    pub fn chunks(&self, places: &[Place], level: u8) -> Result<Vec<ChunkBytes>> {
        if let Some(place) = places.iter().find(|&&place| !self.tiles.contains(place)) {
            return Err(Error::usage(format!("{place}: the raster has no such tile")));
        }
        let mut chunks: Vec<u64> = places.iter().map(|&place| self.tiles.chunk(place)).collect();
        chunks.sort_unstable();
        chunks.dedup();
        let segments = segments_for(level);
        let read = |run: &Run| self.tiles.read(&self.source, run, segments);
        Ok(self.tiles.runs(chunks, segments).iter().map(read).collect::<Result<Vec<_>>>()?.concat())
    }
}

/// The end of a file.
struct Tail {
    start: u64,
    bytes: Vec<u8>,
}

impl Tail {
    fn read(source: &impl RangeRead, length: u64) -> Result<Self> {
        let start = length.saturating_sub(OPENING as u64);
        Ok(Self { start, bytes: read_range(source, &(start..length))? })
    }

    /// The bytes of sections, with one more request for what lies before the tail.
    fn sections<const N: usize>(&self, source: &impl RangeRead, sections: [&Section; N]) -> Result<[Vec<u8>; N]> {
        let before = |section: &Section| section.offset..section.range().end.min(self.start).max(section.offset);
        let missing = sections.map(before);
        let wanted: u64 = missing.iter().map(|range| range.end - range.start).sum();
        let needed = || missing.iter().filter(|range| !range.is_empty());
        let first = needed().map(|range| range.start).min().unwrap_or(self.start);
        let last = needed().map(|range| range.end).max().unwrap_or(self.start);
        // Sections that are needed usually lie side by side; where they do not, each is read alone.
        let together = last - first <= wanted + OPENING as u64;
        let shared = if together { read_range(source, &(first..last))? } else { vec![] };
        let mut found = [const { vec![] }; N];
        for ((bytes, section), range) in found.iter_mut().zip(sections).zip(&missing) {
            if together && !range.is_empty() {
                bytes.extend(&shared[(range.start - first) as usize..(range.end - first) as usize]);
            } else if !range.is_empty() {
                *bytes = read_range(source, range)?;
            }
            let rest = range.end.max(self.start)..section.range().end.max(self.start);
            bytes.extend(&self.bytes[(rest.start - self.start) as usize..(rest.end - self.start) as usize]);
        }
        Ok(found)
    }
}

/// What there is to say of a file without a footer.
fn endless(source: &impl RangeRead) -> Error {
    let head = match read_range(source, &(0..header::LENGTH as u64)) {
        Ok(head) => head,
        Err(error) => return error,
    };
    let message = if head.starts_with(&header::MAGIC) {
        "the file begins as an .oro file and does not end as one: it was cut off, or never finished, and the list of \
         what is in it is missing; fetch it again"
    } else {
        "this is no .oro file: it neither begins nor ends as one"
    };
    Error::new(ErrorKind::Corrupt, message).at_place("footer")
}
