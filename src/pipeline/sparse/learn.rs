//! Dictionaries: learned from rasters into a file, and read from one.
//!
//! A dictionary by itself is a container as any other of the sparse profile: its raster is a gallery, with a patch for
//! each atom.

use super::super::archive::{ByteStream, ContainerOptions, ContainerSource, Target};
use super::model::ModelOptions;
use super::read::Band;
use crate::codec::sparse::{PatchTile, Steps, Term};
use crate::dictionary::{
    Dictionary, Origin, PatchLayout, PatchShape, Patches, Raster, Samples, learn, learn_constrained,
};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::SampleType;
use crate::io::raster::stored::StoredOptions;
use crate::oro::{self, Description, Found, Summary, Writer, encode_patch_chunk};
use crate::units::LengthUnit;
use crate::watch::Watch;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// How finely the atoms of a dictionary are counted that is not made for one raster.
const ATOM_STEP: f64 = 1.0 / 1024.0;
/// What atoms are multiplied with in the gallery, for reliefs that look like hills.
const GALLERY: f64 = 100.0;

/// What to do.
#[derive(Clone, Debug)]
pub struct LearnJob {
    /// Rasters to learn from.
    pub exemplars: Vec<PathBuf>,
    /// What to read of each: one band.
    pub raster: StoredOptions,
    /// Unit of the values; replaces a declared one.
    pub unit: Option<LengthUnit>,
    /// How many atoms of which size, and how long to learn.
    pub model: ModelOptions,
    /// Whether atoms have to be patches as they are found in the exemplars.
    pub constrained: bool,
    /// Bytes of memory that may be used; what is free unless given.
    pub memory: Option<u64>,
}

/// What was done.
#[derive(Debug)]
pub struct LearnReport {
    /// Atoms.
    pub atoms: usize,
    /// Side of each in cells.
    pub side: usize,
    /// Patches that were learned from.
    pub patches: usize,
    /// Part of the patches' square heights that atoms do not explain, after each turn.
    pub unexplained: Vec<f64>,
    /// What was written.
    pub summary: Summary,
    /// How long it took.
    pub time: Duration,
}

/// Runs the job.
///
/// # Errors
/// Anything that is wrong with the inputs, the output or the options; then no file has changed.
pub fn run(job: &LearnJob, target: Target<'_>, watch: &Watch, warn: &mut dyn FnMut(&str)) -> Result<LearnReport> {
    let begun = Instant::now();
    let mut samples = vec![];
    let mut cells_m: Option<f64> = None;
    for path in &job.exemplars {
        let mut band = Band::read(path, &job.raster, job.memory, watch)?;
        to_metres(&mut band, job.unit.as_ref());
        band.notes.iter().for_each(|note| warn(note));
        let found = patches_of(&band, &job.model).map_err(|error| error.at_path(path))?;
        if found.is_empty() {
            warn(&format!("{}: flat or void, nothing is learned from it", path.display()));
        }
        samples.push(found);
        let cell = band.record.transform.map(|transform| transform.0[5].abs());
        if let (Some(first), Some(cell)) = (cells_m, cell)
            && (cell / first - 1.0).abs() > 0.01
        {
            let name = path.display();
            warn(&format!("{name}: cells of {cell}, and of {first} before; atoms are counted in cells"));
        }
        cells_m = cells_m.or(cell);
    }
    let samples = Samples::join(&samples)?;
    let how = job.model.learning();
    let learned = match job.constrained {
        true => {
            let candidates = samples.clone().into_dictionary();
            learn_constrained(&samples, &candidates, (job.model.atoms, job.model.seed), &how, watch)?
        }
        false => learn(&samples, samples.draw(job.model.atoms, job.model.seed)?, &how, watch)?,
    };
    let summary = write_gallery(&learned.dictionary, &job.model, target)?;
    let whole = samples.square_m2();
    Ok(LearnReport {
        atoms: learned.dictionary.len(),
        side: learned.dictionary.side(),
        patches: samples.len(),
        unexplained: learned.error_m2.iter().map(|error| error / whole).collect(),
        summary,
        time: begun.elapsed(),
    })
}

