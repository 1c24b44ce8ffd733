//! Sparse coefficients: for each patch a few atoms and their parts.

use crate::error::{Error, ErrorKind, Result};
use rayon::prelude::*;

/// The coefficients of patches, the paper's matrix X by columns: each patch has at most `sparsity` pairs of an atom
/// and its coefficient.
#[derive(Clone, Debug, PartialEq)]
pub struct Codes {
    sparsity: usize,
    counts: Vec<u32>,
    // A patch's pairs begin at its number times the sparsity.
    atoms: Vec<u32>,
    parts: Vec<f64>,
}

impl Codes {
    /// Codes without any atom, for so many patches.
    pub(super) fn new(patches: usize, sparsity: usize) -> Self {
        Self {
            sparsity,
            counts: vec![0; patches],
            atoms: vec![0; patches * sparsity],
            parts: vec![0.0; patches * sparsity],
        }
    }

    /// Codes that come from elsewhere (a file): for each patch its atoms with their coefficients.
    ///
    /// # Errors
    /// When a patch has more than `sparsity` of them, or a coefficient is not finite; the place names the patch.
    pub fn from_pairs(sparsity: usize, patches: &[Vec<(u32, f64)>]) -> Result<Self> {
        let mut codes = Self::new(patches.len(), sparsity);
        for (i, pairs) in patches.iter().enumerate() {
            let (atoms, parts): (Vec<u32>, Vec<f64>) = pairs.iter().copied().unzip();
            let refused = match parts.iter().find(|part| !part.is_finite()) {
                Some(part) => Some(format!("a coefficient of {part}")),
                None if pairs.len() > sparsity => Some(format!("{} atoms, more than {sparsity}", pairs.len())),
                None => None,
            };
            if let Some(message) = refused {
                return Err(Error::new(ErrorKind::Corrupt, message).at_place(format!("patch {i}")));
            }
            codes.set(i, &atoms, &parts);
        }
        Ok(codes)
    }

    /// Most atoms of a patch, the paper's s.
    pub fn sparsity(&self) -> usize {
        self.sparsity
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.counts.len()
    }

    /// Whether there is no patch.
    pub fn is_empty(&self) -> bool {
        self.counts.is_empty()
    }

    /// The atoms of a patch, and the coefficient of each (metres, as atoms have none).
    pub fn get(&self, patch: usize) -> (&[u32], &[f64]) {
        let (start, count) = (patch * self.sparsity, self.counts[patch] as usize);
        (&self.atoms[start..start + count], &self.parts[start..start + count])
    }

    /// Sets the atoms of a patch.
    pub(super) fn set(&mut self, patch: usize, atoms: &[u32], parts: &[f64]) {
        let mut blocks =
            Block { sparsity: self.sparsity, counts: &mut self.counts, atoms: &mut self.atoms, parts: &mut self.parts };
        blocks.set(patch, atoms, parts);
    }

    /// The codes of so many patches at a time, to be set side by side.
    pub(super) fn blocks_mut(&mut self, patches: usize) -> impl IndexedParallelIterator<Item = Block<'_>> {
        let sparsity = self.sparsity;
        let pairs = self.atoms.par_chunks_mut(patches * sparsity).zip(self.parts.par_chunks_mut(patches * sparsity));
        let blocks = self.counts.par_chunks_mut(patches).zip(pairs);
        blocks.map(move |(counts, (atoms, parts))| Block { sparsity, counts, atoms, parts })
    }

    /// One coefficient of a patch, to be changed.
    pub(super) fn part_mut(&mut self, patch: usize, slot: usize) -> &mut f64 {
        &mut self.parts[patch * self.sparsity + slot]
    }

    /// Number of coefficients of all patches.
    pub fn coefficients(&self) -> usize {
        self.counts.iter().map(|&count| count as usize).sum()
    }

    /// For each of `atoms` atoms, the patches that use it with the slot where they do, in the order of patches.
    pub(super) fn users(&self, atoms: usize) -> Vec<Vec<(u32, u32)>> {
        let mut users = vec![vec![]; atoms];
        for patch in 0..self.len() {
            for (slot, &atom) in self.get(patch).0.iter().enumerate() {
                users[atom as usize].push((patch as u32, slot as u32));
            }
        }
        users
    }
}

/// The codes of some patches that follow each other.
pub(super) struct Block<'a> {
    sparsity: usize,
    counts: &'a mut [u32],
    atoms: &'a mut [u32],
    parts: &'a mut [f64],
}

impl Block<'_> {
    /// Sets the atoms of a patch, counted from the block's first.
    pub(super) fn set(&mut self, patch: usize, atoms: &[u32], parts: &[f64]) {
        let start = patch * self.sparsity;
        self.counts[patch] = atoms.len() as u32;
        self.atoms[start..start + atoms.len()].copy_from_slice(atoms);
        self.parts[start..start + parts.len()].copy_from_slice(parts);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_of_files_are_checked() {
        let codes = Codes::from_pairs(2, &[vec![(3, 1.5)], vec![], vec![(1, 2.0), (0, -1.0)]]).unwrap();
        assert_eq!((codes.len(), codes.coefficients()), (3, 3));
        assert_eq!(codes.get(2), (&[1, 0][..], &[2.0, -1.0][..]));
        assert_eq!(codes.users(4), [vec![(2, 1)], vec![(2, 0)], vec![], vec![(0, 0)]]);
        for bad in [vec![(0, 1.0); 3], vec![(0, f64::NAN)]] {
            let error = Codes::from_pairs(2, &[vec![], bad]).unwrap_err();
            assert_eq!((error.kind(), error.place()), (ErrorKind::Corrupt, Some("patch 1")));
        }
    }
}
