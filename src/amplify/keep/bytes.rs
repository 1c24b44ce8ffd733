//! Numbers and texts as bytes, all little-endian.

use crate::error::{Error, ErrorKind, Result};

/// Appends a `u8`.
pub(crate) fn put_u8(out: &mut Vec<u8>, value: u8) {
    out.push(value);
}

/// Appends a `u16`.
pub(crate) fn put_u16(out: &mut Vec<u8>, value: u16) {
    out.extend(value.to_le_bytes());
}

/// Appends a `u32`.
pub(crate) fn put_u32(out: &mut Vec<u8>, value: u32) {
    out.extend(value.to_le_bytes());
}

/// Appends a `u64`.
pub(crate) fn put_u64(out: &mut Vec<u8>, value: u64) {
    out.extend(value.to_le_bytes());
}

/// Appends a double.
pub(crate) fn put_f64(out: &mut Vec<u8>, value: f64) {
    out.extend(value.to_le_bytes());
}

/// Appends a text behind its length in bytes, a `u16`; what is longer is cut at a character.
pub(crate) fn put_text(out: &mut Vec<u8>, text: &str) {
    let length = text.floor_char_boundary(usize::from(u16::MAX));
    put_u16(out, length as u16);
    out.extend(&text.as_bytes()[..length]);
}

/// Takes bytes from the front. Every failure is a [`ErrorKind::Corrupt`] that names what was to be read.
#[derive(Clone, Debug)]
pub(crate) struct Cursor<'a> {
    rest: &'a [u8],
    /// Bytes of memory that numbers may still take beyond those of the file.
    room: u64,
}

/// What is damaged.
pub(super) fn corrupt(message: impl Into<String>) -> Error {
    Error::new(ErrorKind::Corrupt, message)
}

impl<'a> Cursor<'a> {
    /// At the first of the bytes; what is decoded may take so many bytes of memory.
    pub(crate) fn new(bytes: &'a [u8], room: u64) -> Self {
        Self { rest: bytes, room }
    }

    /// Bytes that are left.
    pub(crate) fn left(&self) -> usize {
        self.rest.len()
    }

    /// Looks whether so many more bytes of memory may be taken.
    ///
    /// # Errors
    /// [`ErrorKind::Unsupported`] when they may not.
    pub(crate) fn reserve(&mut self, bytes: u64) -> Result<()> {
        let Some(room) = self.room.checked_sub(bytes) else {
            let message = format!(
                "what was learned takes more memory than there is: {} MB more are needed, and {} MB may be used; say how \
                 much there is with --memory",
                bytes.div_ceil(1_000_000),
                self.room / 1_000_000
            );
            return Err(Error::new(ErrorKind::Unsupported, message));
        };
        self.room = room;
        Ok(())
    }

    /// The next bytes.
    pub(crate) fn bytes(&mut self, count: usize, what: &str) -> Result<&'a [u8]> {
        let Some((bytes, rest)) = self.rest.split_at_checked(count) else {
            let left = self.left();
            return Err(corrupt(format!("it ends within {what}: {left} bytes are left, and {count} are needed")));
        };
        self.rest = rest;
        Ok(bytes)
    }

    fn array<const N: usize>(&mut self, what: &str) -> Result<[u8; N]> {
        let mut array = [0; N];
        array.copy_from_slice(self.bytes(N, what)?);
        Ok(array)
    }

    pub(crate) fn u8(&mut self, what: &str) -> Result<u8> {
        Ok(self.array::<1>(what)?[0])
    }

    pub(crate) fn u16(&mut self, what: &str) -> Result<u16> {
        self.array(what).map(u16::from_le_bytes)
    }

    pub(crate) fn u32(&mut self, what: &str) -> Result<u32> {
        self.array(what).map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self, what: &str) -> Result<u64> {
        self.array(what).map(u64::from_le_bytes)
    }

    /// A number within bounds, both included.
    pub(crate) fn within(&mut self, value: u64, [least, most]: [u64; 2], what: &str) -> Result<usize> {
        match (least..=most).contains(&value) {
            true => Ok(value as usize),
            false => Err(corrupt(format!("{what} is {value}: expected {least} to {most}"))),
        }
    }

    /// A yes or a no.
    pub(crate) fn flag(&mut self, what: &str) -> Result<bool> {
        let value = self.u8(what)?;
        Ok(self.within(u64::from(value), [0, 1], what)? == 1)
    }

    /// A finite double that is no less than a bound.
    pub(crate) fn f64_from(&mut self, least: f64, what: &str) -> Result<f64> {
        let value = self.array(what).map(f64::from_le_bytes)?;
        match value.is_finite() && value >= least {
            true => Ok(value),
            false => Err(corrupt(format!("{what} is {value}: expected a number of at least {least}"))),
        }
    }

    /// A text.
    pub(crate) fn text(&mut self, what: &str) -> Result<String> {
        let length = usize::from(self.u16(what)?);
        let bytes = self.bytes(length, what)?;
        let text = std::str::from_utf8(bytes).map_err(|_| corrupt(format!("{what} is no UTF-8")))?;
        match text.chars().any(char::is_control) {
            true => Err(corrupt(format!("{what} has control characters"))),
            false => Ok(text.to_string()),
        }
    }

    /// Looks whether all was read.
    pub(crate) fn end(&self) -> Result<()> {
        match self.left() {
            0 => Ok(()),
            left => Err(corrupt(format!("{left} bytes follow the last that it should have"))),
        }
    }
}
