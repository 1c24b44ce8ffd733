//! Atoms of a dictionary as bytes.

use super::super::binary::{BinaryDecoder, BinaryEncoder};
use super::super::bits::{unzigzag, zigzag};
use super::super::mask::Bits;
use super::numbers::{Magnitude, bit_length};
use crate::error::{Error, ErrorKind, Result};

/// Greatest number of values of all atoms together.
pub const MAX_ATOM_VALUES: usize = 1 << 28;
/// How rough the surroundings of a value are, in classes.
const CLASSES: usize = 12;

/// Codes all atoms, each from the upper left, row by row: the value that the plane through three neighbours would have
/// is taken away.
fn code<B: Bits>(bits: &mut B, values: &mut [i32], side: usize, mut more: impl FnMut(&B) -> bool) -> bool {
    let mut chances = vec![Magnitude::new(); CLASSES];
    for atom in values.chunks_exact_mut(side * side) {
        if !more(bits) {
            return false;
        }
        for k in 0..atom.len() {
            let (row, col) = (k / side, k % side);
            let (expected, rough) = match (row, col) {
                (0, 0) => (0, 0),
                (0, _) => (atom[k - 1], 0),
                (_, 0) => (atom[k - side], 0),
                _ => {
                    let (west, north, corner) = (atom[k - 1], atom[k - side], atom[k - side - 1]);
                    let (down, right) = (west.wrapping_sub(corner), north.wrapping_sub(corner));
                    let rough = down.unsigned_abs().saturating_add(right.unsigned_abs());
                    (west.wrapping_add(right), bit_length(rough))
                }
            };
            let class = (rough as usize).min(CLASSES - 1);
            let rest = zigzag(i64::from(atom[k].wrapping_sub(expected))) as u32;
            let rest = chances[class].code(bits, rest);
            atom[k] = expected.wrapping_add(unzigzag(u64::from(rest)) as i32);
        }
    }
    true
}

/// Atoms as bytes: squares of `side` by `side` values, one behind the other, each row by row.
///
/// # Panics
/// When the values are no whole atoms.
pub fn encode_atoms(values: &[i32], side: usize) -> Vec<u8> {
    assert!(side > 0 && values.len().is_multiple_of(side * side), "whole atoms");
    let mut bits = BinaryEncoder::new();
    code(&mut bits, &mut values.to_vec(), side, |_| true);
    bits.finish()
}

/// The values of so many atoms of `side` by `side` values.
///
/// # Errors
/// [`ErrorKind::Corrupt`] when the bytes are no such atoms, or there would be too many.
pub fn decode_atoms(bytes: &[u8], side: usize, count: usize) -> Result<Vec<i32>> {
    let corrupt = |message: &str| Error::new(ErrorKind::Corrupt, message);
    let size = side.checked_mul(side).and_then(|size| size.checked_mul(count));
    let size = size.filter(|&size| size > 0 && size <= MAX_ATOM_VALUES);
    let size = size.ok_or_else(|| corrupt("a dictionary without atoms, or with too many"))?;
    // A bit is at least a 2048th of one: a chance never gets closer to certainty.
    if size / 2048 / 8 > bytes.len() {
        return Err(corrupt("the atoms' bytes end early"));
    }
    let mut values = vec![0; size];
    let mut bits = BinaryDecoder::new(bytes);
    if !code(&mut bits, &mut values, side, |bits| !bits.is_beyond()) || !bits.is_done() {
        return Err(corrupt("the atoms' bytes are not what an encoder writes"));
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn atoms_come_back(side in 1usize..6, count in 1usize..5, seed in any::<u32>(), shift in 0u32..32) {
            let mut state = seed;
            let values: Vec<i32> = (0..side * side * count)
                .map(|_| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (state as i32) >> shift
                })
                .collect();
            let bytes = encode_atoms(&values, side);
            prop_assert_eq!(&decode_atoms(&bytes, side, count).unwrap(), &values);
            let short = decode_atoms(&bytes[..bytes.len().saturating_sub(1)], side, count);
            prop_assert!(bytes.is_empty() || short.map_or(true, |short| short != values), "a byte that says nothing");
            let mut longer = bytes.clone();
            longer.push(0);
            prop_assert!(decode_atoms(&longer, side, count).is_err());
        }
    }

    #[test]
    fn atoms_without_their_last_byte_are_other_atoms() {
        // Found by the property above: what is left may be whole too.
        let values = [34_048_661_u32.wrapping_mul(1_664_525).wrapping_add(1_013_904_223) as i32 >> 3];
        let bytes = encode_atoms(&values, 1);
        assert_eq!(decode_atoms(&bytes, 1, 1).unwrap(), values);
        assert!(decode_atoms(&bytes[..bytes.len() - 1], 1, 1).map_or(true, |short| short != values));
    }

    #[test]
    fn numbers_that_the_bytes_do_not_earn_are_refused() {
        assert!(decode_atoms(&[], 8, 0).is_err());
        assert!(decode_atoms(&[], usize::MAX, 2).is_err());
        assert!(decode_atoms(&[0; 8], 4096, 10).is_err());
    }
}
