//! A terrain of sparse primitives, to be evaluated anywhere.

use super::atoms::{Dictionary, Origin};
use super::codes::Codes;
use super::layout::PatchLayout;
use super::patches::Patches;
use super::pursuit::Decomposition;
use crate::codec::sparse::fall_off;
use crate::error::{Error, ErrorKind, Result};
use crate::linalg::vectorised;
use rayon::prelude::*;

/// No patch at a place.
const NONE: u32 = u32::MAX;

/// A terrain as discs of atoms (paper 001, section 4.1): f = Σ fᵢ αᵢ / Σ αᵢ, where the elevation of a disc is its mean
/// plus its atoms by their coefficients, and its weight αᵢ = (1 - r²)³.
///
/// Positions are rows and columns of the raster that it was made from, as fractions; whole numbers are corners of
/// cells, (0.5, 0.5) the centre of the first. Atoms of noise are functions. Atoms of values are interpolated between
/// them by cubics (Catmull and Rom 1974; values beyond the square's side repeat), which go through the values and
/// have continuous slopes. So at the raster's own centres the terrain is the blend of values alone.
///
/// The dictionary may be finer than the layout's patches, by a whole number (see [`super::DictionaryPair`]).
#[derive(Clone, Debug, PartialEq)]
pub struct SparseTerrain {
    layout: PatchLayout,
    dictionary: Dictionary,
    // Samples of atoms for each cell, in one direction.
    factor: usize,
    // The patch at each place.
    patch_at: Vec<u32>,
    mean_m: Vec<f32>,
    starts: Vec<u32>,
    atoms: Vec<u32>,
    parts_m: Vec<f32>,
}

impl SparseTerrain {
    /// A terrain of the patches at some places: the mean of each, its atoms and their coefficients.
    ///
    /// # Errors
    /// When numbers of patches differ, places are not in rising order within the layout, there is an atom that the
    /// dictionary does not have, or its side is no multiple of the layout's.
    pub fn new(
        layout: PatchLayout,
        places: &[u32],
        mean_m: Vec<f32>,
        codes: &Codes,
        dictionary: Dictionary,
    ) -> Result<Self> {
        let corrupt = |message: String| Error::new(ErrorKind::Corrupt, message);
        let side = layout.shape().side();
        let factor = dictionary.side() / side;
        if factor == 0 || factor * side != dictionary.side() {
            return Err(corrupt(format!("atoms of side {} for patches of side {side}", dictionary.side())));
        }
        if places.len() != mean_m.len() || places.len() != codes.len() {
            let (p, m, c) = (places.len(), mean_m.len(), codes.len());
            return Err(corrupt(format!("{p} places, {m} means and the atoms of {c} patches")));
        }
        if codes.coefficients() >= NONE as usize {
            return Err(Error::new(ErrorKind::Unsupported, "a terrain of 2^32 coefficients or more"));
        }
        let mut patch_at = vec![NONE; layout.places()];
        let (mut starts, mut atoms, mut parts_m) = (vec![0], vec![], vec![]);
        for (i, &place) in places.iter().enumerate() {
            if place as usize >= patch_at.len() || (i > 0 && places[i - 1] >= place) {
                return Err(corrupt(format!("patch {i} at place {place} of {}", patch_at.len())));
            }
            patch_at[place as usize] = i as u32;
            let (used, parts) = codes.get(i);
            if let Some(&atom) = used.iter().find(|&&atom| atom as usize >= dictionary.len()) {
                return Err(corrupt(format!("patch {i} uses atom {atom} of {}", dictionary.len())));
            }
            atoms.extend_from_slice(used);
            parts_m.extend(parts.iter().map(|&v| v as f32));
            starts.push(atoms.len() as u32);
        }
        Ok(Self { layout, dictionary, factor, patch_at, mean_m, starts, atoms, parts_m })
    }

    /// The terrain that patches are decomposed into.
    ///
    /// # Errors
    /// As [`SparseTerrain::new`].
    pub fn of(patches: &Patches, decomposition: &Decomposition, dictionary: Dictionary) -> Result<Self> {
        let mean_m = decomposition.mean_m.iter().map(|&v| v as f32).collect();
        Self::new(patches.layout().clone(), patches.places(), mean_m, &decomposition.codes, dictionary)
    }

