//! The leading eigenvector of a sum of outer products, which is the first singular vector of what was summed.

use super::{dot, quadratic};

/// Directions that one round searches.
const DIRECTIONS: usize = 8;
/// Most rounds; two or three are usual.
const ROUNDS: usize = 60;
/// Rounds end when the matrix turns the vector by less than this angle.
const ANGLE: f64 = 1e-9;
/// Rotations over all pairs that the small eigenproblem of a round takes at most.
const SWEEPS: usize = 30;

/// Turns `vector` into the unit eigenvector of the largest eigenvalue of a symmetric matrix without negative ones,
/// and returns that eigenvalue.
///
/// Each round searches the space of `x, Ax, A²x ...` for the unit vector of the largest `xᵀAx` (Lanczos 1950, with
/// all directions made orthogonal to each other, and restarted). It starts from `vector`, or from the matrix's column
/// of the largest diagonal value if that is nearer; as the start lies in the space, a round never makes it worse. A
/// matrix of zeros leaves the vector as it is and returns 0.
///
/// # Complexity
/// Eight times the square of the size, a round.
pub(crate) fn leading_eigenvector(matrix: &[f64], vector: &mut Vec<f64>) -> f64 {
    let size = vector.len();
    debug_assert_eq!(matrix.len(), size * size, "a square matrix");
    let diagonal = |i: usize| matrix[i * (size + 1)];
    let largest = (0..size).fold(0, |best, i| if diagonal(i) > diagonal(best) { i } else { best });
    if diagonal(largest).is_nan() || diagonal(largest) <= 0.0 {
        return 0.0;
    }
    let column = normalised(&matrix[largest * size..][..size]);
    let start = normalised(vector);
    let quotient = |x: &[f64]| quadratic(matrix, x);
    *vector = if start.iter().all(|v| v.is_finite()) && quotient(&start) >= quotient(&column) { start } else { column };
    for _ in 0..ROUNDS {
        if !search(matrix, vector) {
            break;
        }
    }
    quotient(vector)
}

/// One round; whether another may be worth it.
fn search(matrix: &[f64], vector: &mut [f64]) -> bool {
    let size = vector.len();
    let mut directions = vec![vector.to_vec()];
    let mut images: Vec<Vec<f64>> = vec![];
    loop {
        let last = &directions[directions.len() - 1];
        let image: Vec<f64> = matrix.chunks_exact(size).map(|row| dot(row, last)).collect();
        let length = dot(&image, &image).sqrt();
        let mut next = image.clone();
        images.push(image);
        // Twice is enough (Kahan; Parlett 1998, section 6.9).
        for _ in 0..2 {
            for direction in &directions {
                let part = dot(&next, direction);
                next.iter_mut().zip(direction).for_each(|(value, d)| *value -= part * d);
            }
        }
        let left = dot(&next, &next).sqrt();
        if left.is_nan() || left <= ANGLE * length {
            if directions.len() == 1 {
                return false;
            }
            break;
        }
        if directions.len() == DIRECTIONS.min(size) {
            break;
        }
        directions.push(next.iter().map(|v| v / left).collect());
    }
    let count = directions.len();
    let mut small = vec![0.0; count * count];
    for i in 0..count {
        for j in 0..=i {
            small[i * count + j] = dot(&directions[i], &images[j]);
            small[j * count + i] = small[i * count + j];
        }
    }
    let parts = largest_of(&mut small, count);
    vector.fill(0.0);
    for (part, direction) in parts.iter().zip(&directions) {
        vector.iter_mut().zip(direction).for_each(|(value, d)| *value += part * d);
    }
    let length = dot(vector, vector).sqrt();
    vector.iter_mut().for_each(|v| *v /= length);
    true
}

/// The eigenvector of the largest eigenvalue of a small symmetric matrix.
fn largest_of(a: &mut [f64], size: usize) -> Vec<f64> {
    let vectors = diagonalise(a, size);
    let best = (0..size).fold(0, |best, i| if a[i * (size + 1)] > a[best * (size + 1)] { i } else { best });
    vectors[best * size..][..size].to_vec()
}

/// All eigenvalues of a symmetric matrix, the largest first, and their unit eigenvectors, one after the other.
///
/// # Complexity
/// Some ten times the cube of the size.
pub(crate) fn eigenvectors(matrix: &[f64], size: usize) -> (Vec<f64>, Vec<f64>) {
    let mut a = matrix.to_vec();
    let vectors = diagonalise(&mut a, size);
    let mut order: Vec<usize> = (0..size).collect();
    order.sort_by(|&i, &j| a[j * (size + 1)].total_cmp(&a[i * (size + 1)]));
    let values = order.iter().map(|&i| a[i * (size + 1)]).collect();
    (values, order.iter().flat_map(|&i| vectors[i * size..][..size].iter().copied()).collect())
}

