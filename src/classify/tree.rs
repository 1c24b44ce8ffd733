//! One tree of a forest: questions about features, and what those who answered alike were.

use super::samples::Samples;
use super::split::{Split, best_split};
use crate::error::{Error, ErrorKind, Result};
use crate::rng::Rng;
use serde::{Deserialize, Serialize};

/// A classification tree (CART).
///
/// Nodes lie in the order in which they are met when left sides are walked before right ones: the left side of a node
/// follows it at once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Tree {
    nodes: Vec<Node>,
}

/// A node of a tree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Node {
    /// A question.
    Split {
        /// The feature that is looked at.
        feature: u32,
        /// Where its value is at most this, the left side goes on, else the right one.
        threshold: f64,
        /// Number of the node that begins the right side.
        right: u32,
    },
    /// An end.
    Leaf {
        /// Samples of each class that came here when the tree grew.
        counts: Vec<u32>,
    },
}

/// Members that will make up one node.
struct Branch {
    start: usize,
    end: usize,
    /// The node whose right side it is.
    right_of: Option<usize>,
}

impl Tree {
    /// Grows a tree until every leaf is pure, or its samples cannot be told apart.
    ///
    /// A sample counts `weights[sample]` times. At each node all features are put in a random order, and the first
    /// `tried` of them in which the node's samples differ are tried; the purest split wins, the first of equals
    /// (Breiman 2001, doi:10.1023/A:1010933404324). Nothing is pruned.
    ///
    /// # Panics
    /// When no sample has a weight.
    pub fn grow(samples: &Samples, weights: &[u32], tried: usize, rng: &mut Rng) -> Self {
        #[allow(clippy::cast_possible_truncation, reason = "at most MOST_SAMPLES")]
        let mut members: Vec<u32> = (0..samples.len() as u32).filter(|&m| weights[m as usize] > 0).collect();
        assert!(!members.is_empty(), "a tree grows from at least one sample");
        let mut features: Vec<usize> = (0..samples.features()).collect();
        let mut nodes: Vec<Node> = vec![];
        let mut branches = vec![Branch { start: 0, end: members.len(), right_of: None }];
        while let Some(Branch { start, end, right_of }) = branches.pop() {
            let here = nodes.len();
            #[allow(clippy::cast_possible_truncation, reason = "fewer than two nodes a sample")]
            if let Some(Node::Split { right, .. }) = right_of.map(|parent| &mut nodes[parent]) {
                *right = here as u32;
            }
            let part = &mut members[start..end];
            let mut counts = vec![0_u32; samples.classes()];
            part.iter().for_each(|&m| counts[samples.label(m) as usize] += weights[m as usize]);
            let is_pure = counts.iter().filter(|&&count| count > 0).count() == 1;
            let split = if is_pure { None } else { purest(samples, weights, part, tried, &mut features, rng) };
            match split {
                None => nodes.push(Node::Leaf { counts }),
                Some(Split { feature, threshold, .. }) => {
                    part.sort_unstable_by_key(|&m| (samples.value(feature, m) > threshold, m));
                    let middle = start + part.partition_point(|&m| samples.value(feature, m) <= threshold);
                    #[allow(clippy::cast_possible_truncation, reason = "counted with 32 bits in files")]
                    nodes.push(Node::Split { feature: feature as u32, threshold, right: 0 });
                    branches.push(Branch { start: middle, end, right_of: Some(here) });
                    branches.push(Branch { start, end: middle, right_of: None });
                }
            }
        }
        Self { nodes }
    }

    /// The nodes, the root first.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The counts of the leaf that a row of features comes to.
    ///
    /// # Panics
    /// When the row has fewer features than the tree asks for, or the tree was not checked.
    pub fn leaf(&self, row: &[f64]) -> &[u32] {
        let mut at = 0;
        loop {
            match &self.nodes[at] {
                Node::Leaf { counts } => return counts,
                Node::Split { feature, threshold, right } => {
                    at = if row[*feature as usize] <= *threshold { at + 1 } else { *right as usize };
                }
            }
        }
    }

