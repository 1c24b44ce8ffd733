//! The octaves of a sum of noise: amplitudes, frequencies and where each lattice lies.

use crate::rng::Rng;

/// One term of a sum: `amplitude * eta(position * frequency + shift)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Octave {
    /// Greatest absolute value, in the unit of the sum (metres of elevation).
    pub amplitude: f64,
    /// Cycles per unit of the position (per metre).
    pub frequency: f64,
    /// Seed of the lattice.
    pub seed: u32,
    /// Where the lattice lies. Without shifts all octaves would be 0 at the same points.
    pub shift: [f64; 2],
}

/// Octaves in geometric progression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectrum {
    /// Number of octaves.
    pub octaves: usize,
    /// Amplitude of the first.
    pub amplitude: f64,
    /// Wavelength of the first: 1 / frequency.
    pub wavelength: f64,
    /// Amplitude of an octave relative to the one before; 1/2 is usual.
    pub persistence: f64,
    /// Frequency of an octave relative to the one before; 2 is usual.
    pub lacunarity: f64,
    /// Seed of all lattices.
    pub seed: u64,
}

impl Octave {
    /// Octaves with the given amplitudes and frequencies, lattices drawn from the seed.
    pub fn of(seed: u64, terms: &[(f64, f64)]) -> Vec<Self> {
        let mut rng = Rng::new(seed);
        let mut draw = |&(amplitude, frequency): &(f64, f64)| {
            let seed = rng.next_u32();
            Self { amplitude, frequency, seed, shift: [rng.unit() * 256.0, rng.unit() * 256.0] }
        };
        terms.iter().map(&mut draw).collect()
    }
}

impl Spectrum {
    /// The octaves.
    pub fn terms(&self) -> Vec<Octave> {
        let (mut amplitude, mut frequency) = (self.amplitude, 1.0 / self.wavelength);
        let mut terms = vec![];
        for _ in 0..self.octaves {
            terms.push((amplitude, frequency));
            amplitude *= self.persistence;
            frequency *= self.lacunarity;
        }
        Octave::of(self.seed, &terms)
    }
}
