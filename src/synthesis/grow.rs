//! The divide tree: ridges between the peaks, and saddles so deep that prominences are as drawn.

use super::cast::{Role, STEP_M, stepped};
use super::ridges::Ridge;
use super::tally::Tally;
use super::target::Target;
use crate::components::root;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

/// A ridge of the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edge {
    /// Its number among those that there could be.
    pub(super) ridge: u32,
    /// Elevation of its saddle in metres.
    pub(super) saddle_m: f64,
    /// The peak that ends at the saddle.
    pub(super) ended: u32,
}

/// What grew.
pub(super) struct Grown {
    /// The ridges of the tree, by falling saddle.
    pub(super) edges: Vec<Edge>,
    /// New peaks whose prominence is another than any that was drawn.
    pub(super) missed: usize,
}

/// Whose turn it is; first whatever comes first at one elevation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Turn {
    /// A peak that wants to end.
    Peak(Reverse<u32>),
    /// A kept ridge.
    Kept(Reverse<u32>),
}

/// Peaks that are looked at for an exchange.
pub(super) const PARTNERS: usize = 64;

/// Grows the tree of peaks, which stand from the highest to the lowest.
///
/// A peak's key saddle lies its prominence below it. Peaks are ended by falling key saddle; when its turn comes, a
/// peak is the top of all that is joined to it so far, and its component is joined, by the cheapest ridge there is, to
/// a neighbouring one with a higher top. Saddles only fall on the way, so each is below the peaks at its ends, and a
/// sweep over the tree ends the same peaks at the same saddles: prominences are exact, whatever the ridges. Taking the
/// cheapest ridge out of a component is how Boruvka finds the minimum spanning tree of equation 1; the tree differs
/// from that only where such a ridge leads to a lower top.
///
/// Where a component has neighbours with lower tops alone, its peak cannot end yet. It then exchanges prominences with
/// a lower peak, so that the multiset stays as it was, and dominances as nearly as can be.
///
/// A kept ridge joins the components at its ends when the sweep comes to its saddle, and the lower of the two tops ends
/// there, whatever it was to have; what was drawn for it goes to a peak that was to have about what it has now. No other
/// ridge joins what kept ridges will join, so they never close a circle. A kept peak that no kept ridge is sure to end
/// looks for a ridge at its turn as all do, and waits for its kept ridges where there is none.
///
/// A kept peak that a kept ridge is sure to end does so at its own saddle. Of all components that kept ridges will join to
/// its own above that saddle none has a higher top: so it is in the tree that it comes from, and `is_allowed` sees to it
/// that no other ridge brings a higher one in.
pub(super) fn grow(roles: &mut [Role], ridges: &[Ridge], targets: &[&Target]) -> Grown {
    let mut growth = Growth::new(roles, ridges, targets);
    while let Some((level_m, turn)) = growth.next() {
        match turn {
            Turn::Kept(Reverse(ridge)) => growth.join(ridge, level_m),
            Turn::Peak(Reverse(peak)) => match growth.outlet(peak, level_m) {
                Some(ridge) => growth.end(peak, ridge, level_m),
                None => growth.put_off(peak, level_m),
            },
        }
    }
    Grown { edges: growth.edges, missed: growth.missed }
}

/// Whether a saddle would not lie below the sea, for a peak above it.
pub(super) fn fits(prominence_m: f64, elevation_m: f64) -> bool {
    elevation_m <= 0.0 || prominence_m <= elevation_m
}

/// Bits of a float that is not negative or small, in the order of its values.
pub(super) fn ordered(value: f64) -> i64 {
    #[allow(clippy::cast_possible_wrap, reason = "the bits as they are")]
    let bits = value.to_bits() as i64;
    if bits < 0 { i64::MIN - bits } else { bits }
}

