//! The survey is the reference's, whatever the tiles and the threads.

use super::case::{Case, case, picture};
use super::compare::{Tolerance, differences};
use super::ground::{Ground, Margins};
use super::reference::{self, Answer, Frame, Options};
use super::{cases, subject};
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

proptest! {
    #![proptest_config(cases(3000))]

    #[test]
    fn every_tiling_agrees_with_the_reference(case in case()) {
        let want = expected(&case);
        let mut first: Option<Survey> = None;
        for tile in TILES {
            let survey = surveyed(&case, tile);
            check(&case, &subject::answer(&survey), &want, &format!("tiles of {tile}"))?;
            // Not only near the reference: the very same from tiling to tiling.
            let text = |s: &Survey| format!("{s:?}");
            match &first {
                Some(first) => prop_assert_eq!(text(&survey), text(first), "tiles of {}", tile),
                None => first = Some(survey),
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn threads_change_nothing(case in case()) {
        let (one, two) = (pool(1), pool(2));
        for tile in [3, 8] {
            let alone = one.install(|| surveyed(&case, tile));
            let shared = two.install(|| surveyed(&case, tile));
            prop_assert_eq!(format!("{alone:?}"), format!("{shared:?}"), "tiles of {}", tile);
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
