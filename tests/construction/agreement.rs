//! One tree, evaluated in every way there is.

use super::literal;
use super::spec::{DiscSpec, Spec, WarpSpec};
use super::strategy::{detail, spec};
use orograph::construction::{Area, Builder, Detail, Lattice, Place, Point, Tiling, Tree, Want};
use orograph::noise::{NoiseKind, Sample, Spectrum};
use orograph::watch::Watch;
use proptest::prelude::*;

/// Bits with one zero.
fn bits(point: &Point) -> [u64; 6] {
    let Point { elevation: f, weight: w } = point;
    [f.value, f.dx, f.dy, w.value, w.dx, w.dy].map(|v| (v + 0.0).to_bits())
}

fn all(tree: &Tree, lattice: &Lattice, tiling: Tiling, gradient: bool) -> Vec<Point> {
    tree.evaluate(lattice, tiling, gradient, &Watch::default(), |point| *point).expect("nobody cancels")
}

/// Asserts that tiles of several sizes, with and without gradients, equal single points to the bit.
fn agrees(tree: &Tree, lattice: &Lattice) {
    let reference: Vec<Point> =
        (0..lattice.rows * lattice.cols).map(|i| tree.at(lattice.at(i / lattice.cols, i % lattice.cols))).collect();
    for tiling in
        [Tiling::default(), Tiling { cols: 1, rows: 1 }, Tiling { cols: 7, rows: 3 }, Tiling { cols: 1000, rows: 1000 }]
    {
        let with = all(tree, lattice, tiling, true);
        let without = all(tree, lattice, tiling, false);
        for (i, expected) in reference.iter().enumerate() {
            // Where the weight stays what it is and the elevation is not asked for, there is one exception to know:
            // nothing of a node without weight is compared, for there it is nothing.
            assert_eq!(bits(&with[i]), bits(expected), "{tiling:?}, point {i}: {:?}, not {expected:?}", with[i]);
            let (a, b) = (bits(&without[i]), bits(expected));
            assert_eq!((a[0], a[3]), (b[0], b[3]), "{tiling:?}, point {i} without gradient");
        }
    }
}

proptest! {
    #![proptest_config(crate::cases(200))]

    #[test]
    fn tiles_equal_points_to_the_bit(spec in spec(true), detail in detail(), x0 in -90.0..0.0_f64, y0 in -90.0..90.0_f64, dx in 0.05..4.0_f64) {
        let tree = spec.tree(detail);
        agrees(&tree, &Lattice { x0, y0, dx, dy: -1.3 * dx, cols: 71, rows: 9 });
    }

    #[test]
    fn plans_equal_points_to_the_bit(spec in spec(true), detail in detail(), x in -90.0..90.0_f64, y in -90.0..90.0_f64, side in 0.0..60.0_f64) {
        let tree = spec.tree(detail);
        let plan = tree.plan(&Area::of(&[[x, y], [x + side, y + side]]), Want::ALL);
        for i in 0..25 {
            let at = [x + side * f64::from(i % 5) / 4.0, y + side * f64::from(i / 5) / 4.0];
            prop_assert_eq!(bits(&plan.at(at)), bits(&tree.at(at)));
        }
    }

    #[test]
    fn points_are_those_of_the_formulas(spec in spec(false), kappa in 0.0..=1.0_f64, x in -90.0..90.0_f64, y in -90.0..90.0_f64) {
        let tree = spec.tree(Detail::Constant(kappa));
        let point = tree.at([x, y]);
        let place = Place { at: [x, y], kappa: Sample { value: kappa, dx: 0.0, dy: 0.0 } };
        let (f, w) = literal::value(&spec, &place);
        // Slopes of discs are below 50 m a metre here, and coordinates differ by rounding alone.
        prop_assert!((point.weight.value - w).abs() < 1e-7, "weight {} {w}", point.weight.value);
        if w > 1e-6 {
            prop_assert!((point.elevation.value - f).abs() < 1e-5, "elevation {} {f}", point.elevation.value);
        }
    }

    #[test]
    fn gradients_agree_with_differences(spec in spec(true), detail in detail(), x in -90.0..90.0_f64, y in -90.0..90.0_f64) {
        let tree = spec.tree(detail);
        let e = 1e-5;
        let here = tree.at([x, y]);
        let around = [[-e, 0.0], [e, 0.0], [0.0, -e], [0.0, e]].map(|[dx, dy]| tree.at([x + dx, y + dy]));
        for (left, right, by_x) in [(around[0], around[1], true), (around[2], around[3], false)] {
            for elevation in [true, false] {
                let pick = |p: &Point| if elevation { p.elevation } else { p.weight };
                let (a, b, c) = (pick(&left).value, pick(&here).value, pick(&right).value);
                let slope = if by_x { pick(&here).dx } else { pick(&here).dy };
                // Creases, jumps and steep fringes: there differences to both sides do not agree.
                let (before, after) = ((b - a) / e, (c - b) / e);
                if (before - after).abs() < 1e-3 * (1.0 + slope.abs()) && !has_slope_ramp(&spec) {
                    prop_assert!(((c - a) / (2.0 * e) - slope).abs() < 2e-3 * (1.0 + slope.abs()), "{slope}, differences {before} {after}");
                }
            }
        }
    }
}

