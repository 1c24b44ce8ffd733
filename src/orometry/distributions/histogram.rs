//! Histograms of numbers and of areas.

use crate::error::{Error, ErrorKind, Result};
use serde::{Deserialize, Serialize};

/// Number of values in each of a row of bins.
///
/// Bins are half-open, `[from, to)`, the last one is closed. A value below the first edge counts in the first bin,
/// one beyond the last edge in the last bin, so that no value is lost; `below` and `above` say how many those are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Histogram {
    /// Edges of the bins, increasing; one more than there are bins.
    pub edges: Vec<f64>,
    /// Values in each bin.
    pub counts: Vec<u64>,
    /// How many of those in the first bin lie below the first edge.
    #[serde(default)]
    pub below: u64,
    /// How many of those in the last bin lie beyond the last edge.
    #[serde(default)]
    pub above: u64,
}

/// The bin of `edges` that `value` counts in (clamped to the first and the last).
#[inline]
pub(super) fn bin_of(edges: &[f64], value: f64) -> usize {
    edges.partition_point(|&edge| edge <= value).saturating_sub(1).min(edges.len() - 2)
}

impl Histogram {
    /// An empty histogram.
    ///
    /// # Panics
    /// With fewer than two edges.
    pub fn new(edges: Vec<f64>) -> Self {
        assert!(edges.len() >= 2, "a histogram has at least one bin");
        let counts = vec![0; edges.len() - 1];
        Self { edges, counts, below: 0, above: 0 }
    }

    /// Counts a value; it must not be NaN.
    pub fn add(&mut self, value: f64) {
        self.counts[bin_of(&self.edges, value)] += 1;
        self.below += u64::from(value < self.edges[0]);
        self.above += u64::from(value > self.edges[self.edges.len() - 1]);
    }

    /// Number of values.
    pub fn total(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// Share of each bin; all 0 where the histogram is empty.
    pub fn shares(&self) -> Vec<f64> {
        let total = self.total().max(1) as f64;
        self.counts.iter().map(|&n| n as f64 / total).collect()
    }

    /// Checks the shape.
    ///
    /// # Errors
    /// When edges do not increase, counts have the wrong length, or more values lie outside than the end bins hold.
    pub fn check(&self) -> Result<()> {
        check_edges(&self.edges)?;
        check_length(&self.edges, self.counts.len(), "counts")?;
        let last = self.counts[self.counts.len() - 1];
        if self.below > self.counts[0] || self.above > last {
            return Err(corrupt(format!(
                "{} values lie below and {} above the edges, but the first and last bins count {} and {}",
                self.below, self.above, self.counts[0], last
            )));
        }
        Ok(())
    }
}

/// Cells and their area in each of a row of bins; bins as in [`Histogram`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AreaHistogram {
    /// Edges of the bins, increasing; one more than there are bins.
    pub edges: Vec<f64>,
    /// Cells in each bin.
    pub cells: Vec<u64>,
    /// Their area in square kilometres.
    pub area_km2: Vec<f64>,
}

impl AreaHistogram {
    /// An empty histogram.
    ///
    /// # Panics
    /// With fewer than two edges.
    pub fn new(edges: Vec<f64>) -> Self {
        assert!(edges.len() >= 2, "a histogram has at least one bin");
        let bins = edges.len() - 1;
        Self { edges, cells: vec![0; bins], area_km2: vec![0.0; bins] }
    }

    /// Number of cells.
    pub fn total(&self) -> u64 {
        self.cells.iter().sum()
    }

    /// Area of all bins in square kilometres.
    pub fn total_km2(&self) -> f64 {
        self.area_km2.iter().sum()
    }

    /// Share of each bin in the area; all 0 where there is none.
    pub fn shares(&self) -> Vec<f64> {
        let total = self.total_km2();
        self.area_km2.iter().map(|&a| if total > 0.0 { a / total } else { 0.0 }).collect()
    }

