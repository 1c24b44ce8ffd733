//! Quads of the plane with the highest elevation in each, made where rays come near, and shared by all of them.
//!
//! A quad's **top** is proved: no defined terrain of it is higher. It is the least of what interval bounds say, of its
//! parent's tops, and of what [`CELLS`] x [`CELLS`] samples say, one in the middle of each cell: from there the terrain
//! rises no more than its Lipschitz constant over the quad times half the cell's diagonal. What a quad holds depends
//! on its place alone, not on which ray asked first.

use super::line::Domain;
use super::patch::Patch;
use crate::construction::area::Area;
use crate::construction::bounds::{Bounds, THRESHOLD};
use crate::construction::evaluate::Scattered;
use crate::construction::plan::Plan;
use crate::construction::point::{Point, WIDTH, Want};
use crate::construction::tree::Tree;
use crate::interval::{Interval, product};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// Cells of a quad each way.
pub(super) const CELLS: usize = 8;
/// Samples of a quad.
const SAMPLES: usize = CELLS * CELLS;
const _: () = assert!(SAMPLES <= WIDTH, "a quad's samples are one block");

/// A quad is divided unless its cells are at most so many pixels wide.
const CELL_PX: f64 = 1.5;
/// The finest quads with plans of their own are so many pixels wide.
const PLAN_PX: f64 = 96.0;
/// Quads above one another, at most.
const DEEPEST: u32 = 40;

/// How wide a pixel is, at least, near a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gauge {
    pub(super) origin: [f64; 3],
    pub(super) exaggeration: f64,
    pub(super) footprint_m: f64,
    /// Growth per metre of distance from the origin.
    pub(super) growth: f64,
    /// No pixel is narrower.
    pub(super) least_m: f64,
}

/// Plans for a quad: of elevations alone, and with gradients.
pub(super) struct Plans<'t> {
    area: Area,
    pub(super) plain: Plan<'t>,
    gradient: OnceLock<Plan<'t>>,
}

/// A quad.
pub(super) struct Quad<'t> {
    pub(super) area: Area,
    pub(super) middle: [f64; 2],
    /// Nothing in it is higher; minus infinity where nothing is defined.
    pub(super) top: f64,
    pub(super) bounds: Bounds,
    pub(super) plans: Option<Box<Plans<'t>>>,
    pub(super) parts: Parts<'t>,
    depth: u32,
}

/// What a quad is made of.
pub(super) enum Parts<'t> {
    /// Four quads: left and right in the first row, that of small y, then in the second; with their tops as far as
    /// they are known from here.
    Quads([f64; 4], Box<[OnceLock<Box<Quad<'t>>>; 4]>),
    /// The finest.
    Cells(Box<Cells>),
    /// Nothing that is known better than the quad itself.
    Whole,
}

/// What a finest quad knows.
pub(super) struct Cells {
    /// Tops of 2 x 2, 4 x 4 and 8 x 8 cells.
    pub(super) tops: ([f64; 4], [f64; 16], [f64; 64]),
    /// The ground by its samples, where it is all defined and no steeper than is known.
    pub(super) patch: Option<Patch>,
}

/// All quads of a tree.
pub(super) struct Quads<'t> {
    tree: &'t Tree,
    gauge: Gauge,
    root: Quad<'t>,
    samples: AtomicU64,
    bounds: AtomicU64,
}

impl Gauge {
    fn pixel_m(&self, area: &Area, elevation: Interval) -> f64 {
        if self.growth == 0.0 {
            return self.footprint_m.max(self.least_m);
        }
        let up = Interval { min: elevation.min - self.origin[2], max: elevation.max - self.origin[2] };
        let up = up.scaled(self.exaggeration).square().min;
        let far = area.square_distances([self.origin[0], self.origin[1]]).min + up;
        (self.footprint_m + self.growth * far.sqrt()).max(self.least_m)
    }
}

impl<'t> Plans<'t> {
    pub(super) fn new(tree: &'t Tree, area: Area) -> Self {
        let plain = tree.plan(&area, Want { elevation: true, gradient: false });
        Self { area, plain, gradient: OnceLock::new() }
    }

    /// The plan with gradients.
    pub(super) fn gradient(&self, tree: &'t Tree) -> &Plan<'t> {
        self.gradient.get_or_init(|| tree.plan(&self.area, Want::ALL))
    }
}

/// Half of the diagonal of a quad's cell, for the samples in their middles.
fn reach_m(area: &Area) -> f64 {
    let (w, h) = (area.x.width() / CELLS as f64, area.y.width() / CELLS as f64);
    0.5 * (w * w + h * h).sqrt() * (1.0 + 1e-9)
}

/// By how much terrain may rise from a sample within a reach, or infinity. Ways are straight from a defined place to
/// the sample, so the weight on them is at least [`THRESHOLD`] less what it may fall.
fn rise_m(bounds: &Bounds, reach_m: f64) -> f64 {
    let least = bounds.weight.min.max(THRESHOLD - product(bounds.weight_slope, reach_m));
    let slope = if least > 0.0 { bounds.slope.min(bounds.weighted_slope / least) } else { f64::INFINITY };
    product(slope, reach_m)
}

impl<'t> Quads<'t> {
    /// The quads over a domain.
    pub(super) fn new(tree: &'t Tree, domain: &Domain, gauge: Gauge, work: &mut Scattered) -> Self {
        let [x, y] = domain.area.centre();
        let half = domain.area.x.width().max(domain.area.y.width()) / 2.0;
        let area = Area::around([x, y], half);
        let (samples, bounds) = (AtomicU64::new(0), AtomicU64::new(0));
        let root = Self::make(tree, &gauge, (&samples, &bounds), area, 0, domain.elevation.max, work);
        Self { tree, gauge, root, samples, bounds }
    }

