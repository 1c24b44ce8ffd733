//! From what is seen to pixels.

use super::super::map::tint::Ramp;
use super::super::png;
use super::light::{Sun, hazed, lit, sky};
use crate::error::{Error, ErrorKind, Result};
use rayon::prelude::*;

/// What is seen in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sight {
    /// The sky, in a direction whose sine of elevation is this.
    Sky(f32),
    /// The ground.
    Ground {
        /// Its elevation in metres.
        elevation_m: f32,
        /// How much it rises eastwards and northwards, in metres a metre.
        slope: [f32; 2],
        /// How far it is from the eye, in metres; 0 where there is no eye, as in parallel views.
        distance_m: f32,
        /// How much of the sun it sees, 0 to 1.
        sunlit: f32,
        /// The colour of what lies on it; the tint of its elevation without one.
        colour: Option<[u8; 3]>,
    },
}

/// How to draw.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewOptions {
    /// Where the sun stands.
    pub sun: Sun,
    /// Elevations of the lowest and the highest tint in metres; the middle 98 % of what is seen unless given.
    pub tints_m: Option<[f32; 2]>,
    /// Distance in metres at which half of the light is haze; none without.
    pub haze_m: Option<f32>,
}

/// Draws `width` x `height` pixels. `sights` are row-major from the upper left, `samples` x `samples` for each pixel,
/// whose colours are averaged: a row of sights is `width * samples` long.
///
/// # Errors
/// `Usage` when there are no pixels or not as many sights as they need.
pub fn draw(width: usize, height: usize, samples: usize, sights: &[Sight], options: &ViewOptions) -> Result<Vec<u8>> {
    let needed = width.checked_mul(height).and_then(|n| n.checked_mul(samples)).and_then(|n| n.checked_mul(samples));
    let (Ok(width_px), Ok(height_px)) = (u32::try_from(width), u32::try_from(height)) else {
        return Err(too_large(width, height));
    };
    if needed != Some(sights.len()) || sights.is_empty() {
        let found = sights.len();
        return Err(Error::new(
            ErrorKind::Usage,
            format!("{found} sights for {width} x {height} pixels of {samples} x {samples} samples each"),
        ));
    }
    let ramp = ramp_of(sights, options.tints_m);
    let sun = options.sun.direction().map(|part| part as f32);
    let haze_m = options.haze_m.filter(|haze| *haze > 0.0);
    let across = width * samples;
    let share = 1.0 / (samples * samples) as f32;
    let mut pixels = vec![0_u8; width * height * 3];
    pixels.par_chunks_mut(width * 3).enumerate().for_each(|(row, line)| {
        for (col, pixel) in line.chunks_exact_mut(3).enumerate() {
            let mut sum = [0.0_f32; 3];
            for line in 0..samples {
                let first = (row * samples + line) * across + col * samples;
                for sight in &sights[first..first + samples] {
                    let colour = colour_of(sight, &ramp, sun, haze_m);
                    (0..3).for_each(|i| sum[i] += colour[i].clamp(0.0, 255.0));
                }
            }
            // The cast keeps to the range of a byte.
            pixel.copy_from_slice(&sum.map(|part| (part * share + 0.5) as u8));
        }
    });
    png::encode(width_px, height_px, &pixels)
}

fn too_large(width: usize, height: usize) -> Error {
    Error::new(ErrorKind::Usage, format!("a picture of {width} x {height} pixels is too large"))
}

fn ramp_of(sights: &[Sight], tints_m: Option<[f32; 2]>) -> Ramp {
    // A sample is enough, and a regular one is the same on every run.
    let stride = (sights.len() / 200_000).max(1);
    let seen = sights.iter().step_by(stride).filter_map(|sight| match sight {
        Sight::Ground { elevation_m, colour: None, .. } => Some((*elevation_m, 0.0)),
        _ => None,
    });
    let ramp = Ramp::fit(seen, f32::NEG_INFINITY);
    tints_m.map_or(ramp, |[low_m, high_m]| ramp.between(low_m, high_m))
}

