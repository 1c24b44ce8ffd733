//! Discs: plateaus, hills and mountains around a point.

use super::{FallOff, Primitive};
use crate::construction::area::{Area, Region};
use crate::construction::bounds::Bounds;
use crate::construction::point::{Block, COLS, Place, Places, Point, ROWS, Want, rows, rows_mut};
use crate::construction::vectors::widest;
use crate::error::{Error, Result};
use crate::interval::Interval;
use crate::noise::{NoiseSum, Rows, Sample};

/// A disc of terrain: `f(p) = base + noise(p - centre)` with a weight that falls off with the distance.
///
/// Génevaux et al. 2015, section 4.1: a constant is a plain, turbulence makes hills, ridged multifractals mountains.
/// Noise whose octaves have filters follows the level of detail (section 6). Without a fall-off the disc is the whole
/// plane.
///
/// Bounds: the slope is that of the noise (`sum a_i s_i lambda_eta`; the paper divides by `s_i`, which are
/// frequencies); the weight's that of the fall-off between the nearest and the furthest point.
#[derive(Clone, Debug, PartialEq)]
pub struct Disc {
    centre: [f64; 2],
    base_m: f64,
    noise: Option<NoiseSum>,
    fall_off: Option<FallOff>,
}

impl Disc {
    /// A disc around `centre`.
    ///
    /// # Errors
    /// A usage error for numbers that are not finite.
    pub fn new(centre: [f64; 2], base_m: f64, noise: Option<NoiseSum>, fall_off: Option<FallOff>) -> Result<Self> {
        let sound =
            noise.iter().flat_map(NoiseSum::octaves).all(|o| o.amplitude.is_finite() && o.frequency.is_finite());
        if !(centre[0].is_finite() && centre[1].is_finite() && base_m.is_finite() && sound) {
            return Err(Error::usage("a disc needs finite coordinates, elevation, amplitudes and wavelengths"));
        }
        let noise = noise.map(|noise| noise.with_base(base_m));
        Ok(Self { centre, base_m, noise, fall_off })
    }

    /// Weights, and elevations where wanted, of a block.
    #[inline(always)]
    fn fill<const GRADIENT: bool>(&self, places: &Places, elevation: bool, out: &mut Block) {
        let [weight, weight_x, weight_y] = &mut out.weight;
        let (weight, weight_x, weight_y) =
            (rows_mut(weight, places), rows_mut(weight_x, places), rows_mut(weight_y, places));
        let (xs, ys) = (rows(&places.x, places), rows(&places.y, places));
        match &self.fall_off {
            None => {
                weight.fill([1.0; COLS]);
                if GRADIENT {
                    weight_x.fill([0.0; COLS]);
                    weight_y.fill([0.0; COLS]);
                }
            }
            Some(fall_off) => {
                for r in 0..xs.len() {
                    if !GRADIENT && places.crossing {
                        let (dx, dy) = (less(&xs[0], self.centre[0]), ys[r][0] - self.centre[1]);
                        if fall_off.plateau_m() > 0.0 {
                            let _ = weigh::<true>(fall_off, &dx, &[dy; COLS], &mut weight[r]);
                        } else {
                            let _ = weigh::<false>(fall_off, &dx, &[dy; COLS], &mut weight[r]);
                        }
                        continue;
                    }
                    let (dx, dy) = (less(&xs[r], self.centre[0]), less(&ys[r], self.centre[1]));
                    let slopes = if fall_off.plateau_m() > 0.0 {
                        weigh::<true>(fall_off, &dx, &dy, &mut weight[r])
                    } else {
                        weigh::<false>(fall_off, &dx, &dy, &mut weight[r])
                    };
                    if GRADIENT {
                        for k in 0..COLS {
                            (weight_x[r][k], weight_y[r][k]) = (slopes[k] * dx[k], slopes[k] * dy[k]);
                        }
                    }
                }
            }
        }
        if elevation {
            self.rise::<GRADIENT>(places, out);
        } else {
            out.elevation[0][..places.count()].fill(0.0);
            out.elevation[1][..places.count()].fill(0.0);
            out.elevation[2][..places.count()].fill(0.0);
        }
    }

