//! Isolation: the exact nearest strictly higher cell, and the nearest unknown one.
//!
//! Branch and bound over a [`Pyramid`]: a block is looked into when its maximum is higher than the peak and its
//! least possible distance is within reach of the best cell so far. First come the blocks around the peak, where
//! most peaks find what they look for. The bounds are the metric's own (a chord on an ellipsoid); the few cells that
//! they cannot tell apart are measured, so the result is that of measuring every cell.

use super::pyramid::{BASE, FAN, Level, Pyramid};
use super::survey::Isolation;
use crate::crs::{Block, Metric, Place, Vector};
use crate::grid::{Cell, Grid, Key};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Searches of one raster.
pub(super) struct Isolations<'a, K, M: ?Sized> {
    grid: &'a Grid<K>,
    pyramid: Pyramid<K>,
    metric: &'a M,
    nodata_is_sea: bool,
}

/// What a search looks for.
trait Target<K> {
    fn is_hit(&self, key: K) -> bool;
    fn may_hold(&self, level: &Level<K>, block: usize) -> bool;
}

struct Higher<K>(K);

impl<K: Key> Target<K> for Higher<K> {
    #[inline]
    fn is_hit(&self, key: K) -> bool {
        key > self.0
    }
    #[inline]
    fn may_hold(&self, level: &Level<K>, block: usize) -> bool {
        level.tops[block] > self.0
    }
}

struct Void;

impl<K: Key> Target<K> for Void {
    #[inline]
    fn is_hit(&self, key: K) -> bool {
        key == K::VOID
    }
    #[inline]
    fn may_hold(&self, level: &Level<K>, block: usize) -> bool {
        level.voids[block]
    }
}

/// The state of one search; its buffers serve the next one too.
#[derive(Default)]
pub(super) struct Search {
    /// Squared distance beyond which nothing is of interest any more.
    limit2: f64,
    nearest2: f64,
    /// Hits that were within the limit when they were met, with their `near2`.
    hits: Vec<(f64, Cell)>,
    /// Blocks to look into, the nearest first: the bits of a bound (which sort as it does), level, number.
    blocks: BinaryHeap<Reverse<(u64, u32, u32)>>,
}

impl<'a, K: Key, M: Metric + ?Sized> Isolations<'a, K, M> {
    pub(super) fn new(grid: &'a Grid<K>, metric: &'a M, nodata_is_sea: bool) -> Self {
        Self { grid, pyramid: Pyramid::build(grid), metric, nodata_is_sea }
    }

    /// The isolation of a cell.
    pub(super) fn measure(&self, cell: Cell, search: &mut Search) -> Isolation {
        let (row, col) = self.grid.place(cell);
        let p = (row as i64, col as i64);
        let higher = self.nearest(p, &Higher(self.grid.key(cell)), f64::INFINITY, search);
        let mut unknown_m = None;
        let mut limit_m = higher.map_or(f64::INFINITY, |(vector, _)| vector.distance_m);
        if self.pyramid.has_voids() && !self.nodata_is_sea {
            let void = self.nearest(p, &Void, limit_m, search).filter(|(vector, _)| vector.distance_m < limit_m);
            if let Some((vector, _)) = void {
                unknown_m = Some(vector.distance_m);
                limit_m = vector.distance_m;
            }
        }
        let (rows, cols) = (self.grid.rows() as i64, self.grid.cols() as i64);
        if let Some(outside_m) = self.metric.outside_m(p, rows, cols, limit_m) {
            unknown_m = Some(outside_m);
        }
        match higher {
            Some((vector, higher)) => Isolation {
                isolation_m: Some(vector.distance_m),
                isolation_min_m: Some(unknown_m.unwrap_or(vector.distance_m)),
                certain: unknown_m.is_none(),
                azimuth: vector.azimuth,
                higher: Some(higher),
            },
            None => Isolation {
                isolation_m: None,
                isolation_min_m: unknown_m,
                certain: unknown_m.is_none(),
                azimuth: f64::NAN,
                higher: None,
            },
        }
    }

    /// The nearest hit that is no further than `limit_m`, with the way there; ties go to the lowest index.
    fn nearest(&self, p: Place, target: &impl Target<K>, limit_m: f64, search: &mut Search) -> Option<(Vector, Cell)> {
        search.limit2 = self.metric.reach2(limit_m * limit_m);
        search.nearest2 = f64::INFINITY;
        search.hits.clear();
        search.blocks.clear();
        let done = self.look_around(p, target, search);
        if !done {
            self.descend(p, target, search);
        }
        let limit2 = search.limit2;
        search.hits.retain(|hit| hit.0 <= limit2);
        search.hits.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut best: Option<(Vector, Cell)> = None;
        for &(near2, cell) in &search.hits {
            if best.is_some_and(|(least, _)| near2 > least.distance_m * least.distance_m * (1.0 + 1e-7)) {
                break;
            }
            let (row, col) = self.grid.place(cell);
            let vector = self.metric.vector(p, (row as i64, col as i64));
            if best.is_none_or(|(least, index)| (vector.distance_m, cell) < (least.distance_m, index)) {
                best = Some((vector, cell));
            }
        }
        best
    }

