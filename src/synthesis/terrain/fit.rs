//! Slopes and plains chosen so that the terrain is as steep, and as high, as a real range.

use super::ground::Ground;
use super::likeness::{Likeness, QUANTILES};
use super::raise::{Frame, TerrainOptions, raise_on};
use super::skeleton::{Skeleton, Spot};
use crate::error::Result;
use crate::watch::Watch;

/// What may be chosen, beside the depth of plains where the ground is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Free {
    /// Whether the slope is.
    pub slope: bool,
    /// Whether the roughness is.
    pub roughness: bool,
    /// Whether the curvature is.
    pub curvature: bool,
}

/// Rows and columns of the part of the terrain on which options are tried.
const WINDOW: usize = 1100;
/// Options are tried on cells not larger than this share of those on which slopes are compared.
const SHARE: f64 = 0.7;
/// A difference of so many degrees of slope counts as much ...
const SLOPE: f64 = 1.5;
/// ... as one of so many metres of mean elevation.
const MEAN_M: f64 = 60.0;
/// How often the direction of improvement is looked for, and how far one goes to see it.
const ROUNDS: usize = 3;
const PROBE: f64 = 0.15;
/// Steps tried from the full one on, and how much shorter each is than the one before.
const STEPS: usize = 3;
const SHORTER: f64 = 0.35;
/// No step makes a number smaller or larger than by these shares.
const SHRINK: f64 = -0.4;
const GROW: f64 = 0.7;

/// Options with the slope, the roughness, the curvature and, where the ground is known, the depth of plains with which
/// the terrain comes out most like a range.
///
/// Gauss and Newton's method, damped, on differences between quantiles of slope, and of elevation above the mean around. Terrain is tried on its middle, and on larger cells where slopes are compared on such; once it is looked at on
/// its own cells, and by how much it is different there is taken into account from then on.
///
/// # Errors
/// As [`raise`](super::raise()).
pub fn fit(
    skeleton: &Skeleton,
    options: &TerrainOptions,
    free: Free,
    like: &Likeness,
    watch: &Watch,
) -> Result<TerrainOptions> {
    skeleton.check()?;
    let Some(steep) = like.slopes.get(3 * QUANTILES / 4).map(|slope| slope.to_radians().tan()) else {
        return Ok(options.clone());
    };
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1, and no larger than a cell")]
    let step = (SHARE * like.cell_m / skeleton.cell_m[0].max(skeleton.cell_m[1])).max(1.0) as usize;
    let window = WINDOW * step;
    let slope = if free.slope { 0.8 * steep } else { options.slope };
    let curvature = if free.curvature { 0.002 * slope } else { options.curvature };
    let mut shape = Shape { slope, depth: options.depth, roughness: options.roughness, curvature };
    let choice: Vec<usize> = [free.slope, options.ground.is_some(), free.roughness, free.curvature]
        .iter()
        .enumerate()
        .filter_map(|(number, is_free)| is_free.then_some(number))
        .collect();
    let coarse = middle(skeleton, options.ground.as_ref(), window, step);
    let coarse = Trials::of(&coarse, options, like, watch);
    watch.begin("choosing slopes", 2 * (ROUNDS * (choice.len() + 1) + 1) as u64);
    let mut apart;
    (shape, apart) = coarse.descend(shape, &choice, &[])?;
    if step > 1 {
        let fine = middle(skeleton, options.ground.as_ref(), window, 1);
        let there = Trials::of(&fine, options, like, watch).apart(shape)?;
        apart.iter_mut().zip(&there).for_each(|(here, there)| *here = there - *here);
        (shape, _) = coarse.descend(shape, &choice, &apart)?;
    }
    Ok(shape.on(options))
}

/// A part of the terrain on which options are tried.
struct Trials<'a> {
    frame: Frame<'a>,
    ground: Option<&'a Ground>,
    options: &'a TerrainOptions,
    like: &'a Likeness,
    watch: &'a Watch,
}

impl<'a> Trials<'a> {
    fn of(
        (part, ground): &'a (Skeleton, Option<Ground>),
        options: &'a TerrainOptions,
        like: &'a Likeness,
        watch: &'a Watch,
    ) -> Self {
        Self { frame: Frame::of(part), ground: ground.as_ref(), options, like, watch }
    }

