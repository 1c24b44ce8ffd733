//! The reference against answers worked out by hand from the definitions.

#![cfg(feature = "program")]

mod reference;

use orograph::crs::{Ellipsoid, Geodesic, Metric, Planar};
use orograph::grid::{Elevations, GeoTransform, Grid, SampleType};
use orograph::units::LengthUnit;
use reference::{Answer, Options, RefPeak, survey};

/// A void in the pictures below.
const X: i16 = i16::MIN;

fn picture(cols: usize, wraps: bool, cells: &[i16]) -> Grid<i16> {
    Grid::new(cells.len() / cols, cols, wraps, cells.to_vec())
}

/// Surveys a picture with cells of one metre.
fn measured(cols: usize, cells: &[i16], options: &Options) -> Answer {
    let metric = Planar::new(&GeoTransform::PIXELS, 1.0);
    survey(&picture(cols, false, cells), &Elevations::metres(SampleType::I16), &metric, options)
}

fn from(min_prominence_m: f64) -> Options<'static> {
    Options { min_prominence_m, ..Options::default() }
}

/// (cell, prominence, lower bound, certain) of all peaks.
fn prominences(answer: &Answer) -> Vec<(u64, f64, f64, bool)> {
    answer.peaks.iter().map(|p| (p.cell, p.prominence_m, p.prominence_min_m, p.prominence_certain)).collect()
}

/// Ids of the island, line and prominence parents.
fn parents(peak: &RefPeak) -> (Option<u32>, Option<u32>, Option<u32>) {
    (peak.island_parent, peak.line_parent, peak.prominence_parent)
}

#[test]
fn cone() {
    #[rustfmt::skip]
    let answer = measured(5, &[
        1, 1, 1, 1, 1,
        1, 5, 5, 5, 1,
        1, 5, 9, 5, 1,
        1, 5, 5, 5, 1,
        1, 1, 1, 1, 1,
    ], &from(0.0));
    assert_eq!(prominences(&answer), [(12, 9.0, 8.0, false)], "down to the border at 1");
    let peak = &answer.peaks[0];
    assert!(peak.is_root && peak.key_saddle.is_none() && answer.edges.is_empty());
    let isolation = peak.isolation.as_ref().unwrap();
    assert_eq!((isolation.isolation_m, isolation.isolation_min_m, isolation.certain), (None, Some(3.0), false));
    assert_eq!(
        (peak.dominance, peak.relative_prominence, peak.relative_elevation, peak.relevance),
        (Some(1.0), Some(1.0), Some(1.0), Some(1.0))
    );
}

#[rustfmt::skip]
const TWO_CONES: [i16; 21] = [
    0, 0, 0, 0, 0, 0, 0,
    0, 9, 5, 3, 5, 7, 0,
    0, 0, 0, 0, 0, 0, 0,
];

#[test]
fn two_cones_and_a_pass() {
    let answer = measured(7, &TWO_CONES, &from(0.0));
    assert_eq!(prominences(&answer), [(8, 9.0, 9.0, false), (12, 4.0, 4.0, true)]);
    let low = &answer.peaks[1];
    assert_eq!((low.key_saddle, low.key_saddle_elevation_m), (Some(10), Some(3.0)));
    assert_eq!((low.saddle_distance_m, low.saddle_azimuth), (Some(2.0), Some(270.0)));
    assert_eq!(parents(low), (Some(1), Some(1), Some(1)));
    let isolation = low.isolation.as_ref().unwrap();
    assert_eq!((isolation.isolation_m, isolation.higher, isolation.azimuth), (Some(4.0), Some(8), 270.0));
    assert_eq!((isolation.isolation_min_m, isolation.certain), (Some(2.0), false), "two cells to the outside");
    let edge = &answer.edges[0];
    assert_eq!((edge.peak_a, edge.peak_b, edge.saddle, edge.saddle_cell), (1, 2, 2, 10), "a tie of 5: the west is a");
    assert_eq!(edge.path, [8, 9, 10, 11, 12]);
    assert_eq!((low.dominance, low.relative_prominence), (Some(4.0 / 7.0), Some(4.0 / 9.0)));
}

