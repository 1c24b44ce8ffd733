//! Which lines of a divide tree carry the others: what is left of them when only prominent peaks count.

use std::collections::HashMap;

/// A line of a divide tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edge {
    /// The peaks at its ends.
    pub(super) peaks: [i64; 2],
    /// The peak that ends at its saddle.
    pub(super) ended: i64,
    /// That peak's prominence in metres.
    pub(super) prominence_m: f64,
}

/// For each line the greatest prominence in metres among the peaks that it joins to the root of their tree.
///
/// The lines with at least so much are the divide tree of the peaks with at least so much prominence, so a map that
/// draws them in this order is a generalisation of the whole at every step. O(n) for n lines.
pub(super) fn carried_m(edges: &[Edge]) -> Vec<f64> {
    let mut lines: HashMap<i64, Vec<usize>> = HashMap::new();
    // Roots end nowhere, and never become leaves.
    let mut most: HashMap<i64, f64> = HashMap::new();
    for (i, edge) in edges.iter().enumerate() {
        for peak in edge.peaks {
            lines.entry(peak).or_default().push(i);
        }
        most.insert(edge.ended, edge.prominence_m);
    }
    let mut carried: Vec<f64> = edges.iter().map(|edge| edge.prominence_m).collect();
    let mut left: HashMap<i64, usize> = lines.iter().map(|(&peak, lines)| (peak, lines.len())).collect();
    let mut leaves: Vec<i64> = left.iter().filter(|(_, n)| **n == 1).map(|(&peak, _)| peak).collect();
    let mut is_done = vec![false; edges.len()];
    while let Some(leaf) = leaves.pop() {
        let Some(&own_m) = most.get(&leaf) else { continue };
        let Some(&line) = lines[&leaf].iter().find(|&&line| !is_done[line]) else { continue };
        is_done[line] = true;
        carried[line] = carried[line].max(own_m);
        let [a, b] = edges[line].peaks;
        let next = if a == leaf { b } else { a };
        if let Some(most_m) = most.get_mut(&next) {
            *most_m = most_m.max(own_m);
        }
        let left = left.get_mut(&next).expect("every peak of a line has a count");
        *left -= 1;
        if *left == 1 {
            leaves.push(next);
        }
    }
    carried
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edge(a: i64, b: i64, ended: i64, prominence_m: f64) -> Edge {
        Edge { peaks: [a, b], ended, prominence_m }
    }

    #[test]
    fn lines_carry_the_greatest_peak_beyond_them() {
        // 1 is the root: 1 - 4 - 2 - 5, and 3 hangs on 4. The saddle of 2, the second in prominence, lies next to 1.
        let edges = [edge(1, 4, 2, 500.0), edge(4, 2, 4, 40.0), edge(2, 5, 5, 30.0), edge(3, 4, 3, 100.0)];
        assert_eq!(carried_m(&edges), [500.0, 500.0, 30.0, 100.0]);
    }

    #[test]
    fn lines_above_a_threshold_hang_together() {
        let edges: Vec<Edge> =
            (2..200_i64).map(|i| edge(i, 1 + (i * 7919) % (i - 1), i, ((i * 104_729) % 997) as f64)).collect();
        let carried = carried_m(&edges);
        for threshold in [100.0, 500.0, 900.0] {
            let kept: Vec<&Edge> =
                edges.iter().zip(&carried).filter(|(_, c)| **c >= threshold).map(|(e, _)| e).collect();
            let mut reached = std::collections::HashSet::from([1]);
            for _ in 0..edges.len() {
                for edge in &kept {
                    if edge.peaks.iter().any(|peak| reached.contains(peak)) {
                        reached.extend(edge.peaks);
                    }
                }
            }
            assert!(kept.iter().all(|edge| reached.contains(&edge.peaks[0])), "{threshold}");
            assert!(edges.iter().all(|edge| edge.prominence_m < threshold || reached.contains(&edge.ended)));
        }
    }

    #[test]
    fn what_is_no_tree_does_no_harm() {
        assert!(carried_m(&[]).is_empty());
        // A ring, a tree without a root, a line to itself.
        let edges =
            [edge(1, 2, 1, 5.0), edge(2, 3, 2, 6.0), edge(3, 1, 3, 7.0), edge(8, 9, 8, 1.0), edge(7, 7, 7, 2.0)];
        assert_eq!(carried_m(&edges), [5.0, 6.0, 7.0, 1.0, 2.0]);
    }
}
