//! A divide tree as it is drawn in a file.

use super::super::land::Land;
use crate::components::root;
use crate::crs::Crs;
use crate::error::{Error, ErrorKind, Result};
use crate::synthesis::terrain::{RidgeLine, Skeleton, Spot};
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};
use std::collections::BTreeMap;

/// A peak or a saddle of a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DrawnSpot {
    /// Easting or longitude, and northing or latitude.
    pub(super) at: (f64, f64),
    /// Elevation in metres.
    pub(super) elevation_m: f64,
    /// What to call it: `peak 12`.
    pub(super) name: String,
}

/// A line over a saddle, from peak to peak.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DrawnLine {
    /// Its points.
    pub(super) points: Vec<(f64, f64)>,
    /// What to call it: `line 12`.
    pub(super) name: String,
}

/// A line with its peaks and its saddle.
pub(super) struct JoinedLine {
    /// Positions of the peaks at its beginning and its end.
    pub(super) ends: [u32; 2],
    /// Position of the saddle.
    pub(super) saddle: u32,
    /// Its points, column and row of the land, from the saddle back to the beginning, and on to the end.
    pub(super) sides: [Vec<[f64; 2]>; 2],
}

/// Cells that peaks and saddles have taken, with their names and whether that are saddles.
#[derive(Default)]
pub(super) struct Cells<'a>(BTreeMap<[usize; 2], (&'a str, bool)>);

impl<'a> Cells<'a> {
    /// Takes a cell. Several peaks may end in one: it is a saddle of each.
    ///
    /// # Errors
    /// A cell that is taken.
    pub(super) fn take(&mut self, cell: [usize; 2], name: &'a str, is_saddle: bool) -> Result<()> {
        match self.0.insert(cell, (name, is_saddle)) {
            Some((other, was_saddle)) if !(is_saddle && was_saddle) => {
                let message =
                    format!("{name} and {other} lie in one cell: take one away, or give a finer --resolution");
                Err(Error::new(ErrorKind::Input, message))
            }
            _ => Ok(()),
        }
    }
}

/// Column and row of a place, whole numbers at centres of cells.
fn pixel(land: &Land, (x, y): (f64, f64)) -> [f64; 2] {
    let (row, col) = land.transform.pixel(x, y);
    [col - 0.5, row - 0.5]
}

/// Row and column of the cell of a place, if it is on the land.
pub(super) fn cell_on(land: &Land, at: (f64, f64)) -> Option<[usize; 2]> {
    cell_at(land, pixel(land, at))
}

/// Row and column of the cell of a point in columns and rows, if it is on the land.
pub(super) fn cell_at(land: &Land, point: [f64; 2]) -> Option<[usize; 2]> {
    let [col, row] = point.map(f64::round);
    let is_inside = row >= 0.0 && col >= 0.0 && row < land.rows as f64 && col < land.cols as f64;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "inside of the land")]
    is_inside.then_some([row as usize, col as usize])
}

/// A divide tree as it is drawn.
#[derive(Clone, Debug, Default)]
pub(super) struct DrawnTree {
    /// The CRS of the coordinates.
    pub(super) crs: Option<Crs>,
    /// The peaks.
    pub(super) peaks: Vec<DrawnSpot>,
    /// The saddles.
    pub(super) saddles: Vec<DrawnSpot>,
    /// The lines.
    pub(super) lines: Vec<DrawnLine>,
}

/// How many cells a saddle may lie beside its line.
const REACH_CELLS: f64 = 2.0;
/// Saddles whose distances from a line differ by so many cells are as near.
const SAME_CELLS: f64 = 0.5;

type Places = RTree<GeomWithData<[f64; 2], u32>>;

