//! Where the bytes of a container come from.

use crate::error::{Error, ErrorKind, Result};

/// Something that hands out ranges of its bytes: memory, a file, an object behind HTTP range requests.
///
/// Every call is taken to be expensive, so the [`super::Reader`] makes few of them, and asks for nothing beyond
/// [`RangeRead::len`].
pub trait RangeRead {
    /// Number of bytes in all.
    ///
    /// # Errors
    /// When the source cannot say.
    fn len(&self) -> Result<u64>;

    /// Exactly `length` bytes from `offset` on.
    ///
    /// # Errors
    /// When there are not that many, or they cannot be read.
    fn read_at(&self, offset: u64, length: usize) -> Result<Vec<u8>>;

    /// Whether there are no bytes at all.
    ///
    /// # Errors
    /// When the source cannot say.
    fn is_empty(&self) -> Result<bool> {
        Ok(self.len()? == 0)
    }
}

impl<R: RangeRead + ?Sized> RangeRead for &R {
    fn len(&self) -> Result<u64> {
        (**self).len()
    }

    fn read_at(&self, offset: u64, length: usize) -> Result<Vec<u8>> {
        (**self).read_at(offset, length)
    }
}

impl RangeRead for [u8] {
    fn len(&self) -> Result<u64> {
        Ok(<[u8]>::len(self) as u64)
    }

    fn read_at(&self, offset: u64, length: usize) -> Result<Vec<u8>> {
        let range = usize::try_from(offset).ok().and_then(|from| self.get(from..from.checked_add(length)?));
        range.map(<[u8]>::to_vec).ok_or_else(|| Error::new(ErrorKind::Corrupt, "the bytes end early"))
    }
}

impl RangeRead for Vec<u8> {
    fn len(&self) -> Result<u64> {
        RangeRead::len(self.as_slice())
    }

    fn read_at(&self, offset: u64, length: usize) -> Result<Vec<u8>> {
        self.as_slice().read_at(offset, length)
    }
}

// Positioned reads need no cursor, so several threads can share one file.
#[cfg(any(unix, windows))]
impl RangeRead for std::fs::File {
    fn len(&self) -> Result<u64> {
        Ok(self.metadata().map_err(unreadable)?.len())
    }

    fn read_at(&self, offset: u64, length: usize) -> Result<Vec<u8>> {
        let mut bytes = vec![0; length];
        read_exact_at(self, &mut bytes, offset).map_err(unreadable)?;
        Ok(bytes)
    }
}

#[cfg(any(unix, windows))]
fn unreadable(error: std::io::Error) -> Error {
    Error::new(ErrorKind::Input, format!("cannot be read: {error}"))
}

#[cfg(unix)]
fn read_exact_at(file: &std::fs::File, bytes: &mut [u8], offset: u64) -> std::io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, bytes, offset)
}

#[cfg(windows)]
fn read_exact_at(file: &std::fs::File, mut bytes: &mut [u8], mut offset: u64) -> std::io::Result<()> {
    while !bytes.is_empty() {
        let read = std::os::windows::fs::FileExt::seek_read(file, bytes, offset)?;
        if read == 0 {
            return Err(std::io::ErrorKind::UnexpectedEof.into());
        }
        bytes = &mut bytes[read..];
        offset += read as u64;
    }
    Ok(())
}
