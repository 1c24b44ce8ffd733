//! How strong texture is, told by the terrain that it is laid on.

use super::plane::Plane;
use crate::linalg::{Gram, solve};

/// Cells at each side of a plane of which nothing is told.
pub(super) const STRENGTH_MARGIN: usize = 4;
/// What is measured around a cell: its slope, and its curvature at two scales.
pub(super) const MEASURES: usize = 3;
/// Parts of the mean strength that one cell's is taken to be uncertain by.
const UNCERTAIN: f64 = 0.1;

/// The mean square of texture as a sum of what is measured around a cell, each with a weight of its own. Slope and
/// curvature say more together than either: cliffs are steep and bent, valley floors neither.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Strength {
    pub(super) weights: [f64; MEASURES],
}

/// Sums of a regression of texture on what is measured.
pub(super) struct StrengthSums(Gram);

/// Mean squares around all cells but [`STRENGTH_MARGIN`] at each side, in square metres: of the rise to the next cell
/// in 3 x 3 cells, and of second differences in 3 x 3 and 7 x 7 cells.
fn measured(plane: &Plane) -> [Plane; MEASURES] {
    let (rows, cols) = (plane.rows() - 2, plane.cols() - 2);
    let (mut slopes, mut bends) = (Vec::with_capacity(rows * cols), Vec::with_capacity(rows * cols));
    for row in 1..=rows {
        let [above, own, below] = [row - 1, row, row + 1].map(|row| plane.row(row));
        for col in 1..=cols {
            let (across, down) = ((own[col + 1] - own[col - 1]) / 2.0, (below[col] - above[col]) / 2.0);
            slopes.push(across * across + down * down);
            let bend_across = (own[col + 1] - own[col]) - (own[col] - own[col - 1]);
            let bend_down = (below[col] - own[col]) - (own[col] - above[col]);
            let twist = ((below[col + 1] - below[col - 1]) - (above[col + 1] - above[col - 1])) / 4.0;
            bends.push(bend_across * bend_across + bend_down * bend_down + 2.0 * twist * twist);
        }
    }
    let (slopes, bends) = (Plane::new(rows, cols, slopes), Plane::new(rows, cols, bends));
    [mean_around(&slopes, 1).trimmed(2), mean_around(&bends, 1).trimmed(2), mean_around(&bends, 3)]
}

/// Means over squares of `2 * radius + 1` cells, of all cells but `radius` at each side; each summed on its own, so that
/// they are the same wherever the plane is cut.
fn mean_around(plane: &Plane, radius: usize) -> Plane {
    let side = 2 * radius + 1;
    let (rows, cols) = (plane.rows() - 2 * radius, plane.cols() - 2 * radius);
    let cells = (side * side) as f64;
    let mut means = Vec::with_capacity(rows * cols);
    let mut line = vec![0.0; plane.cols()];
    for row in 0..rows {
        line.copy_from_slice(plane.row(row));
        for other in 1..side {
            line.iter_mut().zip(plane.row(row + other)).for_each(|(sum, height)| *sum += height);
        }
        means.extend(line.windows(side).map(|window| window.iter().sum::<f64>() / cells));
    }
    Plane::new(rows, cols, means)
}

impl StrengthSums {
    pub(super) fn new() -> Self {
        Self(Gram::new(MEASURES + 1))
    }

    /// Adds a terrain: heights, the mean squares of its texture in square metres in each cell, and which cells are known.
    pub(super) fn add(&mut self, coarse: &Plane, squares: &Plane, known: &[bool]) {
        const FAR: usize = 2;
        if coarse.rows().min(coarse.cols()) <= 2 * STRENGTH_MARGIN + 1 {
            return;
        }
        let measures = measured(coarse);
        let around = mean_around(squares, FAR);
        let all = squares.heights_m();
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        for row in 0..measures[0].rows() {
            for col in 0..measures[0].cols() {
                let cell = [row + STRENGTH_MARGIN, col + STRENGTH_MARGIN];
                if !known[cell[0] * coarse.cols() + cell[1]] {
                    continue;
                }
                let size = around.row(cell[0] - FAR)[cell[1] - FAR].sqrt() + UNCERTAIN * mean.sqrt();
                let measure = |k: usize| measures[k].row(row)[col] / size;
                let values = [measure(0), measure(1), measure(2), squares.row(cell[0])[cell[1]] / size];
                if values.iter().all(|value| value.is_finite()) {
                    self.0.add(&values);
                }
            }
        }
    }

    /// The weights with the least squares of errors of which none is negative: the best of all choices of measures.
    pub(super) fn solved(&self) -> Strength {
        let sums = self.0.clone().finish();
        let at = |i: usize, j: usize| sums[i * (MEASURES + 1) + j];
        let mut best = ([0.0; MEASURES], 0.0);
        for chosen in 1..1usize << MEASURES {
            let own: Vec<usize> = (0..MEASURES).filter(|k| chosen >> k & 1 == 1).collect();
            let matrix = own.iter().flat_map(|&i| own.iter().map(move |&j| at(i, j))).collect();
            let right: Vec<f64> = own.iter().map(|&i| at(i, MEASURES)).collect();
            let mut found = right.clone();
            if !solve(matrix, own.len(), &mut found) || !found.iter().all(|weight| *weight >= 0.0) {
                continue;
            }
            let gain: f64 = found.iter().zip(&right).map(|(weight, right)| weight * right).sum();
            if gain > best.1 {
                let mut weights = [0.0; MEASURES];
                own.iter().zip(found).for_each(|(&k, weight)| weights[k] = weight);
                best = (weights, gain);
            }
        }
        Strength { weights: best.0 }
    }
}

