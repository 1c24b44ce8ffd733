//! Texts, each ended by a zero byte.

use super::description::MAX_TEXT;
use crate::error::{Error, ErrorKind, Result};

/// The texts as bytes.
pub(super) fn encode(texts: &[&str]) -> Vec<u8> {
    texts.iter().flat_map(|text| text.bytes().chain([0])).collect()
}

/// Reads texts one after the other.
pub(super) struct Decoder<'a> {
    rest: &'a [u8],
}

impl<'a> Decoder<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// The next text.
    pub(super) fn text(&mut self) -> Result<String> {
        let end = self.rest.iter().take(MAX_TEXT).position(|&byte| byte == 0);
        let (text, rest) = self.rest.split_at(end.ok_or_else(|| corrupt("its texts end early"))?);
        self.rest = &rest[1..];
        String::from_utf8(text.to_vec()).map_err(|_| corrupt("a text is no UTF-8"))
    }

    /// Nothing may be left.
    pub(super) fn end(self) -> Result<()> {
        if self.rest.is_empty() { Ok(()) } else { Err(corrupt("bytes follow the last text")) }
    }
}

fn corrupt(message: &str) -> Error {
    Error::new(ErrorKind::Corrupt, message).at_place("section META")
}
