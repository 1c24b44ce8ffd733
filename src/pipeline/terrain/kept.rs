//! A drawn tree, or a part of it, that terrain is to keep while the rest is made up.

use super::super::land::Land;
use super::drawn::{Cells, DrawnTree, JoinedLine, cell_at, cell_on};
use super::layers::read_layers;
use super::text::read_tree;
use crate::crs::{Crs, CrsKind, Place};
use crate::error::{Error, ErrorKind, Result};
use crate::orometry::distributions::CellSet;
use crate::synthesis::{Kept, KeptPeak, KeptRidge, prominences_m};
use std::path::Path;

/// Reads the tree of a file in its own CRS: layers, or a text.
///
/// # Errors
/// A file that holds no tree.
pub(super) fn read(path: &Path) -> Result<DrawnTree> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    if extension == "txt" { read_tree(path) } else { read_layers(path, None) }
}

/// Reads what of a tree is to be kept on some land: the peaks inside of `within`, all where that is not given, and the
/// ridges that have both of their peaks among these. A tree without a CRS is taken to be in that of the land.
///
/// Prominences are those in the whole tree, so a peak has its own also where its key saddle is not kept.
///
/// # Errors
/// A tree that is none, peaks and saddles that share a cell, and no peak to keep.
pub(in super::super) fn read_kept(
    path: &Path,
    land: &Land,
    within: Option<CellSet>,
    warn: &mut dyn FnMut(String),
) -> Result<Kept> {
    let mut tree = read(path)?;
    let is_local = |crs: &Crs| matches!(crs.kind, CrsKind::Local { .. });
    let mut take = |what: &str| {
        warn(format!("{}: {what}: coordinates are taken as they are", path.display()));
    };
    match (&tree.crs, &land.crs) {
        (Some(own), Some(crs)) if own.wkt == crs.wkt => {}
        (Some(own), Some(crs)) if is_local(own) || is_local(crs) => {
            take("the tree and the land are in CRSs of which one has no place on Earth");
        }
        (Some(_), Some(crs)) => tree = read_layers(path, Some(&crs.wkt))?,
        (None, Some(_)) => take("the tree has no CRS and the land has one"),
        (Some(_), None) => take("the tree has a CRS and the land has none"),
        (None, None) => {}
    }
    kept(&tree, land, within, &mut |text| warn(format!("{}: {text}", path.display())))
        .map_err(|error| error.at_path(path))
}

fn kept(tree: &DrawnTree, land: &Land, within: Option<CellSet>, warn: &mut dyn FnMut(String)) -> Result<Kept> {
    let joined = tree.joined(land)?;
    // Where peaks are equally high their places decide, wherever the land ends.
    let order: Vec<(Place, f64)> = tree.peaks.iter().map(|peak| (rounded(land, peak.at), peak.elevation_m)).collect();
    let passes: Vec<([u32; 2], f64)> =
        joined.iter().map(|line| (line.ends, tree.saddles[line.saddle as usize].elevation_m)).collect();
    let prominences_m = prominences_m(&order, &passes);
    let mut taken = Cells::default();
    let mut numbers: Vec<Option<u32>> = vec![None; tree.peaks.len()];
    let mut peaks: Vec<KeptPeak> = vec![];
    let mut outside = 0;
    for (i, peak) in tree.peaks.iter().enumerate() {
        let Some([row, col]) = cell_on(land, peak.at) else {
            outside += 1;
            continue;
        };
        if within.as_ref().is_some_and(|cells| !cells.holds(row, col)) {
            continue;
        }
        taken.take([row, col], &peak.name, false)?;
        #[allow(clippy::cast_possible_truncation, reason = "peaks are counted with 32 bits")]
        let number = peaks.len() as u32;
        numbers[i] = Some(number);
        peaks.push(KeptPeak {
            place: (row as i64, col as i64),
            elevation_m: peak.elevation_m,
            prominence_m: prominences_m[i],
        });
    }
    if peaks.is_empty() {
        let where_to = if within.is_some() { "in the polygons of --keep-within, on the land" } else { "on the land" };
        let message = format!("none of its {} peaks lies {where_to}: there is nothing to keep", tree.peaks.len());
        return Err(Error::new(ErrorKind::Input, message));
    }
    if outside > 0 && within.is_none() {
        warn(format!("peaks outside of the land, left out: {outside}"));
    }
    let mut ridges = vec![];
    let mut cut = 0;
    for JoinedLine { ends, saddle, sides } in &joined {
        let [Some(a), Some(b)] = ends.map(|end| numbers[end as usize]) else { continue };
        let spot = &tree.saddles[*saddle as usize];
        let place = |[row, col]: [usize; 2]| (row as i64, col as i64);
        let bends = |side: &Vec<[f64; 2]>| -> Option<Vec<Place>> {
            side.iter().map(|&point| cell_at(land, point).map(place)).collect()
        };
        let (Some(cell), [Some(back), Some(on)]) = (cell_on(land, spot.at), [bends(&sides[0]), bends(&sides[1])])
        else {
            cut += 1;
            continue;
        };
        taken.take(cell, &spot.name, true)?;
        let top = |peak: u32| peaks[peak as usize].place;
        let bends = [without_ends(back, place(cell), top(a)), without_ends(on, place(cell), top(b))];
        ridges.push(KeptRidge { peaks: [a, b], saddle: place(cell), saddle_m: spot.elevation_m, bends });
    }
    if cut > 0 {
        warn(format!("ridges that leave the land between their peaks, left out: {cut}"));
    }
    Ok(Kept { peaks, ridges, within })
}

/// Row and column of the cell of a place that need not be on the land.
fn rounded(land: &Land, (x, y): (f64, f64)) -> Place {
    let (row, col) = land.transform.pixel(x, y);
    #[allow(clippy::cast_possible_truncation, reason = "saturates far outside of the land")]
    let place = (row.floor() as i64, col.floor() as i64);
    place
}

/// Bends without those that are in the cell of the one before, of the saddle or of the peak.
fn without_ends(mut bends: Vec<Place>, saddle: Place, peak: Place) -> Vec<Place> {
    bends.dedup();
    while bends.last() == Some(&peak) {
        bends.pop();
    }
    let first = bends.iter().position(|&bend| bend != saddle).unwrap_or(bends.len());
    bends.split_off(first)
}
