//! How high the land is in the mean, here and there.

/// Mean elevations over blocks that cover a raster edge to edge.
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// Rows and columns of blocks.
    pub size: [usize; 2],
    /// Mean elevation of each block in metres, row by row.
    pub z_m: Vec<f32>,
}

impl Ground {
    /// The means of the blocks of a raster.
    pub fn of(z_m: &[f32], [rows, cols]: [usize; 2], size: [usize; 2]) -> Self {
        let mut sums = vec![(0.0_f64, 0_u32); size[0] * size[1]];
        for (row, line) in z_m.chunks_exact(cols.max(1)).enumerate() {
            let block_row = row * size[0] / rows;
            for (col, &z) in line.iter().enumerate().filter(|(_, z)| !z.is_nan()) {
                let (sum, count) = &mut sums[block_row * size[1] + col * size[1] / cols];
                (*sum, *count) = (*sum + f64::from(z), *count + 1);
            }
        }
        let z_m = sums.into_iter().map(|(sum, count)| (sum / f64::from(count.max(1))) as f32).collect();
        Self { size, z_m }
    }

    /// The elevation in metres at a place of the raster, `at` being the shares of its height and width that lie before:
    /// bilinear between the centres of the blocks.
    pub(super) fn at(&self, at: [f64; 2]) -> f32 {
        let [rows, cols] = self.size;
        let part = |at: f64, count: usize| {
            let at = (at * count as f64 - 0.5).clamp(0.0, count as f64 - 1.0);
            let first = (at as usize).min(count.saturating_sub(2));
            (first, (at - first as f64) as f32)
        };
        let ((row, down), (col, right)) = (part(at[0], rows), part(at[1], cols));
        let z = |row: usize, col: usize| self.z_m[row.min(rows - 1) * cols + col.min(cols - 1)];
        let line = |row: usize| z(row, col) + right * (z(row, col + 1) - z(row, col));
        line(row) + down * (line(row + 1) - line(row))
    }

    /// The ground under a window of the raster: from a row and column, of so many rows and columns.
    pub(super) fn part(&self, raster: [usize; 2], first: [usize; 2], size: [usize; 2]) -> Self {
        let blocks = [0, 1].map(|k| (self.size[k] * size[k]).div_ceil(raster[k].max(1)).max(1));
        let mut z_m = Vec::with_capacity(blocks[0] * blocks[1]);
        for row in 0..blocks[0] {
            for col in 0..blocks[1] {
                let at = |k: usize, block: usize| {
                    (first[k] as f64 + (block as f64 + 0.5) * size[k] as f64 / blocks[k] as f64) / raster[k] as f64
                };
                z_m.push(self.at([at(0, row), at(1, col)]));
            }
        }
        Self { size: blocks, z_m }
    }
}
