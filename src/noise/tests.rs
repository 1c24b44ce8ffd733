//! Sums of noise against their definitions, differences and bounds.

use super::*;
use crate::interval::Interval;
use proptest::prelude::*;

const KINDS: [NoiseKind; 3] = [NoiseKind::Fractal, NoiseKind::Turbulence, NoiseKind::Ridged { offset: 1.0, gain: 2.0 }];

/// No filter listens to it.
const ANY: (Interval, f64) = (Interval { min: 0.0, max: 1.0 }, 0.0);

fn sums() -> impl Strategy<Value = NoiseSum> {
    let kind = prop_oneof![
        Just(NoiseKind::Fractal),
        Just(NoiseKind::Turbulence),
        (0.4..1.5_f64, 0.5..3.0_f64).prop_map(|(offset, gain)| NoiseKind::Ridged { offset, gain }),
    ];
    let spectrum = (1..5_usize, -50.0..50.0_f64, 5.0..500.0_f64, 0.3..0.8_f64, 1.5..2.5_f64, any::<u64>());
    (kind, spectrum, any::<bool>()).prop_map(
        |(kind, (octaves, amplitude, wavelength, persistence, lacunarity, seed), filtered)| {
            let spectrum = Spectrum { octaves, amplitude, wavelength, persistence, lacunarity, seed };
            let sum = NoiseSum::new(kind, spectrum.terms());
            let filters = (0..octaves).map(|i| Filter { from: 0.2 * i as f64, to: 0.2 * i as f64 + 0.15 }).collect();
            if filtered { sum.with_filters(filters) } else { sum }
        },
    )
}

/// Proves by branch and bound that a function of a place `(u, v)` in a cell and an angle stays below a limit. It changes
/// by at most so much per unit of u or v, and of the angle; and by symmetry a quarter of the cell and half a turn are
/// enough.
pub(super) fn assert_below(limit: f64, (place_slope, angle_slope): (f64, f64), of: impl Fn(f64, f64, f64) -> f64) {
    let half_turn = std::f64::consts::PI;
    let mut boxes = vec![([0.25, 0.25, half_turn / 2.0], [0.25, 0.25, half_turn / 2.0])];
    let mut looked_at = 0;
    while let Some((centre, half)) = boxes.pop() {
        looked_at += 1;
        assert!(looked_at < 20_000_000, "the search ends");
        let value = of(centre[0], centre[1], centre[2]);
        assert!(value < limit, "{centre:?}: {value}");
        let reach = [half[0] * place_slope, half[1] * place_slope, half[2] * angle_slope];
        if value + reach.iter().sum::<f64>() <= limit {
            continue;
        }
        let longest = (0..3).fold(0, |best, i| if reach[i] > reach[best] { i } else { best });
        for side in [-0.5, 0.5] {
            let (mut centre, mut half) = (centre, half);
            centre[longest] += side * half[longest];
            half[longest] /= 2.0;
            boxes.push((centre, half));
        }
    }
}

/// A level of detail that changes along x.
fn kappa(x: f64) -> Sample {
    Sample { value: 0.5 + 0.001 * x, dx: 0.001, dy: 0.0 }
}