    /// Elevations of a block whose weights are known.
    #[inline(always)]
    fn rise<const GRADIENT: bool>(&self, places: &Places, out: &mut Block) {
        let [value, dx, dy] = &mut out.elevation;
        let (value, dx, dy) = (rows_mut(value, places), rows_mut(dx, places), rows_mut(dy, places));
        if let Some(noise) = &self.noise {
            let [kappa, kappa_x, kappa_y] = &places.kappa;
            let kappa = [rows(kappa, places), rows(kappa_x, places), rows(kappa_y, places)];
            let (xs, ys) = (rows(&places.x, places), rows(&places.y, places));
            if places.crossing {
                let mut heights = [0.0; ROWS];
                for (height, ys) in heights.iter_mut().zip(ys) {
                    *height = ys[0] - self.centre[1];
                }
                let xs = less(&xs[0], self.centre[0]);
                noise.cross::<GRADIENT>(&xs, &heights[..ys.len()], kappa, Rows { value, dx, dy });
            } else {
                let (mut moved_x, mut moved_y) = ([[0.0; COLS]; ROWS], [[0.0; COLS]; ROWS]);
                for r in 0..ys.len() {
                    moved_x[r] = less(&xs[r], self.centre[0]);
                    moved_y[r] = less(&ys[r], self.centre[1]);
                }
                let (xs, ys) = (&moved_x[..ys.len()], &moved_y[..ys.len()]);
                noise.scatter::<GRADIENT>(xs, ys, kappa, Rows { value, dx, dy });
            }
        } else {
            value.fill([self.base_m; COLS]);
            if GRADIENT {
                dx.fill([0.0; COLS]);
                dy.fill([0.0; COLS]);
            }
        }
        let furthest = places.area.square_distances(self.centre).max;
        if self.fall_off.is_none_or(|fall_off| fall_off.at_square(furthest) > 0.0) {
            return;
        }
        // Where the weight is 0, so are its derivatives.
        let [value, dx, dy] = &mut out.elevation;
        let (value, dx, dy) = (rows_mut(value, places), rows_mut(dx, places), rows_mut(dy, places));
        for (r, weight) in rows(&out.weight[0], places).iter().enumerate() {
            for k in 0..COLS {
                let kept = if weight[k] > 0.0 { 1.0 } else { 0.0 };
                value[r][k] *= kept;
                if GRADIENT {
                    (dx[r][k], dy[r][k]) = (dx[r][k] * kept, dy[r][k] * kept);
                }
            }
        }
    }
}

/// Coordinates of a row, counted from the centre.
#[inline(always)]
fn less(row: &[f64; COLS], centre: f64) -> [f64; COLS] {
    let mut moved = *row;
    for value in &mut moved {
        *value -= centre;
    }
    moved
}

/// Weights of a row at offsets from the centre; returns their derivatives over the distance.
#[inline(always)]
fn weigh<const PLATEAU: bool>(
    fall_off: &FallOff,
    dx: &[f64; COLS],
    dy: &[f64; COLS],
    weight: &mut [f64; COLS],
) -> [f64; COLS] {
    let mut slopes = [0.0; COLS];
    for k in 0..COLS {
        (weight[k], slopes[k]) = fall_off.of_square::<PLATEAU>(dx[k] * dx[k] + dy[k] * dy[k]);
    }
    slopes
}

impl Primitive for Disc {
    fn support(&self) -> Area {
        self.fall_off.map_or(Area::PLANE, |fall_off| Area::around(self.centre, fall_off.radius_m()).widened())
    }

    fn bounds(&self, region: &Region) -> Bounds {
        let (weight, weight_slope) = match &self.fall_off {
            None => (Interval::ONE, 0.0),
            Some(fall_off) => fall_off.bounds(region.area.square_distances(self.centre)),
        };
        let (range, slope) = match &self.noise {
            None => (Interval::point(self.base_m), 0.0),
            Some(noise) => {
                let kappa = (region.kappa, region.kappa_slope);
                let (centre, radius) = (region.area.centre(), region.area.radius());
                if radius.is_finite() {
                    noise.bounds_near(centre[0] - self.centre[0], centre[1] - self.centre[1], radius, kappa)
                } else {
                    noise.bounds(kappa)
                }
            }
        };
        Bounds::new(range, slope, weight, weight_slope).widened()
    }

    fn at(&self, place: &Place) -> Point {
        let (x, y) = (place.at[0] - self.centre[0], place.at[1] - self.centre[1]);
        let weight = match &self.fall_off {
            None => Sample { value: 1.0, dx: 0.0, dy: 0.0 },
            Some(fall_off) => fall_off.around(x, y),
        };
        let level = Sample { value: self.base_m, dx: 0.0, dy: 0.0 };
        let elevation = self.noise.as_ref().map_or(level, |noise| noise.at(x, y, place.kappa));
        Point { elevation, weight }.settled()
    }

    fn block(&self, places: &Places, want: Want, out: &mut Block) {
        widest(
            #[inline(always)]
            || {
                if want.gradient {
                    self.fill::<true>(places, want.elevation, out);
                } else {
                    self.fill::<false>(places, want.elevation, out);
                }
            },
        );
    }

    fn misses(&self, area: &Area) -> bool {
        let nearest = area.square_distances(self.centre).min;
        self.fall_off.is_some_and(|fall_off| fall_off.at_square(nearest) <= 0.0)
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
            + self.noise.as_ref().map_or(0, |noise| size_of_val(noise.octaves()) + size_of_val(noise.filters()))
    }

    fn minds_detail(&self) -> bool {
        self.noise.as_ref().is_some_and(|noise| !noise.filters().is_empty())
    }
}
