//! The layers of a survey, and that of a mesh, row by row, as they are written.

mod divide_tree;
mod isolation;
mod line;
mod measure;
mod peaks;
mod saddles;
mod style;
mod triangles;

pub use divide_tree::DivideTreeLayer;
pub use isolation::IsolationLayer;
pub use measure::{Frame, LengthOutput};
pub use peaks::{PeakTags, PeaksLayer};
pub use saddles::SaddlesLayer;
pub use triangles::TrianglesLayer;

/// Names of the layers of a survey, in the order in which they are written.
pub const NAMES: [&str; 4] = ["peaks", "saddles", "divide_tree", "isolation"];
