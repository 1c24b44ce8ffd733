//! Rays against terrain: every strategy against a march in tiny steps.

use super::spec::{DiscSpec, ImageSpec, MappingSpec, Spec};
use super::strategy::{detail, spec};
use orograph::construction::trace::{Camera, Counts, Lens, Ray, Seen, Strategy, TraceOptions, Traced, trace};
use orograph::construction::{Area, Builder, Detail, THRESHOLD, Tree, WeightRule};
use orograph::noise::{NoiseKind, Spectrum};
use orograph::watch::Watch;
use proptest::prelude::*;

const STRATEGIES: [Strategy; 4] = [Strategy::Sphere, Strategy::Accelerated, Strategy::Segment, Strategy::Quads];

fn look(tree: &Tree, lens: &Lens, options: &TraceOptions) -> Traced {
    trace(&[tree], lens, 1, options, &Watch::default()).expect("a picture")
}

fn lens(camera: Camera, width: usize, height: usize) -> Lens {
    camera.lens(width, height).expect("a sound camera")
}

/// Height above the ground, `None` where there is none.
fn above(tree: &Tree, ray: &Ray, t: f64) -> Option<f64> {
    tree.elevation_m(ray.at(t)).map(|ground| ray.elevation_m(t) - ground)
}

/// Asserts that what was seen is what a march in tiny steps sees, within the tolerance.
///
/// Before the hit no step is below the ground for longer than the longest step that is not proved (where the tree has bounds
/// of slope: is at all by more than rounding), unless the hit is the end of a chord beyond it; and at the hit the ray
/// is no further from the ground than the tolerance.
fn checks_out(tree: &Tree, ray: &Ray, seen: &Seen, (from, to): (f64, f64), near: impl Fn(f64) -> f64, bounded: bool) {
    let end = match *seen {
        Seen::Sky(_) => to,
        Seen::Ground { distance_m, elevation_m, wall, .. } => {
            let height = above(tree, ray, distance_m);
            if wall {
                assert!(height.is_some_and(|h| h < 0.0), "a wall is below the surface: {height:?} {seen:?}");
                let before = above(tree, ray, distance_m - near(distance_m));
                assert!(!bounded || before.is_none_or(|h| h >= -near(distance_m)), "{before:?} before {seen:?}");
                return;
            }
            let Some(height) = height else { panic!("no ground at {distance_m} m: {seen:?}") };
            assert!(height.abs() <= near(distance_m) * (1.0 + 1e-9) + 1e-9, "{height} m above the ground: {seen:?}");
            let ground = ray.elevation_m(distance_m) - height;
            assert!((ground - elevation_m).abs() <= 1e-9 * (1.0 + ground.abs()), "{ground} {seen:?}");
            distance_m
        }
    };
    let steps = 3000;
    let step = (to - from) / f64::from(steps);
    let mut below = 0.0;
    for i in 0..steps {
        let t = from + step * (f64::from(i) + 0.5);
        if t >= end {
            break;
        }
        let slack = if matches!(seen, Seen::Sky(_)) { 1e-6 } else { 2.0 * near(t) };
        if above(tree, ray, t).is_some_and(|h| h < -slack) {
            below += step;
            let may = if bounded { 0.0 } else { 16.0 * near(t) + step };
            assert!(below <= may, "below the ground by {:?} m at {t} m before {seen:?}", above(tree, ray, t));
        } else {
            below = 0.0;
        }
    }
}

/// Whether steps are all proved.
fn is_bounded(tree: &Tree) -> bool {
    let bounds = tree.bounds(&Area::PLANE);
    bounds.terrain_slope().is_finite() && bounds.slope.is_finite() && bounds.weight_slope.is_finite()
}

