//! Maps say where peaks stand.

use super::{range, reference};
use orograph::error::ErrorKind;
use orograph::synthesis::{ControlMap, Controls, Extent, Synthesis, SynthesisOptions, Target, peak_counts, synthesize};
use orograph::watch::Watch;

const SIDE: usize = 800;

fn make(targets: &[&Target], counts: &[usize], controls: &Controls) -> orograph::error::Result<Synthesis> {
    let metric = range::cells(30.0);
    let extent = Extent::new(SIDE, SIDE, &metric);
    synthesize(&extent, targets, counts, controls, &SynthesisOptions::default(), &Watch::default())
}

/// A map of two values: in the west and in the east.
fn halves(west: f64, east: f64) -> Option<ControlMap> {
    Some(ControlMap::new(1, 2, vec![west, east]))
}

fn columns(made: &Synthesis) -> Vec<(usize, f64)> {
    let column = |peak: &(u64, f64)| (reference::place(&made.tree, peak.0).1 as usize, peak.1);
    made.tree.peaks.iter().map(column).collect()
}

fn target(from_m: f64, to_m: f64, seed: u64) -> Target {
    range::target(&range::domain(&range::peaks(200, from_m, to_m, 900.0, seed), 576.0))
}

#[test]
fn no_peaks_where_there_is_no_density() {
    let target = target(500.0, 1500.0, 1);
    let controls = Controls { density: halves(0.0, 7.0), ..Controls::default() };
    let made = make(&[&target], &[120], &controls).expect("a tree");
    assert!(columns(&made).iter().all(|&(column, _)| column >= SIDE / 2));
    let metric = range::cells(30.0);
    let extent = Extent::new(SIDE, SIDE, &metric);
    let counts = |controls: &Controls, asked| peak_counts(&extent, &[&target], controls, asked).expect("numbers");
    assert_eq!(counts(&Controls::default(), None), [200], "576 square kilometres, as the range has");
    assert_eq!(counts(&controls, None), [100]);
    assert_eq!(counts(&controls, Some(7)), [7]);
    let voids = Controls { density: halves(f64::NAN, 1.0), ..Controls::default() };
    assert_eq!(counts(&voids, None), [100]);
}

#[test]
fn high_peaks_stand_where_the_land_is_high() {
    let target = target(500.0, 1500.0, 2);
    let controls = Controls { elevation: halves(10.0, 20.0), ..Controls::default() };
    let made = make(&[&target], &[200], &controls).expect("a tree");
    let mean = |east: bool| {
        let found: Vec<f64> =
            columns(&made).iter().filter(|(column, _)| (*column >= SIDE / 2) == east).map(|peak| peak.1).collect();
        found.iter().sum::<f64>() / found.len() as f64
    };
    assert!(mean(true) > mean(false) + 300.0, "{} {}", mean(true), mean(false));
    // A flat map says nothing, and neither do voids.
    let flat = Controls { elevation: halves(5.0, f64::NAN), ..Controls::default() };
    let plain = make(&[&target], &[200], &Controls::default()).expect("a tree");
    assert_eq!(make(&[&target], &[200], &flat).expect("a tree").tree, plain.tree);
}

#[test]
fn two_ranges_in_one_land() {
    let (low, high) = (target(200.0, 900.0, 3), target(1500.0, 3000.0, 4));
    let controls = Controls { kind: halves(2.0, 1.0), ..Controls::default() };
    let made = make(&[&low, &high], &[60, 70], &controls).expect("a tree");
    made.tree.check().expect("one tree");
    assert_eq!(made.kinds.iter().filter(|&&kind| kind == 1).count(), 70);
    for ((column, elevation_m), &kind) in columns(&made).into_iter().zip(&made.kinds) {
        assert_eq!(column < SIDE / 2, kind == 1, "{column} {kind}");
        assert_eq!(elevation_m > 1000.0, kind == 1, "{elevation_m} {kind}");
    }
}

#[test]
fn what_leaves_no_room_is_refused() {
    let target = target(500.0, 1500.0, 5);
    for (controls, count, kind, words) in [
        (Controls { density: halves(0.0, 0.0), ..Controls::default() }, 10, ErrorKind::Input, "nowhere above 0"),
        (
            Controls { elevation: halves(f64::NAN, f64::NAN), ..Controls::default() },
            10,
            ErrorKind::Input,
            "no elevation",
        ),
        (Controls { kind: halves(7.0, 7.0), ..Controls::default() }, 10, ErrorKind::Input, "no room"),
        (Controls::default(), 0, ErrorKind::Usage, "no peaks"),
        (Controls::default(), SIDE * SIDE, ErrorKind::Usage, "no room"),
    ] {
        let error = make(&[&target], &[count], &controls).expect_err("refused");
        assert!(error.kind() == kind && error.to_string().contains(words), "{error}");
    }
}
