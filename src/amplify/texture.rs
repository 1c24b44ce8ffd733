//! Texture: what terrain has beyond the best estimate of it, in patches of exemplars.

use super::back_projection::{BackProjection, CORRECTION_MARGIN};
use super::features::{INPUTS, Patches, RADIUS};
use super::learn::{Lesson, TOO_FEW};
use super::orientation::Ways;
use super::plane::Plane;
use super::step::{Step, trimmed_mask};
use super::strength::{STRENGTH_MARGIN, Strength, StrengthSums, bilinear};
use crate::linalg::vectorised;
use crate::rng::{Rng, cell_hash, row_hash};

/// Coarse cells at each side of its middle that a sample covers.
const HALF: usize = 3;
/// Coarse cells from the middle of one sample to the next.
const STRIDE: usize = 3;
/// Coarse cells at each side of a plane that are needed beyond those that get texture.
pub(super) const TEXTURE_MARGIN: usize = RADIUS + HALF;
/// Samples that are kept of each kind of patch, at most, and values of all of them.
const MOST_SAMPLES: usize = 128;
pub(super) const MOST_VALUES: usize = 1 << 22;
/// Kinds with fewer samples of their own take those of all.
const FEW_SAMPLES: usize = 8;
/// Places that samples are chosen from, at most.
const MOST_PLACES: usize = 1 << 15;
/// Parts of the mean strength below which samples are not made stronger: there is nothing in them but rounding.
const WEAK: f64 = 0.3;
/// Seed of what is drawn while learning.
const LEARNING: u32 = 0x7e47;

/// What exemplars have beyond the estimates of a step, in samples of strength 1.
#[derive(Clone, Debug)]
pub(super) struct Texture {
    pub(super) strength: Strength,
    /// For each kind of patch its samples, by number.
    pub(super) kinds: Vec<Vec<u32>>,
    /// Samples in standing position, one behind the other, faded towards their edges.
    pub(super) samples: Vec<f32>,
}

/// Where a plane lies in its raster, and which of many textures it gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// Row and column of the plane's first cell; margins may begin before the raster.
    pub(super) corner: [i64; 2],
    /// Equal seeds draw equal samples.
    pub(super) seed: u32,
}

/// What an exemplar has beyond the estimate.
struct Example {
    coarse: Plane,
    residual: Plane,
    known: Vec<bool>,
}

pub(super) fn sample_side(factor: usize) -> usize {
    (2 * HALF + 1) * factor
}

/// How much of a sample counts in one of its cells: all in the middle, nothing at the rim of the circle in its square.
fn fade(side: usize, row: usize, col: usize) -> f32 {
    let from_middle = |at: usize| (at as f64 + 0.5) / (side as f64 / 2.0) - 1.0;
    let (down, across) = (from_middle(row), from_middle(col));
    let left = (1.0 - (down * down + across * across)).max(0.0);
    (left * left * left) as f32
}

impl Texture {
    /// Learns what lessons have beyond what the step makes of them; nothing where they have too little of it.
    pub(super) fn learn(lessons: impl Iterator<Item = Lesson>, step: &Step) -> Option<Self> {
        let all = lessons.map(|lesson| (lesson.places().collect::<Vec<_>>(), lesson));
        // Without places there may be no cells at all.
        let examples: Vec<(Vec<(usize, usize)>, Lesson)> = all.filter(|(places, _)| !places.is_empty()).collect();
        if examples.iter().map(|(places, _)| places.len()).sum::<usize>() < TOO_FEW {
            return None;
        }
        let mut places: Vec<(usize, usize, usize)> = vec![];
        let mut sums = StrengthSums::new();
        let mut all = vec![];
        for (number, (own, lesson)) in examples.into_iter().enumerate() {
            places.extend(own.into_iter().map(|(row, col)| (number, row, col)));
            let example = Example::of(lesson, step);
            sums.add(&example.coarse, &example.squares(step.factor), &example.known);
            all.push(example);
        }
        let mut rng = Rng::new(u64::from(LEARNING));
        rng.shuffle(&mut places);
        places.truncate(MOST_PLACES);
        let mut texture = Self { strength: sums.solved(), kinds: vec![vec![]; Step::KINDS], samples: vec![] };
        texture.take(&all, &places, step);
        if texture.samples.is_empty() {
            return None;
        }
        let gain = texture.gain(&all, step);
        texture.strength = texture.strength.times(gain);
        (gain > 0.0).then_some(texture)
    }

