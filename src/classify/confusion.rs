//! What was taken for what.

use serde::Serialize;

/// A confusion table: how often each class was taken for each.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Confusion {
    /// A row for each true class, in it the number of times that each class was told.
    counts: Vec<Vec<u64>>,
}

impl Confusion {
    /// An empty table.
    pub fn new(classes: usize) -> Self {
        Self { counts: vec![vec![0; classes]; classes] }
    }

    /// Counts one answer.
    ///
    /// # Panics
    /// When there is no such class.
    pub fn add(&mut self, truth: usize, told: usize) {
        self.counts[truth][told] += 1;
    }

    /// A row for each true class, in it the number of times that each class was told.
    pub fn counts(&self) -> &[Vec<u64>] {
        &self.counts
    }

    /// Number of answers.
    pub fn total(&self) -> u64 {
        self.counts.iter().flatten().sum()
    }

    /// Share of right answers; `None` without any answer.
    pub fn accuracy(&self) -> Option<f64> {
        let right: u64 = self.counts.iter().enumerate().map(|(class, row)| row[class]).sum();
        let total = self.total();
        (total > 0).then(|| right as f64 / total as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_table() {
        let mut table = Confusion::new(2);
        assert_eq!(table.accuracy(), None);
        [(0, 0), (0, 0), (0, 1), (1, 1)].iter().for_each(|&(truth, told)| table.add(truth, told));
        assert_eq!((table.counts(), table.total()), (&[vec![2, 1], vec![0, 1]][..], 4));
        assert_eq!(table.accuracy(), Some(0.75));
    }
}