fn colour_of(sight: &Sight, ramp: &Ramp, sun: [f32; 3], haze_m: Option<f32>) -> [f32; 3] {
    match *sight {
        Sight::Sky(rise) => sky(rise),
        Sight::Ground { elevation_m, slope, distance_m, sunlit, colour } => {
            let own = colour.map_or_else(|| ramp.colour(elevation_m), |colour| colour.map(f32::from));
            let colour = lit(own, slope, sun, sunlit);
            haze_m.map_or(colour, |haze_m| hazed(colour, distance_m, haze_m))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tiny_skia::Pixmap;

    fn ground(slope: [f32; 2], sunlit: f32, distance_m: f32) -> Sight {
        Sight::Ground { elevation_m: 500.0, slope, distance_m, sunlit, colour: None }
    }

    /// Brightness of one pixel.
    fn brightness(sights: &[Sight], samples: usize, options: &ViewOptions) -> u32 {
        let picture = Pixmap::decode_png(&draw(1, 1, samples, sights, options).unwrap()).unwrap();
        let pixel = picture.pixel(0, 0).unwrap();
        u32::from(pixel.red()) + u32::from(pixel.green()) + u32::from(pixel.blue())
    }

    #[test]
    fn slopes_towards_the_sun_are_bright_and_shadows_dark() {
        let options = ViewOptions { tints_m: Some([0.0, 1000.0]), ..ViewOptions::default() };
        let at = |slope, sunlit| brightness(&[ground(slope, sunlit, 0.0)], 1, &options);
        // The sun is in the north-west: ground that falls that way, rises eastwards and southwards.
        assert!(at([0.4, -0.4], 1.0) > at([0.0, 0.0], 1.0));
        assert!(at([-0.4, 0.4], 1.0) < at([0.0, 0.0], 1.0));
        assert!(at([0.0, 0.0], 0.0) < at([0.0, 0.0], 0.5));
        assert!(at([0.0, 0.0], 0.0) > 0, "the sky lights shadows");
    }

    #[test]
    fn far_ground_fades_into_the_horizon() {
        let options = ViewOptions { haze_m: Some(10_000.0), tints_m: Some([0.0, 1000.0]), ..ViewOptions::default() };
        let horizon = brightness(&[Sight::Sky(0.0)], 1, &options);
        let at = |distance| brightness(&[ground([-0.5, 0.5], 0.0, distance)], 1, &options).abs_diff(horizon);
        assert!(at(0.0) > at(10_000.0) && at(10_000.0) > at(100_000.0));
        assert!(at(1e9) <= 3, "{}", at(1e9));
    }

    #[test]
    fn samples_of_a_pixel_are_averaged() {
        let options = ViewOptions::default();
        let (sky, shade) = (Sight::Sky(1.0), ground([0.0, 0.0], 0.0, 0.0));
        let both = brightness(&[sky, shade, shade, sky], 2, &options);
        let mean = (brightness(&[sky], 1, &options) + brightness(&[shade], 1, &options)) / 2;
        assert!(both.abs_diff(mean) <= 3, "{both} {mean}");
    }

    #[test]
    fn sights_that_do_not_fill_the_picture_are_refused() {
        let sights = [Sight::Sky(0.0); 5];
        assert!(draw(2, 3, 1, &sights, &ViewOptions::default()).is_err());
        assert!(draw(0, 3, 1, &[], &ViewOptions::default()).is_err());
    }

    #[test]
    fn the_suns_direction() {
        let close = |a: [f64; 3], b: [f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-12);
        assert!(close(Sun { azimuth_deg: 90.0, altitude_deg: 0.0 }.direction(), [1.0, 0.0, 0.0]));
        assert!(close(Sun { azimuth_deg: 0.0, altitude_deg: 90.0 }.direction(), [0.0, 0.0, 1.0]));
    }
}
