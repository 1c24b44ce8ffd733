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
        between(&self.z_m, self.size, at)
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

    /// The means of so many blocks in each direction.
    pub(super) fn wide(&self, blocks: usize) -> Self {
        Self::of(&self.z_m, self.size, self.size.map(|count| count.div_ceil(blocks)))
    }

    /// The ground, raised by some times what another lacks beside it, in the mean of [`WIDE`] by [`WIDE`] blocks.
    pub(super) fn corrected(&self, other: &Self, times: f32) -> Self {
        let lacking: Vec<f32> = self.z_m.iter().zip(&other.z_m).map(|(wanted, own)| wanted - own).collect();
        let lacking = Self { size: self.size, z_m: lacking }.wide(WIDE);
        let middle = |at: usize, count: usize| (at as f64 + 0.5) / count as f64;
        let [rows, cols] = self.size;
        let raised = |(block, z): (usize, &f32)| {
            z + times * lacking.at([middle(block / cols, rows), middle(block % cols, cols)])
        };
        Self { size: self.size, z_m: self.z_m.iter().enumerate().map(raised).collect() }
    }
}

/// The value of blocks at a place, `at` being the shares of their height and width that lie before: bilinear between their
/// centres.
pub(super) fn between(values: &[f32], [rows, cols]: [usize; 2], at: [f64; 2]) -> f32 {
    let part = |at: f64, count: usize| {
        let at = (at * count as f64 - 0.5).clamp(0.0, count as f64 - 1.0);
        let first = (at as usize).min(count.saturating_sub(2));
        (first, (at - first as f64) as f32)
    };
    let ((row, down), (col, right)) = (part(at[0], rows), part(at[1], cols));
    let value = |row: usize, col: usize| values[row.min(rows - 1) * cols + col.min(cols - 1)];
    let line = |row: usize| value(row, col) + right * (value(row, col + 1) - value(row, col));
    line(row) + down * (line(row + 1) - line(row))
}

/// Blocks of which one mean is corrected, in each direction.
const WIDE: usize = 5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_and_what_is_between() {
        let cells: Vec<f32> = (0..24).map(|i| (i / 6) as f32 * 10.0 + (i % 6) as f32).collect();
        let ground = Ground::of(&cells, [4, 6], [2, 3]);
        assert_eq!(ground.z_m, [5.5, 7.5, 9.5, 25.5, 27.5, 29.5]);
        // Centres of blocks, the middle, and beyond the outermost centres.
        assert_eq!(ground.at([0.25, 0.5]), 7.5);
        assert_eq!(ground.at([0.5, 0.5]), 17.5);
        assert_eq!(ground.at([0.0, 0.0]), 5.5);
        assert_eq!(ground.at([1.0, 1.0]), 29.5);
        let part = ground.part([4, 6], [0, 0], [4, 4]);
        assert_eq!(part.size, [2, 2]);
        assert_eq!(part.z_m, [5.5, 7.5, 25.5, 27.5]);
    }

    #[test]
    fn corrections_are_of_wide_means() {
        let wanted = Ground { size: [5, 10], z_m: vec![100.0; 50] };
        let own = Ground { size: [5, 10], z_m: (0..50).map(|i| if i % 10 < 5 { 90.0 } else { 120.0 }).collect() };
        let corrected = wanted.corrected(&own, 2.0);
        // Ten too low in the west, twenty too high in the east.
        assert_eq!((corrected.z_m[0], corrected.z_m[9]), (120.0, 60.0));
        assert_eq!(wanted.corrected(&wanted, 2.0), wanted);
    }
}