#[test]
fn threshold_is_inclusive() {
    assert_eq!(measured(7, &TWO_CONES, &from(4.0)).peaks.len(), 2);
    let pruned = measured(7, &TWO_CONES, &from(4.5));
    assert_eq!((pruned.peaks.len(), pruned.edges.len()), (1, 0));
    assert_eq!(measured(7, &TWO_CONES, &from(9.5)).peaks.len(), 0, "the highest root is filtered as well");
}

#[test]
fn base_level_lifts_low_saddles() {
    let answer = measured(7, &TWO_CONES, &Options { base_level_m: Some(4.0), ..from(0.0) });
    assert_eq!(prominences(&answer), [(8, 5.0, 5.0, false), (12, 3.0, 3.0, true)]);
    let answer = measured(7, &TWO_CONES, &Options { base_level_m: Some(2.0), ..from(0.0) });
    assert_eq!(prominences(&answer), [(8, 7.0, 7.0, false), (12, 4.0, 4.0, true)]);
}

#[test]
fn plateau_has_one_peak_at_its_lowest_index() {
    let answer = measured(3, &[7; 9], &from(0.0));
    assert_eq!(prominences(&answer), [(0, 7.0, 0.0, false)]);
    #[rustfmt::skip]
    let answer = measured(3, &[
        5, 0, 5,
        0, 5, 0,
    ], &from(0.0));
    assert_eq!(prominences(&answer), [(0, 5.0, 0.0, false), (2, 0.0, 0.0, false)], "joined by an equal cell");
    assert_eq!(answer.at(2).unwrap().key_saddle, Some(4));
}

#[test]
fn ring_with_a_hole() {
    #[rustfmt::skip]
    let answer = measured(5, &[
        0, 0, 0, 0, 0,
        0, 9, 5, 5, 0,
        0, 5, 1, 5, 0,
        0, 5, 5, 8, 0,
        0, 0, 0, 0, 0,
    ], &from(0.0));
    assert_eq!(prominences(&answer), [(6, 9.0, 9.0, false), (18, 3.0, 3.0, true)]);
    assert_eq!(answer.peaks[1].key_saddle, Some(13), "the ring of 5 fills from the north; it closes without a saddle");
    assert_eq!(answer.edges.len(), 1);
    let edge = &answer.edges[0];
    assert_eq!((edge.peak_a, edge.peak_b), (2, 1), "the saddle's topmost neighbour is the lower peak itself");
    assert_eq!(edge.path, [18, 13, 7, 6]);
}

#[test]
fn staircase_of_ties() {
    #[rustfmt::skip]
    let cells = [
        0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
        0, 9, 9, 5, 5, 3, 3, 5, 5, 7, 7, 0,
        0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    ];
    let answer = measured(12, &cells, &from(0.0));
    // The western 5 of the second flight has no neighbour above it: a peak without prominence.
    assert_eq!(prominences(&answer), [(13, 9.0, 9.0, false), (21, 4.0, 4.0, true), (19, 0.0, 0.0, true)]);
    assert_eq!(answer.at(21).unwrap().key_saddle, Some(18), "of two equal saddle cells the one that joins");
    assert_eq!(answer.at(19).unwrap().key_saddle, Some(20));
    assert_eq!(parents(answer.at(19).unwrap()), (Some(2), Some(2), Some(2)));
    assert_eq!(
        answer.edges.iter().map(|e| (e.peak_a, e.peak_b, e.saddle_cell)).collect::<Vec<_>>(),
        [(3, 1, 18), (2, 3, 20)]
    );

    let pruned = measured(12, &cells, &from(1.0));
    assert_eq!(pruned.edges.len(), 1);
    let edge = &pruned.edges[0];
    assert_eq!((edge.peak_a, edge.peak_b, edge.saddle), (2, 1, 2), "the step belongs to the group of 7");
    assert_eq!(edge.path, [21, 20, 19, 18, 17, 16, 15, 14, 13]);
}

