//! Sparse coefficients: for each patch a few atoms and their parts.

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
        let start = patch * self.sparsity;
        self.counts[patch] = atoms.len() as u32;
        self.atoms[start..start + atoms.len()].copy_from_slice(atoms);
        self.parts[start..start + parts.len()].copy_from_slice(parts);
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
