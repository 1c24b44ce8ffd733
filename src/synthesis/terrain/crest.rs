//! Ridges drawn into cells.

use super::heights::Heights;
use super::skeleton::{RidgeLine, Skeleton};
use super::touches;
use crate::grid::neighbours::OFFSETS;

/// No ridge.
const NONE: u32 = u32::MAX;
/// A peak that no ridge leads to.
const ALONE: u32 = NONE - 1;
/// How much steeper than in the mean a ridge is at its saddle, and gentler at its peak: real mountains are broad there,
/// so that higher ground is nearer than the next higher peak.
const BULGE: f64 = 0.75;
/// By how much what closes the gaps of a ridge lies lower than the ridge, in metres.
const LOWER_M: f32 = 0.05;

/// The cells on ridges, which stand fast.
pub(super) struct Crest {
    pub(super) cols: usize,
    /// Elevations in metres; NaN beside the ridges.
    pub(super) z_m: Vec<f32>,
    /// Position of the ridge of each cell, [`NONE`] beside the ridges.
    pub(super) ridges: Vec<u32>,
    /// Cells at which ridges touch each other, so that water may pass over one of them; in rising order.
    pub(super) gates: Vec<u32>,
    /// Those and what was lowered of the ridges' gaps, in rising order.
    pub(super) lowered: Vec<u32>,
    /// Pairs of ridges that meet higher than the tree has it.
    pub(super) crossings: Vec<[u32; 2]>,
    /// The cells of each ridge, from its saddle to its peak.
    pub(super) lines: Vec<Vec<u32>>,
    /// What closes the gaps of ridges, in rising order, each with the two cells that it is between.
    pub(super) fillers: Vec<[u32; 3]>,
}

impl Crest {
    /// Draws the ridges of a skeleton that was checked.
    ///
    /// Elevations rise along a ridge, less and less steeply; where several share cells the highest counts, but peaks and saddles are what
    /// they are. Water between two corners would slip through a ridge: what closes such a gap is a little lower than the
    /// ridge. Where ridges touch, one of them is lowered (`touches`).
    pub(super) fn of(skeleton: &Skeleton) -> Self {
        let [rows, cols] = skeleton.size;
        let lines = skeleton.ridges.iter().map(|ridge| cells_of(ridge, [rows, cols])).collect();
        let mut crest = Self {
            cols,
            z_m: vec![f32::NAN; rows * cols],
            ridges: vec![NONE; rows * cols],
            gates: vec![],
            lowered: vec![],
            crossings: vec![],
            lines,
            fillers: vec![],
        };
        crest.draw(skeleton);
        let heights = skeleton.heights();
        crest.fill(skeleton, &heights);
        touches::lower(&mut crest, skeleton, &heights);
        crest
    }

    /// Whether a cell lies on a ridge.
    #[inline]
    pub(super) fn is(&self, cell: usize) -> bool {
        self.ridges[cell] != NONE
    }

    fn draw(&mut self, skeleton: &Skeleton) {
        // Those that branch off others come after these.
        let at_peak = |number: &u32| {
            let peak = &skeleton.peaks[skeleton.ridges[*number as usize].peak as usize];
            self.lines[*number as usize].last() == Some(&((peak.row * self.cols + peak.col) as u32))
        };
        let (whole, branches): (Vec<u32>, Vec<u32>) = (0..self.lines.len() as u32).partition(at_peak);
        for number in whole.iter().chain(&branches).copied() {
            let ridge = &skeleton.ridges[number as usize];
            let [low_m, mut high_m] = skeleton.ends_m(ridge);
            let line = &self.lines[number as usize];
            let joint_m = line.last().map_or(f32::NAN, |&cell| self.z_m[cell as usize]);
            if !joint_m.is_nan() && !at_peak(&number) {
                high_m = f64::from(joint_m);
            }
            let steps = line.len().saturating_sub(1).max(1) as f64;
            for (step, &cell) in line.iter().enumerate() {
                let cell = cell as usize;
                let part = step as f64 / steps;
                let elevation_m = (low_m + (high_m - low_m) * part * (1.0 + BULGE * (1.0 - part))) as f32;
                self.z_m[cell] = self.z_m[cell].max(elevation_m);
                let own = self.ridges[cell];
                let saddle_m = |ridge: u32| skeleton.ends_m(&skeleton.ridges[ridge as usize])[0];
                if own == NONE || saddle_m(own) < low_m {
                    self.ridges[cell] = number;
                }
            }
        }
        for (number, ridge) in (0..).zip(&skeleton.ridges) {
            let (saddle, peak) = (&skeleton.saddles[ridge.saddle as usize], &skeleton.peaks[ridge.peak as usize]);
            for spot in [saddle, peak] {
                let cell = spot.row * self.cols + spot.col;
                (self.z_m[cell], self.ridges[cell]) = (spot.elevation_m as f32, number);
            }
        }
        for peak in &skeleton.peaks {
            let cell = peak.row * self.cols + peak.col;
            if self.ridges[cell] == NONE {
                self.ridges[cell] = ALONE;
            }
            self.z_m[cell] = peak.elevation_m as f32;
        }
    }

