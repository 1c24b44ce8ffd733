//! The sweep from above to below.

use orograph::crs::Place;
use orograph::grid::{Cell, Grid, Key};
use std::collections::BTreeSet;

/// A raster with its cells in the total order.
pub struct Raster {
    pub rows: i64,
    pub cols: i64,
    pub wraps: bool,
    keys: Vec<Option<i64>>,
    /// The cells that are not void, from above to below.
    pub order: Vec<Cell>,
    /// Position of each cell in the order; voids come after all.
    rank: Vec<usize>,
}

impl Raster {
    pub fn new<K: Key>(grid: &Grid<K>) -> Self {
        let keys: Vec<Option<i64>> = grid.cells().iter().map(|&key| (key != K::VOID).then(|| key.to_i64())).collect();
        let mut order: Vec<Cell> = (0..keys.len() as Cell).filter(|&c| keys[c as usize].is_some()).collect();
        // Higher first; among equals the lower index.
        order.sort_by(|&p, &q| keys[q as usize].cmp(&keys[p as usize]).then(p.cmp(&q)));
        let mut rank = vec![usize::MAX; keys.len()];
        for (i, &cell) in order.iter().enumerate() {
            rank[cell as usize] = i;
        }
        Self { rows: grid.rows() as i64, cols: grid.cols() as i64, wraps: grid.wraps(), keys, order, rank }
    }

    pub fn key(&self, cell: Cell) -> i64 {
        self.keys[cell as usize].expect("a void has no elevation")
    }

    pub fn is_void(&self, cell: Cell) -> bool {
        self.keys[cell as usize].is_none()
    }

    pub fn has_voids(&self) -> bool {
        self.order.len() < self.keys.len()
    }

    pub fn cells(&self) -> impl Iterator<Item = Cell> + use<> {
        0..self.keys.len() as Cell
    }

    pub fn is_above(&self, p: Cell, q: Cell) -> bool {
        self.rank[p as usize] < self.rank[q as usize]
    }

    pub fn place(&self, cell: Cell) -> Place {
        (cell as i64 / self.cols, cell as i64 % self.cols)
    }

    /// The up to eight places around a cell: cells of the raster, voids among them, or `None` for the outside.
    pub fn around(&self, cell: Cell) -> Vec<Option<Cell>> {
        let (row, col) = self.place(cell);
        let mut found = vec![];
        for r in row - 1..=row + 1 {
            for c in col - 1..=col + 1 {
                if (r, c) == (row, col) {
                    continue;
                }
                let c = if self.wraps { c.rem_euclid(self.cols) } else { c };
                let inside = (0..self.rows).contains(&r) && (0..self.cols).contains(&c);
                found.push(inside.then_some((r * self.cols + c) as Cell));
            }
        }
        found
    }

    /// The neighbours of a cell: those around it that exist and are not void.
    pub fn neighbours(&self, cell: Cell) -> Vec<Cell> {
        self.around(cell).into_iter().flatten().filter(|&n| !self.is_void(n)).collect()
    }

    /// The neighbours above a cell, the topmost first.
    pub fn neighbours_above(&self, cell: Cell) -> Vec<Cell> {
        let mut above: Vec<Cell> = self.neighbours(cell).into_iter().filter(|&n| self.is_above(n, cell)).collect();
        above.sort_by_key(|&n| self.rank[n as usize]);
        above
    }

    /// The cells from `cell` by the topmost neighbours up to a peak, both included.
    pub fn climb(&self, cell: Cell) -> Vec<Cell> {
        let mut way = vec![cell];
        while let Some(&top) = self.neighbours_above(way[way.len() - 1]).first() {
            way.push(top);
        }
        way
    }

    /// The peak at the end of the climb.
    pub fn basin(&self, cell: Cell) -> Cell {
        *self.climb(cell).last().expect("a climb holds its start")
    }
}

/// Two components that meet at a saddle.
#[derive(Clone, Debug, PartialEq)]
pub struct Join {
    pub saddle: Cell,
    /// The saddle's topmost neighbour.
    pub n0: Cell,
    /// The saddle's topmost neighbour in the other component.
    pub ni: Cell,
    /// The basin of `n0`.
    pub a: Cell,
    /// The basin of `ni`.
    pub b: Cell,
    /// The peak that ends: the lower of the two tops.
    pub ended: Cell,
    /// The higher of the two tops: the island parent of the other.
    pub winner: Cell,
    /// Whether the ended peak's component is that of `n0`.
    pub a_ended: bool,
}

/// What the sweep found.
pub struct Sweep {
    /// All peaks, from above to below.
    pub peaks: Vec<Cell>,
    /// All joins, in the order in which they happen.
    pub joins: Vec<Join>,
}

/// The lowest cell of the component that holds a cell.
pub fn lowest_beside(raster: &Raster, cell: Cell) -> Cell {
    let mut seen = BTreeSet::from([cell]);
    let mut todo = vec![cell];
    let mut lowest = cell;
    while let Some(cell) = todo.pop() {
        if raster.is_above(lowest, cell) {
            lowest = cell;
        }
        todo.extend(raster.neighbours(cell).into_iter().filter(|&n| seen.insert(n)));
    }
    lowest
}

/// Disjoint sets of cells, each with its topmost member.
pub struct Components {
    parent: Vec<usize>,
    top: Vec<usize>,
}

impl Components {
    pub fn new(count: usize) -> Self {
        Self { parent: (0..count).collect(), top: (0..count).collect() }
    }

    pub fn find(&mut self, mut i: usize) -> usize {
        while self.parent[i] != i {
            self.parent[i] = self.parent[self.parent[i]];
            i = self.parent[i];
        }
        i
    }

    pub fn top(&mut self, i: usize) -> usize {
        let set = self.find(i);
        self.top[set]
    }

    /// Joins the set of `j` to that of `i`; the top of `i`'s set stays the top.
    pub fn join(&mut self, i: usize, j: usize) {
        let (i, j) = (self.find(i), self.find(j));
        self.parent[j] = i;
    }
}

/// Sweeps all cells from above to below, joining each to its swept neighbours.
pub fn sweep(raster: &Raster) -> Sweep {
    let mut components = Components::new(raster.cells().count());
    let mut peaks = vec![];
    let mut joins: Vec<Join> = vec![];
    for &s in &raster.order {
        let above = raster.neighbours_above(s);
        let Some(&n0) = above.first() else {
            peaks.push(s);
            continue;
        };
        // From above to below, so the first neighbour met of a component is its topmost one: an n_i. A component
        // that is joined here no longer counts as another when its next neighbour comes.
        for &ni in &above[1..] {
            if components.find(n0 as usize) == components.find(ni as usize) {
                continue;
            }
            let top_a = components.top(n0 as usize) as Cell;
            let top_b = components.top(ni as usize) as Cell;
            let a_ended = raster.is_above(top_b, top_a);
            let (winner, ended) = if a_ended { (top_b, top_a) } else { (top_a, top_b) };
            components.join(winner as usize, ended as usize);
            joins.push(Join { saddle: s, n0, ni, a: raster.basin(n0), b: raster.basin(ni), ended, winner, a_ended });
        }
        components.join(n0 as usize, s as usize);
    }
    Sweep { peaks, joins }
}
