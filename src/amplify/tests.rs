//! Slow and plain versions of what steps do, in double precision; and what has to hold of all of it.

use super::anchors::BRANCHES;
use super::back_projection::BackProjection;
use super::extend::{extended, extended_mask};
use super::features::{DIMS, INPUTS, Patches, RADIUS, SIDE};
use super::learn::{By, Lesson, Lessons, learn};
use super::step::{ESTIMATE_MARGIN, Estimator, STEP_REACH, Step, Taken};
use super::texture::{Place, Texture};
use super::{Bicubic, Cascade, Plane};
use crate::rng::Rng;
use crate::watch::Watch;

/// Hills with ridges and noise, in metres.
fn hills(rows: usize, cols: usize, seed: u64) -> Plane {
    let mut rng = Rng::new(seed);
    let waves: Vec<[f64; 4]> = (0..12)
        .map(|k| {
            let scale = 0.02 * 1.4f64.powi(k);
            [(rng.unit() - 0.5) * scale * 6.0, (rng.unit() - 0.5) * scale * 6.0, rng.unit() * 6.3, 1.0 / scale]
        })
        .collect();
    let height = |row: usize, col: usize| {
        waves.iter().map(|[x, y, p, a]| a * (1.0 - (x * col as f64 + y * row as f64 + p).sin().abs())).sum::<f64>()
    };
    let heights = (0..rows * cols).map(|i| height(i / cols, i % cols) + 0.05 * rng.unit()).collect();
    Plane::new(rows, cols, heights)
}

/// All of a plane, with margins.
fn whole(plane: &Plane, margin: usize) -> (Plane, Vec<bool>) {
    let size = [plane.rows(), plane.cols()];
    let m = margin as i64;
    let wanted = [-m, -m, size[0] as i64 + 2 * m, size[1] as i64 + 2 * m];
    let known = vec![true; plane.heights_m().len()];
    (extended(plane, [0, 0], size, wanted), extended_mask(&known, size[1], [0, 0], size, wanted))
}

fn amplified(cascade: &Cascade, plane: &Plane) -> Plane {
    seeded(cascade, plane, 5)
}

fn seeded(cascade: &Cascade, plane: &Plane, seed: u64) -> Plane {
    let (plane, known) = whole(plane, cascade.reach());
    let corner = [-(cascade.reach() as i64); 2];
    cascade.amplified(plane, known, corner, seed)
}

/// A cascade for estimates, and one for terrain.
fn both(exemplar: &Plane, factor: usize) -> [Cascade; 2] {
    let exemplars = std::slice::from_ref(exemplar);
    let watch = Watch::default();
    [
        Cascade::learn(exemplars, factor, true, 1, &watch).unwrap(),
        Cascade::learn_textured(exemplars, factor, true, &watch).unwrap(),
    ]
}

fn step(factor: usize, is_square: bool, fine: &Plane) -> Step {
    taught(&fine.averaged(factor), fine, factor, is_square)
}

fn taught(coarse: &Plane, fine: &Plane, factor: usize, is_square: bool) -> Step {
    let known = vec![true; coarse.heights_m().len()];
    let make = |_: usize| Lesson { fine: fine.clone(), coarse: coarse.clone(), known: known.clone() };
    let lessons = Lessons { count: 1, make: &make };
    learn(&lessons, factor, is_square, By::Regressions, 1, &Watch::default()).unwrap().expect("enough to learn from")
}

/// Cells of a turned square of a side: row and column of each in the square as it lies.
fn turned(side: usize, mirror_cols: bool, mirror_rows: bool, transpose: bool) -> Vec<(usize, usize)> {
    let mut square: Vec<Vec<(usize, usize)>> = (0..side).map(|r| (0..side).map(|c| (r, c)).collect()).collect();
    if mirror_cols {
        square.iter_mut().for_each(|line| line.reverse());
    }
    if mirror_rows {
        square.reverse();
    }
    if transpose {
        square = (0..side).map(|r| (0..side).map(|c| square[c][r]).collect()).collect();
    }
    square.concat()
}

fn regressors(step: &Step) -> &[f32] {
    let Estimator::Regressions(regressors) = &step.estimator else { panic!("it was learned by regressions") };
    regressors
}

