//! The inner nodes: features combined.
//!
//! Each file has what the operator does at a point, its gradient, and its bounds from those of its children.

pub(super) mod add;
pub(super) mod blend;
pub(super) mod boxes;
pub(super) mod level;
pub(super) mod replace;
pub(super) mod warp;
pub(super) mod weigh;

pub use level::Thresholds;
pub use warp::{Affine, Deformation};
pub use weigh::{Ramp, Rules};

/// What becomes of the weight where a node replaces another or is added to it (Génevaux et al. 2015, sections 5.2
/// and 5.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WeightRule {
    /// The first operand's weight stays as it is.
    #[default]
    Keep,
    /// The second operand's weight counts too: the terrain may reach beyond the first operand.
    Join,
}
