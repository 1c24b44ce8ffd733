//! Dart throwing: a place for every peak.

use super::cast::Role;
use super::controls::{Weights, bell};
use super::corridors::Corridors;
use super::extent::{Extent, compass};
use super::target::Target;
use crate::crs::{Metric, Place};
use crate::error::{Error, ErrorKind, Result};
use crate::orometry::Crowd;
use crate::rng::Rng;
use crate::watch::Watch;
use std::ops::Range;

/// Peaks with their places, from the highest to the lowest.
pub(super) struct Thrown {
    pub(super) roles: Vec<Role>,
    pub(super) places: Vec<Place>,
    /// Peaks that found no room at their isolation.
    pub(super) misplaced: usize,
}

/// Places that are tried in the direction that was drawn.
const AIMED: usize = 200;
/// Places that are tried in any direction.
const LOOSE: usize = 600;
/// Peaks further down whose isolation may be taken instead.
const OTHERS: usize = 200;
/// Places that are tried for each of those.
const OTHERS_TRIALS: usize = 20;
/// How well a place in the direction that was drawn fits if no other direction is tried; 1 is as well as can be.
const GOOD_ENOUGH: f64 = 0.3;
/// Rises to the nearest higher peak are off by this part of themselves, and by so many metres.
const RISE_PART: f64 = 0.2;
const RISE_M: f64 = 5.0;
/// No two peaks are nearer to each other, in steps between cells: there is a saddle between them.
const LEAST_STEPS: f64 = 3.0;
/// In the bin that begins at 0 isolations are no less than this part of its width, as those of real peaks are.
const LEAST_PART: f64 = 0.5;

/// How far off the rise to the nearest higher peak may well be, in metres.
fn deviation_m(rise_m: f64) -> f64 {
    RISE_PART * rise_m + RISE_M
}

/// Places peaks from the highest to the lowest.
///
/// How far a peak is from the nearest higher one depends on the higher ones alone. Placed in this order, a peak gets
/// its isolation when it gets its place, and no peak that comes later changes it: what the paper leaves to the chance
/// of acceptance is exact here. A dart is thrown at the drawn distance and direction from a random peak, and counts
/// where no other peak is nearer. Kept peaks are where they are.
pub(super) fn throw<M: Metric + ?Sized>(
    targets: &[&Target],
    mut roles: Vec<Role>,
    extent: &Extent<'_, M>,
    weights: &Weights<'_, M>,
    rng: &mut Rng,
    watch: &Watch,
) -> Result<Thrown> {
    let mut crowd = Crowd::new(extent.size(), extent.metric, roles.len());
    let mut corridors = Corridors::new(extent, roles.len());
    let elevations_m: Vec<f64> = roles.iter().map(|role| role.elevation_m).collect();
    let mut misplaced = 0;
    watch.begin("placing peaks", roles.len() as u64);
    for i in 0..roles.len() {
        if i % 256 == 0 {
            watch.advance(256.min(roles.len() - i) as u64)?;
        }
        let elevations_m = &elevations_m[..i];
        let darts = Darts { targets, extent, crowd: &crowd, elevations_m, corridors: &corridors, weights };
        let place = match i {
            _ if roles[i].kept.is_some() => roles[i].kept.map(|kept| kept.place),
            0 => darts.anywhere(&roles[0], rng),
            _ => darts.find(&mut roles, i, rng).or_else(|| {
                misplaced += 1;
                darts.gap(&roles[i], rng)
            }),
        };
        let Some(place) = place else {
            return Err(Error::new(
                ErrorKind::Input,
                format!("the extent has no room for more than {i} of {} peaks", roles.len()),
            ));
        };
        let is_sure = roles[i].kept.is_some_and(|kept| kept.ends_m.is_some());
        if let Some((_, higher)) = crowd.nearest(place, 0.0, f64::INFINITY).filter(|_| !is_sure) {
            let higher = crowd.places()[higher as usize];
            corridors.add(place, higher, roles[i].elevation_m - roles[i].prominence_m);
        }
        crowd.add(place);
    }
    Ok(Thrown { roles, places: crowd.places().to_vec(), misplaced })
}

/// What the darts of one peak are thrown at.
struct Darts<'a, M: ?Sized> {
    targets: &'a [&'a Target],
    extent: &'a Extent<'a, M>,
    crowd: &'a Crowd<'a, M>,
    /// Of the peaks in the crowd.
    elevations_m: &'a [f64],
    corridors: &'a Corridors<'a, M>,
    weights: &'a Weights<'a, M>,
}

