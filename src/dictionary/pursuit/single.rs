//! One atom a patch: a product and its largest values.

use super::super::codes::Block;
use super::scan::{largest, reaching};
use super::tree::{Short, Tree};
use super::{LEAST_GAIN, Pursuit, Scratch, Signs};
use crate::linalg::{UNDERFLOW, dot, product};

/// Atoms of one product; their scores for a block stay in the processor's cache.
const ATOMS: usize = 512;

/// A patch whose atom is looked for in a tree.
pub(super) struct Turn {
    /// Where in the tree it begins.
    leaf: u32,
    row: u32,
    length: f64,
    short: Short,
}

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

impl Best {
    const NONE: Self = Self { length: 0.0, score: 0.0, gain: 0.0, correlation: 0.0, atom: 0 };
}

impl Pursuit {
    /// Finds the best atom of each patch of a block; unless `SIGNED`, with a positive coefficient.
    #[inline(always)]
    pub(super) fn match_single<const SIGNED: bool>(&self, values: &[f32], codes: &mut Block, scratch: &mut Scratch) {
        let size = self.shape.disc_values();
        let rows = self.scale_block(values, &mut scratch.patches);
        let patches = &scratch.patches[..rows * size];
        let mut best = [Best::NONE; super::BLOCK];
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
            self.set(row, best, codes);
        }
    }

    /// The same by a tree of the atoms.
    #[inline(always)]
    pub(super) fn match_in(&self, tree: &Tree, values: &[f32], codes: &mut Block, scratch: &mut Scratch) {
        let size = self.shape.disc_values();
        let rows = self.scale_block(values, &mut scratch.patches);
        let patch = |row: usize| &scratch.patches[row * size..][..size];
        let turns = &mut scratch.turns;
        turns.clear();
        for row in 0..rows {
            let length = dot(patch(row), patch(row)).sqrt();
            if length > 0.0 {
                let short = tree.short(patch(row), length);
                turns.push(Turn { leaf: tree.near(&short), row: row as u32, length, short });
            } else {
                codes.set(row, &[], &[]);
            }
        }
        turns.sort_unstable_by_key(|turn| (turn.leaf, turn.row));
        for turn in turns {
            let patch = patch(turn.row as usize);
            let mut best = Best { length: turn.length, ..Best::NONE };
            tree.search(&turn.short, |k| {
                let correlation = dot(patch, self.atom(k));
                let gain = correlation * correlation / self.squares[k];
                // The first of equals, whatever the order.
                let is_better = gain > best.gain || (gain == best.gain && (k as u32) < best.atom);
                if is_better && (self.signs == Signs::Both || correlation > 0.0) {
                    (best.gain, best.correlation, best.atom) = (gain, correlation, k as u32);
                }
                best.gain.sqrt() / best.length
            });
            self.set(turn.row as usize, &best, codes);
        }
    }

    /// The atom of a patch, if there is one that explains some of it.
    #[inline(always)]
    fn set(&self, row: usize, best: &Best, codes: &mut Block) {
        if best.gain > LEAST_GAIN * best.length * best.length {
            codes.set(row, &[best.atom], &[best.correlation / self.squares[best.atom as usize]]);
        } else {
            codes.set(row, &[], &[]);
        }
    }
}
