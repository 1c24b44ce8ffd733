//! Amplification: finer terrain from a coarse DEM and exemplars (paper 001, section 5.3, and what came after it).
//!
//! [`Cascade`] is the accurate way: the best estimate of the true finer heights. Terrain is made finer in steps, by 4 where
//! that can be. A step begins with bicubic heights ([`Bicubic`]); a small convolutional network that has learned from the
//! exemplars (`network`) says what is to be added; and back-projection sees to it that the means of the fine cells are the
//! coarse heights again.
//!
//! A cascade that has learned texture makes one plausible terrain for each seed, in steps by 2 mostly. In the first step a
//! network says what is to be added; in later ones patches of the coarse plane do, by regressions, one for each of many
//! kinds of patch (`anchors`, `learn`, `step`; A+, Timofte et al. 2014). That detail is made larger, samples of what
//! exemplars have beyond the estimate are laid on it (`texture`, as strong as `strength` says of the place), water stays
//! level (`level`), and the small pits that all of that makes are opened (`breach`).
//!
//! [`Paper`] is amplification as paper 001 writes it: patches of the exemplar stand in for those of the coarse plane. It is
//! for comparison, and for its look: it keeps no means.
//!
//! What either has learned can be kept as bytes (`keep`) and makes the same terrain when it is read again.
//!
//! Methods know no edges and no voids: a plane comes with margins, made by [`extended`] and [`filled`], and everything
//! has a fixed reach. So terrain of any size can be worked on part by part, and comes out the same to the bit. Only
//! additions, products, divisions and roots decide, in one order: it is the same on every machine, too.

mod anchors;
mod back_projection;
mod bicubic;
mod breach;
mod cascade;
mod extend;
mod features;
mod fill;
pub(crate) mod keep;
mod learn;
mod level;
mod network;
mod orientation;
mod paper;
mod plane;
mod realistic;
mod step;
mod strength;
#[cfg(test)]
mod tests;
mod texture;

pub use bicubic::{Bicubic, cubic};
pub use cascade::{Cascade, MOST_FACTOR, check_factor};
pub use extend::{extended, extended_mask};
pub use fill::{FILL_REACH, filled, filled_to};
pub use paper::{Paper, PatchModel};
pub use plane::Plane;
