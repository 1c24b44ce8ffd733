//! Fits a pass to its terrain: filters by weighted least squares, weights of errors by least squares without
//! negative weights. Only encoders do this; sums run in a fixed order, so every machine finds the same numbers.

mod bits;
mod filters;
mod samples;
mod solve;
mod weights;

pub(super) use bits::log2;
pub(super) use samples::Samples;
pub(super) use solve::solve;
pub(super) use weights::ErrorFit;
