//! Roughness of the ground between ridges and valleys.

use super::form::Graded;
use crate::noise::{COLS, NoiseKind, NoiseSum, Rows, Spectrum};
use rayon::prelude::*;

/// Rows that are worked on at once.
const BAND: usize = 64;
/// Wavelength in metres of the coarsest forms.
const COARSEST_M: f64 = 500.0;
/// What makes the root of the mean square of the slope of one octave 1.
const STEEP: f64 = 0.5;

/// Detail in metres of each cell: fractal noise whose octaves are all as steep, with `roughness` the root of the mean
/// square of the slope of each.
pub(super) fn detail(
    [rows, cols]: [usize; 2],
    [width_m, height_m]: [f64; 2],
    roughness: &Graded,
    seed: u64,
) -> Vec<f32> {
    let most = roughness.most();
    let mut z = vec![0.0_f32; rows * cols];
    let octaves = (COARSEST_M / (2.0 * width_m.max(height_m))).log2().ceil().max(1.0) as usize;
    let amplitude = STEEP * f64::from(most) * COARSEST_M;
    let spectrum = Spectrum { octaves, amplitude, wavelength: COARSEST_M, persistence: 0.5, lacunarity: 2.0, seed };
    let noise = NoiseSum::new(NoiseKind::Fractal, spectrum.terms());
    z.par_chunks_mut((BAND * cols).max(1)).enumerate().for_each(|(band, z)| {
        let ys: Vec<f64> = (0..z.len() / cols).map(|row| (band * BAND + row) as f64 * height_m).collect();
        let mut value = vec![[0.0; COLS]; ys.len()];
        let (mut dx, mut dy) = (value.clone(), value.clone());
        for first in (0..cols).step_by(COLS) {
            let xs: [f64; COLS] = std::array::from_fn(|i| (first + i) as f64 * width_m);
            noise.cross::<false>(&xs, &ys, [&[]; 3], Rows { value: &mut value, dx: &mut dx, dy: &mut dy });
            for (line, value) in z.chunks_exact_mut(cols).zip(&value) {
                for (z, value) in line[first..].iter_mut().zip(value) {
                    *z = *value as f32;
                }
            }
        }
        if !roughness.is_even() && most > 0.0 {
            for (row, line) in z.chunks_exact_mut(cols).enumerate() {
                let own = roughness.row(band * BAND + row, [rows, cols]);
                line.iter_mut().zip(&own).for_each(|(z, own)| *z *= own / most);
            }
        }
    });
    z
}
