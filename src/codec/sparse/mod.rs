//! The sparse profile: terrain as patches, each a mean and a few atoms of a dictionary (Guérin et al. 2016).
//!
//! What goes in are whole numbers: means, coefficients and the values of atoms, each counted in steps of its own.
//! [`encode_atoms`] makes bytes of a dictionary, [`encode_patches`] of the patches of one tile; [`Blend`] makes cells
//! of both. `format-spec/oro.md` describes the bytes and the arithmetic.

mod atoms;
mod blend;
mod numbers;
mod patches;
mod terms;

pub use atoms::{MAX_ATOM_VALUES, decode_atoms, encode_atoms};
pub use blend::{Blend, Lattice, Steps, blended, fall_off, weights};
pub use patches::{PatchTile, decode_patches, encode_patches};
pub use terms::{MAX_TERMS, Term};
