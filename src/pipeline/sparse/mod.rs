//! Jobs of the sparse profile: learning a dictionary, and describing a raster with one.
//!
//! A raster becomes patches, patches become atoms with coefficients ([`crate::dictionary`]), and all of them whole
//! numbers ([`Model`]) that a container holds ([`crate::oro`]).

pub mod encode;
pub mod learn;
mod model;
mod read;
mod steps;

pub use model::{Model, ModelOptions};
