//! Cubic convolution (Keys 1981, doi:10.1109/TASSP.1981.1163711, with a = -1/2), which is what `gdalwarp -r cubic` does
//! when it enlarges by a whole number.

use super::plane::Plane;
use crate::linalg::vectorised;

/// Cells at each side of a plane that enlarging takes beyond those that it enlarges.
pub(super) const MARGIN: usize = 2;

/// Enlarges planes by a whole factor.
#[derive(Clone, Debug)]
pub struct Bicubic {
    factor: usize,
    phases: Vec<Phase>,
}

/// The cells of one place within a coarse cell.
#[derive(Clone, Copy, Debug)]
struct Phase {
    /// First of the four coarse cells, counted from [`MARGIN`] before the one in which the fine cell lies.
    first: usize,
    weights: [f64; 4],
}

/// The kernel at a distance in coarse cells.
pub fn cubic(distance: f64) -> f64 {
    let x = distance.abs();
    if x < 1.0 {
        (1.5 * x - 2.5) * x * x + 1.0
    } else if x < 2.0 {
        ((-0.5 * x + 2.5) * x - 4.0) * x + 2.0
    } else {
        0.0
    }
}

impl Bicubic {
    /// For `factor` fine cells in each row and column of a coarse one.
    pub fn new(factor: usize) -> Self {
        let phase = |k: usize| {
            // Centres of fine cells, from the centre of the coarse one.
            let at = (k as f64 + 0.5) / factor as f64 - 0.5;
            let first = if at < 0.0 { 0 } else { 1 };
            let weights = [0, 1, 2, 3].map(|j| cubic(at - ((first + j) as f64 - MARGIN as f64)));
            Phase { first, weights }
        };
        Self { factor, phases: (0..factor).map(phase).collect() }
    }

    /// The factor.
    pub fn factor(&self) -> usize {
        self.factor
    }

    /// The finer plane of all cells but two at each side.
    ///
    /// # Panics
    /// When there are fewer than four rows or columns.
    #[must_use]
    pub fn enlarged(&self, plane: &Plane) -> Plane {
        let (rows, cols) = (plane.rows() - 2 * MARGIN, plane.cols() - 2 * MARGIN);
        let fine = cols * self.factor;
        let mut heights = vec![0.0; rows * self.factor * fine];
        let mut line = vec![0.0; plane.cols()];
        for (row, out) in heights.chunks_exact_mut(fine.max(1)).enumerate() {
            let phase = &self.phases[row % self.factor];
            let top = row / self.factor + phase.first;
            let lines = [0, 1, 2, 3].map(|j| plane.row(top + j));
            vectorised(|| {
                combine(&mut line, lines, phase.weights);
                for (k, phase) in self.phases.iter().enumerate() {
                    let w = phase.weights;
                    let cells = line[phase.first..].windows(4);
                    for (out, cells) in out.chunks_exact_mut(self.factor).zip(cells) {
                        out[k] = four(w, [cells[0], cells[1], cells[2], cells[3]]);
                    }
                }
            });
        }
        Plane::new(rows * self.factor, fine, heights)
    }

    /// What enlarging and then averaging does to a row of single cells: weights of the cells -2 to 2.
    pub(super) fn there_and_back(&self) -> [f64; 5] {
        let mut weights = [0.0; 5];
        for phase in &self.phases {
            for (j, weight) in phase.weights.iter().enumerate() {
                weights[phase.first + j] += weight / self.factor as f64;
            }
        }
        weights
    }
}

/// One order of the sum for rows and columns; mirrored weights give the same bits for mirrored cells.
#[inline(always)]
fn four(w: [f64; 4], v: [f64; 4]) -> f64 {
    (w[0] * v[0] + w[3] * v[3]) + (w[1] * v[1] + w[2] * v[2])
}

#[inline(always)]
fn combine(out: &mut [f64], lines: [&[f64]; 4], w: [f64; 4]) {
    let [a, b, c, d] = lines;
    for ((((out, a), b), c), d) in out.iter_mut().zip(a).zip(b).zip(c).zip(d) {
        *out = four(w, [*a, *b, *c, *d]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The definition: all sixteen products of a fine cell.
    fn plainly(plane: &Plane, factor: usize, row: usize, col: usize) -> f64 {
        let at = |cell: usize| (cell as f64 + 0.5) / factor as f64 - 0.5 + MARGIN as f64;
        let mut sum = 0.0;
        for r in 0..plane.rows() {
            for c in 0..plane.cols() {
                sum += cubic(at(row) - r as f64) * cubic(at(col) - c as f64) * plane.row(r)[c];
            }
        }
        sum
    }

    proptest! {
        #[test]
        fn it_is_the_definition(
            factor in 1usize..8,
            rows in 5usize..9,
            cols in 5usize..9,
            heights in prop::collection::vec(-500.0f64..9000.0, 81),
        ) {
            let plane = Plane::new(rows, cols, heights[..rows * cols].to_vec());
            let fine = Bicubic::new(factor).enlarged(&plane);
            prop_assert_eq!((fine.rows(), fine.cols()), ((rows - 4) * factor, (cols - 4) * factor));
            for row in 0..fine.rows() {
                for col in 0..fine.cols() {
                    let known = plainly(&plane, factor, row, col);
                    prop_assert!((fine.row(row)[col] - known).abs() < 1e-8, "{} {}: {}", row, col, known);
                }
            }
        }
    }

    #[test]
    fn slopes_stay_slopes() {
        let plane = Plane::new(6, 6, (0..36).map(|i| f64::from(i % 6) * 4.0 - f64::from(i / 6)).collect());
        let fine = Bicubic::new(4).enlarged(&plane);
        for row in 0..8 {
            for col in 0..8 {
                let known = (2.0 - 0.375 + col as f64 / 4.0) * 4.0 - (2.0 - 0.375 + row as f64 / 4.0);
                assert!((fine.row(row)[col] - known).abs() < 1e-12, "{row} {col}");
            }
        }
    }
}