proptest! {
    #[test]
    fn bounds_hold_everywhere_and_near(sum in sums(), x in -300.0..300.0_f64, y in -300.0..300.0_f64, radius in 0.1..40.0_f64) {
        let (range, slope) = sum.bounds((Interval::new(0.0, 1.0), 0.001));
        let near_kappa = Interval::around(kappa(x).value, 0.001 * radius).widened();
        let (near, near_slope) = sum.bounds_near(x, y, radius, (near_kappa, 0.001));
        prop_assert!(near_slope <= slope * (1.0 + 1e-9));
        let mut last: Option<(f64, f64, f64)> = None;
        for i in 0..60 {
            // A spiral of rational points of the circle.
            let t = f64::from(i) * 0.37 - 3.0;
            let r = radius * f64::from(i + 1) / 60.0;
            let (px, py) = (x + r * (1.0 - t * t) / (1.0 + t * t), y + r * 2.0 * t / (1.0 + t * t));
            let n = sum.at(px, py, kappa(px));
            let steep = (n.dx * n.dx + n.dy * n.dy).sqrt();
            prop_assert!(range.holds(n.value) && near.holds(n.value), "{} in {:?}, {:?}", n.value, range, near);
            prop_assert!(steep <= near_slope, "{steep} {near_slope}");
            if let Some((qx, qy, value)) = last {
                let distance = ((px - qx) * (px - qx) + (py - qy) * (py - qy)).sqrt();
                prop_assert!((n.value - value).abs() <= near_slope * distance + 1e-9);
            }
            last = Some((px, py, n.value));
        }
    }

    #[test]
    fn gradients_agree_with_differences(sum in sums(), x in -300.0..300.0_f64, y in -300.0..300.0_f64) {
        let e = 1e-5;
        let at = |x: f64, y: f64| sum.at(x, y, kappa(x)).value;
        let n = sum.at(x, y, kappa(x));
        let (left, right, down, up) = (at(x - e, y), at(x + e, y), at(x, y - e), at(x, y + e));
        // Creases have two gradients; there the differences to both sides do not agree either.
        let smooth = |a: f64, b: f64| (a + b - 2.0 * n.value).abs() < 1e-7;
        if smooth(left, right) {
            prop_assert!(((right - left) / (2.0 * e) - n.dx).abs() < 1e-3);
        }
        if smooth(down, up) {
            prop_assert!(((up - down) / (2.0 * e) - n.dy).abs() < 1e-3);
        }
    }

    #[test]
    fn crossings_equal_points_to_the_bit(
        sum in sums(), count in 0..40_usize, x in -300.0..300.0_f64, y in -300.0..300.0_f64, way in steps(), down in steps(),
    ) {
        let xs: [f64; COLS] = std::array::from_fn(|k| x + way * k.min(28) as f64);
        let ys: Vec<f64> = (0..count).map(|r| y + down * r as f64).collect();
        let places: Vec<[(f64, f64); COLS]> = ys.iter().map(|&y| xs.map(|x| (x, y))).collect();
        agrees(&sum, &places, |levels, gradient, out| {
            if gradient {
                sum.cross::<true>(&xs, &ys, levels, out);
            } else {
                sum.cross::<false>(&xs, &ys, levels, out);
            }
        });
    }

    #[test]
    fn scattered_points_equal_points_to_the_bit(
        sum in sums(), count in 0..40_usize, x in -300.0..300.0_f64, y in -300.0..300.0_f64, way in steps(), down in steps(),
    ) {
        let place = |r: usize, k: usize| {
            let (along, across) = (way * k as f64, down * r as f64);
            (x + 0.8 * along - 0.6 * across, y + 0.6 * along + 0.8 * across)
        };
        let places: Vec<[(f64, f64); COLS]> = (0..count).map(|r| std::array::from_fn(|k| place(r, k))).collect();
        let xs: Vec<[f64; COLS]> = places.iter().map(|row| row.map(|at| at.0)).collect();
        let ys: Vec<[f64; COLS]> = places.iter().map(|row| row.map(|at| at.1)).collect();
        agrees(&sum, &places, |levels, gradient, out| {
            if gradient {
                sum.scatter::<true>(&xs, &ys, levels, out);
            } else {
                sum.scatter::<false>(&xs, &ys, levels, out);
            }
        });
    }
}

/// Ways from a point to the next: none, small next to a cell, larger than one, in both directions.
fn steps() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), -0.1..0.1_f64, -3.0..3.0_f64, -40.0..40.0_f64, -4000.0..4000.0_f64]
}

