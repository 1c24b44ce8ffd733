//! Slopes and plains chosen so that the terrain is as steep, and as high, as a real range.

use super::form::{Form, FormMap};
use super::ground::Ground;
use super::likeness::{Likeness, QUANTILES};
use super::raise::{Frame, TerrainOptions, raise_on};
use super::skeleton::{Skeleton, Spot};
use crate::erosion::Relief;
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

/// Options with the slopes, the roughnesses, the curvatures and, where the ground is known, the depths of plains with which
/// the terrain comes out most like some ranges: each form where it is like the range of its number in `likes`. Forms without
/// a range stay as they are.
///
/// Gauss and Newton's method, damped, on differences between quantiles of slope, and of elevation above the mean around.
/// Terrain is tried on its middle, and on larger cells where slopes are compared on such; once it is looked at on
/// its own cells, and by how much it is different there is taken into account from then on. What one form does to the ground
/// of another is taken for nothing, so that all are tried at once.
///
/// # Errors
/// As [`raise`](super::raise()).
///
/// # Panics
/// As [`raise`](super::raise()); when there is not one entry a form.
pub fn fit(
    skeleton: &Skeleton,
    options: &TerrainOptions,
    free: Free,
    likes: &[Option<&Likeness>],
    watch: &Watch,
) -> Result<TerrainOptions> {
    skeleton.check()?;
    assert_eq!(options.forms.len(), likes.len(), "one entry a form");
    let likes: Vec<Option<&Likeness>> = likes.iter().map(|like| like.filter(|like| !like.slopes.is_empty())).collect();
    let Some(least_m) = likes.iter().flatten().map(|like| like.cell_m).reduce(f64::min) else {
        return Ok(options.clone());
    };
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1, and no larger than a cell")]
    let step = (SHARE * least_m / skeleton.cell_m[0].max(skeleton.cell_m[1])).max(1.0) as usize;
    let window = WINDOW * step;
    let begun = |(form, like): (&Form, &Option<&Likeness>)| {
        let Some(like) = like else { return *form };
        let steep = like.slopes[3 * QUANTILES / 4].to_radians().tan();
        let slope = if free.slope { 0.8 * steep } else { form.slope };
        let curvature = if free.curvature { 0.002 * slope } else { form.curvature };
        Form { slope, curvature, ..*form }
    };
    let mut forms: Vec<Form> = options.forms.iter().zip(&likes).map(begun).collect();
    let choice: Vec<usize> = [free.slope, options.ground.is_some(), free.roughness, free.curvature]
        .iter()
        .enumerate()
        .filter_map(|(number, is_free)| is_free.then_some(number))
        .collect();
    let coarse = Part::middle(skeleton, options, window, step);
    let coarse = Trials::of(&coarse, options, &likes, watch);
    watch.begin("choosing slopes", 2 * (ROUNDS * (choice.len() + 1) + 1) as u64);
    let mut apart;
    (forms, apart) = coarse.descend(forms, &choice, &vec![vec![]; likes.len()])?;
    if step > 1 {
        let fine = Part::middle(skeleton, options, window, 1);
        let there = Trials::of(&fine, options, &likes, watch).apart(&forms)?;
        for (apart, there) in apart.iter_mut().zip(&there) {
            apart.iter_mut().zip(there).for_each(|(here, there)| *here = there - *here);
        }
        (forms, _) = coarse.descend(forms, &choice, &apart)?;
    }
    Ok(with(forms, options))
}

/// A part of the terrain on which options are tried.
struct Trials<'a> {
    frame: Frame<'a>,
    part: &'a Part,
    options: &'a TerrainOptions,
    likes: &'a [Option<&'a Likeness>],
    watch: &'a Watch,
}

