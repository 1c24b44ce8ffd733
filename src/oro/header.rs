//! The header: the first bytes of a file, by which programs know it.

use super::bytes::Cursor;
use crate::error::{Error, ErrorKind, Result};

/// First bytes of every container.
pub const MAGIC: [u8; 4] = *b"\x89ORO";
/// The version of the format that this program writes; it reads the versions from 1 to this one.
pub const VERSION: u16 = 1;
/// Length of the header.
pub(super) const LENGTH: usize = 12;

/// Version and flags, which header and footer both hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Profile {
    /// Version of the format.
    pub(super) version: u16,
    /// No flag has a meaning yet.
    pub(super) flags: u16,
}

impl Profile {
    /// What this program writes.
    pub(super) const WRITTEN: Self = Self { version: VERSION, flags: 0 };

    /// Whether this program can read such a file.
    pub(super) fn check(self) -> Result<()> {
        let Self { version, flags } = self;
        if version == 0 {
            return Err(Error::new(ErrorKind::Corrupt, "version 0 of the format: expected 1 or more"));
        }
        if version > VERSION || flags != 0 {
            let message = format!(
                "version {version} of the format with flags {flags:#x}, of which this program knows version {VERSION} without flags: a newer orograph may read it"
            );
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        Ok(())
    }
}

/// The header's bytes.
pub(super) fn write(profile: Profile) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    bytes.extend(profile.version.to_le_bytes());
    bytes.extend(profile.flags.to_le_bytes());
    bytes.extend(crc32c::crc32c(&bytes).to_le_bytes());
    bytes
}

/// Reads a header; the profile is not yet looked at.
pub(super) fn read(bytes: &[u8]) -> Result<Profile> {
    let mut cursor = Cursor::new(bytes, "header");
    if cursor.take(4)? != MAGIC {
        return Err(cursor.corrupt("these are not the first bytes of an .oro file"));
    }
    let profile = Profile { version: cursor.u16()?, flags: cursor.u16()? };
    if cursor.u32()? != crc32c::crc32c(&bytes[..8]) {
        return Err(cursor.corrupt("the checksum is wrong: the bytes are damaged"));
    }
    cursor.end()?;
    Ok(profile)
}
