//! Lines laid upon ground: their elevations, and what becomes of parts that lie beside it.

use super::sources::Line;
use crate::construction::tree::Tree;

/// Halvings of a segment until its part on the ground is known.
const HALVINGS: usize = 40;

/// A line upon the ground.
pub(super) struct Laid {
    /// Its parts that lie on the ground, with elevations.
    pub(super) parts: Vec<Line>,
    /// Points that lie beside the ground.
    pub(super) beside: usize,
}

/// Lays a line upon the ground: elevations at its points are the ground's. What lies beside it is cut away, at the
/// ground's edge, which is found by halving; a hole between two points on the ground is not noticed.
pub(super) fn lay(line: &Line, ground: &Tree) -> Laid {
    let mut laid = Laid { parts: vec![], beside: 0 };
    let mut open: Vec<[f64; 3]> = vec![];
    let mut close = |open: &mut Vec<[f64; 3]>| {
        let points = std::mem::take(open);
        if points.len() > 1 {
            laid.parts.push(Line { points, fields: line.fields.clone() });
        }
    };
    let mut before: Option<([f64; 2], bool)> = None;
    for &[x, y, _] in &line.points {
        let under = ground.elevation_m([x, y]);
        match (before, under) {
            (Some((from, false)), Some(_)) => open.extend(edge(ground, [x, y], from)),
            (Some((from, true)), None) => {
                let last = edge(ground, from, [x, y]);
                open.extend(last.filter(|last| open.last() != Some(last)));
                close(&mut open);
            }
            _ => {}
        }
        match under {
            Some(z) if open.last().is_none_or(|last| last[..2] != [x, y]) => open.push([x, y, z]),
            Some(_) => {}
            None => laid.beside += 1,
        }
        before = Some(([x, y], under.is_some()));
    }
    close(&mut open);
    laid
}

/// The last point on the ground on the way from one on it to one beside it.
fn edge(ground: &Tree, on: [f64; 2], beside: [f64; 2]) -> Option<[f64; 3]> {
    let at = |t: f64| [on[0] + t * (beside[0] - on[0]), on[1] + t * (beside[1] - on[1])];
    let (mut low, mut high) = (0.0, 1.0);
    let mut found = None;
    for _ in 0..HALVINGS {
        let t = (low + high) / 2.0;
        let [x, y] = at(t);
        match ground.elevation_m([x, y]) {
            Some(z) => {
                low = t;
                found = Some([x, y, z]);
            }
            None => high = t,
        }
    }
    // A point that is next to nothing away from the one on the ground would only make a kink.
    found.filter(|_| low > 1e-3)
}

/// Evens elevations along a line: means weighted by `1 - d / within_m` of the distance d along it.
pub(super) fn even(points: &mut [[f64; 3]], within_m: f64) {
    let mut along = Vec::with_capacity(points.len());
    let mut length = 0.0;
    for (i, p) in points.iter().enumerate() {
        if i > 0 {
            let (dx, dy) = (p[0] - points[i - 1][0], p[1] - points[i - 1][1]);
            length += (dx * dx + dy * dy).sqrt();
        }
        along.push(length);
    }
    let before: Vec<f64> = points.iter().map(|p| p[2]).collect();
    for (i, point) in points.iter_mut().enumerate() {
        let from = along.partition_point(|&s| s <= along[i] - within_m);
        let (mut sum, mut weights) = (0.0, 0.0);
        for j in from..along.len() {
            let weight = 1.0 - (along[j] - along[i]).abs() / within_m;
            if j > i && weight <= 0.0 {
                break;
            }
            sum += weight * before[j];
            weights += weight;
        }
        point[2] = sum / weights;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::construction::primitive::{Disc, FallOff};
    use crate::construction::{Builder, Detail};

    /// Level ground of 7 m whose weight is at least a half up to about 45 m from the origin.
    fn ground() -> Tree {
        let mut builder = Builder::new();
        let disc = Disc::new([0.0; 2], 7.0, None, Some(FallOff::new(0.0, 100.0).expect("sound"))).expect("sound");
        let root = builder.leaf(disc).expect("a leaf");
        builder.finish(root, Detail::default()).expect("its own root")
    }

    fn line(xs: &[f64]) -> Line {
        let points = xs.iter().map(|&x| [x, 0.0, f64::NAN]).collect();
        Line { points, fields: [("width".to_string(), 3.0)].into() }
    }

    #[test]
    fn what_lies_beside_is_cut_away_at_the_edge() {
        let ground = ground();
        let edge = (1.0 - 0.5_f64.cbrt()).sqrt() * 100.0;
        let laid = lay(&line(&[-80.0, -10.0, 10.0, 90.0, 95.0, 0.0]), &ground);
        assert_eq!((laid.parts.len(), laid.beside), (2, 3));
        let ends: Vec<[f64; 2]> =
            laid.parts.iter().map(|part| [part.points[0][0], part.points[part.points.len() - 1][0]]).collect();
        for (found, expected) in ends.iter().flatten().zip([-edge, edge, edge, 0.0]) {
            assert!((found - expected).abs() < 1e-6, "{found} for {expected}");
        }
        assert!(laid.parts.iter().flat_map(|part| &part.points).all(|point| point[2] == 7.0));
        assert_eq!(laid.parts[1].fields["width"], 3.0);
        assert!(lay(&line(&[200.0, 300.0]), &ground).parts.is_empty());
        assert_eq!(lay(&line(&[0.0, 10.0]), &ground).parts[0].points, [[0.0, 0.0, 7.0], [10.0, 0.0, 7.0]]);
    }

    #[test]
    fn evened_elevations_are_means_within_reach() {
        let mut points: Vec<[f64; 3]> = (0..20).map(|i| [f64::from(i * i), 0.0, f64::from(i % 3)]).collect();
        let before = points.clone();
        even(&mut points, 30.0);
        for (i, point) in points.iter().enumerate() {
            let (mut sum, mut weights) = (0.0, 0.0);
            for other in &before {
                let weight = (1.0 - (other[0] - before[i][0]).abs() / 30.0).max(0.0);
                sum += weight * other[2];
                weights += weight;
            }
            assert!((point[2] - sum / weights).abs() < 1e-12, "point {i}");
        }
        // A slope stays one, but for its ends.
        let mut slope: Vec<[f64; 3]> = (0..30).map(|i| [f64::from(i), 0.0, 2.0 * f64::from(i)]).collect();
        even(&mut slope, 4.5);
        assert!((5..25).all(|i| (slope[i][2] - 2.0 * i as f64).abs() < 1e-12));
    }
}
