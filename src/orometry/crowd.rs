//! Places so sorted that the nearest one is found at once, while more are added.

use crate::crs::{Metric, Place};

/// Places in square buckets of cells of a raster that does not wrap.
#[derive(Debug)]
pub struct Crowd<'a, M: ?Sized> {
    metric: &'a M,
    /// Side of a bucket in cells.
    side: i64,
    /// Rows and columns of buckets.
    size: (i64, i64),
    /// Numbers of the places in each bucket.
    buckets: Vec<Vec<u32>>,
    /// All places, in the order in which they came.
    places: Vec<Place>,
    /// The least length in metres of a step to a neighbouring row or column.
    least_step_m: f64,
}

/// Rows that the least length of a step is looked for in.
const SAMPLED_ROWS: usize = 64;
/// Shortens that length, as the sample may miss the shortest.
const SLACK: f64 = 0.98;
/// Lengthens a squared distance, so that one as long is not taken for longer.
const ROUNDED: f64 = 1.0 + 1e-9;

impl<'a, M: Metric + ?Sized> Crowd<'a, M> {
    /// An empty crowd on a raster of so many rows and columns that will have about `count` places.
    pub fn new((rows, cols): (usize, usize), metric: &'a M, count: usize) -> Self {
        #[allow(clippy::cast_possible_truncation, reason = "at most the side of the raster")]
        let side = (rows as f64 * cols as f64 / count.max(1) as f64).sqrt().ceil().max(1.0) as i64;
        let size = ((rows as i64 - 1) / side + 1, (cols as i64 - 1) / side + 1);
        #[allow(clippy::cast_sign_loss, reason = "sizes are positive")]
        let buckets = vec![Vec::new(); (size.0 * size.1) as usize];
        let sampled = (0..rows).step_by(rows.div_ceil(SAMPLED_ROWS).max(1)).chain([rows - 1]);
        let step_m = |row: usize| {
            let row = row as i64;
            metric.distance_m((row, 0), (row + 1, 0)).min(metric.distance_m((row, 0), (row, 1)))
        };
        let least_step_m = SLACK * sampled.map(step_m).fold(f64::INFINITY, f64::min);
        Self { metric, side, size, buckets, places: Vec::with_capacity(count), least_step_m }
    }

    #[allow(clippy::cast_sign_loss, reason = "buckets inside count from 0")]
    fn bucket(&self, row: i64, col: i64) -> usize {
        (row * self.size.1 + col) as usize
    }

    /// The places, in the order in which they came.
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// Adds a place, whose number is how many there were before.
    ///
    /// # Panics
    /// When it lies outside of the raster.
    pub fn add(&mut self, place: Place) {
        let bucket = self.bucket(place.0 / self.side, place.1 / self.side);
        #[allow(clippy::cast_possible_truncation, reason = "places are counted with 32 bits")]
        self.buckets[bucket].push(self.places.len() as u32);
        self.places.push(place);
    }

    /// The distance in metres to the nearest place that is nearer than `most_m`, and its number, the first of equals.
    /// Gives up once one is nearer than `least_m`, and returns that.
    pub fn nearest(&self, place: Place, least_m: f64, most_m: f64) -> Option<(f64, u32)> {
        let (row, col) = (place.0 / self.side, place.1 / self.side);
        let mut best: Option<(f64, u32)> = None;
        let mut reach_m = most_m;
        for ring in 0..=self.size.0.max(self.size.1) {
            // All in this ring of buckets is at least so many cells away.
            if ((ring - 1) * self.side) as f64 * self.least_step_m > reach_m {
                break;
            }
            for r in (row - ring).max(0)..=(row + ring).min(self.size.0 - 1) {
                let step = if (r - row).abs() == ring { 1 } else { 2 * ring };
                let mut c = col - ring;
                while c <= col + ring {
                    if (0..self.size.1).contains(&c) {
                        for &number in &self.buckets[self.bucket(r, c)] {
                            let other = self.places[number as usize];
                            // The square of a rounded root may be less than what it is the root of.
                            if self.metric.near2(place, other) > reach_m * reach_m * ROUNDED {
                                continue;
                            }
                            let distance_m = self.metric.distance_m(place, other);
                            if distance_m < reach_m || best.is_some_and(|best| (distance_m, number) < best) {
                                reach_m = distance_m;
                                best = Some((distance_m, number));
                                if distance_m < least_m {
                                    return best;
                                }
                            }
                        }
                    }
                    c += step.max(1);
                }
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::Planar;
    use crate::grid::GeoTransform;
    use proptest::prelude::*;

    #[test]
    fn the_first_of_places_as_far() {
        let metric = Planar::new(&GeoTransform([0.0, 10.0, 0.0, 0.0, 0.0, -15.0]), 1.0);
        let mut crowd = Crowd::new((40, 70), &metric, 35);
        // Both 30 by 60 m away, and the root of 4500 is no number of the machine's; the second one's bucket comes first.
        crowd.add((9, 62));
        crowd.add((3, 65));
        assert_eq!(crowd.nearest((5, 59), 0.0, 158.0), Some((4500_f64.sqrt(), 0)));
    }

    proptest! {
        #[test]
        fn as_looking_at_all(
            places in prop::collection::vec((0..40_i64, 0..70_i64), 1..60),
            asked in (0..40_i64, 0..70_i64),
            count in 1..90_usize,
            most_m in 1.0..900.0_f64,
        ) {
            let metric = Planar::new(&GeoTransform([0.0, 10.0, 0.0, 0.0, 0.0, -15.0]), 1.0);
            let mut crowd = Crowd::new((40, 70), &metric, count);
            places.iter().for_each(|&place| crowd.add(place));
            let slow = (0..).zip(&places).map(|(i, &p)| (metric.distance_m(asked, p), i)).filter(|(d, _)| *d < most_m);
            let slow = slow.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            prop_assert_eq!(crowd.nearest(asked, 0.0, most_m), slow);
        }
    }
}
