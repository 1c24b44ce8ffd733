//! Stored values <-> the integers that are predicted.
//!
//! `value = meaning(least + factor * x)` with `x` from 0 on; the meaning depends on the type, on the bound and on the
//! data: whole numbers, a decimal grid that floats sit on, a fixed-point grid as fine as the bound asks for, the bits
//! of floats in their order, or a list.

use super::bits::{BitReader, BitWriter};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::SampleType;

/// Step of the quantiser of [`Meaning::Fixed`]: the units in twice the bound.
pub(super) const FIXED_STEP: i64 = 9;

/// Greatest half of a step, rounded down. Encoders need no more, and shifts of errors stay below 32 bits.
const HALF_STEP_LIMIT: u64 = u32::MAX as u64;

/// Most values of a list.
const LIST_LIMIT: u64 = 1 << 14;

/// What an integer stands for.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Meaning {
    /// The value itself.
    Whole,
    /// `n * numerator / denominator`, as the nearest number of the type.
    Grid {
        /// Numerator of the grid's step.
        numerator: u32,
        /// Denominator of the grid's step.
        denominator: u32,
    },
    /// `n * unit` where the unit is two ninths of the bound, made smaller by `shrink` 65536ths.
    Fixed {
        /// Leaves room for the rounding of the floats.
        shrink: u16,
    },
    /// The float's bits, in the floats' order.
    Ordered,
    /// The value with that number in a list.
    List(Vec<i64>),
}

/// How a tile's values become integers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mapping {
    pub(super) meaning: Meaning,
    /// What `x = 0` stands for.
    pub(super) least: i64,
    /// Common divisor of all differences.
    pub(super) factor: u64,
    /// Bits of the greatest `x`; with 0 all cells are the same.
    pub(super) range_bits: u32,
    /// The quantiser's step, odd.
    pub(super) step: i64,
}

fn corrupt(what: impl Into<String>) -> Error {
    Error::new(ErrorKind::Corrupt, what)
}

impl Mapping {
    /// Writes the mapping.
    pub(super) fn write(&self, bits: &mut BitWriter) {
        let code = match self.meaning {
            Meaning::Whole => 0,
            Meaning::Grid { .. } => 1,
            Meaning::Fixed { .. } => 2,
            Meaning::Ordered => 3,
            Meaning::List(_) => 4,
        };
        bits.put(code, 3);
        bits.put_signed(self.least, 10);
        bits.put_number(self.factor - 1, 0);
        bits.put(u64::from(self.range_bits), 7);
        bits.put_number((self.step as u64 - 1) / 2, 2);
        match &self.meaning {
            Meaning::Whole | Meaning::Ordered => {}
            Meaning::Grid { numerator, denominator } => {
                bits.put_number(u64::from(numerator - 1), 0);
                bits.put_number(u64::from(denominator - 1), 6);
            }
            Meaning::Fixed { shrink } => bits.put(u64::from(*shrink), 16),
            Meaning::List(values) => {
                bits.put_number(values.len() as u64, 4);
                let mut before = None;
                for &value in values {
                    match before {
                        None => bits.put_signed(value, 10),
                        Some(before) => bits.put_number(value.wrapping_sub(before) as u64 - 1, 1),
                    }
                    before = Some(value);
                }
            }
        }
    }

