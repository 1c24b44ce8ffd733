//! Triangulated terrain: meshes of rasters, within an error or regular, their way back to rasters, and mesh files.
//!
//! Inside, x is the column and y the row of a cell, counted at its centre, so that cells are whole numbers and every
//! decision is exact; [`Mesh::turn_over`] and whoever knows the georeference make coordinates of them at the end.
//!
//! - [`Heights`] is a raster of elevations with voids; [`regular`] makes a mesh of all its cells.
//! - [`refine`] chooses the cells that a mesh needs to be nowhere more than an error from the others; [`Breaklines`]
//!   are lines that its triangles must not cross.
//! - [`Triangulation`] is the constrained Delaunay triangulation of any points, and the only door to `spade`.
//! - [`scan`] draws a mesh into a raster.
//! - [`write_obj`], [`write_ply`] and [`write_glb`] write a mesh as a file.

mod breaklines;
mod crossings;
mod glb;
mod ground;
mod heights;
mod mesh;
mod obj;
mod plane;
mod ply;
mod refine;
mod regular;
mod scan;
mod spans;
mod triangulation;

pub use breaklines::Breaklines;
pub use glb::{GlbOptions, write_glb};
pub use heights::Heights;
pub use mesh::Mesh;
pub use obj::write_obj;
pub use ply::{PlyOptions, write_ply};
pub use refine::{RefineOptions, Refined, refine};
pub use regular::regular;
pub use scan::{SUBCELLS, scan, snapped};
pub use triangulation::Triangulation;
