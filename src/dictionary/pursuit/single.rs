//! One atom a patch: a product and its largest values.

use super::super::codes::Block;
use super::scan::{largest, reaching};
use super::{LEAST_GAIN, Pursuit, Scratch};
use crate::linalg::{UNDERFLOW, dot, product};

/// Atoms of one product; their scores for a block stay in the processor's cache.
const ATOMS: usize = 512;

/// What is known of a patch so far.
#[derive(Clone, Copy)]
struct Best {
    /// Its length.
    length: f64,
    /// Largest size of a score.
    score: f32,
    /// The best of those compared in double precision: gain, correlation and atom.
    gain: f64,
    correlation: f64,
    atom: u32,
}

impl Pursuit {
    /// Finds the best atom of each patch of a block; unless `SIGNED`, with a positive coefficient.
    #[inline(always)]
    pub(super) fn match_single<const SIGNED: bool>(&self, values: &[f32], codes: &mut Block, scratch: &mut Scratch) {
        let size = self.shape.disc_values();
        let rows = self.scale_block(values, &mut scratch.patches);
        let patches = &scratch.patches[..rows * size];
        let none = Best { length: 0.0, score: 0.0, gain: 0.0, correlation: 0.0, atom: 0 };
        let mut best = [none; super::BLOCK];
        for (best, patch) in best.iter_mut().zip(patches.chunks_exact(size)) {
            best.length = dot(patch, patch).sqrt();
        }
        // A score is off by at most the error, and the lengths of two atoms differ by twice the other.
        let off = 2.0 * self.score_error() + 2.0 * self.unequal * (1.0 + self.score_error());
        for (chunk, atoms) in self.atoms.chunks(ATOMS * size).enumerate() {
            let count = atoms.len() / size;
            scratch.scores.resize(rows * count, 0.0);
            product(patches, atoms, size, &mut scratch.scores);
            for ((best, patch), scores) in
                best.iter_mut().zip(patches.chunks_exact(size)).zip(scratch.scores.chunks_exact(count))
            {
                let most = largest::<SIGNED>(scores);
                best.score = if most > best.score { most } else { best.score };
                let least = f64::from(best.score) - off * best.length - 2.0 * size as f64 * UNDERFLOW;
                let least = (least as f32).next_down();
                if most < least {
                    continue;
                }
                reaching::<SIGNED>(scores, least, |i| {
                    let k = chunk * ATOMS + i;
                    let correlation = dot(patch, self.atom(k));
                    let gain = correlation * correlation / self.squares[k];
                    if gain > best.gain && (SIGNED || correlation > 0.0) {
                        (best.gain, best.correlation, best.atom) = (gain, correlation, k as u32);
                    }
                });
            }
        }
        for (row, best) in best[..rows].iter().enumerate() {
            if best.gain > LEAST_GAIN * best.length * best.length {
                codes.set(row, &[best.atom], &[best.correlation / self.squares[best.atom as usize]]);
            } else {
                codes.set(row, &[], &[]);
            }
        }
    }
}
