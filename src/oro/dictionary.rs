//! DICT: the dictionary of the sparse profile, and how its atoms make up the raster.

use super::bytes::{Cursor, put_float, put_varint};
use super::description::Description;
use super::directory::SectionType;
use crate::codec::sparse::{Lattice, MAX_ATOM_VALUES, MAX_TERMS, Steps, decode_atoms, encode_atoms};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::SampleType;

/// Longest side of a patch.
const MAX_SIDE: usize = 4096;
/// Fewest cells of a patch's side: its disc has to hold some.
const MIN_SIDE: usize = 3;

/// A dictionary, and what a file of the sparse profile says of its patches.
#[derive(Clone, Debug, PartialEq)]
pub struct Dictionary {
    /// Side of patches and atoms in cells.
    pub side: usize,
    /// From one patch's centre to the next in cells.
    pub step: usize,
    /// Most terms of a patch.
    pub sparsity: usize,
    /// What whole numbers stand for.
    pub steps: Steps,
    /// The atoms' values: squares of `side` by `side`, one behind the other.
    pub atoms: Vec<i32>,
    /// What the encoder found.
    pub found: Found,
}

/// What an encoder measured, in stored values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Found {
    /// The least value of the original.
    pub least: f64,
    /// The greatest.
    pub greatest: f64,
    /// Root of the mean square of the cells' errors.
    pub rmse: f64,
}

impl Dictionary {
    /// Number of atoms.
    pub fn count(&self) -> usize {
        self.atoms.len() / (self.side * self.side).max(1)
    }

    /// Where the patches of a raster lie.
    pub fn lattice(&self, description: &Description) -> Lattice {
        Lattice::new(description.width, description.height, self.side, self.step)
    }

    /// Peak signal to noise ratio in decibels, the peak being the range of the original (paper 001, table 1).
    pub fn psnr_db(&self) -> f64 {
        20.0 * ((self.found.greatest - self.found.least) / self.found.rmse).log10()
    }

    /// Looks whether a container can hold it, with the raster that it is for.
    ///
    /// # Errors
    /// A usage error that says what is wrong.
    pub fn check(&self, description: &Description) -> Result<()> {
        let wrong = |message: String| Err(Error::usage(message));
        if !(MIN_SIDE..=MAX_SIDE).contains(&self.side) || !Lattice::covers(self.side, self.step) {
            return wrong(format!("patches of {} cells every {} cells leave gaps", self.side, self.step));
        }
        let size = self.side * self.side;
        if self.atoms.is_empty() || !self.atoms.len().is_multiple_of(size) || self.atoms.len() > MAX_ATOM_VALUES {
            return wrong(format!("{} values are no atoms of {} x {}", self.atoms.len(), self.side, self.side));
        }
        if self.sparsity > MAX_TERMS {
            return wrong(format!("{} atoms a patch: expected at most {MAX_TERMS}", self.sparsity));
        }
        for (name, step) in [("mean", self.steps.mean), ("coefficient", self.steps.part), ("atom", self.steps.atom)] {
            if !(step > 0.0 && step.is_finite()) {
                return wrong(format!("a step of {step} for the {name}: expected a number above 0"));
            }
        }
        match description.bands.as_slice() {
            [band] if band.rule.sample == SampleType::F32 => Ok(()),
            _ => wrong("the sparse profile holds one band of 32-bit floats".into()),
        }
    }
}

/// The section's bytes.
pub(super) fn write(dictionary: &Dictionary) -> Vec<u8> {
    let mut out = vec![];
    for number in [dictionary.side, dictionary.step, dictionary.count(), dictionary.sparsity] {
        put_varint(&mut out, number as u64);
    }
    let Dictionary { steps, found, .. } = dictionary;
    for value in [steps.mean, steps.part, steps.atom, found.least, found.greatest, found.rmse] {
        put_float(&mut out, value);
    }
    out.extend(encode_atoms(&dictionary.atoms, dictionary.side));
    out
}

/// Reads the section of a file of this description.
pub(super) fn read(bytes: &[u8], description: &Description) -> Result<Dictionary> {
    let mut cursor = Cursor::new(bytes, SectionType::Dictionary.place());
    let side = cursor.varint_in("the side of patches", MIN_SIDE as u64, MAX_SIDE as u64)? as usize;
    let step = cursor.varint_in("the step of patches", 1, side as u64)? as usize;
    let most = (MAX_ATOM_VALUES / (side * side)) as u64;
    let count = cursor.varint_in("the number of atoms", 1, most)? as usize;
    let sparsity = cursor.varint_in("the number of terms", 0, MAX_TERMS as u64)? as usize;
    let mut floats = [0.0; 6];
    for value in &mut floats {
        *value = cursor.float()?;
    }
    let [mean, part, atom, least, greatest, rmse] = floats;
    let place = |error: Error| error.at_place(SectionType::Dictionary.place());
    let atoms = decode_atoms(cursor.rest(), side, count).map_err(place)?;
    let steps = Steps { mean, part, atom };
    let dictionary = Dictionary { side, step, sparsity, steps, atoms, found: Found { least, greatest, rmse } };
    dictionary.check(description).map_err(|error| place(Error::new(ErrorKind::Corrupt, error.message().to_owned())))?;
    Ok(dictionary)
}
