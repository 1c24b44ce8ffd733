//! The survey against the slow reference on real DEMs, where there are any.
//!
//! `OROGRAPH_TEST_DATA` names a folder: every `*.tif` in it and in its folder `exemplars` is looked at, up to
//! `OROGRAPH_TEST_CELLS` cells; isolations, which the reference scans for, up to `OROGRAPH_TEST_ISOLATION_CELLS`.

#![cfg(feature = "program")]

mod reference;

use orograph::grid::Cell;
use orograph::io::raster::{Dem, RasterOptions, RasterSource};
use orograph::orometry::{Survey, SurveyOptions, survey};
use orograph::pipeline::{Distance, metric_of};
use orograph::units::LengthUnit;
use orograph::watch::Watch;
use orograph::{with_grid, with_metric};
use reference::Options;
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::path::PathBuf;

/// The prominence threshold at which isolations are compared, in metres.
const THRESHOLD_M: f64 = 30.0;

/// Relative difference within which two ways to find the nearest place outside of a raster agree.
const TOLERANCE: f64 = 1e-9;

/// One line of news, seen with `--nocapture`.
#[allow(clippy::print_stderr, reason = "what was skipped and compared is to be told")]
fn tell(line: &str) {
    eprintln!("{line}");
}

/// A number of cells from the environment.
fn limit(variable: &str, usual: u64) -> u64 {
    std::env::var(variable).map_or(usual, |n| n.parse().unwrap_or_else(|_| panic!("{variable}={n} is no number")))
}

/// The files in a folder whose names end in `.tif`, by name.
fn tifs(folder: PathBuf) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else { return vec![] };
    let mut found: Vec<PathBuf> = entries.map(|entry| entry.expect("the folder can be listed").path()).collect();
    found.retain(|path| path.extension().is_some_and(|e| e == "tif"));
    found.sort();
    found
}

