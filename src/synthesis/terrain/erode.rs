//! Rivers wear down the ground between what stands fast, at several scales (Argudo et al. 2019, section 6.3).

use super::ground::Ground;
use crate::erosion::{Drainage, Relief, incise};
use crate::error::Result;
use rayon::prelude::*;

/// Sides in metres of the cells on which rivers work, one after the other.
const SCALES_M: [f64; 3] = [100.0, 50.0, 30.0];
/// Steps in time on each.
const TURNS: usize = 3;
/// How far in metres what stands fast holds the ground up.
const RADIUS_M: f32 = 120.0;

/// Wears the ground down: at each scale some steps of the stream power law, of `strength` all together, on the means of
/// blocks of cells; what these lose the cells lose, the less the nearer they are to what stands fast, `clear_m` metres
/// away. That is the paper's uplift, g(d / R) = (1 - (d / R)²)³ of what was lost; here it is for whole ridges and for the
/// floors of valleys, not for peaks and saddles alone.
///
/// # Errors
/// As [`Relief::new`].
///
/// # Complexity
/// That of [`Drainage::of`], for each scale and step.
pub(super) fn erode(z_m: &mut [f32], clear_m: &[f32], size: [usize; 2], cell_m: [f64; 2], strength: f64) -> Result<()> {
    let mut last = 0;
    for scale_m in SCALES_M {
        let side = (scale_m / cell_m[0].max(cell_m[1])).round().max(1.0) as usize;
        // Coarse cells know no finer scales.
        if side == last {
            continue;
        }
        last = side;
        let blocks = size.map(|count| count.div_ceil(side));
        let before = Ground::of(z_m, size, blocks);
        let block_m = [0, 1].map(|k| cell_m[k] * size[1 - k] as f64 / blocks[1 - k] as f64);
        let mut relief = Relief::new(blocks[0], blocks[1], block_m, before.z_m.clone())?;
        for _ in 0..TURNS {
            let drainage = Drainage::of(&relief);
            let areas = drainage.areas_cells();
            incise(&mut relief, &drainage, &areas, strength / (TURNS * SCALES_M.len()) as f64);
        }
        let lost = relief.z_m().iter().zip(&before.z_m).map(|(after, before)| after - before).collect();
        let lost = Ground { size: blocks, z_m: lost };
        let lines = z_m.par_chunks_mut(size[1]).zip(clear_m.par_chunks(size[1])).enumerate();
        lines.for_each(|(row, (line, clear_m))| {
            let down = (row as f64 + 0.5) / size[0] as f64;
            for (col, (z, &clear_m)) in line.iter_mut().zip(clear_m).enumerate() {
                let near = (1.0 - (clear_m / RADIUS_M) * (clear_m / RADIUS_M)).max(0.0);
                *z += (1.0 - near * near * near) * lost.at([down, (col as f64 + 0.5) / size[1] as f64]).min(0.0);
            }
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slope with furrows, 30 m a cell.
    fn slope(rows: usize, cols: usize) -> Vec<f32> {
        (0..rows * cols).map(|i| (i / cols) as f32 * 12.0 + ((i % cols) * 7 % 5) as f32 * 6.0).collect()
    }

    #[test]
    fn what_stands_fast_stays_and_the_rest_comes_down() {
        let size = [40, 50];
        let before = slope(size[0], size[1]);
        let clear_m: Vec<f32> = (0..2000).map(|i| (i % 50) as f32 * 30.0).collect();
        let mut z_m = before.clone();
        erode(&mut z_m, &clear_m, size, [30.0; 2], 0.5).unwrap();
        let lost = |cols: std::ops::Range<usize>| -> f32 {
            (0..40).flat_map(|row| cols.clone().map(move |col| row * 50 + col)).map(|i| before[i] - z_m[i]).sum::<f32>()
                / (40 * cols.len()) as f32
        };
        assert_eq!(lost(0..1), 0.0);
        assert!(lost(1..3) < 0.5 * lost(10..40) && lost(10..40) > 1.0, "{} and {}", lost(1..3), lost(10..40));
        assert!(before.iter().zip(&z_m).all(|(before, after)| after <= before));
        let mut none = before.clone();
        erode(&mut none, &clear_m, size, [30.0; 2], 0.0).unwrap();
        assert_eq!(none, before);
    }

    #[test]
    fn single_cells_and_rows_stay() {
        for size in [[1, 1], [1, 7], [7, 1]] {
            let before = slope(size[0], size[1]);
            let mut z_m = before.clone();
            erode(&mut z_m, &vec![1000.0; before.len()], size, [30.0; 2], 1.0).unwrap();
            // All of them lie at the edge, where water leaves.
            assert_eq!(z_m, before);
        }
    }
}
