//! Statistics and distances as tables for people.

use crate::orometry::distributions::{BinSet, Comparison, Domain, Measure, StatsDocument, Unit};
use crate::pipeline::stats::DomainComparison;
use std::fmt::Write;

/// Bars for shares from none to the greatest.
const BARS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// The statistics of all domains of an input.
pub(super) fn statistics(document: &StatsDocument, set: BinSet) -> String {
    let mut text = String::new();
    for (i, domain) in document.domains.iter().enumerate() {
        if i > 0 {
            text.push('\n');
        }
        headline(&mut text, document, domain);
        table(&mut text, document, domain, set);
    }
    text
}

fn headline(text: &mut String, document: &StatsDocument, domain: &Domain) {
    let threshold = match document.definitions.prominence_threshold_m {
        Some(m) => format!(" with a prominence of at least {m} m"),
        None => String::new(),
    };
    let peaks = if domain.peak_count == 1 { "peak" } else { "peaks" };
    let mut line = format!("{}: {} {peaks}{threshold}", domain.name, domain.peak_count);
    if let (Some(area), Some(density)) = (domain.area_km2, domain.density_per_100_km2) {
        // Writing to a String cannot fail, here and below.
        let _ = write!(line, " on {} km², {} per 100 km²", digits(area), digits(density));
    }
    if let Some(extremes) = &domain.extremes {
        let uncertain = if extremes.greatest_prominence_certain { "" } else { " (uncertain)" };
        let _ = write!(
            line,
            "; elevations {} to {} m, greatest prominence {} m{uncertain}",
            digits(extremes.lowest_peak_m),
            digits(extremes.highest_peak_m),
            digits(extremes.greatest_prominence_m)
        );
    }
    let _ = writeln!(text, "{line}");
}

/// One row a metric: how many, the quartiles, and the histogram in small.
fn table(text: &mut String, document: &StatsDocument, domain: &Domain, set: BinSet) {
    let _ = writeln!(
        text,
        "{:<21} {:>7} {:>7} {:>9} {:>8} {:>8} {:>8} {:<4} histogram",
        "metric", "n", "missing", "uncertain", "≈25 %", "≈median", "≈75 %", "unit"
    );
    for (measure, statistics) in domain.metrics.iter() {
        let (factor, unit) = match measure.unit() {
            Unit::Fraction => (1.0, ""),
            Unit::OfRadius => (document.definitions.radius_m / 1000.0, "km"),
            Unit::Azimuth => (1.0, "°"),
            Unit::Metres => (1.0, "m"),
        };
        let fine = &statistics.fine;
        // Directions have no order; groups are dominance once more.
        let ordered = measure.unit() != Unit::Azimuth && measure != Measure::DominanceGroups;
        // No peak that is counted has less than the threshold.
        let least = match (measure, document.definitions.prominence_threshold_m) {
            (Measure::Prominence, Some(threshold_m)) => threshold_m,
            _ => f64::NEG_INFINITY,
        };
        let edges: Vec<f64> = fine.edges.iter().map(|edge| edge.max(least)).collect();
        let quartiles = [0.25, 0.5, 0.75].map(|part| {
            let value = if ordered { quantile(&edges, &fine.shares(), part) } else { None };
            value.map_or("-".into(), |value| digits(value * factor))
        });
        let shown = statistics.histogram(set).unwrap_or(fine);
        let uncertain = statistics.uncertain.to_string();
        row(
            text,
            measure.name(),
            [&fine.total().to_string(), &statistics.missing.to_string(), &uncertain],
            &quartiles,
            unit,
            &histogram(&shown.edges, &shown.shares(), factor),
        );
    }
    let Some(terrain) = &domain.terrain else { return };
    for (name, areas, missing, unit) in [
        ("hypsometry", &terrain.hypsometry, terrain.void_cells, "m"),
        ("slope", &terrain.slope, terrain.slope_missing_cells, "°"),
    ] {
        let shares = areas.shares();
        let quartiles = [0.25, 0.5, 0.75].map(|part| quantile(&areas.edges, &shares, part).map_or("-".into(), digits));
        row(
            text,
            name,
            [&areas.total().to_string(), &missing.to_string(), "-"],
            &quartiles,
            unit,
            &histogram(&areas.edges, &shares, 1.0),
        );
    }
}

