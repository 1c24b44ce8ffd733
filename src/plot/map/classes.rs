//! Classes of prominence: which peaks are drawn large.

/// Lower ends of the classes in metres, largest first; peaks below the last form a class of their own.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Classes {
    /// Least prominence of each class in metres.
    pub(super) floors_m: Vec<f64>,
}

/// Number of classes with a floor.
const MOST: usize = 4;

impl Classes {
    /// Classes with floors of 1, 3, 10, 30, ... metres, or 1, 2, 5, 10, ... where prominences differ less, such that
    /// the first holds a few peaks, not just one.
    pub(super) fn fit(prominences_m: impl Iterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = prominences_m.filter(|p| *p > 0.0 && p.is_finite()).collect();
        sorted.sort_unstable_by(|a, b| b.total_cmp(a));
        // The most prominent peak's prominence often is a convention (that of a root), far above all others.
        let top = (sorted.len() / 40).clamp(usize::from(sorted.len() > 4), 4);
        let (Some(&leading), Some(&least)) = (sorted.get(top), sorted.last()) else {
            return Self { floors_m: Vec::new() };
        };
        let digits: &[f64] = if leading > 30.0 * least { &[3.0, 1.0] } else { &[5.0, 2.0, 1.0] };
        let ladder = (-3..=4).rev().flat_map(|power| digits.iter().map(move |digit| digit * 10_f64.powi(power)));
        let floors_m: Vec<f64> = ladder.filter(|&f| f <= leading && f >= 0.9 * least).take(MOST).collect();
        Self { floors_m }
    }

    /// The class of a prominence: 0 for the largest, the number of floors for what is below them all.
    pub(super) fn of(&self, prominence_m: f64) -> usize {
        self.floors_m.iter().position(|&floor| prominence_m >= floor).unwrap_or(self.floors_m.len())
    }

    /// Size of the triangle of a class: the radius of the circle round it, in pixels.
    pub(super) fn radius(&self, class: usize) -> f32 {
        // The largest size is for maps with all classes; few classes of large triangles would cover the land.
        let skipped = usize::from(self.floors_m.len() < MOST);
        [8.5, 6.6, 5.1, 4.0, 3.1][(class + skipped).min(MOST)]
    }

    /// Weight of a prominence among the classes, 0 to 1, even within a class.
    pub(super) fn weight(&self, prominence_m: f64) -> f32 {
        let (Some(first), Some(last)) = (self.floors_m.first(), self.floors_m.last()) else { return 0.5 };
        let (low, high) = (last / 3.0, first * 3.0);
        (((prominence_m.max(low) / low).ln() / (high / low).ln()) as f32).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floors_follow_the_data() {
        let classes = Classes::fit([2400.0, 900.0, 650.0, 340.0, 120.0, 45.0, 9.0].into_iter());
        assert_eq!(classes.floors_m, [300.0, 100.0, 30.0, 10.0]);
        assert_eq!((classes.of(2400.0), classes.of(300.0), classes.of(299.0), classes.of(1.0)), (0, 0, 1, 4));
        let close = Classes::fit([2800.0, 1100.0, 700.0, 640.0, 500.0, 320.0].into_iter());
        assert_eq!(close.floors_m, [1000.0, 500.0]);
        assert!(Classes::fit([f64::NAN, -1.0].into_iter()).floors_m.is_empty());
        assert_eq!(Classes::fit(std::iter::empty()).of(5.0), 0);
    }

    #[test]
    fn weights_rise_with_prominence() {
        let classes = Classes { floors_m: vec![300.0, 100.0, 30.0, 10.0] };
        let weights: Vec<f32> =
            [0.0, 5.0, 20.0, 60.0, 200.0, 500.0, 9000.0].iter().map(|&p| classes.weight(p)).collect();
        assert!(weights.windows(2).all(|w| w[0] <= w[1]) && weights[0] == 0.0 && weights[6] == 1.0, "{weights:?}");
        assert!((0..4).all(|c| classes.radius(c) > classes.radius(c + 1)));
    }
}