impl DrawnTree {
    /// Least x, least y, greatest x, greatest y of all that is drawn.
    pub(super) fn bbox(&self) -> [f64; 4] {
        let spots = self.peaks.iter().chain(&self.saddles).map(|spot| spot.at);
        let nothing = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        spots
            .chain(self.lines.iter().flat_map(|line| line.points.iter().copied()))
            .fold(nothing, |b, (x, y)| [b[0].min(x), b[1].min(y), b[2].max(x), b[3].max(y)])
    }

    /// The tree on the cells of some land. Geometry decides: a line leads from the peak nearest to its one end to the
    /// peak nearest to its other, over the saddle nearest to the line.
    ///
    /// # Errors
    /// A tree that is none, by the name of the feature that is at fault.
    pub(super) fn placed(&self, land: &Land, cell_m: [f64; 2], warn: &mut dyn FnMut(&str)) -> Result<Skeleton> {
        let wrong = |message: String| Err(Error::new(ErrorKind::Input, message));
        if self.peaks.is_empty() {
            return wrong("there are no peaks: nothing to raise terrain on".into());
        }
        let mut taken = Cells::default();
        let (mut peaks, mut saddles) = (vec![], vec![]);
        for (is_saddle, drawn, placed) in [(false, &self.peaks, &mut peaks), (true, &self.saddles, &mut saddles)] {
            for spot in drawn {
                let Some([row, col]) = cell_on(land, spot.at) else {
                    return wrong(format!("{} lies outside of the land: give a larger --bbox", spot.name));
                };
                taken.take([row, col], &spot.name, is_saddle)?;
                placed.push(Spot { row, col, elevation_m: spot.elevation_m });
            }
        }
        let joined = self.joined(land)?;
        let mut ridges: Vec<RidgeLine> = Vec::with_capacity(2 * joined.len());
        let mut has_line = vec![false; saddles.len()];
        for JoinedLine { ends, saddle, sides: [back, on] } in joined {
            let place = |spot: &Spot| [spot.col as f64, spot.row as f64];
            for (peak, bends) in ends.into_iter().zip([back, on]) {
                let mut points = vec![place(&saddles[saddle as usize])];
                points.extend(bends);
                points.push(place(&peaks[peak as usize]));
                ridges.push(RidgeLine { saddle, peak, points });
            }
            has_line[saddle as usize] = true;
        }
        let idle = has_line.iter().filter(|has| !**has).count();
        if idle > 0 {
            warn(&format!("saddles that no line leads over, left out: {idle}"));
            let mut number = 0;
            let kept: Vec<u32> = has_line.iter().map(|&has| (number, number += u32::from(has)).0).collect();
            ridges.iter_mut().for_each(|ridge| ridge.saddle = kept[ridge.saddle as usize]);
            let mut has_line = has_line.into_iter();
            saddles.retain(|_| has_line.next().unwrap_or(false));
        }
        Ok(Skeleton { size: [land.rows, land.cols], cell_m, peaks, saddles, ridges })
    }

