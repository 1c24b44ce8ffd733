//! Maps that say where peaks stand.

use super::extent::Extent;
use super::kept::Kept;
use super::target::Target;
use crate::crs::{Metric, Place};
use crate::error::{Error, ErrorKind, Result};
use std::collections::BTreeSet;

/// A raster over all of an extent, of any number of cells.
#[derive(Clone, Debug)]
pub struct ControlMap {
    rows: usize,
    cols: usize,
    /// Row by row from the north; NaN where nothing is said.
    values: Vec<f64>,
}

impl ControlMap {
    /// The map of so many rows and columns.
    ///
    /// # Panics
    /// When there is not one value a cell, or no cell.
    pub fn new(rows: usize, cols: usize, values: Vec<f64>) -> Self {
        assert!(rows > 0 && cols > 0 && values.len() == rows * cols, "one value a cell");
        Self { rows, cols, values }
    }

    /// The value of the map's cell that holds a place of the extent.
    fn at<M: ?Sized>(&self, place: Place, extent: &Extent<'_, M>) -> f64 {
        #[allow(clippy::cast_sign_loss, reason = "places inside count from 0")]
        let [row, col] = [place.0 as usize * self.rows / extent.rows, place.1 as usize * self.cols / extent.cols];
        self.values[row * self.cols + col]
    }
}

/// What a user says of where peaks stand; all may be left out.
#[derive(Clone, Debug, Default)]
pub struct Controls {
    /// How many peaks there are beside other places: from 0 up, any unit; none where it is 0 or NaN.
    pub density: Option<ControlMap>,
    /// How high the land is beside other places; any unit.
    pub elevation: Option<ControlMap>,
    /// The number, from 1, of the range that the mountains are like; none where it is NaN or another number.
    pub kind: Option<ControlMap>,
    /// What stands fast, and the new peaks beside it.
    pub kept: Kept,
}

/// A tail of peaks that stand lower or higher than the elevation map says: the standard deviation, as a part of the
/// range of the peaks' elevations (Argudo et al. 2019, section 5.1).
const DEVIATION: f64 = 1.0 / 20.0;

/// The maps as weights of places for peaks.
#[derive(Debug)]
pub(super) struct Weights<'a, M: ?Sized> {
    extent: &'a Extent<'a, M>,
    controls: &'a Controls,
    /// One over the greatest density.
    density_unit: f64,
    /// For each range the elevation map turned into elevations of its peaks, in metres, and their deviation.
    levels: Vec<(ControlMap, f64)>,
    /// Cells that are too near to what is kept.
    near: BTreeSet<Place>,
}

impl<'a, M: Metric + ?Sized> Weights<'a, M> {
    /// The weights of maps for peaks of some ranges.
    ///
    /// The elevation map is equalised: the part of its cells that are lower than one is the part of peaks that stand
    /// below its elevation, so that the map need not know how high the mountains are (as in the authors' program).
    ///
    /// # Errors
    /// `Input` where a map is empty.
    pub(super) fn new(extent: &'a Extent<'a, M>, controls: &'a Controls, targets: &[&Target]) -> Result<Self> {
        let greatest = |map: &ControlMap| map.values.iter().copied().fold(0.0, f64::max);
        let density_unit = controls.density.as_ref().map_or(1.0, |map| 1.0 / greatest(map));
        if !density_unit.is_finite() {
            return Err(Error::new(ErrorKind::Input, "the density map is nowhere above 0"));
        }
        let levels = match &controls.elevation {
            Some(map) => targets.iter().map(|target| levels(map, target)).collect::<Result<_>>()?,
            None => vec![],
        };
        Ok(Self { extent, controls, density_unit, levels, near: controls.kept.near() })
    }

    /// The number of the range that a place is like, from 0; the first where nothing is said.
    pub(super) fn kind(&self, place: Place, kinds: usize) -> usize {
        let own = |map: &ControlMap| (0..kinds).find(|&kind| map.at(place, self.extent) == (kind + 1) as f64);
        self.controls.kind.as_ref().and_then(own).unwrap_or(0)
    }