/// Asserts that rows of points, with and without gradients, are those of single points to the bit.
fn agrees(sum: &NoiseSum, places: &[[(f64, f64); COLS]], evaluate: impl Fn(Levels<'_>, bool, Rows<'_>)) {
    let level =
        |f: fn(&Sample) -> f64| places.iter().map(|row| row.map(|(x, _)| f(&kappa(x)))).collect::<Vec<[f64; COLS]>>();
    let levels = [level(|k| k.value), level(|k| k.dx), level(|k| k.dy)];
    let levels = [&levels[0][..], &levels[1], &levels[2]];
    let anything = vec![[7.0; COLS]; places.len()];
    let mut with = [anything.clone(), anything.clone(), anything];
    let mut without = with.clone();
    let [value, dx, dy] = &mut with;
    evaluate(levels, true, Rows { value, dx, dy });
    let [value, dx, dy] = &mut without;
    evaluate(levels, false, Rows { value, dx, dy });
    for (r, row) in places.iter().enumerate() {
        for (k, &(x, y)) in row.iter().enumerate() {
            let n = sum.at(x, y, kappa(x));
            let found = [with[0][r][k], with[1][r][k], with[2][r][k]];
            assert_eq!(found.map(f64::to_bits), [n.value, n.dx, n.dy].map(f64::to_bits), "{x} {y}: {found:?}, {n:?}");
            assert_eq!(without[0][r][k].to_bits(), n.value.to_bits(), "{x} {y} without gradient");
        }
    }
}

#[test]
fn sums_are_those_of_their_definitions() {
    let spectrum =
        Spectrum { octaves: 3, amplitude: 10.0, wavelength: 100.0, persistence: 0.5, lacunarity: 2.0, seed: 4 };
    for kind in KINDS {
        let sum = NoiseSum::new(kind, spectrum.terms());
        for i in 0..200 {
            let (x, y) = (f64::from(i) * 3.7, f64::from(i) * -1.9);
            let eta: Vec<f64> = sum
                .octaves()
                .iter()
                .map(|o| {
                    gradient_noise::<true>(o.seed, x * o.frequency + o.shift[0], y * o.frequency + o.shift[1]).value
                })
                .collect();
            let expected = match kind {
                NoiseKind::Fractal => 10.0 * eta[0] + 5.0 * eta[1] + 2.5 * eta[2],
                NoiseKind::Turbulence => 10.0 * eta[0].abs() + 5.0 * eta[1].abs() + 2.5 * eta[2].abs(),
                NoiseKind::Ridged { .. } => {
                    let squares: Vec<f64> = eta.iter().map(|n| (1.0 - n.abs()) * (1.0 - n.abs())).collect();
                    let second = squares[1] * (2.0 * squares[0]).min(1.0);
                    let third = squares[2] * (2.0 * second).min(1.0);
                    10.0 * squares[0] + 5.0 * second + 2.5 * third
                }
            };
            assert!((sum.at(x, y, Sample::default()).value - expected).abs() < 1e-12);
        }
    }
}

#[test]
fn bounds_are_the_sums_of_amplitudes_and_of_slopes() {
    let octaves = Octave::of(1, &[(8.0, 0.01), (-2.0, 0.03)]);
    let (range, slope) = NoiseSum::new(NoiseKind::Fractal, octaves.clone()).bounds(ANY);
    assert!((range.max - 10.0).abs() < 1e-9 && (range.min + 10.0).abs() < 1e-9);
    assert!((slope - SLOPE * (0.08 + 0.06)).abs() < 1e-9);
    let (range, _) = NoiseSum::new(NoiseKind::Turbulence, octaves).bounds(ANY);
    assert!((range.max - 8.0).abs() < 1e-9 && (range.min + 2.0).abs() < 1e-9);
}

#[test]
fn filters_rise_from_nothing_to_all() {
    let filter = Filter { from: 0.25, to: 0.75 };
    assert_eq!([0.0, 0.25, 0.75, 1.0].map(|k| filter.share(k).0), [0.0, 0.0, 1.0, 1.0]);
    let mut last = 0.0;
    let mut steepest = 0.0_f64;
    for i in 0..=1000 {
        let (share, slope) = filter.share(f64::from(i) / 1000.0);
        assert!(share >= last, "it rises");
        last = share;
        steepest = steepest.max(slope);
    }
    assert!(steepest <= filter.slope() && steepest > 0.999 * filter.slope(), "{steepest} {}", filter.slope());
    assert_eq!(filter.share(0.5).0, 0.421875);
}
