//! Bits to bytes and back: a binary range coder without carries.
//!
//! The bits so far are an interval of 32-bit numbers. Each bit takes its share of it, and top bytes that both ends
//! have in common are done.

/// Turns bits into bytes.
pub(super) struct Encoder {
    low: u32,
    high: u32,
    bytes: Vec<u8>,
}

/// Where the part of a bit 1 ends whose probability is so many 4096ths.
fn split(low: u32, high: u32, probability: u32) -> u32 {
    low + ((u64::from(high - low) * u64::from(probability)) >> 12) as u32
}

impl Encoder {
    pub(super) fn new() -> Self {
        Self { low: 0, high: u32::MAX, bytes: vec![] }
    }

    pub(super) fn put(&mut self, bit: u32, probability: u32) {
        let middle = split(self.low, self.high, probability);
        if bit == 1 {
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
    pub(super) fn finish(mut self) -> Vec<u8> {
        for count in 0..=4 {
            let mask = u32::MAX.checked_shl(32 - 8 * count).unwrap_or(0);
            let number = self.high & mask;
            if number >= self.low {
                self.bytes.extend(&number.to_be_bytes()[..count as usize]);
                break;
            }
        }
        self.bytes
    }
}

/// Turns bytes into bits.
pub(super) struct Decoder<'a> {
    low: u32,
    high: u32,
    number: u32,
    bytes: &'a [u8],
    /// Bytes taken, with the zeros after the last.
    taken: usize,
}

impl<'a> Decoder<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let mut decoder = Self { low: 0, high: u32::MAX, number: 0, bytes, taken: 0 };
        (0..4).for_each(|_| decoder.take());
        decoder
    }

    fn take(&mut self) {
        self.number = self.number << 8 | u32::from(self.bytes.get(self.taken).copied().unwrap_or(0));
        self.taken += 1;
    }

    pub(super) fn get(&mut self, probability: u32) -> u32 {
        let middle = split(self.low, self.high, probability);
        let bit = u32::from(self.number <= middle);
        if bit == 1 {
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
    pub(super) fn is_beyond(&self) -> bool {
        self.taken > self.bytes.len() + 4
    }

    /// Whether all bytes were needed.
    pub(super) fn is_done(&self) -> bool {
        self.taken >= self.bytes.len()
    }
}
