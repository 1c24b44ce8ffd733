//! Noise: seeded random functions of position, smooth, bounded in value and in slope.
//!
//! [`gradient_noise`] is eta of the papers: one function with bumps about as wide as 1. [`NoiseSum`] adds octaves of
//! it, plainly (fractal noise), by absolute values (turbulence), or so that each octave's weight depends on the one
//! before (ridged multifractal). All have exact gradients, bounds that hold everywhere, and bounds over a disc.
//!
//! Only `+ - *`, comparisons, `floor` and integers are used, and many points go through the same steps as one
//! point: results are the same to the bit on every machine, with vectors or without.

mod bounds;
mod curvature;
mod eta;
mod filter;
mod gradient;
mod octave;
mod sum;
#[cfg(test)]
mod tests;

pub use curvature::CURVATURE;
pub use eta::COLS;
pub use filter::Filter;
pub use gradient::{SLOPE, gradient_noise};
pub use octave::{Octave, Spectrum};
pub use sum::{Levels, NoiseKind, NoiseSum, Rows};

/// A value with its derivatives by x and y.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// The value.
    pub value: f64,
    /// Derivative by x.
    pub dx: f64,
    /// Derivative by y.
    pub dy: f64,
}
