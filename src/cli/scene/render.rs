//! `orograph scene render`.

use super::super::progress::watched;
use super::super::report::Reporter;
use super::super::shared::{MemoryOptions, OutputOptions};
use super::super::wrong_value;
use super::{CommonOptions, DetailArguments, list};
use crate::error::{Error, Result};
use crate::pipeline::scene::render::{RenderJob, RenderReport, Station, Viewpoint, run};
use crate::plot::view::Sun;
use crate::units::parse_length_m;
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Directions of views from which nothing is said: to the north, and down.
const OBLIQUE: [f64; 2] = [0.0, -40.0];

/// Draw a scene as it is seen from somewhere, with the sun's shadows.
///
/// Without --camera it is an oblique view of all of the scene, from the south. Coordinates are those of the scene's CRS;
/// an elevation that begins with + is a height above the ground. Layers of the scene are drawn in colours that their
/// names suggest (water is blue).
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  orograph scene render fixtures/scenes/craters.json craters.png --size 640x360\n  \
                        orograph scene render fixtures/scenes/valley.json valley.png --size 640x360 --direction 30,-25"
)]
pub(super) struct Render {
    /// Scene: a JSON file.
    #[arg(value_name = "SCENE.json")]
    scene: PathBuf,
    /// Output: a PNG.
    #[arg(value_name = "OUT.png")]
    output: PathBuf,
    /// Where the camera is.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, help_heading = "View")]
    camera: Option<String>,
    /// What is in the middle of the picture.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, help_heading = "View")]
    look_at: Option<String>,
    /// The direction of the view: degrees clockwise from north, and degrees above the horizon.
    #[arg(
        long,
        value_name = "AZIMUTH,PITCH",
        value_delimiter = ',',
        num_args = 1,
        allow_hyphen_values = true,
        help_heading = "View"
    )]
    direction: Option<Vec<f64>>,
    /// Angle of view from the upper to the lower edge, in degrees, for a view with --camera.
    #[arg(long, value_name = "DEGREES", default_value_t = 40.0, help_heading = "View")]
    fov: f64,
    /// From edge to edge of a view without --camera; all of the scene unless given.
    #[arg(long, value_name = "LENGTH", conflicts_with = "camera", help_heading = "View")]
    width: Option<String>,
    /// By how much heights are shown larger.
    #[arg(long, value_name = "TIMES", default_value_t = 1.0, help_heading = "View")]
    exaggerate: f64,
    /// Size of the picture in pixels.
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1920x1080", help_heading = "Picture")]
    size: String,
    /// Rays each way through a pixel: 2 or 3 for smooth edges.
    #[arg(long, value_name = "N", default_value_t = 1, help_heading = "Picture")]
    samples: usize,
    /// Where the sun stands: degrees clockwise from north, and degrees above the horizon.
    #[arg(
        long,
        value_name = "AZIMUTH,ALTITUDE",
        value_delimiter = ',',
        num_args = 1,
        allow_hyphen_values = true,
        help_heading = "Picture"
    )]
    sun: Option<Vec<f64>>,
    /// No shadows.
    #[arg(long, help_heading = "Picture")]
    no_shadows: bool,
    /// Elevations in metres of the lowest and the highest tint; nearly those that are seen unless given.
    #[arg(
        long,
        value_name = "LOW,HIGH",
        value_delimiter = ',',
        num_args = 1,
        allow_hyphen_values = true,
        help_heading = "Picture"
    )]
    tints: Option<Vec<f64>>,
    /// Distance at which half of the light is haze.
    #[arg(long, value_name = "LENGTH", help_heading = "Picture")]
    haze: Option<String>,
    /// Colour of a layer of the scene, as RRGGBB; may be given several times.
    #[arg(long = "colour", value_name = "LAYER=RRGGBB", help_heading = "Picture")]
    colours: Vec<String>,
    #[command(flatten)]
    detail: DetailArguments,
    #[command(flatten)]
    out: OutputOptions,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    pub(super) common: CommonOptions,
}

/// Two numbers.
fn two(option: &str, numbers: &[f64]) -> Result<[f64; 2]> {
    <[f64; 2]>::try_from(numbers).ok().filter(|pair| pair.iter().all(|v| v.is_finite())).ok_or_else(|| {
        Error::usage(format!("{option} {}: expected two numbers with a comma between them", list(numbers)))
    })
}

/// A point, with an elevation or a height above the ground.
fn station(option: &str, text: &str) -> Result<Station> {
    let wrong = || Error::usage(format!("{option} {text}: expected X,Y,Z, or X,Y,+Z for a height above the ground"));
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let [x, y, z] = parts[..] else { return Err(wrong()) };
    let number = |text: &str| text.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(wrong);
    Ok(Station { at: [number(x)?, number(y)?], z_m: number(z)?, is_above_ground: z.starts_with('+') })
}

