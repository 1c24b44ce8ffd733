//! The fast way against the definition: all atoms, in double precision, one after the other.

use super::super::layout::PatchLayout;
use super::super::noise_atom::NoiseFamily;
use super::super::raster::Raster;
use super::*;
use crate::rng::Rng;
use proptest::prelude::*;

const CHOICES: [Choice; 2] = [Choice::SmallestResidual, Choice::LargestCorrelation];

/// Atoms and their coefficients by the definition, to the bit.
fn defined(pursuit: &Pursuit, values: &[f32]) -> (Vec<u32>, Vec<f64>) {
    let mut patch = vec![0.0; pursuit.shape.disc_values()];
    pursuit.shape.scale_into(values, &mut patch);
    let mut projection = Projection::default();
    projection.begin(&patch);
    let whole = projection.error();
    while projection.atoms().len() < pursuit.sparsity && projection.error() > LEAST_GAIN * whole {
        let mut best = (0.0, None);
        for k in 0..pursuit.count() {
            let length = match pursuit.choice {
                Choice::SmallestResidual => projection.outside(pursuit.atom(k), pursuit.squares[k]),
                Choice::LargestCorrelation => pursuit.squares[k],
            };
            let correlation = projection.correlation(pursuit.atom(k));
            let gain =
                if pursuit.signs == Signs::Both || correlation > 0.0 { correlation.powi(2) / length } else { 0.0 };
            if length >= LEAST_NEW && gain > best.0 && !projection.atoms().contains(&(k as u32)) {
                best = (gain, Some(k));
            }
        }
        let (gain, Some(k)) = best else { break };
        if gain <= LEAST_GAIN * whole || !projection.take(k as u32, pursuit.atom(k), None) {
            break;
        }
    }
    (projection.atoms().to_vec(), projection.coefficients().0)
}

/// Atoms, some of them twice, some all but equal, some nearly sums of two others.
fn dictionary(shape: &PatchShape, count: usize, seed: u64) -> Dictionary {
    let mut rng = Rng::new(seed);
    let mut all = Dictionary::noise(NoiseFamily::Perlin, shape, count, seed).unwrap();
    for _ in 0..count {
        let (a, b) = (rng.below(all.len() as u64) as usize, rng.below(all.len() as u64) as usize);
        let (mut values, other) = (all.atom(a).to_vec(), all.atom(b).to_vec());
        match rng.below(4) {
            0 => {}
            1 => values.iter_mut().for_each(|v| *v = -v.next_up()),
            2 => values.iter_mut().for_each(|v| *v += 1e-6 * rng.between(-1.0, 1.0) as f32),
            _ => {
                values.iter_mut().zip(&other).for_each(|(v, o)| *v = (*v + o) / 2.0);
                let doubles: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
                let norm = shape.norm(&doubles);
                if norm < 0.1 {
                    continue;
                }
                values.iter_mut().for_each(|v| *v = (f64::from(*v) / norm) as f32);
            }
        }
        let origin = all.origin(a).clone();
        all.push(&values, origin);
    }
    all
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..Default::default() })]

    #[test]
    fn codes_are_those_of_the_definition(
        seed in any::<u64>(), side in 3usize..10, count in 1usize..60, sparsity in 1usize..7, scale in 0u32..5,
    ) {
        let shape = PatchShape::new(side).unwrap();
        let dictionary = dictionary(&shape, count, seed);
        let mut rng = Rng::new(seed);
        let scale = [1.0, 1e-6, 1e-25, 1e3, 1e8][scale as usize];
        let mut values: Vec<f32> = vec![];
        for i in 0..300 {
            let atom = dictionary.atom(rng.below(dictionary.len() as u64) as usize);
            // Noise, an atom alone, an atom with noise, nothing.
            let (of_atom, of_noise) = [(0.0, 1.0), (1.0, 0.0), (1.0, 0.1), (0.0, 0.0)][i % 4];
            values.extend(atom.iter().map(|&v| {
                (scale * (of_atom * f64::from(v) + of_noise * rng.between(-1.0, 1.0))) as f32
            }));
        }
        let each = |choice| Pursuit::new(&dictionary, sparsity, choice).unwrap();
        let positive = Pursuit::new(&dictionary, 1, CHOICES[0]).unwrap().with_signs(Signs::Positive).unwrap();
        let trees = [each(CHOICES[0]), positive.clone()].map(|pursuit| pursuit.with_tree(1));
        for pursuit in CHOICES.map(each).into_iter().chain([positive]).chain(trees) {
            let sparsity = pursuit.sparsity;
            let (codes, _) = pursuit.match_all(&values, |_| None);
            for (i, patch) in values.chunks(shape.values()).enumerate() {
                let (atoms, parts) = defined(&pursuit, patch);
                let length = patch.iter().map(|&v| f64::from(v).powi(2)).sum::<f64>().sqrt();
                prop_assert_eq!(codes.get(i).0, &atoms[..], "patch {}", i);
                for (a, b) in codes.get(i).1.iter().zip(&parts) {
                    // With one atom the coefficient takes a shorter way: it may round otherwise.
                    let off = if sparsity == 1 { 1e-14 * length } else { 0.0 };
                    prop_assert!((a - b).abs() <= off, "patch {}: {} is not {}", i, a, b);
                }
            }
        }
    }
}