    /// Checks the shape.
    ///
    /// # Errors
    /// When edges do not increase, a list has the wrong length, or an area is not a finite number from 0 up.
    pub fn check(&self) -> Result<()> {
        check_edges(&self.edges)?;
        check_length(&self.edges, self.cells.len(), "cells")?;
        check_length(&self.edges, self.area_km2.len(), "area_km2")?;
        match self.area_km2.iter().find(|a| !(a.is_finite() && **a >= 0.0)) {
            Some(area) => Err(corrupt(format!("{area} is not an area in square kilometres"))),
            None => Ok(()),
        }
    }
}

fn corrupt(message: String) -> Error {
    Error::new(ErrorKind::Corrupt, message)
}

fn check_edges(edges: &[f64]) -> Result<()> {
    if edges.len() < 2 {
        return Err(corrupt(format!("{} edges make no bin: at least 2 are needed", edges.len())));
    }
    if let Some(edge) = edges.iter().find(|e| !e.is_finite()) {
        return Err(corrupt(format!("{edge} is not an edge: edges are finite numbers")));
    }
    match edges.windows(2).position(|pair| pair[0] >= pair[1]) {
        Some(i) => Err(corrupt(format!(
            "edges must increase, but edge {} is {} and edge {} is {}",
            i,
            edges[i],
            i + 1,
            edges[i + 1]
        ))),
        None => Ok(()),
    }
}

fn check_length(edges: &[f64], found: usize, list: &str) -> Result<()> {
    let bins = edges.len() - 1;
    if found == bins {
        return Ok(());
    }
    Err(corrupt(format!("{} edges make {bins} bins, but there are {found} {list}", edges.len())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn half_open_bins_with_a_closed_end() {
        let mut h = Histogram::new(vec![0.0, 1.0, 2.0, 4.0]);
        for value in [0.0, 0.5, 1.0, 2.0, 3.9, 4.0, 4.1, 1e9, -0.1, f64::INFINITY, -1e-300] {
            h.add(value);
        }
        assert_eq!(h.counts, [4, 1, 6]);
        assert_eq!((h.below, h.above), (2, 3), "an edge itself is not beyond");
        h.check().unwrap();
        assert!((h.shares().iter().sum::<f64>() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn faults_are_named() {
        let good = Histogram::new(vec![0.0, 1.0, 2.0]);
        let with = |edges: &[f64], counts: &[u64]| Histogram {
            edges: edges.to_vec(),
            counts: counts.to_vec(),
            ..good.clone()
        };
        for (histogram, words) in [
            (with(&[0.0, 2.0, 1.0], &[0, 0]), "edge 1 is 2 and edge 2 is 1"),
            (with(&[0.0, 0.0, 1.0], &[0, 0]), "must increase"),
            (with(&[0.0, f64::NAN, 1.0], &[0, 0]), "finite"),
            (with(&[0.0], &[]), "at least 2"),
            (with(&[0.0, 1.0, 2.0], &[1, 2, 3]), "3 edges make 2 bins, but there are 3 counts"),
            (Histogram { above: 1, ..good.clone() }, "1 above the edges"),
        ] {
            let error = histogram.check().unwrap_err();
            assert!(error.message().contains(words), "{error}");
        }
    }

    proptest! {
        #[test]
        fn every_value_counts_once(values in prop::collection::vec(-3.0..9.0_f64, 0..200)) {
            let mut h = Histogram::new(vec![0.0, 0.25, 1.5, 6.0]);
            for &v in &values {
                h.add(v);
            }
            prop_assert_eq!(h.total(), values.len() as u64);
            let slow = |from: f64, to: f64| values.iter().filter(|v| (from..to).contains(*v)).count() as u64;
            prop_assert_eq!(h.counts.clone(), vec![slow(-9.0, 0.25), slow(0.25, 1.5), slow(1.5, 10.0)]);
            prop_assert_eq!((h.below, h.above), (slow(-9.0, 0.0), slow(6.0, 10.0)));
        }
    }
}
