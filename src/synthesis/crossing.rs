//! Whether lines between cells cross, in whole numbers.

/// Twice the row, twice the column.
pub(super) type Point = [i64; 2];
/// A straight line between two points.
pub(super) type Line = [Point; 2];

/// Twice the signed area of a triangle.
fn area2(a: Point, b: Point, c: Point) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
}

/// Whether two lines have more in common than an end of both.
pub(super) fn cross([a, b]: Line, [c, d]: Line) -> bool {
    let is_apart = |k: usize| a[k].max(b[k]) < c[k].min(d[k]) || c[k].max(d[k]) < a[k].min(b[k]);
    if is_apart(0) || is_apart(1) {
        return false;
    }
    let sides = [area2(a, b, c), area2(a, b, d), area2(c, d, a), area2(c, d, b)].map(i64::signum);
    if sides == [0; 4] {
        // On one line: it is only an end where they lie on both sides of it.
        let along = |p: Point| (p[0], p[1]);
        let (first, last) = (along(a.min(b)).max(along(c.min(d))), along(a.max(b)).min(along(c.max(d))));
        return first < last || (first == last && ![a, b].iter().any(|end| [c, d].contains(end)));
    }
    if [a, b].iter().any(|end| [c, d].contains(end)) {
        return false;
    }
    sides[0] * sides[1] <= 0 && sides[2] * sides[3] <= 0
}

/// Whether a point lies in the triangle of `a`, `b` and the centroid of `a`, `b`, `c`: inside, or between `a` and `b`.
pub(super) fn is_beside(point: Point, a: Point, b: Point, c: Point) -> bool {
    let centroid = [0, 1].map(|k| a[k] + b[k] + c[k]);
    let [point, a, b] = [point, a, b].map(|at| at.map(|at| 3 * at));
    let turn = area2(a, b, centroid).signum();
    let [on, first, last] = [area2(a, b, point), area2(b, centroid, point), area2(centroid, a, point)];
    turn != 0 && on * turn >= 0 && first * turn > 0 && last * turn > 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Lines that have a point in common other than an end of both, looked for at all points that it could be.
        #[test]
        fn as_looking_at_points(at in prop::array::uniform8(0..5_i64)) {
            let [a, b, c, d] = [0, 2, 4, 6].map(|i| [at[i], at[i + 1]]);
            prop_assume!(a != b && c != d);
            // Where lines of so few cells meet is a fraction of an area; lines that lie on each other have halves in common.
            let area = ((b[0] - a[0]) * (d[1] - c[1]) - (b[1] - a[1]) * (d[0] - c[0])).abs().max(2);
            let fine = |p: Point| p.map(|v| v * area);
            let on = |p: Point, from: Point, to: Point| {
                let within = (0..2).all(|k| p[k] >= from[k].min(to[k]) && p[k] <= from[k].max(to[k]));
                within && area2(from, to, p) == 0
            };
            let lines = [a, b, c, d].map(fine);
            let common = (0..=4 * area).flat_map(|row| (0..=4 * area).map(move |col| [row, col]));
            let is_end = |p: Point| (p == lines[0] || p == lines[1]) && (p == lines[2] || p == lines[3]);
            let slow = common.filter(|&p| on(p, lines[0], lines[1]) && on(p, lines[2], lines[3])).any(|p| !is_end(p));
            prop_assert_eq!(cross([a, b], [c, d]), slow);
        }
    }

    #[test]
    fn beside_a_line() {
        let [a, b, c] = [[0, 0], [0, 12], [12, 0]];
        assert!(is_beside([0, 6], a, b, c) && is_beside([2, 4], a, b, c) && is_beside([2, 4], b, a, c));
        for out in [[0, 0], [0, 12], [0, 13], [-1, 6], [4, 4], [5, 3], [2, 2]] {
            assert!(!is_beside(out, a, b, c), "{out:?}");
        }
        assert!(!is_beside([0, 6], a, b, [0, 20]), "no triangle");
    }
}