#[test]
fn three_way_saddle() {
    #[rustfmt::skip]
    let answer = measured(5, &[
        0, 0, 0, 0, 0,
        0, 9, 0, 8, 0,
        0, 0, 3, 0, 0,
        0, 0, 7, 0, 0,
        0, 0, 0, 0, 0,
    ], &from(0.0));
    assert_eq!(prominences(&answer), [(6, 9.0, 9.0, false), (8, 5.0, 5.0, true), (17, 4.0, 4.0, true)]);
    assert!(answer.peaks[1..].iter().all(|p| p.key_saddle == Some(12) && p.island_parent == Some(1)));
    assert_eq!(
        answer.edges.iter().map(|e| (e.peak_a, e.peak_b, e.saddle)).collect::<Vec<_>>(),
        [(1, 2, 2), (1, 3, 3)],
        "both edges start at the topmost neighbour"
    );
}

#[rustfmt::skip]
const THREE_WAYS_IN_TURN: [i16; 49] = [
    0,  0, 0, 0, 0,  0, 0,
    0,  0, 0, 0, 0,  0, 0,
    0,  0, 0, 8, 0,  0, 0,
    0,  0, 0, 5, 0,  0, 0,
    0,  0, 7, 0, 6,  0, 0,
    0, 10, 0, 0, 0, 20, 0,
    0,  0, 0, 0, 0,  0, 0,
];

#[test]
fn three_way_saddle_takes_its_edges_in_turn() {
    // 8 is the topmost neighbour; it first meets 10 over the 7, and both together meet 20 over the 6.
    let answer = measured(7, &THREE_WAYS_IN_TURN, &from(1.0));
    assert_eq!(prominences(&answer), [(40, 20.0, 20.0, false), (36, 5.0, 5.0, true), (17, 3.0, 3.0, true)]);
    assert_eq!(parents(answer.at(17).unwrap()), (Some(2), Some(2), Some(2)), "joins the island of 10 first");
    assert_eq!(parents(answer.at(36).unwrap()), (Some(1), Some(1), Some(1)));
    assert_eq!(
        answer.edges.iter().map(|e| (e.peak_a, e.peak_b, e.saddle, &e.path[..])).collect::<Vec<_>>(),
        [(3, 1, 2, &[17, 24, 32, 40][..]), (3, 2, 3, &[17, 24, 30, 36][..])]
    );
    let pruned = measured(7, &THREE_WAYS_IN_TURN, &from(4.0));
    assert_eq!(pruned.edges.len(), 1);
    assert_eq!((pruned.edges[0].peak_a, pruned.edges[0].peak_b), (2, 1));
    assert_eq!(pruned.edges[0].path, [36, 30, 24, 17, 24, 32, 40], "to the contracted peak and back");
}

#[test]
fn parents_on_the_way_along_the_tree() {
    let row = [9, 1, 10, 4, 12, 3, 20];
    let answer = measured(7, &row, &from(0.0));
    let id = |cell: u64| Some(answer.at(cell).unwrap().id);
    assert_eq!(
        answer.peaks.iter().map(|p| (p.cell, p.prominence_m)).collect::<Vec<_>>(),
        [(6, 20.0), (4, 9.0), (0, 8.0), (2, 6.0)]
    );
    assert_eq!(parents(answer.at(0).unwrap()), (id(6), id(2), id(4)), "three different parents");
    let pruned = measured(7, &row, &from(7.0));
    assert_eq!(parents(pruned.at(0).unwrap()), (Some(1), Some(2), Some(2)), "10 is gone from the tree");
    let edge = pruned.edges.iter().find(|e| e.saddle_cell == 1).unwrap();
    assert_eq!((edge.peak_a, edge.peak_b, &edge.path[..]), (2, 3, &[4, 3, 2, 1, 0][..]), "the saddle's top is the 10");
}

