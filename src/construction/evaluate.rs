//! Evaluation by tile: a plan for each tile, then whole blocks of points at once, tiles in parallel.

use super::area::Area;
use super::detail::Detail;
use super::operator::warp::Warp;
use super::operator::{add, blend, level, replace, weigh};
use super::plan::{Plan, StepId, Task};
use super::point::{Block, COLS, Places, Point, ROWS, WIDTH, Want};
use super::scratch::Scratch;
use super::tree::{STEPS, Tree};
use super::vectors::widest;
use crate::error::Result;
use crate::interval::Interval;
use crate::watch::Watch;
use rayon::prelude::*;
use std::ops::Range;

/// Columns of a tile unless said otherwise: whole blocks, and enough points for what a plan costs.
const TILE_COLS: usize = 4 * COLS;
/// Rows of a tile unless said otherwise.
const TILE_ROWS: usize = 4 * ROWS;

/// Points in rows and columns; point (row, column) lies at `(x0 + column dx, y0 + row dy)`, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// x of the first column.
    pub x0: f64,
    /// y of the first row.
    pub y0: f64,
    /// Way from a column to the next.
    pub dx: f64,
    /// Way from a row to the next; negative where the first row lies in the north.
    pub dy: f64,
    /// Number of columns.
    pub cols: usize,
    /// Number of rows.
    pub rows: usize,
}

/// How a lattice is cut into tiles; results do not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tiling {
    /// Columns of a tile, at least 1.
    pub cols: usize,
    /// Rows of a tile, at least 1.
    pub rows: usize,
}

impl Default for Tiling {
    fn default() -> Self {
        Self { cols: TILE_COLS, rows: TILE_ROWS }
    }
}

impl Lattice {
    /// Coordinates of a point.
    pub fn at(&self, row: usize, col: usize) -> [f64; 2] {
        [self.x0 + col as f64 * self.dx, self.y0 + row as f64 * self.dy]
    }

    /// The box around the points from one row and column to others, ends included.
    fn area(&self, first: (usize, usize), last: (usize, usize)) -> Area {
        Area::of(&[self.at(first.0, first.1), self.at(last.0, last.1)])
    }
}

impl Tree {
    /// Elevations in metres at all points of a lattice, row by row, NaN where the terrain is not defined.
    ///
    /// # Errors
    /// When the watch's job is cancelled.
    pub fn elevations_m(&self, lattice: &Lattice, watch: &Watch) -> Result<Vec<f64>> {
        self.elevations_of_rows_m(lattice, 0..lattice.rows, watch)
    }

    /// [`Tree::elevations_m`] of some of the lattice's rows: for lattices that are larger than memory.
    ///
    /// # Errors
    /// When the watch's job is cancelled.
    ///
    /// # Panics
    /// When the lattice does not have these rows.
    pub fn elevations_of_rows_m(&self, lattice: &Lattice, rows: Range<usize>, watch: &Watch) -> Result<Vec<f64>> {
        self.evaluate_rows(lattice, rows, Tiling::default(), false, watch, |point| {
            // Plus nothing: -0 and 0 are one elevation.
            if point.weight.value >= super::THRESHOLD { point.elevation.value + 0.0 } else { f64::NAN }
        })
    }

    /// What `make` makes of each point of a lattice, row by row; gradients are there if asked for.
    ///
    /// The same to the bit for any tiling and number of threads, and as [`Tree::at`], but for signs of zeros.
    ///
    /// # Errors
    /// When the watch's job is cancelled. It advances by one a row.
    pub fn evaluate<T: Copy + Default + Send>(
        &self,
        lattice: &Lattice,
        tiling: Tiling,
        gradient: bool,
        watch: &Watch,
        make: impl Fn(&Point) -> T + Sync,
    ) -> Result<Vec<T>> {
        self.evaluate_rows(lattice, 0..lattice.rows, tiling, gradient, watch, make)
    }

