//! A classification tree as a textbook has it: every threshold is tried by counting both sides anew.

use orograph::classify::{Node, Samples};
use orograph::rng::Rng;

/// The nodes of a tree, left sides before right ones.
pub(crate) fn grow(samples: &Samples, weights: &[u32], tried: usize, rng: &mut Rng) -> Vec<Node> {
    let mut nodes = vec![];
    let members: Vec<u32> = (0..samples.len() as u32).filter(|&m| weights[m as usize] > 0).collect();
    node(samples, weights, &members, tried, rng, &mut nodes);
    nodes
}

fn node(samples: &Samples, weights: &[u32], members: &[u32], tried: usize, rng: &mut Rng, nodes: &mut Vec<Node>) {
    let counts = counted(samples, weights, members);
    let here = nodes.len();
    let split = if impurity(&counts).0 == 0 { None } else { best(samples, weights, members, tried, rng) };
    let Some((feature, threshold)) = split else {
        nodes.push(Node::Leaf { counts });
        return;
    };
    nodes.push(Node::Split { feature: feature as u32, threshold, right: 0 });
    let [left, right] = sides(samples, members, feature, threshold);
    node(samples, weights, &left, tried, rng, nodes);
    let begin = nodes.len() as u32;
    node(samples, weights, &right, tried, rng, nodes);
    nodes[here] = Node::Split { feature: feature as u32, threshold, right: begin };
}

/// The split that leaves the least impurity: the first of equals among features in the order drawn, then thresholds in
/// rising order.
fn best(samples: &Samples, weights: &[u32], members: &[u32], tried: usize, rng: &mut Rng) -> Option<(usize, f64)> {
    let mut features: Vec<usize> = (0..samples.features()).collect();
    rng.shuffle(&mut features);
    let differs = |&feature: &usize| thresholds(samples, members, feature).len() > 1;
    let mut best: Option<((i128, i128), usize, f64)> = None;
    for feature in features.into_iter().filter(differs).take(tried) {
        let values = thresholds(samples, members, feature);
        for pair in values.windows(2) {
            let threshold = pair[0] / 2.0 + pair[1] / 2.0;
            let [left, right] = sides(samples, members, feature, threshold);
            let [l, r] = [left, right].map(|side| impurity(&counted(samples, weights, &side)));
            let left_over = (l.0 * r.1 + r.0 * l.1, l.1 * r.1);
            // a / b < c / d
            if best.is_none_or(|(least, ..)| left_over.0 * least.1 < least.0 * left_over.1) {
                best = Some((left_over, feature, threshold));
            }
        }
    }
    best.map(|(_, feature, threshold)| (feature, threshold))
}

/// The different values of a feature in rising order.
fn thresholds(samples: &Samples, members: &[u32], feature: usize) -> Vec<f64> {
    let mut values: Vec<f64> = members.iter().map(|&m| samples.value(feature, m)).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

fn sides(samples: &Samples, members: &[u32], feature: usize, threshold: f64) -> [Vec<u32>; 2] {
    let is_left = |&&m: &&u32| samples.value(feature, m) <= threshold;
    [members.iter().filter(is_left).copied().collect(), members.iter().filter(|m| !is_left(m)).copied().collect()]
}

fn counted(samples: &Samples, weights: &[u32], members: &[u32]) -> Vec<u32> {
    let of = |class: u32| members.iter().filter(move |&&m| samples.label(m) == class).map(|&m| weights[m as usize]);
    (0..samples.classes() as u32).map(|class| of(class).sum()).collect()
}

/// `n` times the Gini impurity `1 - sum (n_c / n)²`, as a fraction.
fn impurity(counts: &[u32]) -> (i128, i128) {
    let n: i128 = counts.iter().map(|&count| i128::from(count)).sum();
    let squares: i128 = counts.iter().map(|&count| i128::from(count) * i128::from(count)).sum();
    (n * n - squares, n)
}
