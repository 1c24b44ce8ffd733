//! A packet of lines over quads, all at once: what quads alone can tell of them.
//!
//! Quads are visited once for all lines, those that are nearer first, and each line is told apart where it meets the
//! samples of a finest quad ([`super::patch`]). The ground is met for good only where it was evaluated, and what quads
//! cannot tell is left to those who follow lines one by one.

use super::line::Line;
use super::quads::{Parts, Plans, Quad, Quads};
use crate::construction::evaluate::Scattered;
use std::ops::Range;

/// How far below the ground lines may pass before they meet it, as a share of the height from which they may meet it.
const SUNK: f64 = 2.0;

/// What is asked of lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Goal {
    /// Where they meet the ground.
    Ground,
    /// Whether they do.
    Shade,
}

/// What became of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Fate {
    /// Nothing yet; it is above the ground for certain up to a place, or all along.
    Open,
    /// It seems to meet the ground here.
    Meets(f64),
    /// It is below the ground somewhere.
    Under,
    /// Quads cannot tell.
    Unknown,
}

/// A line as it is cut by quads.
#[derive(Clone, Copy)]
struct Ray {
    origin: [f64; 3],
    /// Metres of way per metre along x, along y and up.
    inverse: [f64; 3],
}

/// The part of a line that lies in a quad, no higher than its top.
#[derive(Clone, Copy)]
struct Entry {
    index: u32,
    from_m: f64,
    to_m: f64,
}

/// What a sweep found.
pub(super) struct Sweep<'q, 't> {
    goal: Goal,
    rays: Vec<Ray>,
    stack: Vec<Entry>,
    pub(super) fates: Vec<Fate>,
    /// Up to where each line is above the ground for certain; infinity: all along.
    pub(super) doubts_m: Vec<f64>,
    /// Lines that seem to meet the ground, in the order of the quads, with the plans of a quad around the place.
    pub(super) meetings: Vec<(usize, &'q Plans<'t>)>,
}

/// Which quarter of a quad lines come to first.
#[derive(Clone, Copy)]
enum Order {
    /// They all come from here.
    Origin([f64; 2]),
    /// They all go there: the first quarter of each quad.
    First(usize),
}

impl Order {
    /// `None` for lines that have none in common, or run along an axis.
    fn of(lines: &[Option<Line>]) -> Option<Self> {
        let mut rays = lines.iter().flatten().map(|line| &line.ray);
        let first = rays.next()?;
        let part = |d: &[f64; 3]| usize::from(d[0] < 0.0) + 2 * usize::from(d[1] < 0.0);
        let (mut together, mut alike) = (true, true);
        for ray in rays {
            together &= ray.origin == first.origin;
            alike &= part(&ray.direction) == part(&first.direction);
        }
        if together {
            Some(Self::Origin([first.origin[0], first.origin[1]]))
        } else {
            alike.then(|| Self::First(part(&first.direction)))
        }
    }

    fn first(self, middle: [f64; 2]) -> usize {
        match self {
            Self::Origin([x, y]) => usize::from(x >= middle[0]) + 2 * usize::from(y >= middle[1]),
            Self::First(part) => part,
        }
    }
}

impl<'t> Quads<'t> {
    /// Sweeps lines over the quads; `None` where they have no order in common.
    pub(super) fn sweep<'q>(
        &'q self,
        lines: &[Option<Line>],
        goal: Goal,
        work: &mut Scattered,
    ) -> Option<Sweep<'q, 't>> {
        let order = Order::of(lines)?;
        let plans = self.root().plans.as_deref()?;
        let blank = Ray { origin: [0.0; 3], inverse: [0.0; 3] };
        let mut sweep = Sweep {
            goal,
            rays: vec![blank; lines.len()],
            stack: Vec::with_capacity(4 * lines.len()),
            fates: vec![Fate::Open; lines.len()],
            doubts_m: vec![f64::INFINITY; lines.len()],
            meetings: vec![],
        };
        for (index, line) in lines.iter().enumerate() {
            let Some(line) = line else { continue };
            let Line { ray, from_m, to_m, .. } = *line;
            if ray.direction.contains(&0.0) {
                (sweep.fates[index], sweep.doubts_m[index]) = (Fate::Unknown, from_m);
                continue;
            }
            sweep.rays[index] = Ray { origin: ray.origin, inverse: ray.direction.map(|speed| 1.0 / speed) };
            sweep.stack.push(Entry { index: index as u32, from_m, to_m });
        }
        let all = 0..sweep.stack.len();
        self.enter(self.root(), plans, order, all, lines, &mut sweep, work);
        Some(sweep)
    }

    #[expect(clippy::too_many_arguments, reason = "a quad, where it lies, and the lines over it")]
    fn enter<'q>(
        &'q self,
        quad: &'q Quad<'t>,
        home: &'q Plans<'t>,
        order: Order,
        over: Range<usize>,
        lines: &[Option<Line>],
        sweep: &mut Sweep<'q, 't>,
        work: &mut Scattered,
    ) {
        let home = quad.plans.as_deref().unwrap_or(home);
        let Parts::Quads(tops, _) = &quad.parts else {
            for at in over {
                sweep.meet(quad, home, at, lines);
            }
            return;
        };
        let first = order.first(quad.middle);
        // A line comes to at most one of the two in the middle.
        for part in [first, first ^ 1, first ^ 2, first ^ 3] {
            let from = sweep.stack.len();
            sweep.divide(quad.middle, part, tops[part], over.clone());
            if sweep.stack.len() > from
                && let Some(child) = self.child(quad, part, work)
            {
                self.enter(child, home, order, from..sweep.stack.len(), lines, sweep, work);
            }
            sweep.stack.truncate(from);
        }
    }
}

