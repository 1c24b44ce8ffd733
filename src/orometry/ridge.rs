//! The lines of the divide tree: cells from peak over saddle to peak.

use super::divide::{DivideForest, Join, PeakNumber};
use super::prune::{PrunedEdge, PrunedPeak};
use crate::crs::Metric;
use crate::grid::neighbours::is_above;
use crate::grid::{Cell, Grid, Key};

/// Draws the lines of a pruned tree.
pub(super) struct Ridges<'a, K> {
    grid: &'a Grid<K>,
    forest: &'a DivideForest<K>,
    /// For each peak that was taken into a group the peak whose join leads from it towards the group's topmost;
    /// [`NONE`] for the topmost itself.
    towards: Vec<PeakNumber>,
}

const NONE: PeakNumber = PeakNumber::MAX;

impl<'a, K: Key> Ridges<'a, K> {
    /// Prepares the ways inside the groups of the pruned tree `peaks`.
    pub(super) fn new(grid: &'a Grid<K>, forest: &'a DivideForest<K>, peaks: &[PrunedPeak<K>]) -> Self {
        let total = forest.cells.len();
        let mut is_kept = vec![false; total];
        for peak in peaks {
            is_kept[peak.number as usize] = true;
        }
        let taken = || (0..total as PeakNumber).filter(|&p| !is_kept[p as usize]);
        // The joins at each basin, in one array, by counting.
        let mut starts = vec![0_u32; total + 1];
        for peak in taken() {
            let join = &forest.joins[peak as usize];
            starts[join.near as usize + 1] += 1;
            starts[join.far as usize + 1] += 1;
        }
        for i in 0..total {
            starts[i + 1] += starts[i];
        }
        let mut fill = starts.clone();
        let mut joins_at = vec![0; starts[total] as usize];
        for peak in taken() {
            let join = &forest.joins[peak as usize];
            for end in [join.near, join.far] {
                joins_at[fill[end as usize] as usize] = peak;
                fill[end as usize] += 1;
            }
        }
        let mut towards = vec![NONE; total];
        let mut open: Vec<PeakNumber> = peaks.iter().map(|peak| peak.number).collect();
        while let Some(basin) = open.pop() {
            for &peak in &joins_at[starts[basin as usize] as usize..starts[basin as usize + 1] as usize] {
                if towards[basin as usize] != peak {
                    let next = other_end(&forest.joins[peak as usize], basin);
                    towards[next as usize] = peak;
                    open.push(next);
                }
            }
        }
        Self { grid, forest, towards }
    }

    /// The cells of an edge, from the group's topmost peak on the side of the saddle's topmost neighbour to the
    /// other one's.
    pub(super) fn path(&self, edge: &PrunedEdge<K>) -> Vec<Cell> {
        let (a, b) = ends(&edge.join);
        let mut path = self.to_top(a);
        path.reverse();
        self.cross(&edge.join, a, &mut path);
        let rest = self.to_top(b);
        path.extend_from_slice(&rest[1..]);
        path
    }

    /// The cells from a basin's peak to the topmost peak of its group, both included.
    fn to_top(&self, mut basin: PeakNumber) -> Vec<Cell> {
        let mut path = vec![self.forest.cells[basin as usize]];
        while self.towards[basin as usize] != NONE {
            let join = &self.forest.joins[self.towards[basin as usize] as usize];
            self.cross(join, basin, &mut path);
            basin = other_end(join, basin);
        }
        path
    }

    /// Appends the cells that follow the peak of basin `from` over the join's saddle up to the other peak.
    fn cross(&self, join: &Join<K>, from: PeakNumber, path: &mut Vec<Cell>) {
        let saddle = join.saddle;
        let (a, b) = ends(join);
        let up_a = self.grid.uphill(saddle).expect("a saddle is no peak");
        let up_b = self.way_to(saddle, self.forest.cells[b as usize]);
        let (down, up) = if from == a { (up_a, up_b) } else { (up_b, up_a) };
        let start = path.len();
        let mut cell = Some(down);
        while let Some(at) = cell {
            path.push(at);
            cell = self.grid.uphill(at);
        }
        // The last of them is the peak that the path has already.
        path.pop();
        path[start..].reverse();
        path.push(saddle);
        let mut cell = Some(up);
        while let Some(at) = cell {
            path.push(at);
            cell = self.grid.uphill(at);
        }
    }

    /// The topmost neighbour of a saddle whose way up leads to a peak.
    fn way_to(&self, saddle: Cell, peak: Cell) -> Cell {
        let order = |cell: Cell| (self.grid.key(cell), cell);
        let mut best: Option<Cell> = None;
        for (_, next) in self.grid.neighbours(saddle) {
            if is_above(order(next), order(saddle))
                && best.is_none_or(|best| is_above(order(next), order(best)))
                && self.grid.basin(next) == peak
            {
                best = Some(next);
            }
        }
        best.expect("a join's saddle has a way up to both of its basins")
    }
}

/// The basin of the saddle's topmost neighbour, and the other one.
fn ends<K: Key>(join: &Join<K>) -> (PeakNumber, PeakNumber) {
    if join.near_is_a { (join.near, join.far) } else { (join.far, join.near) }
}

fn other_end<K: Key>(join: &Join<K>, end: PeakNumber) -> PeakNumber {
    if join.near == end { join.far } else { join.near }
}

/// Lengths of the steps from cell to cell.
pub(super) struct Steps<'a, M: ?Sized> {
    metric: &'a M,
    cols: usize,
    /// For each row the lengths in metres of a step along it, to the next row, and askew to the next row.
    rows: Vec<[f64; 3]>,
    /// Whether both diagonals of a cell are as long; those of a sheared grid are not.
    has_one_diagonal: bool,
}

impl<'a, M: Metric + ?Sized> Steps<'a, M> {
    pub(super) fn new(metric: &'a M, rows: usize, cols: usize) -> Self {
        let mut table = Vec::new();
        if metric.is_alike_along_rows() {
            table = (0..rows as i64)
                .map(|row| {
                    let next = (row + 1).min(rows as i64 - 1);
                    [(row, 1), (next, 0), (next, 1)].map(|to| metric.distance_m((row, 0), to))
                })
                .collect();
        }
        let has_one_diagonal = rows > 1 && metric.distance_m((0, 0), (1, 1)) == metric.distance_m((0, 1), (1, 0));
        Self { metric, cols, rows: table, has_one_diagonal }
    }

    /// Length of a path in metres.
    pub(super) fn length_m(&self, path: &[Cell]) -> f64 {
        path.windows(2).map(|step| self.step_m(step[0], step[1])).sum()
    }

    fn step_m(&self, from: Cell, to: Cell) -> f64 {
        let place = |cell: Cell| ((cell as usize / self.cols) as i64, (cell as usize % self.cols) as i64);
        let (p, q) = (place(from), place(to));
        match self.rows.get(p.0.min(q.0) as usize) {
            Some(&[along, _, _]) if p.0 == q.0 => along,
            Some(&[_, down, _]) if p.1 == q.1 => down,
            Some(&[_, _, askew]) if self.has_one_diagonal => askew,
            _ => self.metric.distance_m(p, q),
        }
    }
}