    /// [`Tree::evaluate`] of some of the lattice's rows, with the same results as of all at once.
    ///
    /// # Errors
    /// When the watch's job is cancelled. It advances by one a row.
    ///
    /// # Panics
    /// When the lattice does not have these rows.
    pub fn evaluate_rows<T: Copy + Default + Send>(
        &self,
        lattice: &Lattice,
        rows: Range<usize>,
        tiling: Tiling,
        gradient: bool,
        watch: &Watch,
        make: impl Fn(&Point) -> T + Sync,
    ) -> Result<Vec<T>> {
        assert!(rows.start <= rows.end && rows.end <= lattice.rows, "rows of the lattice");
        let cols = lattice.cols;
        let mut out = vec![T::default(); cols * rows.len()];
        if out.is_empty() {
            return Ok(out);
        }
        let (tile_cols, tile_rows) = (tiling.cols.max(1), tiling.rows.max(1));
        let want = Want { elevation: true, gradient };
        out.par_chunks_mut(tile_rows * cols).enumerate().try_for_each_init(
            Work::default,
            |work, (strip, values)| -> Result<()> {
                let first_row = rows.start + strip * tile_rows;
                let high = values.len() / cols;
                for first_col in (0..cols).step_by(tile_cols) {
                    let wide = tile_cols.min(cols - first_col);
                    let last = (first_row + high - 1, first_col + wide - 1);
                    let plan = self.plan(&lattice.area((first_row, first_col), last), want);
                    for row in (0..high).step_by(ROWS) {
                        for col in (0..wide).step_by(COLS) {
                            let size = (ROWS.min(high - row), COLS.min(wide - col));
                            work.places.fill(lattice, (first_row + row, first_col + col), size, &plan);
                            let found = work.run(&plan);
                            for (r, line) in values[row * cols..].chunks_mut(cols).take(size.0).enumerate() {
                                let points = &mut line[first_col + col..][..size.1];
                                if !found {
                                    points.fill(make(&Point::NOTHING));
                                } else if gradient {
                                    work.out.map_row::<true, T>(r, points, &make);
                                } else {
                                    work.out.map_row::<false, T>(r, points, &make);
                                }
                            }
                        }
                    }
                }
                watch.advance(high as u64)
            },
        )?;
        Ok(out)
    }
}

impl Block {
    /// Makes something of each point of a row.
    fn map_row<const GRADIENT: bool, T>(&self, row: usize, out: &mut [T], make: &impl Fn(&Point) -> T) {
        let [f, fx, fy] = self.elevation.each_ref().map(|values| &values.as_chunks::<COLS>().0[row]);
        let [w, wx, wy] = self.weight.each_ref().map(|values| &values.as_chunks::<COLS>().0[row]);
        widest(
            #[inline(always)]
            || {
                for (k, value) in out.iter_mut().take(COLS).enumerate() {
                    let mut point = Point::NOTHING;
                    (point.elevation.value, point.weight.value) = (f[k], w[k]);
                    if GRADIENT {
                        (point.elevation.dx, point.elevation.dy) = (fx[k], fy[k]);
                        (point.weight.dx, point.weight.dy) = (wx[k], wy[k]);
                    }
                    *value = make(&point);
                }
            },
        );
    }
}

impl Places {
    /// Sets the places of some rows and columns of a lattice from a row and a column on; columns beyond the last repeat
    /// it.
    fn fill(&mut self, lattice: &Lattice, (row, col): (usize, usize), (rows, cols): (usize, usize), plan: &Plan<'_>) {
        let xs: [f64; COLS] = std::array::from_fn(|k| lattice.at(row, col + k.min(cols - 1))[0]);
        for r in 0..rows {
            let at = r * COLS;
            self.x[at..at + COLS].copy_from_slice(&xs);
            self.y[at..at + COLS].fill(lattice.at(row + r, col)[1]);
        }
        match plan.detail {
            // The same everywhere, and most often there already.
            Detail::Constant(value) if self.kappa[0][0] == value => {}
            Detail::Constant(value) => self.kappa = [[value; WIDTH], [0.0; WIDTH], [0.0; WIDTH]],
            detail @ Detail::Around { .. } => {
                for at in 0..rows * COLS {
                    let kappa = detail.at([self.x[at], self.y[at]]);
                    [self.kappa[0][at], self.kappa[1][at], self.kappa[2][at]] = [kappa.value, kappa.dx, kappa.dy];
                }
            }
        }
        self.area = lattice.area((row, col), (row + rows - 1, col + cols - 1));
        (self.rows, self.crossing) = (rows, true);
    }
}

impl Default for Places {
    fn default() -> Self {
        Self { x: [0.0; WIDTH], y: [0.0; WIDTH], kappa: [[0.0; WIDTH]; 3], area: Area::EMPTY, rows: 1, crossing: false }
    }
}

/// Evaluates points that lie anywhere, a block at a time.
#[derive(Default)]
pub(super) struct Scattered {
    work: Work,
}