    /// Values that it is made of.
    pub(super) fn len(&self) -> usize {
        self.samples.len()
    }

    /// Takes samples at places, in their order.
    fn take(&mut self, examples: &[Example], places: &[(usize, usize, usize)], step: &Step) {
        let side = sample_side(step.factor);
        let most = MOST_SAMPLES.min(MOST_VALUES / (side * side) / Step::KINDS);
        let ways = Ways::new(side);
        let mut count = 0;
        for (number, example) in examples.iter().enumerate() {
            let strength = bilinear(&self.strength.of(&example.coarse), step.factor);
            let all = example.residual.heights_m();
            let least = WEAK * (all.iter().map(|v| v * v).sum::<f64>() / all.len() as f64).sqrt();
            let patches = Patches::new(&example.coarse, step.is_square);
            let offsets = ways.offsets(example.residual.cols());
            let strong_offsets = ways.offsets(strength.cols());
            for &(_, row, col) in places.iter().filter(|place| place.0 == number) {
                let mut patch = [0.0; INPUTS];
                let way = patches.take(row, col, &mut patch);
                let kind = &mut self.kinds[step.kind(&patch)];
                let inset = STRENGTH_MARGIN + 1 + HALF;
                let is_inside = |at: usize, count: usize| (inset..count - inset).contains(&at);
                let is_whole = is_inside(row, example.coarse.rows()) && is_inside(col, example.coarse.cols());
                if kind.len() >= most || !is_whole {
                    continue;
                }
                kind.push(count);
                count += 1;
                let corner = |plane: &Plane, margin: usize| {
                    ((row - HALF - margin) * plane.cols() + col - HALF - margin) * step.factor
                };
                let own = &all[corner(&example.residual, 0)..];
                let strong = &strength.heights_m()[corner(&strength, STRENGTH_MARGIN + 1)..];
                let cells = offsets.of(way).iter().zip(strong_offsets.of(way));
                self.samples.extend(cells.enumerate().map(|(i, (&cell, &strong_cell))| {
                    let unit = own[cell] / strong[strong_cell].max(least).max(f64::MIN_POSITIVE);
                    unit as f32 * fade(side, i / side, i % side)
                }));
            }
        }
        let everything: Vec<u32> = (0..count).collect();
        for kind in self.kinds.iter_mut().filter(|kind| kind.len() < FEW_SAMPLES) {
            kind.clone_from(&everything);
        }
    }

    /// How many times as strong texture has to be drawn to be as strong as that of the examples.
    fn gain(&self, examples: &[Example], step: &Step) -> f64 {
        let (mut own, mut drawn) = (0.0, 0.0);
        let margin = TEXTURE_MARGIN + CORRECTION_MARGIN;
        for (number, example) in examples.iter().enumerate() {
            if example.coarse.rows().min(example.coarse.cols()) <= 2 * margin {
                continue;
            }
            let place = Place { corner: [0, 0], seed: LEARNING.wrapping_add(number as u32) };
            let texture = self.drawn(&example.coarse, step, place);
            let within = example.coarse.trimmed(TEXTURE_MARGIN);
            let zero = Plane::new(within.rows(), within.cols(), vec![0.0; within.heights_m().len()]);
            let all = vec![true; within.heights_m().len()];
            let texture = BackProjection::new(step.factor).corrected(&texture, &zero, &all);
            let residual = example.residual.trimmed(margin * step.factor);
            let known = trimmed_mask(&example.known, example.coarse.cols(), margin);
            let cols = residual.cols();
            let pairs = residual.heights_m().iter().zip(texture.heights_m());
            for (cell, (a, b)) in pairs.enumerate() {
                if known[cell / cols / step.factor * (cols / step.factor) + cell % cols / step.factor] {
                    own += a * a;
                    drawn += b * b;
                }
            }
        }
        if drawn > 0.0 { (own / drawn).sqrt() } else { 0.0 }
    }

