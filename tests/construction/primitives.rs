//! Primitives on their own.

use super::bounds::keeps;
use super::spec::{ImageSpec, MappingSpec};
use super::strategy::{contour, curve, image};
use orograph::construction::primitive::Skeleton;
use orograph::construction::{Area, Detail};
use proptest::prelude::*;

proptest! {
    #![proptest_config(crate::cases(200))]

    #[test]
    fn the_nearest_point_of_a_curve_is_the_nearest(curve in curve(), x in -150.0..150.0_f64, y in -150.0..150.0_f64) {
        let skeleton = Skeleton::through(&curve.points, curve.smooth).expect("sound");
        let found = skeleton.distance_m([x, y], 1e4).expect("near enough");
        // Many points of the same curve, from the definition of its parabolas.
        let mut least = f64::INFINITY;
        for control in controls(&curve.points, curve.smooth) {
            for i in 0..=2000 {
                let t = f64::from(i) / 2000.0;
                let along = |k: usize| {
                    let [p, c, q] = control.map(|point| point[k]);
                    (1.0 - t) * (1.0 - t) * p + 2.0 * t * (1.0 - t) * c + t * t * q
                };
                least = least.min((along(0) - x).hypot(along(1) - y));
            }
        }
        prop_assert!(found <= least + 1e-9 && least - found < 0.05, "{found}, samples {least}");
    }

    #[test]
    fn a_curve_keeps_its_bounds(curve in curve(), x in -120.0..90.0_f64, y in -120.0..90.0_f64, side in 0.01..80.0_f64) {
        let tree = super::spec::Spec::Curve(curve).tree(Detail::default());
        let area = Area::of(&[[x, y], [x + side, y + side]]);
        keeps(&tree, &tree.bounds(&area), &area, 20);
    }
}

proptest! {
    #![proptest_config(crate::cases(200))]

    #[test]
    fn an_image_keeps_its_bounds(image in image(), x in -90.0..150.0_f64, y in -150.0..120.0_f64, side in 0.01..60.0_f64) {
        let tree = super::spec::Spec::Image(image).tree(Detail::default());
        let area = Area::of(&[[x, y], [x + side, y + side]]);
        keeps(&tree, &tree.bounds(&area), &area, 20);
        let seen = tree.support();
        keeps(&tree, &tree.bounds(&Area::PLANE), &seen, 30);
    }

    #[test]
    fn a_contour_keeps_its_bounds(contour in contour(), x in -90.0..60.0_f64, y in -90.0..60.0_f64, side in 0.01..60.0_f64) {
        let tree = super::spec::Spec::Contour(contour.clone()).tree(Detail::default());
        let area = Area::of(&[[x, y], [x + side, y + side]]);
        keeps(&tree, &tree.bounds(&area), &area, 20);
        let bounds = tree.bounds(&Area::PLANE);
        keeps(&tree, &bounds, &tree.support(), 40);
        prop_assert!(bounds.slope < 100.0, "{bounds:?}");
        // Its own points lie on the curve.
        let at = contour.points()[2];
        let knots = &contour.profiles[2.min(contour.profiles.len() - 1)];
        let expected = orograph::construction::primitive::Profile::new(knots).expect("sound").at(1.0).0 + 3.0;
        let point = tree.at(at);
        prop_assert!(point.weight.value == 0.0 || (point.elevation.value - expected).abs() < 1e-6);
    }

    #[test]
    fn an_image_goes_through_its_samples(image in image()) {
        // Where there are no voids nearby, and no fade.
        let image = ImageSpec { fade: 0.0, weights: None, ..image };
        let (cols, rows) = (image.cols, image.heights_m.len() / image.cols);
        let tree = super::spec::Spec::Image(image.clone()).tree(Detail::default());
        let at = |u: f64, v: f64| match &image.mapping {
            MappingSpec::Box(a, b) => Some([a[0] + u * (b[0] - a[0]), b[1] + v * (a[1] - b[1])]),
            MappingSpec::Quadrangle([a, b, c, d]) => {
                let mix = |k: usize| (1.0 - v) * ((1.0 - u) * a[k] + u * b[k]) + v * ((1.0 - u) * d[k] + u * c[k]);
                Some([mix(0), mix(1)])
            }
            MappingSpec::Along(..) => None,
        };
        for (i, height) in image.heights_m.iter().enumerate() {
            let (u, v) = ((i % cols) as f64 / (cols - 1) as f64, (i / cols) as f64 / (rows - 1) as f64);
            // A little inside, for rounding at the edges.
            let Some(p) = at(u.clamp(1e-9, 1.0 - 1e-9), v.clamp(1e-9, 1.0 - 1e-9)) else { continue };
            let point = tree.at(p);
            if height.is_nan() {
                prop_assert!(point.weight.value < 1e-6, "a void has weight {}", point.weight.value);
            } else {
                prop_assert!((point.weight.value - 1.0).abs() < 1e-6, "weight {} at {p:?}", point.weight.value);
                prop_assert!((point.elevation.value - (1.5 * height - 2.0)).abs() < 1e-5);
            }
        }
    }
}