proptest! {
    #![proptest_config(crate::cases(40))]

    #[test]
    fn every_strategy_sees_what_small_steps_see(
        spec in spec(true),
        detail in detail(),
        eye in [-250.0..250.0_f64, -250.0..250.0_f64, 60.0..200.0_f64],
        target in [-50.0..50.0_f64, -50.0..50.0_f64, -20.0..30.0_f64],
        parallel in any::<bool>(),
        exaggeration in prop_oneof![Just(1.0), 0.5..3.0_f64],
    ) {
        let tree = spec.tree(detail);
        let camera = if parallel {
            Camera::parallel(target, eye[0], -eye[2] / 2.5, 6.0)
        } else {
            Camera::towards(eye, target, 1.0)
        };
        let lens = lens(camera.exaggerated(exaggeration), 8, 6);
        let options = TraceOptions { reach_m: Some(600.0), max_steps: 200_000, ..TraceOptions::default() };
        let bounded = is_bounded(&tree);
        for strategy in STRATEGIES {
            if strategy == Strategy::Sphere && !bounded {
                continue;
            }
            let Ok(traced) = trace(&[&tree], &lens, 1, &TraceOptions { strategy, ..options }, &Watch::default()) else {
                prop_assert!(lens.eye().is_some_and(|eye| tree.elevation_m([eye[0], eye[1]]).is_some_and(|f| f > eye[2])));
                return Ok(());
            };
            prop_assert_eq!(traced.counts.exhausted, 0);
            for i in [0, 13, 27, 47] {
                let ray = lens.ray((i % 8) as f64 + 0.5, (i / 8) as f64 + 0.5);
                let near = |t: f64| options.tolerance * ray.pixel_m(t) / exaggeration;
                let from = if parallel { -600.0 } else { 0.0 };
                checks_out(&tree, &ray, &traced.seen[i], (from, 550.0), near, bounded);
            }
        }
    }
}

/// A few hills of ridged noise around the origin.
fn hills() -> Tree {
    let hill = |x: f64, y: f64, seed: u64| {
        Spec::Disc(DiscSpec {
            centre: [x, y],
            base_m: 20.0,
            noise: Some((
                NoiseKind::Ridged { offset: 1.0, gain: 2.0 },
                Spectrum { octaves: 4, amplitude: 25.0, wavelength: 120.0, persistence: 0.5, lacunarity: 2.0, seed },
                false,
            )),
            fall_off: Some((20.0, 150.0)),
        })
    };
    Spec::Blend(
        (0..9).map(|i| hill(f64::from(i % 3) * 90.0 - 90.0, f64::from(i / 3) * 90.0 - 90.0, i as u64)).collect(),
    )
    .tree(Detail::default())
}

fn plain(elevation_m: f64) -> Tree {
    Spec::Disc(DiscSpec { centre: [0.0, 0.0], base_m: elevation_m, noise: None, fall_off: None })
        .tree(Detail::default())
}

#[test]
fn a_picture_of_several_packets_agrees_with_small_steps() {
    let tree = hills();
    let lens = lens(Camera::towards([-250.0, -330.0, 160.0], [0.0, 0.0, 20.0], 40.0), 150, 110);
    let options = TraceOptions::default();
    let traced = look(&tree, &lens, &options);
    let ground = traced.seen.iter().filter(|seen| matches!(seen, Seen::Ground { .. })).count();
    assert!(ground > 5000 && ground < 16_000, "{ground} of {} pixels", traced.seen.len());
    for i in (0..traced.seen.len()).step_by(67) {
        let ray = lens.ray((i % 150) as f64 + 0.5, (i / 150) as f64 + 0.5);
        let near = |t: f64| options.tolerance * ray.pixel_m(t);
        checks_out(&tree, &ray, &traced.seen[i], (0.0, 700.0), near, true);
    }
}

#[test]
fn crests_are_not_jumped_over() {
    // Walls as narrow as their slopes allow, a cell each way, at all distances from one another, on a plain.
    let cols = 80;
    let is_wall =
        |row: usize, col: usize| (3 * row + 7 * col).is_multiple_of(23) || (row * row + col).is_multiple_of(31);
    let height = |row: usize, col: usize| if is_wall(row, col) { 2.0 } else { 0.0 };
    let heights_m = (0..cols * cols).map(|i| height(i / cols, i % cols)).collect();
    let mapping = MappingSpec::Box([-40.0, -40.0], [40.0, 40.0]);
    let tree = Spec::Image(ImageSpec { cols, heights_m, weights: None, bicubic: false, fade: 0.0, mapping })
        .tree(Detail::default());
    for (i, azimuth_deg) in [10.0, 100.0, 220.0].into_iter().enumerate() {
        let lens = lens(Camera::along([0.0, 0.0, 9.0], azimuth_deg, -12.0 - 6.0 * i as f64, 40.0), 80, 48);
        for strategy in [Strategy::Segment, Strategy::Quads] {
            let options = TraceOptions { strategy, reach_m: Some(38.0), ..TraceOptions::default() };
            let traced = look(&tree, &lens, &options);
            for i in 0..traced.seen.len() {
                let ray = lens.ray((i % 80) as f64 + 0.5, (i / 80) as f64 + 0.5);
                let near = |t: f64| options.tolerance * ray.pixel_m(t);
                checks_out(&tree, &ray, &traced.seen[i], (0.0, 38.0), near, true);
            }
        }
    }
}

