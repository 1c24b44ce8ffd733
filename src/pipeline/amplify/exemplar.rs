//! Exemplars, brought to the cells that are to be made.

use super::cell_size::CellSize;
use super::likeness::{median_slope, remark};
use super::resample::resampled;
use crate::amplify::Plane;
use crate::error::Result;
use crate::io::raster::RasterOptions;
use crate::pipeline::archive::open_dem;
use crate::pipeline::memory;
use crate::watch::Watch;
use std::path::Path;

/// What is to be made of an exemplar.
pub(super) struct Wanted {
    /// The cells of the input.
    pub(super) input: CellSize,
    /// How many times finer they become.
    pub(super) factor: usize,
    /// The cells that are made of them.
    pub(super) made: CellSize,
    /// The input's median slope.
    pub(super) slope: Option<f64>,
    /// Bytes that an exemplar's cell takes while it is learned from.
    pub(super) bytes_per_cell: u64,
    /// Bytes of memory that may be used; what is free unless given.
    pub(super) memory: Option<u64>,
}

/// What is known of an exemplar once it was learned from.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Record {
    /// The file's name without its folder.
    pub(super) name: String,
    /// Rows and columns.
    pub(super) size: [usize; 2],
    /// Its own cells.
    pub(super) cell: CellSize,
    /// Its median slope in cells of the input's size.
    pub(super) slope: Option<f64>,
}

/// The size of an exemplar's cells.
///
/// # Errors
/// When it cannot be opened.
pub(super) fn cell_of(path: &Path, memory: Option<u64>, watch: &Watch) -> Result<CellSize> {
    let source = open_dem(path, &RasterOptions::default(), memory, watch)?;
    let [_, _, cols, rows] = source.window;
    Ok(CellSize::of(&source.transform, source.crs.as_ref(), rows, cols))
}

/// A file's name without its folder.
pub(super) fn name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// Reads an exemplar and gives it the cells that are wanted, in metres. Where these are not square there are two: as it
/// lies, and with rows as columns.
///
/// An exemplar with larger cells than those to be made keeps its own: terrain is much the same at scales that are not
/// far from each other, and finer cells of it would hold no more detail. Where only one axis has larger cells, as with
/// cells of degrees that are to be made like metres, it is interpolated along that one: cells twice as large along the
/// other would be another scale.
///
/// # Errors
/// When it cannot be read or has no data.
pub(super) fn read(
    path: &Path,
    wanted: &Wanted,
    watch: &Watch,
    warn: &mut dyn FnMut(&str),
) -> Result<(Vec<Plane>, Record)> {
    let source = open_dem(path, &RasterOptions::default(), wanted.memory, watch)?;
    let needed = source.cells().saturating_mul(wanted.bytes_per_cell) + source.unpacked_bytes();
    memory::admit_or(
        needed,
        wanted.memory.unwrap_or_else(memory::free_bytes),
        "cut the exemplar with gdal_translate -srcwin",
    )
    .map_err(|error| error.at_path(path))?;
    let dem = source.read(watch)?;
    let mut say = |text: &str| warn(&format!("{}: {text}", path.display()));
    if let Some(sentinel) = &dem.sentinel {
        say(&sentinel.to_string());
    }
    let (rows, cols) = (dem.grid.rows(), dem.grid.cols());
    let own = CellSize::of(&dem.transform, dem.crs.as_ref(), rows, cols);
    let exemplar = Plane::new(rows, cols, dem.heights_m());
    drop(dem);
    let made = wanted.made;
    let fit = |exemplar: Plane, own: CellSize| {
        let larger = own.excess(made).max(1.0);
        let target = if own.is_like(made) { made } else { made.times(larger) };
        match own.is_like(target) {
            true => exemplar,
            false => resampled(&exemplar, target.down_m / own.down_m, target.across_m / own.across_m),
        }
    };
    let turned = (!made.is_square()).then(|| fit(exemplar.transposed(), own.transposed()));
    let upright = fit(exemplar, own);
    if own.exceed(made) {
        say(&format!(
            "its cells of {own} are larger than those of {made} that are made: what is learned from it is detail of its own \
             size"
        ));
    }
    let slope = median_slope(&upright.averaged(wanted.factor), wanted.input.times(own.excess(made).max(1.0)));
    if let Some(text) = remark(wanted.slope, slope) {
        say(&text);
    }
    let record = Record { name: name(path), size: [rows, cols], cell: own, slope };
    Ok(([Some(upright), turned].into_iter().flatten().collect(), record))
}
