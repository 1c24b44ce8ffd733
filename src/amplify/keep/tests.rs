//! What was kept comes back, and nothing else is taken for it.

use super::super::anchors::{ANCHORS, Anchors, BRANCHES, Knot};
use super::super::cascade::Stage;
use super::super::features::{DIMS, Features, INPUTS};
use super::super::network::Network;
use super::super::step::{Estimator, Step, detail_side};
use super::super::strength::Strength;
use super::super::texture::{Texture, sample_side};
use super::super::{Cascade, Paper, PatchModel, Plane};
use super::{Cursor, Kind};
use crate::error::{ErrorKind, Result};
use crate::rng::Rng;
use crate::watch::Watch;

const ROOM: u64 = 1 << 28;

/// Hills with noise, and a void where `void` says.
pub(crate) fn hills(rows: usize, cols: usize, void: Option<usize>) -> Plane {
    let mut rng = Rng::new(3);
    let height = |i: usize| {
        let (x, y) = ((i % cols) as f64 / 7.0, (i / cols) as f64 / 5.0);
        100.0 + 9.0 * (x - 3.0) * (y - 2.0) / (1.0 + x * y) + rng.unit()
    };
    let mut heights: Vec<f64> = (0..rows * cols).map(height).map(|v| f64::from(v as f32)).collect();
    void.iter().for_each(|&cell| heights[cell] = f64::NAN);
    Plane::new(rows, cols, heights)
}

/// A cascade whose numbers follow rules, so that it is kept in few bytes.
pub(crate) fn plain(factor: usize, is_textured: bool) -> Cascade {
    if !is_textured {
        let weight = |i: usize| (i * i % 23) as f32 / 16.0 - 0.6875;
        let tables: Vec<Vec<f32>> =
            Network::table_sizes(factor).iter().map(|[rows, cols]| (0..rows * cols).map(weight).collect()).collect();
        let network = Network::of_tables(factor, true, &tables).unwrap();
        return Cascade { steps: vec![Stage::Estimate(network)], borrowed: 0 };
    }
    let cells = detail_side(factor) * detail_side(factor);
    let knot = |number: usize| {
        Knot(std::array::from_fn(|axis| {
            std::array::from_fn(|branch| if (branch + number) % DIMS == axis { 1.0 } else { 0.0 })
        }))
    };
    let side = sample_side(factor);
    let step = Step {
        factor,
        is_square: true,
        features: Features {
            weights: (0..INPUTS).map(|i| std::array::from_fn(|k| f32::from(u8::from(i == k)))).collect(),
        },
        anchors: Anchors { root: knot(0), knots: (1..=BRANCHES).map(knot).collect() },
        estimator: Estimator::Regressions(
            (0..ANCHORS * DIMS * cells).map(|i| if i / cells % DIMS == 3 { 0.125 } else { 0.0 }).collect(),
        ),
    };
    let texture = Texture {
        strength: Strength { weights: [0.25, 0.5, 0.0] },
        // The first kind has its own, the others those of all.
        kinds: (0..Step::KINDS).map(|kind| if kind == 0 { vec![0, 2] } else { vec![0, 1, 2] }).collect(),
        samples: (0..3 * side * side).map(|i| ((i * 5 % 7) as f32 - 3.0) / 4.0).collect(),
    };
    Cascade { steps: vec![Stage::Terrain { step: Box::new(step), texture: Some(texture) }], borrowed: 0 }
}

fn kept(cascade: &Cascade) -> Vec<u8> {
    let mut bytes = vec![];
    cascade.put(&mut bytes).unwrap();
    bytes
}

fn taken(bytes: &[u8], kind: Kind, factor: usize) -> Result<Cascade> {
    let mut cursor = Cursor::new(bytes, ROOM);
    let cascade = Cascade::take(&mut cursor, kind, factor)?;
    cursor.end()?;
    Ok(cascade)
}

fn fine(cascade: &Cascade) -> Vec<u64> {
    let side = 2 * cascade.reach() + 4;
    let plane = hills(side, side, None);
    let fine = cascade.amplified(plane, vec![true; side * side], [0, 0], 8);
    fine.heights_m().iter().map(|height| height.to_bits()).collect()
}

fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn learned_steps_come_back_to_the_bit() {
    let exemplar = hills(90, 80, None);
    let exemplars = std::slice::from_ref(&exemplar);
    let watch = Watch::default();
    for (factor, cascade) in [
        (2, Cascade::learn(exemplars, 2, true, 1, &watch).unwrap()),
        (2, Cascade::learn_textured(exemplars, 2, false, &watch).unwrap()),
        // The coarser step is borrowed.
        (4, Cascade::learn_textured(exemplars, 4, false, &watch).unwrap()),
    ] {
        let bytes = kept(&cascade);
        let again = taken(&bytes, cascade.kind(), factor).unwrap();
        assert_eq!(again.borrowed_steps(), cascade.borrowed_steps());
        for stages in cascade.steps.iter().zip(&again.steps) {
            match stages {
                (Stage::Estimate(old), Stage::Estimate(new)) => assert_eq!(old, new),
                (Stage::Terrain { step: old, texture }, Stage::Terrain { step: new, texture: again }) => {
                    assert_eq!((old.factor, old.is_square), (new.factor, new.is_square));
                    match (&old.estimator, &new.estimator) {
                        (Estimator::Regressions(old), Estimator::Regressions(new)) => assert_eq!(bits(old), bits(new)),
                        (Estimator::Network(old), Estimator::Network(new)) => assert_eq!(old, new),
                        _ => panic!("of one kind"),
                    }
                    assert_eq!(bits(old.features.weights.as_flattened()), bits(new.features.weights.as_flattened()));
                    assert!((0..ANCHORS).all(|k| old.anchors.vector(k) == new.anchors.vector(k)), "anchors");
                    assert_eq!(texture.is_some(), again.is_some());
                    for (old, new) in texture.iter().zip(again) {
                        assert_eq!((&old.kinds, old.strength), (&new.kinds, new.strength));
                        assert_eq!(bits(&old.samples), bits(&new.samples));
                    }
                }
                _ => panic!("of one kind"),
            }
        }
        assert_eq!(fine(&cascade), fine(&again));
        let steps = cascade.bytes();
        assert!(bytes.len() < steps + steps / 10, "{} bytes of {steps}", bytes.len());
        assert!(kept(&again) == bytes, "the same bytes");
    }
}

#[test]
fn equal_steps_are_kept_once() {
    let mut cascade = plain(2, true);
    let one = kept(&cascade).len();
    cascade.steps.push(cascade.steps[0].clone());
    cascade.borrowed = 1;
    let bytes = kept(&cascade);
    assert_eq!(bytes.len(), one + 1);
    assert_eq!(fine(&taken(&bytes, Kind::Steps, 4).unwrap()), fine(&cascade));
    // A step that was learned where no texture was.
    let Stage::Terrain { texture, .. } = &mut cascade.steps[1] else { panic!("it has texture") };
    *texture = None;
    let again = taken(&kept(&cascade), Kind::Steps, 4).unwrap();
    let has = |step: &Stage| matches!(step, Stage::Terrain { texture: Some(_), .. });
    assert!(has(&again.steps[0]) && !has(&again.steps[1]));
    assert_eq!(fine(&again), fine(&cascade));
}

#[test]
fn patches_come_back_to_the_bit() {
    let exemplars = [hills(60, 70, Some(1000)), hills(40, 41, None)];
    let watch = Watch::default();
    let usual = PatchModel { side: 4, ..PatchModel::default() };
    for model in [
        usual.clone(),
        PatchModel { by: Some(2), step: Some(1), patches: Some(300), ..usual.clone() },
        PatchModel { signed: false, atoms: Some(20), seed: 7, ..usual.clone() },
        PatchModel { sparsity: 2, atoms: Some(12), by: Some(2), ..usual },
    ] {
        let paper = Paper::learn(exemplars.to_vec(), 4, &model, &watch).unwrap();
        let mut bytes = vec![];
        paper.put(&mut bytes).unwrap();
        let mut cursor = Cursor::new(&bytes, ROOM);
        let again = Paper::take(&mut cursor, 4, model.seed, &watch).unwrap();
        cursor.end().unwrap();
        assert_eq!((again.model(), again.atoms(), again.factors()), (&model, paper.atoms(), paper.factors()));
        let side = 2 * paper.reach() + 5;
        let fine = |paper: &Paper| {
            let fine = paper.amplified(hills(side, side, None), [-3, 2]);
            fine.heights_m().iter().map(|height| height.to_bits()).collect::<Vec<_>>()
        };
        assert_eq!(fine(&again), fine(&paper), "{model:?}");
        let mut bytes_again = vec![];
        again.put(&mut bytes_again).unwrap();
        assert!(bytes_again == bytes, "the same bytes");
    }
}

