//! How fine means, coefficients and atoms are counted.

use crate::codec::sparse::Steps;
use crate::dictionary::PatchShape;

/// How much of the square error that sparsity leaves rounding of one kind may add, in parts. Less costs bits that
/// more atoms would use better, more loses what atoms have won.
const MEAN_SHARE: f64 = 1.0 / 48.0;
const PART_SHARE: f64 = 1.0 / 24.0;
const ATOM_SHARE: f64 = 1.0 / 48.0;
/// Nothing is counted finer than this part of the largest value: single precision ends there.
const FINEST: f64 = 1.0 / (1 << 24) as f64;

/// What steps are chosen by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measure {
    /// Root of the mean square error without rounding.
    pub(super) rms: f64,
    /// The largest magnitude of a value.
    pub(super) most: f64,
    /// Root of the mean square of all coefficients.
    pub(super) part_rms: f64,
    /// Mean number of terms of a patch.
    pub(super) terms: f64,
}

/// Steps whose rounding adds little to an error. An error of `step²/12` in a coefficient is spread over a patch as the
/// atom is, whose weighted square sum is 1: over a cell, by one part in the sum of all weights.
pub(super) fn steps_of(measure: &Measure, shape: &PatchShape) -> Steps {
    let square = measure.rms.max(measure.most * FINEST).powi(2).max(f64::MIN_POSITIVE);
    let weight: f64 = shape.weights().iter().sum();
    let terms = measure.terms.max(1.0);
    let step = |share: f64, part: f64| short((12.0 * share * square * part).sqrt());
    let parts = terms * measure.part_rms.powi(2);
    Steps {
        mean: step(MEAN_SHARE, 1.0),
        part: step(PART_SHARE, weight / terms),
        atom: if parts > 0.0 { step(ATOM_SHARE, 1.0 / parts).min(0.125) } else { 0.125 },
    }
}

/// A number not above `value`, by at most a fifth, that a file stores in few bytes: 4 to 7 times a power of two.
fn short(value: f64) -> f64 {
    if !(value.is_finite() && value > 1e-30) {
        return 2.0_f64.powi(-60);
    }
    // Exactly a power of two: what is below it in the logarithm is cut off.
    let mut power = 1.0;
    while power * 8.0 <= value {
        power *= 2.0;
    }
    while power * 4.0 > value {
        power /= 2.0;
    }
    (value / power).floor() * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_numbers_are_a_little_less() {
        for value in [1.0, 0.3, 1234.5, 1e-6, 7.99, 8.0] {
            let short = short(value);
            assert!(short <= value && short > value * 0.79, "{value}: {short}");
            assert_eq!(short.to_bits().trailing_zeros().max(50), short.to_bits().trailing_zeros(), "{short} is short");
        }
        assert!(short(0.0) > 0.0 && short(f64::NAN) > 0.0 && short(f64::INFINITY) > 0.0);
    }

    #[test]
    fn a_flat_raster_has_steps_too() {
        let measure = Measure { rms: 0.0, most: 7.5, part_rms: 0.0, terms: 0.0 };
        let steps = steps_of(&measure, &PatchShape::new(8).unwrap());
        assert!([steps.mean, steps.part, steps.atom].iter().all(|step| *step > 0.0 && step.is_finite()));
    }
}
