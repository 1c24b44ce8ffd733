//! Where water goes on a terrain, and what it takes along.
//!
//! - [`Relief`] is a raster of elevations with the size of its cells; NaN where there is none.
//! - [`Drainage`] says for every cell to which neighbour its water goes, through depressions and out of them again,
//!   and gives the cells in an order in which each comes after the one it drains to. So what follows are single passes:
//!   drained areas, the levels to which depressions fill, and erosion.
//! - [`fill`] and [`breach`] make do without that order: depressions filled, or opened.
//! - [`incise`] is a step of the stream power law, [`slide`] lets go what is steeper than an angle of repose.
//! - [`Anchors`] keep peaks and saddles where they are while all around erodes.
//!
//! Everything here is the same for any number of threads: areas are whole numbers of cells, and elevations follow
//! from those of one receiver.

mod anchors;
mod basins;
mod breach;
mod drainage;
mod fill;
mod incise;
mod relief;
mod slide;

pub use anchors::Anchors;
pub use breach::breach;
pub use drainage::Drainage;
pub use fill::fill;
pub use incise::incise;
pub use relief::Relief;
pub use slide::slide;
