//! Steps one after the other, each learned at its own scale.

use super::fill::filled;
use super::learn::{By, Lesson, Lessons, TOO_FEW, learn};
use super::network::{NETWORK_FACTORS, NETWORK_REACH, Network};
use super::plane::Plane;
use super::realistic::{Realistic, Shares, realistic_reach};
use super::step::{STEP_FACTORS, Step, trimmed_mask};
use super::texture::{Place, Texture};
use crate::error::{Error, ErrorKind, Result};
use crate::rng::Rng;
use crate::watch::Watch;
use rayon::prelude::*;

/// Rows and columns of coarse cells in the middle of an exemplar that texture is learned from, at most.
const TEXTURE_SIDE: usize = 768;
/// Seed of what is drawn while steps with texture learn: what they are drawn with comes later.
const TEXTURED: u64 = 1;

/// The largest factor.
pub const MOST_FACTOR: usize = 256;

/// Makes planes finer by a factor, with the detail that exemplars have taught.
#[derive(Clone, Debug)]
pub struct Cascade {
    pub(super) steps: Vec<Stage>,
    /// Steps that were learned at a finer scale than their own.
    pub(super) borrowed: usize,
}

/// What makes planes finer in one step.
#[derive(Clone, Debug)]
pub(super) enum Stage {
    /// The best estimate.
    Estimate(Network),
    /// Estimates, and what is laid on them.
    Terrain { step: Box<Step>, texture: Option<Texture> },
}

impl Stage {
    pub(super) fn factor(&self) -> usize {
        match self {
            Self::Estimate(network) => network.factor,
            Self::Terrain { step, .. } => step.factor,
        }
    }

    /// Coarse cells at each side that are needed beyond those that are made finer.
    fn reach(&self) -> usize {
        match self {
            Self::Estimate(_) => NETWORK_REACH,
            Self::Terrain { step, .. } => realistic_reach(step.factor),
        }
    }

    /// Numbers that were learned.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Estimate(network) => network.len(),
            Self::Terrain { step, texture } => step.len() + texture.as_ref().map_or(0, Texture::len),
        }
    }
}

/// That a factor can be made of steps.
///
/// # Errors
/// A usage error below 2, above [`MOST_FACTOR`], and for factors with prime parts that there are no steps of.
pub fn check_factor(factor: usize) -> Result<()> {
    steps_of(factor, &STEP_FACTORS).map(drop)
}

/// The factors of the steps that make up a factor, the first of `parts` first.
pub(super) fn steps_of(factor: usize, parts: &[usize]) -> Result<Vec<usize>> {
    let expected = format!("expected 2 to {MOST_FACTOR}, a product of 2, 3, 5 and 7, such as 2, 3, 4, 8, 10");
    let mut left = factor;
    let mut steps = vec![];
    for &part in parts {
        while left > 1 && left.is_multiple_of(part) {
            steps.push(part);
            left /= part;
        }
    }
    if !(2..=MOST_FACTOR).contains(&factor) || left != 1 {
        return Err(Error::usage(format!("--factor {factor}: {expected}")));
    }
    Ok(steps)
}

/// Where the coarse cells of an exemplar are laid, in parts of a coarse cell: down and across. One terrain is as many
/// lessons.
const SHIFTS: [(f64, f64); 8] =
    [(0.0, 0.0), (0.5, 0.5), (0.0, 0.5), (0.5, 0.0), (0.25, 0.25), (0.75, 0.75), (0.25, 0.75), (0.75, 0.25)];
/// Cells of all exemplars, each counted as often as it is shifted, beyond which there are fewer shifts.
const MOST_CELLS: usize = 1 << 24;

/// An exemplar with its coarse cells laid in one way.
struct Scales<'a> {
    exemplar: &'a Plane,
    corner: [usize; 2],
    /// Rows and columns of the coarsest cells.
    size: [usize; 2],
    factors: &'a [usize],
    /// What the step at hand sees: heights that the steps before it have made.
    seen: Plane,
}

impl Cascade {
    /// Learns the steps of a factor from terrain (NaN for voids) whose cells are as large as those that are to be made.
    /// Cells that `is_square` says are not are mirrored but not transposed.
    ///
    /// Each step learns from what the steps before it make of the exemplars, which is what it will see. Where the
    /// exemplars are too small for the coarsest steps, these take what the finer ones have learned: terrain is much the
    /// same at scales that are not far from each other.
    ///
    /// # Errors
    /// As [`check_factor`]; exemplars in which no step finds enough to learn from; a cancelled job.
    pub fn learn(exemplars: &[Plane], factor: usize, is_square: bool, seed: u64, watch: &Watch) -> Result<Self> {
        let factors = steps_of(factor, &NETWORK_FACTORS)?;
        let mut scales = shifted(exemplars, &factors);
        let mut found: Vec<Option<Network>> = vec![];
        for (number, &factor) in factors.iter().enumerate() {
            let make = |lesson: usize| scales[lesson].lesson(number);
            let lessons = Lessons { count: scales.len(), make: &make };
            let network = Network::learn(&lessons, factor, is_square, seed, watch)?;
            if number + 1 < factors.len() {
                scales.par_iter_mut().for_each(|scales| scales.advance(number, network.as_ref()));
            }
            found.push(network);
        }
        let borrowed = found.iter().filter(|network| network.is_none()).count();
        let own = |(number, &factor): (usize, &usize)| {
            let later = found[number..].iter().flatten().find(|network| network.factor == factor);
            later.cloned().map(Stage::Estimate).ok_or_else(too_little)
        };
        Ok(Self { steps: factors.iter().enumerate().map(own).collect::<Result<_>>()?, borrowed })
    }

