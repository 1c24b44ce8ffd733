//! Ways that lower peaks must not bar.

use super::extent::Extent;
use crate::crs::{Metric, Place};

/// The ways from peaks to their nearest higher ones, each with the elevation of the key saddle that is to lie on it.
///
/// A peak whose key saddle is high needs a ridge to higher ground that is higher still. A later, lower peak on that way
/// would bar it, unless it ends at a higher saddle itself. While the circle over a way as its diameter is kept free of
/// such peaks, the way stays an edge of the Delaunay triangulation, or a path of peaks that have ended already.
#[derive(Debug)]
pub(super) struct Corridors<'a, M: ?Sized> {
    extent: &'a Extent<'a, M>,
    /// Side of a bucket in cells.
    side: i64,
    /// Rows and columns of buckets.
    size: (i64, i64),
    /// Numbers of the ways whose circles reach into each bucket.
    buckets: Vec<Vec<u32>>,
    ways: Vec<(Place, Place, f64)>,
}

impl<'a, M: Metric + ?Sized> Corridors<'a, M> {
    /// No ways yet; there will be about `count`.
    pub(super) fn new(extent: &'a Extent<'a, M>, count: usize) -> Self {
        let (rows, cols) = extent.size();
        #[allow(clippy::cast_possible_truncation, reason = "at most the side of the extent")]
        let side = (rows as f64 * cols as f64 / count.max(1) as f64).sqrt().ceil().max(1.0) as i64;
        let size = ((rows as i64 - 1) / side + 1, (cols as i64 - 1) / side + 1);
        #[allow(clippy::cast_sign_loss, reason = "sizes are positive")]
        let buckets = vec![Vec::new(); (size.0 * size.1) as usize];
        Self { extent, side, size, buckets, ways: Vec::with_capacity(count) }
    }

    #[allow(clippy::cast_sign_loss, reason = "buckets inside count from 0")]
    fn bucket(&self, row: i64, col: i64) -> usize {
        (row * self.size.1 + col) as usize
    }

    /// Adds the way from a peak to a higher one, with its key saddle at `level_m`.
    pub(super) fn add(&mut self, peak: Place, higher: Place, level_m: f64) {
        let middle = ((peak.0 + higher.0) / 2, (peak.1 + higher.1) / 2);
        let (row_m, col_m) = self.extent.steps_m(middle.0);
        let radius_m = self.extent.metric.distance_m(peak, higher) / 2.0;
        #[allow(clippy::cast_possible_truncation, reason = "at most the extent")]
        let [rows, cols] = [row_m, col_m].map(|step_m| (radius_m / step_m) as i64 + 2);
        let span = |at: i64, reach: i64, most: i64| {
            ((at - reach).max(0) / self.side, ((at + reach) / self.side).min(most - 1))
        };
        let (first_row, last_row) = span(middle.0, rows, self.size.0);
        let (first_col, last_col) = span(middle.1, cols, self.size.1);
        #[allow(clippy::cast_possible_truncation, reason = "peaks are counted with 32 bits")]
        let number = self.ways.len() as u32;
        for row in first_row..=last_row {
            for col in first_col..=last_col {
                let bucket = self.bucket(row, col);
                self.buckets[bucket].push(number);
            }
        }
        self.ways.push((peak, higher, level_m));
    }

    /// Whether a peak at a place that ends at `level_m` would bar none of the ways.
    pub(super) fn are_open(&self, place: Place, level_m: f64) -> bool {
        let near2 = |a: Place, b: Place| self.extent.metric.near2(a, b);
        let bars = |&number: &u32| {
            let (peak, higher, own_m) = self.ways[number as usize];
            own_m > level_m && near2(place, peak) + near2(place, higher) < near2(peak, higher)
        };
        !self.buckets[self.bucket(place.0 / self.side, place.1 / self.side)].iter().any(bars)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::Planar;
    use crate::grid::GeoTransform;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn as_looking_at_all_ways(
            ways in prop::collection::vec(((0..50_i64, 0..30_i64), (0..50_i64, 0..30_i64), 0..4_i32), 1..40),
            places in prop::collection::vec((0..50_i64, 0..30_i64), 1..60),
            level in 0..4_i32,
            count in 1..80_usize,
        ) {
            let metric = Planar::new(&GeoTransform([0.0, 10.0, 0.0, 0.0, 0.0, -20.0]), 1.0);
            let extent = Extent::new(50, 30, &metric);
            let mut corridors = Corridors::new(&extent, count);
            ways.iter().for_each(|&(peak, higher, level)| corridors.add(peak, higher, f64::from(level)));
            for place in places {
                let bars = |&(peak, higher, own): &(Place, Place, i32)| {
                    let near2 = |q: Place| metric.near2(place, q);
                    own > level && near2(peak) + near2(higher) < metric.near2(peak, higher)
                };
                prop_assert_eq!(corridors.are_open(place, f64::from(level)), !ways.iter().any(bars));
            }
        }
    }
}
