//! kappa: how much detail is asked for where.

use super::area::{Area, Region};
use crate::interval::Interval;
use crate::noise::Sample;

/// Source of the level of detail kappa of `[0, 1]` (Génevaux et al. 2015, section 6).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detail {
    /// The same everywhere.
    Constant(f64),
    /// All near a point, less further away: 1 up to `near_m` from `centre`, 0 beyond `far_m`, between them
    /// `1 - (3 - 2 t) t²` of the share t of the way.
    Around {
        /// Where detail is wanted: below a camera.
        centre: [f64; 2],
        /// Distance up to which all is shown, in metres.
        near_m: f64,
        /// Distance beyond which nothing is, in metres; more than `near_m`.
        far_m: f64,
    },
}

impl Default for Detail {
    fn default() -> Self {
        Self::Constant(1.0)
    }
}

impl Detail {
    /// The level of detail at a place of the scene.
    #[inline(always)]
    pub fn at(&self, [x, y]: [f64; 2]) -> Sample {
        match *self {
            Self::Constant(value) => Sample { value, dx: 0.0, dy: 0.0 },
            Self::Around { centre, near_m, far_m } => {
                let (dx, dy) = (x - centre[0], y - centre[1]);
                let d = (dx * dx + dy * dy).sqrt();
                let t = ((d - near_m) / (far_m - near_m)).clamp(0.0, 1.0);
                // At the centre itself t is 0, so is the slope.
                let slope = -6.0 * t * (1.0 - t) / ((far_m - near_m) * d.max(f64::MIN_POSITIVE));
                Sample { value: 1.0 - t * t * (3.0 - 2.0 * t), dx: slope * dx, dy: slope * dy }
            }
        }
    }

    /// The region of a box of the scene.
    pub fn over(&self, area: Area) -> Region {
        match *self {
            Self::Constant(value) => Region { area, kappa: Interval::point(value), kappa_slope: 0.0 },
            Self::Around { centre, near_m, far_m } => {
                let distances = area.square_distances(centre);
                let at = |square: f64| self.at([centre[0] + square.sqrt(), centre[1]]).value;
                let kappa = if distances.max.is_finite() {
                    // Distances along x round differently; kappa changes by less than this.
                    let kappa = Interval::new(at(distances.min), at(distances.max));
                    if kappa.width() == 0.0 { kappa } else { kappa.widened().clamped(0.0, 1.0) }
                } else {
                    Interval::new(0.0, 1.0)
                };
                // 6 t (1 - t) is at most 3/2.
                let still = kappa == Interval::ZERO || kappa == Interval::ONE;
                let kappa_slope = if still { 0.0 } else { 1.5 / (far_m - near_m) };
                Region { area, kappa, kappa_slope }
            }
        }
    }
}
