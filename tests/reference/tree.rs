//! The divide tree, pruned.

use super::sweep::{Join, Raster, Sweep};
use orograph::grid::Cell;
use std::collections::{BTreeMap, VecDeque};

/// Edges at each peak: (the peak at the other end, the join).
type Edges<'a> = BTreeMap<Cell, Vec<(Cell, &'a Join)>>;

/// The divide tree with its contracted edges apart.
pub struct Tree<'a> {
    /// The peak that names each peak's group.
    group: BTreeMap<Cell, Cell>,
    kept: Vec<&'a Join>,
    /// Contracted edges, between peaks.
    inside: Edges<'a>,
    /// The other edges, between the peaks that name groups.
    between: Edges<'a>,
}

fn add<'a>(edges: &mut Edges<'a>, a: Cell, b: Cell, join: &'a Join) {
    edges.entry(a).or_default().push((b, join));
    edges.entry(b).or_default().push((a, join));
}

/// Contracts the edges that `contracted` names.
pub fn prune<'a>(raster: &Raster, sweep: &'a Sweep, contracted: impl Fn(&Join) -> bool) -> Tree<'a> {
    let (mut inside, mut between) = (Edges::new(), Edges::new());
    let (gone, kept): (Vec<&Join>, Vec<&Join>) = sweep.joins.iter().partition(|join| contracted(join));
    for join in gone {
        add(&mut inside, join.a, join.b, join);
    }
    let mut group: BTreeMap<Cell, Cell> = BTreeMap::new();
    // From above to below: the first peak met of a group is its topmost, and names it.
    for &peak in &sweep.peaks {
        if group.contains_key(&peak) {
            continue;
        }
        let mut todo = vec![peak];
        while let Some(p) = todo.pop() {
            if group.insert(p, peak).is_none() {
                assert!(p == peak || raster.is_above(peak, p), "a group is named by its topmost peak");
                todo.extend(inside.get(&p).into_iter().flatten().map(|&(q, _)| q).filter(|q| !group.contains_key(q)));
            }
        }
    }
    for &join in &kept {
        add(&mut between, group[&join.a], group[&join.b], join);
    }
    Tree { group, kept, inside, between }
}

/// The way from one peak to another: each peak after the first with the join that leads to it.
fn way<'a>(edges: &Edges<'a>, from: Cell, to: Cell) -> Vec<(Cell, &'a Join)> {
    let mut came: BTreeMap<Cell, (Cell, &Join)> = BTreeMap::new();
    let mut todo = VecDeque::from([from]);
    while let Some(p) = todo.pop_front() {
        for &(q, join) in edges.get(&p).into_iter().flatten() {
            if q != from && !came.contains_key(&q) {
                came.insert(q, (p, join));
                todo.push_back(q);
            }
        }
    }
    let mut steps = vec![];
    let mut here = to;
    while here != from {
        let (before, join) = came[&here];
        steps.push((here, join));
        here = before;
    }
    steps.reverse();
    steps
}

impl<'a> Tree<'a> {
    /// The peaks that name the groups.
    pub fn groups(&self) -> Vec<Cell> {
        self.group.iter().filter(|(peak, name)| peak == name).map(|(&peak, _)| peak).collect()
    }

    /// The peak that names the group of a peak.
    pub fn group(&self, peak: Cell) -> Cell {
        self.group[&peak]
    }

    /// The edges that are not contracted.
    pub fn edges(&self) -> impl Iterator<Item = &'a Join> + '_ {
        self.kept.iter().copied()
    }

    /// The peaks met from the other side of the saddle along the pruned tree to the island parent, that included.
    pub fn way_to_island_parent(&self, join: &Join) -> Vec<Cell> {
        let start = self.group(if join.a_ended { join.b } else { join.a });
        let mut peaks = vec![start];
        peaks.extend(way(&self.between, start, join.winner).into_iter().map(|(peak, _)| peak));
        peaks
    }

    /// The contracted edges from one peak to another of the same group, in order; each with the peak it leads to.
    pub fn way_inside(&self, from: Cell, to: Cell) -> Vec<(Cell, &'a Join)> {
        way(&self.inside, from, to)
    }
}