/// A step by its definition: all sums in double precision, cell by cell.
fn slowly(step: &Step, coarse: &Plane) -> Plane {
    let (factor, side) = (step.factor, 3 * step.factor);
    let margin = RADIUS + 1;
    let base = Bicubic::new(factor).enlarged(coarse).trimmed((margin - 2) * factor);
    let mut sums = vec![0.0; base.heights_m().len()];
    for row in RADIUS..coarse.rows() - RADIUS {
        for col in RADIUS..coarse.cols() - RADIUS {
            let at = |r: usize, c: usize| coarse.row(row + r - RADIUS)[col + c - RADIUS];
            let near = RADIUS - 1..RADIUS + 2;
            let rise = near.clone().map(|i| at(i, RADIUS + 1) - at(i, RADIUS - 1)).sum::<f64>();
            let fall = near.map(|i| at(RADIUS + 1, i) - at(RADIUS - 1, i)).sum::<f64>();
            let ways = (rise < 0.0, fall < 0.0, step.is_square && fall.abs() > rise.abs());
            let cells = turned(SIDE, ways.0, ways.1, ways.2);
            let patch: Vec<f64> = cells
                .iter()
                .filter(|&&place| place != (RADIUS, RADIUS))
                .map(|&(r, c)| at(r, c) - at(RADIUS, RADIUS))
                .collect();
            let mut unit = [0.0f32; INPUTS];
            unit.iter_mut().zip(&patch).for_each(|(unit, &height)| *unit = height as f32);
            // Columns of the features' matrix, one height of 1 at a time.
            let column = |i: usize| step.features.of(&std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
            let columns: Vec<[f32; DIMS]> = (0..INPUTS).map(column).collect();
            let features: Vec<f64> =
                (0..DIMS).map(|k| patch.iter().zip(&columns).map(|(h, c)| h * f64::from(c[k])).sum()).collect();
            let product = |anchor: usize| -> f64 {
                step.anchors.vector(anchor).iter().zip(&features).map(|(a, f)| f64::from(*a) * f).sum()
            };
            // The tree settles which anchors are compared.
            let anchor = step.anchors.of(&std::array::from_fn(|k| features[k] as f32));
            let siblings = anchor / BRANCHES * BRANCHES..(anchor / BRANCHES + 1) * BRANCHES;
            let best = siblings.map(product).fold(f64::NEG_INFINITY, f64::max);
            assert!(product(anchor) >= best - 1e-4 * best.abs(), "the nearest of the branch");
            let matrix = &regressors(step)[anchor * DIMS * side * side..][..DIMS * side * side];
            for (i, &(r, c)) in turned(side, ways.0, ways.1, ways.2).iter().enumerate() {
                let height: f64 = (0..DIMS).map(|k| features[k] * f64::from(matrix[k * side * side + i])).sum();
                let fine = [(row - 1) * factor + r, (col - 1) * factor + c];
                if fine.iter().all(|&at| at >= margin * factor) {
                    let [r, c] = fine.map(|at| at - margin * factor);
                    if r < base.rows() && c < base.cols() {
                        sums[r * base.cols() + c] += height / 9.0;
                    }
                }
            }
        }
    }
    let heights = base.heights_m().iter().zip(&sums).map(|(base, sum)| base + sum).collect();
    let fine = Plane::new(base.rows(), base.cols(), heights);
    let within = coarse.trimmed(margin);
    let all = vec![true; within.heights_m().len()];
    BackProjection::new(factor).corrected(&fine, &within, &all).trimmed((ESTIMATE_MARGIN - margin) * factor)
}

#[test]
fn steps_are_what_they_are_defined_to_be() {
    let fine = hills(180, 180, 3);
    for (factor, is_square) in [(2, true), (2, false), (3, true), (5, true)] {
        let step = step(factor, is_square, &fine);
        let (coarse, known) = whole(&hills(9, 12, 8), STEP_REACH);
        let (quick, slow) = (step.applied(&coarse, &known), slowly(&step, &coarse));
        assert_eq!((quick.rows(), quick.cols()), (9 * factor, 12 * factor));
        for (a, b) in quick.heights_m().iter().zip(slow.heights_m()) {
            assert!((a - b).abs() < 1e-3, "factor {factor}: {a} and {b}");
        }
    }
}

/// Without noise and with one regression all over, what a fine plane has above bicubic heights is found again.
#[test]
fn a_linear_law_is_learned() {
    let factor = 2;
    let coarse = hills(70, 70, 5);
    // The law: fine cells are bicubic ones plus a fixed linear function of the cells around, alike in all directions.
    let mut fine = Bicubic::new(factor).enlarged(&whole(&coarse, 2).0);
    let cols = fine.cols();
    for row in 4..fine.rows() - 4 {
        for col in 4..cols - 4 {
            let (r, c) = (row / factor, col / factor);
            let around = coarse.row(r - 1)[c] + coarse.row(r + 1)[c] + coarse.row(r)[c - 1] + coarse.row(r)[c + 1];
            fine.heights_mut()[row * cols + col] += 0.3 * (around / 4.0 - coarse.row(r)[c]);
        }
    }
    let step = taught(&coarse, &fine, factor, true);
    // Without the correction, which knows nothing of the law.
    let patches = Patches::new(&coarse, true);
    let mut patch = [0.0; INPUTS];
    let (mut error, mut size) = (0.0, 0.0);
    for row in 8..60 {
        for col in 8..60 {
            patches.take(row, col, &mut patch);
            let features = step.features.of(&patch);
            let matrix = &regressors(&step)[step.anchors.of(&features) * DIMS * 36..][..DIMS * 36];
            // The middle cells have the same law whatever the way.
            let found: f64 = (0..DIMS).map(|k| f64::from(features[k]) * f64::from(matrix[k * 36 + 14])).sum();
            let around = coarse.row(row - 1)[col]
                + coarse.row(row + 1)[col]
                + coarse.row(row)[col - 1]
                + coarse.row(row)[col + 1];
            let law = 0.3 * (around / 4.0 - coarse.row(row)[col]);
            error += (found - law).powi(2);
            size += law * law;
        }
    }
    assert!(error < 0.01 * size, "{error} of {size}");
}

#[test]
fn planes_may_be_cut_anywhere() {
    for (cascade, seed) in both(&hills(160, 150, 2), 4).into_iter().zip([0, 5]) {
        let plane = hills(40, 31, 9);
        let all = seeded(&cascade, &plane, seed);
        assert_eq!((all.rows(), all.cols()), (160, 124));
        let reach = cascade.reach();
        let (wide, known) = whole(&plane, reach);
        for (row, col, rows, cols) in [(0, 0, 7, 31), (7, 3, 1, 1), (39, 30, 1, 1), (13, 11, 20, 9)] {
            let part = wide.part(row, col, rows + 2 * reach, cols + 2 * reach);
            let lines = known.chunks(wide.cols()).skip(row).take(part.rows());
            let mask = lines.flat_map(|line| line[col..col + part.cols()].iter().copied()).collect();
            let corner = [row, col].map(|at| at as i64 - reach as i64);
            let own = cascade.amplified(part, mask, corner, seed);
            assert_eq!(own, all.part(row * 4, col * 4, rows * 4, cols * 4), "{row} {col}");
        }
    }
}

#[test]
fn turned_terrain_becomes_turned_finer_terrain() {
    let cascade = Cascade::learn(&[hills(160, 150, 2)], 4, true, 1, &Watch::default()).unwrap();
    let plane = hills(24, 24, 9);
    // By a quarter.
    let turn = |plane: &Plane| {
        let cells = (0..plane.cols()).flat_map(|row| (0..plane.rows()).rev().map(move |col| plane.row(col)[row]));
        Plane::new(plane.cols(), plane.rows(), cells.collect())
    };
    let (upright, turned) = (amplified(&cascade, &plane), amplified(&cascade, &turn(&plane)));
    for (a, b) in turn(&upright).heights_m().iter().zip(turned.heights_m()) {
        assert!((a - b).abs() < 1e-3, "{a} and {b}");
    }
}

#[test]
fn means_are_kept_at_all_factors() {
    let exemplar = hills(260, 250, 2);
    let watch = Watch::default();
    let plain = [2, 3, 4, 7, 8, 10, 32]
        .map(|factor| (factor, Cascade::learn(std::slice::from_ref(&exemplar), factor, true, 1, &watch).unwrap()));
    let textured = [3, 10, 32].map(|factor| {
        (factor, Cascade::learn_textured(std::slice::from_ref(&exemplar), factor, true, &watch).unwrap())
    });
    for (factor, cascade) in plain.into_iter().chain(textured) {
        assert_eq!(cascade.factor(), factor);
        assert_eq!(cascade.borrowed_steps() > 0, factor > 10, "{factor}: 250 cells hold few of so many");
        for (rows, cols) in [(1, 1), (1, 9), (12, 10)] {
            let plane = hills(rows, cols, 4);
            let fine = amplified(&cascade, &plane);
            assert_eq!((fine.rows(), fine.cols()), (rows * factor, cols * factor));
            for (mean, height) in fine.averaged(factor).heights_m().iter().zip(plane.heights_m()) {
                assert!((mean - height).abs() < 0.01, "factor {factor}: {mean} of {height}");
            }
        }
    }
}

/// With half of the patches each fine cell is the mean of those that speak of it.
#[test]
fn half_of_the_patches_say_about_the_same() {
    let fine = hills(180, 180, 3);
    let step = step(2, true, &fine);
    let coarse = hills(30, 31, 8);
    let [all, even, odd] = [Taken::All, Taken::Even, Taken::Odd].map(|taken| step.estimated(&coarse, 1.0, taken));
    let bicubic = Bicubic::new(2).enlarged(&coarse).trimmed((ESTIMATE_MARGIN - 2) * 2);
    let squares =
        |a: &Plane, b: &Plane| -> f64 { a.heights_m().iter().zip(b.heights_m()).map(|(a, b)| (a - b).powi(2)).sum() };
    for half in [&even, &odd] {
        assert!(squares(half, &all) < 0.1 * squares(&bicubic, &all));
    }
    // A cell takes five of one half and four of the other.
    for (cell, &mean) in all.heights_m().iter().enumerate() {
        let (row, col) = (cell / all.cols() / 2, cell % all.cols() / 2);
        let [five, four] = if (row + col) % 2 == 0 { [&even, &odd] } else { [&odd, &even] };
        let known = (5.0 * five.heights_m()[cell] + 4.0 * four.heights_m()[cell]) / 9.0;
        assert!((mean - known).abs() < 1e-4, "{mean} and {known}");
    }
}

#[test]
fn more_is_known_than_bicubic_does() {
    // Of one range, the north teaches what the south is like.
    let range = hills(420, 240, 2);
    let cascade = Cascade::learn(&[range.part(0, 0, 300, 240)], 4, true, 1, &Watch::default()).unwrap();
    let truth = range.part(300, 0, 120, 240);
    let coarse = truth.averaged(4);
    let bicubic = Bicubic::new(4).enlarged(&whole(&coarse, 2).0);
    let error =
        |plane: &Plane| -> f64 { plane.heights_m().iter().zip(truth.heights_m()).map(|(a, b)| (a - b).powi(2)).sum() };
    let (found, known) = (error(&amplified(&cascade, &coarse)), error(&bicubic));
    assert!(found < 0.9 * known, "{found} and {known}");
}

#[test]
fn threads_make_no_difference() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| both(&hills(150, 170, 2), 4).map(|cascade| amplified(&cascade, &hills(10, 10, 3))))
    };
    assert_eq!(with(1), with(3));
}

