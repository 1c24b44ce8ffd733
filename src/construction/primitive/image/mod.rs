//! Images: rasters of heights as features.

mod found;
mod mapping;
mod samples;

pub use mapping::Mapping;
pub use samples::{Interpolation, Samples};

use super::Primitive;
use crate::construction::area::{Area, Region};
use crate::construction::bounds::Bounds;
use crate::construction::operator::warp::pull;
use crate::construction::point::{Block, Place, Places, Point, Want};
use crate::construction::vectors::widest;
use crate::error::{Error, Result};
use crate::interval::{Interval, product};
use crate::noise::Sample;

/// A raster laid on a box, a convex quadrangle or along a curve (Génevaux et al. 2015, section 4.2).
///
/// Elevations are interpolated between samples, weights bilinearly; voids have weight 0, and the weight rises to that of
/// the raster of weights (1 without one) over one cell. A **fade** lets the weight fall to 0 towards the raster's edges,
/// over so many cells, as `(1 - x²)³`; without one the weight ends there with a jump.
///
/// # Bounds
/// The paper's `sqrt(2) / l` times the greatest difference of neighbours, with the last row's and column's differences,
/// which its `max` leaves out; differences along rows and along columns are kept apart. Bicubic interpolation overshoots:
/// its bounds are those of the control points of each cell's bicubic patch, and the differences between them. A mapping
/// multiplies slopes by the greatest norm of its Jacobian. There is no bound of the weight's slope where an edge without
/// fade lies in the region.
#[derive(Clone, Debug)]
pub struct Image {
    samples: Samples,
    mapping: Mapping,
    interpolation: Interpolation,
    /// Cells over which the weight falls towards the edges.
    fade: f64,
    z_scale: f64,
    z_shift_m: f64,
}

/// Wyvill's fall-off by the distance to the nearer edge: weight and derivative by the coordinate.
#[inline(always)]
fn fade(at: f64, last: f64, fade: f64) -> (f64, f64) {
    if fade <= 0.0 {
        return (1.0, 0.0);
    }
    let (margin, sign) = if at + at < last { (at, 1.0) } else { (last - at, -1.0) };
    let x = (1.0 - margin / fade).clamp(0.0, 1.0);
    let rest = 1.0 - x * x;
    (rest * rest * rest, sign * 6.0 * x * (rest * rest) / fade)
}

impl Image {
    /// An image; elevations are samples times `z_scale` plus `z_shift_m`.
    ///
    /// # Errors
    /// A usage error for a fade below 0 and numbers that are not finite.
    pub fn new(
        samples: Samples,
        mapping: Mapping,
        interpolation: Interpolation,
        fade: f64,
        (z_scale, z_shift_m): (f64, f64),
    ) -> Result<Self> {
        if !(fade >= 0.0 && fade.is_finite() && z_scale.is_finite() && z_shift_m.is_finite()) {
            return Err(Error::usage("an image needs a fade of at least 0 cells, and finite scale and shift"));
        }
        let samples = samples.measured(interpolation);
        Ok(Self { samples, mapping, interpolation, fade, z_scale, z_shift_m })
    }

    /// Columns and rows less one: the greatest coordinates.
    fn last(&self) -> [f64; 2] {
        [(self.samples.cols() - 1) as f64, (self.samples.rows() - 1) as f64]
    }

