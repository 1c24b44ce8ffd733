//! Rays against terrain: what a camera sees of construction trees.
//!
//! A [`Camera`] gives a [`Ray`] for each place of a picture; [`trace`] follows them to the ground and from there to the
//! sun. The ground is what lies at and below the elevation where the terrain is defined, so rays pass over whatever is
//! not (the fringe, whose weight is below [`super::THRESHOLD`]), and meet a wall where they enter the terrain's edge
//! from the side.

mod beam;
mod camera;
mod follow;
mod line;
mod march;
mod packet;
mod patch;
mod picture;
mod quads;
mod ray;
mod seek;
mod sweep;
mod tracer;

pub use camera::{Aim, Camera, Lens, View};
pub use picture::{Counts, Seen, Strategy, TraceOptions, Traced, trace};
pub use ray::Ray;
