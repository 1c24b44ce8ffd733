//! Where rasters lie on Earth (or the Moon): coordinate reference systems and distances.
//!
//! A [`Crs`] is what the file says, read once by `io`; a [`Metric`] measures between cells of one raster: plane
//! geometry in a projected CRS ([`Planar`]), geodesics on the CRS's own ellipsoid in a geographic one ([`Geodesic`]),
//! and geodesics between projected cells on request ([`Surface`]). Only this folder knows geodesics.

mod definition;
mod ellipsoid;
mod geodesic;
mod metric;
mod planar;
mod surface;

pub use definition::{Crs, CrsKind};
pub use ellipsoid::{Ellipsoid, Geodesics};
pub use geodesic::Geodesic;
pub use metric::{Block, Metric, Place, Vector};
pub use planar::Planar;
pub use surface::{Surface, ToGeographic};
