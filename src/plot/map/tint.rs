//! Hypsometric tints: the colour of a height, blended with its light and shadow.
//!
//! The ramp only ever gets lighter upwards (Imhof's "the higher, the lighter"), from a hazy green-grey through straw
//! and sand to near white, so that it reads the same with any colour vision and in black and white.

use super::canvas::Ink;
use super::hillshade::LEVEL;

/// Positions, 0 to 1, and colours of the ramp.
const STOPS: [(f32, [u8; 3]); 6] = [
    (0.00, [146, 168, 149]),
    (0.20, [178, 190, 157]),
    (0.42, [211, 206, 168]),
    (0.64, [228, 215, 188]),
    (0.84, [239, 232, 220]),
    (1.00, [252, 251, 249]),
];

/// Where nothing is known.
pub(super) const VOID: Ink = Ink::rgb(220, 222, 224);
/// The sea at its shore, and where it is deepest.
const SHORE: [f32; 3] = [206.0, 221.0, 229.0];
const DEEP: [f32; 3] = [160.0, 184.0, 202.0];
/// Shadows turn to this, light to that.
const SHADOW: [f32; 3] = [38.0, 42.0, 58.0];
const LIGHT: [f32; 3] = [255.0, 253.0, 245.0];

/// The ramp between two elevations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::plot) struct Ramp {
    /// Elevation of the lowest colour, in metres.
    pub(super) low_m: f32,
    /// Elevation of the highest colour, in metres.
    pub(super) high_m: f32,
    /// Elevation of the shore, in metres.
    pub(super) shore_m: f32,
    /// Depth of the darkest sea below the shore, in metres.
    pub(super) deep_m: f32,
}

impl Ramp {
    /// The ramp over the middle 98 % of the elevations on land, widened to round numbers.
    ///
    /// `cells` yields elevations in metres with the share of each that is sea; voids are left out.
    pub(in crate::plot) fn fit(cells: impl Iterator<Item = (f32, f32)>, shore_m: f32) -> Self {
        let (mut land, mut sea) = (Vec::new(), Vec::new());
        for (elevation_m, share) in cells.filter(|cell| cell.0.is_finite()) {
            if share < 0.5 { land.push(elevation_m) } else { sea.push(elevation_m) }
        }
        let deep_m = rank(&mut sea, 0.02).map_or(1.0, |m| (shore_m - m).max(1.0));
        let (Some(low), Some(high)) = (rank(&mut land, 0.01), rank(&mut land, 0.99)) else {
            return Self { low_m: 0.0, high_m: 1.0, shore_m, deep_m };
        };
        let step = round_step(f64::from(high - low) / 12.0) as f32;
        let low_m = (low / step).floor() * step;
        // On level ground high up, a step may be less than what single precision tells apart.
        let high_m = ((high / step).ceil() * step).max(low_m + step).max(low_m + low_m.abs() * 1e-5);
        Self { low_m, high_m, shore_m, deep_m }
    }

    /// The ramp with other elevations at its ends, `high_m` a little above `low_m` at least.
    pub(in crate::plot) fn between(self, low_m: f32, high_m: f32) -> Self {
        Self { low_m, high_m: high_m.max(low_m + 1e-3), ..self }
    }

    /// The colour of a height without light or shadow.
    pub(in crate::plot) fn colour(&self, elevation_m: f32) -> [f32; 3] {
        at_position(((elevation_m - self.low_m) / (self.high_m - self.low_m)).clamp(0.0, 1.0))
    }

    /// The colour of a cell of the picture: its height and brightness, its shares of sea and of the known.
    pub(super) fn shaded(&self, elevation_m: f32, brightness: f32, sea: f32, valid: f32) -> [u8; 3] {
        let void = [VOID.0[0], VOID.0[1], VOID.0[2]].map(f32::from);
        if !elevation_m.is_finite() || !brightness.is_finite() || valid <= 0.0 {
            return void.map(to_byte);
        }
        let mut colour = lit(self.colour(elevation_m), brightness, 1.0);
        if sea > 0.0 {
            let depth = ((self.shore_m - elevation_m) / self.deep_m).clamp(0.0, 1.0).sqrt();
            // The sea is a background: its floor shows, but only just.
            colour = mix(colour, lit(mix(SHORE, DEEP, depth), brightness, 0.3), sea);
        }
        mix(void, colour, valid.min(1.0)).map(to_byte)
    }
}

/// A colour of the ramp by its position, 0 to 1.
pub(super) fn at_position(position: f32) -> [f32; 3] {
    let next = STOPS.iter().position(|stop| stop.0 >= position).unwrap_or(STOPS.len() - 1).max(1);
    let (a, b) = (STOPS[next - 1], STOPS[next]);
    mix(a.1.map(f32::from), b.1.map(f32::from), (position - a.0) / (b.0 - a.0))
}