    /// The same with other atoms in the place of those that it has, one for one: finer ones of a pair.
    ///
    /// # Errors
    /// When the numbers of atoms differ, or the other's side is no multiple of the patches'.
    pub fn with_dictionary(self, dictionary: Dictionary) -> Result<Self> {
        let side = self.layout.shape().side();
        if dictionary.len() != self.dictionary.len()
            || dictionary.side() < side
            || !dictionary.side().is_multiple_of(side)
        {
            let (n, m, other) = (self.dictionary.len(), dictionary.len(), dictionary.side());
            let message = format!("{m} atoms of side {other} in the place of {n} for patches of side {side}");
            return Err(Error::usage(message));
        }
        Ok(Self { factor: dictionary.side() / side, dictionary, ..self })
    }

    /// Where the discs lie.
    pub fn layout(&self) -> &PatchLayout {
        &self.layout
    }

    /// The atoms.
    pub fn dictionary(&self) -> &Dictionary {
        &self.dictionary
    }

    /// Samples of atoms for each cell, in one direction.
    pub fn factor(&self) -> usize {
        self.factor
    }

    /// Bytes of memory beside itself.
    pub fn bytes(&self) -> usize {
        size_of_val(self.dictionary.values())
            + size_of_val(&self.patch_at[..])
            + size_of_val(&self.mean_m[..])
            + size_of_val(&self.starts[..])
            + size_of_val(&self.atoms[..])
            + size_of_val(&self.parts_m[..])
    }

    /// Number of discs.
    pub fn patches(&self) -> usize {
        self.mean_m.len()
    }

    /// Mean of a disc in metres, its atoms and their coefficients in metres.
    pub fn patch(&self, patch: usize) -> (f32, &[u32], &[f32]) {
        let (start, end) = (self.starts[patch] as usize, self.starts[patch + 1] as usize);
        (self.mean_m[patch], &self.atoms[start..end], &self.parts_m[start..end])
    }

    /// The disc at a place of the layout, if there is one.
    pub fn patch_at(&self, place: usize) -> Option<usize> {
        self.patch_at.get(place).filter(|&&patch| patch != NONE).map(|&patch| patch as usize)
    }

    /// Elevation in metres at a row and column; `None` where no disc reaches.
    ///
    /// # Complexity
    /// About four discs, times the atoms of each.
    pub fn elevation_m(&self, row: f64, col: f64) -> Option<f64> {
        let radius = self.layout.shape().radius_cells();
        let [down, across] = self.layout.places_at((row, row), (col, col));
        let (mut sum, mut weights) = (0.0, 0.0);
        for i in down {
            for j in across.clone() {
                let place = i * self.layout.patches().1 + j;
                let Some(patch) = self.patch_at(place) else { continue };
                let (top, left) = self.layout.corner(place);
                let (y, x) = (row - top as f64, col - left as f64);
                let weight = fall_off(x - radius, y - radius, radius);
                if weight > 0.0 {
                    let (mean, atoms, parts) = self.patch(patch);
                    let mut elevation = f64::from(mean);
                    for (&atom, &part) in atoms.iter().zip(parts) {
                        elevation += f64::from(part) * self.atom_value(atom as usize, x, y);
                    }
                    sum += weight * elevation;
                    weights += weight;
                }
            }
        }
        (weights > 0.0).then(|| sum / weights)
    }

    /// The value of an atom at a point of its square, counted in cells of the layout from its corner.
    pub fn atom_value(&self, atom: usize, x: f64, y: f64) -> f64 {
        if let Origin::Noise(noise) = self.dictionary.origin(atom) {
            let radius = self.layout.shape().radius_cells();
            return noise.value(x / radius - 1.0, y / radius - 1.0);
        }
        let (values, side) = (self.dictionary.atom(atom), self.dictionary.side());
        let (cols, by_col) = cubic(x * self.factor as f64 - 0.5, side);
        let (rows, by_row) = cubic(y * self.factor as f64 - 0.5, side);
        let mut sum = 0.0;
        for (&row, by_row) in rows.iter().zip(by_row) {
            let line = &values[row * side..][..side];
            let along: f64 = cols.iter().zip(by_col).map(|(&col, by_col)| by_col * f64::from(line[col])).sum();
            sum += by_row * along;
        }
        sum
    }

