//! Atoms of exemplars: what is left of their patches in large cells, and where to find them in their own.

use super::super::plane::Plane;
use super::options::PatchModel;
use crate::dictionary::{
    Choice, Codes, Dictionary, Learning, Origin, PatchShape, Pursuit, Samples, Signs, learn_constrained,
};
use crate::error::{Error, ErrorKind, Result};
use crate::watch::Watch;
use rayon::prelude::*;

/// Patches of all exemplars beyond which they lie further apart: as many as the largest dictionary of the paper's table 2
/// has atoms.
const MOST_PATCHES: usize = 120_000;
/// The same where a few atoms are learned: each turn of learning compares all patches with all others of an atom.
const MOST_EXAMPLES: usize = 8192;
/// Rows of patches that are cut out of an exemplar at once.
const ROWS: usize = 16;
/// Turns of learning.
const ITERATIONS: usize = 5;
/// A patch that is no longer than this is flat: sums of heights have errors of about a thousandth of it.
const FLAT_M: f64 = 1e-4;

/// An exemplar: heights in metres in the cells that are to be made, NaN for voids.
#[derive(Clone, Debug)]
pub(in super::super) struct Source {
    pub(in super::super) rows: usize,
    pub(in super::super) cols: usize,
    pub(in super::super) heights_m: Vec<f32>,
}

/// Where an atom lies, and how its patch is shifted and scaled.
#[derive(Clone, Debug)]
pub(super) struct Atom {
    source: usize,
    corner: [usize; 2],
    /// Weighted mean of the patch in large cells.
    pub(super) mean_m: f64,
    /// Its weighted norm.
    pub(super) norm_m: f64,
}

/// The coarse and the fine dictionary (L, H).
#[derive(Clone, Debug)]
pub(super) struct Pairs {
    sources: Vec<Source>,
    factor: usize,
    shape: PatchShape,
    atoms: Vec<Atom>,
    /// Numbers among all patches of those that learning chose, in its order; nothing where all are taken.
    chosen: Option<Vec<u32>>,
    low: Pursuit,
}

impl Source {
    pub(super) fn of(plane: &Plane) -> Self {
        let heights_m = plane.heights_m().iter().map(|&height| height as f32).collect();
        Self { rows: plane.rows(), cols: plane.cols(), heights_m }
    }

    /// With cells so many times as large.
    pub(super) fn averaged(&self, factor: usize) -> Self {
        let heights_m = self.heights_m.iter().map(|&height| f64::from(height)).collect();
        Self::of(&Plane::new(self.rows, self.cols, heights_m).averaged(factor))
    }

    /// Corners of the patches of a side that lie in it, so many cells from each other, along both axes.
    fn corners(&self, side: usize, stride: usize) -> [std::iter::StepBy<std::ops::Range<usize>>; 2] {
        [self.rows, self.cols].map(|cells| (0..(cells + 1).saturating_sub(side)).step_by(stride))
    }

    /// Sums over the rectangles from the first cell to each, with a row and a column of zeros before them, and how many
    /// voids these have (nothing where there are none).
    fn sums(&self) -> (Vec<f64>, Vec<u32>) {
        let width = self.cols + 1;
        let has_voids = self.heights_m.iter().any(|height| height.is_nan());
        let mut sums = vec![0.0; (self.rows + 1) * width];
        let mut voids = vec![0; if has_voids { sums.len() } else { 0 }];
        for row in 0..self.rows {
            let (mut sum, mut count) = (0.0, 0);
            for (col, &height) in self.heights_m[row * self.cols..][..self.cols].iter().enumerate() {
                let at = (row + 1) * width + col + 1;
                sum += if height.is_nan() { 0.0 } else { f64::from(height) };
                sums[at] = sums[at - width] + sum;
                if has_voids {
                    count += u32::from(height.is_nan());
                    voids[at] = voids[at - width] + count;
                }
            }
        }
        (sums, voids)
    }

