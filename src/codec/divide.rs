//! Divides a tile into zones: blocks that the same simple prediction fits. Only encoders do this.
//!
//! Some rows stand for all: their cells of the finest passes H and V are predicted from the cross around each, one and
//! three cells away, as those passes do with more taps. Zones are found as k-means finds clusters: fit predictions and
//! the size of their misses to each zone, give every block to the zone that codes it in the fewest bits, and again.

use super::encode::Pyramid;
use super::fit::log2;
use super::plane::Plane;
use super::tile::TileShape;
use super::word::Word;
use super::zones::{BLOCK_BITS, MAX_ZONES, ZONED_FROM, Zones, blocks};

/// Cells of a pass along a block's side.
const LANES: usize = 1 << (BLOCK_BITS - 1);
/// The passes that are looked at: H in even rows, V in odd ones.
const KINDS: usize = 2;
/// Every so-many-th row is looked at; odd, so that rows of both kinds are.
const ROW_STRIDE: usize = 3;
/// The same of a first look, which spares most tiles the second.
const FIRST_STRIDE: usize = 9;
/// How far the cross reaches.
const REACH: usize = 3;
/// Blocks from which on a tile may be worth dividing.
const BLOCKS_FROM: usize = 48;
/// Rounds of fitting and dividing.
const ROUNDS: usize = 3;
/// Bits a cell that zones have to save by the estimate, which is at least twice of what they do save.
const WORTH: f64 = 0.035;
/// Bits that zones have to save beyond that: what their parameters and their map take.
const PRICE: f64 = 6000.0;
/// Cells that a zone must have among those that are looked at.
const CELLS_FROM: usize = 1000;
/// Terms of the prediction: the two directions against each other, and the bend along each.
const TERMS: usize = 3;

/// Rows of a tile: the terms of each cell, what they should add up to, and the step, all in units of the error that
/// the spread of the cross lets expect. Zeros where nothing is known. Rows are filled up to whole blocks.
struct Survey {
    across: usize,
    /// Which rows of the tile, and how far apart.
    rows: Vec<usize>,
    stride: usize,
    terms: [Vec<f32>; TERMS],
    target: Vec<f32>,
    step: Vec<f32>,
}

/// A prediction, and how far it misses in the mean.
#[derive(Clone, Copy, Default)]
struct Model {
    weights: [f32; TERMS],
    miss: f32,
    cells: usize,
}

impl<W: Word> Pyramid<'_, W> {
    /// Zones, where they save enough.
    pub(super) fn divide(&self, step: i64) -> Option<Zones> {
        let (across, down) = blocks(self.shape);
        if across * down < BLOCKS_FROM || across.min(down) < 2 || self.depth() < usize::from(ZONED_FROM) {
            return None;
        }
        let (cells, voids) = self.finest();
        let worth = WORTH + PRICE / self.shape.cells() as f64;
        let look = |stride: usize, rounds: usize, worth: f64| {
            super::vectors::widest(
                #[inline(always)]
                || Survey::new(cells, self.shape, voids, step, stride).divide(self.shape, rounds, worth),
            )
        };
        look(FIRST_STRIDE, 1, 0.6 * worth)?;
        look(ROW_STRIDE, ROUNDS, worth)
    }
}

