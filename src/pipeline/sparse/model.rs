//! A raster as whole numbers of means, coefficients and atoms.

use super::steps::{Measure, steps_of};
use crate::codec::sparse::{Blend, Lattice, MAX_TERMS, PatchTile, Steps, Term, blended};
use crate::dictionary::{
    Choice, Decomposition, Dictionary, Learning, Origin, PatchLayout, PatchShape, Patches, Pursuit, Raster, Samples,
    SparseTerrain, difference, learn,
};
use crate::error::{Error, ErrorKind, Result};
use crate::oro;
use crate::watch::Watch;
use rayon::prelude::*;
use std::ops::Range;

/// Mean and terms of a patch.
type Patch = (i32, Vec<Term>);

/// Rows of cells that are blended by one thread at a time.
const STRIP: usize = 64;

/// How a raster is described.
#[derive(Clone, Debug)]
pub struct ModelOptions {
    /// Number of atoms to learn.
    pub atoms: usize,
    /// Most atoms of a patch.
    pub sparsity: usize,
    /// Side of a patch in cells.
    pub side: usize,
    /// From one patch to the next in cells; half a side unless given.
    pub step: Option<usize>,
    /// Turns of learning.
    pub iterations: usize,
    /// What the first atoms are drawn by.
    pub seed: u64,
}

impl Default for ModelOptions {
    fn default() -> Self {
        Self { atoms: 128, sparsity: 2, side: 8, step: None, iterations: 10, seed: 1 }
    }
}

impl ModelOptions {
    /// How a dictionary is learned.
    pub(super) fn learning(&self) -> Learning {
        let choice = Choice::SmallestResidual;
        Learning { iterations: self.iterations, sparsity: self.sparsity.max(1), choice }
    }
}

/// A raster in the words of a container of the sparse profile.
#[derive(Clone, Debug)]
pub struct Model {
    /// The dictionary, with what was found.
    pub dictionary: oro::Dictionary,
    /// What is at each place, row by row.
    patches: Vec<Option<Patch>>,
    lattice: Lattice,
    /// The largest error of a cell.
    pub largest_error: f64,
}

impl Model {
    /// Describes a raster, with atoms learned from it or given.
    ///
    /// `nodata` are the bits of a value that no cell may become.
    ///
    /// # Errors
    /// When an option is out of range, the given atoms are for patches of another side, or the job is cancelled.
    pub fn new(
        raster: &Raster,
        options: &ModelOptions,
        given: Option<&Dictionary>,
        nodata: Option<u32>,
        watch: &Watch,
    ) -> Result<Self> {
        if options.sparsity > MAX_TERMS {
            return Err(Error::usage(format!("{} atoms a patch: expected at most {MAX_TERMS}", options.sparsity)));
        }
        let shape = PatchShape::new(given.map_or(options.side, Dictionary::side))?;
        let layout = PatchLayout::new(raster.rows(), raster.cols(), shape, options.step)?;
        let dictionary = match given {
            Some(given) => given.clone(),
            // Cut out twice: both kinds of patches at once would take twice the memory.
            None => learned(Patches::new(raster, layout.clone())?, options, watch)?,
        };
        let patches = Patches::new(raster, layout)?;
        watch.begin("matching", 2);
        let first = decompose(&patches, &dictionary, options.sparsity)?;
        watch.advance(1)?;
        let steps = steps_of(&measure(raster, &patches, &first, &dictionary)?, patches.layout().shape());
        // Atoms as they will be read: what rounding did to them is then made up for by other coefficients.
        let (atoms, dictionary) = rounded(&dictionary, steps.atom)?;
        let decomposition = decompose(&patches, &dictionary, options.sparsity)?;
        watch.advance(1)?;
        let lattice = patches.layout().lattice();
        let Lattice { side, step, .. } = lattice;
        let found = oro::Found { least: 0.0, greatest: 0.0, rmse: 0.0 };
        let sparsity = options.sparsity;
        let dictionary = oro::Dictionary { side, step, sparsity, steps, atoms, found };
        let patches = whole(&patches, &decomposition, &steps)?;
        let mut model = Self { dictionary, patches, lattice, largest_error: 0.0 };
        model.find_errors(raster, nodata);
        Ok(model)
    }

    /// The patches that are stored with the tile of these columns and rows of cells.
    pub(super) fn tile(&self, cols: Range<usize>, rows: Range<usize>) -> PatchTile {
        let (cols, rows) = (self.lattice.stored_with(cols), self.lattice.stored_with(rows));
        let mut tile = PatchTile::new(cols.len(), rows.len());
        for row in rows {
            for patch in &self.patches[row * self.lattice.across..][cols.clone()] {
                tile.push(patch.as_ref().map(|(mean, terms)| (*mean, terms.as_slice())));
            }
        }
        tile
    }

    /// Number of patches.
    pub fn patches(&self) -> usize {
        self.patches.iter().flatten().count()
    }

    /// Number of coefficients of all patches.
    pub fn terms(&self) -> usize {
        self.patches.iter().flatten().map(|(_, terms)| terms.len()).sum()
    }

