//! Where pictures are taken from.

use super::ray::Ray;
use crate::construction::operator::warp::rotation;
use crate::error::{Error, Result};

/// A camera that looks at a terrain. Coordinates are metres in the terrain's own plane; z points up, y to the north.
///
/// It has no roll: what stands upright stands upright in the picture. A view straight down has its azimuth, or north,
/// at the top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// From where, and how.
    pub view: View,
    /// Factor by which the picture shows heights larger than they are; angles and distances are those of the picture.
    pub exaggeration: f64,
}

/// From where a camera looks, and how it projects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// All rays come from one point.
    Perspective {
        /// That point: x, y and elevation in metres.
        eye: [f64; 3],
        /// Where the middle of the picture looks.
        aim: Aim,
        /// Angle between the upper and the lower edge, in degrees.
        fov_deg: f64,
    },
    /// All rays are parallel: an oblique view, or a map at a pitch of -90 degrees.
    Parallel {
        /// A point in the middle of the picture: x, y and elevation in metres.
        centre: [f64; 3],
        /// Direction of the view, in degrees clockwise from north.
        azimuth_deg: f64,
        /// Degrees above the horizon; negative looks down.
        pitch_deg: f64,
        /// How much of the terrain's plane lies between the left and the right edge, in metres.
        width_m: f64,
    },
}

/// Where the middle of a picture looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// At a point: x, y and elevation in metres.
    At([f64; 3]),
    /// In a direction.
    Along {
        /// Degrees clockwise from north.
        azimuth_deg: f64,
        /// Degrees above the horizon; negative looks down.
        pitch_deg: f64,
    },
}

/// A camera with the size of its picture: it gives a ray for each place of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    origin: [f64; 3],
    forward: [f64; 3],
    /// Half of the picture's width and height, as vectors: of the plane at distance 1, or in metres.
    right: [f64; 3],
    up: [f64; 3],
    parallel: bool,
    exaggeration: f64,
    /// Half of the picture's height in pixels.
    half_height_px: f64,
    width: usize,
    height: usize,
}

/// The directions forward, right and up of a view.
fn directions(azimuth_deg: f64, pitch_deg: f64) -> [[f64; 3]; 3] {
    let (ca, sa) = rotation(azimuth_deg);
    let (cp, sp) = rotation(pitch_deg);
    [[sa * cp, ca * cp, sp], [ca, -sa, 0.0], [-sa * sp, -ca * sp, cp]]
}

fn scaled(v: [f64; 3], by: f64) -> [f64; 3] {
    v.map(|part| part * by)
}

