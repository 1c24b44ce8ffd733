//! What of a tree that is there already stays as it is.

use crate::components::root;
use crate::crs::Place;
use crate::error::{Error, ErrorKind, Result};
use crate::orometry::distributions::CellSet;
use std::collections::BTreeSet;

/// Peaks and ridges that stand fast: those of a real tree, or some that somebody drew.
#[derive(Clone, Debug, Default)]
pub struct Kept {
    /// The peaks.
    pub peaks: Vec<KeptPeak>,
    /// The ridges between them: no circle.
    pub ridges: Vec<KeptRidge>,
    /// Where no new peaks stand.
    pub within: Option<CellSet>,
}

/// A peak that stands fast.
#[derive(Clone, Debug, PartialEq)]
pub struct KeptPeak {
    /// Row and column of its cell.
    pub place: Place,
    /// Elevation in metres.
    pub elevation_m: f64,
    /// Prominence in metres in the tree that it comes from; `None` where that ends without a higher peak.
    pub prominence_m: Option<f64>,
}

/// A ridge that stands fast.
#[derive(Clone, Debug, PartialEq)]
pub struct KeptRidge {
    /// Positions of its peaks.
    pub peaks: [u32; 2],
    /// Row and column of its saddle's cell.
    pub saddle: Place,
    /// Elevation of the saddle in metres.
    pub saddle_m: f64,
    /// For each of the peaks where the line bends on its way there from the saddle, without these two.
    pub bends: [Vec<Place>; 2],
}

/// New peaks are so many cells away from what is kept, and more.
const CLEAR: i64 = 2;

impl Kept {
    /// Whether nothing is kept.
    pub fn is_empty(&self) -> bool {
        self.peaks.is_empty()
    }

    /// Checks that all lies on a raster, each peak in a cell of its own, saddles below their peaks, without a circle.
    ///
    /// # Errors
    /// `Input`, with the first fault.
    pub fn check(&self, rows: usize, cols: usize) -> Result<()> {
        let wrong = |message: String| Err(Error::new(ErrorKind::Input, message));
        let is_inside = |&(row, col): &Place| row >= 0 && col >= 0 && row < rows as i64 && col < cols as i64;
        let mut taken = BTreeSet::new();
        for KeptPeak { place, elevation_m, .. } in &self.peaks {
            if !is_inside(place) || !elevation_m.is_finite() || !taken.insert(*place) {
                return wrong(format!(
                    "a peak of {elevation_m} m at row {}, column {} cannot be kept on {rows} rows and {cols} columns",
                    place.0, place.1
                ));
            }
        }
        let mut parents: Vec<u32> = (0..).take(self.peaks.len()).collect();
        for ridge in &self.ridges {
            let KeptRidge { saddle: (row, col), saddle_m, .. } = *ridge;
            let ends = ridge.peaks.map(|peak| self.peaks.get(peak as usize).map(|peak| peak.elevation_m));
            let [Some(a_m), Some(b_m)] = ends else {
                return wrong(format!("a ridge between peaks {:?}, which are not there", ridge.peaks));
            };
            if !(saddle_m < a_m && saddle_m < b_m) {
                return wrong(format!(
                    "the saddle at row {row}, column {col} is {saddle_m} m high, and not below its peaks with {a_m} and {b_m} m"
                ));
            }
            if !ridge.bends.iter().flatten().chain([&ridge.saddle]).all(is_inside) || taken.contains(&ridge.saddle) {
                return wrong(format!("the ridge over row {row}, column {col} has no room on the land"));
            }
            let [a, b] = ridge.peaks.map(|peak| root(&mut parents, peak));
            if a == b {
                return wrong(format!("the ridge over row {row}, column {col} closes a circle"));
            }
            parents[a as usize] = b;
        }
        Ok(())
    }

    /// The cells of a ridge from its saddle to one of its peaks, both included, each beside the one before.
    pub(super) fn line(&self, ridge: usize, side: usize) -> Vec<Place> {
        let KeptRidge { saddle, bends, peaks, .. } = &self.ridges[ridge];
        let mut cells = vec![*saddle];
        for &to in bends[side].iter().chain([&self.peaks[peaks[side] as usize].place]) {
            walk(&mut cells, to);
        }
        cells
    }

    /// The cells of all ridges and peaks.
    pub(super) fn cells(&self) -> BTreeSet<Place> {
        let lines = (0..self.ridges.len()).flat_map(|ridge| [0, 1].map(|side| self.line(ridge, side)));
        lines.flatten().chain(self.peaks.iter().map(|peak| peak.place)).collect()
    }

    /// The cells that are too near to what is kept for a new peak.
    pub(super) fn near(&self) -> BTreeSet<Place> {
        let around = |(row, col): Place| {
            (row - CLEAR..=row + CLEAR).flat_map(move |row| (col - CLEAR..=col + CLEAR).map(move |col| (row, col)))
        };
        self.cells().into_iter().flat_map(around).collect()
    }