    /// Reads a mapping for cells of a type.
    pub(super) fn read(bits: &mut BitReader<'_>, sample: SampleType) -> Result<Self> {
        let code = bits.take(3);
        let least = bits.take_signed(10);
        let factor = bits.take_number(0).checked_add(1).ok_or_else(|| corrupt("a tile's factor is too large"))?;
        let range_bits = bits.take(7) as u32;
        if range_bits > 64 {
            return Err(corrupt(format!("a tile's range has {range_bits} bits; at most 64 are allowed")));
        }
        let half = bits.take_number(2);
        if half > HALF_STEP_LIMIT {
            return Err(corrupt(format!("half a tile's step is {half}; at most {HALF_STEP_LIMIT} is allowed")));
        }
        let step = half as i64 * 2 + 1;
        let is_float = matches!(sample, SampleType::F32 | SampleType::F64);
        let meaning = match (code, is_float) {
            (0, false) => Meaning::Whole,
            (1, true) => {
                let number = |value: u64| {
                    u32::try_from(value.saturating_add(1)).map_err(|_| corrupt("a tile's grid is out of range"))
                };
                let numerator = number(bits.take_number(0))?;
                Meaning::Grid { numerator, denominator: number(bits.take_number(6))? }
            }
            (2, true) => Meaning::Fixed { shrink: bits.take(16) as u16 },
            (3, true) => Meaning::Ordered,
            (4, false) => {
                let count = bits.take_number(4);
                if !(1..=LIST_LIMIT).contains(&count) {
                    return Err(corrupt(format!("a tile's list has {count} values; 1 to {LIST_LIMIT} are allowed")));
                }
                let mut values: Vec<i64> = Vec::new();
                for _ in 0..count {
                    let value = match values.last() {
                        None => bits.take_signed(10),
                        Some(&before) => {
                            let gap = bits.take_number(1).saturating_add(1);
                            i64::try_from(gap)
                                .ok()
                                .and_then(|gap| before.checked_add(gap))
                                .ok_or_else(|| corrupt("a tile's list goes beyond 64-bit numbers"))?
                        }
                    };
                    bits.check()?;
                    values.push(value);
                }
                Meaning::List(values)
            }
            _ => return Err(corrupt(format!("a tile of {} has mapping {code}", sample.name()))),
        };
        Ok(Self { meaning, least, factor, range_bits, step })
    }

    /// The number that an `x` stands for, before its meaning.
    #[inline(always)]
    pub(super) fn number(&self, x: i64) -> i64 {
        self.least.wrapping_add((self.factor as i64).wrapping_mul(x))
    }

    /// A whole number of the list or as it is.
    #[inline(always)]
    pub(super) fn whole(&self, x: i64) -> i64 {
        let number = self.number(x);
        match &self.meaning {
            Meaning::List(values) => values[(number.max(0) as usize).min(values.len() - 1)],
            _ => number,
        }
    }

    /// A float of a grid; `bound` is the band's.
    #[inline(always)]
    pub(super) fn real(&self, x: i64, bound: f64) -> f64 {
        let number = self.number(x);
        match self.meaning {
            Meaning::Grid { numerator, denominator } => {
                number.wrapping_mul(i64::from(numerator)) as f64 / f64::from(denominator)
            }
            Meaning::Fixed { shrink } => number as f64 * fixed_unit(bound, shrink),
            _ => 0.0,
        }
    }
}

/// The unit of [`Meaning::Fixed`].
pub(super) fn fixed_unit(bound: f64, shrink: u16) -> f64 {
    bound * 2.0 / FIXED_STEP as f64 * (f64::from(65_536 - u32::from(shrink)) / 65_536.0)
}

/// The 32-bit float with a place in the order of all floats.
pub(super) fn f32_of_order(order: i64) -> f32 {
    let order = order as i32;
    f32::from_bits((order ^ (((order >> 31) as u32) >> 1) as i32) as u32)
}

/// The place of a 32-bit float in the order of all floats; bit patterns keep apart, -0.0 comes before 0.0.
pub(super) fn order_of_f32(value: f32) -> i64 {
    let bits = value.to_bits() as i32;
    i64::from(bits ^ (((bits >> 31) as u32) >> 1) as i32)
}

/// The 64-bit float with a place in the order of all floats.
pub(super) fn f64_of_order(order: i64) -> f64 {
    f64::from_bits((order ^ (((order >> 63) as u64) >> 1) as i64) as u64)
}

/// The place of a 64-bit float in the order of all floats.
pub(super) fn order_of_f64(value: f64) -> i64 {
    let bits = value.to_bits() as i64;
    bits ^ (((bits >> 63) as u64) >> 1) as i64
}