impl<M: Metric + ?Sized> Darts<'_, M> {
    /// A place for peak `i`, which may exchange its isolation with a lower peak's.
    fn find(&self, roles: &mut [Role], i: usize, rng: &mut Rng) -> Option<Place> {
        let role = roles[i];
        let mut found = self.at(&role, role.isolation_m, Some(role.azimuth), AIMED, rng);
        if found.is_none_or(|(weight, _)| weight < GOOD_ENOUGH) {
            // The maps and the rise count for more than the direction.
            let loose = self.at(&role, role.isolation_m, None, LOOSE, rng);
            found = found.into_iter().chain(loose).max_by(|a, b| a.0.total_cmp(&b.0));
        }
        if let Some((_, place)) = found {
            return Some(place);
        }
        let left = (roles.len() - i - 1).min(OTHERS);
        for _ in 0..left {
            let j = i + 1 + rng.below((roles.len() - i - 1) as u64) as usize;
            let is_other = roles[j].kind != role.kind || roles[j].kept.is_some();
            if roles[j].isolation_m >= role.isolation_m || is_other {
                continue;
            }
            let other = Role { rise_m: roles[j].rise_m, ..role };
            let found = self.at(&other, roles[j].isolation_m, None, OTHERS_TRIALS, rng);
            if let Some((_, place)) = found {
                (roles[i].isolation_m, roles[i].rise_m) = (roles[j].isolation_m, roles[j].rise_m);
                (roles[j].isolation_m, roles[j].rise_m) = (role.isolation_m, role.rise_m);
                return Some(place);
            }
        }
        None
    }

    /// A place whose isolation falls into the same bin as the given one, and how well it fits: 1 where it was drawn, else
    /// the best weight that was seen.
    fn at(
        &self,
        role: &Role,
        isolation_m: f64,
        azimuth: Option<f64>,
        trials: usize,
        rng: &mut Rng,
    ) -> Option<(f64, Place)> {
        let (from_m, to_m) = self.targets[role.kind].isolation.bounds(isolation_m);
        let (from_m, isolation_m) = if from_m > 0.0 {
            (from_m, isolation_m)
        } else {
            let least_m = (LEAST_PART * to_m).max(LEAST_STEPS * self.extent.steps_m(0).0.max(self.extent.steps_m(0).1));
            (least_m, least_m + (to_m - least_m).max(0.0) * (isolation_m / to_m))
        };
        let level_m = role.elevation_m - role.prominence_m;
        let mut best: Option<(f64, Place)> = None;
        let all = 0..self.elevations_m.len();
        let fitting = self.fitting(role);
        for trial in 0..trials {
            // As high as it is to be one time, any the other.
            let among = if trial % 2 == 0 { &fitting } else { &all };
            #[allow(clippy::cast_possible_truncation, reason = "a position in memory")]
            let from = self.crowd.places()[among.start + rng.below(among.len() as u64) as usize];
            let (east, north) = compass(azimuth.unwrap_or_else(|| rng.between(0.0, 360.0)));
            let Some(place) = self.extent.beside(from, -east * isolation_m, -north * isolation_m) else { continue };
            let weight = self.weights.at(place, role.elevation_m, role.kind);
            // No need to look around where nothing better is to be had.
            if weight <= best.map_or(0.0, |(best, _)| best) {
                continue;
            }
            match self.crowd.nearest(place, from_m, to_m) {
                Some((distance_m, higher)) if distance_m >= from_m && self.corridors.are_open(place, level_m) => {
                    let weight = weight * self.likelihood(role, higher);
                    if weight >= 1.0 || rng.unit() < weight {
                        return Some((1.0, place));
                    }
                    if weight > best.map_or(0.0, |(best, _)| best) {
                        best = Some((weight, place));
                    }
                }
                _ => {}
            }
        }
        best
    }

    /// The peaks that are higher than one by about as much as the nearest is to be; all where that is not known, or where
    /// there is none.
    fn fitting(&self, role: &Role) -> Range<usize> {
        let all = 0..self.elevations_m.len();
        let Some(rise_m) = role.rise_m else { return all };
        // They stand from the highest to the lowest.
        let above = |rise_m: f64| self.elevations_m.partition_point(|&m| m > role.elevation_m + rise_m);
        let near = above(rise_m + deviation_m(rise_m))..above(rise_m - deviation_m(rise_m));
        if near.is_empty() { all } else { near }
    }

    /// How well a peak of the crowd is as much higher as it is to be: 0 to 1.
    fn likelihood(&self, role: &Role, higher: u32) -> f64 {
        role.rise_m.map_or(1.0, |rise_m| {
            bell((self.elevations_m[higher as usize] - role.elevation_m - rise_m) / deviation_m(rise_m))
        })
    }

    /// The roomiest of some random places, for a peak that found none at its isolation.
    fn gap(&self, role: &Role, rng: &mut Rng) -> Option<Place> {
        let mut best: Option<(f64, Place)> = None;
        for _ in 0..AIMED {
            let Some(place) = self.anywhere(role, rng) else { continue };
            let room_m = self.crowd.nearest(place, 0.0, role.isolation_m).map_or(role.isolation_m, |(m, _)| m);
            if best.is_none_or(|(most_m, _)| room_m > most_m) {
                best = Some((room_m, place));
            }
        }
        best.filter(|&(room_m, _)| room_m > 0.0).map(|(_, place)| place)
    }

    /// A random place, as likely as its weight.
    fn anywhere(&self, role: &Role, rng: &mut Rng) -> Option<Place> {
        let mut best: Option<(f64, Place)> = None;
        for _ in 0..LOOSE {
            let place = (rng.below(self.extent.rows as u64) as i64, rng.below(self.extent.cols as u64) as i64);
            let weight = self.weights.at(place, role.elevation_m, role.kind);
            if weight > 0.0 && rng.unit() < weight {
                return Some(place);
            }
            if weight > best.map_or(0.0, |(best, _)| best) {
                best = Some((weight, place));
            }
        }
        best.map(|(_, place)| place)
    }
}