impl<'q, 't> Sweep<'q, 't> {
    /// Adds the parts of lines that lie in a quarter around `middle`, no higher than `top`.
    fn divide(&mut self, middle: [f64; 2], part: usize, top: f64, over: Range<usize>) {
        let second = [part % 2 == 1, part / 2 == 1];
        for at in over {
            let Entry { index, mut from_m, mut to_m } = self.stack[at];
            if self.fates[index as usize] != Fate::Open {
                continue;
            }
            let Ray { origin, inverse } = &self.rays[index as usize];
            for axis in 0..2 {
                let cut = (middle[axis] - origin[axis]) * inverse[axis];
                // Beyond the cut, or up to it.
                if (inverse[axis] > 0.0) == second[axis] {
                    from_m = from_m.max(cut);
                } else {
                    to_m = to_m.min(cut);
                }
            }
            let cut = (top - origin[2]) * inverse[2];
            if inverse[2] < 0.0 {
                from_m = from_m.max(cut);
            } else {
                to_m = to_m.min(cut);
            }
            if from_m <= to_m {
                self.stack.push(Entry { index, from_m, to_m });
            }
        }
    }

    /// What a finest quad says of a line.
    fn meet(&mut self, quad: &Quad<'t>, home: &'q Plans<'t>, at: usize, lines: &[Option<Line>]) {
        let Entry { index, mut from_m, mut to_m } = self.stack[at];
        let index = index as usize;
        let Some(line) = &lines[index] else { return };
        let Ray { origin, inverse } = &self.rays[index];
        let cut = (quad.top - origin[2]) * inverse[2];
        if inverse[2] < 0.0 {
            from_m = from_m.max(cut);
        } else {
            to_m = to_m.min(cut);
        }
        // Of two quads side by side one may have told already.
        if from_m > to_m || self.fates[index] != Fate::Open {
            return;
        }
        let doubt_m = &mut self.doubts_m[index];
        let Parts::Cells(cells) = &quad.parts else {
            if quad.top > f64::NEG_INFINITY {
                *doubt_m = doubt_m.min(from_m);
                self.fates[index] = Fate::Unknown;
            }
            return;
        };
        let Some(patch) = &cells.patch else {
            *doubt_m = doubt_m.min(from_m);
            // A line that is not told here may yet be found below the ground elsewhere.
            if self.goal == Goal::Ground {
                self.fates[index] = Fate::Unknown;
            }
            return;
        };
        let unless = |doubt_m: f64, at: Option<f64>| at.map_or(doubt_m, |at| doubt_m.min(at));
        if self.goal == Goal::Shade {
            let pass = patch.pass(&line.ray, [from_m, to_m], 0.0, false);
            *doubt_m = unless(*doubt_m, pass.unproved_m);
            if pass.under {
                self.fates[index] = Fate::Under;
            }
            return;
        }
        let near = line.near_m(from_m);
        let pass = patch.pass(&line.ray, [from_m, to_m], SUNK * near, true);
        *doubt_m = unless(*doubt_m, pass.doubt_m);
        let known_m = pass.meets_m.map_or(f64::NEG_INFINITY, |meets_m| {
            // Looking back from ground that is to be met: it is no further from the line than `near`.
            let grows = patch.slope * line.level + line.ray.direction[2];
            if grows > 0.0 { meets_m - (SUNK - 1.0) * near / grows } else { f64::NEG_INFINITY }
        });
        self.fates[index] = match (pass.unproved_m, pass.meets_m) {
            (Some(_), None) => Fate::Unknown,
            (Some(at), Some(_)) if at < known_m => Fate::Unknown,
            (_, Some(t_m)) => {
                self.meetings.push((index, home));
                Fate::Meets(t_m)
            }
            _ => Fate::Open,
        };
    }
}
