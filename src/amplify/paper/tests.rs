//! The definition, patch by patch and pair by pair in double precision; and what has to hold of all of it.

use super::super::extend::extended;
use super::*;
use crate::error::ErrorKind;
use crate::rng::Rng;
use proptest::prelude::*;

/// Waves with noise, in metres.
fn hills(rows: usize, cols: usize, seed: u64) -> Plane {
    let mut rng = Rng::new(seed);
    let waves: Vec<[f64; 3]> = (0..9)
        .map(|k| {
            let scale = 0.03 * 1.5f64.powi(k);
            [(rng.unit() - 0.5) * scale * 6.0, (rng.unit() - 0.5) * scale * 6.0, 3.0 / scale]
        })
        .collect();
    let height =
        |row: f64, col: f64| waves.iter().map(|[x, y, a]| a * (1.0 - (x * col + y * row).sin().abs())).sum::<f64>();
    let cell = |i: usize| height((i / cols) as f64, (i % cols) as f64) + rng.unit();
    // Exemplars are kept in single precision.
    Plane::new(rows, cols, (0..rows * cols).map(cell).map(|height| f64::from(height as f32)).collect())
}

fn whole(plane: &Plane, margin: usize) -> Plane {
    let (size, m) = ([plane.rows(), plane.cols()], margin as i64);
    extended(plane, [0, 0], size, [-m, -m, size[0] as i64 + 2 * m, size[1] as i64 + 2 * m])
}

fn amplified(paper: &Paper, plane: &Plane) -> Plane {
    paper.amplified(whole(plane, paper.reach()), [-(paper.reach() as i64); 2])
}

fn learned(exemplars: &[Plane], factor: usize, model: &PatchModel) -> Paper {
    Paper::learn(exemplars.to_vec(), factor, model, &Watch::default()).unwrap()
}

/// The weighting function at the middle of a cell of a patch.
fn weight(side: usize, row: usize, col: usize) -> f64 {
    let radius = side as f64 / 2.0;
    let [x, y] = [col, row].map(|at| (at as f64 + 0.5 - radius) / radius);
    (1.0 - x * x - y * y).max(0.0).powi(3)
}

fn product(side: usize, a: &[f64], b: &[f64]) -> f64 {
    (0..side * side).map(|k| weight(side, k / side, k % side) * a[k] * b[k]).sum()
}

/// A patch above its mean, and the mean.
fn centred(side: usize, patch: &[f64]) -> (Vec<f64>, f64) {
    let ones = vec![1.0; side * side];
    let mean = product(side, patch, &ones) / product(side, &ones, &ones);
    (patch.iter().map(|v| v - mean).collect(), mean)
}

/// Coefficients that leave the least of a patch, by elimination in the normal equations; and what they leave, squared.
fn fitted(side: usize, patch: &[f64], atoms: &[&Vec<f64>]) -> (Vec<f64>, f64) {
    let n = atoms.len();
    let mut rows: Vec<Vec<f64>> = atoms
        .iter()
        .map(|a| atoms.iter().map(|b| product(side, a, b)).chain([product(side, a, patch)]).collect())
        .collect();
    for i in 0..n {
        for j in 0..n {
            if i != j {
                let part = rows[j][i] / rows[i][i];
                (0..=n).for_each(|k| rows[j][k] -= part * rows[i][k]);
            }
        }
    }
    let parts: Vec<f64> = (0..n).map(|i| rows[i][n] / rows[i][i]).collect();
    let rest: Vec<f64> =
        (0..side * side).map(|k| patch[k] - atoms.iter().zip(&parts).map(|(a, x)| a[k] * x).sum::<f64>()).collect();
    (parts, product(side, &rest, &rest))
}

