//! Atoms that are functions: a window of noise, known everywhere.

use super::atoms::{Dictionary, Origin};
use super::shape::PatchShape;
use crate::error::{Error, Result};
use crate::interval::Interval;
use crate::noise::{NoiseKind, NoiseSum, Sample, Spectrum};
use crate::rng::Rng;
use rayon::prelude::*;

/// Longest and shortest wavelength of the first octave, in radii of the disc.
const WAVELENGTHS: (f64, f64) = (4.0, 0.75);
/// Most octaves; finer ones would be narrower than a cell of patches of usual sides.
const OCTAVES: u64 = 4;
/// Windows are cut anywhere in a square of this many radii.
const EXTENT: f64 = 4096.0;

/// Families of noise (paper 001, section 5.2). The sign of an atom is free, so ridges and valleys are one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NoiseFamily {
    /// Sums of gradient noise: rounded hills.
    Perlin,
    /// Sums of its absolute values: every octave has creases.
    Ridged,
    /// Ridged multifractal (Musgrave): fine creases on the coarse ones alone.
    RidgedMultifractal,
}

/// A window of noise, shifted and scaled to an atom.
///
/// Positions are counted in radii of the disc from its centre, so the atom can be sampled at any resolution; the
/// samples of a dictionary are its values at the cells' centres.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseAtom {
    family: NoiseFamily,
    spectrum: Spectrum,
    centre: [f64; 2],
    mean: f64,
    scale: f64,
    sum: NoiseSum,
}

impl NoiseAtom {
    /// The window of a family that a seed draws, as an atom for patches of a shape, and its samples.
    ///
    /// `None` where the noise is constant there.
    pub fn draw(family: NoiseFamily, shape: &PatchShape, seed: u64) -> Option<(Self, Vec<f32>)> {
        let mut rng = Rng::new(seed);
        let octaves = 1 + rng.below(OCTAVES) as usize;
        let wavelength = rng.between(WAVELENGTHS.1, WAVELENGTHS.0);
        let spectrum =
            Spectrum { octaves, amplitude: 1.0, wavelength, persistence: 0.5, lacunarity: 2.0, seed: rng.next_u64() };
        let centre = [rng.between(0.0, EXTENT), rng.between(0.0, EXTENT)];
        let kind = match family {
            NoiseFamily::Perlin => NoiseKind::Fractal,
            NoiseFamily::Ridged => NoiseKind::Turbulence,
            NoiseFamily::RidgedMultifractal => NoiseKind::Ridged { offset: 1.0, gain: 2.0 },
        };
        let sum = NoiseSum::new(kind, spectrum.terms());
        let mut atom = Self { family, spectrum, centre, mean: 0.0, scale: 1.0, sum };
        let side = shape.side();
        let at = |i: usize| (i as f64 + 0.5) / shape.radius_cells() - 1.0;
        let mut samples: Vec<f64> = (0..shape.values()).map(|k| atom.value(at(k % side), at(k / side))).collect();
        atom.mean = shape.mean(&samples);
        samples.iter_mut().for_each(|v| *v -= atom.mean);
        let norm = shape.norm(&samples);
        if norm.is_nan() || norm <= 1e-9 {
            return None;
        }
        atom.scale = 1.0 / norm;
        let samples = samples.iter().map(|v| (v * atom.scale) as f32).collect();
        Some((atom, samples))
    }

    /// The family.
    pub fn family(&self) -> NoiseFamily {
        self.family
    }

    /// The octaves; wavelengths in radii.
    pub fn spectrum(&self) -> Spectrum {
        self.spectrum
    }

    /// Where the disc's centre lies in the noise, in radii.
    pub fn centre(&self) -> [f64; 2] {
        self.centre
    }

    /// What is taken away from the noise, and what the rest is multiplied with.
    pub fn mean_and_scale(&self) -> (f64, f64) {
        (self.mean, self.scale)
    }

    /// The atom's value at a point `x`, `y` radii from the centre (east and south).
    pub fn value(&self, x: f64, y: f64) -> f64 {
        (self.sum.at(self.centre[0] + x, self.centre[1] + y, Sample::default()).value - self.mean) * self.scale
    }

    /// The atom's value and its gradient, per radius, at a point `x`, `y` radii from the centre.
    pub fn sample(&self, x: f64, y: f64) -> Sample {
        let found = self.sum.at(self.centre[0] + x, self.centre[1] + y, Sample::default());
        let scale = self.scale;
        Sample { value: (found.value - self.mean) * scale, dx: found.dx * scale, dy: found.dy * scale }
    }

    /// Range of the atom, and bound of its slope per radius.
    pub fn bounds(&self) -> (Interval, f64) {
        let (range, slope) = self.sum.bounds((Interval::ONE, 0.0));
        let range = Interval { min: range.min - self.mean, max: range.max - self.mean }.scaled(self.scale);
        (range.widened(), slope * self.scale.abs() * (1.0 + 1e-12))
    }
}

impl Dictionary {
    /// Windows of noise of one family, drawn by a seed.
    ///
    /// # Errors
    /// When the count is 0 or beyond what a dictionary holds.
    pub fn noise(family: NoiseFamily, shape: &PatchShape, count: usize, seed: u64) -> Result<Self> {
        let mut dictionary = Self::new(shape.side(), vec![]);
        if count == 0 || count > Self::MOST_ATOMS {
            return Err(Error::usage(format!("a dictionary of {count} atoms: 1 to {} are possible", Self::MOST_ATOMS)));
        }
        let drawn: Vec<_> = (0..count as u64)
            .into_par_iter()
            .map(|i| {
                // Noise is nowhere constant, except by an accident that the next seed does not share.
                let mut rng = Rng::for_part(seed, i);
                loop {
                    if let Some(atom) = NoiseAtom::draw(family, shape, rng.next_u64()) {
                        return atom;
                    }
                }
            })
            .collect();
        for (atom, samples) in drawn {
            dictionary.push(&samples, Origin::Noise(Box::new(atom)));
        }
        Ok(dictionary)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAMILIES: [NoiseFamily; 3] = [NoiseFamily::Perlin, NoiseFamily::Ridged, NoiseFamily::RidgedMultifractal];

    #[test]
    fn samples_are_the_values_at_the_centres_of_cells() {
        let shape = PatchShape::new(9).unwrap();
        for family in FAMILIES {
            let dictionary = Dictionary::noise(family, &shape, 20, 5).unwrap();
            assert_eq!(dictionary, Dictionary::noise(family, &shape, 20, 5).unwrap());
            assert_ne!(dictionary, Dictionary::noise(family, &shape, 20, 6).unwrap());
            for i in 0..dictionary.len() {
                let Origin::Noise(atom) = dictionary.origin(i) else { panic!("an atom of noise") };
                let values = dictionary.atom(i);
                assert!(shape.mean(values).abs() < 1e-6);
                let doubles: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
                assert!((shape.norm(&doubles) - 1.0).abs() < 1e-5);
                for (k, &value) in values.iter().enumerate() {
                    let (x, y) = ((k % 9) as f64 - 4.0, (k / 9) as f64 - 4.0);
                    assert!((atom.value(x / 4.5, y / 4.5) - f64::from(value)).abs() < 1e-6);
                }
            }
        }
        assert!(Dictionary::noise(NoiseFamily::Perlin, &shape, 0, 1).is_err());
    }
}
