//! How far counts are from those that are wanted.

/// Counts in bins beside the wanted ones.
#[derive(Clone, Debug)]
pub(super) struct Tally {
    /// Counted less wanted.
    over: Vec<i64>,
}

impl Tally {
    /// Nothing is counted yet.
    pub(super) fn new(wanted: &[usize]) -> Self {
        #[allow(clippy::cast_possible_wrap, reason = "counts of things in memory")]
        let over = wanted.iter().map(|&n| -(n as i64)).collect();
        Self { over }
    }

    /// Counts one more in a bin.
    pub(super) fn add(&mut self, bin: usize) {
        self.over[bin] += 1;
    }

    /// Takes one from a bin to another; returns by how much the sum of the differences grows.
    pub(super) fn move_one(&mut self, from: usize, to: usize) -> i64 {
        if from == to {
            return 0;
        }
        let change = if self.over[from] > 0 { -1 } else { 1 } + if self.over[to] < 0 { -1 } else { 1 };
        self.over[from] -= 1;
        self.over[to] += 1;
        change
    }

    /// Sum of the differences between counted and wanted.
    #[cfg(test)]
    pub(super) fn error(&self) -> i64 {
        self.over.iter().map(|over| over.abs()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn moves_change_the_error_as_they_say(
            wanted in prop::collection::vec(0..6_usize, 5),
            moves in prop::collection::vec((0..5_usize, 0..5_usize), 1..40),
        ) {
            let mut tally = Tally::new(&wanted);
            (0..5).for_each(|bin| tally.add(bin));
            for (from, to) in moves {
                let before = tally.error();
                let change = tally.move_one(from, to);
                prop_assert_eq!(tally.error(), before + change);
            }
        }
    }
}