#[test]
fn voids_part_components() {
    let row = [5, X, 9, X, 7];
    let answer = measured(5, &row, &from(0.0));
    assert_eq!(
        prominences(&answer),
        [(2, 9.0, 0.0, false), (0, 5.0, 0.0, false), (4, 7.0, 0.0, false)],
        "other roots are ordered by their lower bound"
    );
    assert_eq!(measured(5, &row, &from(1.0)).peaks.len(), 1, "and filtered by it");
    let isolation = answer.at(4).unwrap().isolation.clone().unwrap();
    assert_eq!((isolation.isolation_m, isolation.isolation_min_m), (Some(2.0), Some(1.0)));
    assert_eq!(measured(3, &[X; 6], &from(0.0)), Answer::default());
}

#[test]
fn rows_of_roots_that_are_filtered_leave_their_ids() {
    // 9 is the highest root (1); 8 a root that touches a void (lower bound 0, no row, id 3) and the parent of 6.
    #[rustfmt::skip]
    let answer = measured(9, &[
        X, X, X, X, X, X, X, X, X,
        X, 9, X, 8, 2, 6, X, X, X,
        X, X, X, X, X, X, X, X, X,
    ], &from(3.0));
    assert_eq!(answer.peaks.iter().map(|p| (p.id, p.cell)).collect::<Vec<_>>(), [(1, 10), (2, 14)]);
    assert_eq!(parents(&answer.peaks[1]), (Some(3), Some(3), Some(3)));
    assert_eq!((answer.edges[0].peak_a, answer.edges[0].peak_b), (3, 2));
    assert_eq!((answer.peaks[1].prominence_m, answer.peaks[1].prominence_min_m), (4.0, 0.0), "it touches a void");
}

#[test]
fn islands_in_a_sea_of_nodata() {
    #[rustfmt::skip]
    let cells = [
        X, X, X, X, X,
        X, 5, X, 7, X,
        X, 4, X, 6, X,
        X, X, X, X, X,
    ];
    let sea = measured(5, &cells, &Options { nodata_is_sea: true, ..from(0.0) });
    assert_eq!(prominences(&sea), [(8, 7.0, 7.0, true), (6, 5.0, 5.0, true)]);
    let isolation = sea.at(6).unwrap().isolation.clone().unwrap();
    assert_eq!((isolation.isolation_m, isolation.isolation_min_m, isolation.certain), (Some(2.0), Some(2.0), true));
    let voids = measured(5, &cells, &from(0.0));
    assert_eq!(prominences(&voids), [(8, 7.0, 0.0, false), (6, 5.0, 0.0, false)]);
    let isolation = voids.at(6).unwrap().isolation.clone().unwrap();
    assert_eq!((isolation.isolation_m, isolation.isolation_min_m, isolation.certain), (Some(2.0), Some(1.0), false));
}

#[test]
fn certificates_see_what_the_island_touches() {
    // The island of 7 above the saddle 3 holds the 4 on the border: the land may go on higher there.
    #[rustfmt::skip]
    let answer = measured(7, &[
        0, 0, 0, 0, 0, 4, 0,
        0, 9, 5, 3, 5, 7, 0,
        0, 0, 0, 0, 0, 0, 0,
    ], &from(0.0));
    assert_eq!(
        prominences(&answer),
        [(8, 9.0, 6.0, false), (12, 4.0, 3.0, false)],
        "7 may go up over the 4, and so may 9 once it has come down to the pass"
    );
    // A saddle on the border leaves its peak certain: the island is above it.
    let row = [0, 0, 0, 3, 0, 0, 0, 0, 9, 5, 2, 5, 7, 0, 0, 0, 0, 0, 0, 0, 0];
    let answer = measured(7, &row, &from(0.0));
    assert_eq!(answer.at(12).unwrap().key_saddle, Some(3));
    assert!(answer.at(12).unwrap().prominence_certain);
}