/// A colour of a layer.
fn colour(text: &str) -> Result<(String, [u8; 3])> {
    let wrong = || Error::usage(format!("--colour {text}: expected LAYER=RRGGBB, such as water=4076a0"));
    let (name, digits) = text.split_once('=').ok_or_else(wrong)?;
    let digits = digits.trim_start_matches('#');
    if digits.len() != 6 || name.is_empty() {
        return Err(wrong());
    }
    let value = u32::from_str_radix(digits, 16).map_err(|_| wrong())?;
    let [_, red, green, blue] = value.to_be_bytes();
    Ok((name.to_string(), [red, green, blue]))
}

impl Render {
    fn viewpoint(&self) -> Result<Viewpoint> {
        let target = self.look_at.as_deref().map(|text| station("--look-at", text)).transpose()?;
        let direction = self.direction.as_deref().map(|numbers| two("--direction", numbers)).transpose()?;
        let Some(camera) = &self.camera else {
            let width = self.width.as_deref().map(parse_length_m).transpose();
            let width_m = width.map_err(|error| wrong_value("--width", &error))?;
            return Ok(Viewpoint::Parallel { target, direction_deg: direction.unwrap_or(OBLIQUE), width_m });
        };
        let (eye, fov_deg) = (station("--camera", camera)?, self.fov);
        match (target, direction) {
            (Some(target), None) => Ok(Viewpoint::Towards { eye, target, fov_deg }),
            (None, Some(direction_deg)) => Ok(Viewpoint::Along { eye, direction_deg, fov_deg }),
            _ => Err(Error::usage("where does the camera look? Give --look-at X,Y,Z or --direction AZIMUTH,PITCH")),
        }
    }

    fn meant(&self) -> Result<RenderJob> {
        let sides = self.size.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
        let size = sides.filter(|&(w, h): &(usize, usize)| (1..=32_768).contains(&w) && (1..=32_768).contains(&h));
        let size = size.ok_or_else(|| {
            Error::usage(format!("--size {}: expected pixels such as 1920x1080, at most 32768 a side", self.size))
        })?;
        if !(1..=8).contains(&self.samples) {
            return Err(Error::usage(format!("--samples {}: expected 1 to 8", self.samples)));
        }
        let sun = match self.sun.as_deref() {
            None => Sun::default(),
            Some(numbers) => {
                let [azimuth_deg, altitude_deg] = two("--sun", numbers)?;
                if !(0.0..=90.0).contains(&altitude_deg) {
                    return Err(Error::usage(format!(
                        "--sun: expected 0 to 90 degrees above the horizon, found {altitude_deg}"
                    )));
                }
                Sun { azimuth_deg, altitude_deg }
            }
        };
        let haze = self.haze.as_deref().map(parse_length_m).transpose();
        let tints = self.tints.as_deref().map(|numbers| two("--tints", numbers)).transpose()?;
        Ok(RenderJob {
            scene: self.scene.clone(),
            output: self.output.clone(),
            overwrite: self.out.overwrite,
            viewpoint: self.viewpoint()?,
            size,
            samples: self.samples,
            sun,
            shadows: !self.no_shadows,
            exaggeration: self.exaggerate,
            tints_m: tints.map(|pair| pair.map(|v| v as f32)),
            haze_m: haze.map_err(|error| wrong_value("--haze", &error))?.map(|v| v as f32),
            colours: self.colours.iter().map(|text| colour(text)).collect::<Result<_>>()?,
            detail: self.detail.meant()?,
            memory: self.memory.bytes()?,
        })
    }

    pub(super) fn run(&self, reporter: &mut Reporter) -> Result<Value> {
        reporter.input(&self.scene);
        let job = self.meant()?;
        let report = watched(reporter, |watch, reporter| run(&job, watch, &mut |text| reporter.warn(text)))?;
        report.inputs.iter().for_each(|input| reporter.input(input));
        reporter.outputs(std::slice::from_ref(&job.output));
        let [read, drawn] = report.times.map(|time| time.as_secs_f64());
        reporter.remark(&format!("read {read:.3} s, drawn {drawn:.3} s"));
        reporter.say(&text(&job, &report))?;
        Ok(json(&job, &report))
    }
}

fn text(job: &RenderJob, report: &RenderReport) -> String {
    let (width, height) = job.size;
    let seconds: f64 = report.times.iter().map(|time| time.as_secs_f64()).sum();
    let rays = report.counts.rays + report.counts.shadow_rays;
    format!("{width} x {height} pixels, {rays} rays, {seconds:.1} s\n")
}

fn json(job: &RenderJob, report: &RenderReport) -> Value {
    let [read, drawn] = report.times.map(|time| time.as_secs_f64());
    let counts = &report.counts;
    json!({
        "width": job.size.0,
        "height": job.size.1,
        "rays": counts.rays,
        "shadow_rays": counts.shadow_rays,
        "evaluations": counts.evaluations,
        "samples": counts.samples,
        "bounds": counts.bounds,
        "exhausted": counts.exhausted,
        "seconds": { "read": read, "draw": drawn },
    })
}
