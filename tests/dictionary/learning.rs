//! K-SVD and learning from real patches.

use super::ground::{Ground, any_ground, terrain};
use super::{cases, with_threads};
use orograph::dictionary::{
    Choice, Dictionary, Learning, NoiseFamily, Origin, PatchLayout, PatchShape, Patches, Raster, Samples, learn,
    learn_constrained,
};
use orograph::error::ErrorKind;
use orograph::watch::Watch;
use proptest::prelude::*;

fn how(iterations: usize, sparsity: usize, choice: Choice) -> Learning {
    Learning { iterations, sparsity, choice }
}

/// Rounding of sums in double precision, and nothing more.
fn never_rises(errors: &[f64]) -> bool {
    errors.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-12))
}

proptest! {
    #![proptest_config(cases(30))]

    #[test]
    fn the_error_never_rises(
        ground in any_ground(), atoms in 1usize..20, sparsity in 1usize..5, seed in any::<u64>(), correlation in any::<bool>(),
    ) {
        let samples = Samples::new(&ground.patches(), "ground");
        prop_assume!(!samples.is_empty());
        let choice = if correlation { Choice::LargestCorrelation } else { Choice::SmallestResidual };
        let how = how(6, sparsity, choice);
        let start = samples.draw(atoms, seed).unwrap();
        let learned = learn(&samples, start.clone(), &how, &Watch::default()).unwrap();
        prop_assert!(never_rises(&learned.error_m2), "{:?}", learned.error_m2);
        prop_assert_eq!(learned.dictionary.len(), start.len());
        // Of length 1, without a constant part.
        let shape = samples.shape();
        for i in 0..learned.dictionary.len() {
            let values = learned.dictionary.atom(i);
            let sums = shape.weights().iter().zip(values).fold((0.0, 0.0), |sums, (w, &v)| {
                (sums.0 + w * f64::from(v), sums.1 + w * f64::from(v) * f64::from(v))
            });
            prop_assert!(sums.0.abs() < 1e-3 && (sums.1 - 1.0).abs() < 1e-5, "atom {i}: {sums:?}");
        }
        let candidates = samples.clone().into_dictionary();
        let learned = learn_constrained(&samples, &candidates, (atoms, seed), &how, &Watch::default()).unwrap();
        prop_assert!(never_rises(&learned.error_m2), "{:?}", learned.error_m2);
        for i in 0..learned.dictionary.len() {
            let real = (0..candidates.len())
                .any(|k| candidates.origin(k) == learned.dictionary.origin(i) && candidates.atom(k) == learned.dictionary.atom(i));
            prop_assert!(real, "atom {i} is no patch");
        }
    }
}

#[test]
fn threads_change_nothing() {
    let ground = Ground { rows: 90, cols: 80, cells: terrain(90, 80, 4, 1), side: 7, step: Some(2) };
    let run = |sparsity: usize| {
        let samples = Samples::new(&ground.patches(), "ground");
        let how = how(3, sparsity, Choice::SmallestResidual);
        let free = learn(&samples, samples.draw(3, 7).unwrap(), &how, &Watch::default()).unwrap();
        let candidates = samples.clone().into_dictionary();
        (free, learn_constrained(&samples, &candidates, (3, 7), &how, &Watch::default()).unwrap())
    };
    for sparsity in [1, 2] {
        assert_eq!(with_threads(1, || run(sparsity)), with_threads(2, || run(sparsity)));
    }
}

/// Separate patches, each one of three landforms times some height.
fn of_three_landforms() -> Samples {
    let shape = PatchShape::new(8).unwrap();
    let atoms = Dictionary::noise(NoiseFamily::Ridged, &shape, 3, 11).unwrap();
    let all: Vec<Samples> = (0..60)
        .map(|i| {
            let height = 10.0 + (i * 7 % 23) as f32;
            // A raster as small as the step has one patch, of which only the middle is there.
            let cells: Vec<f32> = atoms.atom(i % 3)[..16].iter().map(|v| v * height).collect();
            let layout = PatchLayout::new(4, 4, shape.clone(), Some(4)).unwrap();
            let patches = Patches::new(&Raster::new(4, 4, &cells).unwrap(), layout).unwrap();
            Samples::new(&patches, &format!("source {i}"))
        })
        .collect();
    Samples::join(&all).unwrap()
}

