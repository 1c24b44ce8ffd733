//! Looks whether a file is what it says: every byte, every checksum, every tile.

use super::area::{Area, read_range};
use super::chunk::{ChunkBytes, same_bits};
use super::directory::SectionType;
use super::footer::{self, HASH};
use super::header;
use super::reader::Reader;
use super::source::RangeRead;
use super::tiling::Place;
use super::window::Window;
use crate::codec::{SEGMENTS, TOP_LEVEL};
use crate::error::{Error, Result};
use crate::watch::Watch;
use sha2::{Digest, Sha256};
use std::fmt;

/// Bytes that are read at once where they need not be understood.
const PIECE: u64 = 1 << 20;

/// What a check found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CheckReport {
    /// What is wrong, in the order of the file; empty when the file is sound.
    pub faults: Vec<Fault>,
    /// Chunks looked at.
    pub chunks: u64,
    /// Bytes looked at: the file's length.
    pub bytes: u64,
}

/// One thing that is wrong.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Where.
    pub place: FaultPlace,
    /// Offset of the damaged part in the file.
    pub offset: u64,
    /// What was found.
    pub message: String,
}

/// Where a fault is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultPlace {
    /// The first bytes of the file. The cells are not touched.
    Header,
    /// A tile; the number of the damaged segment, where one alone is.
    Tile(Place, Option<usize>),
    /// A tile of the overview: coarse levels are read from the tiles instead.
    Overview(Place, Option<usize>),
    /// A section.
    Section(SectionType),
    /// The hash of the whole.
    Hash,
}

impl fmt::Display for FaultPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let tile = |f: &mut fmt::Formatter<'_>, place: &Place, segment: &Option<usize>| {
            write!(f, "{place}")?;
            segment.map_or(Ok(()), |segment| write!(f, ", segment {segment}"))
        };
        match self {
            Self::Header => f.write_str("header"),
            Self::Tile(place, segment) => tile(f, place, segment),
            Self::Overview(place, segment) => {
                f.write_str("overview, ")?;
                tile(f, place, segment)
            }
            Self::Section(section) => f.write_str(section.place()),
            Self::Hash => f.write_str("hash of the whole"),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (offset {}): {}", self.place, self.offset, self.message)
    }
}

/// What looks at one chunk and tells its faults; see [`Reader::check_by`].
pub type Look<'a> = dyn Fn(&ChunkBytes) -> Vec<Fault> + Sync + 'a;

impl<R: RangeRead> Reader<R> {
    /// Reads the whole file in its order, compares every checksum and the hash, and decodes every tile.
    ///
    /// Steps of the watch are bytes. Memory: one run of tiles, at most 16 MiB or one tile, and its cells.
    ///
    /// # Errors
    /// When the source cannot be read or the watch is cancelled; damage is no error but a [`Fault`].
    pub fn check(&self, watch: &Watch) -> Result<CheckReport> {
        self.check_by(watch, &|chunks, look| chunks.iter().flat_map(look).collect())
    }