/// Brings values to metres, so that exemplars in feet count for no more than others.
fn to_metres(band: &mut Band, unit: Option<&LengthUnit>) {
    let declared = || band.record.bands.first().and_then(|record| LengthUnit::from_name(&record.unit));
    let metres = unit.cloned().or_else(declared).map_or(1.0, |unit| unit.metres);
    if metres != 1.0 {
        band.values.iter_mut().for_each(|value| *value = (f64::from(*value) * metres) as f32);
    }
}

fn patches_of(band: &Band, model: &ModelOptions) -> Result<Samples> {
    let raster = Raster::new(band.record.height, band.record.width, &band.values)?;
    let layout = PatchLayout::new(raster.rows(), raster.cols(), PatchShape::new(model.side)?, model.step)?;
    Ok(Samples::from_patches(Patches::new(&raster, layout)?, ""))
}

/// Writes a raster with a patch for each atom, from the upper left.
fn write_gallery(dictionary: &Dictionary, model: &ModelOptions, target: Target<'_>) -> Result<Summary> {
    let side = dictionary.side();
    let step = model.step.unwrap_or(side / 2);
    let across = (1..).find(|&across| across * across >= dictionary.len()).unwrap_or(1);
    let down = dictionary.len().div_ceil(across);
    let description = Description::new(across * step, down * step, vec![oro::Band::new(SampleType::F32)]);
    let whole = |value: &f32| (f64::from(*value) / ATOM_STEP).round().clamp(-1e9, 1e9) as i32;
    let kept = oro::Dictionary {
        side,
        step,
        sparsity: 1,
        steps: Steps { mean: 1.0, part: GALLERY, atom: ATOM_STEP },
        atoms: dictionary.values().iter().map(whole).collect(),
        found: Found::default(),
    };
    let (lattice, tiling) = (kept.lattice(&description), description.tiling());
    let name = target.name();
    let at_file = |error: Error| error.at_path(&name);
    let stream = ByteStream::begin(target)?;
    let mut writer = Writer::sparse(stream, description.clone(), kept.clone()).map_err(at_file)?;
    for chunk in 0..tiling.tiles() {
        let place = tiling.place(chunk, 1);
        let shape = tiling.shape(place.col, place.row);
        let (left, top) = (place.col * tiling.side, place.row * tiling.side);
        let cols = lattice.stored_with(left..left + shape.width);
        let rows = lattice.stored_with(top..top + shape.height);
        let mut tile = PatchTile::new(cols.len(), rows.len());
        for row in rows {
            for col in cols.clone() {
                let atom = (row * across + col) as u32;
                let term = [Term { atom, part: 1 }];
                let is_atom = (atom as usize) < dictionary.len();
                tile.push(Some((0, if is_atom { &term[..] } else { &[] })));
            }
        }
        writer.push(&encode_patch_chunk(&description, &kept, place, &tile)?).map_err(at_file)?;
    }
    let (stream, summary) = writer.finish().map_err(at_file)?;
    stream.finish()?;
    Ok(summary)
}

/// The dictionary of a container of the sparse profile.
///
/// # Errors
/// When the file cannot be read or has none.
pub fn read_dictionary(path: &Path) -> Result<Dictionary> {
    let source = ContainerSource::open(path, &ContainerOptions::default())?;
    let Some(found) = source.reader().dictionary() else {
        let message = "the file has no dictionary: it is not of the sparse profile, as `orograph learn` writes it";
        return Err(Error::new(ErrorKind::Input, message).at_path(path));
    };
    let values = found.atoms.iter().map(|&value| (f64::from(value) * found.steps.atom) as f32).collect();
    let origins = vec![Origin::Learned; found.count()];
    Dictionary::from_values(found.side, values, origins, vec![]).map_err(|error| error.at_path(path))
}
