//! Sums with one order: equal terms give equal bits on every machine.

/// Partial sums that run side by side, so that vectors of any width give the same bits.
const LANES: usize = 8;

/// Sum of the products of two equally long vectors, in `f64`.
///
/// Term i goes to partial sum i mod 8, in rising order; the partial sums are then added in pairs.
#[inline(always)]
pub(crate) fn dot<A: Copy + Into<f64>, B: Copy + Into<f64>>(a: &[A], b: &[B]) -> f64 {
    debug_assert_eq!(a.len(), b.len(), "vectors of one length");
    let mut sums = [0.0f64; LANES];
    let (whole_a, rest_a) = a.as_chunks::<LANES>();
    let (whole_b, rest_b) = b.as_chunks::<LANES>();
    for (a, b) in whole_a.iter().zip(whole_b) {
        for lane in 0..LANES {
            sums[lane] += a[lane].into() * b[lane].into();
        }
    }
    for (lane, (&a, &b)) in rest_a.iter().zip(rest_b).enumerate() {
        sums[lane] += a.into() * b.into();
    }
    ((sums[0] + sums[4]) + (sums[2] + sums[6])) + ((sums[1] + sums[5]) + (sums[3] + sums[7]))
}

/// `xᵀ A x` of a square matrix, row by row.
#[inline(always)]
pub(crate) fn quadratic<X: Copy + Into<f64>>(matrix: &[f64], x: &[X]) -> f64 {
    matrix.chunks_exact(x.len()).zip(x).map(|(row, &value)| dot(row, x) * value.into()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_term_counts_once() {
        for length in 0..40 {
            let a: Vec<f32> = (0..length).map(|i| i as f32 + 1.0).collect();
            let b: Vec<f64> = (0..length).map(|i| f64::from(i) - 3.0).collect();
            let plain: f64 = a.iter().zip(&b).map(|(&a, &b)| f64::from(a) * b).sum();
            assert_eq!(dot(&a, &b), plain, "whole numbers, length {length}");
        }
    }

    #[test]
    fn quadratic_forms_are_sums_of_all_pairs() {
        let matrix = [2.0, 1.0, 0.0, 1.0, 3.0, -1.0, 0.0, -1.0, 4.0];
        assert_eq!(quadratic(&matrix, &[1.0f32, 2.0, 3.0]), 2.0 + 12.0 + 36.0 + 4.0 - 12.0);
    }
}
