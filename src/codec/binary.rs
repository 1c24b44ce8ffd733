//! A binary range coder without carries.
//!
//! The bits so far are an interval of 32-bit numbers. Each bit takes its share of it, and top bytes that both ends
//! have in common are done.

/// Where the part of a bit 1 ends whose probability is so many 65536ths.
#[inline]
fn split(low: u32, high: u32, probability: u16) -> u32 {
    low + ((u64::from(high - low) * u64::from(probability)) >> 16) as u32
}

/// The number in an interval that needs the fewest first bytes when zeros follow, and how many these are.
fn shortest(low: u32, high: u32) -> (u32, usize) {
    let first = |count: u32| high & u32::MAX.checked_shl(32 - 8 * count).unwrap_or(0);
    let count = (0..4).find(|&count| first(count) >= low).unwrap_or(4);
    (first(count), count as usize)
}

/// Turns bits into bytes.
#[derive(Clone, Debug)]
pub(crate) struct BinaryEncoder {
    low: u32,
    high: u32,
    bytes: Vec<u8>,
}

impl BinaryEncoder {
    /// Starts with the whole interval.
    pub(crate) fn new() -> Self {
        Self { low: 0, high: u32::MAX, bytes: vec![] }
    }

    /// Writes a bit; `probability` is that of a 1, in 65536ths, not 0.
    pub(crate) fn put(&mut self, bit: bool, probability: u16) {
        let middle = split(self.low, self.high, probability);
        if bit {
            self.high = middle;
        } else {
            self.low = middle + 1;
        }
        while self.low >> 24 == self.high >> 24 {
            self.bytes.push((self.high >> 24) as u8);
            self.low <<= 8;
            self.high = self.high << 8 | 255;
        }
    }

    /// The bytes, with as few at the end as name a number in the interval when zeros follow.
    pub(crate) fn finish(mut self) -> Vec<u8> {
        let (number, count) = shortest(self.low, self.high);
        self.bytes.extend(&number.to_be_bytes()[..count]);
        self.bytes
    }
}

/// Turns bytes into bits.
#[derive(Clone, Debug)]
pub(crate) struct BinaryDecoder<'a> {
    low: u32,
    high: u32,
    number: u32,
    bytes: &'a [u8],
    /// Bytes taken, with the zeros after the last.
    taken: usize,
}

impl<'a> BinaryDecoder<'a> {
    /// Starts on the bytes of an encoder.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        let mut decoder = Self { low: 0, high: u32::MAX, number: 0, bytes, taken: 0 };
        (0..4).for_each(|_| decoder.take());
        decoder
    }

    fn take(&mut self) {
        self.number = self.number << 8 | u32::from(self.bytes.get(self.taken).copied().unwrap_or(0));
        self.taken += 1;
    }

    /// Reads a bit that was written with the same probability.
    pub(crate) fn get(&mut self, probability: u16) -> bool {
        let middle = split(self.low, self.high, probability);
        let bit = self.number <= middle;
        if bit {
            self.high = middle;
        } else {
            self.low = middle + 1;
        }
        while self.low >> 24 == self.high >> 24 {
            self.low <<= 8;
            self.high = self.high << 8 | 255;
            self.take();
        }
        bit
    }

    /// Whether more bytes were needed than there are: an encoder ends with at most four zeros left out.
    pub(crate) fn is_beyond(&self) -> bool {
        self.taken > self.bytes.len() + 4
    }

    /// Whether the bytes are those that an encoder would have written of the same bits.
    pub(crate) fn is_done(&self) -> bool {
        let (number, count) = shortest(self.low, self.high);
        self.number == number && self.bytes.len() == self.taken - 4 + count
    }
}

/// A probability that follows the bits it has seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Adaptive(u16);

impl Adaptive {
    /// Even odds.
    pub(crate) fn new() -> Self {
        Self(1 << 15)
    }

    /// The probability of a 1; never 0 and never 1.
    pub(crate) fn probability(self) -> u16 {
        self.0
    }

    /// Learns from a bit.
    pub(crate) fn learn(&mut self, bit: bool) {
        if bit {
            self.0 += (u16::MAX - self.0) >> 5;
        } else {
            self.0 -= self.0 >> 5;
        }
    }
}