#[test]
fn a_clipped_neighbour_at_the_same_saddle_unsettles_nobody() {
    // At the saddle 5 the 9 first takes the 8, whose island runs off the border, and then ends against the 20. Its
    // own island is the 9 alone: whatever lies beyond the border, it ends at this saddle.
    #[rustfmt::skip]
    let answer = measured(7, &[
        0, 0, 0, 0, 0,  0, 0,
        0, 0, 0, 0, 0,  0, 0,
        0, 0, 0, 9, 0,  0, 0,
        0, 0, 0, 5, 0,  0, 0,
        0, 0, 8, 0, 6,  0, 0,
        0, 7, 0, 0, 0, 20, 0,
        6, 0, 0, 0, 0,  0, 0,
    ], &from(1.0));
    assert_eq!(prominences(&answer), [(40, 20.0, 15.0, false), (17, 4.0, 4.0, true), (30, 3.0, 2.0, false)]);
    assert_eq!((answer.at(30).unwrap().island_parent, answer.at(17).unwrap().island_parent), (Some(2), Some(1)));
}

#[test]
fn one_cell_and_low_ground() {
    let answer = measured(1, &[7], &from(0.0));
    assert_eq!(prominences(&answer), [(0, 7.0, 0.0, false)]);
    let isolation = answer.peaks[0].isolation.clone().unwrap();
    assert_eq!((isolation.isolation_m, isolation.isolation_min_m, isolation.higher), (None, Some(1.0), None));
    assert!(isolation.azimuth.is_nan());
    assert_eq!(prominences(&measured(1, &[-3], &from(0.0))), [(0, 0.0, 0.0, false)]);
    let answer = measured(3, &[-3, -5, -9], &from(0.0));
    assert_eq!(prominences(&answer), [(0, 6.0, 0.0, false)], "below zero: down to the lowest cell");
    assert_eq!(answer.peaks[0].dominance, None);
    assert_eq!(answer.peaks[0].relative_elevation, None);
}

#[test]
fn isolation_ties_go_to_the_lowest_index() {
    let answer = measured(5, &[9, 0, 5, 0, 9], &from(0.0));
    let isolation = answer.at(2).unwrap().isolation.clone().unwrap();
    assert_eq!((isolation.isolation_m, isolation.higher, isolation.azimuth), (Some(2.0), Some(0), 270.0));
    let summits = [answer.at(0).unwrap(), answer.at(4).unwrap()];
    for summit in summits {
        assert_eq!(summit.isolation.as_ref().unwrap().isolation_m, None, "strictly higher: equal summits have none");
    }
}

#[test]
fn columns_wrap() {
    #[rustfmt::skip]
    let cells = [
        0, 0, 0, 0,
        9, 1, 7, 3,
        0, 0, 0, 0,
    ];
    let metric = Planar::new(&GeoTransform::PIXELS, 1.0);
    let elevations = Elevations::metres(SampleType::I16);
    let open = survey(&picture(4, false, &cells), &elevations, &metric, &from(0.0));
    assert_eq!((open.peaks[1].key_saddle, open.peaks[1].prominence_m), (Some(5), 6.0));
    let closed = survey(&picture(4, true, &cells), &elevations, &metric, &from(0.0));
    assert_eq!((closed.peaks[1].key_saddle, closed.peaks[1].prominence_m), (Some(7), 4.0), "over the seam");
    assert!(closed.peaks[1].prominence_certain, "the seam is no border");
    assert_eq!(prominences(&open)[0], (4, 9.0, 0.0, false), "on the western border");
    assert_eq!(prominences(&closed)[0], (4, 9.0, 9.0, false), "down to the rows of 0");
}

/// A globe of 90-degree columns and rows at 60, 0 and -60 degrees: no place is outside.
fn globe() -> Geodesic {
    let transform = GeoTransform([-180.0, 90.0, 0.0, 90.0, 0.0, -60.0]);
    Geodesic::new(&Ellipsoid { a_m: 1000.0, flattening: 0.0 }, &transform, 1.0, 3, 4, true).unwrap()
}

