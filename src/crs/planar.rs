//! Euclidean distances between the cells of an affine grid, rotated or sheared ones included.

use super::metric::{Block, Metric, Place, SLACK, Vector};
use crate::grid::GeoTransform;

/// Plane geometry of a grid.
#[derive(Clone, Copy, Debug)]
pub struct Planar {
    /// Metres eastwards and northwards of one column to the right.
    col_m: (f64, f64),
    /// Metres eastwards and northwards of one row down.
    row_m: (f64, f64),
}

impl Planar {
    /// The metric of a grid whose coordinates are in units of `metres` metres.
    pub fn new(transform: &GeoTransform, metres: f64) -> Self {
        let t = &transform.0;
        Self { col_m: (t[1] * metres, t[4] * metres), row_m: (t[2] * metres, t[5] * metres) }
    }

    fn offset_m(&self, p: Place, q: Place) -> (f64, f64) {
        let (dr, dc) = ((q.0 - p.0) as f64, (q.1 - p.1) as f64);
        (dc * self.col_m.0 + dr * self.row_m.0, dc * self.col_m.1 + dr * self.row_m.1)
    }

    /// Area of a cell in square metres.
    pub fn cell_m2(&self) -> f64 {
        (self.col_m.0 * self.row_m.1 - self.col_m.1 * self.row_m.0).abs()
    }

    /// Least squared distance from `p` to the segment of places from `a` to `b`.
    fn segment2(&self, p: Place, a: Place, b: Place) -> f64 {
        let (ax, ay) = self.offset_m(p, a);
        let (bx, by) = self.offset_m(p, b);
        let (dx, dy) = (bx - ax, by - ay);
        let length2 = dx * dx + dy * dy;
        let t = if length2 > 0.0 { (-(ax * dx + ay * dy) / length2).clamp(0.0, 1.0) } else { 0.0 };
        let (x, y) = (ax + t * dx, ay + t * dy);
        x * x + y * y
    }

    /// The least distance, below `limit_m`, to a place on one of the lines `first`, `first + step`, ... of the grid:
    /// rows where `along_rows`, else columns, both counted from the own one.
    fn lines_m(&self, first: i64, step: i64, along_rows: bool, limit_m: f64) -> f64 {
        let (across, along) = if along_rows { (self.row_m, self.col_m) } else { (self.col_m, self.row_m) };
        let along2 = along.0 * along.0 + along.1 * along.1;
        let apart_m = (across.0 * along.1 - across.1 * along.0).abs() / along2.sqrt();
        let mut best_m = limit_m;
        let mut line = first;
        // A skewed grid may have its nearest place some lines further out.
        while (line.abs() as f64 * apart_m) <= best_m * SLACK {
            let t = -(line as f64) * (across.0 * along.0 + across.1 * along.1) / along2;
            for n in [t.floor() as i64, t.ceil() as i64] {
                let place = if along_rows { (line, n) } else { (n, line) };
                best_m = best_m.min(self.distance_m((0, 0), place));
            }
            line += step;
        }
        best_m
    }
}

impl Metric for Planar {
    #[inline]
    fn distance_m(&self, p: Place, q: Place) -> f64 {
        let (x, y) = self.offset_m(p, q);
        (x * x + y * y).sqrt()
    }

    fn vector(&self, p: Place, q: Place) -> Vector {
        let (x, y) = self.offset_m(p, q);
        let azimuth = if x == 0.0 && y == 0.0 { f64::NAN } else { x.atan2(y).to_degrees().rem_euclid(360.0) };
        Vector { distance_m: (x * x + y * y).sqrt(), azimuth }
    }

    #[inline]
    fn near2(&self, p: Place, q: Place) -> f64 {
        let (x, y) = self.offset_m(p, q);
        x * x + y * y
    }

    #[inline]
    fn block2(&self, p: Place, block: &Block) -> f64 {
        let (r, c) = (block.rows, block.cols);
        let row = p.0.clamp(r.0, r.1);
        let col = p.1.clamp(c.0, c.1);
        if (row, col) == p {
            return 0.0;
        }
        if self.row_m.0 == 0.0 && self.col_m.1 == 0.0 {
            return self.near2(p, (row, col));
        }
        // Sheared: the nearest point of a parallelogram that does not hold `p` is on one of its sides.
        let corners = [(r.0, c.0), (r.0, c.1), (r.1, c.1), (r.1, c.0)];
        let least = (0..4).map(|i| self.segment2(p, corners[i], corners[(i + 1) % 4])).fold(f64::INFINITY, f64::min);
        least / SLACK
    }

    #[inline]
    fn reach2(&self, near2: f64) -> f64 {
        near2 * SLACK
    }

    fn outside_m(&self, p: Place, rows: i64, cols: i64, limit_m: f64) -> Option<f64> {
        let best_m = self.lines_m(-1 - p.0, -1, true, limit_m);
        let best_m = self.lines_m(rows - p.0, 1, true, best_m);
        let best_m = self.lines_m(-1 - p.1, -1, false, best_m);
        let best_m = self.lines_m(cols - p.1, 1, false, best_m);
        (best_m < limit_m).then_some(best_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outside_slowly(metric: &Planar, p: Place, rows: i64, cols: i64) -> f64 {
        let mut best = f64::INFINITY;
        for row in -60..rows + 60 {
            for col in -60..cols + 60 {
                if !(0..rows).contains(&row) || !(0..cols).contains(&col) {
                    best = best.min(metric.distance_m(p, (row, col)));
                }
            }
        }
        best
    }

    #[test]
    fn nearest_outside_even_on_skewed_grids() {
        for t in [[0.0, 3.0, 0.0, 0.0, 0.0, -2.0], [0.0, 3.0, 1.0, 0.0, 0.5, -2.0], [0.0, 1.0, 7.4, 0.0, 0.05, -0.4]] {
            let metric = Planar::new(&GeoTransform(t), 1.0);
            for p in [(0, 0), (3, 4), (8, 2)] {
                let (fast, slow) =
                    (metric.outside_m(p, 9, 7, f64::INFINITY).unwrap(), outside_slowly(&metric, p, 9, 7));
                assert!((fast - slow).abs() < 1e-9, "{t:?} {p:?}: {fast} {slow}");
            }
        }
    }

    #[test]
    fn blocks_bound_their_cells() {
        let metric = Planar::new(&GeoTransform([0.0, 3.0, 1.0, 0.0, 0.5, -2.0]), 0.3048);
        let block = Block { rows: (5, 9), cols: (-4, 2) };
        for p in [(0, 0), (7, 0), (20, -9), (6, 30)] {
            let bound = metric.block2(p, &block);
            let mut least = f64::INFINITY;
            for row in 5..=9 {
                for col in -4..=2 {
                    least = least.min(metric.near2(p, (row, col)));
                }
            }
            assert!(bound <= least, "{p:?}: {bound} {least}");
        }
    }
}
