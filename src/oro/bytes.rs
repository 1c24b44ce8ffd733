//! Integers, floats and texts as bytes: the words in which headers and sections are written.
//!
//! Everything is little-endian. A **varint** has 7 bits a byte, low ones first, and the top bit set in all bytes but
//! the last. A **float** is exact, in the shortest of three forms, named by its first byte:
//!
//! | first byte | then | value |
//! |---|---|---|
//! | n = 0 to 8 | the n highest bytes of the IEEE 754 double | the double, whose other bytes are 0 |
//! | 9 | zigzag varint p, varint q | p / q, rounded as IEEE 754 says |

use crate::error::{Error, ErrorKind, Result};

/// First byte of a float that is a quotient.
const QUOTIENT: u8 = 9;
/// Numerators and denominators are below this, so that doubles hold them exactly.
const QUOTIENT_LIMIT: u64 = 1 << 53;

/// The CRC-32C (Castagnoli) of bytes that lie in parts.
pub fn checksum(parts: &[&[u8]]) -> u32 {
    parts.iter().fold(0, |sum, part| crc32c::crc32c_append(sum, part))
}

/// Appends a varint.
pub(super) fn put_varint(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

/// Appends a float in its shortest form.
pub(super) fn put_float(out: &mut Vec<u8>, value: f64) {
    let bits = value.to_bits();
    let zeros = if bits == 0 { 8 } else { bits.trailing_zeros() as usize / 8 };
    let mut shortest = vec![8 - zeros as u8];
    shortest.extend(&bits.to_le_bytes()[zeros..]);
    if let Some((p, q)) = quotient(value) {
        let mut other = vec![QUOTIENT];
        put_varint(&mut other, ((p << 1) ^ (p >> 63)) as u64);
        put_varint(&mut other, q);
        if other.len() < shortest.len() {
            shortest = other;
        }
    }
    out.extend(shortest);
}

/// The first convergent of the value's continued fraction that gives back the same bits, if it is a short one.
fn quotient(value: f64) -> Option<(i64, u64)> {
    // The writer alone needs to find it; a reader only divides.
    if !value.is_finite() || value.abs() > 1e12 || value.abs() < 1e-12 {
        return None;
    }
    let (mut before, mut now) = ((0_u64, 1_u64), (1_u64, 0_u64));
    let mut rest = value.abs();
    for _ in 0..24 {
        let whole = rest.floor();
        if whole > 1e12 {
            return None;
        }
        let next = (
            (whole as u64).checked_mul(now.0)?.checked_add(before.0)?,
            (whole as u64).checked_mul(now.1)?.checked_add(before.1)?,
        );
        if next.0 >= QUOTIENT_LIMIT || next.1 >= QUOTIENT_LIMIT {
            return None;
        }
        (before, now) = (now, next);
        let p = if value < 0.0 { -(now.0 as i64) } else { now.0 as i64 };
        if (p as f64 / now.1 as f64).to_bits() == value.to_bits() {
            return Some((p, now.1));
        }
        if rest == whole {
            return None;
        }
        rest = 1.0 / (rest - whole);
    }
    None
}

/// Takes bytes from the front; every failure is a [`ErrorKind::Corrupt`] that names the place.
pub(super) struct Cursor<'a> {
    rest: &'a [u8],
    place: &'static str,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8], place: &'static str) -> Self {
        Self { rest: bytes, place }
    }

    /// What to say of bytes that break a rule.
    pub(super) fn corrupt(&self, message: impl Into<String>) -> Error {
        Error::new(ErrorKind::Corrupt, message).at_place(self.place)
    }

    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or_else(|| self.corrupt("its bytes end early"))?;
        self.rest = rest;
        Ok(taken)
    }

    /// All that is left.
    pub(super) fn rest(&mut self) -> &'a [u8] {
        std::mem::take(&mut self.rest)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// Nothing may be left.
    pub(super) fn end(&self) -> Result<()> {
        if self.rest.is_empty() { Ok(()) } else { Err(self.corrupt(format!("{} bytes too many", self.rest.len()))) }
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        let (taken, rest) = self.rest.split_first_chunk().ok_or_else(|| self.corrupt("its bytes end early"))?;
        self.rest = rest;
        Ok(*taken)
    }

    pub(super) fn u8(&mut self) -> Result<u8> {
        Ok(self.array::<1>()?[0])
    }

    pub(super) fn u16(&mut self) -> Result<u16> {
        Ok(u16::from_le_bytes(self.array()?))
    }

    pub(super) fn u32(&mut self) -> Result<u32> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    pub(super) fn u64(&mut self) -> Result<u64> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    pub(super) fn varint(&mut self) -> Result<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.u8()?;
            let bits = u64::from(byte & 0x7f);
            // One number has one form: no bits above the 64th, no zero byte at the end.
            if bits << shift >> shift != bits || (byte == 0 && shift > 0) {
                break;
            }
            value |= bits << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err(self.corrupt("a varint in no valid form"))
    }

    /// A varint that is at least `least` and at most `most`; `name` says what it counts.
    pub(super) fn varint_in(&mut self, name: &str, least: u64, most: u64) -> Result<u64> {
        let value = self.varint()?;
        if (least..=most).contains(&value) {
            return Ok(value);
        }
        Err(self.corrupt(format!("{name} is {value}: expected {least} to {most}")))
    }

    pub(super) fn float(&mut self) -> Result<f64> {
        let form = self.u8()?;
        if form == QUOTIENT {
            let (p, q) = (self.varint()?, self.varint()?);
            let (p, negative) = ((p >> 1) + (p & 1), p & 1 == 1);
            if p >= QUOTIENT_LIMIT || q >= QUOTIENT_LIMIT || q == 0 {
                return Err(self.corrupt("a quotient out of range"));
            }
            let value = p as f64 / q as f64;
            return Ok(if negative { -value } else { value });
        }
        if form > 8 {
            return Err(self.corrupt(format!("a float of form {form}: expected 0 to {QUOTIENT}")));
        }
        let mut bits = [0; 8];
        bits[8 - usize::from(form)..].copy_from_slice(self.take(usize::from(form))?);
        Ok(f64::from_le_bytes(bits))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn float_bytes(value: f64) -> Vec<u8> {
        let mut bytes = vec![];
        put_float(&mut bytes, value);
        let mut cursor = Cursor::new(&bytes, "test");
        assert_eq!(cursor.float().unwrap().to_bits(), value.to_bits(), "{value} came back different");
        cursor.end().unwrap();
        bytes
    }

    #[test]
    fn floats_are_short_and_exact() {
        assert_eq!(float_bytes(0.0), [0]);
        assert_eq!(float_bytes(30.0), [2, 0x3e, 0x40]);
        assert_eq!(float_bytes(1.0 / 1200.0), [9, 2, 0xb0, 0x09]);
        assert_eq!(float_bytes(-0.1), [9, 1, 10]);
        for value in [-0.0, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE, f64::MAX, 1e-300, 463_215.0, 19_199.0 / 2400.0]
        {
            assert!(float_bytes(value).len() <= 9, "{value} is long");
        }
        assert_eq!(float_bytes(f64::from_bits(0x7ff0_0000_0000_0001)).len(), 9);
    }

    #[test]
    fn varints_have_one_form() {
        for value in [0, 1, 127, 128, 16_383, 16_384, u64::MAX] {
            let mut bytes = vec![];
            put_varint(&mut bytes, value);
            assert_eq!(Cursor::new(&bytes, "test").varint().unwrap(), value);
        }
        for bytes in [&[0x80, 0][..], &[0x80], &[0xff; 10], &[0x80; 20]] {
            assert!(Cursor::new(bytes, "test").varint().is_err(), "{bytes:?} was taken for a varint");
        }
    }
}
