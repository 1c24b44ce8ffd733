//! Patches of a raster, around their weighted means.

use super::layout::PatchLayout;
use super::raster::Raster;
use crate::error::{Error, Result};
use rayon::prelude::*;

/// The patches of a raster (paper 001, section 4.2), in the order of their places.
///
/// The paper takes plain means over the disc; here cells count by the disc's weights, as in everything else. Cells
/// that are void or outside the raster have no weight. A patch without a cell that weighs anything is left out.
#[derive(Clone, Debug)]
pub struct Patches {
    layout: PatchLayout,
    places: Vec<u32>,
    mean_m: Vec<f64>,
    values: Vec<f32>,
    known: Vec<Option<Box<[bool]>>>,
}

/// Rows of patches that are cut out at once.
const ROWS: usize = 64;

/// One patch, while it is cut out.
struct Patch {
    mean_m: f64,
    known: Option<Box<[bool]>>,
}

impl Patches {
    /// Cuts a raster into the patches of a layout.
    ///
    /// # Errors
    /// When the layout is made for another size.
    pub fn new(raster: &Raster, layout: PatchLayout) -> Result<Self> {
        if (raster.rows(), raster.cols()) != (layout.rows(), layout.cols()) {
            let (rows, cols) = (layout.rows(), layout.cols());
            let message = format!("patches for {rows} x {cols} cells over {} x {}", raster.rows(), raster.cols());
            return Err(Error::usage(message));
        }
        let size = layout.shape().values();
        let (down, across) = layout.patches();
        let count = down * across;
        let mut all = Self {
            layout,
            places: Vec::with_capacity(count),
            mean_m: Vec::with_capacity(count),
            values: Vec::with_capacity(count * size),
            known: Vec::with_capacity(count),
        };
        // Some rows at a time, so that no second copy of all is there at once.
        for from in (0..down).step_by(ROWS) {
            let layout = &all.layout;
            let line = |i: usize| {
                let (mut places, mut patches, mut values) = (vec![], vec![], vec![]);
                for place in i * across..(i + 1) * across {
                    values.resize(values.len() + size, f32::NAN);
                    let start = values.len() - size;
                    match cut(raster, layout, place, &mut values[start..]) {
                        Some(patch) => {
                            places.push(place as u32);
                            patches.push(patch);
                        }
                        None => values.truncate(start),
                    }
                }
                (places, patches, values)
            };
            let lines: Vec<(Vec<u32>, Vec<Patch>, Vec<f32>)> =
                (from..down.min(from + ROWS)).into_par_iter().map(line).collect();
            for (places, patches, values) in lines {
                all.places.extend(places);
                all.values.extend(values);
                for patch in patches {
                    all.mean_m.push(patch.mean_m);
                    all.known.push(patch.known);
                }
            }
        }
        Ok(all)
    }