    /// The patches without voids and with relief, in large cells: their values, one patch behind the other, and what they
    /// are atoms of.
    fn patches(&self, number: usize, shape: &PatchShape, factor: usize, stride: usize) -> (Vec<f32>, Vec<Atom>) {
        let (sums, voids) = self.sums();
        let width = self.cols + 1;
        let side = shape.side();
        let cells = (factor * factor) as f64;
        let weight: f64 = shape.weights().iter().sum();
        let [rows, cols] = self.corners(side * factor, stride);
        let line = |row: usize| {
            let (mut values, mut atoms) = (vec![], vec![]);
            let mut patch = vec![0.0; shape.values()];
            for col in cols.clone() {
                let end = (row + side * factor) * width + col;
                if !voids.is_empty() {
                    let (start, across) = (row * width + col, side * factor);
                    if voids[end + across] + voids[start] != voids[start + across] + voids[end] {
                        continue;
                    }
                }
                for (k, value) in patch.iter_mut().enumerate() {
                    let start = (row + k / side * factor) * width + col + k % side * factor;
                    let end = start + factor * width;
                    *value = ((sums[end + factor] - sums[end]) - (sums[start + factor] - sums[start])) / cells;
                }
                let mean = |patch: &[f64]| shape.weights().iter().zip(patch).map(|(w, v)| w * v).sum::<f64>() / weight;
                let mean_m = mean(&patch);
                let square = |v: f64| (v - mean_m) * (v - mean_m);
                let norm_m = shape.weights().iter().zip(&patch).map(|(w, &v)| w * square(v)).sum::<f64>().sqrt();
                if norm_m > FLAT_M {
                    values.extend(patch.iter().map(|v| (v - mean_m) as f32));
                    atoms.push(Atom { source: number, corner: [row, col], mean_m, norm_m });
                }
            }
            (values, atoms)
        };
        let rows: Vec<usize> = rows.collect();
        let (mut values, mut atoms) = (vec![], vec![]);
        // Some rows at a time, so that no second copy of all is there at once.
        for rows in rows.chunks(ROWS) {
            let lines: Vec<(Vec<f32>, Vec<Atom>)> = rows.par_iter().map(|&row| line(row)).collect();
            for (own, found) in lines {
                values.extend(own);
                atoms.extend(found);
            }
        }
        (values, atoms)
    }
}

impl Pairs {
    /// All patches of exemplars, or those that learning chooses, or once more those that it `chose`.
    ///
    /// # Errors
    /// When no exemplar is as large as a patch, all are flat or void, the job is cancelled, or what was chosen is not
    /// there.
    pub(super) fn new(
        sources: Vec<Source>,
        factor: usize,
        model: &PatchModel,
        chose: Option<Vec<u32>>,
        watch: &Watch,
    ) -> Result<Self> {
        let shape = PatchShape::new(model.side)?;
        let stride = stride(&sources, model.side * factor, model)?;
        let (mut values, mut atoms) = (vec![], vec![]);
        for (number, source) in sources.iter().enumerate() {
            let (own, found) = source.patches(number, &shape, factor, stride);
            values.extend(own);
            atoms.extend(found);
        }
        if atoms.is_empty() {
            let message = "the exemplars teach nothing: each of their patches is flat or has voids";
            return Err(Error::new(ErrorKind::Input, message));
        }
        let origin = |atom: &Atom| Origin::Patch {
            source: atom.source as u32,
            corner: (atom.corner[0] as i64, atom.corner[1] as i64),
            norm_m: atom.norm_m,
        };
        let names: Vec<String> = (1..=sources.len()).map(|number| format!("exemplar {number}")).collect();
        let origins = atoms.iter().map(origin).collect();
        let mut chosen = None;
        let low = match model.atoms {
            None => {
                for (values, atom) in values.chunks_exact_mut(shape.values()).zip(&atoms) {
                    values.iter_mut().for_each(|v| *v = (f64::from(*v) / atom.norm_m) as f32);
                }
                Dictionary::from_values(model.side, values, origins, names)?
            }
            Some(count) => {
                let how =
                    Learning { iterations: ITERATIONS, sparsity: model.sparsity, choice: Choice::SmallestResidual };
                let samples = Samples::from_values(model.side, values, origins, names)?;
                let all = samples.clone().into_dictionary();
                let found = match chose {
                    Some(chose) => chose,
                    None => {
                        let low = learn_constrained(&samples, &all, (count, model.seed), &how, watch)?.dictionary;
                        let place = |k: usize| match low.origin(k) {
                            Origin::Patch { source, corner, .. } => {
                                (*source as usize, [corner.0 as usize, corner.1 as usize])
                            }
                            _ => unreachable!("candidates are patches"),
                        };
                        // They are in this order already.
                        let found = |k| atoms.binary_search_by_key(&place(k), |atom| (atom.source, atom.corner)).ok();
                        (0..low.len()).filter_map(found).map(|at| at as u32).collect()
                    }
                };
                if found.is_empty() || found.iter().any(|&at| at as usize >= atoms.len()) {
                    let message = format!("an atom is none of the {} patches of the exemplars", atoms.len());
                    return Err(Error::new(ErrorKind::Corrupt, message));
                }
                let own = |at: &u32| all.atom(*at as usize).to_vec();
                let values = found.iter().flat_map(own).collect();
                let origins = found.iter().map(|&at| all.origin(at as usize).clone()).collect();
                let low = Dictionary::from_values(model.side, values, origins, all.sources().to_vec())?;
                atoms = found.iter().map(|&at| atoms[at as usize].clone()).collect();
                chosen = Some(found);
                low
            }
        };
        let signs = if model.signed { Signs::Both } else { Signs::Positive };
        let pursuit = Pursuit::new(&low, model.sparsity, Choice::SmallestResidual)?.with_signs(signs)?;
        debug_assert_eq!(low.len(), atoms.len(), "an atom each");
        Ok(Self { sources, factor, shape, atoms, chosen, low: pursuit })
    }

