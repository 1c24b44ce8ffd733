//! What is tested lies apart from what is learned from.
//!
//! Disks overlap, and neighbouring ground is alike: a forest that is tested beside what it has seen seems better than
//! it is. So one end of every range is cut off for the test, in eight directions in turn.

/// Where a disk lies within its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Number of the range; places of different ranges are always apart.
    pub range: usize,
    /// Column and row of its place on the grid of disks, eastwards and northwards.
    pub place: (i64, i64),
    /// Its centre in metres, on a plane or in space, where a straight line is no longer than the way.
    pub centre_m: [f64; 3],
}

/// What a disk is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// To learn from.
    Learn,
    /// To be tested.
    Test,
    /// For nothing: it shares ground with one that is tested.
    Neither,
}

/// How disks are parted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// Radius of the disks in metres.
    pub radius_m: f64,
    /// One of so many disks of a range is tested, or a few more where several lie equally far out.
    pub one_of: usize,
}

impl Apart {
    /// The directions in which ends are cut off, in steps on the grid.
    pub const DIRECTIONS: [(i64, i64); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

    /// What each disk is for when the ends in a direction are cut off.
    ///
    /// Tested are the disks of every range that lie farthest in the direction; those whose centres are nearer to a
    /// tested one of their range than two radii share ground with it, or might, and are for nothing.
    pub fn parts(&self, spots: &[Spot], direction: (i64, i64)) -> Vec<Part> {
        let reach = |spot: &Spot| spot.place.0 * direction.0 + spot.place.1 * direction.1;
        let ranges = spots.iter().map(|spot| spot.range + 1).max().unwrap_or(0);
        let mut parts = vec![Part::Learn; spots.len()];
        for range in 0..ranges {
            let own: Vec<usize> = (0..spots.len()).filter(|&i| spots[i].range == range).collect();
            let mut reaches: Vec<i64> = own.iter().map(|&i| reach(&spots[i])).collect();
            reaches.sort_unstable_by(|a, b| b.cmp(a));
            let wanted = reaches.len().div_ceil(self.one_of.max(1));
            let Some(&least) = reaches.get(wanted.saturating_sub(1)) else { continue };
            let (tested, others): (Vec<usize>, Vec<usize>) = own.iter().partition(|&&i| reach(&spots[i]) >= least);
            tested.iter().for_each(|&i| parts[i] = Part::Test);
            for &i in &others {
                if tested.iter().any(|&j| self.might_touch(&spots[i], &spots[j])) {
                    parts[i] = Part::Neither;
                }
            }
        }
        parts
    }

    /// Whether two disks might share ground.
    fn might_touch(&self, a: &Spot, b: &Spot) -> bool {
        let squared: f64 = (0..3).map(|i| (a.centre_m[i] - b.centre_m[i]) * (a.centre_m[i] - b.centre_m[i])).sum();
        squared < 4.0 * self.radius_m * self.radius_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spots(range: usize, cols: i64, rows: i64, step_m: f64) -> Vec<Spot> {
        let places = (0..rows).flat_map(|row| (0..cols).map(move |col| (col, row)));
        let centre = |(col, row): (i64, i64)| [col as f64 * step_m, row as f64 * step_m, 0.0];
        places.map(|place| Spot { range, place, centre_m: centre(place) }).collect()
    }

    #[test]
    fn ends_of_every_range() {
        let apart = Apart { radius_m: 10.0, one_of: 5 };
        let all = [spots(0, 9, 9, 5.0), spots(1, 10, 1, 20.0), spots(2, 1, 1, 1.0)].concat();
        let parts = apart.parts(&all, (1, 0));
        let columns: Vec<Part> = parts[..9].to_vec();
        use Part::{Learn as L, Neither as N, Test as T};
        assert_eq!(columns, [L, L, L, L, N, N, N, T, T], "20 m are two radii");
        assert_eq!(parts[72..81], columns, "as in the last row");
        assert_eq!(parts[81..91], [L, L, L, L, L, L, L, L, T, T], "these do not overlap");
        assert_eq!(parts[91], T);
        assert_eq!(apart.parts(&all, (-1, 0))[..9], [T, T, N, N, N, L, L, L, L]);
        assert_eq!(apart.parts(&[], (1, 0)), []);
    }

    #[test]
    fn nothing_that_is_learned_from_touches_what_is_tested() {
        let apart = Apart { radius_m: 5.0, one_of: 4 };
        let all = spots(0, 8, 6, 3.0);
        for direction in Apart::DIRECTIONS {
            let parts = apart.parts(&all, direction);
            let of = |part: Part| all.iter().zip(&parts).filter(move |(_, p)| **p == part).map(|(spot, _)| spot);
            let distance = |a: &Spot, b: &Spot| (a.centre_m[0] - b.centre_m[0]).hypot(a.centre_m[1] - b.centre_m[1]);
            assert!(of(Part::Test).count() >= 12 && of(Part::Learn).count() > 0, "{direction:?}");
            assert!(of(Part::Learn).all(|a| of(Part::Test).all(|b| distance(a, b) >= 10.0)));
            assert!(of(Part::Neither).all(|a| of(Part::Test).any(|b| distance(a, b) < 10.0)));
        }
    }
}