    pub(super) fn root(&self) -> &Quad<'t> {
        &self.root
    }

    pub(super) fn tree(&self) -> &'t Tree {
        self.tree
    }

    /// Points evaluated, and regions bounded.
    pub(super) fn counts(&self) -> (u64, u64) {
        (self.samples.load(Ordering::Relaxed), self.bounds.load(Ordering::Relaxed))
    }

    /// A part of a quad that is made of quads.
    pub(super) fn child<'q>(&'q self, quad: &'q Quad<'t>, index: usize, work: &mut Scattered) -> Option<&'q Quad<'t>> {
        let Parts::Quads(tops, quads) = &quad.parts else { return None };
        let made = quads[index].get_or_init(|| {
            let ([x, y], area) = (quad.middle, quad.area);
            let half = |range: Interval, at: f64, second: bool| {
                if second { Interval { min: at, ..range } } else { Interval { max: at, ..range } }
            };
            let area = Area { x: half(area.x, x, index % 2 == 1), y: half(area.y, y, index / 2 == 1) };
            let counts = (&self.samples, &self.bounds);
            Box::new(Self::make(self.tree, &self.gauge, counts, area, quad.depth + 1, tops[index], work))
        });
        Some(made)
    }

    /// The plans of the smallest quad made so far on the way to `area` that holds it; what is evaluated with them does
    /// not depend on which they are.
    pub(super) fn plans(&self, area: &Area) -> Option<&Plans<'t>> {
        let (mut quad, mut best) = (&self.root, None);
        loop {
            let inside = |outer: &Area| {
                outer.x.min <= area.x.min
                    && area.x.max <= outer.x.max
                    && outer.y.min <= area.y.min
                    && area.y.max <= outer.y.max
            };
            match &quad.plans {
                Some(plans) if inside(&plans.area) => best = Some(plans.as_ref()),
                _ => return best,
            }
            let Parts::Quads(_, quads) = &quad.parts else { return best };
            let [x, y] = area.centre();
            let index = usize::from(x >= quad.middle[0]) + 2 * usize::from(y >= quad.middle[1]);
            let Some(next) = quads[index].get() else { return best };
            quad = next;
        }
    }

    fn make(
        tree: &'t Tree,
        gauge: &Gauge,
        (samples, regions): (&AtomicU64, &AtomicU64),
        area: Area,
        depth: u32,
        top: f64,
        work: &mut Scattered,
    ) -> Quad<'t> {
        let side = area.x.width().max(area.y.width());
        // Rays round.
        let grown = area.grown(side / 1024.0);
        let plan = tree.plan(&grown, Want { elevation: true, gradient: false });
        regions.fetch_add(1, Ordering::Relaxed);
        let bounds = *plan.bounds();
        let middle = area.centre();
        let mut quad = Quad { area, middle, top: f64::NEG_INFINITY, bounds, plans: None, parts: Parts::Whole, depth };
        if bounds.weight.max < THRESHOLD {
            return quad;
        }
        quad.top = top.min(bounds.elevation.max);
        let pixel = gauge.pixel_m(&area, bounds.elevation);
        let known = bounds.terrain_slope().is_finite();
        let finest = side <= pixel * CELL_PX * if known { CELLS as f64 } else { 4.0 } || depth >= DEEPEST;
        let (mut tops, mut patch) = ([quad.top; 64], None);
        let reach = reach_m(&area);
        let rise = rise_m(&bounds, reach);
        if rise < bounds.elevation.width() {
            samples.fetch_add(SAMPLES as u64, Ordering::Relaxed);
            let mut points = [Point::NOTHING; SAMPLES];
            let along = |range: Interval, i: usize| range.min + range.width() * ((i as f64 + 0.5) / CELLS as f64);
            let places: [[f64; 2]; SAMPLES] =
                std::array::from_fn(|k| [along(area.x, k % CELLS), along(area.y, k / CELLS)]);
            work.run(&plan, &places, &mut points);
            for (cell, point) in tops.iter_mut().zip(&points) {
                let weight = point.weight.value;
                let bare = weight + product(bounds.weight_slope, reach) < THRESHOLD;
                *cell = if bare { f64::NEG_INFINITY } else { cell.min((point.elevation.value + rise).next_up()) };
            }
            quad.top = tops.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            if finest && bounds.weight.min >= THRESHOLD {
                patch = Some(Patch::new(&area, &points.map(|point| point.elevation.value), rise, rise / reach));
            }
        } else if finest && bounds.weight.min >= THRESHOLD && bounds.elevation.width().is_finite() {
            // All of it lies in a narrow range.
            let middle = 0.5 * (bounds.elevation.min + bounds.elevation.max);
            patch = Some(Patch::new(&area, &[middle; SAMPLES], bounds.elevation.width(), f64::INFINITY));
        }
        let sixteen: [f64; 16] = halved(&tops, 8);
        let four: [f64; 4] = halved(&sixteen, 4);
        quad.parts = if finest {
            Parts::Cells(Box::new(Cells { tops: (four, sixteen, tops), patch }))
        } else {
            Parts::Quads(four, Box::default())
        };
        if depth == 0 || side > PLAN_PX * pixel {
            quad.plans = Some(Box::new(Plans { area: grown, plain: plan, gradient: OnceLock::new() }));
        }
        quad
    }
}

/// The greatest of each two by two.
fn halved<const N: usize>(tops: &[f64], across: usize) -> [f64; N] {
    let half = across / 2;
    std::array::from_fn(|k| {
        let at = k / half * 2 * across + k % half * 2;
        tops[at].max(tops[at + 1]).max(tops[at + across].max(tops[at + across + 1]))
    })
}
