//! Lines that cross, taken apart: snap rounding.
//!
//! A cell is **hot** if a line begins or ends there, or two lines cross within half a cell of its centre. Each line is
//! led through the centres of all hot cells that it passes. Thereby lines change by less than a cell, none of them cross
//! except in such centres, and none change sides (Hobby 1999, doi:10.1016/S0925-7721(99)00021-8). Everything is
//! reckoned in whole numbers.

use std::collections::{BTreeMap, BTreeSet};

/// Column and row.
type Place = [i64; 2];

/// Parts of lines between cells, none of which cross: each as (lesser, greater), sorted, none twice.
///
/// Coordinates are at most 2^20.
pub(super) fn taken_apart(lines: &[[Place; 2]]) -> Vec<[Place; 2]> {
    let mut hot: BTreeMap<i64, BTreeSet<i64>> = BTreeMap::new();
    let mut heat = |[x, y]: Place| hot.entry(y).or_default().insert(x);
    for line in lines {
        heat(line[0]);
        heat(line[1]);
    }
    each_crossing(lines, |place| {
        heat(place);
    });
    let mut parts: Vec<[Place; 2]> = Vec::new();
    for &line in lines.iter().filter(|line| line[0] != line[1]) {
        let through = passed(line, &hot);
        parts.extend(through.windows(2).map(|pair| [pair[0].min(pair[1]), pair[0].max(pair[1])]));
    }
    parts.sort_unstable();
    parts.dedup();
    parts
}

/// Twice the signed area of a triangle.
fn area2(a: Place, b: Place, c: Place) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
}

/// Calls `each` with the cell of every point where the insides of two lines cross.
fn each_crossing(lines: &[[Place; 2]], mut each: impl FnMut(Place)) {
    let low = |line: &[Place; 2], i: usize| line[0][i].min(line[1][i]);
    let high = |line: &[Place; 2], i: usize| line[0][i].max(line[1][i]);
    let mut order: Vec<&[Place; 2]> = lines.iter().collect();
    order.sort_unstable_by_key(|line| (low(line, 1), **line));
    let mut active: Vec<&[Place; 2]> = Vec::new();
    for line in order {
        let begin = low(line, 1);
        active.retain(|other| high(other, 1) >= begin);
        for &other in &active {
            if high(other, 0) >= low(line, 0)
                && low(other, 0) <= high(line, 0)
                && let Some(place) = crossing(*line, *other)
            {
                each(place);
            }
        }
        active.push(line);
    }
}

/// The cell around the point where the insides of two lines cross; left and upper borders belong to a cell.
fn crossing([a, b]: [Place; 2], [c, d]: [Place; 2]) -> Option<Place> {
    let (from, to) = (area2(c, d, a), area2(c, d, b));
    let apart = area2(a, b, c).signum() * area2(a, b, d).signum() < 0 && from.signum() * to.signum() < 0;
    if !apart {
        return None;
    }
    // The share from / (from - to) of the way from a to b.
    let (num, den) = (i128::from(from), i128::from(from - to));
    let (num, den) = if den < 0 { (-num, -den) } else { (num, den) };
    let at = |i: usize| {
        let twice = 2 * (i128::from(a[i]) * den + i128::from(b[i] - a[i]) * num) + den;
        i64::try_from(twice.div_euclid(2 * den)).expect("between the ends")
    };
    Some([at(0), at(1)])
}

/// The hot cells that a line passes, from its beginning to its end.
fn passed(line: [Place; 2], hot: &BTreeMap<i64, BTreeSet<i64>>) -> Vec<Place> {
    let [a, b] = line;
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    let mut found: Vec<Place> = Vec::new();
    for (&y, cols) in hot.range(a[1].min(b[1])..=a[1].max(b[1])) {
        // The columns between the line's crossings of the row's borders, and one more on either side.
        let (low, high) = if dy == 0 {
            (a[0].min(b[0]), a[0].max(b[0]))
        } else {
            let at = |twice_y: i64| a[0] + (dx * (twice_y - 2 * a[1])).div_euclid(2 * dy);
            let (p, q) = (at(2 * y - 1), at(2 * y + 1));
            (p.min(q) - 1, p.max(q) + 2)
        };
        found.extend(cols.range(low..=high).map(|&x| [x, y]).filter(|&cell| passes(line, cell)));
    }
    found.sort_by_key(|cell| (cell[0] - a[0]) * dx + (cell[1] - a[1]) * dy);
    found
}

