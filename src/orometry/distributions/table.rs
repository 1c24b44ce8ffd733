//! The statistics as a table: one row a bin.

use super::bins::BinSet;
use super::document::StatsDocument;
use std::fmt::Write;

/// The header of the table.
const HEADER: &str = "domain,bin_set,metric,from,to,count,share\n";

/// Renders a document as CSV: one row for each domain, set of bins, metric and bin, in this order.
///
/// The rows of `hypsometry` and `slope` count cells, and their share is that in the area. Names are quoted where they
/// have to be (RFC 4180); lines end with a line feed.
pub fn csv(document: &StatsDocument) -> String {
    let mut text = HEADER.to_string();
    for domain in &document.domains {
        let name = quoted(&domain.name);
        for set in BinSet::ALL {
            let mut rows = |metric: &str, edges: &[f64], counts: &[u64], shares: &[f64]| {
                for (bin, pair) in edges.windows(2).enumerate() {
                    let (from, to, count, share) = (pair[0], pair[1], counts[bin], shares[bin]);
                    writeln!(text, "{name},{},{metric},{from},{to},{count},{share}", set.name())
                        .expect("a String takes all");
                }
            };
            for (measure, statistics) in domain.metrics.iter() {
                if let Some(h) = statistics.histogram(set) {
                    rows(measure.name(), &h.edges, &h.counts, &h.shares());
                }
            }
            if let (BinSet::Fine, Some(terrain)) = (set, &domain.terrain) {
                for (metric, h) in [("hypsometry", &terrain.hypsometry), ("slope", &terrain.slope)] {
                    rows(metric, &h.edges, &h.cells, &h.shares());
                }
            }
        }
    }
    text
}

/// A text as a field of CSV.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
}

#[cfg(test)]
mod tests {
    use super::super::{Definitions, Disk, Domain, Input, InputKind, PeakMeasures, Selection};
    use super::*;

    #[test]
    fn rows() {
        let peak = PeakMeasures { elevation_m: 1250.0, prominence_m: 500.0, ..PeakMeasures::default() };
        let selection = Selection::Disk("the \"big\" one, 3km".into(), Disk::planar(0.0, 0.0, 3000.0, 1.0));
        let domain = Domain::measure(&selection, &[peak.clone(), peak], 30_000.0, None, None).unwrap();
        let input = Input { path: "a.gpkg".into(), kind: InputKind::Peaks, crs: None };
        let text = csv(&StatsDocument::new(input, Definitions::new(None, 30_000.0), vec![domain]));
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "domain,bin_set,metric,from,to,count,share");
        assert_eq!(lines[1 + 8], "\"the \"\"big\"\" one, 3km\",paper,dominance,0.4,0.45,2,1");
        let (paper, fine) = (20 * 7 + 3 * 12, 4 * 40 + 2 * 80 + 3 * 12 + 41 + 84);
        assert_eq!(lines.len(), 1 + paper + fine);
        assert!(text.contains(",fine,elevation,1200,1300,2,1\n"));
        assert!(text.contains(",fine,isolation_direction,330,360,0,0\n"));
    }
}
