//! What was learned, in a file of its own: `format-spec/learned.md` describes it.

use super::super::cell_size::CellSize;
use super::super::exemplar::Record;
use super::super::method::Method;
use super::super::mode::Mode;
use super::{Learned, LearnedSummary};
use crate::amplify::keep::{Cursor, Kind, put_f64, put_text, put_u8, put_u16, put_u32, put_u64};
use crate::error::{Error, ErrorKind, Result};
use crate::io::output::Output;
use crate::oro::{self, checksum};
use crate::pipeline::memory;
use crate::watch::Watch;
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

/// The first bytes of the file.
const MAGIC: [u8; 4] = [0x89, b'O', b'R', b'L'];
/// The version of the format.
const VERSION: u16 = 1;
/// Bytes of the header before its checksum, and with it.
const SUMMED: usize = 16;
const HEADER: usize = 20;

/// Whether a file holds what was learned, by its first bytes.
pub fn is_learned(path: &Path) -> bool {
    let mut first = [0; MAGIC.len()];
    File::open(path).is_ok_and(|mut file| file.read_exact(&mut first).is_ok() && first == MAGIC)
}

/// What a file holds.
///
/// # Errors
/// When it cannot be read, is damaged or of a newer version, or there is no room for what it holds.
pub fn describe(path: &Path, memory: Option<u64>, watch: &Watch) -> Result<LearnedSummary> {
    let (learned, bytes) = Learned::read(path, memory, watch)?;
    Ok(learned.summary(bytes))
}

impl Learned {
    /// Reads a file, and how many bytes it has.
    ///
    /// # Errors
    /// As [`describe`].
    pub(in super::super) fn read(path: &Path, memory: Option<u64>, watch: &Watch) -> Result<(Self, u64)> {
        let unreadable = |error| Error::new(ErrorKind::Input, format!("it cannot be read: {error}")).at_path(path);
        let room = memory.unwrap_or_else(memory::free_bytes);
        let length = fs::metadata(path).map_err(unreadable)?.len();
        memory::admit_or(length, room, "say how much there is with --memory").map_err(|error| error.at_path(path))?;
        let bytes = fs::read(path).map_err(unreadable)?;
        let learned = Self::decoded(&bytes, room, watch).map_err(|error| error.at_path(path))?;
        Ok((learned, bytes.len() as u64))
    }

    /// Writes a file that was begun; returns how many bytes it has.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(in super::super) fn write(&self, output: Output) -> Result<u64> {
        let bytes = self.encoded().map_err(|error| error.at_path(output.target()))?;
        fs::write(output.path(), &bytes).map_err(|error| {
            let message = format!("it cannot be written ({error}); is there room left?");
            Error::new(ErrorKind::Output, message).at_path(output.target())
        })?;
        output.finish()?;
        Ok(bytes.len() as u64)
    }

    /// The file's bytes.
    ///
    /// # Errors
    /// When a number has no room there.
    pub(super) fn encoded(&self) -> Result<Vec<u8>> {
        let mut body = vec![];
        put_u8(&mut body, self.mode.tag());
        put_u8(&mut body, self.method.kind().tag());
        put_u16(&mut body, self.method.factor() as u16);
        put_u64(&mut body, if self.mode.draws_in_learning() { self.seed } else { 0 });
        put_cell(&mut body, self.cell);
        put_u16(
            &mut body,
            u16::try_from(self.exemplars.len()).map_err(|_| {
                Error::new(
                    ErrorKind::Unsupported,
                    format!("{} exemplars: at most 65535 can be kept", self.exemplars.len()),
                )
            })?,
        );
        for record in &self.exemplars {
            put_text(&mut body, &record.name);
            record.size.iter().for_each(|&side| put_u32(&mut body, side as u32));
            put_cell(&mut body, record.cell);
            put_u8(&mut body, u8::from(record.slope.is_some()));
            put_f64(&mut body, record.slope.unwrap_or(0.0));
        }
        self.method.put(&mut body)?;
        Ok(sealed(&body))
    }

    /// Reads the file's bytes; what it holds may take so many bytes of memory.
    pub(super) fn decoded(bytes: &[u8], room: u64, watch: &Watch) -> Result<Self> {
        let mut cursor = Cursor::new(body(bytes)?, room);
        let tag = cursor.u8("the mode")?;
        let mode = Mode::of(tag).ok_or_else(|| unknown("mode", tag))?;
        let tag = cursor.u8("the kind of what was learned")?;
        let kind = Kind::of(tag).ok_or_else(|| unknown("kind of what was learned", tag))?;
        let factor = usize::from(cursor.u16("the factor")?);
        let seed = cursor.u64("the seed")?;
        let cell = take_cell(&mut cursor, "the cells")?;
        let mut exemplars = vec![];
        for number in 1..=cursor.u16("the number of exemplars")? {
            let what = format!("exemplar {number}");
            exemplars.push(Record {
                name: cursor.text(&what)?,
                size: [cursor.u32(&what)?, cursor.u32(&what)?].map(|side| side as usize),
                cell: take_cell(&mut cursor, &what)?,
                slope: match (cursor.flag(&what)?, cursor.f64_from(0.0, &what)?) {
                    (true, slope) => Some(slope),
                    (false, _) => None,
                },
            });
        }
        let method = Method::take(&mut cursor, kind, factor, seed, watch)?;
        cursor.end()?;
        if !method.suits(mode) {
            let message = format!("what was learned is of another kind than mode {} takes", mode.name());
            return Err(Error::new(ErrorKind::Corrupt, message));
        }
        Ok(Self { mode, cell, seed, exemplars, method })
    }
}

