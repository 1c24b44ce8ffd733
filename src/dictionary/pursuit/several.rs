//! Several atoms a patch: one product a step for all patches of a block.

use super::super::codes::Block;
use super::projection::{LEAST_NEW, Projection};
use super::scan::Uncertain;
use super::{Choice, LEAST_GAIN, Pursuit, Scratch};
use crate::linalg::product;

/// Scores of a block that are kept at once; blocks are cut smaller for large dictionaries.
const SCORES: usize = 1 << 22;
/// What rounding a number to `f32` changes it by at most, relatively.
const UNIT: f64 = 1.0 / (1u64 << 24) as f64;

impl Pursuit {
    /// Finds the atoms of each patch of a block.
    #[inline(always)]
    pub(super) fn match_several(&self, values: &[f32], codes: &mut Block, scratch: &mut Scratch) {
        let size = self.shape.values();
        let rows = values.len() / size;
        let most = (SCORES / self.count()).clamp(16, super::BLOCK);
        for from in (0..rows).step_by(most) {
            let to = (from + most).min(rows);
            self.match_part(&values[from * size..to * size], codes, from, scratch);
        }
    }

    #[inline(always)]
    fn match_part(&self, values: &[f32], codes: &mut Block, from: usize, scratch: &mut Scratch) {
        let (size, count) = (self.shape.disc_values(), self.count());
        let rows = self.scale_block(values, &mut scratch.patches);
        let Scratch { patches, scores, directions, overlaps, outside, projections, .. } = scratch;
        projections.resize_with(projections.len().max(rows), Projection::default);
        let mut whole = [0.0; super::BLOCK];
        let mut active = [false; super::BLOCK];
        for row in 0..rows {
            projections[row].begin(&patches[row * size..][..size]);
            whole[row] = projections[row].error();
            active[row] = whole[row] > 0.0;
        }
        scores.resize(rows * count, 0.0);
        overlaps.resize(rows * count, 0.0);
        directions.resize(rows * size, 0.0);
        // Square lengths of what lies outside the span: at first of the whole atoms.
        outside.clear();
        for _ in 0..rows {
            outside.extend(self.squares.iter().map(|&square| square as f32));
        }
        // Of vectors of length 1, rounded to `f32`.
        let off = self.score_error() + UNIT * (1.0 + self.unequal) * (1.0 + self.score_error());
        for step in 0..self.sparsity {
            if step > 0 && self.choice == Choice::SmallestResidual {
                for row in 0..rows {
                    if active[row] {
                        let direction = projections[row].last_direction();
                        let out = &mut directions[row * size..][..size];
                        out.iter_mut().zip(direction).for_each(|(out, &d)| *out = d as f32);
                    }
                }
                product(directions, &self.atoms, size, overlaps);
                for (outside, overlap) in outside.iter_mut().zip(overlaps.iter()) {
                    *outside -= overlap * overlap;
                }
            }
            for row in 0..rows {
                let length = projections[row].error().sqrt();
                active[row] &= length * length > LEAST_GAIN * whole[row];
                if active[row] {
                    let out = &mut patches[row * size..][..size];
                    let residual = projections[row].residual();
                    out.iter_mut().zip(residual).for_each(|(out, &r)| *out = (r / length) as f32);
                }
            }
            if !active[..rows].contains(&true) {
                break;
            }
            product(patches, &self.atoms, size, scores);
            // An overlap v of at most 1 + unequal that is off by e changes v² by at most e (2 |v| + e); squaring and
            // subtracting round twice. 2.5 e has room for it all.
            let terms = match self.choice {
                Choice::SmallestResidual => step as f64,
                Choice::LargestCorrelation => 0.0,
            };
            let uncertain = Uncertain {
                c: (off as f32).next_up(),
                l: ((terms * 2.5 * off + 2.0 * UNIT) * (1.0 + 3.0 * self.unequal)) as f32,
                least: LEAST_NEW as f32,
            };
            for row in 0..rows {
                if active[row] {
                    let (scores, outside) = (&scores[row * count..][..count], &outside[row * count..][..count]);
                    active[row] = self.take_best(&mut projections[row], scores, outside, uncertain, whole[row]);
                }
            }
        }
        for (row, projection) in projections[..rows].iter().enumerate() {
            codes.set(from + row, projection.atoms(), &projection.coefficients().0);
        }
    }

    /// Compares the contenders in double precision and takes the best; false at the end.
    #[inline(always)]
    fn take_best(
        &self,
        projection: &mut Projection,
        scores: &[f32],
        outside: &[f32],
        uncertain: Uncertain,
        whole: f64,
    ) -> bool {
        let mut best = (0.0, None);
        uncertain.contenders(scores, outside, |k| {
            if projection.atoms().contains(&(k as u32)) {
                return;
            }
            let atom = self.atom(k);
            let length = match self.choice {
                Choice::SmallestResidual => projection.outside(atom, self.squares[k]),
                Choice::LargestCorrelation => self.squares[k],
            };
            let correlation = projection.correlation(atom);
            let gain = correlation * correlation / length;
            if length >= LEAST_NEW && gain > best.0 {
                best = (gain, Some(k));
            }
        });
        let (gain, Some(k)) = best else { return false };
        gain > LEAST_GAIN * whole && projection.take(k as u32, self.atom(k), None)
    }
}
