//! The footer: the last bytes of a file, from which a reader finds everything else.

use super::bytes::Cursor;
use super::directory;
use super::header::Profile;
use crate::error::Result;

/// Last bytes of every container.
pub(super) const MAGIC: [u8; 4] = *b"ORO\x89";
/// Length of the footer.
pub(super) const LENGTH: usize = 38;
/// Where in the footer its checksum stands.
const CHECKSUM_AT: usize = 30;
/// Bytes of the SHA-256 that are kept.
pub(super) const HASH: usize = 16;

/// What the footer says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Footer {
    /// Length of the whole file.
    pub(super) file_length: u64,
    /// First bytes of the SHA-256 of everything before the footer.
    pub(super) hash: [u8; HASH],
    /// Length of the directory, which ends where the footer begins.
    pub(super) directory_length: u16,
    /// Version and flags, as in the header.
    pub(super) profile: Profile,
}

impl Footer {
    /// The footer's bytes; its checksum is also the directory's.
    pub(super) fn write(&self, directory: &[u8]) -> Vec<u8> {
        let mut bytes = self.file_length.to_le_bytes().to_vec();
        bytes.extend(self.hash);
        bytes.extend(self.directory_length.to_le_bytes());
        bytes.extend(self.profile.version.to_le_bytes());
        bytes.extend(self.profile.flags.to_le_bytes());
        bytes.extend(checksum(directory, &bytes).to_le_bytes());
        bytes.extend(MAGIC);
        bytes
    }

    /// Whether the last bytes of a file are those of a footer.
    pub(super) fn ends(tail: &[u8]) -> bool {
        tail.ends_with(&MAGIC)
    }

    /// Reads the footer and finds the directory before it, in the last bytes of a file.
    ///
    /// `tail` must end as a footer does ([`Footer::ends`], which whoever opens a file asks first), and be longer than a
    /// footer and the greatest directory, or be the whole file.
    pub(super) fn read(tail: &[u8]) -> Result<(Self, &[u8])> {
        let mut cursor = Cursor::new(&tail[tail.len().saturating_sub(LENGTH)..], "footer");
        let bytes = cursor.take(LENGTH)?;
        let mut fields = Cursor::new(bytes, "footer");
        let file_length = fields.u64()?;
        let mut hash = [0; HASH];
        hash.copy_from_slice(fields.take(HASH)?);
        let directory_length = fields.u16()?;
        let profile = Profile { version: fields.u16()?, flags: fields.u16()? };
        if usize::from(directory_length) > directory::MAX_LENGTH {
            return Err(fields.corrupt(format!("a directory of {directory_length} bytes")));
        }
        let end = tail.len() - LENGTH;
        let directory = end.checked_sub(usize::from(directory_length)).map(|start| &tail[start..end]);
        let directory = directory.ok_or_else(|| fields.corrupt("the directory is longer than the file"))?;
        if fields.u32()? != checksum(directory, &bytes[..CHECKSUM_AT]) {
            return Err(fields.corrupt("the checksum is wrong: the bytes are damaged"));
        }
        Ok((Self { file_length, hash, directory_length, profile }, directory))
    }
}

fn checksum(directory: &[u8], fields: &[u8]) -> u32 {
    crc32c::crc32c_append(crc32c::crc32c(directory), fields)
}
