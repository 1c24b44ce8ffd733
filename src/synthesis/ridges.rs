//! The ridges that peaks could be joined by.

use super::extent::Extent;
use super::kept::Kept;
use crate::components::root;
use crate::crs::{Metric, Place};
use crate::error::Result;
use crate::tin::Triangulation;
use std::collections::BTreeMap;

/// A ridge that may become one of the tree's, or is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ridge {
    /// Numbers of its peaks, which count from the highest; the higher one first.
    pub(super) ends: [u32; 2],
    /// Numbers of the joints that it leads straight from and to: its peaks, or places on kept ridges up to them.
    pub(super) joints: [u32; 2],
    /// What it costs to choose it.
    pub(super) weight: f64,
    /// The third joints of the triangles beside it, where there are any.
    pub(super) beside: [Option<u32>; 2],
    /// Its saddle lies below this elevation, in metres: that of the lower joint.
    pub(super) below_m: f64,
    /// Position of the kept ridge that it is, if it is one.
    pub(super) kept: Option<u32>,
}

/// Where ridges can begin: a peak, or a cell of a kept ridge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Joint {
    /// Twice the row and twice the column: kept ridges may cross between cells.
    pub(super) twice: [i64; 2],
    /// Number of the peak that the kept ridge leads up to, or the peak itself.
    pub(super) peak: u32,
    /// Elevation there in metres, at least.
    pub(super) elevation_m: f64,
    /// Kept ridge, its side, and how many steps up from its saddle; none for a peak.
    pub(super) way: Option<(u32, u8, u32)>,
}

/// All ridges that there can be, and their joints.
#[derive(Clone, Debug)]
pub(super) struct Web {
    /// The joints; first the peaks in their order.
    pub(super) joints: Vec<Joint>,
    /// Pairs of joints that kept ridges lead straight between.
    pub(super) steps: Vec<[u32; 2]>,
    /// The ridges.
    pub(super) ridges: Vec<Ridge>,
}

impl Web {
    /// Row and column of the cell at which a ridge from a joint begins.
    pub(super) fn start(&self, joint: u32, kept: &Kept) -> [i64; 2] {
        let joint = &self.joints[joint as usize];
        match joint.way {
            // Between four cells: one of them.
            Some((ridge, side, step)) if joint.twice.iter().any(|twice| twice % 2 != 0) => {
                let (row, col) = kept.line(ridge as usize, usize::from(side))[step as usize];
                [row, col]
            }
            _ => joint.twice.map(|twice| twice / 2),
        }
    }

    /// The cells of a kept ridge from a joint, included, to its peak, which is not.
    pub(super) fn way(&self, joint: u32, kept: &Kept) -> Vec<Place> {
        let Some((ridge, side, step)) = self.joints[joint as usize].way else { return vec![] };
        let mut line = kept.line(ridge as usize, usize::from(side));
        line.pop();
        line.split_off((step as usize).min(line.len()))
    }
}

/// What makes a ridge that has little room for its saddle the last choice.
const CRAMPED: f64 = 1e6;
/// Joints that are nearer than so many cells leave little room.
const ROOMY: i64 = 3;

