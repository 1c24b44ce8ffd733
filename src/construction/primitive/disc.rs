//! Discs: plateaus, hills and mountains around a point.

use super::{FallOff, Primitive};
use crate::construction::area::{Area, Region};
use crate::construction::bounds::Bounds;
use crate::construction::point::{Block, Place, Places, Point, WIDTH, Want};
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
        Ok(Self { centre, base_m, noise, fall_off })
    }

    /// Weights, and elevations where wanted, of a block.
    #[inline(always)]
    fn fill<const GRADIENT: bool>(&self, places: &Places, elevation: bool, out: &mut Block) {
        let (mut xs, mut ys) = ([0.0; WIDTH], [0.0; WIDTH]);
        for k in 0..WIDTH {
            xs[k] = places.x[k] - self.centre[0];
            ys[k] = places.y[k] - self.centre[1];
        }
        match &self.fall_off {
            None => out.weight = [[1.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]],
            Some(fall_off) => {
                for k in 0..WIDTH {
                    let w = fall_off.around(xs[k], ys[k]);
                    out.weight[0][k] = w.value;
                    if GRADIENT {
                        out.weight[1][k] = w.dx;
                        out.weight[2][k] = w.dy;
                    }
                }
            }
        }
        if !elevation {
            out.elevation = [[0.0; WIDTH]; 3];
            return;
        }
        match &self.noise {
            None => out.elevation = [[self.base_m; WIDTH], [0.0; WIDTH], [0.0; WIDTH]],
            Some(noise) => {
                let kappa = [&places.kappa[0][..], &places.kappa[1], &places.kappa[2]];
                let kappa = (!noise.filters().is_empty()).then_some(kappa);
                let [value, dx, dy] = &mut out.elevation;
                noise.row::<GRADIENT>(&xs, &ys, kappa, Rows { value, dx, dy });
                for value in &mut out.elevation[0] {
                    *value += self.base_m;
                }
            }
        }
        for k in 0..WIDTH {
            out.set::<GRADIENT>(k, out.get::<GRADIENT>(k).settled());
        }
    }
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
            None => (Interval::ZERO, 0.0),
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
        Bounds::new(range.plus(Interval::point(self.base_m)), slope, weight, weight_slope).widened()
    }

    fn at(&self, place: &Place) -> Point {
        let (x, y) = (place.at[0] - self.centre[0], place.at[1] - self.centre[1]);
        let weight = match &self.fall_off {
            None => Sample { value: 1.0, dx: 0.0, dy: 0.0 },
            Some(fall_off) => fall_off.around(x, y),
        };
        let mut elevation = self.noise.as_ref().map_or(Sample::default(), |noise| noise.at(x, y, place.kappa));
        elevation.value += self.base_m;
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

    fn bytes(&self) -> usize {
        size_of::<Self>()
            + self.noise.as_ref().map_or(0, |noise| size_of_val(noise.octaves()) + size_of_val(noise.filters()))
    }

    fn minds_detail(&self) -> bool {
        self.noise.as_ref().is_some_and(|noise| !noise.filters().is_empty())
    }
}
