//! Terrains as sparse combinations of atoms (Guérin, Digne, Galin, Peytavie 2016, Sparse representation of terrains
//! for procedural modeling: "paper 001").
//!
//! A **patch** is a square of a raster's elevations with a disc of weights in it, around its mean; patches lie on a
//! regular grid ([`PatchLayout`]) and overlap. An **atom** is a landform of a patch's shape with length 1: a patch, a
//! combination of patches, or a window of noise. A [`Dictionary`] is a list of atoms, each with its [`Origin`]. A
//! [`Pursuit`] finds a few atoms for each patch, and their coefficients. Patches as combinations of atoms, blended by
//! their weights, are a [`SparseTerrain`], which is a function of position: rebuilt, refined, edited.
//!
//! ```
//! use orograph::dictionary::{Choice, Dictionary, PatchLayout, PatchShape, Patches, Pursuit, Raster, SparseTerrain};
//!
//! let cells: Vec<f32> = (0..400).map(|i| ((i % 20) * (i / 20) % 7) as f32).collect();
//! let raster = Raster::new(20, 20, &cells)?;
//! let layout = PatchLayout::new(20, 20, PatchShape::new(8)?, None)?;
//! let patches = Patches::new(&raster, layout)?;
//! let dictionary = Dictionary::complete(&patches, "hills");
//! let found = Pursuit::new(&dictionary, 1, Choice::SmallestResidual)?.decompose(&patches)?;
//! let terrain = SparseTerrain::of(&patches, &found, dictionary)?;
//! // With all patches as atoms, one each is enough.
//! let rebuilt = terrain.raster(1)?;
//! assert!(cells.iter().zip(rebuilt).all(|(a, b)| (a - b).abs() < 1e-4));
//! # Ok::<(), orograph::error::Error>(())
//! ```
//!
//! Inner products, norms and means count cells by the disc's weights, which is how blending counts their errors; the
//! paper writes them plainly. Everything is the same on every machine and with any number of threads.

mod atoms;
mod codes;
mod layout;
mod learn;
mod noise_atom;
mod pair;
mod patches;
mod pursuit;
mod quality;
mod raster;
mod shape;
mod slopes;
mod terrain;

pub use atoms::{Dictionary, Origin, Samples};
pub use codes::Codes;
pub use layout::PatchLayout;
pub use learn::{Learned, Learning, learn, learn_constrained};
pub use noise_atom::{NoiseAtom, NoiseFamily};
pub use pair::DictionaryPair;
pub use patches::Patches;
pub use pursuit::{Choice, Decomposition, Pursuit, Signs};
pub use quality::{Difference, Storage, difference};
pub use raster::Raster;
pub use shape::PatchShape;
pub use slopes::SparseSample;
pub use terrain::SparseTerrain;