/// How much a plane has above its bicubic means, in square metres.
fn detail(plane: &Plane, factor: usize) -> f64 {
    let bicubic = Bicubic::new(factor).enlarged(&whole(&plane.averaged(factor), 2).0);
    let squares = plane.heights_m().iter().zip(bicubic.heights_m()).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>() / plane.heights_m().len() as f64
}

#[test]
fn each_seed_draws_terrain_of_its_own_as_rough_as_the_truth() {
    // Noise cannot be estimated, so all of it has to come from texture.
    let mut range = hills(420, 240, 2);
    let mut rng = Rng::new(4);
    range.heights_mut().iter_mut().for_each(|height| *height += 3.0 * rng.unit());
    let [estimate, terrain] = both(&range.part(0, 0, 300, 240), 4);
    let truth = range.part(300, 0, 120, 240);
    let coarse = truth.averaged(4);
    let [known, smooth] = [detail(&truth, 4), detail(&amplified(&estimate, &coarse), 4)];
    let drawn = [1, 2, 1].map(|seed| seeded(&terrain, &coarse, seed));
    assert_eq!(drawn[0], drawn[2]);
    let different = drawn[0].heights_m().iter().zip(drawn[1].heights_m()).filter(|(a, b)| a != b).count();
    assert!(different > truth.heights_m().len() * 9 / 10, "{different} cells differ");
    for drawn in drawn {
        let found = detail(&drawn, 4);
        assert!((found / known - 1.0).abs() < 0.25 && smooth < 0.8 * found, "{smooth}, {found} of {known} m2");
    }
}

