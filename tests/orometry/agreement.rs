//! The survey is the reference's, whatever the tiles and the threads.

use super::case::{Case, large_case, picture, small_case};
use super::compare::{Tolerance, differences};
use super::ground::{Ground, Margins};
use super::reference::{self, Answer, Frame, Options, RefPeak};
use super::{cases, subject};
use orograph::grid::Cell;
use orograph::orometry::{Survey, SurveyOptions};
use orograph::with_grid;
use proptest::prelude::*;

/// Sides of the internal tiles that are tried.
const TILES: [usize; 6] = [1, 2, 3, 5, 8, 64];

fn expected(case: &Case) -> Answer {
    let (rows, cols) = (case.rows, case.cols);
    let metric = case.ground.metric(rows, cols, Margins::default());
    let margins = case.ground.margins(rows, cols);
    let outside = case.ground.metric(rows, cols, margins);
    let options = Options {
        min_prominence_m: case.min_prominence_m(),
        base_level_m: case.base_level_m(),
        nodata_is_sea: case.nodata_is_sea,
        isolation: case.isolation(),
        ridges: true,
        frame: Some(Frame { metric: &*outside, before: margins.before, size: margins.size(rows, cols) }),
    };
    with_grid!(&case.grid(), grid => reference::survey(grid, &case.storage.elevations(), &*metric, &options))
}

fn surveyed(case: &Case, tile: usize) -> Survey {
    let metric = case.ground.metric(case.rows, case.cols, Margins::default());
    let options = SurveyOptions {
        min_prominence_m: case.min_prominence_m(),
        base_level_m: case.base_level_m(),
        nodata_is_sea: case.nodata_is_sea,
        isolation: case.isolation(),
        ridges: true,
        tile,
        ..SurveyOptions::default()
    };
    subject::survey(&case.grid(), &case.storage.elevations(), &*metric, &options)
}

fn tolerance(case: &Case) -> Tolerance {
    Tolerance {
        prominence: if case.base.is_some() { 1e-12 } else { 0.0 },
        isolation_min: if case.ground.is_exact() { 0.0 } else { 1e-9 },
    }
}

/// A thread pool of its own size.
fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started")
}

/// Fails with everything that one needs to see.
fn check(case: &Case, got: &Answer, want: &Answer, how: &str) -> Result<(), TestCaseError> {
    let found = differences(got, want, tolerance(case));
    prop_assert!(
        found.is_empty(),
        "{how}: {} differences\n  {}\n{}",
        found.len(),
        found[..found.len().min(12)].join("\n  "),
        picture(case.cols, &case.levels)
    );
    Ok(())
}

/// The survey agrees with the reference, to the byte the same from tiling to tiling.
fn agrees(case: &Case) -> Result<(), TestCaseError> {
    let want = expected(case);
    let first = surveyed(case, TILES[0]);
    for tile in TILES {
        let survey = surveyed(case, tile);
        check(case, &subject::answer(&survey), &want, &format!("tiles of {tile}"))?;
        prop_assert_eq!(format!("{:?}", &survey), format!("{:?}", &first), "tiles of {}", tile);
    }
    lengths_add_up(case, &first)
}

/// The length of every line is the sum of its steps.
fn lengths_add_up(case: &Case, survey: &Survey) -> Result<(), TestCaseError> {
    if case.wraps_anyway {
        // The metric would go the long way over the seam.
        return Ok(());
    }
    let metric = case.ground.metric(case.rows, case.cols, Margins::default());
    let place = |cell: Cell| (cell as i64 / case.cols as i64, cell as i64 % case.cols as i64);
    for edge in &survey.edges {
        let sum: f64 = edge.path.windows(2).map(|w| metric.distance_m(place(w[0]), place(w[1]))).sum();
        prop_assert!((sum - edge.length_m).abs() <= 1e-9 * sum, "{} m for {sum} m: {edge:?}", edge.length_m);
    }
    Ok(())
}

/// Row filters take rows away and change nothing else.
fn filters(case: &Case, min_isolation_m: f64) -> Result<(), TestCaseError> {
    let metric = case.ground.metric(case.rows, case.cols, Margins::default());
    let ask = |min_isolation_m: f64, certain_only: bool| {
        let options = SurveyOptions {
            min_prominence_m: case.min_prominence_m(),
            base_level_m: case.base_level_m(),
            nodata_is_sea: case.nodata_is_sea,
            min_isolation_m,
            certain_only,
            ..SurveyOptions::default()
        };
        let survey = subject::survey(&case.grid(), &case.storage.elevations(), &*metric, &options);
        subject::answer(&survey).peaks
    };
    let all = ask(0.0, false);
    let ids = |peaks: &[RefPeak]| peaks.iter().map(|p| (p.id, p.cell)).collect::<Vec<_>>();
    let far = |p: &RefPeak| p.isolation.as_ref().and_then(|i| i.isolation_m).is_none_or(|m| m >= min_isolation_m);
    let certain = |p: &RefPeak| p.prominence_certain && p.isolation.as_ref().is_none_or(|i| i.certain);
    let isolated: Vec<RefPeak> = all.iter().filter(|p| far(p)).cloned().collect();
    prop_assert_eq!(ids(&ask(min_isolation_m, false)), ids(&isolated), "isolation of {} m", min_isolation_m);
    let sure: Vec<RefPeak> = all.iter().filter(|p| certain(p)).cloned().collect();
    prop_assert_eq!(ids(&ask(0.0, true)), ids(&sure), "certain only");
    Ok(())
}

proptest! {
    #![proptest_config(cases(3000))]

    #[test]
    fn every_tiling_agrees_with_the_reference(case in small_case()) {
        agrees(&case)?;
    }
}

proptest! {
    #![proptest_config(proptest::test_runner::Config { max_shrink_iters: 40, ..cases(30) })]

    #[test]
    fn every_tiling_of_large_grids_agrees_with_the_reference(case in large_case()) {
        agrees(&case)?;
    }
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn threads_change_nothing(case in prop_oneof![3 => small_case(), 1 => large_case()]) {
        let (one, two) = (pool(1), pool(2));
        for tile in [3, 8] {
            let alone = one.install(|| surveyed(&case, tile));
            let shared = two.install(|| surveyed(&case, tile));
            prop_assert_eq!(format!("{alone:?}"), format!("{shared:?}"), "tiles of {}", tile);
        }
    }

    #[test]
    fn filters_only_take_rows_away(case in small_case(), cells in 0_u8..6) {
        if case.isolation() {
            filters(&case, f64::from(cells) * 30.0)?;
        }
    }
}

#[test]
fn no_cells_no_peaks() {
    use orograph::grid::{AnyGrid, Elevations, Grid, Key, SampleType};
    let grid = AnyGrid::Narrow(Grid::new(3, 4, false, vec![i16::VOID; 12]));
    let metric = Ground::Plane([0.0, 1.0, 0.0, 0.0, 0.0, -1.0]).metric(3, 4, Margins::default());
    let survey = subject::survey(&grid, &Elevations::metres(SampleType::I16), &*metric, &SurveyOptions::default());
    assert!(survey.peaks.is_empty() && survey.edges.is_empty(), "{survey:?}");
}