    pub(super) fn factor(&self) -> usize {
        self.factor
    }

    pub(super) fn sources(&self) -> &[Source] {
        &self.sources
    }

    pub(super) fn chosen(&self) -> Option<&[u32]> {
        self.chosen.as_deref()
    }

    pub(super) fn shape(&self) -> &PatchShape {
        &self.shape
    }

    pub(super) fn len(&self) -> usize {
        self.atoms.len()
    }

    pub(super) fn bytes(&self) -> usize {
        let heights: usize = self.sources.iter().map(|source| source.heights_m.len()).sum();
        let values = self.atoms.len() * self.shape.disc_values();
        (heights + values) * size_of::<f32>() + self.atoms.len() * size_of::<Atom>()
    }

    /// Atoms of patches in large cells, which lie one behind the other as values above their means.
    pub(super) fn matched(&self, values: &[f32]) -> Codes {
        self.low.decompose_values(values)
    }

    pub(super) fn atom(&self, atom: u32) -> &Atom {
        &self.atoms[atom as usize]
    }

    /// A row of an atom's patch in fine cells, in metres.
    #[inline(always)]
    pub(super) fn fine_row(&self, atom: &Atom, row: usize) -> &[f32] {
        let source = &self.sources[atom.source];
        let start = (atom.corner[0] + row) * source.cols + atom.corner[1];
        &source.heights_m[start..start + self.shape.side() * self.factor]
    }
}

/// Most patches of so many exemplars.
pub(in super::super) fn most_patches(model: &PatchModel, sources: usize) -> usize {
    let usual = if model.atoms.is_some() { MOST_EXAMPLES } else { MOST_PATCHES };
    // Exemplars are many only in theory; each has a patch at any stride.
    model.patches.unwrap_or(usual).max(sources)
}

/// From one patch of the exemplars to the next, in their cells: the least with which there are not too many.
fn stride(sources: &[Source], side: usize, model: &PatchModel) -> Result<usize> {
    let count = |stride: usize| -> usize {
        let each = sources.iter().map(|source| source.corners(side, stride).map(Iterator::count));
        each.map(|[rows, cols]| rows * cols).sum()
    };
    if count(1) == 0 {
        let most = sources.iter().max_by_key(|source| source.rows.min(source.cols));
        let (rows, cols) = most.map_or((0, 0), |source| (source.rows, source.cols));
        let message = format!(
            "the exemplars are smaller than a patch: {cols} x {rows} cells, and a patch is {side} x {side} of them; take a \
             smaller --patch or --factor, or larger exemplars"
        );
        return Err(Error::new(ErrorKind::Input, message));
    }
    let most = most_patches(model, sources.len());
    Ok((1..).find(|&stride| count(stride) <= most).unwrap_or(1))
}