/// A tree on the way.
pub(super) struct Growth<'a> {
    pub(super) roles: &'a mut [Role],
    pub(super) ridges: &'a [Ridge],
    pub(super) targets: &'a [&'a Target],
    /// For each peak the way to the top of its component.
    tops: Vec<u32>,
    /// For each top the ridges that leave its component, and some that no longer do.
    out: Vec<Vec<u32>>,
    /// For each peak the way to one of all that its component and kept ridges will join.
    linked: Vec<u32>,
    /// For each top the kept ridges that leave its component, and some that no longer do.
    pub(super) pending: Vec<Vec<u32>>,
    /// For each peak the elevation of the kept saddle that it waits for, if it does.
    pub(super) waits_m: Vec<Option<f64>>,
    /// Peaks by falling key saddle, with levels that may be old, and kept ridges.
    turns: BinaryHeap<(i64, Turn)>,
    /// Peaks that have not ended, by prominence.
    pub(super) left: BTreeSet<(i64, u32)>,
    /// Dominances of the peaks of each range.
    pub(super) dominances: Vec<Tally>,
    edges: Vec<Edge>,
    pub(super) missed: usize,
}

impl<'a> Growth<'a> {
    fn new(roles: &'a mut [Role], ridges: &'a [Ridge], targets: &'a [&'a Target]) -> Self {
        let n = roles.len();
        let mut out = vec![Vec::new(); n];
        for (number, ridge) in (0..).zip(ridges) {
            ridge.ends.iter().for_each(|&end| out[end as usize].push(number));
        }
        let of_kind = |kind: usize| roles.iter().filter(move |role| role.kind == kind && role.kept.is_none());
        let tally = |(kind, target): (usize, &&Target)| {
            let mut tally = Tally::new(&target.dominance.apportion(of_kind(kind).count()));
            of_kind(kind).for_each(|role| tally.add(target.dominance.bin(role.prominence_m / role.elevation_m)));
            tally
        };
        let dominances = targets.iter().enumerate().map(tally).collect();
        #[allow(clippy::cast_possible_truncation, reason = "peaks are counted with 32 bits")]
        let tops: Vec<u32> = (0..n as u32).collect();
        let mut growth = Self {
            roles,
            ridges,
            targets,
            linked: tops.clone(),
            tops,
            out,
            pending: vec![Vec::new(); n],
            waits_m: vec![None; n],
            turns: BinaryHeap::new(),
            left: BTreeSet::new(),
            dominances,
            edges: Vec::with_capacity(n.saturating_sub(1)),
            missed: 0,
        };
        for (number, ridge) in (0..).zip(ridges).filter(|(_, ridge)| ridge.kept.is_some()) {
            growth.turns.push((ordered(ridge.below_m), Turn::Kept(Reverse(number))));
            growth.link(ridge.ends);
            ridge.ends.iter().for_each(|&end| growth.pending[end as usize].push(number));
        }
        for peak in growth.tops.clone().into_iter().skip(1) {
            let role = &mut growth.roles[peak as usize];
            let Some(kept) = &role.kept else {
                if !fits(role.prominence_m, role.elevation_m) {
                    role.prominence_m = role.elevation_m;
                }
                role.prominence_m = role.elevation_m - stepped(role.elevation_m - role.prominence_m);
                growth.await_turn(peak);
                continue;
            };
            growth.waits_m[peak as usize] = kept.ends_m;
            if kept.ends_m.is_none() {
                growth.await_turn(peak);
            }
        }
        growth
    }

    fn level_m(&self, peak: u32) -> f64 {
        let role = &self.roles[peak as usize];
        role.elevation_m - role.prominence_m
    }

    fn await_turn(&mut self, peak: u32) {
        self.turns.push((ordered(self.level_m(peak)), Turn::Peak(Reverse(peak))));
        self.left.insert((ordered(self.roles[peak as usize].prominence_m), peak));
    }

    /// Whose turn it is, with the saddle's elevation.
    fn next(&mut self) -> Option<(f64, Turn)> {
        while let Some((level, turn)) = self.turns.pop() {
            let peak = match turn {
                Turn::Kept(Reverse(ridge)) => return Some((self.ridges[ridge as usize].below_m, turn)),
                Turn::Peak(Reverse(peak)) => peak,
            };
            let level_m = self.level_m(peak);
            let is_left = self.left.contains(&(ordered(self.roles[peak as usize].prominence_m), peak));
            if is_left && ordered(level_m) == level {
                return Some((level_m, turn));
            }
        }
        None
    }

    /// The top of a peak's component.
    pub(super) fn top(&mut self, peak: u32) -> u32 {
        root(&mut self.tops, peak)
    }

    /// Notes that two peaks will be joined.
    fn link(&mut self, ends: [u32; 2]) {
        let [a, b] = ends.map(|end| root(&mut self.linked, end));
        self.linked[a as usize] = b;
    }

    /// Whether two peaks will be joined by what is there and by kept ridges.
    pub(super) fn is_linked(&mut self, a: u32, b: u32) -> bool {
        root(&mut self.linked, a) == root(&mut self.linked, b)
    }

    /// The cheapest ridge from the component of a top to one with a higher top.
    fn outlet(&mut self, peak: u32, level_m: f64) -> Option<u32> {
        let mut ridges = std::mem::take(&mut self.out[peak as usize]);
        let mut best: Option<(f64, u32)> = None;
        let mut others = vec![];
        let is_bound = !self.pending[peak as usize].is_empty();
        ridges.retain(|&number| {
            let ridge = &self.ridges[number as usize];
            let [a, b] = ridge.ends.map(|end| self.top(end));
            let other = if a == peak { b } else { a };
            if other == peak || ridge.kept.is_some() {
                return other != peak;
            }
            if self.is_linked(peak, other) {
                return false;
            }
            let is_cheapest = best.is_none_or(|(weight, first)| (ridge.weight, number) < (weight, first));
            if other < peak && level_m < ridge.below_m && (is_bound || is_cheapest) {
                best = Some((ridge.weight, number));
                if is_bound {
                    others.push((ridge.weight, number, other));
                }
            }
            true
        });
        self.out[peak as usize] = ridges;
        if !is_bound {
            return best.map(|(_, number)| number);
        }
        others.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mine = self.reach(peak);
        let mut seen: BTreeMap<u32, bool> = BTreeMap::new();
        let mut is_allowed = |other: u32| {
            *seen.entry(other).or_insert_with(|| {
                let theirs = self.reach(other);
                self.is_allowed(&mine, &theirs) && self.is_allowed(&theirs, &mine)
            })
        };
        others.into_iter().find(|&(_, _, other)| is_allowed(other)).map(|(_, number, _)| number)
    }

    /// Ends a peak at a ridge's saddle.
    pub(super) fn end(&mut self, peak: u32, number: u32, level_m: f64) {
        let ends = self.ridges[number as usize].ends;
        let [a, b] = ends.map(|end| self.top(end));
        let higher = if a == peak { b } else { a };
        self.edges.push(Edge { ridge: number, saddle_m: level_m, ended: peak });
        self.left.remove(&(ordered(self.roles[peak as usize].prominence_m), peak));
        self.link(ends);
        self.tops[peak as usize] = higher;
        let mut mine = std::mem::take(&mut self.out[peak as usize]);
        let theirs = &mut self.out[higher as usize];
        if mine.len() > theirs.len() {
            std::mem::swap(&mut mine, theirs);
        }
        theirs.extend(mine);
        let bound = std::mem::take(&mut self.pending[peak as usize]);
        self.pending[higher as usize].extend(bound);
    }

    /// The elevation at which a top ends, as far as is known.
    fn awaited_m(&self, peak: u32) -> f64 {
        self.waits_m[peak as usize].unwrap_or_else(|| self.level_m(peak))
    }

    /// Gives a peak that cannot end yet a greater prominence, or lets it wait for a kept ridge.
    fn put_off(&mut self, peak: u32, level_m: f64) {
        // Nothing changes for it before one of its neighbours has ended.
        let (mut next_m, mut kept_m) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for number in self.out[peak as usize].clone() {
            let ridge = self.ridges[number as usize];
            let [a, b] = ridge.ends.map(|end| self.top(end));
            let other = if a == peak { b } else { a };
            if ridge.kept.is_some() {
                kept_m = kept_m.max(ridge.below_m);
            } else if other > peak || ridge.below_m <= level_m {
                let neighbour_m = if other < peak { f64::INFINITY } else { self.awaited_m(other) };
                next_m = next_m.max(neighbour_m.min(stepped(ridge.below_m - STEP_M)));
            }
            // All others are barred by what waits for kept ridges, of which one is at its own component.
        }
        let Role { elevation_m, prominence_m, .. } = self.roles[peak as usize];
        if kept_m > f64::NEG_INFINITY && kept_m >= next_m {
            self.waits_m[peak as usize] = Some(kept_m);
            self.left.remove(&(ordered(prominence_m), peak));
            return;
        }
        if next_m == f64::NEG_INFINITY {
            // Without any neighbour it is apart from all others, which a triangulation rules out.
            self.left.remove(&(ordered(prominence_m), peak));
            return;
        }
        self.exchange(peak, (elevation_m - next_m).max(prominence_m + STEP_M), level_m);
    }

    /// Gives a peak a prominence of `needed_m` or more, in exchange with another if that can be.
    pub(super) fn exchange(&mut self, peak: u32, needed_m: f64, level_m: f64) {
        let Role { prominence_m, kept, .. } = self.roles[peak as usize];
        match self.partner(peak, needed_m, level_m) {
            Some(partner) => {
                let theirs_m = self.roles[partner as usize].prominence_m;
                self.set(peak, theirs_m);
                self.set(partner, prominence_m);
            }
            None => {
                self.missed += usize::from(kept.is_none());
                self.set(peak, needed_m + STEP_M);
            }
        }
    }

    pub(super) fn dominance_bin(&self, peak: u32, prominence_m: f64) -> usize {
        let Role { elevation_m, kind, .. } = self.roles[peak as usize];
        self.targets[kind].dominance.bin(prominence_m / elevation_m)
    }

    pub(super) fn set(&mut self, peak: u32, prominence_m: f64) {
        let old_m = self.roles[peak as usize].prominence_m;
        self.left.remove(&(ordered(old_m), peak));
        let Role { kind, kept, .. } = self.roles[peak as usize];
        if kept.is_none() {
            let (from, to) = (self.dominance_bin(peak, old_m), self.dominance_bin(peak, prominence_m));
            self.dominances[kind].move_one(from, to);
        }
        self.roles[peak as usize].prominence_m = prominence_m;
        self.await_turn(peak);
    }

    /// A lower peak that has not ended and has a prominence of `needed_m` or little more, which it can exchange for
    /// that of `peak`; the one after whose exchange dominances are best.
    fn partner(&mut self, peak: u32, needed_m: f64, level_m: f64) -> Option<u32> {
        let Role { elevation_m, prominence_m, kind, kept, .. } = self.roles[peak as usize];
        if kept.is_some() {
            // What it has was not drawn.
            return None;
        }
        let mut candidates = Vec::with_capacity(PARTNERS);
        for &(_, other) in self.left.range((ordered(needed_m), 0)..) {
            let role = &self.roles[other as usize];
            // A higher peak would end above the saddles that are there already.
            let is_fit = other > peak && role.kind == kind && role.kept.is_none();
            let can_take = fits(prominence_m, role.elevation_m) && fits(role.prominence_m, elevation_m);
            if is_fit && can_take && role.elevation_m - prominence_m <= level_m {
                candidates.push(other);
                if candidates.len() == PARTNERS {
                    break;
                }
            }
        }
        let mut best: Option<(i64, u32)> = None;
        for other in candidates {
            let theirs_m = self.roles[other as usize].prominence_m;
            let moves = [
                (self.dominance_bin(peak, prominence_m), self.dominance_bin(peak, theirs_m)),
                (self.dominance_bin(other, theirs_m), self.dominance_bin(other, prominence_m)),
            ];
            let tally = &mut self.dominances[kind];
            let change: i64 = moves.iter().map(|&(from, to)| tally.move_one(from, to)).sum();
            moves.iter().rev().for_each(|&(from, to)| {
                tally.move_one(to, from);
            });
            if best.is_none_or(|(least, _)| change < least) {
                best = Some((change, other));
            }
        }
        best.map(|(_, other)| other)
    }
}

