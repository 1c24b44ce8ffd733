//! How the ground between ridges and valleys is formed: everywhere alike, or here like one range and there like another.

use super::ceiling::nearest;
use super::ground::between;
use super::skeleton::Skeleton;

/// How the ground between ridges and valleys is formed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Form {
    /// Slope of the ground that hangs from the crests, rise over run: valleys become so deep.
    pub slope: f64,
    /// Slope of the detail of each wavelength, rise over run, in the mean.
    pub roughness: f64,
    /// How much the slope of the ground between ridges and valleys changes per metre: hills grow round.
    pub curvature: f64,
    /// Share of the depth of the plains below the ground that is theirs alone: valleys take some part.
    pub depth: f64,
}

impl Default for Form {
    fn default() -> Self {
        Self { slope: 0.5, roughness: 0.2, curvature: 5e-4, depth: 0.75 }
    }
}

/// Side in metres of the blocks that have one form.
const BLOCK_M: f64 = 1000.0;

/// Which of several forms the ground has, in blocks that cover a raster edge to edge.
#[derive(Clone, Debug, PartialEq)]
pub struct FormMap {
    size: [usize; 2],
    /// Row by row.
    forms: Vec<usize>,
}

impl FormMap {
    /// Each block has the form of the nearest peak; `forms` are those of the peaks of a skeleton, in their order. The
    /// first of all where there is no peak.
    ///
    /// # Panics
    /// When there is not one form a peak.
    pub fn of_peaks(skeleton: &Skeleton, forms: &[usize]) -> Self {
        assert_eq!(skeleton.peaks.len(), forms.len(), "one form a peak");
        let [rows, cols] = skeleton.size;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least one, at most all cells")]
        let along =
            |cells: usize, cell_m: f64| ((cells as f64 * cell_m / BLOCK_M).round() as usize).clamp(1, cells.max(1));
        let size = [along(rows, skeleton.cell_m[1]), along(cols, skeleton.cell_m[0])];
        let (mut own, mut is_known) = (vec![0.0_f32; size[0] * size[1]], vec![false; size[0] * size[1]]);
        // From the last to the first: of several peaks in a block the first counts.
        for (peak, &form) in skeleton.peaks.iter().zip(forms).rev() {
            let block = peak.row * size[0] / rows * size[1] + peak.col * size[1] / cols;
            (own[block], is_known[block]) = (form as f32, true);
        }
        let side_m =
            [cols as f64 / size[1] as f64 * skeleton.cell_m[0], rows as f64 / size[0] as f64 * skeleton.cell_m[1]];
        let forms = if is_known.contains(&true) { nearest(&own, &is_known, size, side_m) } else { own };
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole numbers that are counted")]
        let forms = forms.into_iter().map(|form| form as usize).collect();
        Self { size, forms }
    }

    /// The form of the block that holds a cell of the raster.
    pub(super) fn at(&self, [row, col]: [usize; 2], [rows, cols]: [usize; 2]) -> usize {
        self.forms[row * self.size[0] / rows * self.size[1] + col * self.size[1] / cols]
    }

    /// The map of a window of the raster: from a row and column, of so many rows and columns.
    pub(super) fn part(&self, raster: [usize; 2], first: [usize; 2], size: [usize; 2]) -> Self {
        let blocks = [0, 1].map(|k| (self.size[k] * size[k]).div_ceil(raster[k].max(1)).clamp(1, size[k].max(1)));
        let cell = |k: usize, block: usize| first[k] + (2 * block + 1) * size[k] / (2 * blocks[k]);
        let form = |block: usize| self.at([cell(0, block / blocks[1]), cell(1, block % blocks[1])], raster);
        Self { size: blocks, forms: (0..blocks[0] * blocks[1]).map(form).collect() }
    }

    /// The greatest number of a form.
    pub(super) fn last(&self) -> usize {
        self.forms.iter().copied().max().unwrap_or(0)
    }
}

/// A number of forms: the same everywhere, or going over from one form's to another's between the middles of blocks.
#[derive(Clone, Debug)]
pub(super) struct Graded {
    size: [usize; 2],
    /// Of the blocks, row by row.
    values: Vec<f32>,
}

impl Graded {
    /// The same number everywhere.
    pub(super) fn even(value: f64) -> Self {
        Self { size: [1; 2], values: vec![value as f32] }
    }

    /// A number of the forms that a map shows; that of the first without a map.
    pub(super) fn of(forms: &[Form], map: Option<&FormMap>, number: impl Fn(&Form) -> f64) -> Self {
        let value = |&form: &usize| number(&forms[form]) as f32;
        match map {
            Some(map) => Self { size: map.size, values: map.forms.iter().map(value).collect() },
            None => Self::even(number(&forms[0])),
        }
    }

    /// Whether it is the same everywhere.
    pub(super) fn is_even(&self) -> bool {
        self.values.len() == 1
    }

    /// The greatest value.
    pub(super) fn most(&self) -> f32 {
        self.values.iter().copied().fold(f32::NEG_INFINITY, f32::max)
    }

    /// The number at a cell of a raster.
    pub(super) fn at(&self, [row, col]: [usize; 2], [rows, cols]: [usize; 2]) -> f32 {
        let middle = |at: usize, count: usize| (at as f64 + 0.5) / count as f64;
        if self.is_even() {
            self.values[0]
        } else {
            between(&self.values, self.size, [middle(row, rows), middle(col, cols)])
        }
    }

    /// The number at the cells of a row of a raster.
    pub(super) fn row(&self, row: usize, size: [usize; 2]) -> Vec<f32> {
        if self.is_even() {
            vec![self.values[0]; size[1]]
        } else {
            (0..size[1]).map(|col| self.at([row, col], size)).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::skeleton::Spot;
    use super::*;

    #[test]
    fn blocks_are_formed_like_the_nearest_peak() {
        let peak = |row, col| Spot { row, col, elevation_m: 100.0 };
        let skeleton = Skeleton {
            size: [60, 120],
            cell_m: [100.0, 50.0],
            peaks: vec![peak(30, 20), peak(35, 95)],
            saddles: vec![],
            ridges: vec![],
        };
        let map = FormMap::of_peaks(&skeleton, &[1, 0]);
        assert_eq!((map.size, map.last()), ([3, 12], 1));
        assert_eq!([0, 40, 50, 70, 119].map(|col| map.at([59, col], skeleton.size)), [1, 1, 1, 0, 0]);
        let part = map.part(skeleton.size, [20, 40], [20, 40]);
        assert_eq!((part.size, &part.forms[..]), ([1, 4], &[1, 1, 0, 0][..]));
        let forms = [Form { slope: 1.0, ..Form::default() }, Form { slope: 3.0, ..Form::default() }];
        let slope = Graded::of(&forms, Some(&map), |form| form.slope);
        let row = slope.row(30, skeleton.size);
        assert_eq!((row[0], row[119], slope.most()), (3.0, 1.0, 3.0));
        assert!(row.windows(2).all(|pair| pair[0] >= pair[1]) && row.iter().any(|&s| s > 1.5 && s < 2.5));
        let none = FormMap::of_peaks(&Skeleton { peaks: vec![], ..skeleton.clone() }, &[]);
        assert_eq!(none.last(), 0);
        assert_eq!(Graded::of(&forms, None, |form| form.slope).row(0, [1, 3]), [1.0; 3]);
    }
}
