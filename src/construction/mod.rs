//! Construction trees: a terrain is a function of position (Génevaux, Galin, Peytavie, Guérin, Briquet, Grosbellet,
//! Benes, "Terrain modelling from feature primitives", Computer Graphics Forum 34(6), 2015, doi:10.1111/cgf.12530).
//!
//! A [`Tree`] has **primitives** at its leaves (a disc of noise, a river, a lake, a raster) and **operators** inside
//! (blend, replace, add, warp, level of detail). Every node is two functions of position: an **elevation** f in metres
//! and a **weight** alpha, both with gradients. The terrain is defined where the root's weight is at least
//! [`THRESHOLD`]. A node may have many parents: the tree is a directed acyclic graph, and instances cost nothing.
//!
//! A [`Builder`] puts nodes together, children first. [`Tree::at`] evaluates one point. [`Tree::plan`] prunes the tree
//! to what a box needs, and knows its [`Bounds`] there: range of elevations and weights, Lipschitz constants of both.
//! [`Tree::evaluate`] does that for each tile of a [`Lattice`] and evaluates blocks of points at once, in parallel;
//! results are the same to the bit for any tiling, on any machine.
//!
//! Coordinates and elevations are in metres.

mod area;
mod bounds;
mod detail;
mod evaluate;
mod operator;
mod plan;
mod point;
pub mod primitive;
pub mod scene;
mod scratch;
pub mod trace;
mod tree;
mod vectors;

pub use area::{Area, Region};
pub use bounds::{Bounds, THRESHOLD};
pub use detail::Detail;
pub use evaluate::{Lattice, Tiling};
pub use operator::{Affine, Deformation, Ramp, Rules, Thresholds, WeightRule};
pub use plan::Plan;
pub use point::{Block, COLS, Place, Places, Point, ROWS, WIDTH, Want};
pub use tree::{Builder, NodeId, Tree};