    /// The terrain as a raster, with so many rows and columns in each of its cells; NaN where no disc reaches.
    ///
    /// Where that is as fine as the atoms' values these are taken as they are, and of atoms of noise too.
    ///
    /// # Errors
    /// When it is 0 or the raster too large for any memory.
    pub fn raster(&self, per_cell: usize) -> Result<Vec<f32>> {
        let (rows, cols) = (self.layout.rows().checked_mul(per_cell), self.layout.cols().checked_mul(per_cell));
        let cells = rows.zip(cols).and_then(|(rows, cols)| rows.checked_mul(cols)).filter(|&n| n > 0 && n < 1 << 40);
        let (Some(cells), Some(cols)) = (cells, cols) else {
            return Err(Error::usage(format!("a raster of {per_cell} by {per_cell} points a cell")));
        };
        let mut out = vec![f32::NAN; cells];
        let weights = (per_cell == self.factor).then(|| self.weights());
        out.par_chunks_mut(cols).enumerate().for_each(|(row, line)| match &weights {
            Some(weights) => vectorised(
                #[inline(always)]
                || self.blend_values(row, line, weights),
            ),
            None => {
                let centre = |i: usize| (i as f64 + 0.5) / per_cell as f64;
                for (col, out) in line.iter_mut().enumerate() {
                    *out = self.elevation_m(centre(row), centre(col)).map_or(f32::NAN, |v| v as f32);
                }
            }
        });
        Ok(out)
    }

    /// The weights of a disc at the places of the atoms' values.
    fn weights(&self) -> Vec<f64> {
        let (side, radius) = (self.dictionary.side(), self.layout.shape().radius_cells());
        let at = |i: usize| (i as f64 + 0.5) / self.factor as f64 - radius;
        (0..side * side).map(|k| fall_off(at(k % side), at(k / side), radius)).collect()
    }

    /// One row of the raster that is as fine as the atoms.
    #[inline(always)]
    fn blend_values(&self, row: usize, line: &mut [f32], disc: &[f64]) {
        let (side, factor) = (self.dictionary.side(), self.factor as i64);
        let y = (row as f64 + 0.5) / self.factor as f64;
        let [down, across] = self.layout.places_at((y, y), (0.0, self.layout.cols() as f64));
        let (mut sums, mut weights) = (vec![0.0; line.len()], vec![0.0; line.len()]);
        let mut elevations = vec![0.0; side];
        for i in down {
            for j in across.clone() {
                let place = i * self.layout.patches().1 + j;
                let Some(patch) = self.patch_at(place) else { continue };
                let (top, left) = self.layout.corner(place);
                let (within, left) = (row as i64 - top * factor, left * factor);
                if !(0..side as i64).contains(&within) {
                    continue;
                }
                let (from, to) = (left.max(0), (left + side as i64).min(line.len() as i64));
                if from >= to {
                    continue;
                }
                let start = within as usize * side + (from - left) as usize;
                let count = (to - from) as usize;
                let elevations = &mut elevations[..count];
                let (mean, atoms, parts) = self.patch(patch);
                elevations.fill(f64::from(mean));
                for (&atom, &part) in atoms.iter().zip(parts) {
                    let values = &self.dictionary.atom(atom as usize)[start..][..count];
                    for (elevation, &value) in elevations.iter_mut().zip(values) {
                        *elevation += f64::from(part) * f64::from(value);
                    }
                }
                let disc = &disc[start..][..count];
                let sums = &mut sums[from as usize..to as usize];
                for ((sum, elevation), weight) in sums.iter_mut().zip(elevations.iter()).zip(disc) {
                    *sum += weight * elevation;
                }
                for (sum, weight) in weights[from as usize..to as usize].iter_mut().zip(disc) {
                    *sum += weight;
                }
            }
        }
        for ((out, sum), weight) in line.iter_mut().zip(sums).zip(weights) {
            *out = if weight > 0.0 { (sum / weight) as f32 } else { f32::NAN };
        }
    }
}

/// The four values of `count` around a position, and their parts in its value (Catmull and Rom 1974).
pub(super) fn cubic(at: f64, count: usize) -> ([usize; 4], [f64; 4]) {
    let floor = at.floor();
    let t = at - floor;
    let place = |offset: i64| (floor as i64 + offset).clamp(0, count as i64 - 1) as usize;
    let parts = [
        ((1.0 - 0.5 * t) * t - 0.5) * t,
        (1.5 * t - 2.5) * t * t + 1.0,
        ((2.0 - 1.5 * t) * t + 0.5) * t,
        (0.5 * t - 0.5) * t * t,
    ];
    ([place(-1), place(0), place(1), place(2)], parts)
}

/// Derivatives of the parts of [`cubic`] by the position.
pub(super) fn cubic_slopes(at: f64) -> [f64; 4] {
    let t = at - at.floor();
    [(-1.5 * t + 2.0) * t - 0.5, (4.5 * t - 5.0) * t, (-4.5 * t + 4.0) * t + 0.5, (1.5 * t - 1.0) * t]
}
