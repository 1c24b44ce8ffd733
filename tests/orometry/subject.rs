//! The one place that calls the crate: its survey, turned into the form of the reference.

use super::reference::{Answer, RefEdge, RefIsolation, RefPeak};
use orograph::crs::Metric;
use orograph::grid::{AnyGrid, Elevations};
use orograph::orometry::{Survey, SurveyOptions};
use orograph::watch::Watch;

/// The crate's survey.
pub fn survey(grid: &AnyGrid, elevations: &Elevations, metric: &dyn Metric, options: &SurveyOptions) -> Survey {
    orograph::orometry::survey(grid, elevations, metric, options, &Watch::default())
        .expect("a survey that nobody cancels succeeds")
}

/// A survey in the form of the reference.
pub fn answer(survey: &Survey) -> Answer {
    let peaks = survey
        .peaks
        .iter()
        .map(|p| RefPeak {
            id: p.id,
            cell: p.cell,
            elevation_m: p.elevation_m,
            prominence_m: p.prominence_m,
            prominence_min_m: p.prominence_min_m,
            prominence_certain: p.prominence_certain,
            is_root: p.is_root,
            key_saddle: p.key_saddle.map(|s| s.cell),
            key_saddle_elevation_m: p.key_saddle.map(|s| s.elevation_m),
            saddle_distance_m: p.key_saddle.map(|s| s.distance_m),
            saddle_azimuth: p.key_saddle.map(|s| s.azimuth),
            island_parent: p.island_parent,
            prominence_parent: p.prominence_parent,
            line_parent: p.line_parent,
            isolation: p.isolation.map(|i| RefIsolation {
                isolation_m: i.isolation_m,
                isolation_min_m: i.isolation_min_m,
                certain: i.certain,
                azimuth: i.azimuth,
                higher: i.higher,
            }),
            dominance: p.dominance,
            relative_prominence: p.relative_prominence,
            relative_elevation: p.relative_elevation,
            relevance: p.relevance,
        })
        .collect();
    let edges = survey
        .edges
        .iter()
        .map(|e| RefEdge {
            peak_a: e.peak_a,
            peak_b: e.peak_b,
            saddle: e.saddle,
            saddle_cell: e.saddle_cell,
            saddle_elevation_m: e.saddle_elevation_m,
            prominence_m: e.prominence_m,
            path: e.path.clone(),
        })
        .collect();
    Answer { peaks, edges }
}