/// The ridges between peaks that stand from the highest to the lowest: the edges of their Delaunay triangulation, of
/// which real divide trees use more than 95 % (Argudo et al. 2019, section 5.2).
///
/// The weight is that of their equation 1, `d / h^rho`, with `d` the distance in metres, `h` the elevation of the lower
/// end in metres, at least 1, and `exponent` for rho: 0 for short ridges, more for high ones.
///
/// Kept ridges are edges that are given to the triangulation, cell by cell, and their cells are points of it. So no
/// other edge crosses them, or another. An edge to a point on a kept ridge is a ridge that branches off there: it leads
/// on up the kept one to its peak, and is used once growth is below that point. All peaks can be joined in this way, as a
/// triangulation is in one piece, and every point of it belongs to a peak.
///
/// `kept_numbers` are the numbers of the kept peaks.
///
/// # Errors
/// Two peaks in one place.
pub(super) fn ridges<M: Metric + ?Sized>(
    extent: &Extent<'_, M>,
    places: &[Place],
    elevations_m: &[f64],
    exponent: u8,
    (kept, kept_numbers): (&Kept, &[u32]),
) -> Result<Web> {
    let peaks = (0..).zip(places.iter().zip(elevations_m));
    let peak = |(peak, (&(row, col), &elevation_m))| Joint { twice: [2 * row, 2 * col], peak, elevation_m, way: None };
    let mut net = Net { at: BTreeMap::new(), joints: peaks.map(peak).collect(), steps: vec![] };
    net.at.extend((0..).zip(&net.joints).map(|(number, joint)| (joint.twice, number)));
    let mut parents: Vec<u32> = (0..).take(places.len()).collect();
    for (number, ridge) in (0..).zip(&kept.ridges) {
        let ends = ridge.peaks.map(|peak| kept_numbers[peak as usize]);
        for side in [0, 1] {
            let top_m = elevations_m[ends[side] as usize];
            net.draw(&kept.line(number as usize, side), (number, side), ends[side], (ridge.saddle_m, top_m));
        }
        let [a, b] = ends.map(|peak| root(&mut parents, peak));
        parents[a as usize] = b;
    }
    net.cross();
    let Net { joints, steps, .. } = net;
    let (row_m, col_m) = extent.steps_m(extent.rows as i64 / 2);
    let points: Vec<[f64; 2]> = if kept.is_empty() {
        places.iter().map(|&(row, col)| [col as f64 * col_m, row as f64 * row_m]).collect()
    } else {
        // So short a number times a row is exact: what lies on a line of cells lies on it here, too.
        let stretch = f64::from((row_m / col_m) as f32);
        joints.iter().map(|joint| [joint.twice[1] as f64, joint.twice[0] as f64 * stretch]).collect()
    };
    let triangulation = Triangulation::new(&points, &steps)?;
    let sorted = |a: u32, b: u32| [a.min(b), a.max(b)];
    let mut edges: BTreeMap<[u32; 2], [Option<u32>; 2]> =
        triangulation.edges().map(|[a, b]| (sorted(a, b), [None; 2])).collect();
    for triangle in triangulation.triangles() {
        for corner in 0..3 {
            let [a, b, third] = [0, 1, 2].map(|step| triangle[(corner + step) % 3]);
            let beside = edges.entry(sorted(a, b)).or_default();
            beside[usize::from(a < b)] = Some(third);
        }
    }
    // Kept ridges join these already.
    edges.retain(|between, _| {
        let [a, b] = between.map(|joint| root(&mut parents, joints[joint as usize].peak));
        a != b
    });
    let ridge = |(between, beside): ([u32; 2], [Option<u32>; 2])| {
        let own = between.map(|joint| &joints[joint as usize]);
        let is_turned = own[0].peak > own[1].peak;
        let distance_m = match own.map(|joint| joint.twice.map(|twice| twice.div_euclid(2))) {
            [[row_a, col_a], [row_b, col_b]] => extent.metric.distance_m((row_a, col_a), (row_b, col_b)),
        };
        let below_m = own[0].elevation_m.min(own[1].elevation_m);
        let mut weight = (0..exponent).fold(distance_m, |weight, _| weight / below_m.max(1.0));
        let apart = [0, 1].map(|k| (own[0].twice[k] - own[1].twice[k]).abs());
        let is_between = own.iter().any(|joint| joint.twice.iter().any(|twice| twice % 2 != 0));
        if !kept.is_empty() && (is_between || apart[0].max(apart[1]) < 2 * ROOMY) {
            weight = (weight + 1.0) * CRAMPED;
        }
        let [first, last] = if is_turned { [1, 0] } else { [0, 1] };
        let is_peaks = own.iter().all(|joint| joint.way.is_none());
        Ridge {
            ends: [own[first].peak, own[last].peak],
            joints: [between[first], between[last]],
            weight,
            beside,
            below_m: if is_peaks { f64::INFINITY } else { below_m },
            kept: None,
        }
    };
    let mut ridges: Vec<Ridge> = edges.into_iter().map(ridge).collect();
    for (number, ridge) in (0..).zip(&kept.ridges) {
        let ends = ridge.peaks.map(|peak| kept_numbers[peak as usize]);
        let ends = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let below_m = ridge.saddle_m;
        ridges.push(Ridge { ends, joints: ends, weight: 0.0, beside: [None; 2], below_m, kept: Some(number) });
    }
    Ok(Web { joints, steps, ridges })
}

/// Kept ridges as they become joints.
struct Net {
    /// Number of the joint at a place, twice its row and column.
    at: BTreeMap<[i64; 2], u32>,
    joints: Vec<Joint>,
    steps: Vec<[u32; 2]>,
}

impl Net {
    /// Adds the line of a side of a kept ridge, which rises from the saddle's elevation to the peak's.
    fn draw(&mut self, line: &[Place], (ridge, side): (u32, usize), peak: u32, (saddle_m, top_m): (f64, f64)) {
        let steps = line.len().saturating_sub(1).max(1) as f64;
        let mut before = None;
        for (step, &(row, col)) in (0..).zip(line) {
            let elevation_m = saddle_m + (top_m - saddle_m) * (f64::from(step) / steps);
            #[allow(clippy::cast_possible_truncation, reason = "0 or 1")]
            let way = Some((ridge, side as u8, step));
            let number = self.joint(Joint { twice: [2 * row, 2 * col], peak, elevation_m, way });
            if let Some(before) = before.filter(|&before| before != number) {
                self.steps.push([before, number]);
            }
            before = Some(number);
        }
    }

    /// The joint at a place; of several the one with a higher way up counts, and a peak for most.
    fn joint(&mut self, joint: Joint) -> u32 {
        #[allow(clippy::cast_possible_truncation, reason = "joints are counted with 32 bits")]
        let new = self.joints.len() as u32;
        let number = *self.at.entry(joint.twice).or_insert(new);
        match self.joints.get_mut(number as usize) {
            None => self.joints.push(joint),
            Some(own) if own.way.is_some() && own.elevation_m < joint.elevation_m => *own = joint,
            Some(_) => {}
        }
        number
    }

    /// Takes apart steps that cross: only askew ones do, in the middle between four cells.
    fn cross(&mut self) {
        let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
        self.steps.iter_mut().for_each(|step| *step = sorted(*step));
        self.steps.sort_unstable();
        self.steps.dedup();
        let mut middles: BTreeMap<[i64; 2], Vec<[u32; 2]>> = BTreeMap::new();
        for &step in &self.steps {
            let [a, b] = step.map(|joint| self.joints[joint as usize].twice);
            if a[0] != b[0] && a[1] != b[1] {
                middles.entry([0, 1].map(|k| (a[k] + b[k]) / 2)).or_default().push(step);
            }
        }
        for (twice, crossing) in middles.into_iter().filter(|(_, steps)| steps.len() > 1) {
            let ends = crossing.iter().flatten().map(|&joint| self.joints[joint as usize]);
            // The lowest of all, so that what begins here is below both lines.
            let Some(lowest) = ends.reduce(|a, b| if b.elevation_m < a.elevation_m { b } else { a }) else { continue };
            let middle = self.joint(Joint { twice, ..lowest });
            self.steps.retain(|step| !crossing.contains(step));
            self.steps.extend(crossing.iter().flatten().map(|&joint| sorted([joint, middle])));
        }
    }
}
