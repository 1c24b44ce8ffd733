//! Dictionaries: atoms, and where each of them comes from.

use super::noise_atom::NoiseAtom;
use super::patches::Patches;
use super::shape::PatchShape;
use crate::error::{Error, ErrorKind, Result};
use crate::rng::Rng;

/// Where an atom comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// A patch of a raster, scaled to length 1.
    Patch {
        /// Which of the dictionary's sources.
        source: u32,
        /// Row and column of its square's first cell; negative where it reaches out of the raster.
        corner: (i64, i64),
        /// What length 1 was before: the patch's weighted norm, in metres.
        norm_m: f64,
    },
    /// A combination of patches of one or more sources.
    Learned,
    /// A window of noise, which can be sampled at any resolution.
    Noise(Box<NoiseAtom>),
}

/// Atoms of one shape, each of length 1 and without a constant part (by the disc's weights).
#[derive(Clone, Debug, PartialEq)]
pub struct Dictionary {
    side: usize,
    values: Vec<f32>,
    origins: Vec<Origin>,
    sources: Vec<String>,
}

impl Dictionary {
    /// Most atoms of a dictionary.
    pub const MOST_ATOMS: usize = 1 << 24;

    /// A dictionary without atoms, for patches of a side.
    pub(super) fn new(side: usize, sources: Vec<String>) -> Self {
        Self { side, values: vec![], origins: vec![], sources }
    }

    /// Atoms that come from elsewhere (a file): their values one behind the other, and the origin of each. Lengths
    /// need not be exactly 1.
    ///
    /// # Errors
    /// When values, origins or sources do not match, there are too many, or a value is not finite.
    pub fn from_values(side: usize, values: Vec<f32>, origins: Vec<Origin>, sources: Vec<String>) -> Result<Self> {
        let corrupt = |message: String| Error::new(ErrorKind::Corrupt, message);
        let size = PatchShape::new(side)?.values();
        if origins.len() > Self::MOST_ATOMS || values.len() != origins.len() * size {
            return Err(corrupt(format!("{} values for {} atoms of {size}", values.len(), origins.len())));
        }
        if let Some(at) = values.iter().position(|v| !v.is_finite()) {
            return Err(corrupt(format!("a value of {}", values[at])).at_place(format!("atom {}", at / size)));
        }
        for (i, origin) in origins.iter().enumerate() {
            if let Origin::Patch { source, .. } = origin
                && *source as usize >= sources.len()
            {
                return Err(corrupt(format!("source {source} of {}", sources.len())).at_place(format!("atom {i}")));
            }
        }
        Ok(Self { side, values, origins, sources })
    }

    /// Adds an atom.
    pub(super) fn push(&mut self, values: &[f32], origin: Origin) {
        debug_assert_eq!(values.len(), self.side * self.side, "one patch");
        self.values.extend_from_slice(values);
        self.origins.push(origin);
    }

    /// Puts another atom at a place.
    pub(super) fn replace(&mut self, atom: usize, values: &[f32], origin: Origin) {
        let size = self.side * self.side;
        self.values[atom * size..][..size].copy_from_slice(values);
        self.origins[atom] = origin;
    }

    /// All patches of a raster as atoms, those of length 0 left out (the complete dictionary of paper 001, section
    /// 4.3): a terrain is rebuilt from it with one atom a patch as exactly as `f32` can hold it. `source` names the
    /// raster.
    pub fn complete(patches: &Patches, source: &str) -> Self {
        Samples::gather(patches.clone(), source, true).into_dictionary()
    }

