//! Rays followed to the ground over quads, many at a time, so that whole blocks of points are evaluated at once.

use super::line::{Hit, Line, Progress, Verdict};
use super::quads::{Plans, Quads};
use super::seek::Place;
use super::sweep::{Fate, Goal, Sweep};
use super::tracer::{Memory, Tally};
use crate::construction::bounds::THRESHOLD;
use crate::construction::point::WIDTH;

/// A line on its way.
struct Walker<'q, 't> {
    index: usize,
    progress: Progress,
    /// Whether the next place is between two that were looked at: quads know nothing of it.
    between: bool,
    place: Option<Place<'q, 't>>,
    /// Where the line is looked at: the place itself, or further ahead.
    ahead_m: f64,
    /// Whether a look ahead has failed: then the place itself is looked at.
    retry: bool,
    /// How fast the line came down on the ground lately, per metre of way.
    fall: Option<f64>,
    /// Whether the line may pass below the ground, no further than the ground is met from above: of use if it is met.
    bold: bool,
    /// Whether it may have done so.
    doubted: bool,
    done: bool,
}

/// The share of the way to where a look ahead should still succeed that is gone.
const BOLDNESS: f64 = 0.9;

impl Walker<'_, '_> {
    /// A line that is to be followed.
    fn new(index: usize, line: &Line, bold: bool) -> Self {
        Self {
            index,
            progress: Progress::new(line.from_m),
            between: false,
            place: None,
            ahead_m: line.from_m,
            retry: false,
            fall: None,
            bold,
            doubted: false,
            done: false,
        }
    }

    /// How far below the ground the line may pass, in metres.
    fn spare_m(&mut self, line: &Line, t_m: f64) -> f64 {
        self.doubted |= self.bold;
        if self.bold { line.near_m(t_m) } else { 0.0 }
    }

    /// Sets where to look next. The ground between the place and a point ahead is proved to be below the line if the
    /// height ahead is at least what it can have grown by since (the other half of sphere tracing's step, looking
    /// back); so the look goes as far ahead as that is likely, judged by the last heights.
    fn look(&mut self, line: &Line) {
        let Some(place) = &self.place else { return };
        self.ahead_m = place.t_m;
        if std::mem::take(&mut self.retry) || self.between {
            return;
        }
        let (Some((t, height)), Some([shrinks, grows])) = (self.progress.last(), line.speeds(&place.quad.bounds))
        else {
            return;
        };
        let fall = self.fall.unwrap_or(0.5 * shrinks).max(0.0);
        let likely = height - fall * (place.t_m - t);
        let speed = fall + grows.max(0.0);
        if likely > 0.0 && place.t_m > t && speed > 0.0 {
            self.ahead_m = (place.t_m + BOLDNESS * likely / speed).min(place.exit_m).min(line.to_m).max(place.t_m);
        }
    }

    /// Whether a look ahead, at a height, proves what lies between; otherwise the place itself is next.
    fn proves(&mut self, line: &Line, height_m: f64) -> bool {
        let Some(place) = &self.place else { return false };
        if self.ahead_m <= place.t_m {
            return true;
        }
        let (bounds, way_m) = (place.quad.bounds, self.ahead_m - place.t_m);
        let spare_m = self.spare_m(line, self.ahead_m - way_m);
        self.retry = !line.clears(&bounds, way_m, height_m + spare_m);
        !self.retry
    }
}

/// Something to sort by: walkers that need the same plans stand together. The order has no influence on results.
fn address(plans: &Plans<'_>) -> usize {
    std::ptr::from_ref(plans).addr()
}

impl<'t> Quads<'t> {
    /// Where lines meet the ground.
    pub(super) fn follow(
        &self,
        lines: &[Option<Line>],
        goal: Goal,
        hits: &mut [Option<Hit>],
        max_steps: u32,
        memory: &mut Memory,
        tally: &mut Tally,
    ) {
        hits.fill(None);
        let mut lines = lines.to_vec();
        if let Some(sweep) = self.sweep(&lines, goal, &mut memory.scattered) {
            self.settle(&sweep, &lines, hits, memory, tally);
            for (index, line) in lines.iter_mut().enumerate() {
                let doubt_m = sweep.doubts_m[index];
                let told = sweep.fates[index] == Fate::Under || hits[index].is_some() || doubt_m == f64::INFINITY;
                *line = line.filter(|_| !told).map(|line| Line { from_m: line.from_m.max(doubt_m), ..line });
            }
        }
        let lines = &lines[..];
        let mut open: Vec<Walker<'_, 't>> = vec![];
        for (index, line) in lines.iter().enumerate() {
            if let Some(line) = line {
                open.push(Walker::new(index, line, goal == Goal::Ground));
            }
        }
        while !open.is_empty() {
            open.retain_mut(|walker| {
                let Some(line) = &lines[walker.index] else { return false };
                loop {
                    let t = walker.progress.t_m;
                    if walker.between {
                        walker.place = self.anywhere(line, t);
                    } else if t > line.to_m {
                        walker.place = None;
                    } else if !walker.retry {
                        walker.place = self.seek(line, t, walker.place.as_ref(), &mut memory.scattered);
                    }
                    walker.look(line);
                    if walker.place.is_some() || !walker.doubted {
                        return walker.place.is_some();
                    }
                    // It has met nothing: then it must not have passed below anything.
                    *walker = Walker::new(walker.index, line, false);
                }
            });
            open.sort_unstable_by_key(|walker| {
                (walker.place.as_ref().map_or(0, |place| address(place.home.plans)), walker.index)
            });
            let mut from = 0;
            while from < open.len() {
                from += self.step(&mut open[from..], lines, hits, max_steps, memory, tally);
            }
            open.retain(|walker| !walker.done);
        }
    }