impl Survey {
    /// Looks at the cells of a tile.
    #[inline(always)]
    fn new<W: Word>(cells: &[W], shape: TileShape, voids: Option<&Plane<u8>>, step: i64, stride: usize) -> Self {
        let width = shape.width;
        let (across, _) = blocks(shape);
        let rows: Vec<usize> = (REACH..shape.height.saturating_sub(REACH)).step_by(stride).collect();
        let size = rows.len() * across * LANES;
        let new = || vec![0.0f32; size];
        let mut survey = Self { across, rows, stride, terms: [new(), new(), new()], target: new(), step: new() };
        let step = step as f32;
        for (index, &row) in survey.rows.iter().enumerate() {
            // The first cell of the kind that the cross fits around, and how many follow: every second one.
            let first = REACH + row % KINDS;
            let count = width.saturating_sub(first + REACH) / 2;
            let place = |down: usize, right: usize| (row + down - REACH) * width + first + right - REACH;
            let run = |down: usize, right: usize| &cells[place(down, right)..].as_chunks::<2>().0[..count];
            let [x, left, right, up, down] = [run(3, 3), run(3, 2), run(3, 4), run(2, 3), run(4, 3)];
            let [left3, right3, up3, down3] = [run(3, 0), run(3, 6), run(0, 3), run(6, 3)];
            let start = index * across * LANES + first / 2;
            let [one, two, three] = &mut survey.terms;
            let (one, two, three) =
                (&mut one[start..][..count], &mut two[start..][..count], &mut three[start..][..count]);
            let (target, steps) = (&mut survey.target[start..][..count], &mut survey.step[start..][..count]);
            for j in 0..count {
                // Differences, so that nothing is lost of large numbers.
                let from = |cell: [W; 2]| cell[0].minus(x[j][0]).wide() as f32;
                let (l, r, u, d) = (from(left[j]), from(right[j]), from(up[j]), from(down[j]));
                let base = (l + r + (u + d)) * 0.25;
                let spread = (l - base).abs() + (r - base).abs() + ((u - base).abs() + (d - base).abs());
                let unit = 1.0 / (0.05 * spread + 0.3 * step);
                one[j] = (l + r - (u + d)) * unit;
                two[j] = (from(left3[j]) + from(right3[j]) - (l + r)) * unit;
                three[j] = (from(up3[j]) + from(down3[j]) - (u + d)) * unit;
                target[j] = -base * unit;
                steps[j] = step * unit;
            }
            if let Some(voids) = voids {
                for (down, right) in [(3, 3), (3, 2), (3, 4), (2, 3), (4, 3), (3, 0), (3, 6), (0, 3), (6, 3)] {
                    let holes = voids.row(row + down - REACH)[first + right - REACH..].iter().step_by(2).take(count);
                    for (j, _) in holes.enumerate().filter(|&(_, &void)| void != 0) {
                        (one[j], two[j], three[j], target[j], steps[j]) = (0.0, 0.0, 0.0, 0.0, 0.0);
                    }
                }
            }
        }
        survey
    }

    /// Number of blocks.
    #[cfg(test)]
    fn blocks(&self) -> usize {
        self.rows.last().map_or(0, |row| ((row >> BLOCK_BITS) + 1) * self.across)
    }

    /// The cells of a row in one block: the block, the kind of cells, and where they are.
    fn runs(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        let across = self.across;
        self.rows.iter().enumerate().flat_map(move |(index, row)| {
            let block = (row >> BLOCK_BITS) * across;
            (0..across).map(move |col| (block + col, row % KINDS, (index * across + col) * LANES))
        })
    }

    /// The numbers of a run.
    #[inline(always)]
    fn run(lane: &[f32], at: usize) -> [f32; LANES] {
        lane[at..at + LANES].try_into().unwrap_or([0.0; LANES])
    }

    /// What a prediction misses the cells of a run by, and their steps.
    #[inline(always)]
    fn misses(&self, at: usize, weights: &[f32; TERMS]) -> ([f32; LANES], [f32; LANES]) {
        let [one, two, three] = self.terms.each_ref().map(|term| Self::run(term, at));
        let target = Self::run(&self.target, at);
        let mut miss = [0.0; LANES];
        for j in 0..LANES {
            miss[j] = (target[j] - one[j] * weights[0] - (two[j] * weights[1] + three[j] * weights[2])).abs();
        }
        (miss, Self::run(&self.step, at))
    }

    /// The best models of each zone, one for each kind of cells.
    #[inline(always)]
    fn fit(&self, of: &[u8], count: usize) -> Vec<[Model; KINDS]> {
        // Products of the terms with each other, the lower triangle, then with the target.
        let mut sums = vec![[[0.0f64; 9]; KINDS]; count];
        let mut models = vec![[Model::default(); KINDS]; count];
        for (block, kind, at) in self.runs() {
            let zone = usize::from(of[block]);
            let [one, two, three] = self.terms.each_ref().map(|term| Self::run(term, at));
            let target = Self::run(&self.target, at);
            let pairs = [
                (&one, &one),
                (&two, &one),
                (&two, &two),
                (&three, &one),
                (&three, &two),
                (&three, &three),
                (&one, &target),
                (&two, &target),
                (&three, &target),
            ];
            for (sum, (a, b)) in sums[zone][kind].iter_mut().zip(pairs) {
                let mut lanes = [0.0f32; 8];
                for (a, b) in a.as_chunks::<8>().0.iter().zip(b.as_chunks::<8>().0) {
                    for j in 0..8 {
                        lanes[j] += a[j] * b[j];
                    }
                }
                *sum += f64::from(lanes.iter().sum::<f32>());
            }
            models[zone][kind].cells += Self::run(&self.step, at).iter().filter(|&&step| step > 0.0).count();
        }
        for (model, sums) in models.iter_mut().flatten().zip(sums.iter().flatten()) {
            model.weights = solve(sums);
        }
        let mut misses = vec![[0.0f64; KINDS]; count];
        for (block, kind, at) in self.runs() {
            let zone = usize::from(of[block]);
            let (miss, _) = self.misses(at, &models[zone][kind].weights);
            misses[zone][kind] += f64::from(miss.iter().sum::<f32>());
        }
        for (model, miss) in models.iter_mut().flatten().zip(misses.iter().flatten()) {
            model.miss = (miss / model.cells.max(1) as f64) as f32;
        }
        models
    }

