//! How far two distributions are from each other.

use super::bins::BinSet;
use super::document::StatsDocument;
use super::domain::Domain;
use super::measure::{Measure, Unit};
use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};

/// The distance between two distributions of the same measure.
///
/// Histograms are normalised first, so that only shapes are compared. The mass of a bin is taken to lie in the
/// bin's middle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Name of the metric.
    pub metric: String,
    /// Earth Mover's Distance in `emd_unit`: how far the one distribution must be moved, on average, to become the
    /// other; round the circle for directions. `None` where one of the two is empty.
    pub emd: Option<f64>,
    /// `m`, `km`, `degrees` or `fraction`.
    pub emd_unit: String,
    /// Largest difference of a bin's shares.
    pub largest_bin_difference: Option<f64>,
    /// Half the sum of the differences of all shares (total variation): the share that must be moved at all.
    pub total_variation: Option<f64>,
}

/// Earth Mover's Distance of two rows of shares whose masses lie at `positions` on a line.
///
/// # Panics
/// When lengths differ.
pub fn emd_linear(positions: &[f64], p: &[f64], q: &[f64]) -> f64 {
    let carried = carried(p, q);
    assert_eq!(positions.len(), p.len(), "one position a share");
    positions.windows(2).zip(&carried).map(|(pair, d)| (pair[1] - pair[0]) * d.abs()).sum()
}

/// Earth Mover's Distance of two rows of shares whose masses lie at `positions` on a circle of `around` units.
///
/// What is carried over each gap is known up to one constant, the flow over the seam; the sum of the absolute values
/// is least when that is the median of what is carried, each weighted by its gap (Rabin, Delon and Gousseau 2011,
/// doi:10.1007/s10851-011-0284-0).
///
/// # Panics
/// When lengths differ.
pub fn emd_circular(positions: &[f64], around: f64, p: &[f64], q: &[f64]) -> f64 {
    assert_eq!(positions.len(), p.len(), "one position a share");
    let carried = carried(p, q);
    let n = positions.len();
    let gap = |i: usize| if i + 1 < n { positions[i + 1] - positions[i] } else { around + positions[0] - positions[i] };
    let mut flows: Vec<(f64, f64)> = carried.iter().enumerate().map(|(i, &d)| (d, gap(i))).collect();
    flows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut left = around / 2.0;
    let median = flows.iter().find(|(_, gap)| {
        left -= gap;
        left <= 0.0
    });
    let median = median.or(flows.last()).map_or(0.0, |(d, _)| *d);
    carried.iter().enumerate().map(|(i, d)| gap(i) * (d - median).abs()).sum()
}

/// What has to be carried from each position to the next: the difference of the cumulative shares.
fn carried(p: &[f64], q: &[f64]) -> Vec<f64> {
    assert_eq!(p.len(), q.len(), "histograms with the same bins");
    let mut sum = 0.0;
    p.iter()
        .zip(q)
        .map(|(p, q)| {
            sum += p - q;
            sum
        })
        .collect()
}

/// Largest difference of two rows of shares.
pub fn largest_bin_difference(p: &[f64], q: &[f64]) -> f64 {
    p.iter().zip(q).map(|(p, q)| (p - q).abs()).fold(0.0, f64::max)
}

/// Half the sum of the differences of two rows of shares.
pub fn total_variation(p: &[f64], q: &[f64]) -> f64 {
    p.iter().zip(q).map(|(p, q)| (p - q).abs()).sum::<f64>() / 2.0
}

/// Brings two histograms whose bins are parts of one row of bins onto that row; `None` where they are not.
fn aligned(a: (&[f64], Vec<f64>), b: (&[f64], Vec<f64>)) -> Option<(Vec<f64>, Vec<f64>, Vec<f64>)> {
    let mut edges: Vec<f64> = a.0.iter().chain(b.0).copied().collect();
    edges.sort_by(f64::total_cmp);
    edges.dedup();
    let spread = |(part, shares): (&[f64], Vec<f64>)| {
        let start = edges.iter().position(|&e| e == part[0])?;
        if edges.get(start..start + part.len()) != Some(part) {
            return None;
        }
        let mut row = vec![0.0; edges.len() - 1];
        row[start..start + shares.len()].copy_from_slice(&shares);
        Some(row)
    };
    let (a, b) = (spread(a)?, spread(b)?);
    Some((edges, a, b))
}

