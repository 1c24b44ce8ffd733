//! Squares of terrain that a network learns from.

use super::super::back_projection::{BackProjection, CORRECTION_MARGIN};
use super::super::bicubic::{Bicubic, MARGIN};
use super::super::extend::extended;
use super::super::learn::Lesson;
use super::super::orientation::{Offsets, Way, Ways};
use super::super::plane::Plane;
use super::convolution::Convolution;
use super::field::Field;
use super::{REACH, RISES, rises};

/// Side in coarse cells of a square, where there is room.
pub(super) const SQUARE: usize = 32;

/// Terrain that is known coarse and fine, ready to take squares from.
pub(super) struct Ground {
    factor: usize,
    coarse: Plane,
    /// What fine cells have above bicubic heights that keep the means.
    detail: Vec<f32>,
    /// Coarse cells around which all is known.
    is_sure: Vec<bool>,
    /// Their numbers.
    pub(super) places: Vec<u32>,
    side: usize,
    /// Where the cells of a turned square are found: coarse ones with their margins, without, and fine ones.
    around: Offsets,
    own: Offsets,
    fine: Offsets,
}

/// A square to learn from.
pub(super) struct Square {
    /// What the network sees.
    pub(super) rises: Field,
    /// What it should say.
    pub(super) detail: Field,
    /// One for each cell that counts, and zero.
    pub(super) counts: Vec<f32>,
}

impl Ground {
    /// Nothing where no square has room.
    pub(super) fn of(lesson: &Lesson, factor: usize) -> Option<Self> {
        let (rows, cols) = (lesson.coarse.rows(), lesson.coarse.cols());
        let side = SQUARE.min(rows.min(cols).saturating_sub(2 * REACH));
        if side == 0 {
            return None;
        }
        let margin = (MARGIN + CORRECTION_MARGIN) as i64;
        let wanted = [-margin, -margin, rows as i64 + 2 * margin, cols as i64 + 2 * margin];
        let wide = extended(&lesson.coarse, [0, 0], [rows, cols], wanted);
        let base = BackProjection::new(factor).corrected(
            &Bicubic::new(factor).enlarged(&wide),
            &wide.trimmed(MARGIN),
            &vec![true; (wide.rows() - 2 * MARGIN) * (wide.cols() - 2 * MARGIN)],
        );
        let detail = lesson.fine.heights_m().iter().zip(base.heights_m()).map(|(fine, base)| (fine - base) as f32);
        let is_sure = sure(&lesson.known, rows, cols);
        let places = (0..).zip(&is_sure).filter(|(_, sure)| **sure).map(|(place, _)| place).collect();
        Some(Self {
            factor,
            detail: detail.collect(),
            places,
            is_sure,
            side,
            around: Ways::new(side + 2 * REACH).offsets(cols),
            own: Ways::new(side).offsets(cols),
            fine: Ways::new(side * factor).offsets(cols * factor),
            coarse: lesson.coarse.clone(),
        })
    }

    /// The sum of the squares of all that is to be said of cells that count, and their number.
    pub(super) fn power(&self) -> (f64, u64) {
        let cols = self.coarse.cols();
        let (mut sum, mut count) = (0.0, 0);
        for (cell, &height) in self.detail.iter().enumerate() {
            let (row, col) = (cell / (cols * self.factor), cell % (cols * self.factor));
            if self.is_sure[row / self.factor * cols + col / self.factor] {
                sum += f64::from(height) * f64::from(height);
                count += 1;
            }
        }
        (sum, count)
    }

    /// The square around a place, as far as the edges let it be in its middle, turned in a way. All heights are divided
    /// by `unit_m`.
    pub(super) fn square(&self, place: u32, way: Way, unit_m: f32) -> Square {
        let (rows, cols) = (self.coarse.rows(), self.coarse.cols());
        let first = |at: usize, count: usize| at.saturating_sub(self.side / 2).clamp(REACH, count - REACH - self.side);
        let (row, col) = (first(place as usize / cols, rows), first(place as usize % cols, cols));
        let side = self.side + 2 * REACH;
        let heights = &self.coarse.heights_m()[(row - REACH) * cols + col - REACH..];
        let square = self.around.of(way).iter().map(|&cell| heights[cell] / f64::from(unit_m)).collect();
        let square = Plane::new(side, side, square);
        let mut seen = Field::zeros(side - 2, side - 2, RISES);
        for line in 0..side - 2 {
            rises([square.row(line + 1), square.row(line + 2)].map(|row| &row[1..]), seen.row_mut(line));
        }
        let fine = &self.detail[(row * cols * self.factor + col) * self.factor..];
        let depth = Convolution::new(0, self.factor * self.factor).depth();
        let mut detail = Field::zeros(self.side, self.side, depth);
        let wide = self.side * self.factor;
        for (cell, &from) in self.fine.of(way).iter().enumerate() {
            let (line, at) = (cell / wide, cell % wide);
            let own = (line / self.factor * self.side + at / self.factor) * depth;
            detail.values[own + line % self.factor * self.factor + at % self.factor] = fine[from] / unit_m;
        }
        let is_sure = &self.is_sure[row * cols + col..];
        let counts = self.own.of(way).iter().map(|&cell| f32::from(u8::from(is_sure[cell])));
        Square { rises: seen, detail, counts: counts.collect() }
    }
}

/// Cells whose estimate no void sways, and no edge.
fn sure(known: &[bool], rows: usize, cols: usize) -> Vec<bool> {
    // Along rows, then along columns.
    let along: Vec<bool> = (0..rows * cols)
        .map(|cell| {
            let (row, col) = (cell / cols, cell % cols);
            (REACH..cols - REACH).contains(&col) && known[row * cols + col - REACH..][..=2 * REACH].iter().all(|&k| k)
        })
        .collect();
    let down = |cell: usize| {
        let (row, col) = (cell / cols, cell % cols);
        (REACH..rows - REACH).contains(&row) && (row - REACH..=row + REACH).all(|row| along[row * cols + col])
    };
    (0..rows * cols).map(down).collect()
}
