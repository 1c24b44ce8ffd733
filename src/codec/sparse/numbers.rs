//! Whole numbers as bits with adaptive chances, the same code for writing and reading.

use super::super::binary::Adaptive;
use super::super::mask::Bits;

/// Even odds, in 65536ths.
const EVEN: u16 = 1 << 15;

/// The chances of a number: how many bits it has, and its second highest one.
#[derive(Clone, Debug)]
pub(super) struct Magnitude {
    longer: [Adaptive; 32],
    second: [Adaptive; 33],
}

impl Magnitude {
    pub(super) fn new() -> Self {
        Self { longer: [Adaptive::new(); 32], second: [Adaptive::new(); 33] }
    }

    /// Writes a number, or reads one whatever is given.
    pub(super) fn code<B: Bits>(&mut self, bits: &mut B, value: u32) -> u32 {
        let wanted = bit_length(value);
        let mut length = 0;
        while length < 32 && bits.bit(wanted > length, &mut self.longer[length as usize]) {
            length += 1;
        }
        if length < 2 {
            return length;
        }
        let mut number = 1;
        for place in (0..length - 1).rev() {
            let bit = value >> place & 1 == 1;
            let bit = match place == length - 2 {
                true => bits.bit(bit, &mut self.second[length as usize]),
                false => bits.even(bit),
            };
            number = number << 1 | u32::from(bit);
        }
        number
    }
}

/// The chances of numbers below a power of two, each of which is as frequent as it is.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    width: u32,
    nodes: Vec<Adaptive>,
}

impl Tree {
    /// Numbers of `width` bits.
    pub(super) fn new(width: u32) -> Self {
        Self { width, nodes: vec![Adaptive::new(); 1 << width] }
    }

    /// Writes a number, or reads one whatever is given.
    pub(super) fn code<B: Bits>(&mut self, bits: &mut B, value: u32) -> u32 {
        let mut node = 1;
        for place in (0..self.width).rev() {
            let bit = bits.bit(value >> place & 1 == 1, &mut self.nodes[node as usize]);
            node = node << 1 | u32::from(bit);
        }
        node - (1 << self.width)
    }
}

/// Bits that are as likely as not.
pub(super) trait Even: Bits {
    /// Writes such a bit, or reads one whatever is given.
    fn even(&mut self, bit: bool) -> bool;
}

impl<B: Bits> Even for B {
    fn even(&mut self, bit: bool) -> bool {
        debug_assert_eq!(Adaptive::new().probability(), EVEN, "a new chance is even");
        self.bit(bit, &mut Adaptive::new())
    }
}

/// Number of bits up to the highest that is set.
pub(super) fn bit_length(value: u32) -> u32 {
    32 - value.leading_zeros()
}

#[cfg(test)]
mod tests {
    use super::super::super::binary::{BinaryDecoder, BinaryEncoder};
    use super::*;

    #[test]
    fn numbers_come_back() {
        let mut values: Vec<u32> = (0..40).chain([1000, u32::MAX, u32::MAX - 1, 1 << 31]).collect();
        values.extend((0..32).flat_map(|bit| [(1 << bit) - 1, 1 << bit, (1u32 << bit).wrapping_add(1)]));
        let mut encoder = BinaryEncoder::new();
        let (mut magnitude, mut tree) = (Magnitude::new(), Tree::new(7));
        for &value in &values {
            assert_eq!(magnitude.code(&mut encoder, value), value);
            assert_eq!(tree.code(&mut encoder, value % 128), value % 128);
        }
        let bytes = encoder.finish();
        let mut decoder = BinaryDecoder::new(&bytes);
        let (mut magnitude, mut tree) = (Magnitude::new(), Tree::new(7));
        for &value in &values {
            assert_eq!(magnitude.code(&mut decoder, 0), value);
            assert_eq!(tree.code(&mut decoder, 0), value % 128);
        }
        assert!(decoder.is_done());
    }
}