impl<'a> Trials<'a> {
    fn of(part: &'a Part, options: &'a TerrainOptions, likes: &'a [Option<&'a Likeness>], watch: &'a Watch) -> Self {
        Self { frame: Frame::of(&part.skeleton), part, options, likes, watch }
    }

    /// What is different from each range, and from the ground there; nothing where there is no such range.
    fn apart(&self, forms: &[Form]) -> Result<Vec<Vec<f64>>> {
        let Part { ground, form_map, .. } = self.part;
        let options = with(forms.to_vec(), self.options);
        let options = TerrainOptions { ground: ground.clone(), form_map: form_map.clone(), ..options };
        let relief = raise_on(&self.frame, &options, &|| self.watch.check())?;
        self.watch.advance(1)?;
        Ok((0..forms.len()).map(|form| self.apart_from(form, &relief)).collect())
    }

    fn apart_from(&self, form: usize, relief: &Relief) -> Vec<f64> {
        let (Some(like), Part { ground, form_map, .. }) = (self.likes[form], self.part) else { return vec![] };
        let size = [relief.rows(), relief.cols()];
        let is_own =
            |cell: usize| form_map.as_ref().is_none_or(|map| map.at([cell / size[1], cell % size[1]], size) == form);
        let own_m: Option<Vec<f32>> = form_map.as_ref().map(|_| {
            relief.z_m().iter().enumerate().map(|(cell, &z)| if is_own(cell) { z } else { f32::NAN }).collect()
        });
        let z_m = own_m.as_deref().unwrap_or(relief.z_m());
        let own = Likeness::of(z_m, size, relief.cell_m().map(f64::from), like.cell_m);
        let mut apart = differences(&own.slopes, &like.slopes, SLOPE);
        apart.extend(differences(&own.reliefs_m, &like.reliefs_m, MEAN_M));
        if let Some(ground) = ground {
            let mean = |z_m: &[f32]| {
                let known = z_m.iter().filter(|z| !z.is_nan());
                known.clone().map(|&z| f64::from(z)).sum::<f64>() / known.count().max(1) as f64
            };
            let own_ground = |(block, &z): (usize, &f32)| {
                let at = [block / ground.size[1], block % ground.size[1]];
                let is_own = form_map.as_ref().is_none_or(|map| map.at(at, ground.size) == form);
                is_own.then_some(z)
            };
            let own_ground: Vec<f32> = ground.z_m.iter().enumerate().filter_map(own_ground).collect();
            let off_m = if own_ground.is_empty() { 0.0 } else { mean(z_m) - mean(&own_ground) };
            apart.push(softened(off_m / MEAN_M));
        }
        apart
    }

    /// Goes on from forms to where the least is different, `offsets` being added to the differences; returns those
    /// without them, too.
    fn descend(
        &self,
        mut best: Vec<Form>,
        choice: &[usize],
        offsets: &[Vec<f64>],
    ) -> Result<(Vec<Form>, Vec<Vec<f64>>)> {
        let added = |form: usize, apart: &[f64]| -> Vec<f64> {
            let offset = offsets[form].iter().chain(std::iter::repeat(&0.0));
            apart.iter().zip(offset).map(|(apart, offset)| apart + offset).collect()
        };
        let squares = |form: usize, apart: &[f64]| added(form, apart).iter().map(|apart| apart.powi(2)).sum::<f64>();
        let mut apart = self.apart(&best)?;
        // Forms that come closer still.
        let mut moving: Vec<usize> = (0..best.len()).filter(|&form| !apart[form].is_empty()).collect();
        for _ in 0..ROUNDS {
            if moving.is_empty() {
                break;
            }
            let mut slopes: Vec<Vec<Vec<f64>>> = vec![vec![]; best.len()];
            for &number in choice {
                let mut probed = best.clone();
                moving.iter().for_each(|&form| probed[form] = changed(probed[form], number, PROBE));
                for (slopes, (there, here)) in slopes.iter_mut().zip(self.apart(&probed)?.iter().zip(&apart)) {
                    slopes.push(there.iter().zip(here).map(|(there, here)| (there - here) / PROBE).collect());
                }
            }
            let step = |&form: &usize| newton(&slopes[form], &added(form, &apart[form]));
            let steps: Vec<Vec<f64>> = moving.iter().map(step).collect();
            let mut length = 1.0;
            let mut better: Vec<Option<Vec<f64>>> = vec![None; moving.len()];
            let mut tried = best.clone();
            for _ in 0..STEPS {
                for ((&form, step), _) in moving.iter().zip(&steps).zip(&better).filter(|(_, better)| better.is_none())
                {
                    let change = |own: Form, (&number, change): (&usize, &f64)| {
                        changed(own, number, (change * length).clamp(SHRINK, GROW))
                    };
                    tried[form] = choice.iter().zip(step).fold(best[form], change);
                }
                let there = self.apart(&tried)?;
                for (&form, better) in moving.iter().zip(&mut better).filter(|(_, better)| better.is_none()) {
                    if squares(form, &there[form]) < squares(form, &apart[form]) {
                        *better = Some(there[form].clone());
                    }
                }
                if better.iter().all(Option::is_some) {
                    break;
                }
                length *= SHORTER;
            }
            let found = moving.iter().zip(better).filter_map(|(&form, better)| Some((form, better?)));
            moving = found
                .map(|(form, better)| {
                    (best[form], apart[form]) = (tried[form], better);
                    form
                })
                .collect();
        }
        Ok((best, apart))
    }
}

