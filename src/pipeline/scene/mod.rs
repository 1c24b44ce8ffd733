//! The jobs behind `orograph scene`: construction trees from JSON, with the files that they name.

pub mod check;
pub mod eval;
mod files;
pub mod mesh;
mod places;
mod read;
pub mod render;
mod resample;
mod sparse;

pub use files::Cell;
pub use places::{CellOptions, SceneCells};
pub use read::{DetailOption, SceneFile};