    /// [`Reader::check`] with tiles looked at in the caller's way, on threads for example: `each` is handed chunks
    /// that lie side by side and has to give back what the look at each of them tells, in the order of the chunks.
    ///
    /// # Errors
    /// As [`Reader::check`].
    pub fn check_by(
        &self,
        watch: &Watch,
        each: &dyn Fn(&[ChunkBytes], &Look<'_>) -> Vec<Fault>,
    ) -> Result<CheckReport> {
        let length = self.file_length();
        watch.begin("checking", length);
        let mut report = CheckReport { bytes: length, ..CheckReport::default() };
        let mut sum = Sha256::new();

        let header = read_range(&self.source, &(0..header::LENGTH as u64))?;
        sum.update(&header);
        match header::read(&header) {
            Ok(profile) if profile == self.footer.profile => {}
            Ok(_) => report.fault(FaultPlace::Header, 0, "version or flags are not those of the footer"),
            Err(error) => report.fault(FaultPlace::Header, 0, error.message()),
        }
        let tiles = &self.tiles;
        let look = |chunk: &ChunkBytes| {
            // Nobody waits for the rest of a check that was cancelled.
            let faults = if watch.check().is_ok() { faults_of(tiles, chunk, FaultPlace::Tile) } else { Vec::new() };
            // Cancelling is noticed when the run is over.
            let _ = watch.advance(chunk.bytes.len() as u64);
            faults
        };
        self.check_area(tiles, &mut report, &mut |chunks| {
            chunks.iter().for_each(|chunk| sum.update(&chunk.bytes));
            let faults = each(chunks, &look);
            watch.check().map(|()| faults)
        })?;

        for section in &self.sections {
            let mut checksum = 0;
            let mut piece = section.offset;
            while piece < section.range().end {
                let end = section.range().end.min(piece + PIECE);
                let bytes = read_range(&self.source, &(piece..end))?;
                checksum = crc32c::crc32c_append(checksum, &bytes);
                sum.update(&bytes);
                watch.advance(end - piece)?;
                piece = end;
            }
            if checksum != section.checksum {
                report.fault(FaultPlace::Section(section.section), section.offset, "the checksum is wrong");
            }
        }
        if let Some(overview) = &self.overview {
            let before = report.faults.len();
            let look = |chunk: &ChunkBytes| faults_of(overview, chunk, FaultPlace::Overview);
            self.check_area(overview, &mut report, &mut |chunks| watch.check().map(|()| each(chunks, &look)))?;
            if report.faults.is_empty() && before == 0 {
                self.compare_overview(&mut report)?;
            }
        }
        let sections_end = self.sections.last().map_or(0, |section| section.range().end);
        let directory = read_range(&self.source, &(sections_end..length - footer::LENGTH as u64))?;
        sum.update(&directory);
        if sum.finalize()[..HASH] != self.footer.hash {
            report.fault(FaultPlace::Hash, length - footer::LENGTH as u64, "the bytes have another hash");
        }
        Ok(report)
    }

    /// Reads the chunks of an area, as many at once as make a run, and gathers their faults.
    fn check_area(
        &self,
        area: &Area,
        report: &mut CheckReport,
        faults_of: &mut dyn FnMut(&[ChunkBytes]) -> Result<Vec<Fault>>,
    ) -> Result<()> {
        let mut next = 0;
        while next < area.index.chunks() {
            // As many chunks as make a run: all of them at once would be a list as long as the raster is large.
            let some = area.runs(next..area.index.chunks().min(next + 256), SEGMENTS);
            for run in some {
                let chunks = area.read(&self.source, &run, SEGMENTS)?;
                report.faults.extend(faults_of(&chunks)?);
                report.chunks += chunks.len() as u64;
                next += chunks.len() as u64;
            }
        }
        Ok(())
    }

    /// The overview has to say what the tiles say.
    fn compare_overview(&self, report: &mut CheckReport) -> Result<()> {
        let Some(overview) = &self.overview else { return Ok(()) };
        for chunk in 0..overview.index.chunks() {
            let place = overview.place(chunk);
            let shape = overview.tiling.shape(place.col, place.row);
            let side = overview.tiling.side;
            let window =
                Window { col: place.col * side, row: place.row * side, width: shape.width, height: shape.height };
            let again = self.window(place.band, TOP_LEVEL, window)?;
            let tiles = self.window_of_tiles(place.band, TOP_LEVEL, window)?;
            if !same_bits(&again, &tiles) {
                let offset = overview.range(chunk, SEGMENTS).start;
                report.fault(FaultPlace::Overview(place, None), offset, "its cells are not those of the tiles");
            }
        }
        Ok(())
    }
}

impl CheckReport {
    /// Whether nothing is wrong.
    pub fn is_sound(&self) -> bool {
        self.faults.is_empty()
    }

    fn fault(&mut self, place: FaultPlace, offset: u64, message: &str) {
        self.faults.push(Fault { place, offset, message: message.into() });
    }
}

/// Faults of one chunk: those of its checksums, else what the codec says.
fn faults_of(area: &Area, chunk: &ChunkBytes, at: fn(Place, Option<usize>) -> FaultPlace) -> Vec<Fault> {
    let range = |segments: usize| area.range(area.chunk(chunk.place), segments);
    let damaged = chunk.segments().1;
    if !damaged.is_empty() {
        let fault = |segment| Fault {
            place: at(chunk.place, Some(segment)),
            offset: range(segment).end,
            message: "the checksum is wrong: the bytes are damaged".into(),
        };
        return damaged.into_iter().map(fault).collect();
    }
    let broken = chunk.check().err();
    let fault =
        |error: Error| Fault { place: at(chunk.place, None), offset: range(0).start, message: error.message().into() };
    broken.map(fault).into_iter().collect()
}