/// Changes, cuts and lengthens bytes.
fn broken(bytes: &[u8], rng: &mut Rng) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..1 + rng.below(3) {
        // Half of the time where most numbers stand.
        let most = if rng.below(2) == 0 { bytes.len().min(40) } else { bytes.len() };
        let at = rng.below(most.max(1) as u64) as usize;
        match (rng.below(8), bytes.get_mut(at)) {
            (0, _) => bytes.truncate(at),
            (1, _) => bytes.extend([rng.next_u32() as u8; 3]),
            (2, Some(byte)) => *byte = 255,
            (3, Some(byte)) => *byte = 0,
            (4, Some(byte)) => *byte = byte.wrapping_add(1),
            (_, Some(byte)) => *byte ^= 1 << rng.below(8),
            (_, None) => {}
        }
    }
    bytes
}

#[test]
fn broken_steps_are_told_or_work() {
    let mut rng = Rng::new(11);
    for is_textured in [false, true] {
        let kind = plain(2, is_textured).kind();
        let bytes = kept(&plain(2, is_textured));
        for _ in 0..60 {
            let other = broken(&bytes, &mut rng);
            match taken(&other, kind, 2) {
                Ok(cascade) => {
                    fine(&cascade);
                }
                Err(error) => assert!(matches!(error.kind(), ErrorKind::Corrupt | ErrorKind::Unsupported), "{error}"),
            }
        }
        for length in (0..bytes.len()).step_by(bytes.len() / 30).chain(0..20) {
            assert!(taken(&bytes[..length], kind, 2).is_err(), "{length} bytes");
        }
        assert!(taken(&bytes, kind, 4).is_err() && taken(&bytes, kind, 3).is_err(), "of another factor");
        assert!(taken(&[&bytes[..], &[0]].concat(), kind, 2).is_err(), "too long");
    }
}

#[test]
fn broken_patches_are_told_or_work() {
    let mut rng = Rng::new(12);
    let watch = Watch::default();
    let usual = PatchModel { side: 3, ..PatchModel::default() };
    for model in [usual.clone(), PatchModel { atoms: Some(9), ..usual }] {
        let paper = Paper::learn(vec![hills(14, 15, Some(3))], 2, &model, &watch).unwrap();
        let mut bytes = vec![];
        paper.put(&mut bytes).unwrap();
        let take = |bytes: &[u8]| {
            let mut cursor = Cursor::new(bytes, ROOM);
            let paper = Paper::take(&mut cursor, 2, 1, &watch)?;
            cursor.end()?;
            Ok::<_, crate::error::Error>(paper)
        };
        let mut works = 0;
        for _ in 0..3000 {
            match take(&broken(&bytes, &mut rng)) {
                Ok(paper) => {
                    works += 1;
                    let side = 2 * paper.reach() + 2;
                    paper.amplified(hills(side, side, None), [0, 0]);
                }
                Err(error) => assert!(matches!(error.kind(), ErrorKind::Corrupt | ErrorKind::Unsupported), "{error}"),
            }
        }
        assert!(works > 0, "not all changes are seen here: the file has a checksum");
        for length in 0..bytes.len() {
            assert!(take(&bytes[..length]).is_err(), "{length} bytes");
        }
    }
}

/// Numbers that promise more than there is room for.
#[test]
fn memory_is_not_taken_on_a_number_alone() {
    let small = |bytes: &[u8], room: u64| Cascade::take(&mut Cursor::new(bytes, room), Kind::Steps, 2).map(|_| ());
    let bytes = kept(&plain(2, true));
    let error = small(&bytes, 1 << 20).unwrap_err();
    assert!(error.kind() == ErrorKind::Unsupported && error.message().contains("--memory"), "{error}");
    let paper =
        Paper::learn(vec![hills(14, 15, None)], 2, &PatchModel { side: 3, ..PatchModel::default() }, &Watch::default());
    let mut bytes = vec![];
    paper.unwrap().put(&mut bytes).unwrap();
    // Rows and columns of the first exemplar.
    for sides in [[u32::MAX; 2], [1 << 20, 1 << 12]] {
        bytes[16..20].copy_from_slice(&sides[0].to_le_bytes());
        bytes[20..24].copy_from_slice(&sides[1].to_le_bytes());
        let error = Paper::take(&mut Cursor::new(&bytes, ROOM), 2, 1, &Watch::default()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Unsupported, "{error}");
    }
}
