//! Random trees.

use super::spec::{ContourSpec, CurveSpec, DiscSpec, ImageSpec, MappingSpec, Spec, WarpSpec};
use orograph::construction::primitive::Mapping;
use orograph::construction::{Detail, WeightRule};
use orograph::noise::{NoiseKind, Spectrum};
use proptest::prelude::*;

fn spectrum() -> impl Strategy<Value = Spectrum> {
    (1..4_usize, 1.0..30.0_f64, 20.0..200.0_f64, any::<u64>()).prop_map(|(octaves, amplitude, wavelength, seed)| {
        Spectrum { octaves, amplitude, wavelength, persistence: 0.5, lacunarity: 2.0, seed }
    })
}

fn near() -> impl Strategy<Value = [f64; 2]> {
    [-60.0..60.0_f64, -60.0..60.0_f64]
}

fn disc() -> impl Strategy<Value = DiscSpec> {
    let kind = prop_oneof![
        Just(NoiseKind::Fractal),
        Just(NoiseKind::Turbulence),
        Just(NoiseKind::Ridged { offset: 1.0, gain: 2.0 }),
    ];
    let noise = proptest::option::of((kind, spectrum(), any::<bool>()));
    let fall_off = proptest::option::weighted(0.85, (prop_oneof![Just(0.0), 1.0..60.0_f64], 10.0..80.0_f64));
    (near(), -30.0..60.0_f64, noise, fall_off).prop_map(|(centre, base_m, noise, fall_off)| DiscSpec {
        centre,
        base_m,
        noise,
        fall_off: fall_off.map(|(plateau, width)| (plateau, plateau + width)),
    })
}

/// A chain of three to six points that turns by less than two thirds of a right angle at a time; sometimes a corner.
pub fn curve() -> impl Strategy<Value = CurveSpec> {
    let steps = proptest::collection::vec((10.0..40.0_f64, -1.0..1.0_f64, -10.0..10.0_f64), 2..5);
    let knots = proptest::collection::vec((1.0..10.0_f64, -8.0..8.0_f64), 1..4).prop_map(|steps| {
        let mut at = -12.0;
        let knot = |(step, z): &(f64, f64)| {
            at += step;
            (at, *z)
        };
        steps.iter().map(knot).collect::<Vec<_>>()
    });
    let even = (1.0..10.0_f64, -8.0..8.0_f64).prop_map(|(w, z)| vec![(-w, 0.0), (0.0, z), (w, 0.0)]);
    let sections = prop_oneof![
        2 => proptest::collection::vec(knots, 1..3),
        1 => even.prop_map(|knots| vec![knots]),
    ];
    let fall_off = (0.0..10.0_f64, 5.0..25.0_f64).prop_map(|(plateau, width)| (plateau, plateau + width));
    (near(), -3.0..3.0_f64, any::<bool>(), any::<bool>(), steps, sections, fall_off).prop_map(
        |(start, heading, smooth, level, steps, sections, fall_off)| {
            let (mut at, mut heading) = ([start[0], start[1], 5.0], heading);
            let mut points = vec![at];
            for (step, turn, rise) in steps {
                heading += turn;
                at = [
                    at[0] + step * heading.cos(),
                    at[1] + step * heading.sin(),
                    at[2] + if level { 0.0 } else { rise },
                ];
                points.push(at);
            }
            CurveSpec { points, smooth, sections, fall_off }
        },
    )
}

/// A small raster with voids, on a box, a quadrangle or along a curve.
pub fn image() -> impl Strategy<Value = ImageSpec> {
    let size = (2..12_usize, 2..12_usize);
    let mapping =
        (near(), 20.0..90.0_f64, [-0.4..0.4_f64, -0.4..0.4_f64, -0.4..0.4_f64, -0.4..0.4_f64], 0..3, any::<bool>());
    let mapping = mapping.prop_map(|([x, y], side, [a, b, c, d], kind, mirrored)| match kind {
        0 => MappingSpec::Box([x, y], [x + side, y + side * (0.7 + a)]),
        1 => {
            let corner = |u: f64, v: f64| [x + side * u, y - side * v];
            // Beyond a third some are not convex.
            let [a, b, c, d] = [a, b, c, d].map(|share| share * 0.8);
            let corners =
                [corner(0.0, 0.0), corner(1.0 + a, b / 2.0), corner(1.0 + c, 1.0 + d), corner(c / 2.0, 1.0 + a / 2.0)];
            MappingSpec::Quadrangle(if mirrored { [corners[0], corners[3], corners[2], corners[1]] } else { corners })
        }
        _ => MappingSpec::Along(
            vec![[x, y, 0.0], [x + side, y + side * a, 0.0], [x + 2.0 * side, y + side * b, 0.0]],
            side * (0.2 + c / 4.0),
        ),
    });
    // One quadrangle in some ten thousand is not convex.
    let mapping = mapping.prop_filter("convex", |mapping| match mapping {
        MappingSpec::Quadrangle(corners) => Mapping::on_quadrangle(*corners).is_ok(),
        _ => true,
    });
    let fade = prop_oneof![Just(0.0), 0.3..3.0_f64];
    (size, any::<bool>(), any::<bool>(), fade, mapping, any::<u64>()).prop_map(
        |((rows, cols), bicubic, weighted, fade, mapping, seed)| {
            let mut rng = orograph::rng::Rng::new(seed);
            let voids = rng.below(3) == 0;
            let mut height = || {
                let value = rng.between(-30.0, 30.0);
                if voids && rng.below(6) == 0 { f64::NAN } else { value }
            };
            let mut heights_m: Vec<f64> = (0..rows * cols).map(|_| height()).collect();
            heights_m[0] = 1.0;
            let weights =
                weighted.then(|| (0..rows * cols).map(|i| if i == 0 { 1.0 } else { rng.between(-0.2, 1.2) }).collect());
            ImageSpec { cols, heights_m, weights, bicubic, fade, mapping }
        },
    )
}

