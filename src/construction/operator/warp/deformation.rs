//! Smooth deformations, given by their inverses.

use super::{Matrix, rotation};
use crate::construction::area::Area;
use crate::construction::primitive::FallOff;
use crate::error::{Error, Result};
use crate::interval::Interval;
use crate::noise::{NoiseKind, NoiseSum, Sample, Spectrum};

/// A bijection of the plane that bends what is in it; the way into the child's frame is in closed form.
#[derive(Clone, Debug, PartialEq)]
pub struct Deformation(Kind);

/// The kinds.
#[derive(Clone, Debug, PartialEq)]
enum Kind {
    /// `q = p + (n_x(p), n_y(p))`.
    Noise([NoiseSum; 2]),
    /// `q = p - g(|p - c|) v`.
    Drag { centre: [f64; 2], by: [f64; 2], fall_off: FallOff },
    /// `q - c` is `p - c` turned by the angle whose half has the tangent `g(|p - c|) h`.
    Twist { centre: [f64; 2], half_tangent: f64, fall_off: FallOff },
}

/// Greatest `|x g'(x)|` of the fall-off with radius 1: 8 / 9, at x² = 1 / 3.
const TWIST: f64 = 0.888_888_9;

impl Deformation {
    /// Moves every point by noise, independently along x and y: edges and ridges become irregular.
    ///
    /// `spectrum.amplitude` is in metres.
    ///
    /// # Errors
    /// A usage error if the plane could fold: the slope of the displacement must stay below 1.
    pub fn noise(spectrum: Spectrum) -> Result<Self> {
        let sum = |seed: u64| NoiseSum::new(NoiseKind::Fractal, Spectrum { seed, ..spectrum }.terms());
        let pair = [sum(spectrum.seed), sum(!spectrum.seed)];
        let slope = bend(&pair, None);
        let safe = slope < 1.0;
        if !safe {
            return Err(Error::usage(format!(
                "singular warp: the plane could fold, for the displacement changes by up to {slope:.2} m a metre; make the amplitude smaller or the wavelength larger (below 1 is safe)"
            )));
        }
        Ok(Self(Kind::Noise(pair)))
    }

    /// Drags what is at `centre` by so many metres along x and y; nothing moves beyond `radius_m`.
    ///
    /// # Errors
    /// A usage error if the plane could fold: the radius must be 1.72 times the way at least.
    pub fn drag(centre: [f64; 2], by: [f64; 2], radius_m: f64) -> Result<Self> {
        let fall_off = FallOff::new(0.0, radius_m)?;
        let slope = length(by) * fall_off.slope();
        let safe = slope < 1.0 && centre[0].is_finite() && centre[1].is_finite();
        if !safe {
            return Err(Error::usage(format!(
                "singular warp: dragging by {:.3} m folds the plane unless the radius is more than {:.3} m, found {radius_m} m",
                length(by),
                length(by) * 1.7174
            )));
        }
        Ok(Self(Kind::Drag { centre, by, fall_off }))
    }

    /// Turns what is at `centre` by `degrees` to the left, less further out, nothing beyond `radius_m`.
    ///
    /// # Errors
    /// A usage error unless the angle lies between -180 and 180 degrees.
    pub fn twist(centre: [f64; 2], degrees: f64, radius_m: f64) -> Result<Self> {
        let fall_off = FallOff::new(0.0, radius_m)?;
        let (cosine, sine) = rotation(degrees);
        let half_tangent = sine / (1.0 + cosine);
        let finite = centre[0].is_finite() && centre[1].is_finite() && half_tangent.is_finite();
        if !(degrees.abs() < 180.0 && finite) {
            return Err(Error::usage(format!(
                "singular warp: a twist needs an angle between -180 and 180 degrees, found {degrees}"
            )));
        }
        Ok(Self(Kind::Twist { centre, half_tangent, fall_off }))
    }