#[cfg(test)]
mod tests {
    use super::super::target::Class;
    use super::*;
    use crate::orometry::distributions::{BinSet, Measure};
    use crate::synthesis::strata::Strata;
    use proptest::prelude::*;

    /// A target of which growth only wants the bins of dominance.
    fn target() -> Target {
        let edges = BinSet::Fine.edges(Measure::Dominance, (0.0, 0.0)).unwrap();
        let strata = Strata::of_bins(edges.windows(2).map(|pair| (pair[0], pair[1], 1)));
        Target {
            elevation: strata.clone(),
            prominence: strata.clone(),
            dominance: strata.clone(),
            isolation: strata.clone(),
            direction: strata.clone(),
            rises_m: vec![],
            classes: vec![Class { weight: 1, elevation: strata.clone(), isolation: strata }],
            peak_count: 1,
            density_per_100_km2: None,
        }
    }

    fn ridge(ends: [u32; 2], weight: f64) -> Ridge {
        Ridge { ends, joints: ends, weight, beside: [None; 2], below_m: f64::INFINITY, kept: None }
    }

    /// For each peak but the first the elevation of its key saddle: of all ways in the tree to a higher peak the
    /// greatest lowest saddle.
    fn key_saddles(n: usize, edges: &[Edge], ridges: &[Ridge]) -> Vec<f64> {
        let way = |from: u32| {
            let mut lowest = vec![f64::NAN; n];
            lowest[from as usize] = f64::INFINITY;
            for _ in 0..n {
                for edge in edges {
                    let [a, b] = ridges[edge.ridge as usize].ends.map(|end| end as usize);
                    for (a, b) in [(a, b), (b, a)] {
                        if lowest[b].is_nan() && !lowest[a].is_nan() {
                            lowest[b] = lowest[a].min(edge.saddle_m);
                        }
                    }
                }
            }
            lowest
        };
        (1..n as u32).map(|peak| way(peak)[..peak as usize].iter().copied().fold(f64::NEG_INFINITY, f64::max)).collect()
    }