    /// Different dictionaries as one, the atoms in their order.
    ///
    /// # Errors
    /// When there is none, shapes differ, or there are too many atoms.
    pub fn join<'a>(dictionaries: impl IntoIterator<Item = &'a Self>) -> Result<Self> {
        let mut all = dictionaries.into_iter();
        let Some(mut joined) = all.next().cloned() else {
            return Err(Error::usage("a dictionary joined from none"));
        };
        for next in all {
            if next.side != joined.side {
                let message = format!("atoms of side {} and {} in one dictionary", joined.side, next.side);
                return Err(Error::usage(message));
            }
            let sources = join_sources(&mut joined.sources, &next.sources);
            joined.values.extend_from_slice(&next.values);
            joined.origins.extend(next.origins.iter().map(|origin| origin.renumbered(&sources)));
        }
        if joined.len() > Self::MOST_ATOMS {
            return Err(Error::new(ErrorKind::Unsupported, format!("{} atoms in one dictionary", joined.len())));
        }
        Ok(joined)
    }

    /// Some of the atoms, drawn by a seed, none twice; all of them where there are no more.
    pub fn draw(&self, count: usize, seed: u64) -> Self {
        let mut drawn = Self::new(self.side, self.sources.clone());
        for i in draw(self.len(), count, seed) {
            drawn.push(self.atom(i), self.origins[i].clone());
        }
        drawn
    }

    /// Side of the atoms' squares, in values.
    pub fn side(&self) -> usize {
        self.side
    }

    /// Number of atoms, the paper's N.
    pub fn len(&self) -> usize {
        self.origins.len()
    }

    /// Whether there is no atom.
    pub fn is_empty(&self) -> bool {
        self.origins.is_empty()
    }

    /// The values of an atom, row by row.
    pub fn atom(&self, atom: usize) -> &[f32] {
        let size = self.side * self.side;
        &self.values[atom * size..][..size]
    }

    /// The values of all atoms, one behind the other.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Where an atom comes from.
    pub fn origin(&self, atom: usize) -> &Origin {
        &self.origins[atom]
    }

    /// Names of the rasters that [`Origin::Patch`] counts.
    pub fn sources(&self) -> &[String] {
        &self.sources
    }
}

impl Origin {
    /// The same place, with sources that have other numbers.
    fn renumbered(&self, sources: &[u32]) -> Self {
        match self {
            Self::Patch { source, corner, norm_m } => {
                Self::Patch { source: sources[*source as usize], corner: *corner, norm_m: *norm_m }
            }
            other => other.clone(),
        }
    }
}

/// Adds names to others unless they are there, and tells the new number of each.
fn join_sources(all: &mut Vec<String>, more: &[String]) -> Vec<u32> {
    let mut numbers = vec![];
    for name in more {
        let found = all.iter().position(|known| known == name);
        numbers.push(found.unwrap_or(all.len()) as u32);
        if found.is_none() {
            all.push(name.clone());
        }
    }
    numbers
}

/// What a dictionary is learned from: patches of one or more rasters, in metres above their means.
///
/// Only whole patches, as voids in an atom would be invented; where a raster has none, all that it has, with voids
/// at the mean. Patches of length 0 are left out.
#[derive(Clone, Debug)]
pub struct Samples {
    shape: PatchShape,
    values: Vec<f32>,
    origins: Vec<Origin>,
    sources: Vec<String>,
}

impl Samples {
    /// The patches of a raster that is named `source`.
    pub fn new(patches: &Patches, source: &str) -> Self {
        Self::from_patches(patches.clone(), source)
    }

    /// The same of patches that nobody else needs, in their memory.
    pub fn from_patches(patches: Patches, source: &str) -> Self {
        Self::gather(patches, source, false)
    }

    /// Patches that come from elsewhere: their values in metres above their weighted means one behind the other, and
    /// where each comes from, with its weighted norm, in one of the sources.
    ///
    /// # Errors
    /// As [`Dictionary::from_values`]; when one is no patch.
    pub fn from_values(side: usize, values: Vec<f32>, origins: Vec<Origin>, sources: Vec<String>) -> Result<Self> {
        if let Some(i) =
            origins.iter().position(|origin| !matches!(origin, Origin::Patch { norm_m, .. } if *norm_m > 0.0))
        {
            return Err(Error::usage("samples are patches with relief").at_place(format!("sample {i}")));
        }
        let checked = Dictionary::from_values(side, values, origins, sources)?;
        let Dictionary { values, origins, sources, .. } = checked;
        Ok(Self { shape: PatchShape::new(side)?, values, origins, sources })
    }

    /// Whole patches if there are some, or all, voids at the mean.
    fn gather(patches: Patches, source: &str, all: bool) -> Self {
        let shape = patches.layout().shape().clone();
        let all = all || !(0..patches.len()).any(|i| patches.is_whole(i));
        let (mut origins, mut taken) = (vec![], vec![]);
        for i in (0..patches.len()).filter(|&i| all || patches.is_whole(i)) {
            let norm_m = norm_of(&shape, patches.values_m(i));
            if norm_m > 0.0 {
                let corner = patches.layout().corner(patches.places()[i] as usize);
                origins.push(Origin::Patch { source: 0, corner, norm_m });
                taken.push(i);
            }
        }
        let (size, mut values) = (shape.values(), patches.into_values_m());
        for (to, &from) in taken.iter().enumerate() {
            values.copy_within(from * size..(from + 1) * size, to * size);
        }
        values.truncate(taken.len() * size);
        Self { shape, values, origins, sources: vec![source.to_owned()] }
    }