impl Scattered {
    /// What the tree is at up to [`WIDTH`] points of the plan's region; gradients are there if the plan has them.
    pub(super) fn run(&mut self, plan: &Plan<'_>, at: &[[f64; 2]], out: &mut [Point]) {
        let Some(&last) = at.last() else { return };
        let places = &mut self.work.places;
        (places.rows, places.crossing) = (at.len().div_ceil(COLS), false);
        // The block's rest repeats the last point.
        for k in 0..places.count() {
            let [x, y] = at.get(k).copied().unwrap_or(last);
            [places.x[k], places.y[k]] = [x, y];
            let kappa = plan.detail.at([x, y]);
            [places.kappa[0][k], places.kappa[1][k], places.kappa[2][k]] = [kappa.value, kappa.dx, kappa.dy];
        }
        places.area = Area::of(at);
        if self.work.run(plan) {
            for (k, point) in out.iter_mut().enumerate().take(at.len()) {
                *point = self.work.out.get::<true>(k);
            }
        } else {
            out[..at.len()].fill(Point::NOTHING);
        }
    }
}

/// Memory of one thread.
#[derive(Default)]
struct Work {
    places: Places,
    out: Block,
    scratch: Scratch,
}

impl Work {
    /// Evaluates the block of `self.places`; false where nothing is defined.
    fn run(&mut self, plan: &Plan<'_>) -> bool {
        let Some(root) = plan.root else { return false };
        let Self { places, out, scratch } = self;
        for known in scratch.known.drain(..).flatten().flatten() {
            scratch.blocks.push(known);
        }
        scratch.known.resize_with(plan.steps.len(), || None);
        plan.block(root, places, out, scratch)
    }
}