/// Whether a weight depends on a slope: its gradient is itself a difference.
fn has_slope_ramp(spec: &Spec) -> bool {
    match spec {
        Spec::Disc(_) | Spec::Curve(_) | Spec::Image(_) | Spec::Contour(_) => false,
        Spec::Blend(children) => children.iter().any(has_slope_ramp),
        Spec::Weigh(_, slope, a, b) => slope.is_some() || has_slope_ramp(a) || has_slope_ramp(b),
        Spec::Replace(_, a, b) | Spec::Add(_, a, b) | Spec::Level(_, _, a, b) | Spec::Dunes(a, b) => {
            has_slope_ramp(a) || has_slope_ramp(b)
        }
        Spec::Warp(_, child) => has_slope_ramp(child),
    }
}

/// A hill of ridged noise.
fn hill() -> Spec {
    let spectrum =
        Spectrum { octaves: 3, amplitude: 20.0, wavelength: 50.0, persistence: 0.5, lacunarity: 2.0, seed: 5 };
    Spec::Disc(DiscSpec {
        centre: [0.0, 0.0],
        base_m: 10.0,
        noise: Some((NoiseKind::Ridged { offset: 1.0, gain: 2.0 }, spectrum, false)),
        fall_off: Some((5.0, 40.0)),
    })
}

#[test]
fn threads_make_no_difference() {
    let children = (0..40).map(|i| {
        let shift = [f64::from(i % 8) * 25.0, f64::from(i / 8) * 25.0];
        let warp =
            WarpSpec::Affine { scale: [1.0, 1.2], degrees: f64::from(i) * 17.0, shift, z_scale: 1.0, z_shift_m: 0.0 };
        Spec::Warp(warp, Box::new(hill()))
    });
    let tree = Spec::Blend(children.collect()).tree(Detail::default());
    let lattice = Lattice { x0: -40.0, y0: 140.0, dx: 0.9, dy: -0.9, cols: 300, rows: 200 };
    let bits_with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let values = pool.install(|| tree.elevations_m(&lattice, &Watch::default())).expect("nobody cancels");
        values.iter().map(|v| v.to_bits()).collect::<Vec<u64>>()
    };
    let one = bits_with(1);
    assert!(one == bits_with(3));
    assert!(one.iter().any(|v| f64::from_bits(*v).is_nan()) && one.iter().any(|v| f64::from_bits(*v) > 20.0));
    agrees(&tree, &Lattice { cols: 130, rows: 20, ..lattice });
}

