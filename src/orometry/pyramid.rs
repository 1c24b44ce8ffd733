//! Maxima of blocks of cells, in levels, for searches that skip what holds nothing of interest.

use crate::grid::{Grid, Key};
use rayon::prelude::*;

/// Side in cells of the blocks of the finest level.
pub(super) const BASE: usize = 8;

/// Blocks of one level along each side of a block of the next.
pub(super) const FAN: usize = 4;

/// One level of blocks.
#[derive(Debug)]
pub(super) struct Level<K> {
    /// Side of a block in cells.
    pub(super) side: usize,
    pub(super) rows: usize,
    pub(super) cols: usize,
    /// Greatest key of each block.
    pub(super) tops: Vec<K>,
    /// Whether each block holds a void; empty where the whole raster holds none.
    pub(super) voids: Vec<bool>,
}

/// The levels, finest first; the last has at most `FAN` blocks a side.
#[derive(Debug)]
pub(super) struct Pyramid<K> {
    pub(super) levels: Vec<Level<K>>,
}

impl<K: Key> Pyramid<K> {
    /// Builds the pyramid of a grid.
    pub(super) fn build(grid: &Grid<K>) -> Self {
        let (rows, cols) = (grid.rows().div_ceil(BASE), grid.cols().div_ceil(BASE));
        let lines: Vec<(Vec<K>, Vec<bool>)> = (0..rows)
            .into_par_iter()
            .map(|br| {
                let mut tops = vec![K::VOID; cols];
                let mut lows = vec![K::from_i64(0); cols];
                let mut first = true;
                for row in br * BASE..((br + 1) * BASE).min(grid.rows()) {
                    for ((top, low), cells) in tops.iter_mut().zip(&mut lows).zip(grid.row(row).chunks(BASE)) {
                        *top = cells.iter().fold(*top, |a, &b| a.max(b));
                        let least = cells.iter().fold(cells[0], |a, &b| a.min(b));
                        *low = if first { least } else { least.min(*low) };
                    }
                    first = false;
                }
                (tops, lows.into_iter().map(|low| low == K::VOID).collect())
            })
            .collect();
        let mut level = Level { side: BASE, rows, cols, tops: Vec::new(), voids: Vec::new() };
        for (tops, voids) in lines {
            level.tops.extend(tops);
            level.voids.extend(voids);
        }
        if !level.voids.contains(&true) {
            level.voids = Vec::new();
        }
        let mut levels = vec![level];
        while let Some(fine) = levels.last().filter(|fine| fine.rows > FAN || fine.cols > FAN) {
            let coarse = fine.coarser();
            levels.push(coarse);
        }
        Self { levels }
    }

    /// Whether the raster holds a void.
    pub(super) fn has_voids(&self) -> bool {
        !self.levels[0].voids.is_empty()
    }
}

impl<K: Key> Level<K> {
    fn coarser(&self) -> Self {
        let (rows, cols) = (self.rows.div_ceil(FAN), self.cols.div_ceil(FAN));
        let mut tops = vec![K::VOID; rows * cols];
        let mut voids = vec![false; if self.voids.is_empty() { 0 } else { rows * cols }];
        for row in 0..self.rows {
            for col in 0..self.cols {
                let (to, from) = (row / FAN * cols + col / FAN, row * self.cols + col);
                tops[to] = tops[to].max(self.tops[from]);
                if !voids.is_empty() {
                    voids[to] |= self.voids[from];
                }
            }
        }
        Self { side: self.side * FAN, rows, cols, tops, voids }
    }
}