    /// What is different from the range, and from the ground.
    fn apart(&self, shape: Shape) -> Result<Vec<f64>> {
        let options = TerrainOptions { ground: self.ground.cloned(), ..shape.on(self.options) };
        let relief = raise_on(&self.frame, &options, &|| self.watch.check())?;
        self.watch.advance(1)?;
        let own = self.like.same(&relief);
        let mut apart = differences(&own.slopes, &self.like.slopes, SLOPE);
        apart.extend(differences(&own.reliefs_m, &self.like.reliefs_m, MEAN_M));
        if let Some(ground) = self.ground {
            let mean = |z_m: &[f32]| z_m.iter().map(|&z| f64::from(z)).sum::<f64>() / z_m.len() as f64;
            apart.push(softened((mean(relief.z_m()) - mean(&ground.z_m)) / MEAN_M));
        }
        Ok(apart)
    }

    /// Goes on from a shape to where the least is different, `offset` being added to the differences; returns those
    /// without it, too.
    fn descend(&self, mut best: Shape, choice: &[usize], offset: &[f64]) -> Result<(Shape, Vec<f64>)> {
        let squares = |apart: &[f64]| -> f64 {
            let offset = offset.iter().chain(std::iter::repeat(&0.0));
            apart.iter().zip(offset).map(|(apart, offset)| (apart + offset).powi(2)).sum()
        };
        let mut apart = self.apart(best)?;
        for _ in 0..ROUNDS {
            let mut slopes = vec![];
            for &number in choice {
                let probed = self.apart(best.changed(number, PROBE))?;
                slopes
                    .push(probed.iter().zip(&apart).map(|(there, here)| (there - here) / PROBE).collect::<Vec<f64>>());
            }
            let values: Vec<f64> =
                apart.iter().zip(offset.iter().chain(std::iter::repeat(&0.0))).map(|(a, b)| a + b).collect();
            let step = newton(&slopes, &values);
            let mut length = 1.0;
            let mut found = None;
            for _ in 0..STEPS {
                let change = |shape: Shape, (&number, change): (&usize, &f64)| {
                    shape.changed(number, (change * length).clamp(SHRINK, GROW))
                };
                let tried = choice.iter().zip(&step).fold(best, change);
                let there = self.apart(tried)?;
                if squares(&there) < squares(&apart) {
                    found = Some((tried, there));
                    break;
                }
                length *= SHORTER;
            }
            let Some(better) = found else { break };
            (best, apart) = better;
        }
        Ok((best, apart))
    }
}

/// What is chosen.
#[derive(Clone, Copy)]
struct Shape {
    slope: f64,
    depth: f64,
    roughness: f64,
    curvature: f64,
}

impl Shape {
    /// One of the numbers made larger by a share of it.
    fn changed(mut self, number: usize, share: f64) -> Self {
        let (value, least, most) = match number {
            0 => (&mut self.slope, 0.01, 3.0),
            1 => (&mut self.depth, 0.1, 2.0),
            2 => (&mut self.roughness, 0.02, 1.0),
            _ => (&mut self.curvature, 1e-5, 1e-2),
        };
        *value = (*value * (1.0 + share)).clamp(least, most);
        self
    }

    /// The options with this shape, rounded: the last bits of a tangent may differ from machine to machine.
    fn on(self, options: &TerrainOptions) -> TerrainOptions {
        let rounded = |value: f64, parts: f64| (value * parts).round() / parts;
        TerrainOptions {
            slope: rounded(self.slope, 1e3),
            depth: rounded(self.depth, 1e3),
            roughness: rounded(self.roughness, 1e3),
            curvature: rounded(self.curvature, 1e6),
            ..options.clone()
        }
    }
}

/// Differences as shares of a unit, all of them together counting as one.
fn differences(own: &[f64], wanted: &[f64], unit: f64) -> Vec<f64> {
    let part = 1.0 / (own.len().max(1) as f64).sqrt();
    own.iter().zip(wanted).map(|(own, wanted)| softened((own - wanted) / unit) * part).collect()
}

/// A number whose square grows less and less steeply, so that a few large differences do not outweigh many small ones.
fn softened(value: f64) -> f64 {
    value / (1.0 + value.abs()).sqrt()
}

/// How much damping there is.
const DAMPING: f64 = 0.01;

/// The step to where the sum of squares of linear functions is least, damped; `slopes` are those of all functions along
/// each direction, `values` theirs here.
fn newton(slopes: &[Vec<f64>], values: &[f64]) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let count = slopes.len();
    let mut rows: Vec<Vec<f64>> = (0..count)
        .map(|i| {
            let mut row: Vec<f64> = slopes.iter().map(|other| dot(&slopes[i], other)).collect();
            row[i] += DAMPING * (row[i] + 1.0);
            row.push(-dot(&slopes[i], values));
            row
        })
        .collect();
    // Positive definite, so elimination needs no exchange of rows.
    for i in 0..count {
        for j in i + 1..count {
            let (above, below) = rows.split_at_mut(j);
            let times = below[0][i] / above[i][i];
            below[0].iter_mut().zip(&above[i]).skip(i).for_each(|(own, other)| *own -= times * other);
        }
    }
    let mut step = vec![0.0; count];
    for i in (0..count).rev() {
        let known: f64 = (i + 1..count).map(|j| rows[i][j] * step[j]).sum();
        step[i] = (rows[i][count] - known) / rows[i][i];
    }
    step
}

