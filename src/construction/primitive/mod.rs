//! The leaves: features of terrain.

mod contour;
mod curve;
mod disc;
mod fall_off;
mod image;
mod profile;
mod pyramid;
mod skeleton;
mod sparse;

pub use contour::Contour;
pub use curve::Curve;
pub use disc::Disc;
pub use fall_off::FallOff;
pub use image::{Image, Interpolation, Mapping, Samples};
pub use profile::Profile;
pub use skeleton::Skeleton;
pub use sparse::Sparse;

use super::area::{Area, Region};
use super::bounds::Bounds;
use super::point::{Block, Place, Places, Point, Want};

/// A feature of terrain: an elevation and a weight, as functions of position.
///
/// # What an implementation keeps to
/// - Results depend on the place (and its level of detail) alone, and are the same to the bit from [`Primitive::at`]
///   and [`Primitive::block`], on every machine: `+ - * /`, `sqrt`, `floor`, comparisons and integers.
/// - Outside of [`Primitive::support`] the weight is 0. Where the weight is 0, all else is ([`Point::settled`]).
/// - No point breaks [`Primitive::bounds`]; weights are finite and at least 0, elevations finite.
pub trait Primitive: std::fmt::Debug + Send + Sync {
    /// A box outside of which the weight is 0.
    fn support(&self) -> Area;

    /// Bounds over a region that meets the support; the region may be unbounded where the support is.
    fn bounds(&self, region: &Region) -> Bounds;

    /// Elevation and weight at a place, with gradients.
    fn at(&self, place: &Place) -> Point;

    /// Elevations and weights at a block of places. Elevations that are not wanted may be anything finite.
    fn block(&self, places: &Places, want: Want, out: &mut Block) {
        let _ = want;
        for k in 0..places.count() {
            out.set::<true>(k, self.at(&places.get(k)));
        }
    }

    /// Whether the weight is 0 at all points of a box; false where that is not known.
    fn misses(&self, area: &Area) -> bool {
        let _ = area;
        false
    }

    /// Bytes of memory that the feature takes.
    fn bytes(&self) -> usize;

    /// Whether the level of detail matters.
    fn minds_detail(&self) -> bool {
        false
    }
}