    /// Where the patches lie.
    pub fn layout(&self) -> &PatchLayout {
        &self.layout
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there is none: the raster is void.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// The place of each patch.
    pub fn places(&self) -> &[u32] {
        &self.places
    }

    /// The weighted mean of each patch, in metres.
    pub fn mean_m(&self) -> &[f64] {
        &self.mean_m
    }

    /// The values of a patch above its mean, in metres, row by row; 0 where there is no cell.
    pub fn values_m(&self, patch: usize) -> &[f32] {
        let size = self.layout.shape().values();
        &self.values[patch * size..][..size]
    }

    /// The values of all patches, one behind the other.
    pub(super) fn all_values_m(&self) -> &[f32] {
        &self.values
    }

    /// The values of all patches, to be made something else of.
    pub(super) fn into_values_m(self) -> Vec<f32> {
        self.values
    }

    /// Which of the disc's cells are there; `None`: all of them.
    pub(super) fn known(&self, patch: usize) -> Option<&[bool]> {
        self.known[patch].as_deref()
    }

    /// Whether all cells of a patch's disc are there.
    pub fn is_whole(&self, patch: usize) -> bool {
        self.known[patch].is_none()
    }
}

/// Fills `values` (of NaN) with a patch above its mean.
fn cut(raster: &Raster, layout: &PatchLayout, place: usize, values: &mut [f32]) -> Option<Patch> {
    let shape = layout.shape();
    let (top, left) = layout.corner(place);
    for (row, line) in values.chunks_exact_mut(shape.side()).enumerate() {
        let (begin, cells) = raster.part(top + row as i64, left, shape.side());
        line[begin..begin + cells.len()].copy_from_slice(cells);
    }
    // Above the first cell, so that flat ground has exactly its own mean.
    let first = f64::from(shape.disc().map(|k| values[k]).find(|v| !v.is_nan())?);
    let (mut weight, mut sum, mut missing) = (0.0, 0.0, 0);
    for k in shape.disc() {
        if values[k].is_nan() {
            missing += 1;
        } else {
            weight += shape.weights()[k];
            sum += shape.weights()[k] * (f64::from(values[k]) - first);
        }
    }
    let mean_m = first + sum / weight;
    let known = (missing > 0).then(|| shape.disc().map(|k| !values[k].is_nan()).collect());
    for value in values {
        *value = if value.is_nan() { 0.0 } else { (f64::from(*value) - mean_m) as f32 };
    }
    Some(Patch { mean_m, known })
}

#[cfg(test)]
mod tests {
    use super::super::shape::PatchShape;
    use super::*;

    fn patches(rows: usize, cols: usize, cells: &[f32], side: usize) -> Patches {
        let layout = PatchLayout::new(rows, cols, PatchShape::new(side).unwrap(), None).unwrap();
        Patches::new(&Raster::new(rows, cols, cells).unwrap(), layout).unwrap()
    }

    #[test]
    fn means_are_weighted_and_taken_away() {
        let cells: Vec<f32> = (0..144).map(|i| 1000.0 + ((i * 37) % 101) as f32).collect();
        let patches = patches(12, 12, &cells, 6);
        assert_eq!(patches.len(), 16);
        let shape = patches.layout().shape();
        for i in 0..patches.len() {
            let (top, left) = patches.layout().corner(patches.places()[i] as usize);
            let (mut weight, mut sum) = (0.0, 0.0);
            for k in 0..36 {
                let (row, col) = (top + k as i64 / 6, left + k as i64 % 6);
                if (0..12).contains(&row) && (0..12).contains(&col) {
                    let height = f64::from(cells[(row * 12 + col) as usize]);
                    weight += shape.weights()[k];
                    sum += shape.weights()[k] * height;
                    assert!((patches.mean_m()[i] + f64::from(patches.values_m(i)[k]) - height).abs() < 1e-4);
                } else {
                    assert_eq!(patches.values_m(i)[k], 0.0);
                }
            }
            assert!((patches.mean_m()[i] - sum / weight).abs() < 1e-9);
            assert_eq!(patches.is_whole(i), (0..=6).contains(&top) && (0..=6).contains(&left));
        }
    }

    #[test]
    fn voids_weigh_nothing_and_patches_of_voids_are_left_out() {
        let mut cells = vec![f32::NAN; 400];
        cells[0] = 7.0;
        let patches = patches(20, 20, &cells, 8);
        assert!(!patches.is_empty() && patches.len() < patches.layout().places());
        assert!(patches.mean_m().iter().all(|&mean| mean == 7.0));
        assert!((0..patches.len()).all(|i| patches.values_m(i).iter().all(|&v| v == 0.0)));
        let void = [f32::NAN; 9];
        assert!(self::patches(3, 3, &void, 4).is_empty());
    }

    #[test]
    fn a_patch_may_be_larger_than_the_raster() {
        let patches = patches(2, 3, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], 30);
        assert_eq!(patches.len(), 1);
        assert!(!patches.is_whole(0));
    }

    #[test]
    fn a_layout_of_another_size_is_refused() {
        let layout = PatchLayout::new(4, 4, PatchShape::new(3).unwrap(), None).unwrap();
        assert!(Patches::new(&Raster::new(2, 2, &[0.0; 4]).unwrap(), layout).is_err());
    }
}
