//! The job behind `orograph scene render`: a picture of a scene.

use super::super::view::{self, Layer, Picture, RenderOptions};
use super::places::nothing;
use super::read::{DetailOption, SceneFile};
use crate::construction::Tree;
use crate::construction::trace::{Camera, Counts};
use crate::error::{Error, ErrorKind, Result};
use crate::io::output::Output;
use crate::plot::view::Sun;
use crate::watch::Watch;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// A point of which the elevation may be said as a height above the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// Place in the scene's CRS.
    pub at: [f64; 2],
    /// Elevation, or height above the ground, in metres.
    pub z_m: f64,
    /// Whether it is a height above the ground.
    pub is_above_ground: bool,
}

/// From where a scene is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Viewpoint {
    /// From a point to another.
    Towards {
        /// Where the camera is.
        eye: Station,
        /// What is in the middle of the picture.
        target: Station,
        /// Angle between the upper and the lower edge, in degrees.
        fov_deg: f64,
    },
    /// From a point in a direction.
    Along {
        /// Where the camera is.
        eye: Station,
        /// Degrees clockwise from north, and above the horizon.
        direction_deg: [f64; 2],
        /// Angle between the upper and the lower edge, in degrees.
        fov_deg: f64,
    },
    /// In parallel: an oblique view, or a map from above.
    Parallel {
        /// What is in the middle of the picture; the middle of the scene unless given.
        target: Option<Station>,
        /// Degrees clockwise from north, and above the horizon.
        direction_deg: [f64; 2],
        /// From edge to edge, in metres; all of the scene unless given.
        width_m: Option<f64>,
    },
}

/// What to do.
#[derive(Clone, Debug)]
pub struct RenderJob {
    /// The scene.
    pub scene: PathBuf,
    /// Where to write the PNG.
    pub output: PathBuf,
    /// Whether an existing output may be replaced.
    pub overwrite: bool,
    /// From where.
    pub viewpoint: Viewpoint,
    /// Pixels from left to right and from top to bottom.
    pub size: (usize, usize),
    /// Rays each way through a pixel.
    pub samples: usize,
    /// Where the sun stands.
    pub sun: Sun,
    /// Whether the terrain throws shadows.
    pub shadows: bool,
    /// By how much heights are shown larger.
    pub exaggeration: f64,
    /// Elevations of the lowest and the highest tint in metres.
    pub tints_m: Option<[f32; 2]>,
    /// Distance in metres at which half of the light is haze.
    pub haze_m: Option<f32>,
    /// Colours of layers by name; others have those that their names suggest.
    pub colours: Vec<(String, [u8; 3])>,
    /// Where the level of detail comes from, if not from the scene.
    pub detail: Option<DetailOption>,
    /// Bytes of memory that may be used; what is free unless given.
    pub memory: Option<u64>,
}

/// What was done.
#[derive(Clone, Debug)]
pub struct RenderReport {
    /// The files that the scene names.
    pub inputs: Vec<PathBuf>,
    /// What it took.
    pub counts: Counts,
    /// How long reading, and tracing and drawing took.
    pub times: [Duration; 2],
}

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the scene, its files, the output or the options; then no file has changed.
pub fn run(job: &RenderJob, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<RenderReport> {
    let begun = Instant::now();
    if job.output.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("png")) {
        return Err(Error::usage("the output is a picture: name it .png").at_path(&job.output));
    }
    let output = Output::begin(&job.output, job.overwrite)?;
    let file = SceneFile::open(&job.scene, job.memory, watch)?;
    file.notes.iter().for_each(|note| warn(note));
    let ground = file.tree(None, job.detail)?;
    let mut trees: Vec<(Tree, Option<[u8; 3]>)> = vec![];
    for (name, _) in &file.scene.layers {
        let given = job.colours.iter().find(|(known, _)| known == name).map(|(_, colour)| *colour);
        trees.push((file.tree(Some(name), job.detail)?, Some(given.unwrap_or_else(|| colour_of(name)))));
    }
    if let Some((name, _)) =
        job.colours.iter().find(|(name, _)| !file.scene.layers.iter().any(|(known, _)| known == name))
    {
        return Err(Error::usage(format!("--colour {name}: the scene has no such layer")).at_path(&job.scene));
    }
    let camera = camera(job, &file, &ground)?;
    let mut layers = vec![Layer { tree: &ground, colour: None }];
    layers.extend(trees.iter().map(|(tree, colour)| Layer { tree, colour: *colour }));
    let options = RenderOptions {
        width: job.size.0,
        height: job.size.1,
        samples: job.samples,
        sun: job.sun,
        shadows: job.shadows,
        tints_m: job.tints_m,
        haze_m: job.haze_m,
        ..RenderOptions::new(camera.exaggerated(job.exaggeration))
    };
    let read = begun.elapsed();

    let begun = Instant::now();
    let Picture { png, counts } = view::render(&layers, &options, watch)?;
    if counts.exhausted > 0 {
        warn(&format!("{} rays gave up before they met the ground; their pixels may be wrong", counts.exhausted));
    }
    std::fs::write(output.path(), png).map_err(|error| {
        let message = format!("the picture cannot be written ({error}); is there room left?");
        Error::new(ErrorKind::Output, message).at_path(output.target())
    })?;
    output.finish()?;
    Ok(RenderReport { inputs: file.inputs, counts, times: [read, begun.elapsed()] })
}

