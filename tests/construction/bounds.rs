//! Bounds that nothing may break.

use super::strategy::{detail, spec};
use orograph::construction::{Area, Bounds, Point, THRESHOLD, Tree};
use proptest::prelude::*;

/// Asserts that points of a box keep its bounds.
pub fn keeps(tree: &Tree, bounds: &Bounds, area: &Area, steps: u32) {
    let along = |i: u32, min: f64, max: f64| (min + (max - min) * f64::from(i) / f64::from(steps - 1)).clamp(min, max);
    let mut before: Vec<Option<([f64; 2], Point)>> = vec![None; steps as usize];
    for row in 0..steps {
        let mut left: Option<([f64; 2], Point)> = None;
        for col in 0..steps {
            let at = [along(col, area.x.min, area.x.max), along(row, area.y.min, area.y.max)];
            let point = tree.at(at);
            check_point(bounds, &point, at);
            let defined = point.weight.value > 0.0;
            for (other_at, other) in [&left, &before[col as usize]].into_iter().flatten() {
                let way = ((at[0] - other_at[0]).powi(2) + (at[1] - other_at[1]).powi(2)).sqrt();
                let rise = (point.weight.value - other.weight.value).abs();
                assert!(
                    rise <= bounds.weight_slope * way * (1.0 + 1e-9) + 1e-9,
                    "weight rises {rise} in {way} m at {at:?}: {bounds:?}"
                );
                if defined && other.weight.value > 0.0 {
                    let rise = (point.elevation.value - other.elevation.value).abs();
                    // A way through points without weight is no way; two discs that touch have one such point.
                    let between = |i: u32| {
                        let t = f64::from(i) / 16.0;
                        [other_at[0] + t * (at[0] - other_at[0]), other_at[1] + t * (at[1] - other_at[1])]
                    };
                    if bounds.weight.min > 0.0 || (1..16).all(|i| tree.at(between(i)).weight.value > 1e-6) {
                        assert!(
                            rise <= bounds.slope * way * (1.0 + 1e-9) + 1e-7,
                            "rises {rise} in {way} m at {at:?}: {bounds:?}"
                        );
                    }
                }
            }
            left = Some((at, point));
            before[col as usize] = Some((at, point));
        }
    }
}

fn check_point(bounds: &Bounds, point: &Point, at: [f64; 2]) {
    let weight = point.weight.value;
    assert!(bounds.weight.holds(weight), "weight {weight} at {at:?}: {bounds:?}");
    if weight <= 0.0 {
        return;
    }
    let steep = |s: &orograph::noise::Sample| (s.dx * s.dx + s.dy * s.dy).sqrt();
    let slope = steep(&point.elevation);
    assert!(bounds.elevation.holds(point.elevation.value), "elevation {} at {at:?}: {bounds:?}", point.elevation.value);
    assert!(slope <= bounds.slope * (1.0 + 1e-9) + 1e-9, "slope {slope} at {at:?}: {bounds:?}");
    assert!(
        slope * weight <= bounds.weighted_slope * (1.0 + 1e-9) + 1e-9,
        "slope {slope} times {weight} at {at:?}: {bounds:?}"
    );
    assert!(steep(&point.weight) <= bounds.weight_slope * (1.0 + 1e-9) + 1e-12, "weight's slope at {at:?}: {bounds:?}");
    if weight >= THRESHOLD {
        assert!(slope <= bounds.terrain_slope() * (1.0 + 1e-9) + 1e-9, "terrain's slope {slope} at {at:?}: {bounds:?}");
    }
}

proptest! {
    #![proptest_config(crate::cases(300))]

    #[test]
    fn no_point_breaks_the_bounds(spec in spec(true), detail in detail(), x in -120.0..90.0_f64, y in -120.0..90.0_f64, side in 0.01..80.0_f64) {
        let tree = spec.tree(detail);
        let whole = tree.bounds(&Area::PLANE);
        let area = Area::of(&[[x, y], [x + side, y + side]]);
        let local = tree.bounds(&area);
        keeps(&tree, &local, &area, 12);
        keeps(&tree, &whole, &Area::of(&[[-150.0, -150.0], [150.0, 150.0]]), 12);
        keeps(&tree, &whole, &Area::of(&[[x, y], [x + 0.5, y + 0.5]]), 6);
        // A segment's box.
        let other = [x + side, y - side / 3.0];
        let segment = tree.bounds(&Area::of(&[[x, y], other]));
        for i in 0..30 {
            let t = f64::from(i) / 29.0;
            let at = [x + t * side, y - t * side / 3.0];
            let at = if i == 29 { other } else { at };
            check_point(&segment, &tree.at(at), at);
        }
    }
}