#[test]
fn large_dictionaries_are_matched_in_chunks() {
    let shape = PatchShape::new(4).unwrap();
    let dictionary = dictionary(&shape, 1000, 8);
    let values: Vec<f32> = dictionary.values()[..600 * 16].iter().map(|v| 3.0 * v).collect();
    // In a tree of two levels, too.
    for (sparsity, choice, many) in
        [(1, CHOICES[0], MANY), (1, CHOICES[0], 1), (3, CHOICES[0], MANY), (3, CHOICES[1], MANY)]
    {
        let pursuit = Pursuit::new(&dictionary, sparsity, choice).unwrap().with_tree(many);
        assert_eq!(pursuit.tree.is_some(), many == 1);
        let (codes, _) = pursuit.match_all(&values, |_| None);
        for i in (0..600).step_by(7) {
            assert_eq!(codes.get(i).0, defined(&pursuit, &values[i * 16..][..16]).0);
        }
    }
}

#[test]
fn a_patch_with_all_cells_known_is_the_same_on_the_slow_way() {
    let shape = PatchShape::new(7).unwrap();
    let dictionary = Dictionary::noise(NoiseFamily::Ridged, &shape, 40, 2).unwrap();
    let cells: Vec<f32> = (0..900).map(|i| ((i * i * 31) % 977) as f32).collect();
    let layout = PatchLayout::new(30, 30, shape.clone(), None).unwrap();
    let patches = Patches::new(&Raster::new(30, 30, &cells).unwrap(), layout).unwrap();
    for (sparsity, choice) in [(1, CHOICES[0]), (4, CHOICES[0]), (4, CHOICES[1])] {
        let pursuit = Pursuit::new(&dictionary, sparsity, choice).unwrap();
        let all = vec![true; shape.disc_values()];
        let (fast, _) = pursuit.match_all(patches.all_values_m(), |_| None);
        let (slow, shift) = pursuit.match_all(patches.all_values_m(), |_| Some(&all));
        for i in (0..patches.len()).filter(|&i| patches.is_whole(i)) {
            assert_eq!(fast.get(i).0, slow.get(i).0);
            assert!(shift[i].abs() < 1e-3);
            for (a, b) in fast.get(i).1.iter().zip(slow.get(i).1) {
                assert!((a - b).abs() < 1e-3, "{a} {b}");
            }
        }
    }
}

#[test]
fn what_cannot_be_matched_is_refused() {
    let shape = PatchShape::new(4).unwrap();
    let dictionary = Dictionary::noise(NoiseFamily::Perlin, &shape, 3, 1).unwrap();
    assert!(Pursuit::new(&dictionary, 0, CHOICES[0]).is_err());
    assert!(Pursuit::new(&dictionary, MOST_SPARSITY + 1, CHOICES[0]).is_err());
    assert!(Pursuit::new(&Dictionary::new(4, vec![]), 1, CHOICES[0]).is_err());
    let layout = PatchLayout::new(5, 5, PatchShape::new(5).unwrap(), None).unwrap();
    let patches = Patches::new(&Raster::new(5, 5, &[1.0; 25]).unwrap(), layout).unwrap();
    assert!(Pursuit::new(&dictionary, 1, CHOICES[0]).unwrap().decompose(&patches).is_err());
}
