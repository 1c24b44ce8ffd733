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
        let pixel = |(x, y): (f64, f64)| {
            let (row, col) = land.transform.pixel(x, y);
            [col - 0.5, row - 0.5]
        };
        let mut taken: BTreeMap<(usize, usize), (&str, bool)> = BTreeMap::new();
        let (mut peaks, mut saddles) = (vec![], vec![]);
        for (is_saddle, drawn, placed) in [(false, &self.peaks, &mut peaks), (true, &self.saddles, &mut saddles)] {
            for spot in drawn {
                let [col, row] = pixel(spot.at).map(|at| at.round());
                if !(row >= 0.0 && col >= 0.0 && row < land.rows as f64 && col < land.cols as f64) {
                    return wrong(format!("{} lies outside of the land: give a larger --bbox", spot.name));
                }
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "inside of the land")]
                let (row, col) = (row as usize, col as usize);
                // Several peaks may end in one cell: it is a saddle of each.
                if let Some((other, was_saddle)) = taken.insert((row, col), (&spot.name, is_saddle))
                    && !(is_saddle && was_saddle)
                {
                    return wrong(format!(
                        "{} and {other} lie in one cell: take one away, or give a finer --resolution",
                        spot.name
                    ));
                }
                placed.push(Spot { row, col, elevation_m: spot.elevation_m });
            }
        }
        let tree = |drawn: &[DrawnSpot]| -> Places {
            let places = (0..).zip(drawn).map(|(i, spot)| GeomWithData::new(pixel(spot.at), i)).collect();
            RTree::bulk_load(places)
        };
        let (peak_places, saddle_places) = (tree(&self.peaks), tree(&self.saddles));
        let mut ridges: Vec<RidgeLine> = Vec::with_capacity(2 * self.lines.len());
        let mut line_of: Vec<Option<usize>> = vec![None; self.saddles.len()];
        let mut parents: Vec<u32> = (0..self.peaks.len() as u32).collect();
        for (number, line) in self.lines.iter().enumerate() {
            let points: Vec<[f64; 2]> = line.points.iter().map(|&point| pixel(point)).collect();
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
            let place = |spot: &Spot| [spot.col as f64, spot.row as f64];
            let top = [ends[0], ends[1]].map(|peak| place(&peaks[peak as usize]));
            let start = place(&saddles[saddle as usize]);
            let mut back: Vec<[f64; 2]> = vec![start];
            back.extend(points[..=segment].iter().rev());
            back.push(top[0]);
            let mut on = vec![start];
            on.extend(&points[segment + 1..]);
            on.push(top[1]);
            ridges.push(RidgeLine { saddle, peak: ends[0], points: back });
            ridges.push(RidgeLine { saddle, peak: ends[1], points: on });
        }
        let idle = line_of.iter().filter(|line| line.is_none()).count();
        if idle > 0 {
            warn(&format!("saddles that no line leads over, left out: {idle}"));
            let mut number = 0;
            let kept: Vec<u32> = line_of.iter().map(|line| (number, number += u32::from(line.is_some())).0).collect();
            ridges.iter_mut().for_each(|ridge| ridge.saddle = kept[ridge.saddle as usize]);
            let mut has_line = line_of.iter().map(Option::is_some);
            saddles.retain(|_| has_line.next().unwrap_or(false));
        }
        Ok(Skeleton { size: [land.rows, land.cols], cell_m, peaks, saddles, ridges })
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