#[test]
fn three_landforms_are_learned_from_any_start() {
    let samples = of_three_landforms();
    assert_eq!(samples.len(), 60);
    assert_eq!(samples.draw(60, 1).unwrap().sources().len(), 60);
    let how = how(8, 1, Choice::SmallestResidual);
    let candidates = samples.clone().into_dictionary();
    for seed in 0..10 {
        let free = learn(&samples, samples.draw(3, seed).unwrap(), &how, &Watch::default()).unwrap();
        let real = learn_constrained(&samples, &candidates, (3, seed), &how, &Watch::default()).unwrap();
        for learned in [free, real] {
            let last = *learned.error_m2.last().unwrap();
            assert!(never_rises(&learned.error_m2) && last < 1e-6, "{:?}", learned.error_m2);
        }
    }
}

#[test]
fn atoms_of_noise_can_be_chosen() {
    let ground = Ground { rows: 60, cols: 60, cells: terrain(60, 60, 9, 0), side: 8, step: None };
    let samples = Samples::new(&ground.patches(), "ground");
    let candidates = Dictionary::noise(NoiseFamily::Ridged, samples.shape(), 300, 2).unwrap();
    let how = how(4, 1, Choice::SmallestResidual);
    let learned = learn_constrained(&samples, &candidates, (12, 5), &how, &Watch::default()).unwrap();
    assert!(never_rises(&learned.error_m2));
    assert!((0..12).all(|i| matches!(learned.dictionary.origin(i), Origin::Noise(_))));
}

#[test]
fn dictionaries_of_several_sources_keep_their_origins() {
    let source = |seed: u64| {
        let ground = Ground { rows: 30, cols: 30, cells: terrain(30, 30, seed, 0), side: 6, step: None };
        Samples::new(&ground.patches(), &format!("terrain {seed}"))
    };
    let (first, second) = (source(1), source(2));
    let noise = Dictionary::noise(NoiseFamily::Perlin, first.shape(), 5, 1).unwrap();
    let parts = [first.draw(4, 1).unwrap(), noise, second.draw(4, 1).unwrap(), first.draw(2, 9).unwrap()];
    let mixed = Dictionary::join(&parts).unwrap();
    assert_eq!((mixed.len(), mixed.sources()), (15, &["terrain 1".to_owned(), "terrain 2".to_owned()][..]));
    let sources: Vec<Option<u32>> = (0..mixed.len())
        .map(|i| match mixed.origin(i) {
            Origin::Patch { source, .. } => Some(*source),
            _ => None,
        })
        .collect();
    let expected: Vec<Option<u32>> = [vec![Some(0); 4], vec![None; 5], vec![Some(1); 4], vec![Some(0); 2]].concat();
    assert_eq!(sources, expected);
    assert_eq!(mixed.atom(9), parts[2].atom(0));
    let other = Dictionary::noise(NoiseFamily::Perlin, &PatchShape::new(7).unwrap(), 5, 1).unwrap();
    assert!(Dictionary::join([&mixed, &other]).is_err());
    assert!(Dictionary::join([]).is_err());
}

#[test]
fn what_cannot_be_learned_is_refused() {
    let flat = Ground { rows: 9, cols: 9, cells: vec![5.0; 81], side: 4, step: None };
    let samples = Samples::new(&flat.patches(), "flat");
    assert!(samples.is_empty());
    assert_eq!(samples.draw(3, 1).unwrap_err().kind(), ErrorKind::Input);
    let hills = Ground { cells: terrain(9, 9, 1, 0), ..flat };
    let samples = Samples::new(&hills.patches(), "hills");
    assert!(samples.draw(0, 1).is_err());
    let other = Dictionary::noise(NoiseFamily::Perlin, &PatchShape::new(7).unwrap(), 5, 1).unwrap();
    let how = how(2, 1, Choice::SmallestResidual);
    assert!(learn(&samples, other.clone(), &how, &Watch::default()).is_err());
    assert!(learn_constrained(&samples, &other, (2, 1), &how, &Watch::default()).is_err());
    let watch = Watch::default();
    watch.cancel();
    let cancelled = learn(&samples, samples.draw(2, 1).unwrap(), &how, &watch).unwrap_err();
    assert_eq!(cancelled.kind(), ErrorKind::Interrupted);
}
