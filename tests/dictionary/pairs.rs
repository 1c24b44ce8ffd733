//! Dictionaries of two resolutions.

use super::ground::{Ground, terrain};
use orograph::dictionary::{Choice, DictionaryPair, Learning, Pursuit, Samples, SparseTerrain, learn_constrained};
use orograph::watch::Watch;

const FACTOR: usize = 4;

fn fine() -> Ground {
    Ground { rows: 96, cols: 96, cells: terrain(96, 96, 12, 0), side: 24, step: Some(8) }
}

/// Averages over squares of cells.
fn coarse(fine: &Ground) -> Ground {
    let (rows, cols) = (fine.rows / FACTOR, fine.cols / FACTOR);
    let mut cells = vec![0.0f64; rows * cols];
    for (i, &z) in fine.cells.iter().enumerate() {
        cells[i / fine.cols / FACTOR * cols + i % fine.cols / FACTOR] += f64::from(z) / (FACTOR * FACTOR) as f64;
    }
    let cells = cells.into_iter().map(|z| z as f32).collect();
    Ground { rows, cols, cells, side: 6, step: Some(2) }
}

#[test]
fn averages_of_fine_atoms_are_the_coarse_ones() {
    let pair = DictionaryPair::new(&fine().patches(), FACTOR, "fine").unwrap();
    assert!(pair.low().len() > 10);
    assert_eq!((pair.low().len(), pair.low().side(), pair.high().side()), (pair.high().len(), 6, 24));
    for i in 0..pair.low().len() {
        assert_eq!(pair.low().origin(i), pair.high().origin(i));
        for (k, &low) in pair.low().atom(i).iter().enumerate() {
            let square = (0..FACTOR * FACTOR)
                .map(|m| pair.high().atom(i)[(k / 6 * FACTOR + m / FACTOR) * 24 + k % 6 * FACTOR + m % FACTOR]);
            let mean = square.map(f64::from).sum::<f64>() / (FACTOR * FACTOR) as f64;
            assert!((mean - f64::from(low)).abs() < 1e-5, "{mean} {low}");
        }
    }
    assert!(DictionaryPair::new(&fine().patches(), 5, "fine").is_err());
    assert!(DictionaryPair::new(&fine().patches(), 0, "fine").is_err());
    assert!(DictionaryPair::new(&fine().patches(), 12, "fine").is_err());
}

#[test]
fn fine_atoms_in_the_place_of_coarse_ones_bring_the_fine_terrain_back() {
    let (fine, coarse) = (fine(), coarse(&fine()));
    let pair = DictionaryPair::new(&fine.patches(), FACTOR, "fine").unwrap();
    let patches = coarse.patches();
    let found = Pursuit::new(pair.low(), 1, Choice::SmallestResidual).unwrap().decompose(&patches).unwrap();
    let terrain = SparseTerrain::of(&patches, &found, pair.low().clone()).unwrap();
    let terrain = terrain.with_dictionary(pair.high().clone()).unwrap();
    let rebuilt = terrain.raster(FACTOR).unwrap();
    // Away from the borders, where patches of the coarse terrain are not those of the pair.
    for row in 24..72 {
        for col in 24..72 {
            let (a, b) = (fine.cells[row * 96 + col], rebuilt[row * 96 + col]);
            assert!((a - b).abs() < 0.02, "{row} {col}: {a} {b}");
            let at = terrain.elevation_m((row as f64 + 0.5) / 4.0, (col as f64 + 0.5) / 4.0).unwrap();
            assert_eq!(at as f32, b);
        }
    }
}

#[test]
fn learned_pairs_stay_pairs() {
    let pair = DictionaryPair::new(&fine().patches(), FACTOR, "fine").unwrap();
    let samples = Samples::new(&coarse(&fine()).patches(), "coarse");
    let how = Learning { iterations: 3, sparsity: 1, choice: Choice::SmallestResidual };
    let learned = learn_constrained(&samples, pair.low(), (6, 1), &how, &Watch::default()).unwrap();
    let chosen = pair.select(&learned.dictionary).unwrap();
    assert_eq!(chosen.low(), &learned.dictionary);
    for i in 0..6 {
        let k = (0..pair.low().len()).find(|&k| pair.low().origin(k) == chosen.low().origin(i)).unwrap();
        assert_eq!(pair.high().atom(k), chosen.high().atom(i));
    }
    assert!(pair.select(&samples.into_dictionary()).is_err());
}