/// Whether a line passes a cell: its inside, or the corner at its upper left.
fn passes([a, b]: [Place; 2], cell: Place) -> bool {
    // Twice as fine, corners are whole numbers, and odd ones.
    let [a, b, [x, y]] = [a, b, cell].map(|place| place.map(|v| 2 * v));
    let overlaps = |i: usize, v: i64| a[i].min(b[i]) < v + 1 && v - 1 < a[i].max(b[i]);
    let sides = [[x - 1, y - 1], [x + 1, y - 1], [x + 1, y + 1], [x - 1, y + 1]].map(|corner| area2(a, b, corner));
    let inside = sides.iter().any(|&side| side > 0) && sides.iter().any(|&side| side < 0);
    let within = |i: usize, v: i64| a[i].min(b[i]) <= v && v <= a[i].max(b[i]);
    inside && overlaps(0, x) && overlaps(1, y) || sides[0] == 0 && within(0, x - 1) && within(1, y - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_cross_meets_in_a_cell() {
        let lines = [[[0, 0], [5, 4]], [[0, 4], [5, 0]]];
        // At 2.5, 2: the cell on its right has its left border.
        assert_eq!(taken_apart(&lines), [[[0, 0], [3, 2]], [[0, 4], [3, 2]], [[3, 2], [5, 0]], [[3, 2], [5, 4]]]);
        assert_eq!(taken_apart(&[[[1, 1], [1, 1]]]), Vec::<[Place; 2]>::new(), "a point is no line");
    }

    #[test]
    fn what_touches_is_parted_there() {
        let lines = [[[0, 0], [6, 0]], [[3, 0], [3, 4]], [[2, 0], [8, 0]]];
        assert_eq!(
            taken_apart(&lines),
            [[[0, 0], [2, 0]], [[2, 0], [3, 0]], [[3, 0], [3, 4]], [[3, 0], [6, 0]], [[6, 0], [8, 0]]]
        );
    }

    fn place() -> impl Strategy<Value = Place> {
        [0..24_i64, 0..24_i64]
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(1000) })]

        #[test]
        fn nothing_crosses_afterwards(lines in prop::collection::vec([place(), place()], 1..14)) {
            let parts = taken_apart(&lines);
            for (i, &p) in parts.iter().enumerate() {
                for &q in &parts[..i] {
                    prop_assert_eq!(crossing(p, q), None, "{:?} and {:?}", p, q);
                }
            }
            // Every line is still there: its ends are joined by parts near it.
            for [a, b] in lines {
                let near = |p: Place| {
                    let (dx, dy) = ((b[0] - a[0]) as f64, (b[1] - a[1]) as f64);
                    let length2 = dx * dx + dy * dy;
                    let (px, py) = ((p[0] - a[0]) as f64, (p[1] - a[1]) as f64);
                    let t = if length2 > 0.0 { ((px * dx + py * dy) / length2).clamp(0.0, 1.0) } else { 0.0 };
                    (px - t * dx).hypot(py - t * dy) < 0.7072
                };
                let mut reached = BTreeSet::from([a]);
                loop {
                    let before = reached.len();
                    for &[p, q] in parts.iter().filter(|part| near(part[0]) && near(part[1])) {
                        if reached.contains(&p) || reached.contains(&q) {
                            reached.extend([p, q]);
                        }
                    }
                    if reached.len() == before {
                        break;
                    }
                }
                prop_assert!(reached.contains(&b), "{:?} to {:?} in {:?}", a, b, parts);
            }
        }
    }
}