#[test]
fn whole_globe() {
    let metric = globe();
    assert!(metric.is_whole_globe(3));
    #[rustfmt::skip]
    let cells = [
        1, 1, 1, 1,
        9, 2, 7, 3,
        1, 1, 1, 1,
    ];
    let elevations = Elevations::metres(SampleType::I16);
    let answer = survey(&picture(4, true, &cells), &elevations, &metric, &from(0.0));
    assert_eq!(prominences(&answer), [(4, 9.0, 9.0, true), (6, 4.0, 4.0, true)], "the root is certain");
    let root = answer.peaks[0].isolation.clone().unwrap();
    assert_eq!((root.isolation_m, root.isolation_min_m, root.certain), (None, None, true));
    let other = answer.peaks[1].isolation.clone().unwrap();
    let half = 1000.0 * std::f64::consts::PI;
    assert!((other.isolation_m.unwrap() - half).abs() < 1e-6 && other.certain, "{other:?}");

    // The first row is at a pole, so it is border: the island of 7 above 3 reaches it.
    #[rustfmt::skip]
    let cells = [
        1, 1, 4, 1,
        9, 2, 7, 3,
        1, 1, 1, 1,
    ];
    let answer = survey(&picture(4, true, &cells), &elevations, &metric, &from(0.0));
    assert_eq!(prominences(&answer), [(4, 9.0, 9.0, true), (6, 4.0, 3.0, false)]);

    // One void takes the root's certainty, unless it is sea.
    let cells = [1, 1, 1, 1, 9, 2, 7, 3, 1, 1, X, 1];
    let answer = survey(&picture(4, true, &cells), &elevations, &metric, &from(0.0));
    assert_eq!(prominences(&answer), [(4, 9.0, 6.0, false), (6, 4.0, 0.0, false)]);
    let sea = Options { nodata_is_sea: true, ..from(0.0) };
    let answer = survey(&picture(4, true, &cells), &elevations, &metric, &sea);
    assert_eq!(prominences(&answer), [(4, 9.0, 9.0, true), (6, 4.0, 4.0, true)]);
}

#[test]
fn feet_scale_and_depths() {
    let metric = Planar::new(&GeoTransform::PIXELS, 1.0);
    let foot = LengthUnit { name: "ft".into(), metres: 0.3048 };
    let elevations = Elevations { unit: foot, ..Elevations::metres(SampleType::I16) };
    let answer = survey(&picture(7, false, &TWO_CONES), &elevations, &metric, &from(1.0));
    assert_eq!(answer.peaks[1].prominence_m, 4.0 * 0.3048);
    assert_eq!(answer.peaks[1].key_saddle_elevation_m, Some(3.0 * 0.3048));

    // Depths counted downwards: the shallowest cell is the top.
    let elevations = Elevations { scale: -0.5, ..Elevations::metres(SampleType::I16) };
    let keys: Vec<i16> = [2_i16, 8, 4].iter().map(|&v| elevations.key_of(v) as i16).collect();
    let answer = survey(&Grid::new(1, 3, false, keys), &elevations, &metric, &from(0.0));
    assert_eq!(
        answer.peaks.iter().map(|p| (p.cell, p.elevation_m, p.prominence_m)).collect::<Vec<_>>(),
        [(0, -1.0, 3.0), (2, -2.0, 2.0)]
    );
}

#[test]
fn the_outside_may_be_nearest_further_out_on_skewed_grids() {
    // One row down leads 7.4 m east and 0.4 m south: two rows further may come nearer than one.
    let metric = Planar::new(&GeoTransform([0.0, 1.0, 7.4, 0.0, 0.05, -0.4]), 1.0);
    let grid = picture(9, false, &[1; 81]);
    let elevations = Elevations::metres(SampleType::I16);
    let narrow = survey(&grid, &elevations, &metric, &from(0.0));
    let frame = reference::Frame { metric: &metric, before: (20, 20), size: (49, 49) };
    let wide = survey(&grid, &elevations, &metric, &Options { frame: Some(frame), ..from(0.0) });
    let min_m = |a: &Answer| a.peaks[0].isolation.as_ref().unwrap().isolation_min_m.unwrap();
    assert!(min_m(&wide) <= min_m(&narrow));
    assert_eq!(min_m(&wide), metric.outside_m((0, 0), 9, 9, f64::INFINITY).unwrap());
}
