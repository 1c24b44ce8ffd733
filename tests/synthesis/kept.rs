//! What is kept of a tree stays, and the rest grows around it.

use super::{cases, range, reference};
use orograph::crs::Place;
use orograph::error::ErrorKind;
use orograph::orometry::distributions::CellSet;
use orograph::orometry::{GivenTree, Survey, survey_tree};
use orograph::rng::Rng;
use orograph::synthesis::{
    Controls, Extent, Kept, KeptPeak, KeptRidge, Synthesis, SynthesisOptions, Target, peak_counts, prominences_m,
    synthesize,
};
use orograph::watch::Watch;
use proptest::prelude::*;
use std::collections::BTreeSet;

type Line = [Place; 2];

fn area2(a: Place, b: Place, c: Place) -> i64 {
    (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0)
}

fn is_on(point: Place, [a, b]: Line) -> bool {
    let within = |p: i64, a: i64, b: i64| p >= a.min(b) && p <= a.max(b);
    area2(a, b, point) == 0 && within(point.0, a.0, b.0) && within(point.1, a.1, b.1)
}

/// Whether lines have a point in common that is no end of both.
fn cross(p: Line, q: Line) -> bool {
    let touches = |point: Place, line: Line, own: Line| is_on(point, line) && !own.contains(&point);
    let [a, b] = [area2(p[0], p[1], q[0]).signum(), area2(p[0], p[1], q[1]).signum()];
    let [c, d] = [area2(q[0], q[1], p[0]).signum(), area2(q[0], q[1], p[1]).signum()];
    let crosses = a * b < 0 && c * d < 0;
    let touch = p.iter().any(|&end| touches(end, q, q)) || q.iter().any(|&end| touches(end, p, p));
    crosses || touch || (p[0].min(p[1]), p[0].max(p[1])) == (q[0].min(q[1]), q[0].max(q[1]))
}

/// A line of cells, each beside the one before, that wanders a little.
fn way(from: Place, to: Place, rng: &mut Rng) -> Vec<Place> {
    let mut cells = vec![from];
    let mut at = from;
    while at != to {
        let (down, right) = ((to.0 - at.0).signum(), (to.1 - at.1).signum());
        at = match rng.below(3) {
            0 if down != 0 => (at.0 + down, at.1),
            1 if right != 0 => (at.0, at.1 + right),
            _ => (at.0 + down, at.1 + right),
        };
        cells.push(at);
    }
    cells
}

/// A forest of some peaks whose ridges do not cross, but may run together towards a peak.
fn forest(rows: usize, cols: usize, count: usize, joins: usize, rng: &mut Rng) -> Kept {
    let place = |rng: &mut Rng| (rng.below(rows as u64) as i64, rng.below(cols as u64) as i64);
    let places: BTreeSet<Place> = (0..count).map(|_| place(rng)).collect();
    let mut kept = Kept::default();
    for place in places {
        // Steps of 40 m, so that there are equals.
        kept.peaks.push(KeptPeak { place, elevation_m: 900.0 + 40.0 * rng.below(30) as f64, prominence_m: None });
    }
    let mut steps: Vec<Line> = vec![];
    for _ in 0..joins {
        let number = |rng: &mut Rng| rng.below(kept.peaks.len() as u64) as u32;
        let peaks = [number(rng), number(rng)];
        let [a, b] = peaks.map(|peak| kept.peaks[peak as usize].place);
        let saddle = (i64::midpoint(a.0, b.0), i64::midpoint(a.1, b.1));
        let lines = [way(saddle, a, rng), way(saddle, b, rng)];
        let mine: Vec<Line> = lines.iter().flat_map(|line| line.windows(2).map(|step| [step[0], step[1]])).collect();
        let others = kept.peaks.iter().map(|peak| peak.place).filter(|peak| ![a, b].contains(peak));
        let is_barred = others.into_iter().any(|peak| mine.iter().any(|step| step.contains(&peak)));
        let askew = |step: &Line, other: &Line| step != other && *step != [other[1], other[0]] && cross(*step, *other);
        let meets = mine.iter().any(|step| steps.iter().any(|other| askew(step, other) || other.contains(&saddle)));
        let lower_m = peaks.map(|peak| kept.peaks[peak as usize].elevation_m).into_iter().fold(f64::MAX, f64::min);
        let saddle_m = lower_m - 5.0 - rng.below(20) as f64 * 20.0;
        let bends = lines.map(|line| line[1..line.len().saturating_sub(1).max(1)].to_vec());
        kept.ridges.push(KeptRidge { peaks, saddle, saddle_m, bends });
        if is_barred || meets || mine.is_empty() || kept.check(rows, cols).is_err() {
            kept.ridges.pop();
        } else {
            steps.extend(mine);
        }
    }
    // Some have another prominence in the tree that they come from: a higher saddle, which is not kept.
    let own = prominences_m(
        &kept.peaks.iter().map(|peak| (peak.place, peak.elevation_m)).collect::<Vec<_>>(),
        &kept.ridges.iter().map(|ridge| (ridge.peaks, ridge.saddle_m)).collect::<Vec<_>>(),
    );
    for (peak, own_m) in kept.peaks.iter_mut().zip(own) {
        peak.prominence_m = match rng.below(5) {
            0 => Some(own_m.unwrap_or(300.0).min(peak.elevation_m) * 0.5),
            1 if own_m.is_none() => Some(150.0),
            _ => own_m,
        };
    }
    kept
}