    #[inline(always)]
    fn point<const GRADIENT: bool>(&self, at: [f64; 2]) -> Point {
        let last = self.last();
        let Some(([u, v], jacobian)) = self.mapping.enter(at) else { return Point::NOTHING };
        let (c, r) = ((u * last[0]).clamp(0.0, last[0]), (v * last[1]).clamp(0.0, last[1]));
        let (height, weight) = self.samples.at(self.interpolation, c, r);
        let ((along, along_slope), (down, down_slope)) = (fade(c, last[0], self.fade), fade(r, last[1], self.fade));
        let share = along * down;
        let mut point = Point {
            elevation: Sample { value: height.value * self.z_scale + self.z_shift_m, dx: 0.0, dy: 0.0 },
            weight: Sample { value: weight.value * share, dx: 0.0, dy: 0.0 },
        };
        if GRADIENT {
            let per_uv = |dx: f64, dy: f64| Sample { value: 0.0, dx: dx * last[0], dy: dy * last[1] };
            let slope = pull(&jacobian, per_uv(height.dx * self.z_scale, height.dy * self.z_scale));
            let fall = pull(
                &jacobian,
                per_uv(
                    weight.dx * share + weight.value * along_slope * down,
                    weight.dy * share + weight.value * along * down_slope,
                ),
            );
            (point.elevation.dx, point.elevation.dy) = (slope.dx, slope.dy);
            (point.weight.dx, point.weight.dy) = (fall.dx, fall.dy);
        }
        point.settled()
    }
}

impl Primitive for Image {
    fn support(&self) -> Area {
        self.mapping.area().widened()
    }

    fn bounds(&self, region: &Region) -> Bounds {
        let last = self.last();
        let seen = self.mapping.seen(&region.area);
        let Some((u, v)) = seen.uv else { return Bounds::NOTHING };
        let scaled =
            |i: Interval, last: f64| Interval { min: i.min * last, max: i.max * last }.widened().clamped(0.0, last);
        let (c, r) = (scaled(u, last[0]), scaled(v, last[1]));
        let found = self.samples.over(self.interpolation, c, r);
        if found.weight.max <= 0.0 {
            return Bounds::NOTHING;
        }
        // The weight's fall towards the edges, and its slope there.
        let edge = |range: Interval, last: f64| {
            if self.fade <= 0.0 {
                return (Interval::ONE, 0.0);
            }
            let (a, b) = (fade(range.min, last, self.fade), fade(range.max, last, self.fade));
            let middle = if range.holds(last / 2.0) { fade(last / 2.0, last, self.fade).0 } else { 0.0 };
            // Highest in the middle, so lowest at an end.
            let share = Interval { min: a.0.min(b.0), max: a.0.max(b.0).max(middle) };
            let whole = share.min >= 1.0;
            (share, if whole { 0.0 } else { 1.717_301_6 / self.fade })
        };
        let ((along, along_slope), (down, down_slope)) = (edge(c, last[0]), edge(r, last[1]));
        let mut weight = found.weight.times(along.times(down));
        let length = |x: f64, y: f64| (x * x + y * y).sqrt();
        let slope_uv = length(found.dx * last[0], found.dy * last[1]) * self.z_scale.abs();
        let fall = |slope: f64, side: f64, last: f64| (slope + product(found.weight.max, side)) * last;
        let fall_uv = length(fall(found.weight_dx, along_slope, last[0]), fall(found.weight_dy, down_slope, last[1]));
        let mut weight_slope = product(fall_uv, seen.stretch);
        if seen.has_edge {
            weight.min = 0.0;
            if self.fade <= 0.0 {
                weight_slope = f64::INFINITY;
            }
        }
        let elevation = found.height.scaled(self.z_scale).plus(Interval::point(self.z_shift_m));
        Bounds::new(elevation, product(slope_uv, seen.stretch), weight, weight_slope).widened()
    }

    fn at(&self, place: &Place) -> Point {
        self.point::<true>(place.at)
    }

    fn block(&self, places: &Places, want: Want, out: &mut Block) {
        widest(
            #[inline(always)]
            || {
                for k in 0..places.count() {
                    let at = [places.x[k], places.y[k]];
                    if want.gradient {
                        out.set::<true>(k, self.point::<true>(at));
                    } else {
                        out.set::<false>(k, self.point::<false>(at));
                    }
                }
            },
        );
    }

    fn bytes(&self) -> usize {
        size_of::<Self>() + self.samples.bytes() + self.mapping.bytes()
    }
}
