//! The ten histograms of Argudo et al. 2019, table 1, as one figure.

use crate::error::Result;
use crate::orometry::distributions::{
    BinSet, Comparison, Definitions, Domain, Histogram, Measure, StatsDocument, Unit, compare_documents,
};
use crate::plot::chart::{Chart, Panel, PanelKind, Series};

/// One of the domains on a chart.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// Name in the legend.
    pub name: &'a str,
    /// The document that the domain is in.
    pub document: &'a StatsDocument,
    /// Name of the domain; the first of the document where it is not given.
    pub domain: Option<&'a str>,
}

/// The order in which the figure shows the measures: heights above, distances and directions below.
const ORDER: [Measure; 10] = [
    Measure::Prominence,
    Measure::RelativeProminence,
    Measure::Dominance,
    Measure::DominanceGroups,
    Measure::Relevance,
    Measure::NormalisedElevation,
    Measure::IsolationDistance,
    Measure::IsolationDirection,
    Measure::SaddleDistance,
    Measure::SaddleDirection,
];

/// The ten histograms of one or more domains, overlaid, in two rows of five; with two domains, every panel tells
/// their Earth Mover's Distance and total variation.
///
/// # Errors
/// A usage error when there is no domain of a name, and when the domains cannot be compared.
pub fn distributions_chart(title: &str, subjects: &[Subject<'_>], set: BinSet) -> Result<Chart> {
    let domains = subjects.iter().map(|s| s.document.domain(s.domain)).collect::<Result<Vec<_>>>()?;
    let mut comparisons = vec![];
    for other in subjects.iter().skip(1) {
        let (a, b) = ((subjects[0].document, subjects[0].domain), (other.document, other.domain));
        comparisons.push(compare_documents(a, b, set)?);
    }
    let comparison = if let [only] = &comparisons[..] { Some(&only[..]) } else { None };
    let radius_m = subjects.first().map_or(0.0, |s| s.document.definitions.radius_m);
    Ok(Chart {
        title: title.to_string(),
        series: subjects
            .iter()
            .zip(&domains)
            .map(|(s, d)| Series { name: s.name.to_string(), detail: detail(d, &s.document.definitions) })
            .collect(),
        columns: 5,
        panels: ORDER.into_iter().map(|measure| panel(measure, &domains, set, radius_m, comparison)).collect(),
        shares_of: "peaks".into(),
        footnotes: footnotes(comparison.is_some()),
    })
}

/// What the legend says of a domain.
fn detail(domain: &Domain, definitions: &Definitions) -> String {
    let peaks = if domain.peak_count == 1 { "peak" } else { "peaks" };
    let mut detail = format!("{} {peaks}", domain.peak_count);
    if let Some(threshold_m) = definitions.prominence_threshold_m {
        detail.push_str(&format!(" with a prominence of {threshold_m} m or more"));
    }
    if let (Some(area), Some(density)) = (domain.area_km2, domain.density_per_100_km2) {
        detail.push_str(&format!(" on {} km², {} per 100 km²", digits(area, 4), digits(density, 3)));
    }
    if let Some(extremes) = &domain.extremes {
        detail.push_str(&format!("; highest {:.0} m", extremes.highest_peak_m));
    }
    detail
}

fn footnotes(compared: bool) -> Vec<String> {
    let mut lines = vec![
        "Values beyond the last edge of an axis count in its last bin (+). Relative measures refer to the peaks shown. \
         Roses: the area of a wedge is proportional to its share; dashed, the same share in all directions."
            .to_string(),
    ];
    if compared {
        lines.push(
            "EMD: Earth Mover's Distance, round the circle for directions. TV: total variation, the share of peaks that are in other bins."
                .to_string(),
        );
    }
    lines
}

fn panel(
    measure: Measure,
    domains: &[&Domain],
    set: BinSet,
    radius_m: f64,
    comparison: Option<&[Comparison]>,
) -> Panel {
    let histograms: Vec<&Histogram> = domains.iter().filter_map(|d| d.metrics.get(measure).histogram(set)).collect();
    let (title, axis) = words(measure);
    let factor = if measure.unit() == Unit::OfRadius { radius_m / 1000.0 } else { 1.0 };
    let compared = comparison.and_then(|all| all.iter().find(|c| c.metric == measure.name()));
    let note = match (compared, domains) {
        (Some(comparison), _) => distance(comparison),
        (None, [domain]) => counts(measure, domain, set),
        _ => String::new(),
    };
    Panel {
        title: title.into(),
        note,
        axis: axis.into(),
        kind: match measure {
            Measure::DominanceGroups => PanelKind::Groups,
            _ if measure.unit() == Unit::Azimuth => PanelKind::Rose,
            _ => PanelKind::Bars,
        },
        edges: histograms.first().map_or(vec![0.0, 1.0], |h| h.edges.iter().map(|e| e * factor).collect()),
        shares: histograms.iter().map(|h| (h.total() > 0).then(|| h.shares())).collect(),
        open_end: histograms.iter().any(|h| h.above > 0),
    }
}

fn words(measure: Measure) -> (&'static str, &'static str) {
    match measure {
        Measure::Dominance => ("Dominance", "prominence / elevation"),
        Measure::DominanceGroups => ("Dominance groups", "prominence / elevation"),
        Measure::NormalisedElevation => ("Normalised elevation", "lowest to highest peak"),
        Measure::IsolationDirection => ("Isolation direction", "azimuth to higher ground"),
        Measure::IsolationDistance => ("Isolation", "distance to higher ground (km)"),
        Measure::SaddleDirection => ("Key-saddle direction", "azimuth to key saddle"),
        Measure::SaddleDistance => ("Key-saddle distance", "distance to key saddle (km)"),
        Measure::Prominence => ("Prominence", "prominence (m)"),
        Measure::RelativeProminence => ("Relative prominence", "prominence / greatest prominence"),
        Measure::Relevance => ("Relevance", "relevance"),
        Measure::Elevation => ("Elevation", "elevation (m)"),
    }
}

/// How many peaks a panel stands for.
fn counts(measure: Measure, domain: &Domain, set: BinSet) -> String {
    let statistics = domain.metrics.get(measure);
    let counted = statistics.histogram(set).map_or(0, Histogram::total);
    let mut note = format!("n = {counted}");
    if statistics.uncertain > 0 {
        note.push_str(&format!(", {} uncertain", statistics.uncertain));
    }
    if statistics.missing > 0 {
        note.push_str(&format!(", {} missing", statistics.missing));
    }
    note
}

/// How far the two domains of a panel are apart.
fn distance(comparison: &Comparison) -> String {
    let unit = match comparison.emd_unit.as_str() {
        "fraction" => "",
        "degrees" => "°",
        "km" => " km",
        _ => " m",
    };
    match (comparison.emd, comparison.total_variation) {
        (Some(emd), Some(tv)) => format!("EMD {}{unit}, TV {} %", digits(emd, 2), digits(tv * 100.0, 2)),
        _ => String::new(),
    }
}

/// A number with so many significant digits, but all those before the point.
fn digits(value: f64, significant: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let before = value.abs().log10().floor() as i64 + 1;
    let decimals = (significant as i64 - before).clamp(0, 9) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orometry::distributions::{Input, InputKind, PeakMeasures, Selection};

    fn document(lift_m: f64) -> StatsDocument {
        let peak = |i: u32| PeakMeasures {
            elevation_m: 1000.0 + lift_m + f64::from(i * 37 % 2000),
            prominence_m: 30.0 + f64::from(i * i % 900),
            isolation_m: (i > 0).then(|| f64::from(i * 411 % 50_000)),
            isolation_azimuth: (i > 0).then(|| f64::from(i * 7 % 360)),
            ..PeakMeasures::default()
        };
        let peaks: Vec<PeakMeasures> = (0..300).map(peak).collect();
        let domain = Domain::measure(&Selection::Whole, &peaks, 30_000.0, None, Some(2500.0)).unwrap();
        let input = Input { path: "a".into(), kind: InputKind::Peaks, crs: None };
        StatsDocument::new(input, Definitions::new(Some(30.0), 30_000.0), vec![domain])
    }

    #[test]
    fn one_and_two_domains() {
        let (a, b) = (document(0.0), document(500.0));
        let subject = |name, document| Subject { name, document, domain: None };
        let one = distributions_chart("", &[subject("A", &a)], BinSet::Paper).unwrap();
        assert_eq!(one.panels.len(), 10);
        assert_eq!(one.panels[6].note, "n = 299, 299 uncertain, 1 missing");
        assert_eq!((one.panels[6].edges[20], one.panels[6].open_end), (30.0, true));
        assert_eq!(one.panels[8].shares, [None], "no key saddles at all");
        assert_eq!(
            one.series[0].detail,
            "300 peaks with a prominence of 30 m or more on 2500 km², 12.0 per 100 km²; highest 2998 m"
        );
        let two = distributions_chart("", &[subject("A", &a), subject("B", &b)], BinSet::Paper).unwrap();
        assert_eq!(two.panels[0].note, "EMD 0 m, TV 0 %");
        assert!(two.panels[2].note.starts_with("EMD 0.0"), "{}", two.panels[2].note);
        assert_eq!(two.panels[8].note, "");
        assert!(distributions_chart("", &[Subject { domain: Some("x"), ..subject("A", &a) }], BinSet::Paper).is_err());
    }
}