fn make(
    extent: &Extent<'_, orograph::crs::Planar>,
    target: &Target,
    count: usize,
    controls: &Controls,
    options: &SynthesisOptions,
) -> orograph::error::Result<Synthesis> {
    synthesize(extent, &[target], &[count], controls, options, &Watch::default())
}

/// The straight lines of all that was made, and the steps of what was kept.
fn lines(made: &Synthesis) -> (Vec<Line>, BTreeSet<Line>) {
    let (mut new, mut kept) = (vec![], BTreeSet::new());
    for (pass, own) in made.tree.passes.iter().zip(&made.kept_passes) {
        let place = |cell: u64| reference::place(&made.tree, cell);
        for (bends, peak) in pass.bends.iter().zip(pass.peaks) {
            let cells = [pass.cell].into_iter().chain(bends.iter().copied());
            let mut line: Vec<Place> = cells.map(place).collect();
            line.push(place(made.tree.peaks[peak as usize].0));
            let steps = line.windows(2).map(|step| [step[0], step[1]]);
            if own.is_some() {
                kept.extend(steps.map(|[a, b]| [a.min(b), a.max(b)]));
            } else {
                new.push([line[0], line[1]]);
            }
        }
    }
    (new, kept)
}

fn surveyed(tree: &GivenTree, metric: &orograph::crs::Planar) -> Survey {
    survey_tree(tree, metric).expect("a tree")
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn what_is_kept_stays(
        peaks in range::any(),
        (rows, cols) in (1..130_usize, 1..130_usize),
        (own, joins, count) in (1..14_usize, 0..30_usize, 0..50_usize),
        (seed, ridge_exponent, is_within) in (any::<u64>(), 0..3_u8, any::<bool>()),
    ) {
        let mut rng = Rng::new(seed);
        let target = range::target(&range::domain(&peaks, 100.0));
        let metric = range::cells(50.0);
        let extent = Extent::new(rows, cols, &metric);
        let mut kept = forest(rows, cols, own, joins, &mut rng);
        if is_within {
            kept.within = Some(CellSet::from_rows(rows, cols, |row, cells| {
                if row < rows / 2 {
                    cells[..cols / 2].fill(true);
                }
            }));
        }
        let controls = Controls { kept, ..Controls::default() };
        let kept = &controls.kept;
        let options = SynthesisOptions { seed, ridge_exponent };
        let made = match make(&extent, &target, count, &controls, &options) {
            Ok(made) => made,
            Err(error) => {
                prop_assert!(error.to_string().contains("room"), "{error}");
                return Ok(());
            }
        };
        prop_assert_eq!(made.tree.peaks.len(), kept.peaks.len() + count);
        let survey = surveyed(&made.tree, &metric);
        // Peaks are where they were, and as prominent where that is decided by what is kept.
        let mut altered = 0;
        let sure = prominences_m(
            &kept.peaks.iter().map(|peak| (peak.place, peak.elevation_m)).collect::<Vec<_>>(),
            &kept.ridges.iter().map(|ridge| (ridge.peaks, ridge.saddle_m)).collect::<Vec<_>>(),
        );
        for (number, peak) in (0..).zip(&kept.peaks) {
            let at = made.kept.iter().position(|own| *own == Some(number)).expect("every peak");
            let (cell, elevation_m) = made.tree.peaks[at];
            prop_assert_eq!((reference::place(&made.tree, cell), elevation_m), (peak.place, peak.elevation_m));
            let found = survey.peaks.iter().find(|found| found.cell == cell).expect("a peak");
            if peak.prominence_m.is_some() && peak.prominence_m == sure[number as usize] {
                prop_assert_eq!(Some(found.prominence_m), peak.prominence_m, "{} of {:?}", number, kept);
            }
            altered += usize::from(peak.prominence_m.is_some_and(|own_m| own_m != found.prominence_m));
        }
        prop_assert_eq!(altered, made.altered);
        // Ridges, too.
        for (number, ridge) in (0..).zip(&kept.ridges) {
            let at = made.kept_passes.iter().position(|own| *own == Some(number)).expect("every ridge");
            let pass = &made.tree.passes[at];
            prop_assert_eq!((reference::place(&made.tree, pass.cell), pass.elevation_m), (ridge.saddle, ridge.saddle_m));
            let mut ends = pass.peaks.map(|peak| made.kept[peak as usize]);
            ends.sort_unstable();
            let mut wanted = ridge.peaks.map(Some);
            wanted.sort_unstable();
            prop_assert_eq!(ends, wanted);
        }
        // No new peak is in the way.
        let (new, steps) = lines(&made);
        let fast: BTreeSet<Place> =
            steps.iter().flatten().copied().chain(kept.peaks.iter().map(|peak| peak.place)).collect();
        for (peak, _) in made.tree.peaks.iter().zip(&made.kept).filter(|(_, own)| own.is_none()) {
            let place = reference::place(&made.tree, peak.0);
            let near = fast.iter().any(|other| (other.0 - place.0).abs().max((other.1 - place.1).abs()) <= 2);
            prop_assert!(!near, "{:?}", place);
            prop_assert!(kept.within.as_ref().is_none_or(|cells| !cells.holds(place.0 as usize, place.1 as usize)));
        }
        // No new ridge crosses another, or what is kept.
        for (i, &line) in new.iter().enumerate() {
            prop_assert!(!steps.iter().any(|&step| cross(line, step)), "{:?} crosses what is kept", line);
            let other = new[i + 1..].iter().find(|&&other| cross(line, other));
            prop_assert!(other.is_none(), "{:?} crosses {:?}", line, other);
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
        let again = pool.install(|| make(&extent, &target, count, &controls, &options)).expect("as before");
        prop_assert_eq!(again.tree, made.tree);
    }
}

fn target() -> Target {
    range::target(&range::domain(&range::peaks(200, 500.0, 1500.0, 900.0, 1), 576.0))
}

/// A hundred kept trees grow together with 300 new peaks: what was drawn is as it was drawn.
#[test]
fn the_rest_is_like_the_range() {
    let metric = range::cells(30.0);
    let extent = Extent::new(800, 800, &metric);
    let target = target();
    let controls = Controls { kept: forest(800, 800, 40, 60, &mut Rng::new(3)), ..Controls::default() };
    assert!(controls.kept.ridges.len() > 10, "{}", controls.kept.ridges.len());
    let made = make(&extent, &target, 300, &controls, &SynthesisOptions::default()).expect("a tree");
    assert!(made.misjudged < 9 && made.misplaced < 9, "{} {}", made.misjudged, made.misplaced);
    let plain = make(&extent, &target, 300, &Controls::default(), &SynthesisOptions::default()).expect("a tree");
    let prominences = |made: &Synthesis| -> Vec<f64> {
        let survey = surveyed(&made.tree, &metric);
        let new = made.tree.peaks.iter().zip(&made.kept).filter(|(_, own)| own.is_none());
        let find = |cell: u64| survey.peaks.iter().find(|peak| peak.cell == cell).expect("a peak").prominence_m;
        let mut found: Vec<f64> = new.map(|(peak, _)| find(peak.0)).collect();
        found.sort_by(f64::total_cmp);
        found
    };
    let bins = |found: Vec<f64>| -> Vec<usize> {
        [40.0, 60.0, 100.0, 150.0, 300.0].iter().map(|&edge| found.partition_point(|&own_m| own_m < edge)).collect()
    };
    let (own, usual) = (bins(prominences(&made)), bins(prominences(&plain)));
    assert!(own.iter().zip(&usual).all(|(a, b)| a.abs_diff(*b) <= 3), "{own:?} {usual:?}");
}

/// Everything is kept, and there is nothing new: the tree comes back.
#[test]
fn there_and_back() {
    let metric = range::cells(30.0);
    let extent = Extent::new(400, 400, &metric);
    let target = target();
    let first = make(&extent, &target, 80, &Controls::default(), &SynthesisOptions::default()).expect("a tree");
    let survey = surveyed(&first.tree, &metric);
    let place = |cell| reference::place(&first.tree, cell);
    let prominence_m = |cell| {
        let peak = survey.peaks.iter().find(|peak| peak.cell == cell).expect("a peak");
        (!peak.is_root).then_some(peak.prominence_m)
    };
    let peak = |&(cell, elevation_m): &(u64, f64)| KeptPeak {
        place: place(cell),
        elevation_m,
        prominence_m: prominence_m(cell),
    };
    let ridge = |pass: &orograph::orometry::GivenPass| KeptRidge {
        peaks: pass.peaks,
        saddle: place(pass.cell),
        saddle_m: pass.elevation_m,
        bends: [vec![], vec![]],
    };
    let kept = Kept {
        peaks: first.tree.peaks.iter().map(peak).collect(),
        ridges: first.tree.passes.iter().map(ridge).collect(),
        within: None,
    };
    let controls = Controls { kept, ..Controls::default() };
    let again = make(&extent, &target, 0, &controls, &SynthesisOptions::default()).expect("a tree");
    assert_eq!((again.misjudged, again.misplaced, again.altered), (0, 0, 0));
    assert_eq!(again.tree.peaks, first.tree.peaks);
    let passes = |tree: &GivenTree| -> Vec<(u64, String, [u32; 2])> {
        let mut passes: Vec<_> =
            tree.passes.iter().map(|pass| (pass.cell, pass.elevation_m.to_string(), pass.peaks)).collect();
        passes.sort();
        passes
    };
    assert_eq!(passes(&again.tree), passes(&first.tree));
    // Kept peaks count for those that are asked for.
    let counts = |asked| peak_counts(&extent, &[&target], &controls, asked);
    assert_eq!(counts(Some(80)).expect("numbers"), [0]);
    assert_eq!(counts(Some(95)).expect("numbers"), [15]);
    assert_eq!(counts(None).expect("numbers"), [0], "the land has room for 50 by density");
    let error = counts(Some(79)).expect_err("too few");
    assert!(error.kind() == ErrorKind::Usage && error.to_string().contains("fewer than the 80 peaks"), "{error}");
    // Where a part of the land is kept as it is, the rest has as many as it has room for.
    let mut controls = controls;
    controls.kept.within = Some(CellSet::from_rows(400, 400, |row, cells| cells.fill(row < 200)));
    assert_eq!(peak_counts(&extent, &[&target], &controls, None).expect("numbers"), [25]);
}
