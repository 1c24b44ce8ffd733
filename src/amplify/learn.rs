//! Learns a step from terrain that is known coarse and fine (A+: Timofte, De Smet, Van Gool 2014,
//! doi:10.1007/978-3-319-16817-3_8): near each anchor, the heights of fine cells above the bicubic ones as a linear
//! function of the patch's features.

use super::anchors::{ANCHORS, Anchors};
use super::bicubic::{Bicubic, MARGIN};
use super::features::{DIMS, Features, INPUTS, Patches};
use super::network::Network;
use super::orientation::Ways;
use super::plane::Plane;
use super::step::{Estimator, HALF, Step, detail_side};
use crate::error::Result;
use crate::linalg::{Gram, solve};
use crate::rng::Rng;
use crate::watch::Watch;
use rayon::prelude::*;

/// Coarse cells at an exemplar's edges in which no patch has its middle.
const BORDER: usize = 5;
/// Patches that are learned from at most, and values of them.
const MOST_PATCHES: usize = 1 << 19;
const MOST_VALUES: usize = 1 << 25;
/// Patches that are too few to learn from.
pub(super) const TOO_FEW: usize = 500;
/// The least patches, of the nearest anchors, that an anchor's regression is learned from.
const POOL: u64 = 4096;
/// What is added to the diagonal of the regression's matrix, in parts of its mean.
const RIDGE: f64 = 1e-3;
/// Patches without more relief than this, in metres, teach nothing.
const FLAT_M: f32 = 1e-3;

/// Terrain that is known at two scales.
pub(super) struct Lesson {
    /// The coarse heights, as the step will see them.
    pub(super) coarse: Plane,
    /// The true fine heights: the factor times as many rows and columns.
    pub(super) fine: Plane,
    /// Which coarse cells have data.
    pub(super) known: Vec<bool>,
}

/// A patch, and what its fine cells have above the bicubic ones; both in standing position.
struct Samples {
    patches: Vec<f32>,
    details: Vec<f32>,
    /// Fine cells of a patch.
    cells: usize,
}

/// Where lessons come from, one at a time, so that not all of them take memory at once.
pub(super) struct Lessons<'a> {
    /// How many there are.
    pub(super) count: usize,
    /// Makes one of them.
    pub(super) make: &'a dyn Fn(usize) -> Lesson,
}

/// What a step makes its estimates by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum By {
    Regressions,
    /// Where exemplars have room for what it sees; else by regressions.
    Network,
}

/// Learns a step; nothing where there are too few patches with any relief. Equal seeds give equal steps, with any
/// number of threads.
///
/// # Errors
/// When the job is cancelled.
pub(super) fn learn(
    lessons: &Lessons<'_>,
    factor: usize,
    is_square: bool,
    by: By,
    seed: u64,
    watch: &Watch,
) -> Result<Option<Step>> {
    let samples = Samples::draw(lessons, factor, is_square, seed);
    watch.check()?;
    if samples.len() < TOO_FEW {
        return Ok(None);
    }
    let features = Features::learn(&samples.patches);
    let found: Vec<[f32; DIMS]> =
        samples.patches.par_chunks(INPUTS).map(|patch| features.of(&std::array::from_fn(|i| patch[i]))).collect();
    let units: Vec<[f32; DIMS]> = found.par_iter().map(unit).collect();
    let anchors = Anchors::learn(&units);
    watch.check()?;
    let network = match by {
        By::Network => Network::learn(lessons, factor, is_square, seed, watch)?,
        By::Regressions => None,
    };
    let estimator = match network {
        Some(network) => Estimator::Network(network),
        None => Estimator::Regressions(regressors(&found, &units, &anchors, &samples, watch)?),
    };
    Ok(Some(Step { factor, is_square, features, anchors, estimator }))
}