/// A form with one of its numbers made larger by a share of it.
fn changed(mut form: Form, number: usize, share: f64) -> Form {
    let (value, least, most) = match number {
        0 => (&mut form.slope, 0.01, 3.0),
        1 => (&mut form.depth, 0.1, 2.0),
        2 => (&mut form.roughness, 0.02, 1.0),
        _ => (&mut form.curvature, 1e-5, 1e-2),
    };
    *value = (*value * (1.0 + share)).clamp(least, most);
    form
}

/// The options with these forms, rounded: the last bits of a tangent may differ from machine to machine.
fn with(forms: Vec<Form>, options: &TerrainOptions) -> TerrainOptions {
    let rounded = |value: f64, parts: f64| (value * parts).round() / parts;
    let round = |form: Form| Form {
        slope: rounded(form.slope, 1e3),
        depth: rounded(form.depth, 1e3),
        roughness: rounded(form.roughness, 1e3),
        curvature: rounded(form.curvature, 1e6),
    };
    TerrainOptions { forms: forms.into_iter().map(round).collect(), ..options.clone() }
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

/// A part of the terrain, maybe on larger cells.
struct Part {
    skeleton: Skeleton,
    ground: Option<Ground>,
    form_map: Option<FormMap>,
}

impl Part {
    /// The middle of a skeleton and of what options say of places, at most `window` rows and columns, on cells `step` times
    /// as wide and high.
    fn middle(skeleton: &Skeleton, options: &TerrainOptions, window: usize, step: usize) -> Self {
        let size = skeleton.size.map(|count| count.min(window));
        let first = [0, 1].map(|k| (skeleton.size[k] - size[k]) / 2);
        Self {
            skeleton: window_of(skeleton, first, size, step),
            ground: options.ground.as_ref().map(|ground| ground.part(skeleton.size, first, size)),
            form_map: options.form_map.as_ref().map(|map| map.part(skeleton.size, first, size)),
        }
    }
}

/// A window of a skeleton: from a row and a column, of so many rows and columns, on cells `step` times as wide and high.
fn window_of(skeleton: &Skeleton, first: [usize; 2], fine: [usize; 2], step: usize) -> Skeleton {
    let size = fine.map(|count| count.div_ceil(step));
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
    Skeleton { size, cell_m, peaks, saddles, ridges }
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
        let middle = |step: usize| Part::middle(&skeleton, &TerrainOptions::default(), 100, step);
        let Part { skeleton: part, ground, form_map } = middle(2);
        assert!(ground.is_none() && form_map.is_none());
        assert_eq!((part.size, part.cell_m), ([5, 4], [20.0, 40.0]));
        assert_eq!([(part.peaks[0].row, part.peaks[0].col), (part.peaks[1].row, part.peaks[1].col)], [(4, 0), (1, 2)]);
        assert_eq!(part.ridges[0].points, [[1.75, 1.75], [2.5, 1.5]]);
        assert_eq!(middle(1).skeleton, skeleton);
    }
}