impl Plan<'_> {
    /// Evaluates a step at a block of places; where it returns false the step is nothing, and `out` holds anything.
    fn block(&self, id: StepId, places: &Places, out: &mut Block, scratch: &mut Scratch) -> bool {
        let step = &self.steps[id as usize];
        if !step.support.meets(&places.area) {
            return false;
        }
        if step.uses < 2 {
            return self.fresh(id, places, out, scratch);
        }
        match &scratch.known[id as usize] {
            Some(None) => return false,
            Some(Some(block)) => {
                out.copy(block, places.count(), step.want.gradient);
                return true;
            }
            None => {}
        }
        let found = self.fresh(id, places, out, scratch);
        let copy = found.then(|| {
            let mut block = scratch.take();
            block.copy(out, places.count(), step.want.gradient);
            block
        });
        scratch.known[id as usize] = Some(copy);
        found
    }

    /// The step's block, or zeros where it is nothing.
    fn settled(&self, id: Option<StepId>, places: &Places, out: &mut Block, scratch: &mut Scratch) -> bool {
        let found = id.is_some_and(|id| self.block(id, places, out, scratch));
        if !found {
            out.clear(places.count(), true);
        }
        found
    }

    fn fresh(&self, id: StepId, places: &Places, out: &mut Block, scratch: &mut Scratch) -> bool {
        let step = &self.steps[id as usize];
        let (gradient, count) = (step.want.gradient, places.count());
        match &step.task {
            Task::Leaf(primitive) => {
                let seen = !primitive.misses(&places.area);
                if seen {
                    primitive.block(places, step.want, out);
                }
                seen
            }
            Task::Blend(range) => {
                let mut child = scratch.take();
                let mut found = false;
                for &operand in &self.operands[range.clone()] {
                    if self.block(operand, places, &mut child, scratch) {
                        if !found {
                            out.clear(count, gradient);
                        }
                        found = true;
                        run(
                            gradient,
                            #[inline(always)]
                            |with| {
                                if with {
                                    blend::gather_block::<true>(out, &child, count)
                                } else {
                                    blend::gather_block::<false>(out, &child, count)
                                }
                            },
                        );
                    }
                }
                scratch.give(child);
                if found {
                    run(
                        gradient,
                        #[inline(always)]
                        |with| {
                            if with {
                                blend::divide_block::<true>(out, count)
                            } else {
                                blend::divide_block::<false>(out, count)
                            }
                        },
                    );
                }
                found
            }
            Task::Replace(rule, a, b) => self.pair(
                *a,
                Some(*b),
                places,
                out,
                scratch,
                gradient,
                #[inline(always)]
                |_, a, b| {
                    if gradient {
                        replace::replace::<true>(*rule, a, b)
                    } else {
                        replace::replace::<false>(*rule, a, b)
                    }
                },
            ),
            Task::Add(rule, a, b) => self.pair(
                *a,
                Some(*b),
                places,
                out,
                scratch,
                gradient,
                #[inline(always)]
                |_, a, b| {
                    if gradient { add::add::<true>(*rule, a, b) } else { add::add::<false>(*rule, a, b) }
                },
            ),
            Task::Level(thresholds, a, b) => self.pair(
                *a,
                *b,
                places,
                out,
                scratch,
                gradient,
                #[inline(always)]
                |k, a, b| {
                    let kappa = places.get(k).kappa;
                    if gradient {
                        level::mix::<true>(thresholds, kappa, a, b)
                    } else {
                        level::mix::<false>(thresholds, kappa, a, b)
                    }
                },
            ),
            Task::Warp(warp, child) => self.warped(warp, *child, places, out, scratch, gradient),
            Task::Weigh(rules, child, guide, around) => {
                if !self.block(*child, places, out, scratch) {
                    return false;
                }
                let mut guides = scratch.take();
                let found = self.block(*guide, places, &mut guides, scratch);
                if found {
                    let mut steps: Vec<Box<Block>> = vec![];
                    for (i, &id) in around.iter().flatten().enumerate() {
                        let mut block = scratch.take();
                        let _ = self.settled(id, &stepped(places, STEPS[i]), &mut block, scratch);
                        steps.push(block);
                    }
                    for k in 0..count {
                        let guide = guides.get::<true>(k);
                        let at = |i: usize| steps[i].get::<true>(k);
                        let around = (steps.len() == 4).then(|| [at(0), at(1), at(2), at(3)]);
                        let point = if gradient {
                            weigh::weigh::<true>(rules, out.get::<true>(k), guide, around)
                        } else {
                            weigh::weigh::<false>(rules, out.get::<false>(k), guide, None)
                        };
                        out.set::<true>(k, point);
                    }
                    for block in steps {
                        scratch.give(block);
                    }
                }
                scratch.give(guides);
                found
            }
        }
    }

    /// Combines two operands point by point.
    #[expect(clippy::too_many_arguments, reason = "operands, places, results and memory")]
    #[inline(always)]
    fn pair(
        &self,
        a: Option<StepId>,
        b: Option<StepId>,
        places: &Places,
        out: &mut Block,
        scratch: &mut Scratch,
        gradient: bool,
        combine: impl Fn(usize, Point, Point) -> Point,
    ) -> bool {
        let left = self.settled(a, places, out, scratch);
        let mut other = scratch.take();
        let right = self.settled(b, places, &mut other, scratch);
        if left || right {
            widest(
                #[inline(always)]
                || {
                    if gradient {
                        for k in 0..places.count() {
                            out.set::<true>(k, combine(k, out.get::<true>(k), other.get::<true>(k)));
                        }
                    } else {
                        for k in 0..places.count() {
                            out.set::<false>(k, combine(k, out.get::<false>(k), other.get::<false>(k)));
                        }
                    }
                },
            );
        }
        scratch.give(other);
        left || right
    }

    fn warped(
        &self,
        warp: &Warp,
        child: StepId,
        places: &Places,
        out: &mut Block,
        scratch: &mut Scratch,
        gradient: bool,
    ) -> bool {
        let (mut inside, mut jacobians) = scratch.take_frame();
        inside.area = warp.image(&places.area);
        (inside.rows, inside.crossing) = (places.rows, places.crossing && warp.keeps_axes());
        widest(
            #[inline(always)]
            || {
                for (k, to) in jacobians.iter_mut().enumerate().take(places.count()) {
                    let (place, jacobian) = warp.enter(&places.get(k));
                    [inside.x[k], inside.y[k]] = place.at;
                    [inside.kappa[0][k], inside.kappa[1][k], inside.kappa[2][k]] =
                        [place.kappa.value, place.kappa.dx, place.kappa.dy];
                    *to = jacobian;
                }
            },
        );
        // Shared results are kept by step, and each step belongs to one frame: no other places come to it.
        let found = self.block(child, &inside, out, scratch);
        if found {
            for (k, jacobian) in jacobians.iter().enumerate().take(places.count()) {
                if gradient {
                    out.set::<true>(k, warp.leave(jacobian, out.get::<true>(k)));
                } else {
                    out.set::<false>(k, warp.leave(jacobian, out.get::<false>(k)));
                }
            }
        }
        scratch.frames.push((inside, jacobians));
        found
    }
}

/// Runs `work` with the widest vectors, told whether gradients are wanted.
#[inline(always)]
fn run(gradient: bool, work: impl FnOnce(bool)) {
    widest(
        #[inline(always)]
        || work(gradient),
    );
}

/// Places a step away.
#[inline(never)]
fn stepped(places: &Places, [dx, dy]: [f64; 2]) -> Box<Places> {
    let mut moved = Box::new(places.clone());
    for k in 0..places.count() {
        moved.x[k] += dx;
        moved.y[k] += dy;
    }
    let by = |i: Interval, by: f64| Interval { min: i.min + by, max: i.max + by };
    moved.area = Area { x: by(places.area.x, dx), y: by(places.area.y, dy) };
    moved
}