/// The regressions of all anchors, from features of all samples, and the same with length 1.
fn regressors(
    found: &[[f32; DIMS]],
    units: &[[f32; DIMS]],
    anchors: &Anchors,
    samples: &Samples,
    watch: &Watch,
) -> Result<Vec<f32>> {
    let mut followers = vec![vec![]; ANCHORS];
    let nearest: Vec<usize> = units.par_iter().map(|unit| anchors.of(unit)).collect();
    nearest.iter().enumerate().for_each(|(sample, &anchor)| followers[anchor].push(sample));
    let sums: Vec<Normal> = followers.par_iter().map(|own| Normal::of(own, found, samples)).collect();
    watch.check()?;
    let vectors: Vec<[f32; DIMS]> = (0..ANCHORS).map(|anchor| anchors.vector(anchor)).collect();
    let solved: Vec<Vec<f32>> = (0..ANCHORS).into_par_iter().map(|own| pooled(own, &vectors, &sums)).collect();
    Ok(solved.concat())
}

impl Samples {
    fn len(&self) -> usize {
        self.details.len() / self.cells
    }

    /// Patches of all lessons, drawn where there are too many.
    fn draw(lessons: &Lessons<'_>, factor: usize, is_square: bool, seed: u64) -> Self {
        let side = detail_side(factor);
        let cells = side * side;
        let mut places: Vec<Place> = vec![];
        for number in 0..lessons.count {
            let at = |(row, col): (usize, usize)| Place { number: number as u32, row: row as u32, col: col as u32 };
            places.extend((lessons.make)(number).places().map(at));
        }
        // No order is left that anchors could begin from.
        Rng::new(seed).shuffle(&mut places);
        places.truncate(MOST_PATCHES.min(MOST_VALUES / cells));
        let mut samples =
            Self { patches: vec![0.0; places.len() * INPUTS], details: vec![0.0; places.len() * cells], cells };
        let ways = Ways::new(side);
        for number in 0..lessons.count {
            let lesson = (lessons.make)(number);
            let residual = lesson.residual(factor);
            let patches = Patches::new(&lesson.coarse, is_square);
            let offsets = ways.offsets(residual.cols());
            let all = places
                .par_iter()
                .zip(samples.patches.par_chunks_mut(INPUTS))
                .zip(samples.details.par_chunks_mut(cells));
            all.filter(|((place, _), _)| place.number as usize == number).for_each(|((place, patch), detail)| {
                let (row, col) = (place.row as usize, place.col as usize);
                let mut own = [0.0; INPUTS];
                let way = patches.take(row, col, &mut own);
                patch.copy_from_slice(&own);
                // The residual begins with the coarse cells after the margin.
                let corner = (row - HALF - MARGIN) * factor * residual.cols() + (col - HALF - MARGIN) * factor;
                let square = &residual.heights_m()[corner..];
                detail.iter_mut().zip(offsets.of(way)).for_each(|(height, &cell)| *height = square[cell] as f32);
            });
        }
        samples.drop_flat();
        samples
    }

    /// Leaves patches out that have no relief.
    fn drop_flat(&mut self) {
        let cells = self.cells;
        let mut kept = 0;
        for sample in 0..self.len() {
            let patch = sample * INPUTS..(sample + 1) * INPUTS;
            if self.patches[patch.clone()].iter().any(|height| height.abs() >= FLAT_M) {
                self.patches.copy_within(patch, kept * INPUTS);
                self.details.copy_within(sample * cells..(sample + 1) * cells, kept * cells);
                kept += 1;
            }
        }
        self.patches.truncate(kept * INPUTS);
        self.details.truncate(kept * cells);
    }
}

/// The middle of a patch.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// Number of the lesson.
    number: u32,
    row: u32,
    col: u32,
}