fn length(v: [f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

impl Camera {
    /// A camera at a point that looks at another.
    pub fn towards(eye: [f64; 3], target: [f64; 3], fov_deg: f64) -> Self {
        Self { view: View::Perspective { eye, aim: Aim::At(target), fov_deg }, exaggeration: 1.0 }
    }

    /// A camera at a point that looks in a direction.
    pub fn along(eye: [f64; 3], azimuth_deg: f64, pitch_deg: f64, fov_deg: f64) -> Self {
        Self { view: View::Perspective { eye, aim: Aim::Along { azimuth_deg, pitch_deg }, fov_deg }, exaggeration: 1.0 }
    }

    /// A parallel view of so many metres from edge to edge.
    pub fn parallel(centre: [f64; 3], azimuth_deg: f64, pitch_deg: f64, width_m: f64) -> Self {
        Self { view: View::Parallel { centre, azimuth_deg, pitch_deg, width_m }, exaggeration: 1.0 }
    }

    /// The same with heights shown larger.
    #[must_use]
    pub fn exaggerated(self, exaggeration: f64) -> Self {
        Self { exaggeration, ..self }
    }

    /// The camera with a picture of so many pixels.
    ///
    /// # Errors
    /// A usage error for numbers that are not finite, an eye at its own target, angles or sizes out of range, or no
    /// pixels.
    pub fn lens(&self, width: usize, height: usize) -> Result<Lens> {
        let exaggeration = self.exaggeration;
        if !(exaggeration > 0.0 && exaggeration.is_finite()) {
            return Err(Error::usage(format!("heights are exaggerated by a number above 0, not by {exaggeration}")));
        }
        if width == 0 || height == 0 {
            return Err(Error::usage("a picture has at least one pixel"));
        }
        let pitched = |azimuth_deg: f64, pitch_deg: f64| {
            if !azimuth_deg.is_finite() || !(-90.0..=90.0).contains(&pitch_deg) {
                return Err(Error::usage(format!(
                    "a view has an azimuth, and a pitch from -90 to 90 degrees: found {azimuth_deg} and {pitch_deg}"
                )));
            }
            Ok(directions(azimuth_deg, pitch_deg))
        };
        let finite = |point: [f64; 3]| {
            if point.iter().all(|part| part.is_finite()) {
                Ok(point)
            } else {
                Err(Error::usage(format!("a camera needs finite coordinates, found {point:?}")))
            }
        };
        let aspect = width as f64 / height as f64;
        let ([forward, right, up], origin, half_m, parallel) = match self.view {
            View::Perspective { eye, aim, fov_deg } => {
                let eye = finite(eye)?;
                if !(fov_deg > 0.0 && fov_deg < 180.0) {
                    return Err(Error::usage(format!(
                        "a field of view lies between 0 and 180 degrees, found {fov_deg}"
                    )));
                }
                let axes = match aim {
                    Aim::Along { azimuth_deg, pitch_deg } => pitched(azimuth_deg, pitch_deg)?,
                    Aim::At(target) => towards(eye, finite(target)?, exaggeration)?,
                };
                let (cosine, sine) = rotation(fov_deg / 2.0);
                (axes, eye, [sine / cosine * aspect, sine / cosine], false)
            }
            View::Parallel { centre, azimuth_deg, pitch_deg, width_m } => {
                if !(width_m > 0.0 && width_m.is_finite()) {
                    return Err(Error::usage(format!("a parallel view is wider than 0 m, found {width_m}")));
                }
                let half = width_m / 2.0;
                (pitched(azimuth_deg, pitch_deg)?, finite(centre)?, [half, half / aspect], true)
            }
        };
        Ok(Lens {
            origin,
            forward,
            right: scaled(right, half_m[0]),
            up: scaled(up, half_m[1]),
            parallel,
            exaggeration,
            half_height_px: height as f64 / 2.0,
            width,
            height,
        })
    }
}

/// The directions of a view from a point to another, in the picture's own heights.
fn towards(eye: [f64; 3], target: [f64; 3], exaggeration: f64) -> Result<[[f64; 3]; 3]> {
    let way = [target[0] - eye[0], target[1] - eye[1], (target[2] - eye[2]) * exaggeration];
    let far = length(way);
    if !(far > 0.0 && far.is_finite()) {
        return Err(Error::usage("the eye and what it looks at are one point"));
    }
    let level = (way[0] * way[0] + way[1] * way[1]).sqrt();
    let (sa, ca) = if level > 0.0 { (way[0] / level, way[1] / level) } else { (0.0, 1.0) };
    let (sp, cp) = (way[2] / far, level / far);
    Ok([[sa * cp, ca * cp, sp], [ca, -sa, 0.0], [-sa * sp, -ca * sp, cp]])
}

impl Lens {
    /// Pixels from left to right, and from top to bottom.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The eye, or `None` where rays are parallel.
    pub fn eye(&self) -> Option<[f64; 3]> {
        (!self.parallel).then_some(self.origin)
    }

    /// The point in the middle of a parallel view, or the eye.
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Factor by which heights are shown larger than they are.
    pub fn exaggeration(&self) -> f64 {
        self.exaggeration
    }

    /// The ray through a place of the picture, counted in pixels from its upper left corner.
    pub fn ray(&self, col_px: f64, row_px: f64) -> Ray {
        let (origin, way) = self.way(col_px, row_px);
        let long = self.stretch(col_px, row_px);
        let ([footprint_m, growth], from_m) = (self.pixel(), if self.parallel { f64::NEG_INFINITY } else { 0.0 });
        Ray { origin, direction: way.map(|part| part / long), footprint_m, growth: growth / long, from_m }
    }

    /// Where the way through a place of the picture begins, and what it moves per unit of depth.
    pub(super) fn way(&self, col_px: f64, row_px: f64) -> ([f64; 3], [f64; 3]) {
        let offset = self.offset(col_px, row_px);
        let flat = |v: [f64; 3]| [v[0], v[1], v[2] / self.exaggeration];
        if self.parallel {
            let raised = flat(offset);
            (std::array::from_fn(|i| self.origin[i] + raised[i]), flat(self.forward))
        } else {
            (self.origin, flat(std::array::from_fn(|i| self.forward[i] + offset[i])))
        }
    }

    /// Metres of a ray's way per unit of depth.
    pub(super) fn stretch(&self, col_px: f64, row_px: f64) -> f64 {
        let offset = self.offset(col_px, row_px);
        if self.parallel { 1.0 } else { length(std::array::from_fn(|i| self.forward[i] + offset[i])) }
    }

    /// A pixel's width at depth 0, and its growth per unit of depth.
    pub(super) fn pixel(&self) -> [f64; 2] {
        let pixel = length(self.up) / self.half_height_px;
        if self.parallel { [pixel, 0.0] } else { [0.0, pixel] }
    }

    /// From the middle of the picture to a place of it.
    fn offset(&self, col_px: f64, row_px: f64) -> [f64; 3] {
        let (u, v) = (2.0 * col_px / self.width as f64 - 1.0, 1.0 - 2.0 * row_px / self.height as f64);
        std::array::from_fn(|i| u * self.right[i] + v * self.up[i])
    }
}