    /// Compares what a reader will see with the original.
    fn find_errors(&mut self, raster: &Raster, nodata: Option<u32>) {
        let (cols, rows) = (raster.cols(), raster.rows());
        let strips: Vec<Range<usize>> = (0..rows).step_by(STRIP).map(|row| row..rows.min(row + STRIP)).collect();
        let each = |strip: &Range<usize>| {
            let mut blend = Blend::new(self.lattice, 1, 0..cols, strip.clone());
            for row in blend.places().1 {
                for col in 0..self.lattice.across {
                    if let Some((mean, terms)) = &self.patches[row * self.lattice.across + col] {
                        let patch = (*mean, terms.as_slice());
                        blend.add((row, col), patch, &self.dictionary.atoms, &self.dictionary.steps);
                    }
                }
            }
            let truth = &raster.elevation_m()[strip.start * cols..strip.end * cols];
            let mut found = Errors::NONE;
            for (&truth, height) in truth.iter().zip(blend.cells()).filter(|(truth, _)| !truth.is_nan()) {
                let error = (f64::from(truth) - f64::from(blended(height, nodata))).abs();
                found = found.joined(&Errors {
                    cells: 1,
                    square: error * error,
                    most: error,
                    least: f64::from(truth),
                    greatest: f64::from(truth),
                });
            }
            found
        };
        // In the order of the strips, whatever the threads.
        let found: Vec<Errors> = strips.par_iter().map(each).collect();
        let all = found.iter().fold(Errors::NONE, |all, strip| all.joined(strip));
        self.largest_error = all.most;
        if all.cells > 0 {
            let rmse = (all.square / all.cells as f64).sqrt();
            self.dictionary.found = oro::Found { least: all.least, greatest: all.greatest, rmse };
        }
    }
}

/// Sums over cells.
#[derive(Clone, Copy, Debug)]
struct Errors {
    cells: u64,
    square: f64,
    most: f64,
    least: f64,
    greatest: f64,
}

impl Errors {
    const NONE: Self = Self { cells: 0, square: 0.0, most: 0.0, least: f64::INFINITY, greatest: f64::NEG_INFINITY };

    fn joined(&self, other: &Self) -> Self {
        Self {
            cells: self.cells + other.cells,
            square: self.square + other.square,
            most: self.most.max(other.most),
            least: self.least.min(other.least),
            greatest: self.greatest.max(other.greatest),
        }
    }
}

/// A dictionary learned from patches; where these are flat or void, one atom that nobody uses.
fn learned(patches: Patches, options: &ModelOptions, watch: &Watch) -> Result<Dictionary> {
    let samples = Samples::from_patches(patches, "");
    if samples.is_empty() {
        let side = samples.shape().side();
        return Dictionary::from_values(side, vec![0.0; side * side], vec![Origin::Learned], vec![]);
    }
    let start = samples.draw(options.atoms, options.seed)?;
    Ok(learn(&samples, start, &options.learning(), watch)?.dictionary)
}

/// Atoms and coefficients of all patches; none with a sparsity of 0.
fn decompose(patches: &Patches, dictionary: &Dictionary, sparsity: usize) -> Result<Decomposition> {
    let found = Pursuit::new(dictionary, sparsity.max(1), Choice::SmallestResidual)?.decompose(patches)?;
    if sparsity > 0 {
        return Ok(found);
    }
    let codes = crate::dictionary::Codes::from_pairs(0, &vec![vec![]; patches.len()])?;
    Ok(Decomposition { codes, mean_m: patches.mean_m().to_vec() })
}

/// What steps are chosen by.
fn measure(
    raster: &Raster,
    patches: &Patches,
    decomposition: &Decomposition,
    dictionary: &Dictionary,
) -> Result<Measure> {
    let rebuilt = SparseTerrain::of(patches, decomposition, dictionary.clone())?.raster(1)?;
    let rms = difference(raster.elevation_m(), &rebuilt).map_or(0.0, |found| found.rms_m);
    // NaN is passed over.
    let most = f64::from(raster.elevation_m().iter().fold(0.0_f32, |most, v| most.max(v.abs())));
    let codes = &decomposition.codes;
    let square: f64 = (0..codes.len()).flat_map(|patch| codes.get(patch).1).map(|part| part * part).sum();
    let count = codes.coefficients().max(1) as f64;
    let terms = codes.coefficients() as f64 / codes.len().max(1) as f64;
    Ok(Measure { rms, most, part_rms: (square / count).sqrt(), terms })
}

/// The atoms' values as whole numbers, and the dictionary that these are.
fn rounded(dictionary: &Dictionary, step: f64) -> Result<(Vec<i32>, Dictionary)> {
    // Values of atoms of length 1 are far below what 32 bits hold, unless the weight of a cell is next to nothing.
    let whole = |value: &f32| (f64::from(*value) / step).round().clamp(-1e9, 1e9) as i32;
    let atoms: Vec<i32> = dictionary.values().iter().map(whole).collect();
    let values = atoms.iter().map(|&value| (f64::from(value) * step) as f32).collect();
    let origins = vec![Origin::Learned; dictionary.len()];
    Ok((atoms, Dictionary::from_values(dictionary.side(), values, origins, vec![])?))
}

/// Means and coefficients as whole numbers, place by place; coefficients that become 0 are left out.
fn whole(patches: &Patches, decomposition: &Decomposition, steps: &Steps) -> Result<Vec<Option<Patch>>> {
    let count = |value: f64, step: f64| {
        let count = (value / step).round();
        // Not the least number, which stands for a place without a patch.
        if count.abs() < f64::from(i32::MAX) {
            return Ok(count as i32);
        }
        Err(Error::new(ErrorKind::Unsupported, format!("{value} counted in steps of {step} is beyond 32 bits")))
    };
    let mut places = vec![None; patches.layout().places()];
    for (patch, &place) in patches.places().iter().enumerate() {
        let (atoms, parts) = decomposition.codes.get(patch);
        let mut terms = vec![];
        for (&atom, &part) in atoms.iter().zip(parts) {
            let part = count(part, steps.part)?;
            if part != 0 {
                terms.push(Term { atom, part });
            }
        }
        places[place as usize] = Some((count(decomposition.mean_m[patch], steps.mean)?, terms));
    }
    Ok(places)
}
