//! The peaks before they have a place: elevations, prominences and isolations that go together.

use super::strata::{Strata, apportion};
use super::tally::Tally;
use super::target::{Class, Target};
use crate::crs::Place;
use crate::rng::Rng;

/// A peak without a place.
///
/// Elevations become multiples of [`STEP_M`], all different, once all ranges are cast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Role {
    /// Elevation in metres.
    pub(super) elevation_m: f64,
    /// Prominence in metres; the highest peak's is its elevation.
    pub(super) prominence_m: f64,
    /// Distance to the nearest higher peak in metres; of no meaning for the highest.
    pub(super) isolation_m: f64,
    /// Azimuth of that peak in degrees clockwise from north.
    pub(super) azimuth: f64,
    /// By how much that peak is higher, in metres, where the range tells.
    pub(super) rise_m: Option<f64>,
    /// Number of the range that it is like, from 0.
    pub(super) kind: usize,
    /// What is fixed of it, where it is kept.
    pub(super) kept: Option<Fixed>,
}

/// What is fixed of a kept peak beside its elevation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fixed {
    /// Its position among the kept ones.
    pub(super) number: u32,
    /// Its place.
    pub(super) place: Place,
    /// Elevation in metres of its key saddle, where a kept ridge is sure to be that.
    pub(super) ends_m: Option<f64>,
}

/// Elevations are multiples of this, in metres, which single precision holds exactly up to 131 km.
pub(super) const STEP_M: f64 = 1.0 / 64.0;

/// An elevation as a multiple of [`STEP_M`], not above it.
pub(super) fn stepped(elevation_m: f64) -> f64 {
    (elevation_m / STEP_M).floor() * STEP_M
}

/// Exchanges that are tried for each peak, each kind.
const TRIALS: usize = 300;

/// Casts `count` peaks like those of a range of number `kind`, from the highest to the lowest; where `with_highest`,
/// the first of them is the one that has neither key saddle nor isolation.
///
/// Each of the measures is drawn on its own, stratum by stratum, so that its histogram is right whatever comes after.
/// Then values are exchanged between peaks until the dominances (prominence over elevation) and the elevations and
/// isolations in each class of prominence are right too: what the paper draws anew for each pass.
pub(super) fn cast(target: &Target, kind: usize, count: usize, with_highest: bool, rng: &mut Rng) -> Vec<Role> {
    let mut elevations = target.elevation.draw(count, rng);
    let highest_m = if with_highest { elevations.pop() } else { None };
    let n = elevations.len();
    let mut prominences = target.prominence.draw(count, rng);
    if let Some(highest_m) = highest_m {
        let own = prominences.partition_point(|&p| p < highest_m).min(prominences.len() - 1);
        prominences.remove(own);
    }
    prominences.reverse();
    let class = classes(target, n);
    pair_elevations(target, &class, &prominences, &mut elevations, highest_m.is_some(), rng);
    let mut isolations = target.isolation.draw(n, rng);
    pair_isolations(target, &class, &mut isolations, rng);
    let mut azimuths = target.direction.draw(n, rng);
    // Statistics without directions have peaks in all of them.
    azimuths.resize_with(n, || rng.between(0.0, 360.0));
    rng.shuffle(&mut azimuths);
    let rises = rises(target, &isolations);
    let role = |i: usize| Role {
        elevation_m: elevations[i],
        prominence_m: prominences[i],
        isolation_m: isolations[i],
        azimuth: azimuths[i],
        rise_m: rises[i],
        kind,
        kept: None,
    };
    let mut roles: Vec<Role> = (0..n).map(role).collect();
    roles.extend(highest_m.map(|elevation_m| Role {
        elevation_m,
        prominence_m: elevation_m,
        isolation_m: f64::INFINITY,
        azimuth: 0.0,
        rise_m: None,
        kind,
        kept: None,
    }));
    roles
}

/// By how much the nearest higher peak is higher, for peaks of some isolations: as it is for the range's peak of the same
/// rank.
fn rises(target: &Target, isolations: &[f64]) -> Vec<Option<f64>> {
    let mut order: Vec<usize> = (0..isolations.len()).collect();
    order.sort_by(|&i, &j| isolations[i].total_cmp(&isolations[j]).then(i.cmp(&j)));
    let mut rises = vec![None; isolations.len()];
    for (rank, &i) in order.iter().enumerate() {
        rises[i] = target.rises_m.get(rank * target.rises_m.len() / isolations.len()).copied();
    }
    rises
}