/// Control points of the parabolas.
fn controls(points: &[[f64; 3]], smooth: bool) -> Vec<[[f64; 2]; 3]> {
    let flat: Vec<[f64; 2]> = points.iter().map(|p| [p[0], p[1]]).collect();
    let mix = |p: [f64; 2], q: [f64; 2], t: f64| [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])];
    let length = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
    let last = flat.len() - 1;
    let tangent = |i: usize| {
        let (a, b) = (flat[i.max(1) - 1], flat[(i + 1).min(last)]);
        let mut scale = 1.0;
        if i > 0 && i < last {
            scale = (2.0 * length(a, flat[i]).min(length(flat[i], b)) / length(a, b)).min(1.0) / 2.0;
        }
        [(b[0] - a[0]) * scale, (b[1] - a[1]) * scale]
    };
    let mut found = vec![];
    for i in 0..last {
        let (p, q) = (flat[i], flat[i + 1]);
        if smooth {
            let (m, n) = (tangent(i), tangent(i + 1));
            let (c, d) = ([p[0] + m[0] / 4.0, p[1] + m[1] / 4.0], [q[0] - n[0] / 4.0, q[1] - n[1] / 4.0]);
            found.extend([[p, c, mix(c, d, 0.5)], [mix(c, d, 0.5), d, q]]);
        } else {
            found.push([p, mix(p, q, 0.5), q]);
        }
    }
    found
}

#[test]
fn a_gentle_curve_has_bounds_near_what_it_needs() {
    // A straight canal 40 m long that falls by 4 m, with banks of slope 1.
    let curve = super::spec::CurveSpec {
        points: vec![[0.0, 0.0, 4.0], [20.0, 0.0, 2.0], [40.0, 0.0, 0.0]],
        smooth: true,
        sections: vec![vec![(-4.0, 0.0), (-2.0, -2.0), (2.0, -2.0), (4.0, 0.0)]],
        fall_off: (4.0, 8.0),
    };
    let tree = super::spec::Spec::Curve(curve).tree(Detail::default());
    let middle = tree.bounds(&Area::of(&[[15.0, -1.0], [25.0, 1.0]]));
    assert!(middle.slope > 0.1 && middle.slope < 2.1, "{middle:?}");
    assert!(middle.elevation.max < 4.1 && middle.elevation.min > -2.1, "{middle:?}");
    // Two pixels on the bed, inside the plateau.
    let bed = tree.bounds(&Area::of(&[[19.0, 0.5], [20.0, 1.0]]));
    assert!(bed.slope < 0.11 && bed.weight.min == 1.0 && bed.weight_slope == 0.0, "{bed:?}");
}