impl Strength {
    /// So many times as strong.
    pub(super) fn times(self, factor: f64) -> Self {
        Self { weights: self.weights.map(|weight| weight * factor * factor) }
    }

    /// The root of the mean square of texture in metres, in all cells but [`STRENGTH_MARGIN`] at each side.
    pub(super) fn of(&self, coarse: &Plane) -> Plane {
        let [mut sums, bends, wide] = measured(coarse);
        let others = bends.heights_m().iter().zip(wide.heights_m());
        let [slope, bend, far] = self.weights;
        sums.heights_mut().iter_mut().zip(others).for_each(|(sum, (bends, wide))| {
            *sum = ((slope * *sum + bend * bends) + far * wide).sqrt();
        });
        sums
    }
}

/// A plane so many times finer, of all cells but one at each side, with straight lines between the middles of cells.
pub(super) fn bilinear(plane: &Plane, factor: usize) -> Plane {
    let (rows, cols) = (plane.rows() - 2, plane.cols() - 2);
    let phases: Vec<(usize, f64)> = (0..factor)
        .map(|k| {
            let at = (k as f64 + 0.5) / factor as f64 + 0.5;
            if at < 1.0 { (0, at) } else { (1, at - 1.0) }
        })
        .collect();
    let mut heights = Vec::with_capacity(rows * cols * factor * factor);
    let mut line = vec![0.0; plane.cols()];
    for row in 0..rows * factor {
        let (first, part) = phases[row % factor];
        let top = row / factor + first;
        let pairs = plane.row(top).iter().zip(plane.row(top + 1));
        line.iter_mut().zip(pairs).for_each(|(own, (a, b))| *own = a * (1.0 - part) + b * part);
        for cells in line.windows(3) {
            heights.extend(phases.iter().map(|&(first, part)| cells[first] * (1.0 - part) + cells[first + 1] * part));
        }
    }
    Plane::new(rows * factor, cols * factor, heights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    fn noise(rows: usize, cols: usize, seed: u64) -> Plane {
        let mut rng = Rng::new(seed);
        Plane::new(rows, cols, (0..rows * cols).map(|_| rng.unit() * 40.0).collect())
    }

    #[test]
    fn weights_are_found_again() {
        let coarse = noise(40, 50, 3);
        for weights in [[0.5, 0.25, 0.0], [0.0, 0.0, 2.0], [0.125, 0.0, 0.75]] {
            let strength = Strength { weights };
            let mut squares = Plane::new(40, 50, vec![1.0; 2000]);
            let found = strength.of(&coarse);
            for row in 0..found.rows() {
                for col in 0..found.cols() {
                    let value = found.row(row)[col];
                    squares.heights_mut()[(row + STRENGTH_MARGIN) * 50 + col + STRENGTH_MARGIN] = value * value;
                }
            }
            let mut sums = StrengthSums::new();
            sums.add(&coarse, &squares, &[true; 2000]);
            for (found, known) in sums.solved().weights.iter().zip(weights) {
                assert!((found - known).abs() < 1e-9, "{found} and {known}");
            }
        }
        assert_eq!(StrengthSums::new().solved().weights, [0.0; MEASURES]);
    }

    #[test]
    fn slopes_and_bends_are_their_definitions() {
        let plane = Plane::new(11, 11, (0..121).map(|i| f64::from(i % 11) * 3.0 - f64::from(i / 11) * 4.0).collect());
        let [slopes, bends, wide] = measured(&plane);
        assert_eq!(slopes.heights_m(), [25.0; 9]);
        assert_eq!(bends.heights_m(), [0.0; 9]);
        assert_eq!(wide.heights_m(), [0.0; 9]);
        let squared = Plane::new(9, 9, (0..81).map(|i| f64::from((i % 9) * (i % 9))).collect());
        assert_eq!(measured(&squared)[1].heights_m(), [4.0]);
    }

    #[test]
    fn lines_are_straight_between_middles() {
        let plane = Plane::new(4, 5, (0..20).map(|i| f64::from(i % 5) * 4.0 + f64::from(i / 5)).collect());
        let fine = bilinear(&plane, 4);
        assert_eq!((fine.rows(), fine.cols()), (8, 12));
        for row in 0..8 {
            for col in 0..12 {
                let known = (0.625 + col as f64 / 4.0) * 4.0 + 0.625 + row as f64 / 4.0;
                assert!((fine.row(row)[col] - known).abs() < 1e-12, "{row} {col}");
            }
        }
    }
}
