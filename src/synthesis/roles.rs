//! The peaks of all ranges, and those that are kept, before the new ones have a place.

use super::cast::{Fixed, Role, STEP_M, cast, stepped};
use super::controls::Weights;
use super::kept::Kept;
use super::target::Target;
use crate::crs::Metric;
use crate::rng::Rng;
use std::collections::BTreeSet;

/// Casts `counts` peaks like those of each range, beside those that are kept; from the highest to the lowest, without
/// equals but for kept ones. The first has no key saddle and no isolation.
///
/// A kept peak has its prominence. Where nobody knows that, it takes the place, and the prominence, of one that was cast
/// as high for it.
pub(super) fn roles<M: Metric + ?Sized>(
    targets: &[&Target],
    counts: &[usize],
    kept: &Kept,
    weights: &Weights<'_, M>,
    rng: &dyn Fn(u64) -> Rng,
) -> Vec<Role> {
    let mut fixed = fixed(kept, weights, targets.len());
    let top_m = |kind: &usize| targets[*kind].elevation.quantile(1.0);
    let kept_m = fixed.first().map_or(f64::NEG_INFINITY, |role| role.elevation_m);
    // One more is cast for each peak whose prominence nobody knows.
    let numbers = |is_first_kept: bool| {
        let mut numbers = counts.to_vec();
        let unknown = fixed.iter().skip(usize::from(is_first_kept)).filter(|role| role.prominence_m.is_nan());
        unknown.for_each(|role| numbers[role.kind] += 1);
        numbers
    };
    let highest_kind = |numbers: &[usize]| -> Option<usize> {
        let there = (0..targets.len()).filter(|&kind| numbers[kind] > 0);
        there.max_by(|a, b| top_m(a).total_cmp(&top_m(b)).then(b.cmp(a)))
    };
    let all = |numbers: &[usize], highest: Option<usize>| {
        let mut roles: Vec<Role> = Vec::with_capacity(numbers.iter().sum());
        for (kind, (target, &count)) in targets.iter().zip(numbers).enumerate() {
            roles.extend(cast(target, kind, count, Some(kind) == highest, &mut rng(16 + kind as u64)));
        }
        roles
    };
    let mut roles = all(&numbers(false), highest_kind(counts));
    let highest_m = roles.iter().map(|role| role.elevation_m).fold(f64::NEG_INFINITY, f64::max);
    let has_none = counts.iter().all(|&count| count == 0);
    let is_first_kept = !fixed.is_empty() && (has_none || stepped(highest_m) <= kept_m);
    if is_first_kept {
        // The one without a key saddle is kept: another is cast in vain.
        let mut own = numbers(true);
        let highest = highest_kind(&own);
        highest.into_iter().for_each(|kind| own[kind] += 1);
        roles = all(&own, highest);
        roles.retain(|role| role.isolation_m < f64::INFINITY);
    }
    let unknown = fixed.iter_mut().skip(usize::from(is_first_kept)).filter(|role| role.prominence_m.is_nan());
    for role in unknown {
        let off = |other: &Role| (other.elevation_m - role.elevation_m).abs();
        let alike = (0..roles.len()).filter(|&i| roles[i].kind == role.kind && roles[i].isolation_m < f64::INFINITY);
        let Some(nearest) = alike.min_by(|&i, &j| off(&roles[i]).total_cmp(&off(&roles[j]))) else { continue };
        let prominence_m = roles.remove(nearest).prominence_m;
        // No saddle lies below the sea.
        role.prominence_m = if role.elevation_m > 0.0 { prominence_m.min(role.elevation_m) } else { prominence_m };
    }
    distinguish(&mut roles, &fixed);
    roles.extend(fixed);
    sort(&mut roles);
    if let Some(first) = roles.first_mut() {
        (first.prominence_m, first.isolation_m) = (first.elevation_m, f64::INFINITY);
    }
    roles
}

/// The roles of kept peaks, from the highest to the lowest; their prominence is NaN where nobody knows it.
fn fixed<M: Metric + ?Sized>(kept: &Kept, weights: &Weights<'_, M>, kinds: usize) -> Vec<Role> {
    let own_m = kept.own_prominences_m();
    let role = |(number, (peak, own_m)): (u32, (&super::KeptPeak, &Option<f64>))| {
        let is_sure = own_m.is_some() && *own_m == peak.prominence_m;
        let saddle_m = |prominence_m: &f64| peak.elevation_m - prominence_m;
        let ends_m = own_m.as_ref().filter(|_| is_sure).map(saddle_m);
        Role {
            elevation_m: peak.elevation_m,
            prominence_m: peak.prominence_m.unwrap_or(f64::NAN),
            isolation_m: f64::INFINITY,
            azimuth: 0.0,
            rise_m: None,
            kind: weights.kind(peak.place, kinds),
            kept: Some(Fixed { number, place: peak.place, ends_m }),
        }
    };
    let mut roles: Vec<Role> = (0..).zip(kept.peaks.iter().zip(&own_m)).map(role).collect();
    sort(&mut roles);
    roles
}

/// Puts roles into the order from the highest to the lowest; equals are kept, and stand in the order of their places.
fn sort(roles: &mut [Role]) {
    let place = |role: &Role| role.kept.map(|kept| kept.place);
    roles.sort_by(|a, b| b.elevation_m.total_cmp(&a.elevation_m).then_with(|| place(a).cmp(&place(b))));
}

/// Makes the elevations of new peaks multiples of a step, all different from each other and from those of kept ones.
/// The first has no key saddle and no isolation.
fn distinguish(roles: &mut [Role], fixed: &[Role]) {
    roles.sort_by(|a, b| b.elevation_m.total_cmp(&a.elevation_m).then(a.kind.cmp(&b.kind)));
    let bits = |elevation_m: f64| (elevation_m + 0.0).to_bits();
    let taken: BTreeSet<u64> = fixed.iter().map(|role| bits(role.elevation_m)).collect();
    let mut above_m = f64::INFINITY;
    for role in roles.iter_mut() {
        role.elevation_m = stepped(role.elevation_m).min(above_m - STEP_M);
        while taken.contains(&bits(role.elevation_m)) {
            role.elevation_m -= STEP_M;
        }
        above_m = role.elevation_m;
    }
    // Another range may have come out a little higher than the one that was expected to.
    if let Some(expected) = roles.iter().position(|role| role.isolation_m == f64::INFINITY) {
        let Role { prominence_m, isolation_m, azimuth, rise_m, .. } = roles[0];
        let other = &mut roles[expected];
        (other.prominence_m, other.isolation_m, other.azimuth) = (prominence_m, isolation_m, azimuth);
        other.rise_m = rise_m;
        (roles[0].prominence_m, roles[0].isolation_m) = (roles[0].elevation_m, f64::INFINITY);
    }
}