/// The middle of a skeleton and of its ground, at most `window` rows and columns, on cells `step` times as wide and high.
fn middle(skeleton: &Skeleton, ground: Option<&Ground>, window: usize, step: usize) -> (Skeleton, Option<Ground>) {
    let fine = skeleton.size.map(|count| count.min(window));
    let size = fine.map(|count| count.div_ceil(step));
    let first = [0, 1].map(|k| (skeleton.size[k] - fine[k]) / 2);
    let ground = ground.map(|ground| ground.part(skeleton.size, first, fine));
    // Ridges that leave the window end there: a peak or saddle outside of it is none.
    let moved = |spots: &[Spot]| -> (Vec<Spot>, Vec<Option<u32>>) {
        let mut kept = vec![];
        let numbers = spots.iter().map(|spot| {
            let (row, col) = (spot.row.checked_sub(first[0])?, spot.col.checked_sub(first[1])?);
            (row < fine[0] && col < fine[1]).then(|| {
                kept.push(Spot { row: row / step, col: col / step, ..*spot });
                kept.len() as u32 - 1
            })
        });
        let numbers = numbers.collect();
        (kept, numbers)
    };
    let (peaks, peak_numbers) = moved(&skeleton.peaks);
    let (saddles, saddle_numbers) = moved(&skeleton.saddles);
    let mut ridges = skeleton.ridges.clone();
    ridges.retain_mut(|ridge| {
        let numbers = saddle_numbers[ridge.saddle as usize].zip(peak_numbers[ridge.peak as usize]);
        if let Some((saddle, peak)) = numbers {
            (ridge.saddle, ridge.peak) = (saddle, peak);
            let coarse = |at: f64, first: usize| (at - first as f64 + 0.5) / step as f64 - 0.5;
            for point in &mut ridge.points {
                *point = [coarse(point[0], first[1]), coarse(point[1], first[0])];
            }
        }
        numbers.is_some()
    });
    let cell_m = skeleton.cell_m.map(|side| side * step as f64);
    (Skeleton { size, cell_m, peaks, saddles, ridges }, ground)
}

#[cfg(test)]
mod tests {
    use super::super::skeleton::RidgeLine;
    use super::*;

    #[test]
    fn a_linear_problem_is_solved_in_one_step() {
        // Residuals a·x + b with the least squares at x = (2, -1), up to the damping.
        let slopes = [vec![30.0, 0.0, 10.0], vec![0.0, 50.0, 20.0]];
        let at = |x: f64, y: f64| -> Vec<f64> { (0..3).map(|i| slopes[0][i] * x + slopes[1][i] * y).collect() };
        let values: Vec<f64> = at(-2.0, 1.0);
        let step = newton(&slopes, &values);
        assert!((step[0] - 2.0).abs() < 0.05 && (step[1] + 1.0).abs() < 0.05, "{step:?}");
        let there: Vec<f64> = values.iter().zip(at(step[0], step[1])).map(|(a, b)| a + b).collect();
        let squares = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>();
        assert!(squares(&there) < 1e-3 * squares(&values));
    }

    #[test]
    fn the_middle_on_larger_cells() {
        let spot = |row, col| Spot { row, col, elevation_m: 100.0 };
        let skeleton = Skeleton {
            size: [9, 8],
            cell_m: [10.0, 20.0],
            peaks: vec![spot(8, 0), spot(3, 5)],
            saddles: vec![Spot { elevation_m: 50.0, ..spot(4, 4) }],
            ridges: vec![RidgeLine { saddle: 0, peak: 1, points: vec![[4.0, 4.0], [5.5, 3.5]] }],
        };
        let (part, ground) = middle(&skeleton, None, 100, 2);
        assert!(ground.is_none());
        assert_eq!((part.size, part.cell_m), ([5, 4], [20.0, 40.0]));
        assert_eq!([(part.peaks[0].row, part.peaks[0].col), (part.peaks[1].row, part.peaks[1].col)], [(4, 0), (1, 2)]);
        assert_eq!(part.ridges[0].points, [[1.75, 1.75], [2.5, 1.5]]);
        assert_eq!(middle(&skeleton, None, 100, 1).0, skeleton);
    }
}
