//! A step that makes one of the finer planes that there may be, in place of the mean of all of them.

use super::back_projection::{BackProjection, CORRECTION_MARGIN};
use super::bicubic::{Bicubic, MARGIN};
use super::breach::{BREACH_REACH, breach};
use super::level::{keep_level, level};
use super::plane::Plane;
use super::step::{ESTIMATE_MARGIN, Step, Taken, trimmed_mask};
use super::texture::{Place, TEXTURE_MARGIN, Texture};

/// Turns of opening pits before the last; each leaves those that making up for what was dug has made.
const TURNS: usize = 1;

/// How the variance that an estimate lacks is shared out. Adding it as texture alone would be one draw of what is
/// likely, twice as far from the truth as the estimate is, in squares. Where the estimate's own detail is made larger by a
/// part, variance grows with that part and the error only with its square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shares {
    /// How many times the estimate's detail is taken.
    pub(super) detail: f64,
    /// How many times texture is taken, of that which would make up for all that is missing.
    pub(super) texture: f64,
}

impl Shares {
    /// Of the first step, on whose octave the distance from the truth depends.
    pub(super) const FIRST: Self = Self { detail: 1.2, texture: 0.75 };
    /// Of later steps, which decide how rough terrain is.
    pub(super) const LATER: Self = Self { detail: 1.3, texture: 1.05 };
}

/// A step and what is laid on its estimates.
#[derive(Clone, Debug)]
pub(super) struct Realistic<'a> {
    pub(super) step: &'a Step,
    pub(super) texture: Option<&'a Texture>,
    pub(super) shares: Shares,
}

/// Coarse cells at each side that are needed beyond those that are made finer by a factor.
pub(super) fn realistic_reach(factor: usize) -> usize {
    let breach = BREACH_REACH.div_ceil(factor);
    TEXTURE_MARGIN + CORRECTION_MARGIN + TURNS * (breach + MARGIN) + breach
}

impl Realistic<'_> {
    /// The finer plane of all but [`realistic_reach`] coarse cells at each side. Its means are the coarse heights where
    /// these are `known`.
    pub(super) fn applied(&self, coarse: &Plane, known: &[bool], place: Place) -> Plane {
        let factor = self.step.factor;
        let estimate = self.step.estimated(coarse, self.shares.detail, Taken::half(place.corner));
        let mut fine = estimate.trimmed((TEXTURE_MARGIN - ESTIMATE_MARGIN) * factor);
        if let Some(texture) = self.texture {
            let texture = texture.drawn(coarse, self.step, place);
            let pairs = fine.heights_mut().iter_mut().zip(texture.heights_m());
            pairs.for_each(|(height, texture)| *height += self.shares.texture * texture);
        }
        let mut ground = Ground::of(coarse, known).trimmed(TEXTURE_MARGIN - 1);
        fine = BackProjection::new(factor).corrected(&fine, &ground.coarse, &ground.known);
        ground = ground.trimmed(CORRECTION_MARGIN);
        ground.keep_level(&mut fine, factor);
        let breached = BREACH_REACH.div_ceil(factor);
        for _ in 0..TURNS {
            breach(&mut fine, &ground.fixed(factor));
            (fine, ground) = (fine.trimmed(breached * factor), ground.trimmed(breached));
            let more = Bicubic::new(factor).enlarged(&ground.missing(&fine, factor));
            (fine, ground) = (fine.trimmed(MARGIN * factor), ground.trimmed(MARGIN));
            fine.heights_mut().iter_mut().zip(more.heights_m()).for_each(|(height, more)| *height += more);
            ground.keep_level(&mut fine, factor);
        }
        breach(&mut fine, &ground.fixed(factor));
        (fine, ground) = (fine.trimmed(breached * factor), ground.trimmed(breached));
        // Hardly anything is missing now: it is given to all fine cells of a coarse one alike, which makes no pits in it.
        let missing = ground.missing(&fine, factor);
        let cols = fine.cols();
        for (row, line) in fine.heights_mut().chunks_exact_mut(cols).enumerate() {
            let missing = missing.row(row / factor);
            line.chunks_exact_mut(factor).zip(missing).for_each(|(cells, more)| {
                cells.iter_mut().for_each(|height| *height += more);
            });
        }
        fine
    }
}

/// Coarse heights, and what is known of them.
struct Ground {
    coarse: Plane,
    known: Vec<bool>,
    is_level: Vec<bool>,
}

impl Ground {
    /// Of all cells but one at each side.
    fn of(coarse: &Plane, known: &[bool]) -> Self {
        Self { coarse: coarse.trimmed(1), known: trimmed_mask(known, coarse.cols(), 1), is_level: level(coarse) }
    }

    fn trimmed(&self, margin: usize) -> Self {
        let cols = self.coarse.cols();
        Self {
            coarse: self.coarse.trimmed(margin),
            known: trimmed_mask(&self.known, cols, margin),
            is_level: trimmed_mask(&self.is_level, cols, margin),
        }
    }

    fn keep_level(&self, fine: &mut Plane, factor: usize) {
        keep_level(fine, &self.coarse, &self.is_level, factor);
    }

    /// Fine cells that are not to be dug in: those of water, and those of voids.
    fn fixed(&self, factor: usize) -> Vec<bool> {
        let cols = self.coarse.cols();
        let mut fixed = Vec::with_capacity(self.known.len() * factor * factor);
        for (level, known) in self.is_level.chunks_exact(cols).zip(self.known.chunks_exact(cols)) {
            let start = fixed.len();
            let line = level.iter().zip(known).map(|(level, known)| *level || !known);
            fixed.extend(line.flat_map(|is_fixed| std::iter::repeat_n(is_fixed, factor)));
            (1..factor).for_each(|_| fixed.extend_from_within(start..start + cols * factor));
        }
        fixed
    }

    /// What the means of fine cells lack.
    fn missing(&self, fine: &Plane, factor: usize) -> Plane {
        let mut missing = fine.averaged(factor);
        for ((own, wanted), &known) in missing.heights_mut().iter_mut().zip(self.coarse.heights_m()).zip(&self.known) {
            *own = if known { wanted - *own } else { 0.0 };
        }
        missing
    }
}