    /// Texture for all cells of a plane but [`TEXTURE_MARGIN`] at each side.
    ///
    /// Samples lie where the raster's cells say, and each is drawn by a hash of its place; each fine cell takes them row
    /// by row. Where they overlap, the sum is divided by the root of the sum of squares of their weights: independent
    /// samples keep their variance so.
    pub(super) fn drawn(&self, coarse: &Plane, step: &Step, place: Place) -> Plane {
        let factor = step.factor;
        let side = sample_side(factor);
        let wide = coarse.cols() * factor;
        let mut sums = vec![0.0f32; coarse.rows() * factor * wide];
        let patches = Patches::new(coarse, step.is_square);
        let places = Ways::new(side).offsets(wide);
        let first = |corner: i64| RADIUS + (-(corner + RADIUS as i64)).rem_euclid(STRIDE as i64) as usize;
        let rows = (first(place.corner[0])..coarse.rows() - RADIUS).step_by(STRIDE);
        for row in rows {
            let hashes = row_hash(place.seed, (place.corner[0] + row as i64) as u32);
            for col in (first(place.corner[1])..coarse.cols() - RADIUS).step_by(STRIDE) {
                let mut patch = [0.0; INPUTS];
                let way = patches.take(row, col, &mut patch);
                let kind = &self.kinds[vectorised(|| step.kind(&patch))];
                let hash = cell_hash(hashes, (place.corner[1] + col as i64) as u32);
                // The upper half of the product: each sample is as likely as the others.
                let number = kind[((u64::from(hash) * kind.len() as u64) >> 32) as usize] as usize;
                let sample = &self.samples[number * side * side..][..side * side];
                let square = &mut sums[((row - HALF) * wide + col - HALF) * factor..];
                for (height, &cell) in sample.iter().zip(places.of(way)) {
                    square[cell] += height;
                }
            }
        }
        let mut texture =
            bilinear(&self.strength.of(coarse), factor).trimmed((TEXTURE_MARGIN - STRENGTH_MARGIN - 1) * factor);
        let divisors = divisors(factor);
        let period = STRIDE * factor;
        let phase =
            |axis: usize| (place.corner[axis] + TEXTURE_MARGIN as i64).rem_euclid(STRIDE as i64) as usize * factor;
        let cols = texture.cols();
        for (row, line) in texture.heights_mut().chunks_exact_mut(cols.max(1)).enumerate() {
            let divisors = &divisors[(row + phase(0)) % period * period..][..period];
            let sums = &sums[(row + TEXTURE_MARGIN * factor) * wide + TEXTURE_MARGIN * factor..];
            let columns = divisors.iter().cycle().skip(phase(1));
            line.iter_mut()
                .zip(sums)
                .zip(columns)
                .for_each(|((height, sum), divisor)| *height *= f64::from(*sum) * divisor);
        }
        texture
    }
}