/// The colour that a layer's name suggests.
fn colour_of(name: &str) -> [u8; 3] {
    match name.to_ascii_lowercase().as_str() {
        "water" | "river" | "rivers" | "lake" | "lakes" | "sea" => [64, 118, 160],
        "sand" | "dunes" => [222, 196, 148],
        "snow" | "ice" | "glacier" => [240, 244, 248],
        "road" | "roads" => [120, 112, 106],
        "forest" | "vegetation" => [88, 116, 72],
        _ => [168, 120, 96],
    }
}

/// The camera in the scene's own coordinates.
fn camera(job: &RenderJob, file: &SceneFile, ground: &Tree) -> Result<Camera> {
    let [ox, oy] = file.scene.origin;
    let station = |what: &str, station: &Station| -> Result<[f64; 3]> {
        let at = [station.at[0] - ox, station.at[1] - oy];
        let under = if station.is_above_ground {
            let missing = || {
                let [x, y] = station.at;
                Error::usage(format!("{what} {x},{y},+{}: there is no ground below; give an elevation", station.z_m))
            };
            ground.elevation_m(at).ok_or_else(missing)?
        } else {
            0.0
        };
        Ok([at[0], at[1], under + station.z_m])
    };
    Ok(match &job.viewpoint {
        Viewpoint::Towards { eye, target, fov_deg } => {
            Camera::towards(station("--camera", eye)?, station("--look-at", target)?, *fov_deg)
        }
        Viewpoint::Along { eye, direction_deg: [azimuth, pitch], fov_deg } => {
            Camera::along(station("--camera", eye)?, *azimuth, *pitch, *fov_deg)
        }
        Viewpoint::Parallel { target, direction_deg: [azimuth, pitch], width_m } => {
            let support = ground.support();
            let ends = [support.x.min, support.x.max, support.y.min, support.y.max];
            if support.is_empty() {
                return Err(nothing(file));
            }
            if (target.is_none() || width_m.is_none()) && !ends.iter().all(|v| v.is_finite()) {
                let message =
                    "the scene is endless: say what is to be seen of it, with --camera, or --look-at and --width";
                return Err(Error::usage(message).at_path(&job.scene));
            }
            let centre = match target {
                Some(target) => station("--look-at", target)?,
                None => {
                    let at = support.centre();
                    let bounds = ground.bounds(&support).elevation;
                    let middle = if bounds.width().is_finite() { (bounds.min + bounds.max) / 2.0 } else { 0.0 };
                    [at[0], at[1], ground.elevation_m(at).unwrap_or(middle)]
                }
            };
            let width_m = width_m.unwrap_or_else(|| {
                // All of it, whichever way it is turned.
                let (wide, high) = (support.x.width(), support.y.width());
                let turned = azimuth.to_radians();
                let across = (wide * turned.cos()).abs() + (high * turned.sin()).abs();
                let along = (wide * turned.sin()).abs() + (high * turned.cos()).abs();
                let tall = along * pitch.to_radians().sin().abs() * job.size.0 as f64 / job.size.1.max(1) as f64;
                1.04 * across.max(tall)
            });
            Camera::parallel(centre, *azimuth, *pitch, width_m)
        }
    })
}