/// The class of each of `count` peaks by falling prominence.
fn classes(target: &Target, count: usize) -> Vec<usize> {
    let weights: Vec<u64> = target.classes.iter().map(|class| class.weight).collect();
    let sizes = apportion(&weights, count);
    sizes.into_iter().enumerate().flat_map(|(class, size)| std::iter::repeat_n(class, size)).collect()
}

/// What a dominance counts for beside an elevation in its class.
const DOMINANCE_WEIGHT: i64 = 3;

/// For each class an empty tally of what it is to hold.
fn tallies<'a>(target: &'a Target, class: &[usize], strata: impl Fn(&'a Class) -> &'a Strata) -> Vec<Tally> {
    let size = |wanted: usize| class.iter().filter(|&&c| c == wanted).count();
    target.classes.iter().enumerate().map(|(c, of)| Tally::new(&strata(of).apportion(size(c)))).collect()
}

/// Exchanges elevations until dominances are right, and those in each class; `class` and `prominences` fall.
fn pair_elevations(
    target: &Target,
    class: &[usize],
    prominences: &[f64],
    elevations: &mut [f64],
    with_highest: bool,
    rng: &mut Rng,
) {
    let n = prominences.len();
    rng.shuffle(elevations);
    let bins = target.dominance.bins();
    // One bin more, which is wanted by none: no saddle lies below the sea.
    let dominance = |prominence_m: f64, elevation_m: f64| {
        if prominence_m > elevation_m { bins } else { target.dominance.bin(prominence_m / elevation_m) }
    };
    let mut wanted = target.dominance.apportion(n + usize::from(with_highest));
    wanted[bins - 1] = wanted[bins - 1].saturating_sub(usize::from(with_highest));
    wanted.push(0);
    let mut dominances = Tally::new(&wanted);
    let mut own = tallies(target, class, |class| &class.elevation);
    let bin = |c: usize, elevation_m: f64| target.classes[c].elevation.bin(elevation_m);
    for i in 0..n {
        dominances.add(dominance(prominences[i], elevations[i]));
        own[class[i]].add(bin(class[i], elevations[i]));
    }
    for _ in 0..n * TRIALS {
        let [i, j] = pair(n, rng);
        let (p, q) = (prominences[i], prominences[j]);
        let mut turn = |g: f64, h: f64| {
            let off = dominances.move_one(dominance(p, g), dominance(p, h))
                + dominances.move_one(dominance(q, h), dominance(q, g));
            DOMINANCE_WEIGHT * off
                + own[class[i]].move_one(bin(class[i], g), bin(class[i], h))
                + own[class[j]].move_one(bin(class[j], h), bin(class[j], g))
        };
        let (g, h) = (elevations[i], elevations[j]);
        if turn(g, h) > 0 {
            turn(h, g);
        } else {
            elevations.swap(i, j);
        }
    }
}

/// Exchanges isolations until each class of peaks has its own.
fn pair_isolations(target: &Target, class: &[usize], isolations: &mut [f64], rng: &mut Rng) {
    let n = isolations.len();
    rng.shuffle(isolations);
    let mut own = tallies(target, class, |class| &class.isolation);
    let bin = |c: usize, isolation_m: f64| target.classes[c].isolation.bin(isolation_m);
    for i in 0..n {
        own[class[i]].add(bin(class[i], isolations[i]));
    }
    for _ in 0..n * TRIALS {
        let [i, j] = pair(n, rng);
        let mut turn = |a: f64, b: f64| {
            own[class[i]].move_one(bin(class[i], a), bin(class[i], b))
                + own[class[j]].move_one(bin(class[j], b), bin(class[j], a))
        };
        let (a, b) = (isolations[i], isolations[j]);
        if turn(a, b) > 0 {
            turn(b, a);
        } else {
            isolations.swap(i, j);
        }
    }
}

#[allow(clippy::cast_possible_truncation, reason = "below a number of things in memory")]
fn pair(n: usize, rng: &mut Rng) -> [usize; 2] {
    [rng.below(n as u64) as usize, rng.below(n as u64) as usize]
}