/// Compares all distributions of two domains in one set of bins: the measures in the order of files, then, where
/// both have terrain and the bins are the fine ones, `hypsometry` and `slope`.
///
/// `radius_m` is the radius R of both.
///
/// # Errors
/// A usage error when bins differ and so cannot be compared.
pub fn compare(a: &Domain, b: &Domain, set: BinSet, radius_m: f64) -> Result<Vec<Comparison>> {
    let mut comparisons = vec![];
    for measure in Measure::ALL {
        let histograms = a.metrics.get(measure).histogram(set).zip(b.metrics.get(measure).histogram(set));
        let Some((p, q)) = histograms else { continue };
        let (factor, unit) = match measure.unit() {
            Unit::Fraction => (1.0, "fraction"),
            Unit::OfRadius => (radius_m / 1000.0, "km"),
            Unit::Azimuth => (1.0, "degrees"),
            Unit::Metres => (1.0, "m"),
        };
        let full = p.total() > 0 && q.total() > 0;
        let axis = Axis { name: measure.name(), factor, unit, circular: measure.unit() == Unit::Azimuth };
        comparisons.push(axis.compare((&p.edges, p.shares()), (&q.edges, q.shares()), full)?);
    }
    if let (BinSet::Fine, Some(a), Some(b)) = (set, &a.terrain, &b.terrain) {
        for (name, unit, p, q) in
            [("hypsometry", "m", &a.hypsometry, &b.hypsometry), ("slope", "degrees", &a.slope, &b.slope)]
        {
            let full = p.total_km2() > 0.0 && q.total_km2() > 0.0;
            let axis = Axis { name, factor: 1.0, unit, circular: false };
            comparisons.push(axis.compare((&p.edges, p.shares()), (&q.edges, q.shares()), full)?);
        }
    }
    Ok(comparisons)
}

/// Compares a domain of one document with a domain of another, each the first where no name is given.
///
/// # Errors
/// A usage error when there is no domain of a name, when distances were divided by different radii, and as [`compare()`].
pub fn compare_documents(
    (a, name_a): (&StatsDocument, Option<&str>),
    (b, name_b): (&StatsDocument, Option<&str>),
    set: BinSet,
) -> Result<Vec<Comparison>> {
    let (radius_a, radius_b) = (a.definitions.radius_m, b.definitions.radius_m);
    if radius_a != radius_b {
        return Err(Error::usage(format!(
            "the radius R is {radius_a} m in the one and {radius_b} m in the other: measure both with the same"
        )));
    }
    compare(a.domain(name_a)?, b.domain(name_b)?, set, radius_a)
}

/// The axis of a histogram: how to name and scale what is measured along it.
struct Axis {
    name: &'static str,
    factor: f64,
    unit: &'static str,
    circular: bool,
}

