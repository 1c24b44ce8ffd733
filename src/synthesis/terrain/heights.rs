//! How high one stays on the best way between two peaks of a tree.

/// Elevation in metres.
pub(super) type Elevation = f32;

/// The elevation of the lowest saddle between any two peaks of a divide tree.
pub(super) struct Heights {
    /// For each peak the one that it was joined to, or itself.
    parents: Vec<u32>,
    /// At what elevation.
    joined_m: Vec<Elevation>,
}

impl Heights {
    /// From the passes of `peaks` peaks: elevation in metres, and the two peaks that meet there.
    ///
    /// # Complexity
    /// O(n log n).
    pub(super) fn of(peaks: usize, mut passes: Vec<(Elevation, [u32; 2])>) -> Self {
        let mut parents: Vec<u32> = (0..peaks as u32).collect();
        let mut joined_m = vec![f32::NEG_INFINITY; peaks];
        let mut sizes = vec![1_u32; peaks];
        passes.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for (elevation_m, ends) in passes {
            // Without shortcuts: the way up tells when peaks were joined. It is short, for small ones join large ones.
            let [a, b] = ends.map(|mut peak| {
                while parents[peak as usize] != peak {
                    peak = parents[peak as usize];
                }
                peak as usize
            });
            if a != b {
                let (small, large) = if sizes[a] < sizes[b] { (a, b) } else { (b, a) };
                (parents[small], joined_m[small]) = (large as u32, elevation_m);
                sizes[large] += sizes[small];
            }
        }
        Self { parents, joined_m }
    }

    /// The elevation in metres of the lowest saddle between two peaks: infinite from a peak to itself, minus infinite
    /// between peaks of different trees.
    ///
    /// # Complexity
    /// O(log n).
    pub(super) fn between(&self, mut a: u32, mut b: u32) -> Elevation {
        let mut least = f32::INFINITY;
        while a != b {
            // Elevations fall on the way up: the one that was joined first goes on.
            let (own, other) = (self.joined_m[a as usize], self.joined_m[b as usize]);
            let goer = if own > other || (own == other && self.parents[a as usize] != a) { &mut a } else { &mut b };
            let joined = self.joined_m[*goer as usize];
            if joined == f32::NEG_INFINITY {
                return joined;
            }
            least = least.min(joined);
            *goer = self.parents[*goer as usize];
        }
        least
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    /// The highest of all ways, by trying passes from the highest down.
    fn slow(peaks: usize, passes: &[(f32, [u32; 2])], a: u32, b: u32) -> f32 {
        let mut sorted = passes.to_vec();
        sorted.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut group: Vec<u32> = (0..peaks as u32).collect();
        for (elevation_m, [p, q]) in sorted {
            let (from, to) = (group[p as usize], group[q as usize]);
            group.iter_mut().filter(|g| **g == from).for_each(|g| *g = to);
            if group[a as usize] == group[b as usize] {
                return elevation_m;
            }
        }
        f32::NEG_INFINITY
    }

    #[test]
    fn the_lowest_saddle_on_the_way() {
        let mut rng = Rng::new(3);
        for _ in 0..50 {
            let peaks = 1 + rng.below(12) as usize;
            let mut passes = vec![];
            for peak in 1..peaks as u32 {
                if rng.below(8) > 0 {
                    // Few different elevations: ties are common.
                    passes.push((rng.below(5) as f32, [peak, rng.below(u64::from(peak)) as u32]));
                }
            }
            let heights = Heights::of(peaks, passes.clone());
            for a in 0..peaks as u32 {
                assert_eq!(heights.between(a, a), f32::INFINITY);
                for b in (0..peaks as u32).filter(|&b| b != a) {
                    assert_eq!(heights.between(a, b), slow(peaks, &passes, a, b), "{passes:?} {a} {b}");
                }
            }
        }
    }
}
