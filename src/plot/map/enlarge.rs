//! A relief that is coarser than the picture, interpolated to its size.

use super::raster::Averaged;
use rayon::prelude::*;

impl Averaged {
    /// The relief with so many rows and columns, at least as many as it has.
    pub(super) fn enlarged(self, rows: usize, cols: usize) -> Self {
        let (from, to) = ((self.rows, self.cols), (rows, cols));
        if from == to {
            return self;
        }
        let (y, x) = (from.0 as f64 / to.0 as f64, from.1 as f64 / to.1 as f64);
        // Between the widths of rows, as between their elevations.
        let width = |row: usize| {
            let at = ((row as f64 + 0.5) * y - 0.5).clamp(0.0, (from.0 - 1) as f64);
            let (low, share) = (at as usize, at.fract());
            let high = (low + 1).min(from.0 - 1);
            (self.cell_x_m[low] * (1.0 - share) + self.cell_x_m[high] * share) * x
        };
        Self {
            rows,
            cols,
            elevation_m: enlarge(&self.elevation_m, from, to, smooth),
            valid: enlarge(&self.valid, from, to, straight),
            sea: enlarge(&self.sea, from, to, straight),
            cell_x_m: (0..rows).map(width).collect(),
            cell_y_m: self.cell_y_m * y,
        }
    }
}

/// Weights of the four cells round a point that lies so far behind the second of them.
type Kernel = fn(f32) -> [f32; 4];

/// Linear interpolation: never beyond the values of the cells.
fn straight(t: f32) -> [f32; 4] {
    [0.0, 1.0 - t, t, 0.0]
}

/// The cubic of Mitchell and Netravali (1988, Reconstruction filters in computer graphics) with B = C = 1/3,
/// as they advise: slopes without steps, ridges that stay sharp, faults of single cells that do not stand out.
fn smooth(t: f32) -> [f32; 4] {
    const B: f32 = 1.0 / 3.0;
    const C: f32 = 1.0 / 3.0;
    let near =
        |d: f32| ((12.0 - 9.0 * B - 6.0 * C) * d * d * d + (-18.0 + 12.0 * B + 6.0 * C) * d * d + 6.0 - 2.0 * B) / 6.0;
    let far = |d: f32| {
        ((-B - 6.0 * C) * d * d * d + (6.0 * B + 30.0 * C) * d * d + (-12.0 * B - 48.0 * C) * d + 8.0 * B + 24.0 * C)
            / 6.0
    };
    [far(1.0 + t), near(t), near(1.0 - t), far(2.0 - t)]
}

/// Four cells of a row or column of cells, and their weights.
struct Tap {
    cells: [usize; 4],
    weights: [f32; 4],
    /// The share of the third cell where only the two next ones are used.
    share: f32,
}

impl Tap {
    /// The value there. Next to voids the weight of a void goes to its neighbour.
    #[inline]
    fn value(&self, at: impl Fn(usize) -> f32) -> f32 {
        let values = self.cells.map(at);
        let sum: f32 = values.iter().zip(&self.weights).map(|(value, weight)| value * weight).sum();
        if sum.is_finite() {
            return sum;
        }
        match (values[1].is_finite(), values[2].is_finite()) {
            (true, true) => values[1] * (1.0 - self.share) + values[2] * self.share,
            (true, false) if self.share < 1.0 => values[1],
            (false, true) if self.share > 0.0 => values[2],
            _ => f32::NAN,
        }
    }
}

fn taps(from: usize, to: usize, kernel: Kernel) -> Vec<Tap> {
    let last = from as isize - 1;
    (0..to)
        .map(|i| {
            let at = ((i as f64 + 0.5) * from as f64 / to as f64 - 0.5).clamp(0.0, last as f64);
            let low = at.floor();
            let share = (at - low) as f32;
            // Cells beyond the edge are as those at it.
            let cells = [-1, 0, 1, 2].map(|step| (low as isize + step).clamp(0, last) as usize);
            let weights = if from == to { [0.0, 1.0, 0.0, 0.0] } else { kernel(share) };
            Tap { cells, weights, share }
        })
        .collect()
}

/// Interpolates between cell centres, from `from` to `to` rows and columns.
fn enlarge(plane: &[f32], from: (usize, usize), to: (usize, usize), kernel: Kernel) -> Vec<f32> {
    // A relief without voids or without sea has planes of one value.
    if let Some(&first) = plane.first().filter(|first| plane.iter().all(|value| value == *first)) {
        return vec![first; to.0 * to.1];
    }
    let (down, across) = (taps(from.0, to.0, kernel), taps(from.1, to.1, kernel));
    let mut wide = vec![f32::NAN; from.0 * to.1];
    wide.par_chunks_mut(to.1).zip(plane.par_chunks(from.1)).for_each(|(line, source)| {
        for (cell, tap) in line.iter_mut().zip(&across) {
            *cell = tap.value(|col| source[col]);
        }
    });
    let mut out = vec![f32::NAN; to.0 * to.1];
    out.par_chunks_mut(to.1).zip(&down).for_each(|(line, tap)| {
        for (col, cell) in line.iter_mut().enumerate() {
            *cell = tap.value(|row| wide[row * to.1 + col]);
        }
    });
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_stays_a_plane() {
        let plane: Vec<f32> = (0..8).flat_map(|r| (0..8).map(move |c| (r * 10 + c) as f32)).collect();
        for kernel in [straight as Kernel, smooth] {
            let out = enlarge(&plane, (8, 8), (32, 32), kernel);
            let at = |r: f64, c: f64| ((r + 0.5) / 4.0 - 0.5) * 10.0 + (c + 0.5) / 4.0 - 0.5;
            for (r, c) in (8..24).flat_map(|r| (8..24).map(move |c| (r, c))) {
                assert!((f64::from(out[r * 32 + c]) - at(r as f64, c as f64)).abs() < 1e-3, "{r} {c}");
            }
        }
    }

    #[test]
    fn weights_sum_to_one() {
        for kernel in [straight as Kernel, smooth] {
            for t in [0.0, 0.2, 0.5, 0.9] {
                assert!((kernel(t).iter().sum::<f32>() - 1.0).abs() < 1e-6, "{t}");
            }
        }
    }

    #[test]
    fn voids_stay_and_do_not_spread() {
        let hole = enlarge(&[1.0, f32::NAN, f32::NAN, f32::NAN], (2, 2), (8, 8), smooth);
        assert_eq!(hole[0], 1.0);
        assert!(hole[63].is_nan());
        let known = hole.iter().filter(|value| value.is_finite()).count();
        assert!((16..64).contains(&known), "{known}");
    }
}
