//! Texts in few bytes: an adaptive model of what usually stands in metadata, and a range coder.
//!
//! The model has read the priming text, `format-spec/tables/text-1.txt`, before the first byte of a file: coordinate
//! reference systems that stand there cost a few bytes, others of their kind some dozens.

mod model;

use super::description::MAX_TEXT;
use crate::codec::{BinaryDecoder, BinaryEncoder};
use crate::error::{Error, ErrorKind, Result};
use model::Model;
use std::sync::LazyLock;

/// What the model has read before. Its lines stand for texts, so a line feed is read as the byte 0.
const PRIMING: &[u8] = include_bytes!("../../../format-spec/tables/text-1.txt");

/// The model as it is before the first byte.
static PRIMED: LazyLock<Model> = LazyLock::new(|| {
    let mut model = Model::new();
    for &byte in PRIMING {
        let byte = if byte == b'\n' { 0 } else { byte };
        for bit in bits(byte) {
            model.push(bit);
        }
    }
    model
});

/// The model's 4096ths in the coder's 65536ths.
fn share(probability: u32) -> u16 {
    (probability << 4) as u16
}

/// The bits of a byte, highest first.
fn bits(byte: u8) -> impl Iterator<Item = u32> {
    (0..8).rev().map(move |place| u32::from(byte) >> place & 1)
}

/// The texts as bytes; no bytes when there are none.
pub(super) fn encode(texts: &[&str]) -> Vec<u8> {
    if texts.is_empty() {
        return vec![];
    }
    let mut model = PRIMED.clone();
    let mut coder = BinaryEncoder::new();
    for bit in texts.iter().flat_map(|text| text.bytes().chain([0])).flat_map(bits) {
        coder.put(bit == 1, share(model.probability()));
        model.push(bit);
    }
    coder.finish()
}

/// Reads texts one after the other.
pub(super) struct Decoder<'a> {
    bytes: &'a [u8],
    /// Made when the first text is asked for: most of the cost is here.
    state: Option<(Model, BinaryDecoder<'a>)>,
    length: usize,
}

impl<'a> Decoder<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, state: None, length: 0 }
    }

    /// The next text.
    pub(super) fn text(&mut self) -> Result<String> {
        let (model, coder) = self.state.get_or_insert_with(|| (PRIMED.clone(), BinaryDecoder::new(self.bytes)));
        let mut text = vec![];
        loop {
            let Some(byte) = model.push(u32::from(coder.get(share(model.probability())))) else { continue };
            if coder.is_beyond() {
                return Err(corrupt("its texts end early"));
            }
            self.length += 1;
            if self.length > MAX_TEXT {
                return Err(corrupt("more than 16 MiB of text"));
            }
            match byte {
                0 => return String::from_utf8(text).map_err(|_| corrupt("a text is no UTF-8")),
                byte => text.push(byte),
            }
        }
    }

    /// Nothing may be left.
    pub(super) fn end(self) -> Result<()> {
        let done = self.state.map_or(self.bytes.is_empty(), |(_, coder)| coder.is_done());
        if done { Ok(()) } else { Err(corrupt("bytes follow the last text")) }
    }
}

fn corrupt(message: &str) -> Error {
    Error::new(ErrorKind::Corrupt, message).at_place("section META")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn round_trip(texts: &[&str]) -> usize {
        let bytes = encode(texts);
        let mut decoder = Decoder::new(&bytes);
        for text in texts {
            assert_eq!(decoder.text().unwrap(), *text);
        }
        decoder.end().unwrap();
        bytes.len()
    }

    /// The specification has these bytes and the checksum, for whoever writes another reader.
    #[test]
    fn the_worked_example_holds() {
        assert_eq!((PRIMING.len(), crc32c::crc32c(PRIMING)), (34_219, 0x5289_1816));
        assert_eq!(encode(&["m", ""]), [0x1b, 0xe9]);
        let expected = [0x98, 0x1f, 0xe4, 0xc7, 0x27, 0x1c, 0x82, 0xab, 0x6c, 0x08, 0x5b, 0x3b, 0x48, 0x1b, 0x9d, 0xb2];
        assert_eq!(encode(&["Grüße aus dem Gebirge"]), [&expected[..], &[0x5e, 0x6a]].concat());
        let probabilities = |mut model: Model, bytes: &[u8]| {
            let push = |bit| (model.probability(), model.push(bit)).0;
            bytes.iter().copied().flat_map(bits).map(push).collect::<Vec<_>>()
        };
        let expected = [49, 3119, 1210, 797, 2275, 3086, 1703, 2123, 104, 3277, 3385, 750, 423, 847, 797, 715];
        assert_eq!(probabilities(PRIMED.clone(), b"m\0"), expected);
        let expected = [1550, 2546, 2550, 1539, 1536, 1532, 1529, 2567];
        assert_eq!(probabilities(Model::new(), b"aaa"), [&[2048; 16][..], &expected].concat());
    }

    #[test]
    fn known_texts_are_short() {
        for crs in PRIMING.split(|&byte| byte == b'\n').filter(|line| line.ends_with(b"]]")) {
            let length = round_trip(&[std::str::from_utf8(crs).unwrap()]);
            assert!(length <= 20, "{length} bytes for {}", String::from_utf8_lossy(crs));
        }
    }

    #[test]
    fn long_and_repetitive_texts_come_back() {
        let long = "<gco:CharacterString>".repeat(5000);
        assert!(round_trip(&[&long, "", &long]) < 1000);
        assert_eq!(round_trip(&[]), 0);
    }

    proptest! {
        #[test]
        fn any_texts_come_back(texts in proptest::collection::vec("[^\0]{0,40}", 0..6)) {
            round_trip(&texts.iter().map(String::as_str).collect::<Vec<_>>());
        }

        #[test]
        fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..40)) {
            let mut decoder = Decoder::new(&bytes);
            while decoder.text().is_ok() {}
        }
    }
}