    /// The prominences in metres that the kept ridges alone give their peaks.
    pub(super) fn own_prominences_m(&self) -> Vec<Option<f64>> {
        let peaks: Vec<(Place, f64)> = self.peaks.iter().map(|peak| (peak.place, peak.elevation_m)).collect();
        let ridges: Vec<([u32; 2], f64)> = self.ridges.iter().map(|ridge| (ridge.peaks, ridge.saddle_m)).collect();
        prominences_m(&peaks, &ridges)
    }
}

/// Leads a line of cells on to another one.
fn walk(cells: &mut Vec<Place>, to: Place) {
    let Some(&from) = cells.last() else { return };
    let (down, right) = (to.0 - from.0, to.1 - from.1);
    let steps = down.abs().max(right.abs());
    // Halves are rounded up, in whole numbers.
    let part = |whole: i64, step: i64| (2 * whole * step + steps).div_euclid(2 * steps);
    cells.extend((1..=steps).map(|step| (from.0 + part(down, step), from.1 + part(right, step))));
}

/// Prominences in metres of the peaks of a tree, or of several, with their places and elevations, that meet at ridges:
/// two positions, and the saddle's elevation. `None` for the highest peak of each tree.
///
/// Of peaks that are equally high, the one in the first row counts as higher, then that in the first column.
pub fn prominences_m(peaks: &[(Place, f64)], ridges: &[([u32; 2], f64)]) -> Vec<Option<f64>> {
    let mut falling: Vec<&([u32; 2], f64)> = ridges.iter().collect();
    falling.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut tops: Vec<u32> = (0..).take(peaks.len()).collect();
    let mut found = vec![None; peaks.len()];
    for &&(ends, saddle_m) in &falling {
        let [a, b] = ends.map(|peak| root(&mut tops, peak));
        let order = |peak: u32| {
            let (place, elevation_m) = peaks[peak as usize];
            (-elevation_m, place)
        };
        let (high, low) = if order(a) < order(b) { (a, b) } else { (b, a) };
        if high != low {
            found[low as usize] = Some(peaks[low as usize].1 - saddle_m);
            tops[low as usize] = high;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn lines_go_from_cell_to_cell(points in prop::collection::vec((-40..40_i64, -40..40_i64), 1..6)) {
            let mut cells = vec![points[0]];
            points[1..].iter().for_each(|&to| walk(&mut cells, to));
            prop_assert_eq!(cells.last(), points.last());
            for pair in cells.windows(2) {
                let step = ((pair[1].0 - pair[0].0).abs(), (pair[1].1 - pair[0].1).abs());
                prop_assert!(step.0.max(step.1) == 1, "{:?}", pair);
            }
            prop_assert!(points.iter().all(|point| cells.contains(point)));
        }
    }

    fn three() -> Kept {
        let peak = |place, elevation_m| KeptPeak { place, elevation_m, prominence_m: None };
        let ridge = |peaks, saddle, saddle_m| KeptRidge { peaks, saddle, saddle_m, bends: [vec![], vec![]] };
        Kept {
            peaks: vec![peak((1, 1), 90.0), peak((1, 9), 70.0), peak((9, 5), 90.0)],
            ridges: vec![ridge([0, 1], (1, 5), 60.0), ridge([1, 2], (5, 7), 65.0)],
            within: None,
        }
    }

    #[test]
    fn prominences_of_a_tree() {
        assert_eq!(three().own_prominences_m(), [None, Some(5.0), Some(30.0)]);
        let near = three().near();
        assert!(near.contains(&(3, 3)) && near.contains(&(-1, -1)) && !near.contains(&(4, 3)));
    }

    #[test]
    fn what_cannot_be_kept() {
        let with = |change: &dyn Fn(&mut Kept)| {
            let mut kept = three();
            change(&mut kept);
            kept.check(10, 10).map_err(|error| error.to_string())
        };
        assert_eq!(with(&|_| ()), Ok(()));
        let refused = |change: &dyn Fn(&mut Kept), words: &str| {
            let error = with(change).expect_err(words);
            assert!(error.contains(words), "{error}");
        };
        refused(&|kept| kept.peaks[0].place = (1, 10), "row 1, column 10");
        refused(&|kept| kept.peaks[0].place = (1, 9), "row 1, column 9");
        refused(&|kept| kept.peaks[0].elevation_m = f64::NAN, "NaN");
        refused(&|kept| kept.ridges[0].saddle_m = 70.0, "not below its peaks");
        refused(&|kept| kept.ridges[0].saddle_m = f64::NAN, "not below its peaks");
        refused(&|kept| kept.ridges[0].saddle = (9, 5), "no room");
        refused(&|kept| kept.ridges[0].bends[1].push((0, 10)), "no room");
        refused(&|kept| kept.ridges[0].peaks = [1, 2], "circle");
        refused(&|kept| kept.ridges[0].peaks = [1, 3], "not there");
    }
}
