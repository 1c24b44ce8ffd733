//! One tree, ready for rays, whatever the strategy.

use super::beam::Beam;
use super::camera::Lens;
use super::line::{Domain, Hit, Line};
use super::march::March;
use super::picture::{Counts, Strategy, TraceOptions};
use super::quads::{Gauge, Plans, Quads};
use super::sweep::Goal;
use crate::construction::area::Area;
use crate::construction::bounds::THRESHOLD;
use crate::construction::evaluate::Scattered;
use crate::construction::plan::Plan;
use crate::construction::point::{Point, WIDTH};
use crate::construction::tree::Tree;

/// How far is looked where the terrain has no end.
const REACH_M: f64 = 1e6;

/// Memory of one thread.
pub(super) struct Memory {
    pub(super) scattered: Scattered,
    pub(super) places: Vec<[f64; 2]>,
    pub(super) points: [Point; WIDTH],
}

/// What following some rays took.
#[derive(Clone, Copy, Default)]
pub(super) struct Tally {
    pub(super) evaluations: u64,
    pub(super) blocks: u64,
    pub(super) bounds: u64,
    pub(super) exhausted: u64,
}

/// One tree, ready for rays.
pub(super) struct Tracer<'t> {
    pub(super) domain: Domain,
    max_steps: u32,
    way: Way<'t>,
}

enum Way<'t> {
    /// Nothing is defined where rays come.
    Nowhere,
    March(Box<March<'t>>),
    Quads(Box<Quads<'t>>),
}

impl Default for Memory {
    fn default() -> Self {
        Self { scattered: Scattered::default(), places: vec![], points: [Point::NOTHING; WIDTH] }
    }
}

impl<'t> Tracer<'t> {
    /// Makes a tree ready for a picture.
    pub(super) fn new(tree: &'t Tree, lens: &Lens, options: &TraceOptions, memory: &mut Memory) -> Self {
        let [x, y, _] = lens.origin();
        let support = tree.support();
        let ends = [support.x.min, support.x.max, support.y.min, support.y.max].iter().all(|end| end.is_finite());
        let reach_m = options.reach_m.or((!ends).then_some(REACH_M));
        let area = reach_m.map_or(support, |reach_m| support.meet(&Area::around([x, y], reach_m)));
        let max_steps = options.max_steps.max(1);
        let plans = (!area.is_empty()).then(|| Plans::new(tree, area));
        let bounds = plans.as_ref().map(|plans| *plans.plain.bounds()).filter(|b| b.weight.max >= THRESHOLD);
        let (Some(plans), Some(bounds)) = (plans, bounds) else {
            let domain = Domain { area: Area::EMPTY, elevation: crate::interval::Interval::ZERO };
            return Self { domain, max_steps, way: Way::Nowhere };
        };
        let domain = Domain { area, elevation: bounds.elevation };
        let way = if options.strategy == Strategy::Quads {
            let corner = lens.ray(0.0, 0.0);
            let gauge = Gauge {
                origin: lens.origin(),
                exaggeration: lens.exaggeration(),
                footprint_m: corner.footprint_m,
                growth: corner.growth,
                least_m: corner.pixel_m(0.0),
            };
            Way::Quads(Box::new(Quads::new(tree, &domain, gauge, &mut memory.scattered)))
        } else {
            Way::March(Box::new(March { tree, plans, strategy: options.strategy }))
        };
        Self { domain, max_steps, way }
    }

    /// Where lines meet the ground, or whether they do.
    pub(super) fn follow(
        &self,
        lines: &[Option<Line>],
        goal: Goal,
        hits: &mut [Option<Hit>],
        memory: &mut Memory,
        tally: &mut Tally,
    ) {
        match &self.way {
            Way::Nowhere => hits.fill(None),
            Way::March(march) => march.follow(lines, hits, self.max_steps, memory, tally),
            Way::Quads(quads) => quads.follow(lines, goal, hits, self.max_steps, memory, tally),
        }
    }

    /// The depth up to which a packet's rays are free of ground, as far as that is easily told.
    pub(super) fn free(&self, beam: &Beam, memory: &mut Memory) -> f64 {
        match &self.way {
            Way::Nowhere | Way::March(_) => f64::NEG_INFINITY,
            Way::Quads(quads) => beam.free(quads, &self.domain, &mut memory.scattered),
        }
    }

    /// A plan with gradients for points of a box.
    pub(super) fn gradient(&self, area: &Area) -> Option<&Plan<'t>> {
        match &self.way {
            Way::Nowhere => None,
            Way::March(march) => Some(march.plans.gradient(march.tree)),
            Way::Quads(quads) => quads.plans(area).map(|plans| plans.gradient(quads.tree())),
        }
    }

    /// Adds what rays share to the counts.
    pub(super) fn count(&self, counts: &mut Counts) {
        if let Way::Quads(quads) = &self.way {
            let (samples, bounds) = quads.counts();
            counts.samples += samples;
            counts.bounds += bounds;
        }
    }
}
