//! Segments of tiles put together bit by bit, after the specification.

use crate::parts::{Parts, varint};

/// Bits, lowest first.
#[derive(Clone, Default)]
pub struct Bits(Vec<bool>);

impl Bits {
    /// So many bits of a number.
    pub fn bits(mut self, value: u64, count: u32) -> Self {
        self.0.extend((0..count).map(|bit| value >> bit & 1 == 1));
        self
    }

    /// These and others.
    pub fn then(mut self, others: Self) -> Self {
        self.0.extend(others.0);
        self
    }

    /// Exp-Golomb code.
    pub fn number(self, order: u32, value: u64) -> Self {
        let shifted = u128::from(value) + (1 << order);
        let length = shifted.ilog2();
        let low = shifted - (1 << length);
        let (first, second) = (length.min(32), length.saturating_sub(32));
        self.bits(0, length - order).bits(1, 1).bits(low as u64 & 0xffff_ffff, first).bits((low >> 32) as u64, second)
    }

    /// Exp-Golomb code of a number that may be below 0.
    pub fn signed(self, order: u32, value: i64) -> Self {
        self.number(order, if value < 0 { 2 * value.unsigned_abs() - 1 } else { 2 * value as u64 })
    }

    /// The bytes.
    pub fn bytes(&self) -> Vec<u8> {
        let byte = |bits: &[bool]| bits.iter().rev().fold(0, |byte, &bit| byte << 1 | u8::from(bit));
        self.0.chunks(8).map(byte).collect()
    }
}

/// A part with its length.
pub fn part(bytes: &[u8]) -> Vec<u8> {
    [varint(bytes.len()).as_slice(), bytes].concat()
}

/// A tile header of whole numbers without voids or patches: least, factor, range bits, step; what follows when there
/// are range bits: coarseness, copies (when the step is 1), seed.
pub fn header(range_bits: u64, step: u64) -> Bits {
    Bits::default().bits(0, 2).bits(0, 3).signed(10, 0).number(0, 0).bits(range_bits, 7).number(2, step / 2)
}

/// A file of one band and one tile; `record` is the band's record in META.
pub fn file(width: usize, height: usize, record: &[u8], segments: [Vec<u8>; 4]) -> Vec<u8> {
    let side = width.max(height).div_ceil(64);
    let meta = [&varint(width), varint(height).as_slice(), &varint(side), &[1, 1, 0], record].concat();
    let (mut chunks, mut index) = (vec![], vec![]);
    for segment in segments {
        index.extend(varint(segment.len()));
        if !segment.is_empty() {
            chunks.extend(&segment);
            chunks.extend(crc32c::crc32c(&segment).to_le_bytes());
        }
    }
    Parts { chunks, sections: vec![(0x81, meta), (0x82, index)], version: 1, flags: 0 }.file()
}
