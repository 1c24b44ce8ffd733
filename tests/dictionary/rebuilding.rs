//! Terrains rebuilt from atoms, at any point and resolution.

use super::ground::{Ground, any_ground, terrain};
use super::{cases, with_threads};
use orograph::dictionary::{Choice, Codes, Dictionary, NoiseFamily, PatchShape, Pursuit, SparseTerrain, difference};
use proptest::prelude::*;

fn of_noise(ground: &Ground, sparsity: usize, seed: u64) -> SparseTerrain {
    let patches = ground.patches();
    let dictionary = Dictionary::noise(NoiseFamily::Ridged, &PatchShape::new(ground.side).unwrap(), 30, seed).unwrap();
    let found = Pursuit::new(&dictionary, sparsity, Choice::SmallestResidual).unwrap().decompose(&patches).unwrap();
    SparseTerrain::of(&patches, &found, dictionary).unwrap()
}

/// The same terrain with its atoms as values only.
fn of_values(ground: &Ground, sparsity: usize, seed: u64) -> Option<SparseTerrain> {
    let patches = ground.patches();
    let dictionary = Dictionary::complete(&patches, "ground").draw(30, seed);
    if dictionary.is_empty() {
        return None;
    }
    let found = Pursuit::new(&dictionary, sparsity, Choice::SmallestResidual).unwrap().decompose(&patches).unwrap();
    Some(SparseTerrain::of(&patches, &found, dictionary).unwrap())
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn all_patches_as_atoms_rebuild_the_terrain(ground in any_ground()) {
        let patches = ground.patches();
        let dictionary = Dictionary::complete(&patches, "ground");
        prop_assume!(!dictionary.is_empty());
        let found = Pursuit::new(&dictionary, 1, Choice::SmallestResidual).unwrap().decompose(&patches).unwrap();
        let rebuilt = SparseTerrain::of(&patches, &found, dictionary).unwrap().raster(1).unwrap();
        prop_assert!(ground.cells.iter().zip(&rebuilt).all(|(a, b)| a.is_nan() || !b.is_nan()), "a cell is missing");
        if let Some(difference) = difference(&ground.cells, &rebuilt) {
            prop_assert!(difference.rms_m < 1e-3, "{difference:?}");
        }
    }

    #[test]
    fn the_raster_is_the_function_at_the_centres(ground in any_ground(), sparsity in 1usize..4, seed in any::<u64>()) {
        let Some(terrain) = of_values(&ground, sparsity, seed) else { return Ok(()) };
        for (i, &cell) in terrain.raster(1).unwrap().iter().enumerate() {
            let at = terrain.elevation_m((i / ground.cols) as f64 + 0.5, (i % ground.cols) as f64 + 0.5);
            // To the bit: interpolation goes through the values.
            prop_assert_eq!(at.map(|z| (z as f32).to_bits()), (!cell.is_nan()).then_some(cell.to_bits()));
        }
        for (i, &cell) in terrain.raster(3).unwrap().iter().enumerate() {
            let (row, col) = (i / (3 * ground.cols), i % (3 * ground.cols));
            let at = terrain.elevation_m((row as f64 + 0.5) / 3.0, (col as f64 + 0.5) / 3.0);
            prop_assert_eq!(at.map(|z| z as f32), (!cell.is_nan()).then_some(cell));
        }
    }

    #[test]
    fn it_is_the_blend_that_the_paper_writes(ground in any_ground(), sparsity in 1usize..4, seed in any::<u64>()) {
        let terrain = of_noise(&ground, sparsity, seed);
        let layout = terrain.layout();
        let radius = ground.side as f64 / 2.0;
        let rebuilt = terrain.raster(1).unwrap();
        for row in 0..ground.rows {
            for col in 0..ground.cols {
                let (mut sum, mut weights) = (0.0, 0.0);
                for place in 0..layout.places() {
                    let Some(patch) = terrain.patch_at(place) else { continue };
                    let (top, left) = layout.corner(place);
                    let (i, j) = (row as i64 - top, col as i64 - left);
                    let square = ((i as f64 + 0.5 - radius).powi(2) + (j as f64 + 0.5 - radius).powi(2)) / radius.powi(2);
                    if square < 1.0 {
                        let (mean, atoms, parts) = terrain.patch(patch);
                        let k = i as usize * ground.side + j as usize;
                        let value = |(&atom, &part): (&u32, &f32)| f64::from(part) * f64::from(terrain.dictionary().atom(atom as usize)[k]);
                        let weight = (1.0 - square).powi(3);
                        sum += weight * (f64::from(mean) + atoms.iter().zip(parts).map(value).sum::<f64>());
                        weights += weight;
                    }
                }
                let found = rebuilt[row * ground.cols + col];
                if weights > 0.0 {
                    prop_assert!((f64::from(found) - sum / weights).abs() < 1e-3);
                    // Noise is the same function between the values.
                    let at = terrain.elevation_m(row as f64 + 0.5, col as f64 + 0.5).unwrap();
                    prop_assert!((f64::from(found) - at).abs() < 2e-3, "{found} {at}");
                } else {
                    prop_assert!(found.is_nan());
                }
            }
        }
    }
}