#[test]
fn strategies_agree_and_shared_quads_take_the_least() {
    let tree = hills();
    let lens = lens(Camera::towards([-250.0, -330.0, 160.0], [0.0, 0.0, 20.0], 40.0), 64, 36);
    let sun = Some([-0.6, 0.0, 0.8]);
    let of =
        |strategy| look(&tree, &lens, &TraceOptions { strategy, sun, max_steps: 1_000_000, ..TraceOptions::default() });
    let all = STRATEGIES.map(of);
    for other in &all[..3] {
        let differ = other.seen.iter().zip(&all[3].seen).filter(|(a, b)| match (a, b) {
            (Seen::Sky(_), Seen::Sky(_)) => false,
            (Seen::Ground { distance_m: a, .. }, Seen::Ground { distance_m: b, .. }) => (a - b).abs() > 0.03 * a,
            _ => true,
        });
        // Where rays graze crests, half a pixel decides.
        let count = differ.count();
        assert!(count * 50 < other.seen.len(), "{count} of {} differ", other.seen.len());
    }
    let taken = |counts: &Counts| counts.evaluations + counts.samples;
    assert!(3 * taken(&all[3].counts) < taken(&all[0].counts), "{:?} {:?}", all[3].counts, all[0].counts);
}

#[test]
fn threads_make_no_difference() {
    let tree = hills();
    let lens = lens(Camera::towards([-250.0, -330.0, 160.0], [0.0, 0.0, 20.0], 40.0), 130, 90);
    let options = TraceOptions { sun: Some([-0.6, 0.0, 0.8]), ..TraceOptions::default() };
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| look(&tree, &lens, &options))
    };
    let one = with(1);
    assert_eq!(one, with(3));
    assert!(one.seen.iter().any(|seen| matches!(seen, Seen::Ground { sunlit: false, .. })));
    assert!(one.seen.iter().any(|seen| matches!(seen, Seen::Ground { sunlit: true, .. })));
}

#[test]
fn a_plain_is_where_geometry_says() {
    let tree = plain(10.0);
    for strategy in STRATEGIES {
        let options = TraceOptions { strategy, ..TraceOptions::default() };
        // Straight down, heights doubled.
        let down = lens(Camera::along([3.0, 4.0, 110.0], 0.0, -90.0, 30.0).exaggerated(2.0), 9, 9);
        let Seen::Ground { distance_m, elevation_m, slope, wall, .. } = look(&tree, &down, &options).seen[40] else {
            panic!("ground below")
        };
        assert!((distance_m - 200.0).abs() < 1e-9 && elevation_m == 10.0 && slope == [0.0; 2] && !wall);
        // At the horizon: the upper half is sky, the lower ground as far as is looked.
        let level = lens(Camera::along([0.0, 0.0, 20.0], 77.0, 0.0, 20.0), 4, 40);
        for (i, seen) in look(&tree, &level, &options).seen.iter().enumerate() {
            let ray = level.ray((i % 4) as f64 + 0.5, (i / 4) as f64 + 0.5);
            match *seen {
                Seen::Sky(rise) => assert!(rise > 0.0 && i < 80, "{rise} in row {}", i / 4),
                Seen::Ground { distance_m, .. } => {
                    let exact = -10.0 / ray.direction[2];
                    assert!((distance_m / exact - 1.0).abs() < 1e-9, "{distance_m} {exact}");
                }
            }
        }
    }
}