/// Paper 001, section 5.3: all pairs, all patches, all cells.
fn defined(exemplars: &[Plane], plane: &Plane, factor: usize, model: &PatchModel) -> Plane {
    let side = model.side;
    let fine = side * factor;
    let (mut low, mut high) = (vec![], vec![]);
    let places = |cells: usize, stride: usize| (0..cells).step_by(stride).filter(|at| at + fine <= cells).count();
    let all = |stride: usize| -> usize {
        exemplars.iter().map(|plane| places(plane.rows(), stride) * places(plane.cols(), stride)).sum()
    };
    let stride = (1..).find(|&stride| all(stride) <= model.patches.unwrap()).unwrap();
    for exemplar in exemplars {
        for row in (0..=exemplar.rows().saturating_sub(fine)).step_by(stride) {
            for col in (0..=exemplar.cols() - fine).step_by(stride) {
                let patch = exemplar.part(row, col, fine, fine);
                if patch.heights_m().iter().all(|height| !height.is_nan()) {
                    let (wide, mean) = centred(side, patch.averaged(factor).heights_m());
                    let norm = product(side, &wide, &wide).sqrt();
                    low.push(wide.iter().map(|v| v / norm).collect::<Vec<f64>>());
                    high.push(patch.heights_m().iter().map(|v| (v - mean) / norm).collect::<Vec<f64>>());
                }
            }
        }
    }
    let step = model.step.unwrap_or(side / 2) as i64;
    let around = whole(plane, 3 * side);
    let starts = |cells: usize| {
        (-9..99)
            .map(|k| k * step + (step - side as i64).div_euclid(2))
            .filter(move |&at| at > -(side as i64) && at < cells as i64)
    };
    let [rows, cols] = [plane.rows(), plane.cols()].map(|cells| cells * factor);
    let (mut sums, mut weights) = (vec![0.0; rows * cols], vec![0.0; rows * cols]);
    for top in starts(plane.rows()) {
        for left in starts(plane.cols()) {
            let inside = |at: i64| (at + 3 * side as i64) as usize;
            let (patch, mean) = centred(side, around.part(inside(top), inside(left), side, side).heights_m());
            let mut taken: Vec<usize> = vec![];
            let mut parts = vec![];
            for _ in 0..model.sparsity {
                let mut best = f64::INFINITY;
                let before = taken.clone();
                for k in (0..low.len()).filter(|k| !before.contains(k)) {
                    let mut atoms: Vec<&Vec<f64>> = before.iter().map(|&k| &low[k]).collect();
                    atoms.push(&low[k]);
                    let (found, rest) = fitted(side, &patch, &atoms);
                    if rest < best && (model.signed || found[0] > 0.0) {
                        best = rest;
                        taken = [before.clone(), vec![k]].concat();
                        parts = found;
                    }
                }
            }
            for (k, (down, across)) in (0..fine * fine).map(|k| (k / fine, k % fine)).enumerate() {
                let (row, col) = (top * factor as i64 + down as i64, left * factor as i64 + across as i64);
                if (0..rows as i64).contains(&row) && (0..cols as i64).contains(&col) {
                    let at = row as usize * cols + col as usize;
                    let weight = weight(fine, down, across);
                    let detail: f64 = taken.iter().zip(&parts).map(|(&atom, part)| part * high[atom][k]).sum();
                    sums[at] += weight * (mean + detail);
                    weights[at] += weight;
                }
            }
        }
    }
    Plane::new(rows, cols, sums.iter().zip(&weights).map(|(sum, weight)| sum / weight).collect())
}

fn difference(a: &Plane, b: &Plane) -> f64 {
    assert_eq!((a.rows(), a.cols()), (b.rows(), b.cols()));
    a.heights_m().iter().zip(b.heights_m()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Heights of some hundred metres, atoms in single precision: a millimetre.
#[test]
fn it_is_the_definition() {
    let mut first = hills(41, 38, 3);
    first.heights_mut()[20 * 38 + 30] = f64::NAN;
    let exemplars = [first, hills(30, 29, 4), Plane::new(2, 3, vec![1.0; 6])];
    let usual = PatchModel { patches: Some(150), ..PatchModel::default() };
    let with = |side, step, sparsity, signed| PatchModel { side, step, sparsity, signed, ..usual.clone() };
    for (factor, model) in [
        (2, with(8, None, 1, true)),
        (4, with(4, None, 1, true)),
        (3, with(5, Some(3), 1, true)),
        (3, with(4, Some(1), 1, false)),
        (2, with(6, Some(4), 1, false)),
        (2, with(5, None, 2, true)),
        (5, with(3, Some(1), 3, true)),
    ] {
        let plane = hills(9, 7, 5);
        let exemplars = &exemplars[..if factor == 5 { 2 } else { 3 }];
        // The definition takes no exemplar that is smaller than a patch.
        let paper = learned(exemplars, factor, &model);
        let found = difference(&amplified(&paper, &plane), &defined(&exemplars[..2], &plane, factor, &model));
        assert!(found < 1e-3, "factor {factor}, {model:?}: {found} m");
    }
}

/// With the terrain's own patches as atoms, the terrain comes back (section 4.3).
#[test]
fn its_own_exemplar_comes_back() {
    let truth = hills(80, 64, 8);
    let model = PatchModel { side: 4, patches: Some(17 * 13), ..PatchModel::default() };
    let found = amplified(&learned(std::slice::from_ref(&truth), 4, &model), &truth.averaged(4));
    // Patches at the edge hold what no exemplar has.
    let found = difference(&found.trimmed(12), &truth.trimmed(12));
    assert!(found < 1e-3, "{found} m");
}

/// A unit of the input is any, and what is as flat as water stays so.
#[test]
fn units_and_flat_land() {
    let paper = learned(&[hills(60, 60, 2)], 3, &PatchModel { side: 4, ..PatchModel::default() });
    let plane = hills(12, 10, 6);
    let feet = Plane::new(12, 10, plane.heights_m().iter().map(|height| height / 0.25).collect());
    let back = amplified(&paper, &feet).heights_m().iter().map(|height| height * 0.25).collect();
    assert!(difference(&Plane::new(36, 30, back), &amplified(&paper, &plane)) < 1e-9);
    let flat = amplified(&paper, &Plane::new(5, 6, vec![12.5; 30]));
    assert!(flat.heights_m().iter().all(|&height| height as f32 == 12.5));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..Default::default() })]

    /// However a raster is cut, each fine cell is the same to the bit.
    #[test]
    fn parts_are_the_whole(
        (side, step) in (3usize..7).prop_flat_map(|side| (Just(side), 1..side.div_ceil(2).max(2))),
        by in 2usize..4,
        steps in 1u32..3,
        sparsity in 1usize..3,
        atoms in prop::option::of(1usize..9),
        (row, col) in (0usize..9, 0usize..9),
        (rows, cols) in (1usize..6, 1usize..6),
    ) {
        let factor = by.pow(steps);
        let model = PatchModel { side, step: Some(step), sparsity, atoms, by: Some(by), ..PatchModel::default() };
        let paper = learned(&[hills(side * factor + 9, side * factor + 5, 1)], factor, &model);
        prop_assert_eq!(paper.atoms().len(), steps as usize);
        let plane = hills(14, 14, 9);
        let all = amplified(&paper, &plane);
        let reach = paper.reach() as i64;
        let corner = [row as i64 - reach, col as i64 - reach];
        let wanted = [corner[0], corner[1], rows as i64 + 2 * reach, cols as i64 + 2 * reach];
        let part = paper.amplified(extended(&plane, [0, 0], [14, 14], wanted), corner);
        prop_assert_eq!(part, all.part(row * factor, col * factor, rows * factor, cols * factor));
    }
}