    /// Evaluates the ground where lines seem to meet it; they do where that is so within the tolerance.
    fn settle(
        &self,
        sweep: &Sweep<'_, 't>,
        lines: &[Option<Line>],
        hits: &mut [Option<Hit>],
        memory: &mut Memory,
        tally: &mut Tally,
    ) {
        let hit = |t_m: f64| Hit { t_m, proved_m: t_m, wall: false, lost: false, ground: None };
        for (index, fate) in sweep.fates.iter().enumerate() {
            // Whoever asks whether lines meet the ground does not ask where.
            if let (Fate::Under, Some(line)) = (fate, &lines[index]) {
                hits[index] = Some(hit(line.from_m));
            }
        }
        let Memory { scattered, places, points } = memory;
        let mut rest = &sweep.meetings[..];
        while let [(_, plans), ..] = rest {
            let count = rest.iter().take(WIDTH).take_while(|(_, other)| std::ptr::eq(*other, *plans)).count();
            let (block, others) = rest.split_at(count);
            rest = others;
            let met = |&(index, _): &(usize, &Plans<'t>)| match (sweep.fates[index], &lines[index]) {
                (Fate::Meets(t_m), Some(line)) => Some((index, t_m, line)),
                _ => None,
            };
            places.clear();
            places.extend(block.iter().filter_map(met).map(|(_, t_m, line)| line.ray.at(t_m)));
            scattered.run(plans.gradient(self.tree()), places, points);
            tally.evaluations += places.len() as u64;
            tally.blocks += 1;
            for ((index, t_m, line), point) in block.iter().filter_map(met).zip(points.iter()) {
                let height = line.ray.elevation_m(t_m) - point.elevation.value;
                if point.weight.value >= THRESHOLD && height.abs() <= line.near_m(t_m) {
                    hits[index] = Some(Hit { ground: Some(*point), ..hit(t_m) });
                }
            }
        }
    }

    /// Evaluates one block for the first walkers, and lets them go on. Gives how many they were.
    fn step(
        &self,
        walkers: &mut [Walker<'_, 't>],
        lines: &[Option<Line>],
        hits: &mut [Option<Hit>],
        max_steps: u32,
        memory: &mut Memory,
        tally: &mut Tally,
    ) -> usize {
        let Some(plans) = walkers[0].place.as_ref().map(|place| place.home.plans) else { return 1 };
        let same =
            |walker: &Walker<'_, 't>| walker.place.as_ref().is_some_and(|place| std::ptr::eq(place.home.plans, plans));
        let count = walkers.iter().take(WIDTH).take_while(|walker| same(walker)).count();
        let Memory { scattered, places, points } = memory;
        places.clear();
        for walker in &walkers[..count] {
            let Some(line) = &lines[walker.index] else { continue };
            places.push(line.ray.at(walker.ahead_m));
        }
        scattered.run(&plans.plain, places, points);
        tally.evaluations += count as u64;
        tally.blocks += 1;
        for (walker, point) in walkers[..count].iter_mut().zip(points.iter()) {
            let Some(line) = &lines[walker.index] else { continue };
            let t = walker.ahead_m;
            let (height, weight) = (line.ray.elevation_m(t) - point.elevation.value, point.weight.value);
            if !walker.proves(line, height) {
                walker.progress.wasted();
                continue;
            }
            if let Some((t0, h0)) = walker.progress.last().filter(|(t0, _)| *t0 < t) {
                walker.fall = Some((h0 - height) / (t - t0));
            }
            let Some(place) = &walker.place else { continue };
            match walker.progress.judge(line, t, height, weight, max_steps) {
                Verdict::Met(hit) => {
                    tally.exhausted += u64::from(hit.lost);
                    hits[walker.index] = Some(hit);
                    walker.done = true;
                }
                Verdict::Between => walker.between = true,
                Verdict::Free => {
                    let (bounds, exit_m) = (place.quad.bounds, place.exit_m);
                    let free = line.free_m(&bounds, t, height + walker.spare_m(line, t), weight);
                    // Bounds hold in the quad alone; the shortest step may lead out of it.
                    walker.progress.t_m = (t + free.far).min(exit_m.max(t + free.least));
                }
            }
        }
        count
    }
}