#[cfg(test)]
impl Texture {
    /// What [`Texture::drawn`] does, cell by cell in double precision.
    pub(super) fn drawn_slowly(&self, coarse: &Plane, step: &Step, place: Place) -> Plane {
        let (factor, side) = (step.factor, sample_side(step.factor));
        let margin = TEXTURE_MARGIN * factor;
        let strength = bilinear(&self.strength.of(coarse), factor);
        let (rows, cols) = (coarse.rows() * factor - 2 * margin, coarse.cols() * factor - 2 * margin);
        let patches = Patches::new(coarse, step.is_square);
        let samples =
            (RADIUS..coarse.rows() - RADIUS).flat_map(|r| (RADIUS..coarse.cols() - RADIUS).map(move |c| (r, c)));
        let is_sampled = |(r, c): &(usize, usize)| {
            [(place.corner[0], *r), (place.corner[1], *c)].iter().all(|(corner, at)| (corner + *at as i64) % 3 == 0)
        };
        let drawn: Vec<(usize, usize, &[f32], Vec<usize>)> = samples
            .filter(is_sampled)
            .map(|(r, c)| {
                let mut patch = [0.0; INPUTS];
                let way = patches.take(r, c, &mut patch);
                let kind = &self.kinds[step.kind(&patch)];
                let [down, across] = [place.corner[0] + r as i64, place.corner[1] + c as i64].map(|at| at as u32);
                let hash = cell_hash(row_hash(place.seed, down), across);
                let number = kind[(f64::from(hash) / 4_294_967_296.0 * kind.len() as f64) as usize] as usize;
                let cells = Ways::new(side).offsets(side).of(way).to_vec();
                (r, c, &self.samples[number * side * side..][..side * side], cells)
            })
            .collect();
        let height = |row: usize, col: usize| {
            let (mut sum, mut squares) = (0.0, 0.0);
            for (r, c, sample, cells) in &drawn {
                let own = [row + HALF * factor, col + HALF * factor].map(|at| at as i64);
                let [down, across] = [own[0] - (r * factor) as i64, own[1] - (c * factor) as i64];
                if [down, across].iter().all(|at| (0..side as i64).contains(at)) {
                    let cell = (down * side as i64 + across) as usize;
                    let turned = cells.iter().position(|&other| other == cell).expect("a way turns all cells");
                    sum += f64::from(sample[turned]);
                    squares += f64::from(fade(side, down as usize, across as usize)).powi(2);
                }
            }
            let inset = (STRENGTH_MARGIN + 1) * factor;
            sum / squares.sqrt() * strength.row(row - inset)[col - inset]
        };
        let heights = (0..rows * cols).map(|cell| height(cell / cols + margin, cell % cols + margin)).collect();
        Plane::new(rows, cols, heights)
    }
}

/// For the fine cells of `STRIDE` rows and columns of coarse ones, from one in which a sample has its middle: one over the
/// root of the sum of squares of the weights of all samples that cover it.
fn divisors(factor: usize) -> Vec<f64> {
    let (side, period) = (sample_side(factor), STRIDE * factor);
    let squares = |cell: usize| -> f64 {
        let (row, col) = (cell / period, cell % period);
        // From the first row of a sample with its middle in the first coarse row, or so many strides before.
        let covered = |at: usize| (0..side).skip((at + HALF * factor) % period).step_by(period);
        let weight = |(r, c): (usize, usize)| f64::from(fade(side, r, c));
        covered(row).flat_map(|r| covered(col).map(move |c| (r, c))).map(weight).map(|w| w * w).sum()
    };
    (0..period * period).map(|cell| 1.0 / squares(cell).sqrt()).collect()
}

impl Example {
    fn of(lesson: Lesson, step: &Step) -> Self {
        let estimate = lesson.estimated(step);
        let mut residual = lesson.fine;
        residual.heights_mut().iter_mut().zip(estimate.heights_m()).for_each(|(height, own)| *height -= own);
        Self { coarse: lesson.coarse, residual, known: lesson.known }
    }

    /// Mean squares in each coarse cell.
    fn squares(&self, factor: usize) -> Plane {
        let squares = self.residual.heights_m().iter().map(|v| v * v).collect();
        Plane::new(self.residual.rows(), self.residual.cols(), squares).averaged(factor)
    }
}
