//! From the passes of one tile to the joins that are certain already and those that the whole raster must decide.
//!
//! Kruskal's sweep over the passes of a tile, from above to below, joins its basins. A basin with a cell on the
//! tile's ring may meet others elsewhere and is **open**, and so is every component that holds one. A component that
//! is not open has shown all its passes: where its top is the lower one, it ends for good, a **join** of the final
//! divide tree. All other joins of the tile are **candidates**. A pass between basins that the tile has joined
//! already can be no edge of the divide tree of the whole, as the sweep of any larger graph would close a cycle too:
//! a candidate list is the tile's share of a minimum spanning forest (the filter of Borůvka and Kruskal variants).

use super::tile::{NO_NODE, Node, Pass, Scan};
use crate::components::root;
use crate::grid::neighbours::is_above;
use crate::grid::{Cell, Key};

/// A join that is certain: where the component of a peak ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalJoin {
    /// The peak that ends.
    pub(super) ended: Node,
    /// The top, so far as the tile knows, of the component that it joins.
    pub(super) into: Node,
    /// The saddle.
    pub(super) saddle: Cell,
    /// The basin on the ended component's side.
    pub(super) near: Node,
    /// The basin on the other side.
    pub(super) far: Node,
    /// Number of the pass at its saddle.
    pub(super) nth: u8,
    /// Whether `near` is the basin of the saddle's topmost neighbour.
    pub(super) near_is_a: bool,
}

/// The joins of one tile.
#[derive(Debug, Default)]
pub(super) struct TileForest<K> {
    /// Joins that are certain, each with the key of its saddle.
    pub(super) joins: Vec<(K, LocalJoin)>,
    /// The passes that the whole raster must decide, in the order of the sweep.
    pub(super) candidates: Vec<(K, Pass)>,
}

/// Sweeps the passes of one tile.
pub(super) fn sweep_tile<K: Key>(scan: &Scan<K>) -> TileForest<K> {
    let nodes = scan.cells.len();
    let mut open = vec![false; nodes];
    open[scan.peaks..].fill(true);
    for &node in scan.ring.iter().filter(|&&node| node != NO_NODE) {
        open[node as usize] = true;
    }
    // A basin beside a void takes part in the certificates, which look at the whole.
    for &(node, _) in &scan.frontier {
        open[node as usize] = true;
    }
    let mut parent: Vec<Node> = (0..nodes as Node).collect();
    let mut forest = TileForest { joins: Vec::with_capacity(scan.peaks), candidates: Vec::new() };
    for &(key, pass) in &scan.passes {
        let (top_a, top_b) = (root(&mut parent, pass.a), root(&mut parent, pass.b));
        if top_a == top_b {
            continue;
        }
        let order = |node: Node| (scan.keys[node as usize], scan.cells[node as usize]);
        let near_is_a = is_above(order(top_b), order(top_a));
        let (low, high) = if near_is_a { (top_a, top_b) } else { (top_b, top_a) };
        if open[low as usize] {
            open[high as usize] = true;
            forest.candidates.push((key, pass));
        } else {
            let (near, far) = if near_is_a { (pass.a, pass.b) } else { (pass.b, pass.a) };
            let join = LocalJoin { ended: low, into: high, saddle: pass.saddle, near, far, nth: pass.nth, near_is_a };
            forest.joins.push((key, join));
        }
        parent[low as usize] = high;
    }
    // Many tiles wait for each other with what they found.
    forest.joins.shrink_to_fit();
    forest.candidates.shrink_to_fit();
    forest
}
