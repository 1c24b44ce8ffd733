//! Products of large matrices, as fast as the processor can.
#![allow(unsafe_code, reason = "matrixmultiply takes pointers; lengths are checked here")]

/// Rounding unit of `f32`.
const UNIT: f64 = 1.0 / (1u64 << 24) as f64;

/// `out = a bᵀ`: `a` has rows of `inner` values, `b` too, `out` one row for each row of `a` and one column for each
/// row of `b`; all row by row.
///
/// The last bits of `out` depend on the processor; [`product_error`] bounds the difference.
///
/// # Panics
/// When the lengths do not fit.
pub(crate) fn product(a: &[f32], b: &[f32], inner: usize, out: &mut [f32]) {
    assert!(inner > 0 && a.len().is_multiple_of(inner) && b.len().is_multiple_of(inner), "whole rows");
    let (rows, cols) = (a.len() / inner, b.len() / inner);
    assert_eq!(out.len(), rows * cols, "one value for each pair of rows");
    // SAFETY: with these strides the product reads rows * inner values of `a`, cols * inner of `b`, and writes
    // rows * cols of `out`, which is what they hold; `out` is borrowed alone.
    unsafe {
        let (a, b, out) = (a.as_ptr(), b.as_ptr(), out.as_mut_ptr());
        let stride = inner as isize;
        matrixmultiply::sgemm(rows, inner, cols, 1.0, a, stride, 1, b, 1, stride, 0.0, out, cols as isize, 1);
    }
}

/// How far a value of [`product`] can be from the exact product of two rows of `inner` values whose lengths
/// multiply to 1.
///
/// Whatever the order of the sum, and whether products and additions are fused or not, each of the products goes
/// through at most `inner + 2` roundings (Higham 2002, Accuracy and stability of numerical algorithms, section 3.1):
/// the error is at most γ Σ|aᵢbᵢ|, which is at most γ |a||b| (Cauchy and Schwarz), with γ = nu / (1 - nu) for
/// n = `inner + 2`. Besides, each product can lose [`UNDERFLOW`].
pub(crate) fn product_error(inner: usize) -> f64 {
    let n = (inner + 2) as f64 * UNIT;
    n / (1.0 - n)
}

/// The smallest step of `f32`: what a term of a product can lose besides its rounding.
pub(crate) const UNDERFLOW: f64 = 1.401298464324817e-45;

#[cfg(test)]
mod tests {
    use super::super::dot;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn values_are_within_the_bound(
            inner in 1usize..90,
            rows in 1usize..6,
            cols in 1usize..40,
            values in prop::collection::vec(-1000.0f32..1000.0, 46 * 90),
        ) {
            let (a, b) = (&values[..rows * inner], &values[rows * inner..(rows + cols) * inner]);
            let mut out = vec![0.0; rows * cols];
            product(a, b, inner, &mut out);
            for (i, a) in a.chunks(inner).enumerate() {
                for (j, b) in b.chunks(inner).enumerate() {
                    let exact = dot(a, b);
                    let bound = product_error(inner) * (dot(a, a) * dot(b, b)).sqrt() + inner as f64 * UNDERFLOW;
                    prop_assert!((f64::from(out[i * cols + j]) - exact).abs() <= bound * (1.0 + 1e-9));
                }
            }
        }
    }
}