    /// The point in the child's frame, and the Jacobian of the way there.
    #[inline(always)]
    pub(super) fn enter(&self, [x, y]: [f64; 2]) -> ([f64; 2], Matrix) {
        match &self.0 {
            Kind::Noise([along_x, along_y]) => {
                let (a, b) = (along_x.at(x, y, Sample::default()), along_y.at(x, y, Sample::default()));
                ([x + a.value, y + b.value], [[1.0 + a.dx, a.dy], [b.dx, 1.0 + b.dy]])
            }
            Kind::Drag { centre, by, fall_off } => {
                let g = fall_off.around(x - centre[0], y - centre[1]);
                (
                    [x - by[0] * g.value, y - by[1] * g.value],
                    [[1.0 - by[0] * g.dx, -by[0] * g.dy], [-by[1] * g.dx, 1.0 - by[1] * g.dy]],
                )
            }
            Kind::Twist { centre, half_tangent, fall_off } => {
                let (dx, dy) = (x - centre[0], y - centre[1]);
                let g = fall_off.around(dx, dy);
                let h = half_tangent * g.value;
                let per = 1.0 / (1.0 + h * h);
                let (c, s) = ((1.0 - h * h) * per, 2.0 * h * per);
                let turn = 2.0 * half_tangent * per;
                let (tx, ty) = (turn * g.dx, turn * g.dy);
                // Derivative of the turned offset by the angle.
                let (ax, ay) = (c * dy - s * dx, -c * dx - s * dy);
                (
                    [centre[0] + (c * dx + s * dy), centre[1] + (c * dy - s * dx)],
                    [[c + ax * tx, s + ax * ty], [ay * tx - s, c + ay * ty]],
                )
            }
        }
    }

    /// Where nothing is moved: beyond the radius.
    fn still(&self, area: &Area) -> bool {
        match &self.0 {
            Kind::Noise(_) => false,
            Kind::Drag { centre, fall_off, .. } | Kind::Twist { centre, fall_off, .. } => {
                area.square_distances(*centre).min >= fall_off.radius_m() * fall_off.radius_m() * (1.0 + 1e-12)
            }
        }
    }

    pub(super) fn image(&self, area: &Area) -> Area {
        if self.still(area) {
            return *area;
        }
        match &self.0 {
            Kind::Noise(pair) => {
                let (centre, radius) = (area.centre(), area.radius());
                let range = |sum: &NoiseSum| {
                    if radius.is_finite() {
                        sum.bounds_near(centre[0], centre[1], radius, NO_DETAIL).0
                    } else {
                        sum.bounds(NO_DETAIL).0
                    }
                };
                Area { x: area.x.plus(range(&pair[0])), y: area.y.plus(range(&pair[1])) }
            }
            Kind::Drag { centre, by, fall_off } => {
                let share = fall_off.bounds(area.square_distances(*centre)).0;
                Area { x: area.x.minus(share.scaled(by[0])), y: area.y.minus(share.scaled(by[1])) }
            }
            // Points of the disc stay in it, the others where they are.
            Kind::Twist { centre, fall_off, .. } => area.hull(&Area::around(*centre, fall_off.radius_m())),
        }
    }

    pub(super) fn support(&self, child: &Area) -> Area {
        if child.is_empty() || self.still(child) {
            return *child;
        }
        match &self.0 {
            Kind::Noise(pair) => {
                let range = |sum: &NoiseSum| sum.bounds(NO_DETAIL).0;
                Area { x: child.x.minus(range(&pair[0])), y: child.y.minus(range(&pair[1])) }
            }
            Kind::Drag { by, .. } => {
                let way = |by: f64| Interval::new(0.0, by);
                Area { x: child.x.plus(way(by[0])), y: child.y.plus(way(by[1])) }
            }
            Kind::Twist { centre, fall_off, .. } => child.hull(&Area::around(*centre, fall_off.radius_m())),
        }
    }

    /// Bounds of the norms of the Jacobian, `1 + e` with e that of its difference from the unit matrix, and of its
    /// inverse, `1 / (1 - e)`. A twist's inverse is a twist.
    pub(super) fn stretches(&self, area: &Area) -> (f64, f64) {
        if self.still(area) {
            return (1.0, 1.0);
        }
        let e = match &self.0 {
            Kind::Noise(pair) => bend(pair, Some(area)),
            Kind::Drag { centre, by, fall_off } => length(*by) * fall_off.bounds(area.square_distances(*centre)).1,
            Kind::Twist { half_tangent, .. } => {
                // r |grad angle| <= 2 |h| r |g'|.
                let stretch = 1.0 + 2.0 * half_tangent.abs() * TWIST;
                return (stretch, stretch);
            }
        };
        (1.0 + e, 1.0 / (1.0 - e))
    }
}

/// Noise that no level of detail sways.
const NO_DETAIL: (Interval, f64) = (Interval::ONE, 0.0);

/// Bound of the norm of the Jacobian of a displacement by noise.
fn bend(pair: &[NoiseSum; 2], area: Option<&Area>) -> f64 {
    let slope = |sum: &NoiseSum| match area {
        Some(area) if area.radius().is_finite() => {
            let centre = area.centre();
            sum.bounds_near(centre[0], centre[1], area.radius(), NO_DETAIL).1
        }
        _ => sum.bounds(NO_DETAIL).1,
    };
    length([slope(&pair[0]), slope(&pair[1])])
}

/// Length of a vector.
fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}
