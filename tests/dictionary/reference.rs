//! Pursuit as section 4.3 of the paper writes it: for every candidate the normal equations, solved anew.

use orograph::dictionary::{Choice, Dictionary, Patches};

/// A patch as the reference sees it: cells that count, their weights and elevations.
pub struct RefPatch {
    cells: Vec<usize>,
    weights: Vec<f64>,
    elevation_m: Vec<f64>,
}

impl RefPatch {
    /// The patch at position `i` of `patches`, cut from the raster anew.
    pub fn new(patches: &Patches, i: usize, cells_m: &[f32]) -> Self {
        let layout = patches.layout();
        let (top, left) = layout.corner(patches.places()[i] as usize);
        let side = layout.shape().side();
        let mut patch = Self { cells: vec![], weights: vec![], elevation_m: vec![] };
        for k in 0..side * side {
            let (row, col) = (top + (k / side) as i64, left + (k % side) as i64);
            let inside = (0..layout.rows() as i64).contains(&row) && (0..layout.cols() as i64).contains(&col);
            let centre = |i: usize| (i as f64 + 0.5) / (side as f64 / 2.0) - 1.0;
            let square = centre(k % side).powi(2) + centre(k / side).powi(2);
            if inside && square < 1.0 {
                let z = cells_m[row as usize * layout.cols() + col as usize];
                if !z.is_nan() {
                    patch.cells.push(k);
                    patch.weights.push((1.0 - square).powi(3));
                    patch.elevation_m.push(f64::from(z));
                }
            }
        }
        patch
    }

    fn column(&self, dictionary: &Dictionary, atom: u32) -> Vec<f64> {
        self.cells.iter().map(|&k| f64::from(dictionary.atom(atom as usize)[k])).collect()
    }

    fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        self.weights.iter().zip(a).zip(b).map(|((w, a), b)| w * a * b).sum()
    }

    /// What the constant and some atoms leave of a vector.
    fn residual(&self, vector: &[f64], dictionary: &Dictionary, atoms: &[u32]) -> Vec<f64> {
        let mut columns = vec![vec![1.0; self.cells.len()]];
        columns.extend(atoms.iter().map(|&atom| self.column(dictionary, atom)));
        let matrix: Vec<Vec<f64>> =
            columns.iter().map(|a| columns.iter().map(|b| self.product(a, b)).collect()).collect();
        let right: Vec<f64> = columns.iter().map(|a| self.product(a, vector)).collect();
        let x = solve(matrix, right);
        (0..vector.len()).map(|i| vector[i] - x.iter().zip(&columns).map(|(x, c)| x * c[i]).sum::<f64>()).collect()
    }

    /// Square of what some atoms and a constant leave of the patch, at best.
    pub fn error(&self, dictionary: &Dictionary, atoms: &[u32]) -> f64 {
        let residual = self.residual(&self.elevation_m, dictionary, atoms);
        self.product(&residual, &residual)
    }

    /// The same with the coefficients and the mean given.
    pub fn error_of(&self, dictionary: &Dictionary, atoms: &[u32], parts: &[f64], mean_m: f64) -> f64 {
        let mut residual: Vec<f64> = self.elevation_m.iter().map(|z| z - mean_m).collect();
        for (&atom, part) in atoms.iter().zip(parts) {
            residual.iter_mut().zip(self.column(dictionary, atom)).for_each(|(r, v)| *r -= part * v);
        }
        self.product(&residual, &residual)
    }

    /// How well each atom does as the next one: what is to be largest, or `None` for those that may not be chosen.
    pub fn merits(&self, dictionary: &Dictionary, atoms: &[u32], choice: Choice) -> Vec<Option<f64>> {
        let residual = self.residual(&self.elevation_m, dictionary, atoms);
        let before = self.product(&residual, &residual);
        (0..dictionary.len() as u32)
            .map(|k| {
                let column = self.column(dictionary, k);
                let first = self.residual(&column, dictionary, &[]);
                let left = self.residual(&column, dictionary, atoms);
                let (first, left) = (self.product(&first, &first), self.product(&left, &left));
                if atoms.contains(&k) {
                    return None;
                }
                match choice {
                    Choice::SmallestResidual => {
                        let with: Vec<u32> = atoms.iter().copied().chain([k]).collect();
                        // Near the limit either answer is right.
                        (left > 1.1e-4).then(|| before - self.error(dictionary, &with))
                    }
                    Choice::LargestCorrelation => {
                        (first > 1.1e-4).then(|| self.product(&residual, &column).powi(2) / first)
                    }
                }
            })
            .collect()
    }
}

/// Solves by elimination with the largest pivot.
fn solve(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let n = right.len();
    for i in 0..n {
        let pivot = (i..n).max_by(|&a, &b| matrix[a][i].abs().total_cmp(&matrix[b][i].abs())).unwrap();
        matrix.swap(i, pivot);
        right.swap(i, pivot);
        for j in i + 1..n {
            let part = matrix[j][i] / matrix[i][i];
            let (above, below) = matrix.split_at_mut(j);
            below[0].iter_mut().zip(&above[i]).for_each(|(value, pivot)| *value -= part * pivot);
            right[j] -= part * right[i];
        }
    }
    let mut x = vec![0.0; n];
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| matrix[i][k] * x[k]).sum();
        x[i] = (right[i] - known) / matrix[i][i];
    }
    x
}
