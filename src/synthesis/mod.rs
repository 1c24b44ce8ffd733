//! Synthesis: divide trees from the statistics of real ranges.
//!
//! After Argudo et al. 2019, section 5, in four steps, each in a file of its own:
//!
//! 1. `cast`: elevations, prominences, dominances and isolations are drawn from their histograms ([`Target`]) stratum
//!    by stratum, and paired so that they go together; where it is known by how much nearest higher peaks are higher
//!    ([`Target::with_rises`]), each isolation brings its own.
//! 2. `throw`: from the highest to the lowest, each peak gets a place at its isolation from those before it, where
//!    [`Controls`] welcome it, no ridge is barred that others need (`corridors`) and the nearest higher peak is about as
//!    high as it should be.
//! 3. `grow`: peaks end by falling key saddle, each at the cheapest ridge of the Delaunay triangulation (`ridges`) that
//!    leads to a higher top: a spanning tree whose prominences are as drawn.
//! 4. `saddles`: each saddle gets a place beside its ridge.
//!
//! Peaks and ridges of a real tree may be [`Kept`]: `roles` puts them among those that are cast, they stand before darts
//! are thrown, their ridges are edges that are given to the triangulation, and growth joins at their saddles (`held`).
//!
//! What comes out is a [`crate::orometry::GivenTree`], which [`crate::orometry::survey_tree`] measures.

mod cast;
mod controls;
mod corridors;
mod crossing;
mod extent;
mod grow;
mod held;
mod kept;
mod ridges;
mod roles;
mod saddles;
mod strata;
mod synthesize;
mod tally;
mod target;
pub mod terrain;
mod throw;

pub use controls::{ControlMap, Controls};
pub use extent::Extent;
pub use kept::{Kept, KeptPeak, KeptRidge, prominences_m};
pub use synthesize::{Synthesis, SynthesisOptions, peak_counts, synthesize};
pub use target::Target;