    /// Learns the steps of a factor as [`Cascade::learn`] does, and the texture of each. What is to become terrain looks
    /// like terrain before each step, so each step learns from true heights. How far the result is from the truth depends
    /// on the first step most, so its estimates are by a network; those of later ones, for many more cells, by
    /// regressions.
    ///
    /// # Errors
    /// As [`Cascade::learn`].
    pub fn learn_textured(exemplars: &[Plane], factor: usize, is_square: bool, watch: &Watch) -> Result<Self> {
        let factors = steps_of(factor, &STEP_FACTORS)?;
        let mut scales = shifted(exemplars, &factors);
        let mut found: Vec<Option<(Step, Option<Texture>)>> = vec![];
        for (number, &factor) in factors.iter().enumerate() {
            let make = |lesson: usize| scales[lesson].lesson(number);
            watch.begin("learning", 1);
            let lessons = Lessons { count: scales.len(), make: &make };
            let by = if number == 0 { By::Network } else { By::Regressions };
            let step = learn(&lessons, factor, is_square, by, TEXTURED, watch)?;
            if number + 1 < factors.len() {
                scales.par_iter_mut().for_each(|scales| scales.advance(number, None));
            }
            found.push(step.map(|step| {
                let texture = texture(exemplars, &factors, number, &step);
                (step, texture)
            }));
            watch.advance(1)?;
        }
        let borrowed = found.iter().filter(|step| step.is_none()).count();
        let mut steps = vec![];
        for (number, &factor) in factors.iter().enumerate() {
            let later = || found[number..].iter().flatten().filter(|(step, _)| step.factor == factor);
            let (step, texture) = later().next().cloned().ok_or_else(too_little)?;
            // A scale may be large enough for a step and too small for texture; finer texture will do.
            let (step, texture) = match texture {
                None => later().find(|(_, texture)| texture.is_some()).cloned().unwrap_or((step, None)),
                Some(_) => (step, texture),
            };
            steps.push(Stage::Terrain { step: Box::new(step), texture });
        }
        Ok(Self { steps, borrowed })
    }

    /// How many times finer planes become.
    pub fn factor(&self) -> usize {
        self.steps.iter().map(Stage::factor).product()
    }

    /// How many times finer each step makes planes, in their order.
    pub fn factors(&self) -> Vec<usize> {
        self.steps.iter().map(Stage::factor).collect()
    }

    /// Whether texture was to be learned, so that it makes one of many terrains.
    pub fn is_textured(&self) -> bool {
        self.steps.iter().any(|step| matches!(step, Stage::Terrain { .. }))
    }

    /// Steps for whose own scale the exemplars were too small.
    pub fn borrowed_steps(&self) -> usize {
        self.borrowed
    }

    /// Cells at each side of a plane that are needed beyond those that are made finer.
    pub fn reach(&self) -> usize {
        self.margins()[0]
    }

    /// Bytes of memory that the steps take.
    pub fn bytes(&self) -> usize {
        self.steps.iter().map(Stage::len).sum::<usize>() * size_of::<f32>()
    }

    /// Margins before each step and after the last.
    fn margins(&self) -> Vec<usize> {
        let mut margins: Vec<usize> = vec![0];
        for step in self.steps.iter().rev() {
            let after = margins[margins.len() - 1];
            margins.push(after.div_ceil(step.factor()) + step.reach());
        }
        margins.reverse();
        margins
    }

