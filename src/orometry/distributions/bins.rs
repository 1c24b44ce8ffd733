//! The two sets of bins: the paper's, and the finer ones that synthesis needs.

use super::measure::Measure;

/// Which bins a histogram has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinSet {
    /// Those of Argudo et al. 2019, table 1: 20 bins, 12 for directions.
    Paper,
    /// Those that the authors' program synthesises from: 40 bins for fractions, 80 for distances, 12 for directions,
    /// prominences every 50 m, elevations every 100 m.
    Fine,
}

impl BinSet {
    /// Both sets.
    pub const ALL: [Self; 2] = [Self::Paper, Self::Fine];

    /// Name as it stands in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Fine => "fine",
        }
    }

    /// Edges of the bins of a measure, in the measure's unit; `None` where the set has no bins for it, as the
    /// paper's has none for plain elevations.
    ///
    /// `range` are the least and the greatest value, by which the bins of elevations are extended.
    pub fn edges(self, measure: Measure, range: (f64, f64)) -> Option<Vec<f64>> {
        use Measure as M;
        Some(match (measure, self) {
            (M::DominanceGroups, _) => JURGALSKI.to_vec(),
            (M::IsolationDirection | M::SaddleDirection, _) => even(12, 360.0),
            (M::Elevation, Self::Paper) => return None,
            (M::Elevation, Self::Fine) => elevation_edges(range.0, range.1),
            (M::Prominence, Self::Paper) => even(20, 2000.0),
            (M::Prominence, Self::Fine) => {
                let mut edges = even(40, 2000.0);
                edges.push(2100.0);
                edges
            }
            (M::IsolationDistance | M::SaddleDistance, Self::Fine) => even(80, 1.0),
            (_, Self::Paper) => even(20, 1.0),
            (_, Self::Fine) => even(40, 1.0),
        })
    }
}

/// Bounds of Jurgalski's classes of dominance (2016), as Argudo et al. use them.
const JURGALSKI: [f64; 13] = [0.0, 0.0035, 0.007, 0.014, 0.021, 0.042, 0.07, 0.105, 0.14, 0.245, 0.49, 0.882, 1.0];

/// Edges of `bins` bins of the same width from 0 to `end`; each is the number nearest to its fraction.
fn even(bins: u32, end: f64) -> Vec<f64> {
    (0..=bins).map(|i| f64::from(i) * end / f64::from(bins)).collect()
}

/// Lowest edge that the bins of elevations are extended to: below the deepest trench.
pub(super) const DEEPEST_M: f64 = -12_000.0;
/// Highest edge that the bins of elevations are extended to: above the highest mountain of the planets.
pub(super) const HIGHEST_M: f64 = 22_800.0;

/// Edges of the bins of elevations in metres: every 100 m from 0 to 8000, every 200 m to 8800.
///
/// Where `lowest_m` lies below 0, bins of 100 m are put in front until it has one, at most down to -12000 m; where
/// `highest_m` lies beyond 8800, bins of 200 m are put behind, at most up to 22800 m. So bathymetry and other planets
/// are not squeezed into the end bins, and any two such rows of bins are parts of one.
pub fn elevation_edges(lowest_m: f64, highest_m: f64) -> Vec<f64> {
    let mut edges = Vec::with_capacity(86);
    let mut edge = DEEPEST_M;
    while edge <= HIGHEST_M {
        let width = if edge < 8000.0 { 100.0 } else { 200.0 };
        // A bin outside of 0 to 8800 is kept when it, or one further out, is needed.
        if (edge >= 0.0 || edge + width > lowest_m) && (edge <= 8800.0 || edge - 200.0 < highest_m) {
            edges.push(edge);
        }
        edge += width;
    }
    edges
}

/// The bin of an elevation when the bins are extended as far as they ever are.
#[inline]
pub(super) fn bin_of_elevation(elevation_m: f64) -> usize {
    let e = elevation_m.clamp(DEEPEST_M, HIGHEST_M - 1.0);
    if e < 8000.0 { ((e / 100.0).floor() - DEEPEST_M / 100.0) as usize } else { 200 + ((e - 8000.0) / 200.0) as usize }
}

/// Edges of the bins of slopes: every degree from 0 to 90.
pub fn slope_edges() -> Vec<f64> {
    even(90, 90.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_of_table_1() {
        for measure in Measure::TABLE_1 {
            let paper = BinSet::Paper.edges(measure, (0.0, 0.0)).unwrap();
            let bins = match measure {
                Measure::DominanceGroups | Measure::IsolationDirection | Measure::SaddleDirection => 12,
                _ => 20,
            };
            assert_eq!(paper.len(), bins + 1, "{measure:?}");
            let end = match measure {
                Measure::Prominence => 2000.0,
                Measure::IsolationDirection | Measure::SaddleDirection => 360.0,
                _ => 1.0,
            };
            assert_eq!((paper[0], paper[bins]), (0.0, end), "{measure:?}");
        }
        assert_eq!(BinSet::Paper.edges(Measure::Elevation, (0.0, 0.0)), None);
    }

    #[test]
    fn finer_bins() {
        let fine = |m| BinSet::Fine.edges(m, (0.0, 100.0)).unwrap();
        assert_eq!(fine(Measure::Dominance)[3], 0.075, "the decimal number itself");
        assert_eq!(fine(Measure::IsolationDistance)[1], 0.0125);
        assert_eq!(fine(Measure::Prominence)[39..], [1950.0, 2000.0, 2100.0]);
        let edges = fine(Measure::Elevation);
        assert_eq!((edges.len(), edges[0], edges[1], edges[80]), (85, 0.0, 100.0, 8000.0));
        assert_eq!(edges[80..], [8000.0, 8200.0, 8400.0, 8600.0, 8800.0]);
    }

    #[test]
    fn the_bin_of_an_elevation() {
        let edges = elevation_edges(DEEPEST_M, HIGHEST_M);
        for e in [
            -1e30, -12_000.0, -11_999.0, -100.0, -1e-20, 0.0, 99.9, 100.0, 7999.9, 8000.0, 8199.0, 8200.0, 22_800.0,
            1e9,
        ] {
            assert_eq!(bin_of_elevation(e), super::super::histogram::bin_of(&edges, e), "{e}");
        }
    }

    #[test]
    fn elevations_below_0_and_above_everest() {
        let plain = elevation_edges(0.0, 8800.0);
        let ends = |low, high| {
            let e = elevation_edges(low, high);
            assert!(plain.iter().all(|edge| e.contains(edge)), "the plain bins are part of it");
            (e[0], e[e.len() - 1])
        };
        assert_eq!(ends(12.0, 4000.0), (0.0, 8800.0));
        assert_eq!(ends(-0.5, 8800.1), (-100.0, 9000.0));
        assert_eq!(ends(-100.0, 9000.0), (-100.0, 9000.0), "the last bin is closed, the first holds its edge");
        assert_eq!(ends(-10_376.0, 10_504.0), (-10_400.0, 10_600.0));
        assert_eq!(ends(-1e30, 1e30), (DEEPEST_M, HIGHEST_M), "a sentinel does not make a million bins");
    }
}