#[test]
fn nothing_is_sky_and_eyes_are_above_ground() {
    let mut builder = Builder::new();
    let nothing = builder.blend(&[]).expect("a blend of none");
    let empty = builder.finish(nothing, Detail::default()).expect("a tree");
    let down = lens(Camera::along([0.0, 0.0, 5.0], 0.0, -60.0, 30.0), 5, 5);
    for strategy in STRATEGIES {
        let options = TraceOptions { strategy, ..TraceOptions::default() };
        assert!(look(&empty, &down, &options).seen.iter().all(|seen| matches!(seen, Seen::Sky(_))));
    }
    assert!(trace(&[], &down, 1, &TraceOptions::default(), &Watch::default()).expect("no trees").seen.len() == 25);
    let below = trace(&[&plain(10.0)], &down, 1, &TraceOptions::default(), &Watch::default());
    let message = below.expect_err("an eye below the ground").message().to_string();
    assert!(message.contains("below the ground, which is at 10.0 m"), "{message}");
    for options in [
        TraceOptions { tolerance: 0.0, ..TraceOptions::default() },
        TraceOptions { reach_m: Some(-1.0), ..TraceOptions::default() },
    ] {
        assert!(trace(&[&empty], &down, 1, &options, &Watch::default()).is_err());
    }
    assert!(trace(&[&empty], &down, 0, &TraceOptions::default(), &Watch::default()).is_err());
}

#[test]
fn edges_are_walls_and_hills_throw_shadows() {
    let table = |centre: [f64; 2], base_m: f64, plateau: f64| {
        Spec::Disc(DiscSpec { centre, base_m, noise: None, fall_off: Some((plateau, plateau + 1.0)) })
    };
    // A table seen from the side, from below its top: its rim is where the weight is one half.
    let tree = table([0.0, 0.0], 50.0, 30.0).tree(Detail::default());
    let side = lens(Camera::along([-200.0, 0.0, 25.0], 90.0, 0.0, 1.0), 5, 5);
    for strategy in STRATEGIES {
        let seen = look(&tree, &side, &TraceOptions { strategy, ..TraceOptions::default() }).seen[12];
        let Seen::Ground { distance_m, elevation_m, wall, .. } = seen else { panic!("a wall, not {seen:?}") };
        // 1 - x² = (1/2)^(1/3).
        let rim = 200.0 - 30.0 - (1.0 - 0.5_f64.cbrt()).sqrt();
        assert!(wall && (distance_m - rim).abs() < 0.3 && (elevation_m - 25.0).abs() < 1e-6, "{seen:?}, rim {rim}");
    }
    // A tower on a plain, the sun in the west: dark in the east up to its height over the tangent, light elsewhere.
    let floor = Spec::Disc(DiscSpec { centre: [0.0, 0.0], base_m: 0.0, noise: None, fall_off: None });
    let tower = table([0.0, 0.0], 40.0, 10.0);
    let tree = Spec::Replace(WeightRule::Keep, Box::new(floor), Box::new(tower)).tree(Detail::default());
    let map = lens(Camera::parallel([0.0, 0.0, 0.0], 0.0, -90.0, 200.0), 100, 100);
    let (sun, half) = ([-(0.5_f64.sqrt()), 0.0, 0.5_f64.sqrt()], 50);
    for strategy in STRATEGIES {
        let traced = look(&tree, &map, &TraceOptions { strategy, sun: Some(sun), ..TraceOptions::default() });
        let lit = |x: usize| matches!(traced.seen[half * 100 + x], Seen::Ground { sunlit: true, .. });
        // A pixel is 2 m wide: x = 20 m is 60 pixels from the left, x = 50 m is 75.
        assert!(lit(10) && lit(40) && lit(50), "west of the tower, and on it");
        assert!(!lit(60) && !lit(70), "in its shadow");
        assert!(lit(78) && lit(95), "beyond its shadow");
        assert!(traced.counts.shadow_rays > 5000);
    }
}

#[test]
fn terrain_that_jumps_is_drawn_too() {
    // A hill that replaces a smaller plain beyond that plain's border: no bound of slope there.
    let disc = |base_m: f64, at: f64, fall_off| {
        Box::new(Spec::Disc(DiscSpec { centre: [at, 0.0], base_m, noise: None, fall_off: Some(fall_off) }))
    };
    let tree = Spec::Replace(WeightRule::Join, disc(0.0, 0.0, (40.0, 60.0)), disc(30.0, 50.0, (5.0, 60.0)))
        .tree(Detail::default());
    assert!(!is_bounded(&tree));
    let lens = lens(Camera::towards([-120.0, -120.0, 90.0], [20.0, 0.0, 0.0], 50.0), 40, 30);
    for strategy in STRATEGIES {
        let options = TraceOptions { strategy, max_steps: 100_000, ..TraceOptions::default() };
        let traced = look(&tree, &lens, &options);
        assert_eq!(traced.counts.exhausted, 0, "{strategy:?}");
        for i in (0..1200).step_by(31) {
            let ray = lens.ray((i % 40) as f64 + 0.5, (i / 40) as f64 + 0.5);
            let near = |t: f64| options.tolerance * ray.pixel_m(t);
            checks_out(&tree, &ray, &traced.seen[i], (0.0, 400.0), near, false);
        }
    }
    // A limit of steps ends every ray, and such rays show ground.
    let hurried =
        look(&tree, &lens, &TraceOptions { strategy: Strategy::Sphere, max_steps: 2, ..TraceOptions::default() });
    assert!(hurried.counts.exhausted > 0);
}