/// A texture by its definition: for each fine cell all samples that cover it.
#[test]
fn textures_are_what_they_are_defined_to_be() {
    let mut fine = hills(240, 240, 3);
    let mut rng = Rng::new(4);
    fine.heights_mut().iter_mut().for_each(|height| *height += rng.unit());
    for factor in [2, 3] {
        let step = step(factor, true, &fine);
        let coarse = fine.averaged(factor);
        let known = vec![true; coarse.heights_m().len()];
        let lesson = Lesson { fine: fine.clone(), coarse, known };
        let texture = Texture::learn([lesson].into_iter(), &step).expect("enough to learn from");
        let coarse = hills(21, 26, 9);
        let place = Place { corner: [-4, 100], seed: 7 };
        let quick = texture.drawn(&coarse, &step, place);
        let slow = texture.drawn_slowly(&coarse, &step, place);
        assert_eq!((quick.rows(), quick.cols()), ((21 - 12) * factor, (26 - 12) * factor));
        for (a, b) in quick.heights_m().iter().zip(slow.heights_m()) {
            assert!((a - b).abs() < 1e-4 * (1.0 + b.abs()), "factor {factor}: {a} and {b}");
        }
    }
}

#[test]
fn narrow_exemplars_teach_steps_without_texture() {
    let watch = Watch::default();
    let narrow = hills(24, 1200, 2);
    let cascade = Cascade::learn_textured(&[narrow, hills(5, 5, 3)], 2, true, &watch).unwrap();
    let coarse = hills(9, 9, 4);
    assert_eq!(seeded(&cascade, &coarse, 1), seeded(&cascade, &coarse, 2));
}

