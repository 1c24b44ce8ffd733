//! Octaves that set in with the level of detail.

use super::Sample;

/// When an octave sets in with growing level of detail kappa of `[0, 1]`: 0 up to `from`, 1 beyond `to`.
///
/// Between, `(1 - (1 - t)²)³` with `t = (kappa - from) / (to - from)`. The printed filter of Génevaux et al. 2015,
/// section 6, `(1 - t²)³`, falls from 1 to 0 and jumps at both ends; this is its mirror image, which rises from 0
/// to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// Level of detail at which the octave begins to show.
    pub from: f64,
    /// Level of detail at which it is whole; more than `from`.
    pub to: f64,
}

impl Filter {
    /// Share of the octave at a level of detail, and its derivative.
    #[inline(always)]
    pub fn share(&self, kappa: f64) -> (f64, f64) {
        let width = self.to - self.from;
        let t = ((kappa - self.from) / width).clamp(0.0, 1.0);
        let (back, s) = (1.0 - t, t * (2.0 - t));
        (s * s * s, 6.0 * back * (s * s) / width)
    }

    /// The share with its derivatives by place, those of the level of detail given.
    #[inline(always)]
    pub(super) fn sample(&self, kappa: Sample) -> Sample {
        let (value, slope) = self.share(kappa.value);
        Sample { value, dx: slope * kappa.dx, dy: slope * kappa.dy }
    }

    /// Bound of the derivative of [`Filter::share`]: 96 sqrt(5) / 125 over the width.
    pub fn slope(&self) -> f64 {
        1.717_301_6 / (self.to - self.from)
    }
}