/// A lake or a mound.
pub fn contour() -> impl Strategy<Value = ContourSpec> {
    let radii = proptest::collection::vec(20.0..35.0_f64, 6..9);
    let fall_off = (0.3..1.2_f64, 0.2..0.8_f64).prop_map(|(plateau, width)| (plateau, plateau + width));
    (near(), radii, proptest::collection::vec((-9.0..9.0_f64, -9.0..9.0_f64), 9), any::<bool>(), fall_off).prop_map(
        |(centre, radii_m, heights, single, fall_off)| {
            let count = if single { 1 } else { radii_m.len() };
            let profile = |(a, b): &(f64, f64)| vec![(0.0, -4.0), (0.5, *a), (1.1, *b)];
            let profiles = heights[..count].iter().map(profile).collect();
            ContourSpec { centre, radii_m, profiles, fall_off }
        },
    )
}

fn warp(with_noise: bool) -> impl Strategy<Value = WarpSpec> {
    let scale = (prop_oneof![-1.6..-0.5_f64, 0.5..1.6_f64], 0.5..1.6_f64).prop_map(|(x, y)| [x, y]);
    let affine = (scale, -200.0..200.0_f64, near(), -1.5..1.5_f64, -20.0..20.0_f64).prop_map(
        |(scale, degrees, shift, z_scale, z_shift_m)| WarpSpec::Affine { scale, degrees, shift, z_scale, z_shift_m },
    );
    let drag = (near(), [-20.0..20.0_f64, -20.0..20.0_f64], 60.0..120.0_f64)
        .prop_map(|(centre, by, radius_m)| WarpSpec::Drag { centre, by, radius_m });
    let twist = (near(), -120.0..120.0_f64, 20.0..120.0_f64).prop_map(|(centre, degrees, radius_m)| WarpSpec::Twist {
        centre,
        degrees,
        radius_m,
    });
    let noise = (20.0..100.0_f64, any::<u64>()).prop_map(|(wavelength, seed)| {
        let amplitude = wavelength * 0.08;
        WarpSpec::Noise(Spectrum { octaves: 2, amplitude, wavelength, persistence: 0.5, lacunarity: 2.0, seed })
    });
    if with_noise {
        prop_oneof![2 => affine, 1 => drag, 1 => twist, 1 => noise].boxed()
    } else {
        prop_oneof![2 => affine, 1 => drag, 1 => twist].boxed()
    }
}

fn rule() -> impl Strategy<Value = WeightRule> {
    prop_oneof![Just(WeightRule::Keep), Just(WeightRule::Join)]
}

/// A tree; `with_noise` allows deformations by noise.
pub fn spec(with_noise: bool) -> impl Strategy<Value = Spec> {
    let leaf = prop_oneof![3 => disc().prop_map(Spec::Disc), 1 => curve().prop_map(Spec::Curve), 1 => image().prop_map(Spec::Image), 1 => contour().prop_map(Spec::Contour)];
    leaf.prop_recursive(4, 24, 12, move |inner| {
        let boxed = inner.clone().prop_map(Box::new);
        let elevations = (-20.0..40.0_f64, 5.0..40.0_f64, any::<bool>())
            .prop_map(|(a, width, falls)| if falls { (a + width, a) } else { (a, a + width) });
        let slopes = (0.0..1.0_f64, 0.2..2.0_f64).prop_map(|(a, width)| (a, a + width));
        let ramps = prop_oneof![
            elevations.clone().prop_map(|e| (Some(e), None)),
            slopes.clone().prop_map(|s| (None, Some(s))),
            (elevations, slopes).prop_map(|(e, s)| (Some(e), Some(s))),
        ];
        prop_oneof![
            3 => proptest::collection::vec(inner.clone(), 1..12).prop_map(Spec::Blend),
            2 => (rule(), boxed.clone(), boxed.clone()).prop_map(|(rule, a, b)| Spec::Replace(rule, a, b)),
            2 => (rule(), boxed.clone(), boxed.clone()).prop_map(|(rule, a, b)| Spec::Add(rule, a, b)),
            3 => (warp(with_noise), boxed.clone()).prop_map(|(warp, a)| Spec::Warp(warp, a)),
            1 => (0.0..0.4_f64, 0.1..0.6_f64, boxed.clone(), boxed.clone())
                .prop_map(|(from, width, a, b)| Spec::Level(from, from + width, a, b)),
            1 => (ramps, boxed.clone(), boxed.clone()).prop_map(|((e, s), a, b)| Spec::Weigh(e, s, a, b)),
            1 => (boxed.clone(), boxed).prop_map(|(a, b)| Spec::Dunes(a, b)),
        ]
    })
}

/// A source of the level of detail.
pub fn detail() -> impl Strategy<Value = Detail> {
    prop_oneof![
        (0.0..=1.0_f64).prop_map(Detail::Constant),
        (near(), 0.0..40.0_f64, 10.0..100.0_f64).prop_map(|(centre, near_m, width)| Detail::Around {
            centre,
            near_m,
            far_m: near_m + width
        }),
    ]
}