    /// Checks that the nodes make up one tree, each met exactly once from the root, and that it asks for features that
    /// there are and tells of as many classes as there are.
    ///
    /// # Errors
    /// `Corrupt`, with the node.
    pub fn check(&self, features: usize, classes: usize) -> Result<()> {
        let wrong = |node: usize, message: String| {
            Err(Error::new(ErrorKind::Corrupt, message).at_place(format!("node {node}")))
        };
        // Where the right sides begin that are still to come.
        let mut waiting: Vec<usize> = vec![];
        let mut is_whole = false;
        for (at, node) in self.nodes.iter().enumerate() {
            if is_whole {
                return wrong(at, "the tree ends before it: no way leads here".into());
            }
            match node {
                Node::Split { feature, threshold, right } => {
                    if *feature as usize >= features {
                        return wrong(at, format!("it asks for feature {feature}: there are {features}"));
                    }
                    if !threshold.is_finite() {
                        return wrong(at, format!("its threshold is {threshold}: expected a finite number"));
                    }
                    waiting.push(*right as usize);
                }
                Node::Leaf { counts } => {
                    if counts.len() != classes {
                        return wrong(at, format!("it counts {} classes: there are {classes}", counts.len()));
                    }
                    if counts.iter().all(|&count| count == 0) {
                        return wrong(at, "no sample came to this leaf".into());
                    }
                    match waiting.pop() {
                        None => is_whole = true,
                        Some(right) if right == at + 1 => {}
                        Some(right) => {
                            return wrong(at, format!("node {} must be a right side here, not node {right}", at + 1));
                        }
                    }
                }
            }
        }
        if is_whole { Ok(()) } else { wrong(self.nodes.len(), "the tree breaks off".into()) }
    }
}

/// The purest split by some features drawn at random.
fn purest(
    samples: &Samples,
    weights: &[u32],
    members: &[u32],
    tried: usize,
    features: &mut [usize],
    rng: &mut Rng,
) -> Option<Split> {
    features.sort_unstable();
    rng.shuffle(features);
    let splits = features.iter().filter_map(|&feature| best_split(samples, weights, members, feature));
    splits.take(tried).reduce(|best, split| if split.is_purer(&best) { split } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn leaf(counts: &[u32]) -> Node {
        Node::Leaf { counts: counts.to_vec() }
    }

    fn split(feature: u32, right: u32) -> Node {
        Node::Split { feature, threshold: 0.5, right }
    }

    #[test]
    fn a_tree_by_hand() {
        let rows = [(vec![0.0, 0.0], 0), (vec![0.0, 1.0], 1), (vec![1.0, 0.0], 1), (vec![1.0, 1.0], 0)];
        let samples = Samples::new(&rows, 2).unwrap();
        let tree = Tree::grow(&samples, &[1; 4], 2, &mut Rng::new(1));
        tree.check(2, 2).unwrap();
        assert_eq!(tree.nodes().len(), 7, "no single question helps, and yet two do");
        for (row, class) in &rows {
            assert_eq!(tree.leaf(row)[*class as usize], 1);
        }
        let twins = Samples::new(&[(vec![1.0], 0), (vec![1.0], 1)], 2).unwrap();
        assert_eq!(Tree::grow(&twins, &[2, 1], 1, &mut Rng::new(1)).nodes(), [leaf(&[2, 1])]);
    }

    #[test]
    fn damaged_trees_are_refused() {
        let good = vec![split(0, 2), leaf(&[1, 0]), split(1, 4), leaf(&[0, 1]), leaf(&[1, 1])];
        Tree { nodes: good.clone() }.check(2, 2).unwrap();
        let with = |at: usize, node: Node| {
            let mut nodes = good.clone();
            nodes[at] = node;
            nodes
        };
        let endless = Node::Split { feature: 0, threshold: f64::NAN, right: 2 };
        for (nodes, words) in [
            (vec![], "node 0: the tree breaks off"),
            (good[..4].to_vec(), "node 4: the tree breaks off"),
            ([&good[..], &[leaf(&[1, 0])]].concat(), "node 5: the tree ends before it"),
            (with(0, split(2, 2)), "node 0: it asks for feature 2: there are 2"),
            (with(0, split(0, 0)), "node 1: node 2 must be a right side here, not node 0"),
            (with(0, split(0, 4)), "node 1: node 2 must be a right side here, not node 4"),
            (with(2, split(0, u32::MAX)), "node 3: node 4 must be"),
            (with(0, endless), "node 0: its threshold is NaN"),
            (with(1, leaf(&[1])), "node 1: it counts 1 classes"),
            (with(1, leaf(&[0, 0])), "node 1: no sample"),
        ] {
            let error = Tree { nodes }.check(2, 2).unwrap_err();
            assert!(error.kind() == ErrorKind::Corrupt && error.to_string().contains(words), "{error}");
        }
    }
}