#[test]
fn water_stays_level() {
    let [_, terrain] = both(&hills(160, 150, 2), 4);
    let mut coarse = hills(30, 30, 9);
    for row in 0..30 {
        coarse.heights_mut()[row * 30..row * 30 + 12].fill(-8.25);
    }
    let fine = amplified(&terrain, &coarse);
    for row in 0..120 {
        assert_eq!(fine.row(row)[..44], [-8.25; 44], "row {row}");
    }
}

#[test]
fn what_teaches_nothing_is_refused() {
    let watch = Watch::default();
    let flat = Plane::new(200, 200, vec![7.0; 40_000]);
    let void = Plane::new(200, 200, vec![f64::NAN; 40_000]);
    for plane in [flat, void, hills(20, 20, 1), hills(3, 900, 1)] {
        for result in [
            Cascade::learn(std::slice::from_ref(&plane), 2, true, 1, &watch),
            Cascade::learn_textured(std::slice::from_ref(&plane), 2, true, &watch),
        ] {
            let error = result.unwrap_err();
            assert!(error.message().contains("teach nothing"), "{error}");
        }
    }
    for factor in [0, 1, 11, 26, 257, 512] {
        let error = Cascade::learn(&[hills(200, 200, 1)], factor, true, 1, &watch).unwrap_err();
        assert!(error.message().contains("a product of 2, 3, 5 and 7"), "{error}");
    }
    watch.cancel();
    assert!(Cascade::learn(&[hills(200, 200, 1)], 2, true, 1, &watch).is_err());
}