    /// Whether a place is in the part of the land that is kept as it is.
    fn is_within(&self, place: Place) -> bool {
        #[allow(clippy::cast_sign_loss, reason = "places inside count from 0")]
        self.controls.kept.within.as_ref().is_some_and(|cells| cells.holds(place.0 as usize, place.1 as usize))
    }

    /// How welcome a peak of an elevation and of the range of number `kind` is at a place: 0 to 1.
    pub(super) fn at(&self, place: Place, elevation_m: f64, kind: usize) -> f64 {
        let mut weight = 1.0;
        if self.near.contains(&place) || self.is_within(place) {
            return 0.0;
        }
        if let Some(map) = &self.controls.kind
            && map.at(place, self.extent) != (kind + 1) as f64
        {
            return 0.0;
        }
        if let Some(map) = &self.controls.density {
            // NaN is no density.
            weight = (map.at(place, self.extent) * self.density_unit).max(0.0);
        }
        if let Some((map, deviation_m)) = self.levels.get(kind) {
            let level_m = map.at(place, self.extent);
            // A map that is flat or unknown there says nothing.
            if level_m.is_finite() {
                weight *= bell((elevation_m - level_m) / deviation_m);
            }
        }
        if weight > 0.0 { weight } else { 0.0 }
    }

    /// The part of the extent that peaks of a range can stand in, as the density counts it.
    pub(super) fn share(&self, kind: usize) -> f64 {
        // A coarse look is enough: what is wanted is a number of peaks.
        let (rows, cols) = (self.extent.rows.min(LOOKS), self.extent.cols.min(LOOKS));
        let place = |i: usize| {
            let (row, col) = (i / cols, i % cols);
            ((row * self.extent.rows / rows) as i64, (col * self.extent.cols / cols) as i64)
        };
        let is_there = |place: Place| {
            let density = self.controls.density.as_ref().is_none_or(|map| map.at(place, self.extent) > 0.0);
            let own = |map: &ControlMap| map.at(place, self.extent) == (kind + 1) as f64;
            density && self.controls.kind.as_ref().is_none_or(own) && !self.is_within(place)
        };
        let found = (0..rows * cols).filter(|&i| is_there(place(i))).count();
        found as f64 / (rows * cols) as f64
    }
}

/// Rows and columns that are looked at to see how much of an extent is to be filled.
const LOOKS: usize = 1000;

/// The normal distribution's curve with a height of 1, but for a part in 50: `(1 + x² / 16)^-8` in place of the
/// library's exponential, whose last bit differs between machines.
pub(super) fn bell(x: f64) -> f64 {
    let base = 1.0 + x * x / 16.0;
    let fourth = base * base * base * base;
    1.0 / (fourth * fourth)
}

fn levels(map: &ControlMap, target: &Target) -> Result<(ControlMap, f64)> {
    let mut sorted: Vec<f64> = map.values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let (Some(&lowest), Some(&highest)) = (sorted.first(), sorted.last()) else {
        return Err(Error::new(ErrorKind::Input, "the elevation map holds no elevation"));
    };
    let level = |value: f64| {
        if lowest == highest || !value.is_finite() {
            return f64::NAN;
        }
        // The middle of all that are equal.
        let (below, upto) = (sorted.partition_point(|&v| v < value), sorted.partition_point(|&v| v <= value));
        target.elevation.quantile((below + upto) as f64 / (2 * sorted.len()) as f64)
    };
    let values = map.values.iter().map(|&value| level(value)).collect();
    let (from_m, to_m) = (target.elevation.quantile(0.0), target.elevation.quantile(1.0));
    let deviation_m = ((to_m - from_m) * DEVIATION).max(1.0);
    Ok((ControlMap { values, ..*map }, deviation_m))
}
