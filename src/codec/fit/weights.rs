//! Weights of errors by least squares without negative weights.

use crate::codec::params::{ERROR_WEIGHTS, MAX_CODE, PassParams, weight_of};

/// Sums for the fit of the weights of errors: what each part of the expectation was, and what the error was.
pub(in crate::codec) struct ErrorFit {
    rows: Vec<([f32; ERROR_WEIGHTS], f32)>,
}

impl ErrorFit {
    /// From the parts of the expected error and the error of cells.
    pub(in crate::codec) fn new(rows: Vec<([f32; ERROR_WEIGHTS], f32)>) -> Self {
        Self { rows }
    }

    /// Codes of the best weights; those of parts that are 0 everywhere are 0.
    pub(in crate::codec) fn codes(&self, start: &PassParams) -> Option<[u8; ERROR_WEIGHTS]> {
        if self.rows.len() < 300 {
            return None;
        }
        let mut weights: [f64; ERROR_WEIGHTS] = start.weights.map(|weight| f64::from(weight) / 1024.0);
        for _ in 0..2 {
            let (matrix, right) = crate::codec::vectors::widest(
                #[inline(always)]
                || self.sums(&weights),
            );
            for _ in 0..60 {
                for k in 0..ERROR_WEIGHTS {
                    if matrix[k][k] <= 0.0 {
                        weights[k] = 0.0;
                        continue;
                    }
                    let mut sum = right[k];
                    for l in 0..ERROR_WEIGHTS {
                        if l != k {
                            sum -= matrix[k][l] * weights[l];
                        }
                    }
                    weights[k] = (sum / matrix[k][k]).max(0.0);
                }
            }
            weights[ERROR_WEIGHTS - 1] = weights[ERROR_WEIGHTS - 1].max(0.01);
        }
        Some(weights.map(|weight| code_of(weight * 1024.0)))
    }

    /// The normal equations, weighted by what the given weights expect.
    #[inline(always)]
    fn sums(&self, weights: &[f64; ERROR_WEIGHTS]) -> ([[f64; ERROR_WEIGHTS]; ERROR_WEIGHTS], [f64; ERROR_WEIGHTS]) {
        // Filled up to whole vectors.
        let mut matrix = [[0.0f64; ERROR_ROW]; ERROR_WEIGHTS];
        let mut right = [0.0f64; ERROR_WEIGHTS];
        for (parts, error) in &self.rows {
            let mut row = [0.0f64; ERROR_ROW];
            for (cell, &part) in row.iter_mut().zip(parts) {
                *cell = f64::from(part);
            }
            let expected: f64 = (0..ERROR_WEIGHTS).map(|k| weights[k] * row[k]).sum();
            let expected = expected.max(0.1 * row[ERROR_WEIGHTS - 1]).max(1e-3);
            let weight = 1.0 / (expected * expected.sqrt());
            for k in 0..ERROR_WEIGHTS {
                let weighted = weight * row[k];
                right[k] += weighted * f64::from(*error);
                for (sum, part) in matrix[k].iter_mut().zip(&row) {
                    *sum += weighted * part;
                }
            }
        }
        (std::array::from_fn(|k| std::array::from_fn(|l| matrix[k][l])), right)
    }
}

/// Error weights, filled up to whole vectors.
const ERROR_ROW: usize = ERROR_WEIGHTS.next_multiple_of(4);

/// The code whose weight is nearest.
fn code_of(weight: f64) -> u8 {
    (0..=MAX_CODE)
        .min_by(|&a, &b| {
            let miss = |code: u8| (f64::from(weight_of(code)) - weight).abs();
            miss(a).total_cmp(&miss(b))
        })
        .unwrap_or(0)
}