impl Axis {
    fn compare(&self, a: (&[f64], Vec<f64>), b: (&[f64], Vec<f64>), full: bool) -> Result<Comparison> {
        let (edges, p, q) = aligned(a, b).ok_or_else(|| {
            Error::usage(format!(
                "the two histograms of {} have different bins; measure both anew with one program",
                self.name
            ))
        })?;
        let middles: Vec<f64> = edges.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0).collect();
        let emd = if self.circular {
            emd_circular(&middles, edges[edges.len() - 1] - edges[0], &p, &q)
        } else {
            emd_linear(&middles, &p, &q) * self.factor
        };
        Ok(Comparison {
            metric: self.name.to_string(),
            emd: full.then_some(emd),
            emd_unit: self.unit.to_string(),
            largest_bin_difference: full.then(|| largest_bin_difference(&p, &q)),
            total_variation: full.then(|| total_variation(&p, &q)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Definitions, Input, InputKind, PeakMeasures, Selection};
    use super::*;
    use proptest::prelude::*;

    fn shares(counts: &[u32]) -> Vec<f64> {
        let total: u32 = counts.iter().sum();
        counts.iter().map(|&n| f64::from(n) / f64::from(total)).collect()
    }

    /// Moves unit masses in the order in which they lie: optimal on a line.
    fn by_units(positions: &[f64], p: &[u32], q: &[u32]) -> f64 {
        let masses = |counts: &[u32], times: u32| -> Vec<f64> {
            let each = counts.iter().zip(positions).flat_map(|(&n, &x)| std::iter::repeat_n(x, (n * times) as usize));
            each.collect()
        };
        let (np, nq): (u32, u32) = (p.iter().sum(), q.iter().sum());
        let (p, q) = (masses(p, nq), masses(q, np));
        p.iter().zip(&q).map(|(a, b)| (a - b).abs()).sum::<f64>() / p.len() as f64
    }

    #[test]
    fn by_hand() {
        let x = [5.0, 15.0, 35.0];
        assert_eq!(emd_linear(&x, &[1.0, 0.0, 0.0], &[0.0, 0.0, 1.0]), 30.0);
        assert_eq!(emd_linear(&x, &[0.5, 0.5, 0.0], &[0.0, 0.5, 0.5]), 15.0);
        let degrees: Vec<f64> = (0..12).map(|i| 15.0 + 30.0 * f64::from(i)).collect();
        let one = |bin: usize| (0..12).map(|i| if i == bin { 1.0 } else { 0.0 }).collect::<Vec<_>>();
        assert_eq!(emd_circular(&degrees, 360.0, &one(0), &one(11)), 30.0, "across north");
        assert_eq!(emd_circular(&degrees, 360.0, &one(0), &one(6)), 180.0);
        assert_eq!(emd_circular(&degrees, 360.0, &one(2), &one(2)), 0.0);
        assert_eq!(
            (total_variation(&[1.0, 0.0], &[0.25, 0.75]), largest_bin_difference(&[1.0, 0.0], &[0.25, 0.75])),
            (0.75, 0.75)
        );
    }

    proptest! {
        #[test]
        fn linear_as_moving_unit_masses(
            p in prop::collection::vec(0_u32..9, 6), q in prop::collection::vec(0_u32..9, 6), widths in prop::collection::vec(0.1..9.0_f64, 6),
        ) {
            prop_assume!(p.iter().sum::<u32>() > 0 && q.iter().sum::<u32>() > 0);
            let positions: Vec<f64> = widths.iter().scan(0.0, |x, w| { *x += w; Some(*x) }).collect();
            let (fast, slow) = (emd_linear(&positions, &shares(&p), &shares(&q)), by_units(&positions, &p, &q));
            prop_assert!((fast - slow).abs() < 1e-9, "{} {}", fast, slow);
        }

        #[test]
        fn circular_as_the_best_of_all_cuts(
            p in prop::collection::vec(0_u32..9, 7), q in prop::collection::vec(0_u32..9, 7), widths in prop::collection::vec(0.1..9.0_f64, 7),
        ) {
            prop_assume!(p.iter().sum::<u32>() > 0 && q.iter().sum::<u32>() > 0);
            let positions: Vec<f64> = widths.iter().scan(0.0, |x, w| { *x += w; Some(*x) }).collect();
            let around = positions[6] + 0.7;
            let (p, q) = (shares(&p), shares(&q));
            let fast = emd_circular(&positions, around, &p, &q);
            // In an optimal plan nothing crosses some gap: cut there, and it is a line.
            let slow = (0..7).map(|cut| {
                let turn = |v: &[f64]| [&v[cut..], &v[..cut]].concat();
                let x: Vec<f64> = (0..7).map(|i| positions[(cut + i) % 7] + if cut + i >= 7 { around } else { 0.0 }).collect();
                emd_linear(&x, &turn(&p), &turn(&q))
            }).fold(f64::INFINITY, f64::min);
            prop_assert!((fast - slow).abs() < 1e-9, "{} {}", fast, slow);
            prop_assert!(fast <= around / 2.0 + 1e-9);
        }
    }

    fn domain(elevations: &[f64]) -> Domain {
        let peak = |&elevation_m| PeakMeasures { elevation_m, prominence_m: 100.0, ..PeakMeasures::default() };
        let peaks: Vec<PeakMeasures> = elevations.iter().map(peak).collect();
        Domain::measure(&Selection::Whole, &peaks, 30_000.0, None, None).unwrap()
    }

    #[test]
    fn documents_with_the_same_radius() {
        let document = |radius_m| {
            let input = Input { path: "a".into(), kind: InputKind::Peaks, crs: None };
            StatsDocument::new(input, Definitions::new(None, radius_m), vec![domain(&[100.0])])
        };
        let (a, b) = (document(30_000.0), document(10_000.0));
        assert_eq!(compare_documents((&a, None), (&a, Some("whole")), BinSet::Fine).unwrap().len(), 11);
        assert!(compare_documents((&a, None), (&b, None), BinSet::Fine).unwrap_err().message().contains("10000 m"));
        assert!(compare_documents((&a, None), (&a, Some("alps")), BinSet::Fine).is_err());
    }

    #[test]
    fn bins_that_are_parts_of_one_row_are_compared() {
        let found = compare(&domain(&[-320.0]), &domain(&[9150.0]), BinSet::Fine, 30_000.0).unwrap();
        let of = |name: &str| found.iter().find(|c| c.metric == name).unwrap();
        assert_eq!(of("elevation").emd, Some(9450.0), "from the middle of -400..-300 to that of 9000..9200, {found:?}");
        assert_eq!((of("prominence").emd, of("saddle_distance").emd), (Some(0.0), None));
        assert_eq!(of("isolation_distance").emd_unit, "km");
        assert_eq!(found.len(), 11);
        assert_eq!(compare(&domain(&[1.0]), &domain(&[1.0]), BinSet::Paper, 1.0).unwrap().len(), 10);
        let mut odd = domain(&[500.0]);
        odd.metrics.get_mut(Measure::Prominence).fine.edges[3] = 151.0;
        assert!(compare(&odd, &domain(&[500.0]), BinSet::Fine, 1.0).is_err());
    }
}
