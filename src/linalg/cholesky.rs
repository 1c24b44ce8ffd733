//! Equations with a symmetric matrix.

/// Solves `matrix x = right` for several right sides at once, in their place: `matrix` is symmetric and positive definite
/// with `size` rows, of which only the lower triangle is read; `right` has a row of values for each of them. Returns
/// whether the matrix was positive definite; the values mean nothing where it was not.
///
/// # Complexity
/// A third of the cube of the size, and twice its square for each right side (Cholesky).
pub(crate) fn solve(mut matrix: Vec<f64>, size: usize, right: &mut [f64]) -> bool {
    debug_assert_eq!(matrix.len(), size * size, "a square matrix");
    let cols = right.len() / size.max(1);
    for i in 0..size {
        for j in 0..=i {
            let (upper, row) = matrix.split_at_mut(i * size);
            let other = if j == i { &row[..j] } else { &upper[j * size..][..j] };
            let left = row[j] - row[..j].iter().zip(other).map(|(a, b)| a * b).sum::<f64>();
            if j < i {
                row[j] = left / upper[j * (size + 1)];
            } else if left > 0.0 {
                row[i] = left.sqrt();
            } else {
                return false;
            }
        }
    }
    // Forwards with the triangle, then backwards with its transpose; whole rows at once.
    for i in 0..size {
        let (done, rest) = right.split_at_mut(i * cols);
        let own = &mut rest[..cols];
        for (j, line) in done.chunks_exact(cols.max(1)).enumerate() {
            take(own, matrix[i * size + j], line);
        }
        own.iter_mut().for_each(|value| *value /= matrix[i * (size + 1)]);
    }
    for i in (0..size).rev() {
        let (own, done) = right[i * cols..].split_at_mut(cols);
        for (j, line) in (i + 1..).zip(done.chunks_exact(cols.max(1))) {
            take(own, matrix[j * size + i], line);
        }
        own.iter_mut().for_each(|value| *value /= matrix[i * (size + 1)]);
    }
    true
}

/// Takes a multiple of a line away.
fn take(own: &mut [f64], factor: f64, line: &[f64]) {
    own.iter_mut().zip(line).for_each(|(value, other)| *value -= factor * other);
}

#[cfg(test)]
mod tests {
    use super::super::Gram;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn solutions_solve(size in 1usize..8, cols in 0usize..4, values in prop::collection::vec(-3.0f64..3.0, 96)) {
            let mut gram = Gram::new(size);
            gram.add(&values[..8 * size]);
            let mut matrix = gram.finish();
            (0..size).for_each(|i| matrix[i * (size + 1)] += 0.5);
            let right = &values[64..64 + size * cols];
            let mut found = right.to_vec();
            prop_assert!(solve(matrix.clone(), size, &mut found));
            for i in 0..size {
                for k in 0..cols {
                    let sum: f64 = (0..size).map(|j| matrix[i * size + j] * found[j * cols + k]).sum();
                    prop_assert!((sum - right[i * cols + k]).abs() < 1e-9, "{}", sum);
                }
            }
        }
    }

    #[test]
    fn what_is_not_positive_is_refused() {
        assert!(!solve(vec![1.0, 0.0, 2.0, 1.0], 2, &mut [1.0, 1.0]));
        assert!(!solve(vec![0.0], 1, &mut [1.0]));
        assert!(!solve(vec![f64::NAN], 1, &mut [1.0]));
    }
}
