//! Both ways of choosing atoms against the reference, with voids and borders.

use super::ground::any_ground;
use super::reference::RefPatch;
use super::{cases, with_threads};
use orograph::dictionary::{Choice, Dictionary, NoiseFamily, PatchShape, Pursuit};
use proptest::prelude::*;

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn each_atom_is_the_best_at_its_step(
        ground in any_ground(), atoms in 1usize..30, sparsity in 1usize..5, seed in any::<u64>(),
    ) {
        let patches = ground.patches();
        let shape = PatchShape::new(ground.side).unwrap();
        let dictionary = Dictionary::noise(NoiseFamily::Ridged, &shape, atoms, seed).unwrap();
        for choice in [Choice::SmallestResidual, Choice::LargestCorrelation] {
            let found = Pursuit::new(&dictionary, sparsity, choice).unwrap().decompose(&patches).unwrap();
            for i in 0..patches.len() {
                let reference = RefPatch::new(&patches, i, &ground.cells);
                let (atoms, parts) = found.codes.get(i);
                let whole = reference.error(&dictionary, &[]);
                // Values of patches are rounded to `f32`, and so are the atoms times the roots of weights.
                let rounding = 1e-5 * whole + 1e-6;
                for step in 0..=atoms.len().min(sparsity - 1) {
                    let merits = reference.merits(&dictionary, &atoms[..step], choice);
                    let best = merits.iter().flatten().copied().fold(0.0, f64::max);
                    match atoms.get(step) {
                        Some(&k) => {
                            // One that the reference leaves out is near the limit of what may be chosen.
                            if let Some(merit) = merits[k as usize] {
                                prop_assert!(merit >= best - rounding, "patch {i} step {step}: {merit} of {best}");
                            }
                        }
                        None if choice == Choice::SmallestResidual => prop_assert!(best <= rounding, "{best} is left"),
                        None => {}
                    }
                }
                let (error, least) = (
                    reference.error_of(&dictionary, atoms, parts, found.mean_m[i]),
                    reference.error(&dictionary, atoms),
                );
                prop_assert!(error <= least + rounding, "patch {i}: {error} where {least} is possible");
            }
        }
    }

    #[test]
    fn threads_change_nothing(ground in any_ground(), sparsity in 1usize..4, seed in any::<u64>()) {
        let run = || {
            let patches = ground.patches();
            let shape = PatchShape::new(ground.side).unwrap();
            let dictionary = Dictionary::noise(NoiseFamily::Perlin, &shape, 50, seed).unwrap();
            Pursuit::new(&dictionary, sparsity, Choice::SmallestResidual).unwrap().decompose(&patches).unwrap()
        };
        prop_assert_eq!(with_threads(1, run), with_threads(2, run));
    }
}

#[test]
fn flat_terrain_needs_no_atoms() {
    let ground = super::ground::Ground { rows: 20, cols: 20, cells: vec![1e4; 400], side: 6, step: None };
    let patches = ground.patches();
    let dictionary = Dictionary::noise(NoiseFamily::Perlin, &PatchShape::new(6).unwrap(), 9, 1).unwrap();
    for sparsity in [1, 3] {
        let pursuit = Pursuit::new(&dictionary, sparsity, Choice::SmallestResidual).unwrap();
        let found = pursuit.decompose(&patches).unwrap();
        assert_eq!(found.codes.coefficients(), 0);
        assert!(found.mean_m.iter().all(|&mean| mean == 1e4));
    }
    assert!(Dictionary::complete(&patches, "flat").is_empty());
}
