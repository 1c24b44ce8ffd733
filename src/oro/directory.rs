//! The directory: which sections there are, where, and with which checksum.

use super::bytes::{Cursor, put_varint};
use super::footer;
use crate::error::{Error, ErrorKind, Result};
use std::ops::Range;

/// Set in the type of a section without which the file cannot be understood.
const MUST_UNDERSTAND: u8 = 0x80;

/// Type of a section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SectionType {
    /// META: what the raster is.
    Metadata,
    /// INDX: lengths of all segments.
    Index,
    /// OVER: level 6 of the whole raster, once more.
    Overview,
    /// DICT: a dictionary of patches (the sparse profile).
    Dictionary,
    /// One that this program does not know and need not know.
    Unknown(u8),
}

impl SectionType {
    fn number(self) -> u8 {
        match self {
            Self::Metadata => 1,
            Self::Index => 2,
            Self::Overview => 3,
            Self::Dictionary => 4,
            Self::Unknown(number) => number,
        }
    }

    fn from_number(number: u8) -> Self {
        match number {
            1 => Self::Metadata,
            2 => Self::Index,
            3 => Self::Overview,
            4 => Self::Dictionary,
            other => Self::Unknown(other),
        }
    }

    /// Whether this program can do something with it.
    fn is_understood(self) -> bool {
        matches!(self, Self::Metadata | Self::Index | Self::Overview | Self::Dictionary)
    }

    /// The name in the specification.
    pub fn name(self) -> &'static str {
        match self {
            Self::Metadata => "META",
            Self::Index => "INDX",
            Self::Overview => "OVER",
            Self::Dictionary => "DICT",
            Self::Unknown(_) => "unknown",
        }
    }

    /// The place that errors name.
    pub(super) fn place(self) -> &'static str {
        match self {
            Self::Metadata => "section META",
            Self::Index => "section INDX",
            Self::Overview => "section OVER",
            Self::Dictionary => "section DICT",
            Self::Unknown(_) => "section of an unknown type",
        }
    }
}

/// One section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Section {
    /// What is in it.
    pub section: SectionType,
    /// Whether a reader that does not know the type has to give up.
    pub must_understand: bool,
    /// Offset in the file.
    pub offset: u64,
    /// Length in bytes.
    pub length: u64,
    /// CRC-32C of its bytes.
    pub checksum: u32,
}

impl Section {
    /// The bytes of the file that it takes.
    pub fn range(&self) -> Range<u64> {
        self.offset..self.offset + self.length
    }

    /// Compares its bytes with the checksum.
    pub(super) fn check(&self, bytes: &[u8]) -> Result<()> {
        if crc32c::crc32c(bytes) == self.checksum {
            return Ok(());
        }
        Err(Error::new(ErrorKind::Corrupt, "the checksum is wrong: the bytes are damaged")
            .at_place(self.section.place()))
    }
}

/// The directory's bytes.
pub(super) fn write(sections: &[Section]) -> Vec<u8> {
    let mut bytes = vec![];
    for section in sections {
        bytes.push(section.section.number() | if section.must_understand { MUST_UNDERSTAND } else { 0 });
        put_varint(&mut bytes, section.length);
        bytes.extend(section.checksum.to_le_bytes());
    }
    bytes
}

/// Reads the directory, which begins at `offset` of the file. Sections lie without gaps and end where it begins.
pub(super) fn read(bytes: &[u8], offset: u64) -> Result<Vec<Section>> {
    let mut cursor = Cursor::new(bytes, "directory");
    let mut sections: Vec<Section> = vec![];
    while !cursor.is_empty() {
        let number = cursor.u8()?;
        let section = SectionType::from_number(number & !MUST_UNDERSTAND);
        let must_understand = number & MUST_UNDERSTAND != 0;
        let length = cursor.varint()?;
        let checksum = cursor.u32()?;
        if must_understand && !section.is_understood() {
            let message = format!(
                "a section of type {} that this program does not know but would have to: a newer orograph may read it",
                section.number()
            );
            return Err(Error::new(ErrorKind::Unsupported, message).at_place("directory"));
        }
        if section.is_understood() && sections.iter().any(|other| other.section == section) {
            return Err(cursor.corrupt(format!("two sections {}", section.name())));
        }
        sections.push(Section { section, must_understand, offset: 0, length, checksum });
    }
    let mut end = offset;
    for section in sections.iter_mut().rev() {
        let start = end.checked_sub(section.length).filter(|&start| start >= super::header::LENGTH as u64);
        section.offset = start.ok_or_else(|| cursor.corrupt("the sections are longer than the file"))?;
        end = section.offset;
    }
    Ok(sections)
}

/// Greatest length of a directory: it is found in the first read of the file's end.
pub(super) const MAX_LENGTH: usize = 32_768;
const _: () = assert!(MAX_LENGTH + footer::LENGTH < super::reader::OPENING, "the directory is read with the footer");
