//! Certificates: whatever lies outside and in the voids, certain values stay and intervals hold.
//!
//! The raster is padded with terrain made to embarrass: walls, pits, the raster's own levels; voids are filled with
//! the same. Then it is measured again, and every peak's first answer is held against the second.

use super::case::{Case, Dice, Storage, picture, small_case};
use super::ground::{Ground, Margins};
use super::reference::{self, Answer, Frame, Options, RefPeak};
use super::{cases, subject};
use orograph::crs::Metric;
use orograph::grid::{AnyGrid, Cell, Elevations};
use orograph::orometry::SurveyOptions;
use orograph::with_grid;
use proptest::prelude::*;

/// A raster, and what is asked of it.
struct Site {
    rows: usize,
    cols: usize,
    levels: Vec<Option<i16>>,
    grid: AnyGrid,
    elevations: Elevations,
    metric: Box<dyn Metric>,
    /// The metric of the raster with all its margins, and these.
    outside: (Box<dyn Metric>, Margins),
    /// So low that every peak has a row.
    min_prominence_m: f64,
    base_level_m: Option<f64>,
    nodata_is_sea: bool,
    isolation: bool,
}

/// A way to survey.
type Surveyor = fn(&Site) -> Answer;

fn by_reference(site: &Site) -> Answer {
    let (metric, margins) = (&*site.outside.0, site.outside.1);
    let options = Options {
        min_prominence_m: site.min_prominence_m,
        base_level_m: site.base_level_m,
        nodata_is_sea: site.nodata_is_sea,
        isolation: site.isolation,
        ridges: false,
        frame: Some(Frame { metric, before: margins.before, size: margins.size(site.rows, site.cols) }),
    };
    with_grid!(&site.grid, grid => reference::survey(grid, &site.elevations, &*site.metric, &options))
}

fn by_crate(site: &Site) -> Answer {
    let options = SurveyOptions {
        min_prominence_m: site.min_prominence_m,
        base_level_m: site.base_level_m,
        nodata_is_sea: site.nodata_is_sea,
        isolation: site.isolation,
        ridges: false,
        tile: 5,
        ..SurveyOptions::default()
    };
    subject::answer(&subject::survey(&site.grid, &site.elevations, &*site.metric, &options))
}

/// The raster of a case with more rows and columns around it.
fn site(case: &Case, more: Margins, levels: Vec<Option<i16>>) -> Site {
    let (rows, cols) = more.size(case.rows, case.cols);
    let all = case.ground.margins(case.rows, case.cols);
    let minus = |all: (i64, i64), more: (i64, i64)| (all.0 - more.0, all.1 - more.1);
    let rest = Margins { before: minus(all.before, more.before), after: minus(all.after, more.after) };
    Site {
        rows,
        cols,
        grid: case.storage.grid(rows, cols, case.wraps(), &levels),
        levels,
        elevations: case.storage.elevations(),
        metric: case.ground.metric(case.rows, case.cols, more),
        outside: (case.ground.metric(case.rows, case.cols, all), rest),
        // With a base level peaks below it have a negative prominence, and nothing to say.
        min_prominence_m: if case.base.is_some() { 1e-3 } else { 0.0 },
        base_level_m: case.base_level_m(),
        nodata_is_sea: case.nodata_is_sea,
        isolation: case.isolation(),
    }
}

/// Levels that do harm: far above, far below, or among those of the raster and just beside them.
fn adversary(levels: &[Option<i16>], seed: u64) -> impl FnMut() -> i16 {
    let known: Vec<i16> = levels.iter().flatten().copied().collect();
    let mut dice = Dice(seed);
    let mode = dice.below(6);
    let one = if known.is_empty() { 0 } else { known[dice.below(known.len() as u64) as usize] };
    move || {
        let pick = if known.is_empty() { 0 } else { known[dice.below(known.len() as u64) as usize] };
        match (mode, dice.below(3)) {
            (0, _) | (3, 0) => 1000,
            (1, _) | (3, 1) => -1000,
            (2, _) => one,
            (4, r) => pick + r as i16 - 1,
            (5, 0) => one + 1,
            (5, _) => -1000,
            _ => pick,
        }
    }
}

/// The raster with terrain around it and in its voids: in all of them, in some, or in none where they are sea.
fn padded(case: &Case, more: Margins, seed: u64) -> Site {
    let (rows, cols) = more.size(case.rows, case.cols);
    let mut level = adversary(&case.levels, seed);
    let mut dice = Dice(seed ^ 1);
    let keep_percent = [0, 50][dice.below(2) as usize];
    let own = |i: usize| {
        let row = (i / cols).checked_sub(more.before.0 as usize).filter(|&row| row < case.rows)?;
        let col = (i % cols).checked_sub(more.before.1 as usize).filter(|&col| col < case.cols)?;
        Some(case.levels[row * case.cols + col])
    };
    let levels = (0..rows * cols)
        .map(|i| match own(i) {
            Some(Some(known)) => Some(known),
            Some(None) if case.nodata_is_sea || dice.below(100) < keep_percent => None,
            _ => Some(level()),
        })
        .collect();
    site(case, more, levels)
}

/// Slightly more, as two metrics of one place round differently.
const ROUNDING: f64 = 1.0 + 1e-9;