/// Darkens towards a cool shadow, lightens towards a warm white.
fn lit(colour: [f32; 3], brightness: f32, strength: f32) -> [f32; 3] {
    if brightness < LEVEL {
        let dark = (1.0 - brightness / LEVEL) * strength;
        // Multiplied rather than painted over, so that tints keep their hue in the shade.
        let shade = mix([255.0; 3], SHADOW, 0.92 * dark);
        std::array::from_fn(|i| colour[i] * shade[i] / 255.0)
    } else {
        mix(colour, LIGHT, (brightness - LEVEL) / (1.0 - LEVEL) * 0.75 * strength)
    }
}

fn mix(a: [f32; 3], b: [f32; 3], share: f32) -> [f32; 3] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share)
}

fn to_byte(value: f32) -> u8 {
    // The cast keeps to the range of a byte.
    (value + 0.5) as u8
}

/// The value below which the share `part` of the values lies.
fn rank(values: &mut [f32], part: f64) -> Option<f32> {
    let index = ((values.len() as f64 * part) as usize).min(values.len().checked_sub(1)?);
    Some(*values.select_nth_unstable_by(index, f32::total_cmp).1)
}

/// The least of 1, 2 and 5 times a power of ten that is not below `value`.
pub(super) fn round_step(value: f64) -> f64 {
    let value = if value.is_finite() { value.max(1e-6) } else { 1.0 };
    let power = 10_f64.powf(value.log10().floor());
    // A hair of slack, as 10 to the power of a logarithm is seldom exact.
    [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|&step| step >= value * (1.0 - 1e-9)).unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance(c: [f32; 3]) -> f32 {
        0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]
    }

    #[test]
    fn stops_are_met_and_get_lighter_all_the_way() {
        for (position, colour) in STOPS {
            assert_eq!(at_position(position).map(to_byte), colour);
        }
        let ladder: Vec<f32> = (0..=1000).map(|i| luminance(at_position(i as f32 / 1000.0))).collect();
        assert!(ladder.windows(2).all(|w| w[0] < w[1]), "lighter at every step");
    }

    #[test]
    fn red_and_green_blind_readers_see_the_same_order() {
        // Without the red or the green cones, lightness is left to the others: each channel must rise by itself.
        for pair in STOPS.windows(2) {
            assert!((0..3).all(|i| pair[0].1[i] <= pair[1].1[i]), "{pair:?}");
        }
    }

    #[test]
    fn fitted_to_round_numbers() {
        let ramp = Ramp::fit((0..1000).map(|i| (553.0 + i as f32 * 2.7, 0.0)), 0.0);
        assert_eq!((ramp.low_m, ramp.high_m), (500.0, 3500.0));
        for level in [0.0, 12.0, 500.0, 8848.0] {
            let flat = Ramp::fit(std::iter::repeat_n((level, 0.0), 9), 0.0);
            assert!(flat.high_m > flat.low_m && flat.colour(level).iter().all(|c| c.is_finite()), "{level}");
        }
        let nothing = Ramp::fit(std::iter::empty(), 0.0);
        assert!(nothing.high_m > nothing.low_m);
    }

    #[test]
    fn voids_are_neutral_and_the_sea_is_no_land() {
        let ramp = Ramp { low_m: 0.0, high_m: 1000.0, shore_m: 0.0, deep_m: 100.0 };
        let void = ramp.shaded(f32::NAN, 0.9, 0.0, 0.0);
        assert_eq!(void, [VOID.0[0], VOID.0[1], VOID.0[2]]);
        assert!(void.iter().max().unwrap() - void.iter().min().unwrap() <= 4, "grey");
        let sea = ramp.shaded(0.0, LEVEL, 1.0, 1.0);
        assert_eq!(sea.map(f32::from), SHORE);
        assert_eq!(ramp.shaded(1000.0, LEVEL, 0.0, 1.0), STOPS[5].1);
    }

    #[test]
    fn shadow_darkens_and_light_lightens() {
        let ramp = Ramp { low_m: 0.0, high_m: 1000.0, shore_m: 0.0, deep_m: 1.0 };
        let at = |b: f32| luminance(ramp.shaded(300.0, b, 0.0, 1.0).map(f32::from));
        assert!(at(0.0) < at(0.3) && at(0.3) < at(LEVEL) && at(LEVEL) < at(1.0));
    }

    #[test]
    fn round_steps() {
        for (value, step) in [(1.0, 1.0), (1.01, 2.0), (375.0, 500.0), (0.03, 0.05), (1000.0, 1000.0), (99.0, 100.0)] {
            assert!((round_step(value) / step - 1.0).abs() < 1e-9, "{value}: {}", round_step(value));
        }
    }
}