    /// Bits that each block takes with a zone's models, up to a constant.
    #[inline(always)]
    fn bits(&self, models: &[Model; KINDS], blocks: usize) -> Vec<f64> {
        let mut bits = vec![0.0; blocks];
        for (block, kind, at) in self.runs() {
            let model = &models[kind];
            let (miss, step) = self.misses(at, &model.weights);
            let mut lanes = [0.0f32; 8];
            for (miss, step) in miss.as_chunks::<8>().0.iter().zip(step.as_chunks::<8>().0) {
                for j in 0..8 {
                    let expected = model.miss + 0.05 * step[j];
                    let cost = log2(expected) + std::f32::consts::LOG2_E * miss[j] / expected;
                    lanes[j] += if step[j] > 0.0 { cost } else { 0.0 };
                }
            }
            bits[block] += f64::from(lanes.iter().sum::<f32>());
        }
        bits
    }

    /// How badly models do in each block: the mean logarithm of its misses.
    #[inline(always)]
    fn roughness(&self, models: &[Model; KINDS], blocks: usize) -> Vec<f64> {
        let (mut sums, mut counts) = (vec![0.0; blocks], vec![0usize; blocks]);
        for (block, kind, at) in self.runs() {
            let (miss, step) = self.misses(at, &models[kind].weights);
            for (miss, &step) in miss.iter().zip(&step).filter(|&(_, &step)| step > 0.0) {
                sums[block] += f64::from(log2(miss + 0.3 * step));
                counts[block] += 1;
            }
        }
        sums.iter().zip(counts).map(|(sum, count)| if count == 0 { 0.0 } else { sum / count as f64 }).collect()
    }

    /// Zones after so many rounds, where they save so many bits a cell.
    #[inline(always)]
    fn divide(&self, shape: TileShape, rounds: usize, worth: f64) -> Option<Zones> {
        let (across, down) = blocks(shape);
        let all = across * down;
        let whole = self.fit(&vec![0; all], 1)[0];
        let cells = |models: &[Model; KINDS]| models.iter().map(|model| model.cells).sum::<usize>();
        let least = CELLS_FROM * ROW_STRIDE / self.stride;
        if cells(&whole) < MAX_ZONES * least {
            return None;
        }
        let undivided: f64 = self.bits(&whole, all).iter().sum();
        // At first by how well the prediction does.
        let roughness = self.roughness(&whole, all);
        let mut order: Vec<usize> = (0..all).collect();
        order.sort_by(|&a, &b| roughness[a].total_cmp(&roughness[b]).then(a.cmp(&b)));
        let mut of = vec![0u8; all];
        for (place, &block) in order.iter().enumerate() {
            of[block] = (place * MAX_ZONES / all) as u8;
        }
        let mut saved = 0.0;
        for _ in 0..rounds {
            let models = self.fit(&of, MAX_ZONES);
            let bits: Vec<_> = models
                .iter()
                .map(|model| if cells(model) < least { vec![f64::INFINITY; all] } else { self.bits(model, all) })
                .collect();
            let mut left = undivided;
            for (block, zone) in of.iter_mut().enumerate() {
                *zone = (0..MAX_ZONES).min_by(|&a, &b| bits[a][block].total_cmp(&bits[b][block])).unwrap_or(0) as u8;
                left -= bits[usize::from(*zone)][block];
            }
            saved = left / cells(&whole) as f64;
        }
        if saved < worth {
            return None;
        }
        // Zones that nothing is left of have no number.
        let mut numbers = [None; MAX_ZONES];
        let mut count = 0;
        for zone in &mut of {
            let number = numbers[usize::from(*zone)].get_or_insert_with(|| {
                count += 1;
                count - 1
            });
            *zone = *number;
        }
        (count > 1).then(|| Zones::new(shape, usize::from(count), of))
    }
}