#[test]
fn the_nearest_of_several_trees_is_seen() {
    let (ground, water) = (hills(), plain(45.0));
    let map = lens(Camera::parallel([0.0, 0.0, 0.0], 0.0, -90.0, 500.0), 250, 250);
    let traced = trace(&[&ground, &water], &map, 1, &TraceOptions::default(), &Watch::default()).expect("a picture");
    let mut seen = [0, 0];
    for (i, found) in traced.seen.iter().enumerate() {
        let ray = map.ray((i % 250) as f64 + 0.5, (i / 250) as f64 + 0.5);
        let Seen::Ground { tree, .. } = *found else { panic!("ground or water") };
        let under = ground.at(ray.at(0.0));
        let wet = under.weight.value < THRESHOLD || under.elevation.value < 45.0;
        // A pixel is 2 m wide, and the ground is met half of that above it.
        let edge = (under.weight.value - THRESHOLD).abs() < 0.05;
        let sure = !edge && (under.weight.value < THRESHOLD || (under.elevation.value - 45.0).abs() > 2.0);
        assert!(!sure || wet == (tree == 1), "{found:?} over {under:?}");
        seen[tree] += 1;
    }
    assert!(seen[0] > 500 && seen[1] > 500, "{seen:?}");
}

#[test]
fn cameras_point_where_they_say() {
    let close = |a: [f64; 3], b: [f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-12);
    // North is up in a map, and east to the right.
    let map = lens(Camera::parallel([10.0, 20.0, 0.0], 0.0, -90.0, 8.0), 4, 2);
    let corner = map.ray(0.0, 0.0);
    assert!(close(corner.direction, [0.0, 0.0, -1.0]) && close(corner.origin, [6.0, 22.0, 0.0]), "{corner:?}");
    assert_eq!(corner.pixel_m(7.0), 2.0);
    let down = lens(Camera::towards([0.0, 0.0, 9.0], [0.0, 0.0, 0.0], 90.0), 2, 2);
    let half = 0.5_f64.sqrt();
    assert!(close(down.ray(1.0, 0.0).direction, [0.0, half, -half]), "{:?}", down.ray(1.0, 0.0));
    let east = lens(Camera::along([0.0, 0.0, 0.0], 90.0, 0.0, 90.0), 2, 2);
    assert!(close(east.ray(1.0, 1.0).direction, [1.0, 0.0, 0.0]));
    assert!(close(east.ray(2.0, 1.0).direction, [half, -half, 0.0]), "south is to the right");
    // A pixel of the middle is as wide as half of the picture at that depth.
    assert!((east.ray(1.0, 1.0).pixel_m(5.0) - 5.0).abs() < 1e-12);
    let at = |camera: Camera| camera.lens(2, 2).is_err();
    assert!(at(Camera::towards([1.0; 3], [1.0; 3], 40.0)) && at(Camera::along([0.0; 3], 0.0, 91.0, 40.0)));
    assert!(at(Camera::along([0.0; 3], f64::NAN, 0.0, 40.0)) && at(Camera::along([0.0; 3], 0.0, 0.0, 180.0)));
    assert!(at(Camera::parallel([0.0; 3], 0.0, 0.0, 0.0)) && at(Camera::parallel([f64::INFINITY; 3], 0.0, 0.0, 5.0)));
    assert!(at(Camera::along([0.0; 3], 0.0, 0.0, 40.0).exaggerated(0.0)));
    assert!(Camera::along([0.0; 3], 0.0, 0.0, 40.0).lens(0, 2).is_err());
}