/// Calls `check` with every DEM that is not too large, and fails with all its complaints.
fn for_every_dem(most_cells: u64, check: impl Fn(&Dem) -> Result<String, String>) {
    let Some(folder) = std::env::var_os("OROGRAPH_TEST_DATA").map(PathBuf::from) else {
        return tell("skipped: OROGRAPH_TEST_DATA does not name a folder of DEMs");
    };
    let paths = [tifs(folder.clone()), tifs(folder.join("exemplars"))].concat();
    assert!(!paths.is_empty(), "there is no DEM in {}", folder.display());
    let mut complaints = vec![];
    for path in &paths {
        // A raster of something else, in percent say, is ground as good as any: its values are taken for metres.
        let metres = RasterOptions { vertical_unit: Some(LengthUnit::metre()), ..RasterOptions::default() };
        let source = RasterSource::open(path, &RasterOptions::default())
            .or_else(|_| RasterSource::open(path, &metres))
            .expect("the DEM opens");
        if source.cells() > most_cells {
            continue;
        }
        let dem = source.read(&Watch::default()).expect("the DEM can be read");
        let name = path.file_stem().expect("a file has a name").to_string_lossy();
        match check(&dem) {
            Ok(news) => tell(&format!("{name}, {} x {}: {news}", dem.grid.rows(), dem.grid.cols())),
            Err(complaint) => {
                tell(&format!("{name}: DIFFERENT: {complaint}"));
                complaints.push(format!("{name}: {complaint}"));
            }
        }
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

fn surveyed(dem: &Dem, options: &SurveyOptions) -> Survey {
    let metric = metric_of(dem, Distance::Crs, None).expect("the DEM has a metric");
    with_metric!(&metric, metric => survey(&dem.grid, &dem.elevations, metric, options, &Watch::default()))
        .expect("a survey that nobody cancels succeeds")
}

fn all_peaks() -> SurveyOptions {
    SurveyOptions { min_prominence_m: 0.0, isolation: false, ridges: false, ..SurveyOptions::default() }
}

/// How often each value occurs in the first list more than in the second; less often counts below zero.
fn surplus<T: Ord + Copy>(these: &[T], those: &[T]) -> BTreeMap<T, i64> {
    let mut count = BTreeMap::new();
    these.iter().for_each(|&value| *count.entry(value).or_insert(0) += 1);
    those.iter().for_each(|&value| *count.entry(value).or_insert(0) -= 1);
    count.retain(|_, n| *n != 0);
    count
}

/// Peaks and key saddles by their keys, and the elevations that are said to be theirs.
fn prominences(dem: &Dem) -> Result<String, String> {
    let found = surveyed(dem, &all_peaks());
    let mut pairs = vec![];
    for peak in &found.peaks {
        let key = dem.grid.key(peak.cell);
        let Some(saddle) = &peak.key_saddle else { continue };
        let low = dem.grid.key(saddle.cell);
        let e = &dem.elevations;
        let stated = (peak.elevation_m, saddle.elevation_m, peak.prominence_m);
        let actual = (e.elevation_m(key), e.elevation_m(low), e.height_m(key, low));
        if stated != actual {
            return Err(format!("peak {peak:?} has elevation, saddle and prominence {actual:?}"));
        }
        if key > low {
            pairs.push((key, low));
        }
    }
    let expected = with_grid!(&dem.grid, grid => reference::pairs(grid));
    let more = surplus(&pairs, &expected);
    if let Some(((key, low), n)) = more.iter().max_by_key(|((key, low), _)| key - low) {
        let count = more.len();
        return Err(format!("{count} pairs of keys differ, the widest is ({key}, {low}), {n} times too many"));
    }
    Ok(format!("{} peaks, {} pairs of positive prominence", found.peaks.len(), pairs.len()))
}

/// Equal to the bit, or nearly so.
fn is_near(a: Option<f64>, b: Option<f64>) -> bool {
    a == b || a.zip(b).is_some_and(|(a, b)| (a - b).abs() <= TOLERANCE * a.abs().max(b.abs()))
}

/// Isolations at the threshold, by the scan of every cell.
fn isolations(dem: &Dem) -> Result<String, String> {
    let found = surveyed(dem, &SurveyOptions { min_prominence_m: THRESHOLD_M, ..SurveyOptions::default() });
    // The rows are those of the survey of all peaks that are prominent enough.
    let cells = |peaks: &Survey| -> Vec<Cell> {
        let prominent = peaks.peaks.iter().filter(|p| !p.is_root && p.prominence_m >= THRESHOLD_M);
        prominent.map(|p| p.cell).collect()
    };
    if cells(&found) != cells(&surveyed(dem, &all_peaks())) {
        return Err("the peaks above the threshold are not those of all peaks".into());
    }
    let metric = metric_of(dem, Distance::Crs, None).expect("the DEM has a metric");
    let cells: Vec<Cell> = found.peaks.iter().map(|p| p.cell).collect();
    let expected = with_grid!(&dem.grid, grid => reference::isolations(grid, &metric, &cells, &Options::default()));
    for (peak, want) in found.peaks.iter().zip(expected) {
        let got = peak.isolation.expect("isolation was asked for");
        let same = (got.higher, got.isolation_m) == (want.higher, want.isolation_m)
            && (got.azimuth == want.azimuth || got.azimuth.is_nan() && want.azimuth.is_nan())
            && is_near(got.isolation_min_m, want.isolation_min_m)
            && (got.certain == want.certain || is_near(want.isolation_m, want.isolation_min_m));
        if !same {
            return Err(format!("the peak at cell {} has {got:?}, should have {want:?}", peak.cell));
        }
    }
    Ok(format!("{} isolations", found.peaks.len()))
}

/// The first of two lists' items that differ, if any; NaN equals NaN.
fn first_difference<T: PartialEq + Debug>(these: &[T], those: &[T]) -> Option<String> {
    if these.len() != those.len() {
        return Some(format!("{} rows against {}", these.len(), those.len()));
    }
    let differs = |(a, b): &(&T, &T)| a != b && format!("{a:?}") != format!("{b:?}");
    these.iter().zip(those).find(differs).map(|(a, b)| format!("{a:?} against {b:?}"))
}

/// Surveys with everything, by one thread and two, in small tiles and large ones.
fn tilings(dem: &Dem) -> Result<String, String> {
    let mut first: Option<(Survey, Survey)> = None;
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
        for tile in [64, 256] {
            let full = SurveyOptions { min_prominence_m: THRESHOLD_M, tile, ..SurveyOptions::default() };
            let plain = SurveyOptions { tile, ..all_peaks() };
            let (full, plain) = pool.install(|| (surveyed(dem, &full), surveyed(dem, &plain)));
            let Some(first) = &first else {
                first = Some((full, plain));
                continue;
            };
            for (these, those) in [(&full, &first.0), (&plain, &first.1)] {
                let how = format!("{threads} threads, tiles of {tile}");
                if these.local_peaks != those.local_peaks {
                    return Err(format!("{how}: {} local peaks against {}", these.local_peaks, those.local_peaks));
                }
                let edges = || first_difference(&these.edges, &those.edges);
                if let Some(difference) = first_difference(&these.peaks, &those.peaks).or_else(edges) {
                    return Err(format!("{how}: {difference}"));
                }
            }
        }
    }
    Ok("the same whatever the tiles and the threads".into())
}

#[test]
fn prominences_are_those_of_the_reference() {
    for_every_dem(limit("OROGRAPH_TEST_CELLS", 600_000), prominences);
}

#[test]
fn isolations_are_those_of_the_reference() {
    for_every_dem(limit("OROGRAPH_TEST_ISOLATION_CELLS", 150_000), isolations);
}

#[test]
fn tiles_and_threads_change_nothing() {
    for_every_dem(limit("OROGRAPH_TEST_CELLS", 600_000), tilings);
}