    /// The finer plane of all but [`Cascade::reach`] cells at each side: the best estimate where no texture was learned,
    /// and else one of many, which a seed stands for. `corner` is row and column of the plane's first cell in its raster;
    /// margins may begin before it. The mean of the fine cells of each cell that is `known` is its height, within a 100th
    /// of what bicubic enlargement is off.
    ///
    /// Each fine cell depends on what lies within the reach alone, and comes out the same however planes are cut.
    ///
    /// # Panics
    /// When there is not one value of `known` a cell, or the plane is not larger than its margins.
    pub fn amplified(&self, mut plane: Plane, mut known: Vec<bool>, mut corner: [i64; 2], seed: u64) -> Plane {
        assert_eq!(known.len(), plane.heights_m().len(), "one value a cell");
        let margins = self.margins();
        for (number, step) in self.steps.iter().enumerate() {
            let cols = plane.cols();
            let (reach, factor) = (step.reach(), step.factor());
            let fine = match step {
                Stage::Estimate(network) => network.applied(&plane, &known),
                Stage::Terrain { step, texture } => {
                    let shares = if number == 0 { Shares::FIRST } else { Shares::LATER };
                    let place = Place { corner, seed: Rng::for_part(seed, number as u64).next_u32() };
                    Realistic { step, texture: texture.as_ref(), shares }.applied(&plane, &known, place)
                }
            };
            let mask = enlarged_mask(&trimmed_mask(&known, cols, reach), cols - 2 * reach, factor);
            // A margin may be a little wider than the next step needs.
            let excess = (margins[number] - reach) * factor - margins[number + 1];
            known = trimmed_mask(&mask, fine.cols(), excess);
            plane = fine.trimmed(excess);
            corner = corner.map(|at| (at + reach as i64) * factor as i64 + excess as i64);
        }
        plane
    }
}

/// What exemplars have beyond a step's estimates. The middle of a large one says enough.
fn texture(exemplars: &[Plane], factors: &[usize], number: usize, step: &Step) -> Option<Texture> {
    let cell: usize = factors[number..].iter().product();
    let lessons = exemplars.iter().map(|exemplar| {
        let most = [exemplar.rows(), exemplar.cols()].map(|side| side.min(TEXTURE_SIDE * cell));
        let [row, col] = [(exemplar.rows() - most[0]) / 2, (exemplar.cols() - most[1]) / 2];
        let part = exemplar.part(row, col, most[0], most[1]);
        let mut scales = Scales::of(&part, [0, 0], factors);
        scales.seen = scales.truth(number).0;
        scales.lesson(number)
    });
    Texture::learn(lessons, step)
}

/// All exemplars in all ways.
fn shifted<'a>(exemplars: &'a [Plane], factors: &'a [usize]) -> Vec<Scales<'a>> {
    let factor: usize = factors.iter().product();
    let cells: usize = exemplars.iter().map(|exemplar| exemplar.heights_m().len()).sum();
    let most = (MOST_CELLS / cells.max(1)).clamp(1, SHIFTS.len());
    let mut corners: Vec<[usize; 2]> = vec![];
    for (down, across) in &SHIFTS[..most] {
        let corner = [down, across].map(|part| (part * factor as f64) as usize);
        if !corners.contains(&corner) {
            corners.push(corner);
        }
    }
    let each = |exemplar: &'a Plane| corners.iter().map(move |&corner| Scales::of(exemplar, corner, factors));
    exemplars.iter().flat_map(each).collect()
}

impl<'a> Scales<'a> {
    fn of(exemplar: &'a Plane, corner: [usize; 2], factors: &'a [usize]) -> Self {
        let factor: usize = factors.iter().product();
        let left = |side: usize, corner: usize| side.saturating_sub(corner) / factor;
        let size = [left(exemplar.rows(), corner[0]), left(exemplar.cols(), corner[1])];
        let none = Plane::new(0, 0, vec![]);
        let mut scales = Self { exemplar, corner, size, factors, seen: none };
        scales.seen = scales.truth(0).0;
        scales
    }

    /// True heights after so many steps, and which are known: means with a void are voids.
    fn truth(&self, steps: usize) -> (Plane, Vec<bool>) {
        let all: usize = self.factors.iter().product();
        let [rows, cols] = self.size.map(|side| side * all);
        if rows == 0 || cols == 0 {
            return (Plane::new(0, 0, vec![]), vec![]);
        }
        let cell: usize = self.factors[steps..].iter().product();
        let averaged = self.exemplar.part(self.corner[0], self.corner[1], rows, cols).averaged(cell);
        filled(averaged.rows(), averaged.cols(), averaged.heights_m().to_vec())
    }

    /// What a step learns from.
    fn lesson(&self, number: usize) -> Lesson {
        Lesson { coarse: self.seen.clone(), fine: self.truth(number + 1).0, known: self.truth(number).1 }
    }

    /// Goes on to the next scale: with what the network makes of this one, or with the truth where there is none.
    fn advance(&mut self, number: usize, network: Option<&Network>) {
        let (_, known) = self.truth(number);
        self.seen = match network {
            Some(network) if !known.is_empty() => network.applied_whole(&self.seen, &known),
            _ => self.truth(number + 1).0,
        };
    }
}

/// A mask of finer cells.
fn enlarged_mask(mask: &[bool], cols: usize, factor: usize) -> Vec<bool> {
    let lines = mask.chunks_exact(cols.max(1)).flat_map(|line| std::iter::repeat_n(line, factor));
    lines.flat_map(|line| line.iter().flat_map(|&known| std::iter::repeat_n(known, factor))).collect()
}

fn too_little() -> Error {
    let message = format!(
        "the exemplars teach nothing: fewer than {TOO_FEW} places with relief and without voids around them; take larger \
         ones, or ones that are not flat"
    );
    Error::new(ErrorKind::Input, message)
}