    /// Patches of several rasters together.
    ///
    /// # Errors
    /// When there is none, or shapes differ.
    pub fn join<'a>(samples: impl IntoIterator<Item = &'a Self>) -> Result<Self> {
        let mut all = samples.into_iter();
        let Some(mut joined) = all.next().cloned() else {
            return Err(Error::usage("samples joined from none"));
        };
        for next in all {
            if next.shape != joined.shape {
                let (a, b) = (joined.shape.side(), next.shape.side());
                return Err(Error::usage(format!("patches of side {a} and {b} together")));
            }
            let sources = join_sources(&mut joined.sources, &next.sources);
            joined.values.extend_from_slice(&next.values);
            joined.origins.extend(next.origins.iter().map(|origin| origin.renumbered(&sources)));
        }
        Ok(joined)
    }

    /// The patches' shape.
    pub fn shape(&self) -> &PatchShape {
        &self.shape
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.origins.len()
    }

    /// Whether there is none: everything is flat or void.
    pub fn is_empty(&self) -> bool {
        self.origins.is_empty()
    }

    /// Sum of the weighted squares of all patches, in square metres: what a dictionary without atoms leaves.
    pub fn square_m2(&self) -> f64 {
        let square = |origin: &Origin| match origin {
            Origin::Patch { norm_m, .. } => norm_m * norm_m,
            _ => 0.0,
        };
        self.origins.iter().map(square).sum()
    }

    /// The values of all patches, one behind the other.
    pub(super) fn values_m(&self) -> &[f32] {
        &self.values
    }

    /// The values of a patch.
    pub(super) fn patch_m(&self, i: usize) -> &[f32] {
        let size = self.shape.values();
        &self.values[i * size..][..size]
    }

    /// A patch as an atom: its values with length 1, and where it comes from.
    pub(super) fn atom(&self, i: usize) -> (Vec<f32>, Origin) {
        let Origin::Patch { norm_m, .. } = &self.origins[i] else { unreachable!("samples are patches") };
        let values = self.patch_m(i).iter().map(|&v| (f64::from(v) / norm_m) as f32).collect();
        (values, self.origins[i].clone())
    }

    /// All patches as atoms.
    pub fn into_dictionary(self) -> Dictionary {
        let mut dictionary = Dictionary::new(self.shape.side(), self.sources.clone());
        for i in 0..self.len() {
            let (values, origin) = self.atom(i);
            dictionary.push(&values, origin);
        }
        dictionary
    }

    /// Some patches as atoms, drawn by a seed, none twice; all of them where there are no more.
    ///
    /// # Errors
    /// When no atom is asked for, or more than a dictionary holds, or there is no patch.
    pub fn draw(&self, count: usize, seed: u64) -> Result<Dictionary> {
        if count == 0 || count > Dictionary::MOST_ATOMS {
            let most = Dictionary::MOST_ATOMS;
            return Err(Error::usage(format!("a dictionary of {count} atoms: 1 to {most} are possible")));
        }
        if self.is_empty() {
            return Err(Error::new(ErrorKind::Input, "the terrain is flat or void: there is nothing to learn from"));
        }
        let mut dictionary = Dictionary::new(self.shape.side(), self.sources.clone());
        for i in draw(self.len(), count, seed) {
            let (values, origin) = self.atom(i);
            dictionary.push(&values, origin);
        }
        Ok(dictionary)
    }
}

/// Different numbers below `all`, as many as `count` or all of them, drawn by a seed.
fn draw(all: usize, count: usize, seed: u64) -> Vec<usize> {
    let mut rng = Rng::new(seed);
    let mut order: Vec<usize> = (0..all).collect();
    for i in 0..count.min(all) {
        let other = i + rng.below((all - i) as u64) as usize;
        order.swap(i, other);
    }
    order.truncate(count);
    order
}

/// Weighted norm of a patch whose voids are 0.
fn norm_of(shape: &PatchShape, values: &[f32]) -> f64 {
    shape.weights().iter().zip(values).map(|(w, &v)| w * f64::from(v) * f64::from(v)).sum::<f64>().sqrt()
}
