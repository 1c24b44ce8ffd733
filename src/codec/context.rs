//! From the expected error of a cell to how its residual is stored.
//!
//! A *context* is a number: of 10 bits an eighth of an octave of the expected error, and how far the prediction was
//! rounded; above them the zone. Each pass turns contexts into tables once.

use super::params::PassParams;
use super::tables::{TableRef, TableSet};
use super::zones::MAX_ZONES;

/// Eighths of octaves that an expected error can fall into.
const EIGHTHS: usize = 224;
/// Classes of the prediction's fraction.
const CLASSES: usize = 4;
/// Number of contexts of a zone, rounded up so that ten bits always name one.
pub(super) const CONTEXTS: usize = 1 << ZONE_SHIFT;
/// The bits of a context above these are its zone.
const ZONE_SHIFT: u32 = 10;

/// What is the same for all passes of a tile.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileRule {
    /// The quantiser's step, odd.
    pub(super) step: i64,
    /// Errors are divided by `2^coarseness`.
    pub(super) coarseness: u32,
}

/// The coarseness of errors that suits a step, unless a tile says otherwise.
pub(super) fn usual_coarseness(step: i64) -> u32 {
    (64 - step.leading_zeros()).saturating_sub(6).min(NARROW_COARSENESS)
}

/// Greatest coarseness where integers of so many bits are predicted: then the greatest error is about the greatest
/// integer.
pub(super) fn greatest_coarseness(range_bits: u32) -> u32 {
    if range_bits > 31 { 47 } else { NARROW_COARSENESS }
}

/// Greatest coarseness for 32-bit integers.
const NARROW_COARSENESS: u32 = 15;

impl TileRule {
    /// Turns the rounding of a prediction into its class: a multiplier, whose product's high bits are the class.
    pub(super) fn class_factor(self) -> i32 {
        match self.step {
            // Quarters of a half, an exact half among the last.
            1 => 512,
            // Thirds of a half.
            3 => 357,
            _ => 0,
        }
    }

    /// Whether residuals are turned so that a positive one leads back over the prediction's rounding.
    pub(super) fn turns(self) -> bool {
        self.step <= 3
    }
}

/// How a residual is stored: its table, and how many low bits as they are.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ask {
    pub(super) table: TableRef,
    pub(super) raw: u8,
}

/// How residuals are stored in each context of a pass.
pub(super) struct Asks(Box<[Ask; CONTEXTS * MAX_ZONES]>);

impl Asks {
    /// The tables of a pass, from the parameters of each zone.
    pub(super) fn new(params: &[PassParams], rule: TileRule) -> Self {
        let mut asks = Box::new([Ask::default(); CONTEXTS * MAX_ZONES]);
        for (asks, params) in asks.chunks_mut(CONTEXTS).zip(params) {
            for (eighth, asks) in asks.as_chunks_mut::<CLASSES>().0.iter_mut().enumerate() {
                let bin = bin_of(eighth, rule);
                for (class, ask) in asks.iter_mut().enumerate() {
                    ask.table = TableSet::table(rule.step, params.shape, params.shift, bin, class);
                    ask.raw = TableSet::raw_bits(bin) as u8;
                }
            }
        }
        Self(asks)
    }

    /// How a residual of a context is stored.
    #[inline(always)]
    pub(super) fn of(&self, context: u16) -> Ask {
        self.0[usize::from(context) & (CONTEXTS * MAX_ZONES - 1)]
    }
}

/// The eighth of an octave that an expected error (below `2^31`) falls into; errors below 8 are alike.
#[inline(always)]
pub(super) fn eighth_of(expected: u32) -> u32 {
    let v = expected.max(8);
    let octave = 31 - v.leading_zeros();
    (octave - 3) * 8 + ((v >> (octave - 3)) & 7)
}

/// The same as [`eighth_of`], from the exponent and the first bits of a float: loops of it take vectors.
#[inline(always)]
fn eighth_by_float(expected: u32) -> u32 {
    let v = expected.max(8);
    // Without the bit that lies eight below the first one, rounding never reaches the three bits that count.
    let v = v & !(v >> 8);
    ((v as i32 as f32).to_bits() >> 20) - (130 << 3)
}

/// The contexts of a row of cells from their expected errors and the roundings of their predictions.
#[inline(always)]
pub(super) fn contexts_of(contexts: &mut [u16], expected: &[u32], rests: impl Fn(usize) -> i32, factor: i32) {
    for (col, (context, &expected)) in contexts.iter_mut().zip(expected).enumerate() {
        *context = (eighth_by_float(expected) << 2) as u16 | class_of(rests(col), factor);
    }
}

/// What a zone adds to the contexts of its cells.
#[inline(always)]
pub(super) fn zone_context(zone: usize) -> u16 {
    (zone << ZONE_SHIFT) as u16
}

/// The zone that a context is of.
#[inline(always)]
pub(super) fn zone_of(context: u16) -> usize {
    usize::from(context) >> ZONE_SHIFT
}

/// The context of one cell.
#[inline(always)]
pub(super) fn context_of(expected: u32, rest: i32, factor: i32) -> u16 {
    (eighth_of(expected) << 2) as u16 | class_of(rest, factor)
}

#[inline(always)]
fn class_of(rest: i32, factor: i32) -> u16 {
    ((rest.unsigned_abs() * factor as u32) >> 16).min(CLASSES as u32 - 1) as u16
}

/// The bin of an eighth: quarter octaves of the expected error in 1024ths of a step, from 16 on.
fn bin_of(eighth: usize, rule: TileRule) -> usize {
    let eighth = eighth.min(EIGHTHS - 1) as u32;
    // The middle of the eighth, doubled to be whole; an expected error is in 1024ths of quarters.
    let middle = u128::from(17 + 2 * (eighth % 8)) << (eighth / 8);
    let error = ((middle << rule.coarseness) / (8 * rule.step as u128)).max(16);
    let octave = 127 - error.leading_zeros();
    ((octave - 4) * 4) as usize + ((error >> (octave - 2)) & 3) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eighths_are_found_alike_both_ways() {
        let mut v = 1u32;
        for _ in 0..200_000 {
            v = v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let expected = (v >> 1) >> (v % 31);
            assert_eq!(eighth_of(expected), eighth_by_float(expected), "{expected}");
        }
        for octave in 0..31 {
            for expected in [(1u32 << octave) - 1, 1 << octave, (1 << octave) + 1] {
                assert_eq!(eighth_of(expected), eighth_by_float(expected), "{expected}");
            }
        }
        assert_eq!(eighth_of(i32::MAX as u32), EIGHTHS as u32 - 1);
    }

    #[test]
    fn bins_grow_with_the_expected_error() {
        for step in [1, 3, 9, 21, 1001, i64::from(u32::MAX)] {
            let rule = TileRule { step, coarseness: usual_coarseness(step) };
            let bins: Vec<usize> = (0..EIGHTHS).map(|eighth| bin_of(eighth, rule)).collect();
            assert!(bins.is_sorted());
        }
        // At a step of 1 a bin is two eighths: 2^12 1024ths of quarters are one unit, and 1024 1024ths of a step.
        let rule = TileRule { step: 1, coarseness: 0 };
        assert_eq!(bin_of((12 - 3) * 8, rule), (10 - 4) * 4);
    }
}
