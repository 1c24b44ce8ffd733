//! Dictionaries of two resolutions.

use super::atoms::{Dictionary, Origin, Samples};
use super::patches::Patches;
use super::shape::PatchShape;
use crate::error::{Error, Result};

/// Two dictionaries of the same landforms (H, L), atom by atom: fine ones, and what is left of them in larger cells
/// (paper 001, section 4.1 and figure 10).
///
/// Atoms of `low` have length 1 and no constant part. Those of `high` are shifted and scaled just like them, so that a
/// coefficient of one means the other: averages of `high` over squares of `factor` cells are `low`.
#[derive(Clone, Debug, PartialEq)]
pub struct DictionaryPair {
    low: Dictionary,
    high: Dictionary,
    factor: usize,
}

impl DictionaryPair {
    /// The patches of a fine raster, and the same in cells `factor` times as wide; those without detail at the wider
    /// cells are left out. Voids are at the patch's mean, as in [`Samples`]. `source` names the raster.
    ///
    /// # Errors
    /// When the patches' side is no multiple of the factor, or the wider patches are too small.
    pub fn new(patches: &Patches, factor: usize, source: &str) -> Result<Self> {
        let side = patches.layout().shape().side();
        if factor == 0 || !side.is_multiple_of(factor) {
            return Err(Error::usage(format!("patches of side {side} in cells {factor} times as wide")));
        }
        let shape = PatchShape::new(side / factor)?;
        let mut low = Dictionary::new(shape.side(), vec![source.to_owned()]);
        let mut high = Dictionary::new(side, vec![source.to_owned()]);
        let samples = Samples::new(patches, source);
        for i in 0..samples.len() {
            let fine = samples.patch_m(i);
            let mut wide = averages(fine, side, factor);
            let mean = shape.mean(&wide);
            wide.iter_mut().for_each(|v| *v -= mean);
            let norm_m = shape.norm(&wide);
            let (_, Origin::Patch { source, corner, .. }) = samples.atom(i) else { continue };
            // Rounding alone leaves less than this.
            if norm_m > 1e-6 {
                let origin = Origin::Patch { source, corner, norm_m };
                let wide: Vec<f32> = wide.iter().map(|v| (v / norm_m) as f32).collect();
                let fine: Vec<f32> = fine.iter().map(|&v| ((f64::from(v) - mean) / norm_m) as f32).collect();
                low.push(&wide, origin.clone());
                high.push(&fine, origin);
            }
        }
        Ok(Self { low, high, factor })
    }

    /// The pair of only those atoms that a dictionary has which was learned or drawn from [`DictionaryPair::low`].
    ///
    /// # Errors
    /// When it has an atom that is not of this pair.
    pub fn select(&self, chosen: &Dictionary) -> Result<Self> {
        let mut low = Dictionary::new(self.low.side(), self.low.sources().to_vec());
        let mut high = Dictionary::new(self.high.side(), self.high.sources().to_vec());
        for i in 0..chosen.len() {
            let same = |k: &usize| self.low.origin(*k) == chosen.origin(i) && self.low.atom(*k) == chosen.atom(i);
            let Some(k) = (0..self.low.len()).find(same) else {
                return Err(Error::usage(format!("atom {i} is none of the pair's")));
            };
            low.push(self.low.atom(k), self.low.origin(k).clone());
            high.push(self.high.atom(k), self.high.origin(k).clone());
        }
        Ok(Self { low, high, factor: self.factor })
    }

    /// The atoms in wide cells, for matching.
    pub fn low(&self) -> &Dictionary {
        &self.low
    }

    /// The atoms in fine cells, to be put in their place.
    pub fn high(&self) -> &Dictionary {
        &self.high
    }

    /// Fine cells along a wide one.
    pub fn factor(&self) -> usize {
        self.factor
    }
}

/// Averages over squares of `factor` cells of a square patch.
fn averages(values: &[f32], side: usize, factor: usize) -> Vec<f64> {
    let wide = side / factor;
    let mut sums = vec![0.0; wide * wide];
    for (k, &value) in values.iter().enumerate() {
        sums[k / side / factor * wide + k % side / factor] += f64::from(value);
    }
    let cells = (factor * factor) as f64;
    sums.iter().map(|sum| sum / cells).collect()
}
