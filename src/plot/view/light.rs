//! Sun, sky and haze.

/// Where the sun stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Degrees clockwise from north.
    pub azimuth_deg: f64,
    /// Degrees above the horizon.
    pub altitude_deg: f64,
}

impl Sun {
    /// The direction towards the sun: east, north, up; of length 1.
    pub fn direction(&self) -> [f64; 3] {
        let (azimuth, altitude) = (self.azimuth_deg.to_radians(), self.altitude_deg.to_radians());
        [azimuth.sin() * altitude.cos(), azimuth.cos() * altitude.cos(), altitude.sin()]
    }
}

/// Low in the north-west, as cartographers have it.
impl Default for Sun {
    fn default() -> Self {
        Self { azimuth_deg: 315.0, altitude_deg: 35.0 }
    }
}

/// What the sun gives to a surface that faces it: red, green, blue, as shares of the surface's own colour.
const SUNLIGHT: [f32; 3] = [0.86, 0.80, 0.70];
/// What the whole sky gives to level ground.
const SKYLIGHT: [f32; 3] = [0.30, 0.34, 0.42];
/// The sky at the horizon, which is the colour of haze too, and overhead.
const HORIZON: [f32; 3] = [214.0, 224.0, 232.0];
const ZENITH: [f32; 3] = [104.0, 148.0, 196.0];

/// The colour of ground that rises `slope` metres a metre eastwards and northwards, of `colour` by itself; `sunlit` is
/// how much of the sun it sees, 0 to 1.
pub(super) fn lit(colour: [f32; 3], slope: [f32; 2], sun: [f32; 3], sunlit: f32) -> [f32; 3] {
    let length = (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
    let normal = [-slope[0] / length, -slope[1] / length, 1.0 / length];
    let facing = (0..3).map(|i| normal[i] * sun[i]).sum::<f32>().max(0.0) * sunlit;
    // A slope sees that part of the sky that its own plane does not hide.
    let sky = 0.5 + 0.5 * normal[2];
    std::array::from_fn(|i| colour[i] * (SUNLIGHT[i] * facing + SKYLIGHT[i] * sky) * GAIN)
}

/// Brings level ground under the default sun close to its own colour.
const GAIN: f32 = 1.25;

/// The sky in a direction whose sine of elevation is `rise`.
pub(super) fn sky(rise: f32) -> [f32; 3] {
    // Quickly bluer above the horizon, then slowly.
    let part = rise.clamp(0.0, 1.0).sqrt();
    mix(HORIZON, ZENITH, part)
}

/// A colour seen through the air; at `haze_m` metres half of it is haze.
pub(super) fn hazed(colour: [f32; 3], distance_m: f32, haze_m: f32) -> [f32; 3] {
    let part = distance_m / haze_m;
    // No exponential: this is the same to the bit wherever square roots are.
    mix(colour, HORIZON, part * part / (1.0 + part * part))
}

pub(super) fn mix(a: [f32; 3], b: [f32; 3], share: f32) -> [f32; 3] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share)
}
