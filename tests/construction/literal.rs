//! The formulas as the documentation has them, value by value: no gradients, no boxes, no order of evaluation.

use super::spec::{DUNES, Spec, WarpSpec, rules};
use orograph::construction::primitive::Primitive;
use orograph::construction::{Builder, Detail, Place, WeightRule};

/// Elevation and weight.
pub type Pair = (f64, f64);

fn joined(rule: WeightRule, beta: f64, a: Pair, replaces: bool, b: Pair) -> f64 {
    match (rule, replaces) {
        (WeightRule::Keep, _) => a.1,
        (WeightRule::Join, true) => (1.0 - beta) * a.1 + beta * beta,
        (WeightRule::Join, false) => a.1 + b.1 * b.1,
    }
}

fn ramp((from, to): (f64, f64), value: f64) -> f64 {
    let t = ((value - from) / (to - from)).clamp(0.0, 1.0);
    3.0 * t * t - 2.0 * t * t * t
}

/// What a node is at a place, whose level of detail is given; the elevation is of no meaning where the weight is 0.
pub fn value(spec: &Spec, place: &Place) -> Pair {
    let at = |spec: &Spec| value(spec, place);
    match spec {
        Spec::Disc(disc) => {
            let point = disc.make().at(place);
            (point.elevation.value, point.weight.value)
        }
        Spec::Curve(curve) => {
            let point = curve.make().at(place);
            (point.elevation.value, point.weight.value)
        }
        Spec::Image(image) => {
            let point = image.make().at(place);
            (point.elevation.value, point.weight.value)
        }
        Spec::Contour(contour) => {
            let point = contour.make().at(place);
            (point.elevation.value, point.weight.value)
        }
        Spec::Blend(children) => {
            let children: Vec<Pair> = children.iter().map(at).collect();
            let weight: f64 = children.iter().map(|c| c.1).sum();
            if weight == 0.0 { (0.0, 0.0) } else { (children.iter().map(|c| c.0 * c.1).sum::<f64>() / weight, weight) }
        }
        Spec::Replace(rule, a, b) => {
            let (a, b) = (at(a), at(b));
            let beta = b.1.clamp(0.0, 1.0);
            let f = if a.1 > 0.0 { (1.0 - beta) * a.0 + beta * b.0 } else { b.0 };
            (f, joined(*rule, beta, a, true, b))
        }
        Spec::Add(rule, a, b) => {
            let (a, b) = (at(a), at(b));
            let f = if a.1 > 0.0 { a.0 } else { 0.0 };
            (f + b.1 * b.0, joined(*rule, 0.0, a, false, b))
        }
        Spec::Warp(warp, child) => warped(warp, child, place),
        Spec::Level(from, to, a, b) => {
            let t = ((place.kappa.value - from) / (to - from)).clamp(0.0, 1.0);
            let (a, b) = (at(a), at(b));
            let weight = (1.0 - t) * a.1 + t * b.1;
            let f = match (a.1 > 0.0, b.1 > 0.0) {
                (true, true) => (1.0 - t) * a.0 + t * b.0,
                (true, false) => a.0,
                _ => b.0,
            };
            (f, weight)
        }
        Spec::Weigh(elevation, slope, child, guide) => {
            let (child, base) = (at(child), at(guide));
            if base.1 <= 0.0 {
                return (0.0, 0.0);
            }
            let mut share = elevation.map_or(1.0, |ends| ramp(ends, base.0));
            if let Some(ends) = slope {
                // The guide's exact slope is the tree's own.
                let mut builder = Builder::new();
                let id = guide.add(&mut builder);
                let tree = builder.finish(id, Detail::Constant(place.kappa.value)).expect("sound");
                let point = tree.at(place.at);
                share *= ramp(*ends, point.elevation.dx.hypot(point.elevation.dy));
            }
            let _ = rules(*elevation, *slope);
            (child.0, child.1 * share)
        }
        Spec::Dunes(mountain, dunes) => {
            let (mountain, dunes) = (at(mountain), at(dunes));
            let share = if mountain.1 > 0.0 { ramp(DUNES, mountain.0) } else { 0.0 };
            (mountain.0 + dunes.1 * share * dunes.0, mountain.1)
        }
    }
}

fn warped(warp: &WarpSpec, child: &Spec, place: &Place) -> Pair {
    let [x, y] = place.at;
    let offset = |centre: [f64; 2]| (x - centre[0], y - centre[1]);
    let fall = |centre: [f64; 2], radius: f64| {
        let (dx, dy) = offset(centre);
        let s = (dx * dx + dy * dy) / (radius * radius);
        if s < 1.0 { (1.0 - s) * (1.0 - s) * (1.0 - s) } else { 0.0 }
    };
    let turned = |(dx, dy): (f64, f64), radians: f64| {
        let (s, c) = radians.sin_cos();
        (c * dx + s * dy, c * dy - s * dx)
    };
    match *warp {
        WarpSpec::Affine { scale, degrees, shift, z_scale, z_shift_m } => {
            let (u, v) = turned(offset(shift), degrees.to_radians());
            let (f, w) = value(child, &Place { at: [u / scale[0], v / scale[1]], ..*place });
            (f * z_scale + z_shift_m, w)
        }
        WarpSpec::Noise(_) => {
            // The displacement is what a warped plane z = x, and one z = y, show.
            unreachable!("noise has no other definition than the library's")
        }
        WarpSpec::Drag { centre, by, radius_m } => {
            let g = fall(centre, radius_m);
            value(child, &Place { at: [x - by[0] * g, y - by[1] * g], ..*place })
        }
        WarpSpec::Twist { centre, degrees, radius_m } => {
            let half = (degrees.to_radians() / 2.0).tan() * fall(centre, radius_m);
            let (dx, dy) = turned(offset(centre), 2.0 * half.atan());
            value(child, &Place { at: [centre[0] + dx, centre[1] + dy], ..*place })
        }
    }
}
