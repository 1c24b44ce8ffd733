//! Bits into bytes and back: least significant bit first, unused bits of the last byte 0.

use crate::error::{Error, ErrorKind, Result};

/// Writes bits.
#[derive(Clone, Debug, Default)]
pub(super) struct BitWriter {
    bytes: Vec<u8>,
    pending: u64,
    count: u32,
}

impl BitWriter {
    /// Writes the lowest `width` bits of a value; at most 32.
    #[inline]
    pub(super) fn put(&mut self, value: u64, width: u32) {
        debug_assert!(width <= 32 && (width == 64 || value >> width == 0), "a value fits its width");
        self.pending |= value << self.count;
        self.count += width;
        while self.count >= 8 {
            self.bytes.push(self.pending as u8);
            self.pending >>= 8;
            self.count -= 8;
        }
    }

    /// Writes any 64-bit number in few bits when it is small: Exp-Golomb of order `order`.
    pub(super) fn put_number(&mut self, value: u64, order: u32) {
        let shifted = u128::from(value) + (1u128 << order);
        let length = 127 - shifted.leading_zeros();
        for _ in order..length {
            self.put(0, 1);
        }
        self.put(1, 1);
        let rest = (shifted & ((1u128 << length) - 1)) as u64;
        if length > 32 {
            self.put(rest & 0xffff_ffff, 32);
            self.put(rest >> 32, length - 32);
        } else {
            self.put(rest, length);
        }
    }

    /// Writes a signed number as [`BitWriter::put_number`] of its zigzag.
    pub(super) fn put_signed(&mut self, value: i64, order: u32) {
        self.put_number(zigzag(value), order);
    }

    /// Writes all bits of another writer.
    pub(super) fn append(&mut self, other: &Self) {
        other.bytes.iter().for_each(|&byte| self.put(u64::from(byte), 8));
        self.put(other.pending, other.count);
    }

    /// Number of bits so far.
    pub(super) fn bits(&self) -> usize {
        self.bytes.len() * 8 + self.count as usize
    }

    /// The bytes, the last one filled up with zeros.
    pub(super) fn finish(mut self) -> Vec<u8> {
        if self.count > 0 {
            self.bytes.push(self.pending as u8);
        }
        self.bytes
    }
}

/// Reads bits; beyond the end it reads zeros, and [`BitReader::check`] says so.
#[derive(Clone, Debug)]
pub(super) struct BitReader<'a> {
    bytes: &'a [u8],
    position: usize,
    pending: u64,
    count: u32,
}

impl<'a> BitReader<'a> {
    /// Reads from the first bit.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, position: 0, pending: 0, count: 0 }
    }

    /// Reads `width` bits; at most 32.
    #[inline]
    pub(super) fn take(&mut self, width: u32) -> u64 {
        if self.count < width {
            self.refill(width);
        }
        let value = self.pending & ((1 << width) - 1);
        self.pending >>= width;
        self.count -= width;
        value
    }

    /// Makes at least `width` bits ready.
    #[inline]
    fn refill(&mut self, width: u32) {
        if let Some(next) = self.bytes.get(self.position..).and_then(|bytes| bytes.first_chunk()) {
            self.pending |= u64::from(u32::from_le_bytes(*next)) << self.count;
            self.position += 4;
            self.count += 32;
        }
        while self.count < width {
            let byte = self.bytes.get(self.position).copied().unwrap_or(0);
            self.position += 1;
            self.pending |= u64::from(byte) << self.count;
            self.count += 8;
        }
    }

    /// Reads what [`BitWriter::put_number`] wrote; a number of more than 64 bits comes back as `u64::MAX`,
    /// and [`BitReader::check`] fails.
    pub(super) fn take_number(&mut self, order: u32) -> u64 {
        let mut length = order;
        while self.take(1) == 0 {
            length += 1;
            if length > 64 || self.position > self.bytes.len() + 8 {
                self.position = self.bytes.len() + 1;
                return u64::MAX;
            }
        }
        let rest = match length {
            0..=32 => self.take(length),
            _ => self.take(32) | (self.take(length - 32) << 32),
        };
        let shifted = (1u128 << length) + u128::from(rest);
        u64::try_from(shifted - (1u128 << order)).unwrap_or_else(|_| {
            self.position = self.bytes.len() + 1;
            u64::MAX
        })
    }

    /// Reads what [`BitWriter::put_signed`] wrote.
    pub(super) fn take_signed(&mut self, order: u32) -> i64 {
        unzigzag(self.take_number(order))
    }

    /// Fails when more was read than there is.
    pub(super) fn check(&self) -> Result<()> {
        match self.position <= self.bytes.len() {
            true => Ok(()),
            false => Err(Error::new(ErrorKind::Corrupt, "the tile's bits end early")),
        }
    }

    /// Fails unless all was read but for the zeros that fill the last byte up.
    pub(super) fn finish(&self) -> Result<()> {
        self.check()?;
        match self.bytes.len() == self.position && self.count < 8 && self.pending == 0 {
            true => Ok(()),
            false => Err(Error::new(ErrorKind::Corrupt, "the tile's bits go on after their end")),
        }
    }
}

/// Small magnitudes to small numbers: 0, -1, 1, -2, ...
#[inline]
pub(super) fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)) as u64
}

/// The inverse of [`zigzag`].
#[inline]
pub(super) fn unzigzag(value: u64) -> i64 {
    (value >> 1) as i64 ^ -((value & 1) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back() {
        let mut values = vec![0, 1, 2, 3, u64::MAX, u64::MAX - 1, 1 << 63];
        values.extend((0..63).flat_map(|bit| [(1 << bit) - 1, 1 << bit, (1 << bit) + 1]));
        let mut writer = BitWriter::default();
        for order in [0, 3, 7] {
            values.iter().for_each(|&value| writer.put_number(value, order));
            values.iter().for_each(|&value| writer.put_signed(value as i64, order));
        }
        let bytes = writer.finish();
        let mut reader = BitReader::new(&bytes);
        for order in [0, 3, 7] {
            values.iter().for_each(|&value| assert_eq!(reader.take_number(order), value));
            values.iter().for_each(|&value| assert_eq!(reader.take_signed(order), value as i64));
        }
        assert!(reader.check().is_ok());
        reader.take(32);
        assert!(reader.check().is_err());
    }
}