    /// The lines with their peaks and saddles: geometry decides, see [`DrawnTree::placed`].
    ///
    /// # Errors
    /// Lines that make no tree, by their names.
    pub(super) fn joined(&self, land: &Land) -> Result<Vec<JoinedLine>> {
        let wrong = |message: String| Err(Error::new(ErrorKind::Input, message));
        let tree = |drawn: &[DrawnSpot]| -> Places {
            let places = (0..).zip(drawn).map(|(i, spot)| GeomWithData::new(pixel(land, spot.at), i)).collect();
            RTree::bulk_load(places)
        };
        let (peak_places, saddle_places) = (tree(&self.peaks), tree(&self.saddles));
        let mut joined: Vec<JoinedLine> = Vec::with_capacity(self.lines.len());
        let mut line_of: Vec<Option<usize>> = vec![None; self.saddles.len()];
        let mut parents: Vec<u32> = (0..self.peaks.len() as u32).collect();
        for (number, line) in self.lines.iter().enumerate() {
            let points: Vec<[f64; 2]> = line.points.iter().map(|&point| pixel(land, point)).collect();
            let (Some(first), Some(last)) = (points.first(), points.last()) else { continue };
            let near = |point: &[f64; 2]| peak_places.nearest_neighbor(*point).map_or(0, |place| place.data);
            let ends = [near(first), near(last)];
            if ends[0] == ends[1] {
                return wrong(format!(
                    "{} begins and ends at {}: a ridge leads from one peak to another",
                    line.name, self.peaks[ends[0] as usize].name
                ));
            }
            let candidates = self.saddles_at(&saddle_places, &points);
            let free = candidates.iter().find(|(saddle, _)| line_of[*saddle as usize].is_none());
            let Some(&(saddle, segment)) = free.or(candidates.first()) else {
                return wrong(format!(
                    "{} leads over no saddle: there is none within {REACH_CELLS} cells of it",
                    line.name
                ));
            };
            let spot = &self.saddles[saddle as usize];
            if let Some(other) = line_of[saddle as usize].replace(number) {
                return wrong(format!("{} and {} both lead over {}", self.lines[other].name, line.name, spot.name));
            }
            for peak in ends.map(|peak| &self.peaks[peak as usize]) {
                if spot.elevation_m > peak.elevation_m {
                    return wrong(format!(
                        "{} is {} m high, above {} with {} m",
                        spot.name, spot.elevation_m, peak.name, peak.elevation_m
                    ));
                }
            }
            let roots = ends.map(|peak| root(&mut parents, peak));
            if roots[0] == roots[1] {
                return wrong(format!("{} closes a circle of ridges: a divide tree has none", line.name));
            }
            parents[roots[0].max(roots[1]) as usize] = roots[0].min(roots[1]);
            let back = points[..=segment].iter().rev().copied().collect();
            joined.push(JoinedLine { ends, saddle, sides: [back, points[segment + 1..].to_vec()] });
        }
        Ok(joined)
    }

    /// The saddles that a line may lead over, with the segments that they are nearest to. All that are about as near as
    /// the nearest count; a line goes down to its own saddle and no farther, so the lowest comes first.
    fn saddles_at(&self, places: &Places, points: &[[f64; 2]]) -> Vec<(u32, usize)> {
        let mut nearest: BTreeMap<u32, (f64, usize)> = BTreeMap::new();
        for (segment, pair) in points.windows(2).enumerate() {
            let corner = |pick: fn(f64, f64) -> f64, by: f64| [0, 1].map(|k| pick(pair[0][k], pair[1][k]) + by);
            let area = AABB::from_corners(corner(f64::min, -REACH_CELLS), corner(f64::max, REACH_CELLS));
            for saddle in places.locate_in_envelope(area) {
                let way = [0, 1].map(|k| pair[1][k] - pair[0][k]);
                let to = [0, 1].map(|k| saddle.geom()[k] - pair[0][k]);
                let square = way[0] * way[0] + way[1] * way[1];
                let part =
                    if square > 0.0 { ((to[0] * way[0] + to[1] * way[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
                let off = [0, 1].map(|k| to[k] - part * way[k]);
                let distance = (off[0] * off[0] + off[1] * off[1]).sqrt();
                let own = nearest.entry(saddle.data).or_insert((f64::INFINITY, 0));
                if distance <= REACH_CELLS && distance < own.0 {
                    *own = (distance, segment);
                }
            }
        }
        let least = nearest.values().map(|own| own.0).fold(f64::INFINITY, f64::min);
        let is_near = |own: &(f64, usize)| own.0.is_finite() && own.0 <= least + SAME_CELLS;
        let mut found: Vec<(u32, usize)> =
            nearest.into_iter().filter(|(_, own)| is_near(own)).map(|(saddle, own)| (saddle, own.1)).collect();
        let elevation_m = |saddle: u32| self.saddles[saddle as usize].elevation_m;
        found.sort_by(|a, b| elevation_m(a.0).total_cmp(&elevation_m(b.0)).then(a.0.cmp(&b.0)));
        found
    }
}