/// What is wrong with the first answer on a peak, now that more is known.
fn broken(
    old: &RefPeak,
    new: Option<&RefPeak>,
    saddle_now: Option<Cell>,
    threshold_m: f64,
    lowest_m: f64,
) -> Vec<String> {
    let mut found = vec![];
    let mut must = |holds: bool, what: &str| {
        if !holds {
            found.push(what.to_string());
        }
    };
    let Some(new) = new else {
        must(!old.prominence_certain, "a certain peak is gone");
        must(old.prominence_min_m <= threshold_m, "a peak with a lower bound is gone");
        return found;
    };
    if old.prominence_certain {
        must(new.prominence_m == old.prominence_m, "a certain prominence changed");
        must(new.prominence_certain, "a certain prominence became uncertain");
        must(new.key_saddle == saddle_now, "a certain key saddle moved");
        must(old.prominence_min_m == old.prominence_m, "a certain prominence has an interval");
    }
    if !old.is_root {
        must(!new.is_root, "a peak with a key saddle lost it");
        must(new.prominence_m <= old.prominence_m, "above the upper bound");
    }
    // A root's prominence is a convention; only its lower bound says something.
    must(new.is_root || new.prominence_m >= old.prominence_min_m, "below the lower bound");
    if new.is_root && new.prominence_certain {
        // Both its numbers are the convention now: less than the bound where that came from ground below the base.
        let most_m = new.prominence_m.max(new.elevation_m - lowest_m);
        must(old.prominence_min_m <= most_m * ROUNDING, "the lower bound was more than all there is");
    } else {
        must(new.prominence_min_m >= old.prominence_min_m, "the lower bound fell");
    }
    let (Some(was), Some(is)) = (&old.isolation, &new.isolation) else { return found };
    let far = |m: Option<f64>| m.unwrap_or(f64::INFINITY);
    must(far(is.isolation_m) * ROUNDING >= far(was.isolation_min_m), "nearer than the lower bound");
    must(far(is.isolation_m) <= far(was.isolation_m) * ROUNDING, "further than the known higher cell");
    must(far(is.isolation_min_m) * ROUNDING >= far(was.isolation_min_m), "the isolation's lower bound fell");
    if was.certain {
        must(far(is.isolation_m) * ROUNDING >= far(was.isolation_m), "a certain isolation changed");
    }
    found
}

/// The lowest elevation of a raster.
fn lowest_m(site: &Site) -> f64 {
    let known_m = |i: usize| site.levels[i].map(|_| site.elevations.elevation_m(site.grid.key(i as Cell)));
    (0..site.levels.len()).filter_map(known_m).fold(f64::INFINITY, f64::min)
}

fn check(case: &Case, wish: i64, seed: u64, survey: Surveyor) -> Result<(), TestCaseError> {
    let first = site(case, Margins::default(), case.levels.clone());
    let aside = if case.wraps() { 0 } else { wish };
    let more = case.ground.margins(case.rows, case.cols).at_most(wish, aside);
    let second = padded(case, more, seed);
    let (old, new) = (survey(&first), survey(&second));
    let moved = |cell: Cell| {
        let (row, col) = (cell as usize / case.cols, cell as usize % case.cols);
        ((row + more.before.0 as usize) * second.cols + col + more.before.1 as usize) as Cell
    };
    let lowest_m = lowest_m(&second);
    for peak in &old.peaks {
        let saddle_now = peak.key_saddle.map(moved);
        let found = broken(peak, new.at(moved(peak.cell)), saddle_now, first.min_prominence_m, lowest_m);
        prop_assert!(
            found.is_empty(),
            "{}\n{peak:#?}\nnow {:#?}\n{}\n{}",
            found.join(", "),
            new.at(moved(peak.cell)),
            picture(first.cols, &first.levels),
            picture(second.cols, &second.levels)
        );
    }
    Ok(())
}

/// A root's bound may come from ground below 0, while its prominence once all is known is its height above 0.
#[test]
fn of_a_globe_with_ground_below_its_base() {
    let level = |row: usize, col: usize| match (row, col) {
        (1, 4) => None,
        (2, 1) => Some(1),
        (1..=3, 0..=2) => Some(0),
        _ => Some(-1),
    };
    let (rows, cols) = (6, 7);
    let case = Case {
        rows,
        cols,
        levels: (0..rows * cols).map(|i| level(i / cols, i % cols)).collect(),
        ground: Ground::Globe(false),
        storage: Storage::Metres16,
        threshold: 0.0,
        base: None,
        nodata_is_sea: false,
        wraps_anyway: false,
    };
    let top =
        |site: &Site| by_crate(site).at((2 * cols + 1) as Cell).map(|top| (top.prominence_m, top.prominence_min_m));
    let first = site(&case, Margins::default(), case.levels.clone());
    assert_eq!(top(&first), Some((1.0, 2.0)));
    let filled = case.levels.iter().map(|level| level.or(Some(-1))).collect();
    assert_eq!(top(&site(&case, Margins::default(), filled)), Some((1.0, 1.0)));
    for seed in 0..64 {
        check(&case, 0, seed, by_crate).unwrap_or_else(|e| panic!("{e}"));
        check(&case, 0, seed, by_reference).unwrap_or_else(|e| panic!("{e}"));
    }
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn hold_whatever_lies_in_the_unknown(case in small_case(), wish in 0_i64..5, seed in any::<u64>()) {
        check(&case, wish, seed, by_crate)?;
    }
}

proptest! {
    #![proptest_config(cases(500))]

    /// The definitions themselves are sound: the reference keeps its word.
    #[test]
    fn of_the_reference_hold(case in small_case(), wish in 0_i64..5, seed in any::<u64>()) {
        check(&case, wish, seed, by_reference)?;
    }
}
