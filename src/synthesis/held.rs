//! Kept ridges as the tree grows, and what they hold back.

use super::cast::Role;
use super::grow::{Growth, PARTNERS, fits, ordered};
use std::collections::BTreeSet;

impl Growth<'_> {
    /// Joins what is on both sides of a kept ridge.
    pub(super) fn join(&mut self, number: u32, saddle_m: f64) {
        let [a, b] = self.ridges[number as usize].ends.map(|end| self.top(end));
        let (high, low) = (a.min(b), a.max(b));
        if self.roles[low as usize].kept.is_none_or(|kept| kept.ends_m.is_none()) {
            self.force(low, saddle_m);
        }
        self.waits_m[low as usize] = None;
        self.end(low, number, saddle_m);
        let is_sure = self.roles[high as usize].kept.is_some_and(|kept| kept.ends_m.is_some());
        if !is_sure && self.waits_m[high as usize].take().is_some() {
            // It has new neighbours, and its turn is over.
            let needed_m = self.roles[high as usize].elevation_m - saddle_m;
            self.left.insert((ordered(self.roles[high as usize].prominence_m), high));
            self.exchange(high, needed_m, saddle_m);
        }
    }

    /// Gives a peak the prominence that it has above a kept saddle. What was drawn for it goes to one that was to have
    /// about as much, of those that can still end there.
    fn force(&mut self, peak: u32, saddle_m: f64) {
        let Role { elevation_m, prominence_m, kind, kept, .. } = self.roles[peak as usize];
        let forced_m = elevation_m - saddle_m;
        self.left.remove(&(ordered(prominence_m), peak));
        self.roles[peak as usize].prominence_m = forced_m;
        if kept.is_some() || forced_m == prominence_m {
            return;
        }
        let (from, to) = (self.dominance_bin(peak, prominence_m), self.dominance_bin(peak, forced_m));
        self.dominances[kind].move_one(from, to);
        let target = self.targets[kind];
        let can_take = |&&(_, other): &&(i64, u32)| {
            let role = &self.roles[other as usize];
            let is_alike = target.prominence.bin(role.prominence_m) == target.prominence.bin(forced_m);
            let can_end = fits(prominence_m, role.elevation_m) && role.elevation_m - prominence_m <= saddle_m;
            role.kept.is_none() && role.kind == kind && is_alike && can_end
        };
        let here = (ordered(forced_m), 0);
        let above = self.left.range(here..).take(PARTNERS).find(can_take);
        let below = self.left.range(..here).rev().take(PARTNERS).find(can_take);
        let off = |other: &u32| (self.roles[*other as usize].prominence_m - forced_m).abs();
        let nearest = above.into_iter().chain(below).map(|own| own.1).min_by(|a, b| off(a).total_cmp(&off(b)));
        match nearest {
            Some(other) => self.set(other, prominence_m),
            None => self.missed += 1,
        }
    }

    /// The tops of the components that kept ridges will join to that of a top, itself among them, each with the lowest
    /// saddle of the way there.
    pub(super) fn reach(&mut self, peak: u32) -> Vec<(f64, u32)> {
        let mut found = vec![(f64::INFINITY, peak)];
        let mut seen = BTreeSet::from([peak]);
        let mut next = 0;
        while let Some(&(lowest_m, here)) = found.get(next) {
            next += 1;
            let mut pending = std::mem::take(&mut self.pending[here as usize]);
            pending.retain(|&number| {
                let ridge = &self.ridges[number as usize];
                let [a, b] = ridge.ends.map(|end| self.top(end));
                let other = if a == here { b } else { a };
                if other != here && seen.insert(other) {
                    found.push((lowest_m.min(ridge.below_m), other));
                }
                other != here
            });
            self.pending[here as usize] = pending;
        }
        found
    }

    /// Whether no top of `others` would come in above a peak of `own` before its kept ridge ends it.
    pub(super) fn is_allowed(&self, own: &[(f64, u32)], others: &[(f64, u32)]) -> bool {
        // The highest top of all that are reached by ways as high as each.
        let mut falling = others.to_vec();
        falling.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut highest = u32::MAX;
        for other in &mut falling {
            highest = highest.min(other.1);
            other.1 = highest;
        }
        own.iter().all(|&(lowest_m, peak)| {
            let Some(ends_m) = self.roles[peak as usize].kept.and_then(|kept| kept.ends_m) else { return true };
            let reached = falling.partition_point(|other| other.0 > ends_m);
            lowest_m <= ends_m || reached == 0 || falling[reached - 1].1 > peak
        })
    }
}
