//! What filters would cost.

use super::samples::{ROW, Samples, miss};
use crate::codec::pass::FRACTION;
use crate::codec::taps::MAX_TAPS;

impl Samples {
    /// Mean of the squared-off logarithms of what filters miss by: about the bits a cell takes, up to a constant.
    pub(in crate::codec) fn bits(&self, filters: [&[i32; MAX_TAPS]; 2], step: i64) -> f64 {
        let scaled = filters.map(scaled);
        let unit = 0.3 * step as f32;
        crate::codec::vectors::widest(
            #[inline(always)]
            || {
                let mut bits = 0.0;
                for (index, sample) in self.samples.iter().enumerate().step_by(2) {
                    let miss = miss(sample, &scaled[usize::from(index >= self.flat)]).abs();
                    // The spread's part is what the contexts know already.
                    bits += f64::from(log2(miss * miss + unit * unit)) * 0.5;
                }
                bits / self.samples.len().div_ceil(2).max(1) as f64
            },
        )
    }
}

/// A filter's weights as numbers.
fn scaled(filter: &[i32; MAX_TAPS]) -> [f32; ROW] {
    std::array::from_fn(|k| filter.get(k).map_or(0.0, |&weight| weight as f32 / (1 << FRACTION) as f32))
}

/// Logarithm to base 2 from the bits of a float: the same on every machine, within 0.01.
#[inline(always)]
pub(in crate::codec) fn log2(value: f32) -> f32 {
    let bits = value.to_bits();
    let exponent = (bits >> 23) as f32 - 127.0;
    let x = f32::from_bits((bits & 0x007f_ffff) | 0x3f80_0000) - 1.0;
    exponent + x * (1.342_57 - 0.342_57 * x)
}
