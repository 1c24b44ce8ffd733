//! Exemplars with other cells.

use crate::amplify::{Plane, cubic};

/// The exemplar with cells so many times as high and as wide: means over the areas of larger cells, cubic convolution
/// along an axis where they are smaller; voids where a part of what makes up a cell is void. What fills no whole cell is
/// left out.
pub(super) fn resampled(exemplar: &Plane, high: f64, wide: f64) -> Plane {
    let lines = shares(exemplar.rows(), high);
    let places = shares(exemplar.cols(), wide);
    let mut heights_m = Vec::with_capacity(lines.len() * places.len());
    let mut sums = vec![0.0; exemplar.cols()];
    for line in &lines {
        sums.fill(0.0);
        for &(row, share) in line {
            sums.iter_mut().zip(exemplar.row(row)).for_each(|(sum, height)| *sum += share * height);
        }
        heights_m.extend(places.iter().map(|place| place.iter().map(|&(col, share)| share * sums[col]).sum::<f64>()));
    }
    Plane::new(lines.len(), places.len(), heights_m)
}

/// For each new cell those that it covers along one axis, and what part of it each makes up.
fn shares(count: usize, length: f64) -> Vec<Vec<(usize, f64)>> {
    let new = (count as f64 / length + 1e-9).floor() as usize;
    let cell = |i: usize| {
        let (from, to) = (i as f64 * length, (i as f64 + 1.0) * length);
        if length < 1.0 {
            // The cells around the middle, the outermost over again beyond the edges.
            let middle = (from + to) / 2.0 - 0.5;
            let first = middle.floor();
            let tap = |k: f64| ((first + k).clamp(0.0, count as f64 - 1.0) as usize, cubic(middle - first - k));
            return [-1.0, 0.0, 1.0, 2.0].map(tap).into_iter().filter(|(_, share)| *share != 0.0).collect();
        }
        let last = ((to - 1e-9).ceil() as usize).min(count);
        let share = |cell: usize| ((cell as f64 + 1.0).min(to) - (cell as f64).max(from)) / length;
        (from as usize..last).map(|cell| (cell, share(cell))).filter(|(_, share)| *share > 1e-9).collect()
    };
    (0..new).map(cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_means_over_their_areas() {
        let exemplar = Plane::new(1, 7, vec![1.0, 2.0, 4.0, 8.0, 16.0, 32.0, f64::NAN]);
        let found = resampled(&exemplar, 1.0, 1.5);
        assert_eq!((found.rows(), found.cols()), (1, 4));
        let known =
            [(1.0 + 0.5 * 2.0) / 1.5, (0.5 * 2.0 + 4.0) / 1.5, (8.0 + 0.5 * 16.0) / 1.5, (0.5 * 16.0 + 32.0) / 1.5];
        assert!(found.heights_m().iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        assert!(resampled(&exemplar, 1.0, 7.0).heights_m()[0].is_nan(), "a void in it");
        assert_eq!(resampled(&exemplar, 2.0, 1.0).rows(), 0);
        let straight = Plane::new(1, 4, vec![1.0, 3.0, 5.0, 7.0]);
        let finer = resampled(&straight, 1.0, 0.5);
        let known = [1.0, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.0];
        let pairs = || finer.heights_m().iter().zip(known);
        assert!(pairs().skip(3).take(2).all(|(a, b)| (a - b).abs() < 1e-12), "slopes go on as slopes: {finer:?}");
        assert!(finer.cols() == 8 && pairs().all(|(a, b)| (a - b).abs() < 0.2), "{finer:?}");
        assert!(resampled(&Plane::new(1, 3, vec![1.0, f64::NAN, 1.0]), 1.0, 0.8).heights_m()[1].is_nan());
        let same = resampled(&exemplar, 1.0, 1.0);
        assert_eq!(same.heights_m()[..6], exemplar.heights_m()[..6]);
    }
}