    proptest! {
        #[test]
        fn prominences_are_as_they_were_drawn(
            drawn in prop::collection::vec((1..4000_u32, 1..1000_u32), 2..40),
            extra in prop::collection::vec((any::<u32>(), any::<u32>(), 0..50_u32), 0..80),
        ) {
            let mut elevations: Vec<u32> = drawn.iter().map(|d| d.0 * 64).collect();
            elevations.sort_unstable_by(|a, b| b.cmp(a));
            elevations.dedup();
            let n = elevations.len();
            let mut roles: Vec<Role> = elevations.iter().zip(&drawn).map(|(&h, d)| {
                let elevation_m = f64::from(h) * STEP_M;
                let prominence_m = (elevation_m * f64::from(d.1) / 1000.0 / STEP_M).floor().max(1.0) * STEP_M;
                Role { elevation_m, prominence_m, isolation_m: 1.0, azimuth: 0.0, rise_m: None, kind: 0, kept: None }
            }).collect();
            // A path through all peaks, so that the graph is in one piece, and more.
            let path = (1..n as u32).map(|i| (i - 1, i, i * 7 % 50));
            let other = extra.iter().map(|&(a, b, w)| (a % n as u32, b % n as u32, w)).filter(|(a, b, _)| a != b);
            let ridges: Vec<Ridge> = path
                .chain(other)
                .map(|(a, b, w)| ridge([a.min(b), a.max(b)], f64::from(w)))
                .collect();
            let mut before: Vec<f64> = roles[1..].iter().map(|role| role.prominence_m).collect();
            let grown = grow(&mut roles, &ridges, &[&target()]);
            prop_assert_eq!(grown.edges.len(), n - 1);
            prop_assert!(grown.edges.windows(2).all(|pair| pair[0].saddle_m >= pair[1].saddle_m));
            for edge in &grown.edges {
                for end in ridges[edge.ridge as usize].ends {
                    prop_assert!(edge.saddle_m < roles[end as usize].elevation_m);
                }
            }
            for (role, saddle_m) in roles[1..].iter().zip(key_saddles(n, &grown.edges, &ridges)) {
                prop_assert_eq!(role.elevation_m - saddle_m, role.prominence_m);
            }
            if grown.missed == 0 {
                let mut after: Vec<f64> = roles[1..].iter().map(|role| role.prominence_m).collect();
                before.sort_by(f64::total_cmp);
                after.sort_by(f64::total_cmp);
                prop_assert_eq!(before, after, "the multiset is as it was drawn");
            }
        }
    }
}
