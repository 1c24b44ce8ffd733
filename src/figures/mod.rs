//! Figures: from what the methods measured to what the plot room draws.
//!
//! The rooms of measuring and of drawing do not know each other; this one, above both, puts numbers, names and units
//! on the axes.

mod amplified;
mod distributions;

pub use amplified::AmplifiedPage;
pub use distributions::{Subject, distributions_chart};
