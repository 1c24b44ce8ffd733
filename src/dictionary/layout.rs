//! Where the patches of a terrain lie: a regular grid of discs.

use super::shape::PatchShape;
use crate::codec::sparse::Lattice;
use crate::error::{Error, ErrorKind, Result};

/// A regular grid of discs that covers a raster (paper 001, figure 5).
///
/// The raster is cut into squares of `step` cells; leftover cells are shared by the first and the last. A disc of
/// radius R lies on each square's centre (half a cell north-west of it where the square's cells do not match the
/// disc's), so discs at the border reach out of the raster, and every point of it lies within a disc.
///
/// The paper says that the step is R/2, but counts t₀ = nK/4 cells for n patches of K values, which is a step of
/// R = √K/2 cells, and so does its table 1; a step of R is the default.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchLayout {
    rows: usize,
    cols: usize,
    shape: PatchShape,
    lattice: Lattice,
}

impl PatchLayout {
    /// Discs of `shape` over a raster of `rows` by `cols` cells, every `step` cells; by default every R, rounded
    /// down.
    ///
    /// # Errors
    /// When the raster has no cell, or the step is 0 or so long that discs leave gaps: `2 step²` must be less than
    /// `side²`, counting a cell more where one of step and side is even and the other odd.
    pub fn new(rows: usize, cols: usize, shape: PatchShape, step: Option<usize>) -> Result<Self> {
        let side = shape.side();
        let step = step.unwrap_or(side / 2);
        if rows == 0 || cols == 0 || rows > 1 << 30 || cols > 1 << 30 {
            return Err(Error::usage(format!("patches need a raster, and {rows} x {cols} cells are none")));
        }
        if !Lattice::covers(side, step) {
            let most = (1..side).rev().find(|&step| Lattice::covers(side, step)).unwrap_or(1);
            return Err(Error::usage(format!(
                "discs of side {side} cover the terrain with steps of 1 to {most}, not {step}"
            )));
        }
        let lattice = Lattice::new(cols, rows, side, step);
        let Lattice { down, across, .. } = lattice;
        if down.checked_mul(across).is_none_or(|count| count >= u32::MAX as usize) {
            return Err(Error::new(ErrorKind::Unsupported, format!("{down} x {across} patches; take a longer step")));
        }
        Ok(Self { rows, cols, shape, lattice })
    }

    /// Number of rows of the raster.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns of the raster.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// From one centre to the next, in cells.
    pub fn step(&self) -> usize {
        self.lattice.step
    }

    /// Where the squares lie.
    pub fn lattice(&self) -> Lattice {
        self.lattice
    }

    /// The shape of the patches.
    pub fn shape(&self) -> &PatchShape {
        &self.shape
    }

    /// Rows and columns of patches.
    pub fn patches(&self) -> (usize, usize) {
        (self.lattice.down, self.lattice.across)
    }

    /// Number of places for patches; places are numbered row by row.
    pub fn places(&self) -> usize {
        self.lattice.down * self.lattice.across
    }

    /// Row and column of the first cell of the square at a place; outside the raster they may be negative.
    pub fn corner(&self, place: usize) -> (i64, i64) {
        let (i, j) = ((place / self.lattice.across) as i64, (place % self.lattice.across) as i64);
        (self.lattice.top + i * self.lattice.step as i64, self.lattice.left + j * self.lattice.step as i64)
    }

    /// Rows of places, and columns of places, whose squares hold cells or points of a window: from `from` to `to`,
    /// in cells of the raster, both included.
    pub(super) fn places_at(&self, rows: (f64, f64), cols: (f64, f64)) -> [std::ops::Range<usize>; 2] {
        let range = |first: i64, count: usize, (from, to): (f64, f64)| {
            let step = self.lattice.step as f64;
            let begin = ((from - first as f64 - self.shape.side() as f64) / step).floor().max(0.0) as usize;
            let end = ((to - first as f64) / step).floor() + 1.0;
            begin.min(count)..(end.max(0.0) as usize).min(count)
        };
        [range(self.lattice.top, self.lattice.down, rows), range(self.lattice.left, self.lattice.across, cols)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codec::sparse::fall_off;
    use proptest::prelude::*;

    fn layout(rows: usize, cols: usize, side: usize, step: Option<usize>) -> PatchLayout {
        PatchLayout::new(rows, cols, PatchShape::new(side).unwrap(), step).unwrap()
    }

    #[test]
    fn the_default_step_is_the_radius() {
        let layout = layout(512, 512, 8, None);
        assert_eq!((layout.step(), layout.patches()), (4, (128, 128)));
        // Then t0 = nK/4.
        assert_eq!(layout.places() * layout.shape().values() / 4, 512 * 512);
        assert_eq!(layout.corner(0), (-2, -2));
        assert_eq!(layout.corner(129), (2, 2));
    }

    #[test]
    fn steps_that_leave_gaps_are_refused() {
        for (side, step) in [(8, 0), (8, 6), (8, 5), (8, 9), (3, 2), (14, 10)] {
            let error = PatchLayout::new(9, 9, PatchShape::new(side).unwrap(), Some(step)).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Usage, "{side} {step}");
        }
        assert!(PatchLayout::new(0, 9, PatchShape::new(8).unwrap(), None).is_err());
    }

    proptest! {
        #[test]
        fn every_point_lies_in_a_disc(
            rows in 1usize..30, cols in 1usize..30, side in 3usize..16, step in 1usize..11,
            down in 0.0f64..=1.0, right in 0.0f64..=1.0,
        ) {
            let Ok(layout) = PatchLayout::new(rows, cols, PatchShape::new(side).unwrap(), Some(step)) else {
                return Ok(());
            };
            let (y, x) = (down * rows as f64, right * cols as f64);
            let radius = layout.shape().radius_cells();
            let weight = |place: usize| {
                let (top, left) = layout.corner(place);
                fall_off(x - left as f64 - radius, y - top as f64 - radius, radius)
            };
            let all: Vec<usize> = (0..layout.places()).filter(|&place| weight(place) > 0.0).collect();
            prop_assert!(!all.is_empty(), "nothing covers {y} {x}");
            let [down, across] = layout.places_at((y, y), (x, x));
            for place in all {
                let (i, j) = (place / layout.patches().1, place % layout.patches().1);
                prop_assert!(down.contains(&i) && across.contains(&j), "{place} was not found");
            }
        }
    }
}