/// Leaves the eigenvalues of a symmetric matrix on its diagonal and returns the eigenvectors, by rotations that take away
/// one value beside the diagonal after the other (Jacobi 1846).
fn diagonalise(a: &mut [f64], size: usize) -> Vec<f64> {
    let mut vectors = vec![0.0; size * size];
    (0..size).for_each(|i| vectors[i * (size + 1)] = 1.0);
    for _ in 0..SWEEPS {
        let mut turned = false;
        for p in 0..size {
            for q in p + 1..size {
                let (app, aqq, apq) = (a[p * (size + 1)], a[q * (size + 1)], a[p * size + q]);
                if apq.abs() <= 1e-17 * (app.abs() + aqq.abs()) {
                    continue;
                }
                turned = true;
                let theta = (aqq - app) / (2.0 * apq);
                let sign = if theta < 0.0 { -1.0 } else { 1.0 };
                let t = sign / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for k in 0..size {
                    let (x, y) = (a[k * size + p], a[k * size + q]);
                    (a[k * size + p], a[k * size + q]) = (c * x - s * y, s * x + c * y);
                }
                for k in 0..size {
                    let (x, y) = (a[p * size + k], a[q * size + k]);
                    (a[p * size + k], a[q * size + k]) = (c * x - s * y, s * x + c * y);
                    let (x, y) = (vectors[p * size + k], vectors[q * size + k]);
                    (vectors[p * size + k], vectors[q * size + k]) = (c * x - s * y, s * x + c * y);
                }
            }
        }
        if !turned {
            break;
        }
    }
    vectors
}

/// The vector with length 1; not numbers where it is zero.
fn normalised(vector: &[f64]) -> Vec<f64> {
    let length = dot(vector, vector).sqrt();
    vector.iter().map(|v| v / length).collect()
}

#[cfg(test)]
mod tests {
    use super::super::Gram;
    use super::*;
    use proptest::prelude::*;

    /// All eigenvalues, by rotations that take away one pair after the other (Jacobi 1846).
    fn jacobi(matrix: &[f64], size: usize) -> Vec<f64> {
        let mut a = matrix.to_vec();
        for _ in 0..60 {
            for p in 0..size {
                for q in p + 1..size {
                    let apq = a[p * size + q];
                    if apq == 0.0 {
                        continue;
                    }
                    let theta = (a[q * size + q] - a[p * size + p]) / (2.0 * apq);
                    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                    let c = 1.0 / (t * t + 1.0).sqrt();
                    let s = t * c;
                    for k in 0..size {
                        let (x, y) = (a[k * size + p], a[k * size + q]);
                        (a[k * size + p], a[k * size + q]) = (c * x - s * y, s * x + c * y);
                    }
                    for k in 0..size {
                        let (x, y) = (a[p * size + k], a[q * size + k]);
                        (a[p * size + k], a[q * size + k]) = (c * x - s * y, s * x + c * y);
                    }
                }
            }
        }
        (0..size).map(|i| a[i * (size + 1)]).collect()
    }

    proptest! {
        #[test]
        fn it_is_the_largest_that_jacobi_finds(
            size in 1usize..12,
            count in 0usize..20,
            values in prop::collection::vec(-10.0f64..10.0, 20 * 12),
            start in prop::collection::vec(-1.0f64..1.0, 12),
        ) {
            let mut gram = Gram::new(size);
            gram.add(&values[..count * size]);
            let matrix = gram.finish();
            let mut vector = start[..size].to_vec();
            let value = leading_eigenvector(&matrix, &mut vector);
            let largest = jacobi(&matrix, size).into_iter().fold(0.0, f64::max);
            prop_assert!((value - largest).abs() <= 1e-7 * largest, "{value}, not {largest}");
            if value > 0.0 {
                prop_assert!((dot(&vector, &vector) - 1.0).abs() < 1e-12);
                // Nearly equal eigenvalues leave the vector open, but never by more than their difference allows.
                let off: f64 = matrix
                    .chunks(size)
                    .zip(&vector)
                    .map(|(row, v)| (dot(row, &vector) - value * v).powi(2))
                    .sum::<f64>()
                    .sqrt();
                prop_assert!(off <= 1e-4 * largest, "{off}");
            }
        }
    }

    #[test]
    fn all_eigenvectors_in_order() {
        let matrix = [2.0, -1.0, 0.0, -1.0, 2.0, -1.0, 0.0, -1.0, 2.0];
        let (values, vectors) = eigenvectors(&matrix, 3);
        let root = 2.0f64.sqrt();
        for (value, known) in values.iter().zip([2.0 + root, 2.0, 2.0 - root]) {
            assert!((value - known).abs() < 1e-12, "{values:?}");
        }
        for (value, vector) in values.iter().zip(vectors.chunks(3)) {
            for (row, v) in matrix.chunks(3).zip(vector) {
                assert!((dot(row, vector) - value * v).abs() < 1e-12, "{vectors:?}");
            }
        }
    }

    #[test]
    fn a_start_at_right_angles_does_not_stop_it() {
        let matrix = [4.0, 0.0, 0.0, 1.0];
        let mut vector = vec![0.0, 1.0];
        assert_eq!(leading_eigenvector(&matrix, &mut vector), 4.0);
        assert_eq!(vector, [1.0, 0.0]);
    }

    #[test]
    fn zeros_have_no_direction() {
        let mut vector = vec![0.6, 0.8];
        assert_eq!(leading_eigenvector(&[0.0; 4], &mut vector), 0.0);
        assert_eq!(vector, [0.6, 0.8]);
    }
}
