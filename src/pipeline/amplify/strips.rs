//! Makes the output strip by strip, each in tiles that the threads share.

use super::glance::Glance;
use super::method::Method;
use super::sink::Sink;
use super::terrain::Terrain;
use crate::amplify::{extended, extended_mask, filled_to};
use crate::error::Result;
use crate::pipeline::memory::{BatchNeeds, batch_budget};
use crate::watch::Watch;
use rayon::prelude::*;
use std::ops::Range;

/// Side in fine cells that tiles have where there is room: their margins are then a small part of them.
const TILE: usize = 1024;
/// Bytes a fine cell that a thread takes while it makes a tile.
const TILE_BYTES_PER_CELL: u64 = 64;
/// Bytes a fine cell of a strip that is being made or written.
const STRIP_BYTES_PER_CELL: u64 = 8;
/// What to do where less memory would do.
const REMEDY: &str = "cut the raster with --window or --bbox, or take fewer threads";

/// How a raster is made finer.
pub(super) struct Making<'a> {
    pub(super) terrain: &'a Terrain,
    pub(super) method: &'a Method,
    /// The value of cells without data; NaN where none is declared.
    pub(super) void: f32,
    /// Which of many terrains is made, where the method draws one.
    pub(super) seed: u64,
    pub(super) memory: Option<u64>,
    pub(super) watch: &'a Watch,
}

/// What was made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Made {
    /// Fine cells with data.
    pub(super) cells: u64,
    /// Greatest difference in the input's unit between an input cell and the mean of its fine cells.
    pub(super) deviation: f64,
}

impl Made {
    const NOTHING: Self = Self { cells: 0, deviation: 0.0 };

    fn joined(self, other: Self) -> Self {
        Self { cells: self.cells + other.cells, deviation: self.deviation.max(other.deviation) }
    }
}

/// Fine cells of a rectangle of input cells, how far the mean of each of these is off, NaN for voids, and all in all.
struct Strip {
    cells: Vec<f32>,
    deviations: Vec<f64>,
    made: Made,
}

/// Rows of input cells of a strip, and rows and columns of a tile.
#[derive(Clone, Copy, Debug)]
struct Plan {
    strip: usize,
    tile: [usize; 2],
}

/// Input cells that a tile needs, and what is known of them.
struct Window {
    corner: [usize; 2],
    size: [usize; 2],
    elevations: Vec<f64>,
}