fn row(text: &mut String, name: &str, counts: [&str; 3], quartiles: &[String; 3], unit: &str, histogram: &str) {
    let [n, missing, uncertain] = counts;
    let [low, middle, high] = quartiles;
    let _ = writeln!(
        text,
        "{name:<21} {n:>7} {missing:>7} {uncertain:>9} {low:>8} {middle:>8} {high:>8} {unit:<4} {histogram}"
    );
}

/// The value below which a share of a histogram lies, as if each bin were filled evenly.
fn quantile(edges: &[f64], shares: &[f64], part: f64) -> Option<f64> {
    let mut below = 0.0;
    for (pair, share) in edges.windows(2).zip(shares) {
        if *share > 0.0 && below + share >= part {
            return Some(pair[0] + (pair[1] - pair[0]) * (part - below) / share);
        }
        below += share;
    }
    None
}

/// The bins that hold something as bars between the edges of the first and the last of them.
fn histogram(edges: &[f64], shares: &[f64], factor: f64) -> String {
    let (Some(first), Some(last)) = (shares.iter().position(|s| *s > 0.0), shares.iter().rposition(|s| *s > 0.0))
    else {
        return "-".into();
    };
    let greatest = shares.iter().fold(0.0_f64, |a, b| a.max(*b));
    let bar = |share: f64| {
        let steps = (BARS.len() - 1) as f64;
        // What is there at all is seen.
        if share > 0.0 { BARS[((share / greatest * steps).round() as usize).max(1)] } else { BARS[0] }
    };
    let bars: String = shares[first..=last].iter().map(|share| bar(*share)).collect();
    format!("{} {bars} {}", digits(edges[first] * factor), digits(edges[last + 1] * factor))
}

/// The distances between the domains of two inputs.
pub(super) fn distances(documents: &[StatsDocument], comparisons: &[DomainComparison], set: BinSet) -> String {
    let mut text = String::new();
    for (i, pair) in comparisons.iter().enumerate() {
        if i > 0 {
            text.push('\n');
        }
        for (document, name) in documents.iter().zip([&pair.first, &pair.second]) {
            if let Ok(domain) = document.domain(Some(name)) {
                let _ = write!(text, "{} ", document.input.path);
                headline(&mut text, document, domain);
            }
        }
        let _ = writeln!(
            text,
            "{:<21} {:>10} {:<8} {:>18} {:>16}   ({} bins)",
            "metric",
            "EMD",
            "",
            "largest bin diff.",
            "total variation",
            set.name()
        );
        for metric in &pair.metrics {
            let _ = writeln!(text, "{}", distance(metric).trim_end());
        }
    }
    text
}

fn distance(metric: &Comparison) -> String {
    let unit = match metric.emd_unit.as_str() {
        "fraction" => "",
        "degrees" => "°",
        unit => unit,
    };
    let percent = |value: Option<f64>| value.map_or("-".into(), |value| format!("{:.1} %", value * 100.0));
    format!(
        "{:<21} {:>10} {:<8} {:>18} {:>16}",
        metric.metric,
        metric.emd.map_or("-".into(), digits),
        unit,
        percent(metric.largest_bin_difference),
        percent(metric.total_variation)
    )
}

/// A number with three significant digits, but all those before the point.
fn digits(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.abs().to_string();
    }
    let before = value.abs().log10().floor() as i64 + 1;
    let decimals = (3 - before).clamp(0, 6) as usize;
    let text = format!("{value:.decimals$}");
    // Zeros at the end say nothing in a table.
    if decimals > 0 { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers() {
        let texts = [0.0, 0.00351, 0.5, 12.345, 1499.6, -3.0].map(digits);
        assert_eq!(texts, ["0", "0.00351", "0.5", "12.3", "1500", "-3"]);
    }

    #[test]
    fn quantiles_and_bars() {
        let (edges, shares) = ([0.0, 1.0, 2.0, 4.0, 9.0], [0.0, 0.25, 0.75, 0.0]);
        let of = |part| quantile(&edges, &shares, part);
        assert_eq!((of(0.25), of(0.5), of(1.0)), (Some(2.0), Some(2.0 + 2.0 / 3.0), Some(4.0)));
        assert_eq!(quantile(&edges, &[0.0; 4], 0.5), None);
        assert_eq!(histogram(&edges, &shares, 10.0), "10 ▃█ 40");
        assert_eq!(histogram(&edges, &[0.0; 4], 1.0), "-");
    }
}
