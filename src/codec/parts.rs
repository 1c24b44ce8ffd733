//! Parts of a segment, each with its length before it.

use crate::error::{Error, ErrorKind, Result};

/// Appends a part of a segment: its length, seven bits a byte, and its bytes.
pub(super) fn put_part(segment: &mut Vec<u8>, part: &[u8]) {
    let mut length = part.len();
    while length >= 128 {
        segment.push(length as u8 | 128);
        length >>= 7;
    }
    segment.push(length as u8);
    segment.extend_from_slice(part);
}

/// Reads a part of a segment and leaves what follows it.
pub(super) fn take_part<'a>(segment: &mut &'a [u8]) -> Result<&'a [u8]> {
    let early = || Error::new(ErrorKind::Corrupt, "a segment ends early");
    let mut length = 0u64;
    for place in 0..5 {
        let (&byte, rest) = segment.split_first().ok_or_else(early)?;
        *segment = rest;
        length |= u64::from(byte & 127) << (7 * place);
        if byte == 0 && place > 0 {
            return Err(Error::new(ErrorKind::Corrupt, "the length of a part of a segment has needless bytes"));
        }
        if byte < 128 {
            let length = usize::try_from(length).map_err(|_| early())?;
            let (part, rest) = segment.split_at_checked(length).ok_or_else(early)?;
            *segment = rest;
            return Ok(part);
        }
    }
    Err(Error::new(ErrorKind::Corrupt, "the length of a part of a segment has too many bytes"))
}