    /// Looks into the blocks next to the place, then lines up the blocks, as small as can be, that together hold
    /// all that is within the limit. Returns whether the first look was enough.
    fn look_around(&self, p: Place, target: &impl Target<K>, search: &mut Search) -> bool {
        for (l, level) in self.pyramid.levels.iter().enumerate() {
            let side = level.side as i64;
            let (br, bc) = ((p.0 / side) as usize, (p.1 / side) as usize);
            let rows = (br.saturating_sub(1), (br + 1).min(level.rows - 1));
            let cols = (bc.saturating_sub(1), (bc + 1).min(level.cols - 1));
            if l == 0 {
                self.look_into(p, br, bc, target, search);
                for r in rows.0..=rows.1 {
                    for c in cols.0..=cols.1 {
                        if (r, c) != (br, bc) && target.may_hold(level, r * level.cols + c) {
                            let bound2 = self.metric.block2(p, &self.block(level, r, c));
                            if bound2 <= search.limit2 {
                                self.look_into(p, r, c, target, search);
                            }
                        }
                    }
                }
            }
            if search.limit2 < f64::INFINITY && self.is_within(p, level, rows, cols, search.limit2) {
                if l == 0 {
                    return true;
                }
                for r in rows.0..=rows.1 {
                    for c in cols.0..=cols.1 {
                        self.push(p, l, r, c, target, search);
                    }
                }
                return false;
            }
        }
        let top = self.pyramid.levels.len() - 1;
        let level = &self.pyramid.levels[top];
        for r in 0..level.rows {
            for c in 0..level.cols {
                self.push(p, top, r, c, target, search);
            }
        }
        false
    }

    /// Whether all that is within the limit lies in the given blocks.
    fn is_within(&self, p: Place, level: &Level<K>, rows: (usize, usize), cols: (usize, usize), limit2: f64) -> bool {
        let (all_rows, all_cols) = (self.grid.rows() as i64 - 1, self.grid.cols() as i64 - 1);
        let side = level.side as i64;
        let (north, south) = (rows.0 as i64 * side - 1, (rows.1 as i64 + 1) * side);
        let (west, east) = (cols.0 as i64 * side - 1, (cols.1 as i64 + 1) * side);
        let beyond = |rows: (i64, i64), cols: (i64, i64)| {
            rows.0 > rows.1 || cols.0 > cols.1 || self.metric.block2(p, &Block { rows, cols }) > limit2
        };
        beyond((0, north), (0, all_cols))
            && beyond((south, all_rows), (0, all_cols))
            && beyond((0, all_rows), (0, west))
            && beyond((0, all_rows), (east, all_cols))
    }

    fn block(&self, level: &Level<K>, r: usize, c: usize) -> Block {
        let side = level.side;
        Block {
            rows: ((r * side) as i64, ((r + 1) * side).min(self.grid.rows()) as i64 - 1),
            cols: ((c * side) as i64, ((c + 1) * side).min(self.grid.cols()) as i64 - 1),
        }
    }

    #[inline]
    fn push(&self, p: Place, l: usize, r: usize, c: usize, target: &impl Target<K>, search: &mut Search) {
        let level = &self.pyramid.levels[l];
        let index = r * level.cols + c;
        if target.may_hold(level, index) {
            let bound2 = self.metric.block2(p, &self.block(level, r, c));
            if bound2 <= search.limit2 {
                search.blocks.push(Reverse((bound2.to_bits(), l as u32, index as u32)));
            }
        }
    }

    fn descend(&self, p: Place, target: &impl Target<K>, search: &mut Search) {
        let (own_row, own_col) = (p.0 as usize / BASE, p.1 as usize / BASE);
        while let Some(Reverse((bits, l, index))) = search.blocks.pop() {
            if f64::from_bits(bits) > search.limit2 {
                // All others are at least as far.
                break;
            }
            let level = &self.pyramid.levels[l as usize];
            let (r, c) = (index as usize / level.cols, index as usize % level.cols);
            if l == 0 {
                // The blocks next to the place were looked into before anything else.
                if r.abs_diff(own_row) > 1 || c.abs_diff(own_col) > 1 {
                    self.look_into(p, r, c, target, search);
                }
                continue;
            }
            let fine = &self.pyramid.levels[l as usize - 1];
            for r in r * FAN..((r + 1) * FAN).min(fine.rows) {
                for c in c * FAN..((c + 1) * FAN).min(fine.cols) {
                    self.push(p, l as usize - 1, r, c, target, search);
                }
            }
        }
    }

    #[inline]
    fn look_into(&self, p: Place, r: usize, c: usize, target: &impl Target<K>, search: &mut Search) {
        let cols = c * BASE..((c + 1) * BASE).min(self.grid.cols());
        for row in r * BASE..((r + 1) * BASE).min(self.grid.rows()) {
            for (col, &key) in cols.clone().zip(&self.grid.row(row)[cols.clone()]) {
                if target.is_hit(key) {
                    let near2 = self.metric.near2(p, (row as i64, col as i64));
                    if near2 <= search.limit2 {
                        search.hits.push((near2, self.grid.cell(row, col)));
                        if near2 < search.nearest2 {
                            search.nearest2 = near2;
                            search.limit2 = search.limit2.min(self.metric.reach2(near2));
                        }
                    }
                }
            }
        }
    }
}