/// The weights that the sums of products give.
fn solve(sums: &[f64; 9]) -> [f32; TERMS] {
    let mut matrix = [[sums[0], 0.0, 0.0], [sums[1], sums[2], 0.0], [sums[3], sums[4], sums[5]]];
    let ridge = 1e-5 * (sums[0] + sums[2] + sums[5]) / 3.0 + 1e-9;
    for (k, row) in matrix.iter_mut().enumerate() {
        row[k] += ridge;
    }
    super::fit::solve(&mut matrix, &[sums[6], sums[7], sums[8]], TERMS).map(|weight| weight as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Waves of two directions, each in squares of 64 cells, or of one; with a little noise.
    fn waves(width: usize, height: usize, kinds: usize) -> Vec<i64> {
        let mut noise = 1u32;
        let mut cell = |index: usize| {
            let (row, col) = (index / width, index % width);
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let wave = if (row / 64 + col / 64) % kinds == 0 { row * 37 + col * 90 } else { row * 90 + col * 11 };
            (wave % 256) as i64 * 4 + i64::from(noise >> 30)
        };
        (0..width * height).map(&mut cell).collect()
    }

    fn divided(width: usize, height: usize, kinds: usize) -> Option<Zones> {
        let shape = TileShape { width, height };
        let levels = super::super::level::levels(shape);
        Pyramid::<i32>::new(&waves(width, height, kinds), shape, levels, &[]).divide(1)
    }

    #[test]
    fn kinds_of_ground_become_zones() {
        let zones = divided(320, 310, 2).expect("is worth dividing");
        let seen = zones.at_level(0).expect("the finest level has zones");
        // Blocks of different ground never share a zone.
        let kind = |row: usize, col: usize| (row / 32 + col / 32) % 2;
        let mut kinds = vec![None; zones.count];
        for (row, col) in (0..155).flat_map(|row| (0..160).map(move |col| (row, col))) {
            assert_eq!(*kinds[seen.of(row, col)].get_or_insert(kind(row, col)), kind(row, col), "{row} {col}");
        }
    }

    #[test]
    fn one_kind_of_ground_stays_whole() {
        assert_eq!(divided(320, 290, 1), None);
        assert_eq!(divided(192, 128, 2), None, "a tile of few blocks");
        for (width, height) in [(3, 4096), (4096, 3), (31, 2000), (2000, 7)] {
            assert_eq!(divided(width, height, 2), None, "a thin tile");
        }
    }

    /// Cell by cell, in double precision.
    #[test]
    fn models_miss_as_they_say() {
        let (width, height) = (150, 101);
        let shape = TileShape { width, height };
        let cells: Vec<i32> = waves(width, height, 2).iter().map(|&x| x as i32).collect();
        let survey = Survey::new(&cells, shape, None, 1, ROW_STRIDE);
        let models = survey.fit(&vec![0; survey.blocks()], 1)[0];
        let at = |row: usize, col: usize| f64::from(cells[row * width + col]);
        for (kind, model) in models.iter().enumerate() {
            let (mut sum, mut count) = (0.0, 0);
            for row in (REACH..height - REACH).step_by(ROW_STRIDE).filter(|row| row % 2 == kind) {
                // The last cells of a row are left out.
                for col in (REACH + kind..width - REACH - 1).step_by(2).filter(|col| col + 4 < width) {
                    let (l, r, u, d) = (at(row, col - 1), at(row, col + 1), at(row - 1, col), at(row + 1, col));
                    let base = (l + r + u + d) / 4.0;
                    let spread = [l, r, u, d].iter().map(|near| (near - base).abs()).sum::<f64>() / 4.0;
                    let terms = [
                        l + r - u - d,
                        at(row, col - 3) + at(row, col + 3) - l - r,
                        at(row - 3, col) + at(row + 3, col) - u - d,
                    ];
                    let share: f64 =
                        terms.iter().zip(model.weights).map(|(term, weight)| term * f64::from(weight)).sum();
                    sum += (at(row, col) - base - share).abs() / (0.2 * spread + 0.3);
                    count += 1;
                }
            }
            assert_eq!(count, model.cells);
            let mean = sum / f64::from(count as u32);
            assert!((f64::from(model.miss) - mean).abs() < 1e-3 * mean, "{} is not {mean}", model.miss);
        }
    }
}