impl Making<'_> {
    /// Makes all of it: while a strip is written, the next is made.
    ///
    /// # Errors
    /// When a part cannot be read or written, memory does not suffice, or the job is cancelled.
    pub(super) fn run(&self, sink: &mut Sink, mut glance: Option<&mut Glance>) -> Result<Made> {
        let [rows, cols] = self.terrain.size();
        let plan = self.plan(sink.rows())?;
        let factor = self.method.factor();
        let strips: Vec<Range<usize>> =
            (0..rows).step_by(plan.strip).map(|row| row..rows.min(row + plan.strip)).collect();
        self.watch.begin("making", rows as u64 * cols as u64);
        let mut made = Made::NOTHING;
        let mut coming = strips.first().map(|rows| self.strip(rows, plan.tile)).transpose()?;
        for (i, rows) in strips.iter().enumerate() {
            let Some(mut strip) = coming.take() else { break };
            made = made.joined(strip.made);
            if let Some(glance) = &mut glance {
                glance.take(rows, &strip.cells, &strip.deviations);
            }
            let next = || strips.get(i + 1).map(|rows| self.strip(rows, plan.tile)).transpose();
            let (next, written) =
                rayon::join(next, || sink.write(rows.start * factor, cols * factor, &mut strip.cells));
            written?;
            coming = next?;
        }
        Ok(made)
    }

    /// How large strips and tiles are. Neither changes the bytes of the output, as strips end where blocks do.
    fn plan(&self, block: usize) -> Result<Plan> {
        let factor = self.method.factor();
        let [rows, cols] = self.terrain.size();
        // The fewest rows of input cells that make whole rows of blocks.
        let unit = (1..=block).find(|&rows| (rows * factor).is_multiple_of(block)).unwrap_or(block);
        let row_bytes = (cols * factor) as u64 * STRIP_BYTES_PER_CELL * factor as u64;
        let reach = 2 * self.method.reach() * factor;
        let side = |cells: usize| (cells + reach.min(TILE)) as u64;
        let needs = |tile: usize| BatchNeeds {
            least: row_bytes * unit.min(rows) as u64,
            per_thread: side(tile) * side(TILE) * TILE_BYTES_PER_CELL,
            kept: self.method.bytes() as u64 + 2 * reach as u64 * cols as u64 * 8 / factor as u64,
        };
        let tile = (TILE / factor).max(1);
        // Tiles as high as the lowest strip where there is no room for more.
        let lowest = unit.min(tile);
        let (high, budget) = match batch_budget(self.memory, &needs(tile * factor), REMEDY) {
            Ok(budget) => (tile, budget),
            Err(_) => (lowest, batch_budget(self.memory, &needs(lowest * factor), REMEDY)?),
        };
        let most = usize::try_from(budget / row_bytes.max(1)).unwrap_or(usize::MAX) / unit * unit;
        let strip = most.min(self.method.strip_rows(tile, unit)).max(unit);
        // Enough tiles for all threads, where the raster is small; but none that is mostly margins.
        let threads = rayon::current_num_threads();
        let mut tile = [high.min(strip), tile];
        let least = (TILE / 4 / factor).max(2 * self.method.reach());
        while tile[0].max(tile[1]) > least && strip.min(rows).div_ceil(tile[0]) * cols.div_ceil(tile[1]) < 4 * threads {
            let longer = usize::from(tile[1] >= tile[0]);
            tile[longer] = (tile[longer] / 2).max(1);
        }
        Ok(Plan { strip, tile })
    }

    /// The fine cells of some rows of input cells.
    fn strip(&self, rows: &Range<usize>, tile: [usize; 2]) -> Result<Strip> {
        self.watch.check()?;
        let [height, cols] = self.terrain.size();
        let factor = self.method.factor();
        let halo = self.method.reach() + self.method.fill_reach();
        let (top, bottom) = (rows.start.saturating_sub(halo), height.min(rows.end + halo));
        let elevations = self.terrain.read([top, 0], [bottom - top, cols])?;
        let strip = Window { corner: [top, 0], size: [bottom - top, cols], elevations };
        let tiles: Vec<[usize; 4]> = rows
            .clone()
            .step_by(tile[0])
            .flat_map(|row| {
                let high = tile[0].min(rows.end - row);
                (0..cols).step_by(tile[1]).map(move |col| [row, col, high, tile[1].min(cols - col)])
            })
            .collect();
        let made: Vec<Result<Strip>> = tiles.par_iter().map(|&tile| self.tile(&strip, tile)).collect();
        let mut cells = vec![0.0; rows.len() * factor * cols * factor];
        let mut deviations = vec![0.0; rows.len() * cols];
        let mut all = Made::NOTHING;
        for ([row, col, _, wide], made) in tiles.into_iter().zip(made) {
            let own = made?;
            all = all.joined(own.made);
            for (line, own) in own.deviations.chunks_exact(wide).enumerate() {
                deviations[(row - rows.start + line) * cols + col..][..wide].copy_from_slice(own);
            }
            for (line, own) in own.cells.chunks_exact(wide * factor).enumerate() {
                let start = ((row - rows.start) * factor + line) * cols * factor + col * factor;
                cells[start..start + own.len()].copy_from_slice(own);
            }
        }
        Ok(Strip { cells, deviations, made: all })
    }

    /// The fine cells of a rectangle of input cells: first row, first column, rows, columns.
    fn tile(&self, strip: &Window, [row, col, rows, cols]: [usize; 4]) -> Result<Strip> {
        let size = self.terrain.size();
        let factor = self.method.factor();
        let reach = self.method.reach();
        let window = strip.part([row, col], [rows, cols], reach + self.method.fill_reach(), size);
        let (plane, known) = filled_to(self.method.fill_reach(), window.size[0], window.size[1], window.elevations);
        let margin = reach as i64;
        let wanted = [row as i64 - margin, col as i64 - margin, (rows + 2 * reach) as i64, (cols + 2 * reach) as i64];
        let around = extended(&plane, window.corner, size, wanted);
        let mask = extended_mask(&known, plane.cols(), window.corner, size, wanted);
        let own = |mask: &[bool], row: usize, col: usize| mask[(row + reach) * (cols + 2 * reach) + col + reach];
        let is_known: Vec<bool> = (0..rows * cols).map(|cell| own(&mask, cell / cols, cell % cols)).collect();
        let truth = around.trimmed(reach);
        let corner = [row, col].map(|at| at as i64 - margin);
        let fine = self.method.amplified(around, mask, corner, self.seed);
        let mut cells: Vec<f32> = fine.heights_m().iter().map(|&height| height as f32).collect();
        let mut made = Made::NOTHING;
        let mut deviations = vec![f64::NAN; is_known.len()];
        for (cell, &known) in is_known.iter().enumerate() {
            let corner = (cell / cols * cols * factor + cell % cols) * factor;
            let mut sum = 0.0;
            for line in 0..factor {
                for value in &mut cells[corner + line * cols * factor..][..factor] {
                    if !known {
                        *value = self.void;
                    } else if *value == self.void {
                        // It has data, so it must not look like a void.
                        *value = value.next_up();
                    }
                    sum += f64::from(*value);
                }
            }
            if known {
                made.cells += (factor * factor) as u64;
                let deviation = (sum / (factor * factor) as f64 - truth.heights_m()[cell]).abs();
                made.deviation = made.deviation.max(deviation);
                deviations[cell] = deviation;
            }
        }
        self.watch.advance((rows * cols) as u64)?;
        Ok(Strip { cells, deviations, made })
    }
}

impl Window {
    /// The part around a rectangle, as far as a halo reaches within the raster.
    fn part(&self, corner: [usize; 2], size: [usize; 2], halo: usize, whole: [usize; 2]) -> Self {
        let from = [0, 1].map(|axis| corner[axis].saturating_sub(halo).max(self.corner[axis]));
        let to = [0, 1].map(|axis| {
            let end = whole[axis].min(corner[axis] + size[axis] + halo);
            end.min(self.corner[axis] + self.size[axis])
        });
        let lines = (from[0]..to[0]).flat_map(|row| {
            let start = (row - self.corner[0]) * self.size[1] - self.corner[1];
            self.elevations[start + from[1]..start + to[1]].iter().copied()
        });
        Self { corner: from, size: [to[0] - from[0], to[1] - from[1]], elevations: lines.collect() }
    }
}