#[test]
fn learned_atoms_are_patches_and_explain_more_than_as_many_drawn() {
    let exemplar = hills(120, 110, 12);
    let truth = hills(80, 80, 12).averaged(4);
    let model = |atoms| PatchModel { side: 4, atoms, patches: Some(27 * 24), ..PatchModel::default() };
    let error = |model: &PatchModel| {
        let paper = learned(std::slice::from_ref(&exemplar), 4, model);
        let means = amplified(&paper, &truth).averaged(4);
        let square: f64 = means.heights_m().iter().zip(truth.heights_m()).map(|(a, b)| (a - b) * (a - b)).sum();
        (paper.atoms(), square)
    };
    let (few, rough) = error(&model(Some(2)));
    let (many, fine) = error(&model(Some(40)));
    let (all, finest) = error(&model(None));
    assert_eq!((few, many, all), (vec![2], vec![40], vec![27 * 24]));
    assert!(finest < fine && fine < rough, "{finest}, {fine}, {rough}");
}

#[test]
fn refusals() {
    let usual = PatchModel::default();
    let steps = |factor: usize, model: PatchModel| model.steps(factor).map_err(|error| error.to_string());
    assert_eq!(steps(64, PatchModel { by: Some(4), ..usual.clone() }), Ok(vec![4, 4, 4]));
    assert_eq!(steps(11, usual.clone()), Ok(vec![11]));
    for (factor, model, words) in [
        (1, usual.clone(), "--factor 1: expected 2 to 256"),
        (257, usual.clone(), "--factor 257"),
        (8, PatchModel { by: Some(4), ..usual.clone() }, "--by 4"),
        (8, PatchModel { by: Some(1), ..usual.clone() }, "--by 1"),
        (8, PatchModel { by: Some(0), ..usual.clone() }, "--by 0"),
        (4, PatchModel { side: 2, ..usual.clone() }, "--patch 2: expected 3 to 64"),
        (4, PatchModel { step: Some(6), ..usual.clone() }, "--step: discs of side 8"),
        (4, PatchModel { step: Some(0), ..usual.clone() }, "--step"),
        (4, PatchModel { sparsity: 0, ..usual.clone() }, "--sparsity 0"),
        (4, PatchModel { atoms: Some(0), ..usual.clone() }, "--atoms 0"),
        (4, PatchModel { patches: Some(0), ..usual.clone() }, "--patches 0"),
        (4, PatchModel { signed: false, sparsity: 2, ..usual.clone() }, "--unsigned"),
    ] {
        let found = steps(factor, model).unwrap_err();
        assert!(found.contains(words), "{found}");
    }
    let refused = |plane: Plane| Paper::learn(vec![plane], 4, &usual, &Watch::default()).unwrap_err();
    let small = refused(hills(31, 60, 1));
    assert_eq!(small.kind(), ErrorKind::Input);
    assert!(small.message().contains("smaller than a patch: 60 x 31 cells, and a patch is 32 x 32"), "{small}");
    let flat = refused(Plane::new(40, 40, vec![7.1; 1600]));
    assert!(flat.message().contains("flat or has voids"), "{flat}");
    assert!(refused(Plane::new(40, 40, vec![f64::NAN; 1600])).message().contains("flat or has voids"));
}