#[test]
fn instances_equal_copies() {
    let place = |i: i32| WarpSpec::Affine {
        scale: [1.0, 0.8],
        degrees: f64::from(i) * 31.0,
        shift: [f64::from(i) * 30.0, f64::from(i % 3) * 20.0],
        z_scale: 1.0 + 0.1 * f64::from(i),
        z_shift_m: f64::from(i),
    };
    let copies = Spec::Blend((0..10).map(|i| Spec::Warp(place(i), Box::new(hill()))).collect()).tree(Detail::default());
    let mut builder = Builder::new();
    let one = hill().add(&mut builder);
    let warped: Vec<_> =
        (0..10).map(|i| builder.place(one, place(i).affine().expect("affine")).expect("sound")).collect();
    let root = builder.blend(&warped).expect("sound");
    let instances = builder.finish(root, Detail::default()).expect("sound");
    assert_eq!((copies.counts().0, instances.counts().0), (10, 1));
    assert!(instances.bytes() < copies.bytes());
    let lattice = Lattice { x0: -50.0, y0: -50.0, dx: 3.1, dy: 3.3, cols: 130, rows: 40 };
    let tiling = Tiling::default();
    assert_eq!(all(&copies, &lattice, tiling, true), all(&instances, &lattice, tiling, true));
    agrees(&instances, &lattice);
}

#[test]
fn one_warp_stands_for_several() {
    let warps = [
        WarpSpec::Affine { scale: [2.0, 0.5], degrees: 30.0, shift: [10.0, -5.0], z_scale: 2.0, z_shift_m: 3.0 },
        WarpSpec::Affine { scale: [-1.0, 1.5], degrees: -75.0, shift: [-20.0, 9.0], z_scale: -0.5, z_shift_m: 1.0 },
        WarpSpec::Affine { scale: [0.7, 0.7], degrees: 200.0, shift: [3.0, 4.0], z_scale: 1.5, z_shift_m: -8.0 },
    ];
    let nested = warps.iter().fold(hill(), |child, warp| Spec::Warp(warp.clone(), Box::new(child)));
    let tree = nested.tree(Detail::default());
    let place = |at| Place { at, kappa: Sample { value: 1.0, dx: 0.0, dy: 0.0 } };
    let mut seen = 0;
    for i in 0..400 {
        let at = [f64::from(i % 20) * 3.0 - 40.0, f64::from(i / 20) * 3.0 - 25.0];
        let (f, w) = literal::value(&nested, &place(at));
        let point = tree.at(at);
        assert!((point.weight.value - w).abs() < 1e-12 && (w == 0.0 || (point.elevation.value - f).abs() < 1e-9));
        seen += u32::from(w > 0.0);
    }
    assert!(seen > 50, "{seen} points in the hill");
    // Only the last of the three is used: it stands upon the hill itself.
    assert_eq!(tree.plan(&Area::PLANE, Want::ALL).len(), 2);
}

#[test]
fn plans_leave_out_what_cannot_matter() {
    let disc = |x: f64, base_m: f64, plateau: f64, radius: f64| {
        Spec::Disc(DiscSpec { centre: [x, 0.0], base_m, noise: None, fall_off: Some((plateau, radius)) })
    };
    let blend = Spec::Blend((0..100).map(|i| disc(f64::from(i) * 10.0, 1.0, 0.0, 15.0)).collect());
    let rule = orograph::construction::WeightRule::Join;
    let tree = Spec::Replace(rule, Box::new(blend), Box::new(disc(500.0, 7.0, 50.0, 60.0))).tree(Detail::default());
    let steps = |x0: f64, x1: f64| tree.plan(&Area::of(&[[x0, -1.0], [x1, 1.0]]), Want::ALL).len();
    assert_eq!(steps(500.0, 510.0), 2, "the replacement and the disc that covers all");
    assert_eq!(steps(100.0, 101.0), 4, "a blend of three");
    assert_eq!(steps(-100.0, -50.0), 0);
    assert_eq!(steps(-1e9, 1e9), 103);
}
