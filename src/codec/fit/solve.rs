//! Small symmetric systems.

/// Solves the first `count` equations of a symmetric positive system by Cholesky's method; only the lower triangle is
/// read.
pub(in crate::codec) fn solve<const N: usize>(matrix: &mut [[f64; N]; N], right: &[f64; N], count: usize) -> [f64; N] {
    let mut x = [0.0; N];
    for i in 0..count {
        for j in 0..=i {
            let known: f64 = matrix[i][..j].iter().zip(&matrix[j][..j]).map(|(a, b)| a * b).sum();
            let sum = matrix[i][j] - known;
            matrix[i][j] = if i == j { sum.max(1e-12).sqrt() } else { sum / matrix[j][j] };
        }
    }
    for i in 0..count {
        let mut sum = right[i];
        for k in 0..i {
            sum -= matrix[i][k] * x[k];
        }
        x[i] = sum / matrix[i][i];
    }
    for i in (0..count).rev() {
        let mut sum = x[i];
        for k in i + 1..count {
            sum -= matrix[k][i] * x[k];
        }
        x[i] = sum / matrix[i][i];
    }
    x
}
