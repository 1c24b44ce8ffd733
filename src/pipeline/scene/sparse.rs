//! The sparse profile of a container as a terrain of sparse primitives.

use crate::codec::sparse::Steps;
use crate::dictionary::{Codes, Dictionary, Origin, PatchLayout, PatchShape, SparseTerrain};
use crate::error::{Error, ErrorKind, Result};
use crate::oro::{Place, Reader};
use crate::pipeline::archive::{ContainerOptions, ContainerSource, is_container};
use std::fs::File;
use std::path::Path;

/// The mean of a patch, and its atoms with their coefficients.
type Patch = (f32, Vec<(u32, f64)>);

/// Opens a container of the sparse profile; the error says what to do with others.
///
/// # Errors
/// A file that is missing, damaged, or none of the sparse profile.
pub(super) fn open(path: &Path) -> Result<ContainerSource> {
    let others =
        "it is no .oro file of the sparse profile, as encode --sparse makes; give it to an image, as its heights";
    let refuse = || Error::new(ErrorKind::Input, others).at_path(path);
    if path.is_file() && !is_container(path) {
        return Err(refuse());
    }
    let source = ContainerSource::open(path, &ContainerOptions::default())?;
    if source.reader().dictionary().is_none() {
        return Err(refuse());
    }
    Ok(source)
}

/// The terrain of a container: its patches as they are stored, in the band's stored values.
///
/// # Errors
/// A damaged container.
pub(super) fn read(source: &ContainerSource) -> Result<SparseTerrain> {
    read_from(source.reader()).map_err(|error| error.at_path(&source.path))
}

fn read_from(reader: &Reader<File>) -> Result<SparseTerrain> {
    let stored = reader.dictionary().ok_or_else(|| Error::usage("no dictionary"))?;
    let description = reader.description();
    let (side, Steps { mean, part, atom }) = (stored.side, stored.steps);
    let values: Vec<f32> = stored.atoms.iter().map(|&value| (f64::from(value) * atom) as f32).collect();
    let origins = vec![Origin::Learned; stored.count()];
    let dictionary = Dictionary::from_values(side, values, origins, vec![])?;
    let shape = PatchShape::new(side)?;
    let layout = PatchLayout::new(description.height, description.width, shape, Some(stored.step))?;
    let across = layout.patches().1;
    let mut found: Vec<Option<Patch>> = vec![None; layout.places()];
    let tiling = description.tiling();
    for row in 0..tiling.down() {
        for col in 0..tiling.across() {
            let (tile, [first_col, first_row]) = reader.patches(Place { col, row, band: 0 })?;
            for (k, patch) in tile.patches().enumerate() {
                let Some((count, terms)) = patch else { continue };
                let terms = terms.iter().map(|term| (term.atom, f64::from(term.part) * part)).collect();
                let place = (first_row + k / tile.across) * across + first_col + k % tile.across;
                found[place] = Some(((f64::from(count) * mean) as f32, terms));
            }
        }
    }
    let (mut places, mut means, mut pairs) = (vec![], vec![], vec![]);
    for (place, patch) in found.into_iter().enumerate() {
        if let Some((mean, terms)) = patch {
            places.push(place as u32);
            means.push(mean);
            pairs.push(terms);
        }
    }
    let codes = Codes::from_pairs(stored.sparsity, &pairs)?;
    SparseTerrain::new(layout, &places, means, &codes, dictionary)
}