    /// The peak of a cell's ridge.
    pub(super) fn peak(&self, skeleton: &Skeleton, cell: usize) -> Option<u32> {
        skeleton.ridges.get(self.ridges[cell] as usize).map(|ridge| ridge.peak)
    }

    /// The cells around a cell.
    pub(super) fn around(&self, cell: usize) -> impl Iterator<Item = usize> + use<> {
        let (cols, count) = (self.cols, self.z_m.len());
        let (row, col) = ((cell / cols) as isize, (cell % cols) as isize);
        OFFSETS.into_iter().filter_map(move |(down, right)| {
            let (row, col) = (row + down, col + right);
            (row >= 0 && col >= 0 && col < cols as isize)
                .then(|| (row * cols as isize + col) as usize)
                .filter(|&cell| cell < count)
        })
    }

    /// Closes the gaps between cells of a ridge that touch by a corner alone.
    fn fill(&mut self, skeleton: &Skeleton, heights: &Heights) {
        let cols = self.cols;
        for number in 0..self.lines.len() {
            let peak = skeleton.ridges[number].peak;
            for at in 1..self.lines[number].len() {
                let [a, b] = [self.lines[number][at - 1] as usize, self.lines[number][at] as usize];
                if a / cols == b / cols || a % cols == b % cols {
                    continue;
                }
                let corners = [a / cols * cols + b % cols, b / cols * cols + a % cols];
                if corners.iter().any(|&corner| self.is(corner)) {
                    continue;
                }
                let strangers = |corner: usize| {
                    let strange = |cell: &usize| {
                        self.peak(skeleton, *cell).is_some_and(|other| heights.between(peak, other) < f32::INFINITY)
                    };
                    self.around(corner).filter(strange).count()
                };
                let corner = if strangers(corners[1]) < strangers(corners[0]) { corners[1] } else { corners[0] };
                self.z_m[corner] = f32::INFINITY;
                self.ridges[corner] = number as u32;
                self.fillers.push([corner as u32, a as u32, b as u32]);
            }
        }
        self.fillers.sort_unstable();
        self.settle_fillers();
    }

    /// Keeps what closes gaps lower than the ridges.
    pub(super) fn settle_fillers(&mut self) {
        for &[filler, a, b] in &self.fillers {
            let below_m = self.z_m[a as usize].min(self.z_m[b as usize]) - LOWER_M;
            let own = &mut self.z_m[filler as usize];
            *own = own.min(below_m);
        }
    }

    /// Whether a cell closes a gap.
    pub(super) fn is_filler(&self, cell: u32) -> bool {
        self.fillers.binary_search_by_key(&cell, |filler| filler[0]).is_ok()
    }
}

/// The cells of a line, each beside the one before.
fn cells_of(ridge: &RidgeLine, [rows, cols]: [usize; 2]) -> Vec<u32> {
    let mut cells: Vec<u32> = vec![];
    let inside = |at: f64, count: usize| (at.round().max(0.0) as usize).min(count - 1);
    for pair in ridge.points.windows(2) {
        let (x, y) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
        // At most one row and one column from step to step.
        let steps = x.abs().max(y.abs()).ceil().max(1.0) as usize;
        for step in 0..=steps {
            let part = step as f64 / steps as f64;
            let cell = inside(pair[0][1] + part * y, rows) * cols + inside(pair[0][0] + part * x, cols);
            if cells.last() != Some(&(cell as u32)) {
                cells.push(cell as u32);
            }
        }
    }
    cells
}