#[test]
fn threads_change_nothing() {
    let ground = Ground { rows: 60, cols: 50, cells: terrain(60, 50, 3, 2), side: 8, step: None };
    let run = || [1, 2].map(|per_cell| of_values(&ground, 2, 1).unwrap().raster(per_cell).unwrap());
    let bits = |rasters: [Vec<f32>; 2]| rasters.map(|cells| cells.into_iter().map(f32::to_bits).collect::<Vec<_>>());
    assert_eq!(bits(with_threads(1, run)), bits(with_threads(2, run)));
}

#[test]
fn between_the_values_it_is_smooth() {
    let ground = Ground { rows: 24, cols: 24, cells: terrain(24, 24, 5, 0), side: 8, step: None };
    let terrain = of_values(&ground, 2, 1).unwrap();
    // Slopes from both sides of a point agree better the nearer they are taken, also where values lie (at n + 1/2).
    for i in 0..200 {
        let (row, col) = (4.0 + f64::from(i % 20) / 4.0, 4.0 + f64::from(i / 20) / 2.0);
        let kink = |h: f64| {
            let at = |h: f64| terrain.elevation_m(row, col + h).unwrap();
            ((at(h) - at(0.0)) / h - (at(0.0) - at(-h)) / h).abs()
        };
        assert!(kink(1e-4) < 0.05 + 0.01 * kink(1e-1), "{row} {col}: {} {}", kink(1e-4), kink(1e-1));
    }
}

#[test]
fn a_void_raster_is_no_terrain() {
    let ground = Ground { rows: 9, cols: 9, cells: vec![f32::NAN; 81], side: 4, step: None };
    let terrain = of_noise(&ground, 1, 1);
    assert_eq!(terrain.patches(), 0);
    assert!(terrain.raster(1).unwrap().iter().all(|z| z.is_nan()));
    assert!(terrain.elevation_m(4.0, 4.0).is_none());
    assert!(terrain.raster(0).is_err());
    assert!(terrain.raster(usize::MAX).is_err());
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    let ground = Ground { rows: 12, cols: 12, cells: terrain(12, 12, 1, 0), side: 6, step: None };
    let patches = ground.patches();
    let layout = patches.layout().clone();
    let dictionary = |side| Dictionary::noise(NoiseFamily::Perlin, &PatchShape::new(side).unwrap(), 2, 1).unwrap();
    let codes = |atom| Codes::from_pairs(1, &[vec![(atom, 1.0)], vec![]]).unwrap();
    let new = |places: &[u32], means: Vec<f32>, atom, side| {
        SparseTerrain::new(layout.clone(), places, means, &codes(atom), dictionary(side))
    };
    assert!(new(&[0, 5], vec![1.0, 2.0], 1, 6).is_ok());
    assert!(new(&[0, 5], vec![1.0, 2.0], 1, 12).is_ok());
    assert!(new(&[5, 0], vec![1.0, 2.0], 1, 6).is_err());
    assert!(new(&[0, 16], vec![1.0, 2.0], 1, 6).is_err());
    assert!(new(&[0, 5], vec![1.0], 1, 6).is_err());
    assert!(new(&[0, 5], vec![1.0, 2.0], 2, 6).is_err());
    assert!(new(&[0, 5], vec![1.0, 2.0], 1, 7).is_err());
    let terrain = new(&[0, 5], vec![1.0, 2.0], 1, 6).unwrap();
    assert!(terrain.clone().with_dictionary(dictionary(9)).is_err());
    assert_eq!((terrain.patch_at(5), terrain.patch_at(4), terrain.patch_at(99)), (Some(1), None, None));
}
