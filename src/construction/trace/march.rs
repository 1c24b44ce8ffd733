//! Rays followed to the ground each by itself: the ways of the papers, to compare with.

use super::line::{Hit, Line, Progress, Verdict};
use super::picture::Strategy;
use super::quads::Plans;
use super::tracer::{Memory, Tally};
use crate::construction::area::Area;
use crate::construction::bounds::{Bounds, THRESHOLD};
use crate::construction::point::WIDTH;
use crate::construction::tree::Tree;

/// What one of the papers' ways needs to know of a tree.
pub(super) struct March<'t> {
    pub(super) tree: &'t Tree,
    pub(super) plans: Plans<'t>,
    pub(super) strategy: Strategy,
}

/// A line on its way.
#[derive(Clone, Copy)]
struct Walker {
    index: usize,
    progress: Progress,
    /// The step to try.
    candidate_m: f64,
}

impl March<'_> {
    /// Where lines meet the ground.
    pub(super) fn follow(
        &self,
        lines: &[Option<Line>],
        hits: &mut [Option<Hit>],
        max_steps: u32,
        memory: &mut Memory,
        tally: &mut Tally,
    ) {
        hits.fill(None);
        let global = *self.plans.plain.bounds();
        let mut open: Vec<Walker> = vec![];
        let mut next = 0;
        let Memory { scattered, places, points } = memory;
        loop {
            // Lines that have ended make room for others: blocks stay full.
            while open.len() < WIDTH && next < lines.len() {
                if let Some(line) = &lines[next] {
                    let candidate_m = line.ray.pixel_m(line.from_m);
                    open.push(Walker { index: next, progress: Progress::new(line.from_m), candidate_m });
                }
                next += 1;
            }
            if open.is_empty() {
                return;
            }
            places.clear();
            places.extend(open.iter().filter_map(|w| lines[w.index].as_ref().map(|line| line.ray.at(w.progress.t_m))));
            scattered.run(&self.plans.plain, places, points);
            tally.evaluations += open.len() as u64;
            tally.blocks += 1;
            let mut known = points.iter();
            open.retain_mut(|walker| {
                let (Some(line), Some(point)) = (&lines[walker.index], known.next()) else { return false };
                let t = walker.progress.t_m;
                let (height, weight) = (line.ray.elevation_m(t) - point.elevation.value, point.weight.value);
                match walker.progress.judge(line, t, height, weight, max_steps) {
                    Verdict::Met(hit) => {
                        tally.exhausted += u64::from(hit.lost);
                        hits[walker.index] = Some(hit);
                        return false;
                    }
                    Verdict::Between => return true,
                    Verdict::Free => {}
                }
                let step = match self.strategy {
                    Strategy::Sphere | Strategy::Quads => line.free_m(&global, t, height, weight).far,
                    Strategy::Accelerated | Strategy::Segment => {
                        self.local(line, t, height, weight, walker.candidate_m, tally)
                    }
                };
                walker.progress.t_m = t + step;
                walker.candidate_m = 2.0 * step;
                walker.progress.t_m <= line.to_m
            });
        }
    }

    /// A step from bounds of what is around or ahead, at most `candidate_m` long.
    fn local(&self, line: &Line, t: f64, height: f64, weight: f64, candidate_m: f64, tally: &mut Tally) -> f64 {
        let end = (t + candidate_m).min(line.to_m);
        let here = line.ray.at(t);
        let area = match self.strategy {
            Strategy::Accelerated => Area::around(here, (end - t) * line.level),
            _ => Area::of(&[here, line.ray.at(end)]),
        };
        tally.bounds += 1;
        let bounds: Bounds = self.tree.bounds(&area.widened());
        let low = line.ray.elevation_m(t).min(line.ray.elevation_m(end));
        let free = line.free_m(&bounds, t, height, weight);
        // Over all that is there, or nothing is.
        if bounds.weight.max < THRESHOLD || low > bounds.elevation.max {
            return candidate_m;
        }
        free.far.min(candidate_m.max(free.least))
    }
}
