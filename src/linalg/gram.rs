//! Sums of outer products.

/// A sum of outer products `v vᵀ` of vectors of one length, in `f64`.
#[derive(Clone, Debug)]
pub(crate) struct Gram {
    size: usize,
    // Row by row; only the lower triangle is kept up until `finish`.
    sums: Vec<f64>,
}

impl Gram {
    /// The sum of nothing, for vectors of `size` values.
    pub(crate) fn new(size: usize) -> Self {
        Self { size, sums: vec![0.0; size * size] }
    }

    /// Adds the outer products of vectors that lie one behind the other, in their order.
    #[inline(always)]
    pub(crate) fn add(&mut self, vectors: &[f64]) {
        // Four at once go through memory only once; each sum still takes its terms in order.
        let mut quads = vectors.chunks_exact(4 * self.size);
        for quad in &mut quads {
            let (a, rest) = quad.split_at(self.size);
            let (b, rest) = rest.split_at(self.size);
            let (c, d) = rest.split_at(self.size);
            for i in 0..self.size {
                let sums = &mut self.sums[i * self.size..][..=i];
                let (ai, bi, ci, di) = (a[i], b[i], c[i], d[i]);
                for (j, sum) in sums.iter_mut().enumerate() {
                    *sum = (((*sum + ai * a[j]) + bi * b[j]) + ci * c[j]) + di * d[j];
                }
            }
        }
        for vector in quads.remainder().chunks_exact(self.size) {
            for i in 0..self.size {
                for (sum, value) in self.sums[i * self.size..][..=i].iter_mut().zip(vector) {
                    *sum += vector[i] * value;
                }
            }
        }
    }

    /// Adds another sum.
    pub(crate) fn join(&mut self, other: &Self) {
        for (sum, other) in self.sums.iter_mut().zip(&other.sums) {
            *sum += other;
        }
    }

    /// The whole symmetric matrix, row by row.
    pub(crate) fn finish(mut self) -> Vec<f64> {
        for i in 0..self.size {
            for j in 0..i {
                self.sums[j * self.size + i] = self.sums[i * self.size + j];
            }
        }
        self.sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_sum_of_all_outer_products() {
        for count in 0..11 {
            let vectors: Vec<f64> = (0..count * 3).map(|i| f64::from((i * 7) % 11) - 4.0).collect();
            let mut gram = Gram::new(3);
            let (first, second) = vectors.split_at(vectors.len() / 2 / 3 * 3);
            gram.add(first);
            let mut other = Gram::new(3);
            other.add(second);
            gram.join(&other);
            let matrix = gram.finish();
            for i in 0..3 {
                for j in 0..3 {
                    let plain: f64 = vectors.chunks(3).map(|v| v[i] * v[j]).sum();
                    assert_eq!(matrix[i * 3 + j], plain, "{count} vectors, {i} {j}");
                }
            }
        }
    }
}