impl Lesson {
    /// Middles of patches with data all around.
    pub(super) fn places(&self) -> impl Iterator<Item = (usize, usize)> {
        let (rows, cols) = (self.coarse.rows(), self.coarse.cols());
        let range = |side: usize| BORDER..side.saturating_sub(BORDER).max(BORDER);
        let is_known = move |row: usize, col: usize| {
            let mut lines = (row - BORDER + 1..row + BORDER).map(|row| &self.known[row * cols..][..cols]);
            lines.all(|line| line[col - BORDER + 1..col + BORDER].iter().all(|&known| known))
        };
        let all = range(rows).flat_map(move |row| range(cols).map(move |col| (row, col)));
        all.filter(move |&(row, col)| is_known(row, col))
    }

    /// What a step makes of the coarse heights.
    pub(super) fn estimated(&self, step: &Step) -> Plane {
        step.applied_whole(&self.coarse, &self.known)
    }

    /// What the fine heights have above the bicubic ones, without the cells at the edges.
    fn residual(&self, factor: usize) -> Plane {
        if self.coarse.rows() <= 2 * MARGIN || self.coarse.cols() <= 2 * MARGIN {
            return Plane::new(0, 0, vec![]);
        }
        let mut residual = self.fine.trimmed(MARGIN * factor);
        let base = Bicubic::new(factor).enlarged(&self.coarse);
        residual.heights_mut().iter_mut().zip(base.heights_m()).for_each(|(height, base)| *height -= base);
        residual
    }
}

/// Features with length 1.
fn unit(features: &[f32; DIMS]) -> [f32; DIMS] {
    let length = features.iter().map(|&v| f64::from(v) * f64::from(v)).sum::<f64>().sqrt().max(1e-30);
    features.map(|v| (f64::from(v) / length) as f32)
}

/// The two sums of a regression: features with features, and features with fine heights.
struct Normal {
    count: u64,
    gram: Gram,
    cross: Vec<f64>,
}

impl Normal {
    /// Of some samples. Squares of their errors count by one over the features' length: between a count by relief, which
    /// the steepest would rule, and one that is blind to it.
    fn of(own: &[usize], features: &[[f32; DIMS]], samples: &Samples) -> Self {
        let cells = samples.cells;
        let mut normal = Self { count: own.len() as u64, gram: Gram::new(DIMS), cross: vec![0.0; DIMS * cells] };
        for &sample in own {
            let z = features[sample].map(f64::from);
            let length = z.iter().map(|v| v * v).sum::<f64>().sqrt().max(1e-30);
            let root = length.sqrt();
            let z = z.map(|v| v / root);
            normal.gram.add(&z);
            let detail = &samples.details[sample * cells..][..cells];
            let heights: Vec<f64> = detail.iter().map(|&height| f64::from(height) / root).collect();
            for (sums, feature) in normal.cross.chunks_exact_mut(cells).zip(z) {
                sums.iter_mut().zip(&heights).for_each(|(sum, height)| *sum += feature * height);
            }
        }
        normal
    }
}

/// The regression of an anchor, from as many of the nearest anchors' samples as it takes.
fn pooled(own: usize, vectors: &[[f32; DIMS]], sums: &[Normal]) -> Vec<f32> {
    let nearness = |other: usize| crate::linalg::dot(&vectors[own], &vectors[other]);
    let mut order: Vec<(f64, usize)> = (0..ANCHORS).map(|other| (nearness(other), other)).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut gram = Gram::new(DIMS);
    let mut cross = vec![0.0; sums[own].cross.len()];
    let mut count = 0;
    for (_, other) in order {
        gram.join(&sums[other].gram);
        cross.iter_mut().zip(&sums[other].cross).for_each(|(sum, other)| *sum += other);
        count += sums[other].count;
        if count >= POOL {
            break;
        }
    }
    let mut matrix = gram.finish();
    let trace: f64 = (0..DIMS).map(|i| matrix[i * (DIMS + 1)]).sum();
    (0..DIMS).for_each(|i| matrix[i * (DIMS + 1)] += RIDGE * trace / DIMS as f64 + f64::MIN_POSITIVE);
    if !solve(matrix, DIMS, &mut cross) {
        // Bicubic heights then.
        cross.fill(0.0);
    }
    cross.iter().map(|&v| v as f32).collect()
}
