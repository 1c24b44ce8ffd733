//! Small terrains: hills with creases and steps, with and without voids.

use orograph::dictionary::{PatchLayout, PatchShape, Patches, Raster};
use orograph::rng::Rng;
use proptest::prelude::*;

/// A terrain, and the patches to cut it into.
#[derive(Clone, Debug)]
pub struct Ground {
    pub rows: usize,
    pub cols: usize,
    pub cells: Vec<f32>,
    pub side: usize,
    pub step: Option<usize>,
}

impl Ground {
    pub fn patches(&self) -> Patches {
        let layout = PatchLayout::new(self.rows, self.cols, PatchShape::new(self.side).unwrap(), self.step).unwrap();
        Patches::new(&Raster::new(self.rows, self.cols, &self.cells).unwrap(), layout).unwrap()
    }
}

/// Terrain of a seed: `voids` of a hundred cells are missing.
pub fn terrain(rows: usize, cols: usize, seed: u64, voids: u64) -> Vec<f32> {
    let mut rng = Rng::new(seed);
    let (height, rough) = (rng.between(0.0, 8000.0), rng.between(0.0, 30.0));
    let waves: Vec<[f64; 3]> =
        (0..4).map(|_| [rng.between(-0.3, 0.3), rng.between(-0.3, 0.3), rng.between(0.0, 200.0)]).collect();
    let mut cells = vec![];
    for row in 0..rows {
        for col in 0..cols {
            let mut z = height + rng.between(-rough, rough);
            for [down, right, size] in &waves {
                // Triangle waves, which need no library.
                let phase = (row as f64 * down + col as f64 * right).rem_euclid(2.0);
                z += size * (1.0 - phase).abs();
            }
            cells.push(if rng.below(100) < voids { f32::NAN } else { z as f32 });
        }
    }
    cells
}

/// Terrains of all sizes, among them flat ones and ones smaller than a patch.
pub fn any_ground() -> impl Strategy<Value = Ground> {
    (1usize..40, 1usize..40, 3usize..11, any::<u64>(), 0u64..5, any::<bool>()).prop_map(
        |(rows, cols, side, seed, kind, tight)| {
            let cells = match kind {
                0 => vec![1234.5; rows * cols],
                1 => terrain(rows, cols, seed, 10),
                2 => terrain(rows, cols, seed, 70),
                _ => terrain(rows, cols, seed, 0),
            };
            Ground { rows, cols, cells, side, step: tight.then_some(side.div_ceil(3)) }
        },
    )
}