/// A body behind its header.
pub(super) fn sealed(body: &[u8]) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    put_u16(&mut bytes, VERSION);
    put_u16(&mut bytes, 0);
    put_u64(&mut bytes, (HEADER + body.len()) as u64);
    let sum = checksum(&[&bytes, body]);
    put_u32(&mut bytes, sum);
    bytes.extend(body);
    bytes
}

/// What follows the header, once this is right.
fn body(bytes: &[u8]) -> Result<&[u8]> {
    if !bytes.starts_with(&MAGIC) {
        let message = match bytes.starts_with(&oro::MAGIC) {
            true => {
                "it is an .oro container, and not what orograph learn --multires keeps; a dictionary is for encode --sparse"
            }
            false => "it is not what orograph learn --multires keeps: other files begin otherwise",
        };
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    let corrupt = |message: String| Err(Error::new(ErrorKind::Corrupt, message));
    let Some((header, body)) = bytes.split_at_checked(HEADER) else {
        return corrupt(format!(
            "{} bytes, and its header alone has {HEADER}: it was cut off; copy it again",
            bytes.len()
        ));
    };
    let mut cursor = Cursor::new(&header[MAGIC.len()..], 0);
    let (version, flags) = (cursor.u16("the version")?, cursor.u16("the flags")?);
    if (version, flags) != (VERSION, 0) {
        let message = format!(
            "version {version} of the format with flags {flags}: this program knows version {VERSION} without flags; take a \
             newer one, or learn again"
        );
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    let length = cursor.u64("the length")?;
    if length != bytes.len() as u64 {
        return corrupt(format!("{} bytes, and its header says {length}: it was cut off; copy it again", bytes.len()));
    }
    if cursor.u32("the checksum")? != checksum(&[&header[..SUMMED], body]) {
        return corrupt("it is damaged: its checksum is not that of its bytes; copy it again, or learn again".into());
    }
    Ok(body)
}

fn put_cell(out: &mut Vec<u8>, cell: CellSize) {
    put_f64(out, cell.across_m);
    put_f64(out, cell.down_m);
}

fn take_cell(cursor: &mut Cursor<'_>, what: &str) -> Result<CellSize> {
    let mut side = || cursor.f64_from(f64::MIN_POSITIVE, what);
    Ok(CellSize { across_m: side()?, down_m: side()? })
}

/// A tag that may be one of a later version.
fn unknown(what: &str, tag: u8) -> Error {
    let message = format!("{what} {tag}, which this program does not know; take a newer one, or learn again");
    Error::new(ErrorKind::Unsupported, message)
}
