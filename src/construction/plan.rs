//! What a region needs of a tree: parts that cannot matter there are left out, and bounds come with it.
//!
//! Left out is only what contributes exactly nothing: nodes whose weight is 0 all over the region, the elevation of what
//! is fully replaced, levels of detail that are not asked for. So results equal [`Tree::at`] to the bit.

use super::area::{Area, Region};
use super::bounds::Bounds;
use super::detail::Detail;
use super::operator::warp::Warp;
use super::operator::{Rules, Thresholds, WeightRule, add, blend, level, replace, weigh};
use super::point::{Place, Point, Want};
use super::primitive::Primitive;
use super::tree::{Node, NodeId, STEPS, Tree, shifted};
use std::collections::BTreeMap;

/// Index of a step.
pub(super) type StepId = u32;

/// What a step does.
#[derive(Clone, Debug)]
pub(super) enum Task<'t> {
    Leaf(&'t dyn Primitive),
    /// The children are this range of [`Plan::operands`].
    Blend(std::ops::Range<usize>),
    Replace(WeightRule, Option<StepId>, StepId),
    Add(WeightRule, Option<StepId>, StepId),
    Warp(&'t Warp, StepId),
    Level(&'t Thresholds, Option<StepId>, Option<StepId>),
    /// Child, guide, and the guide at [`STEPS`].
    Weigh(&'t Rules, StepId, StepId, Option<[Option<StepId>; 4]>),
}

/// A node as the region needs it.
#[derive(Clone, Debug)]
pub(super) struct Step<'t> {
    /// The node that the step is of.
    node: NodeId,
    pub(super) task: Task<'t>,
    /// Outside of it the step is nothing.
    pub(super) support: Area,
    pub(super) want: Want,
    /// Steps that ask for this one.
    pub(super) uses: u32,
}

/// What a region needs of a tree.
#[derive(Clone, Debug)]
pub struct Plan<'t> {
    pub(super) steps: Vec<Step<'t>>,
    pub(super) operands: Vec<StepId>,
    pub(super) root: Option<StepId>,
    pub(super) detail: Detail,
    area: Area,
    bounds: Bounds,
}

/// A step that is shared: node, frame, and what is wanted of it.
type Key = (NodeId, u32, Want);

/// A plan in the making.
struct Planner<'t> {
    tree: &'t Tree,
    steps: Vec<Step<'t>>,
    operands: Vec<StepId>,
    /// Steps of nodes with several parents.
    known: BTreeMap<Key, Option<(StepId, Bounds)>>,
    /// Frames: that of the parent, with the warp's node or the step that leads out of it.
    frames: Vec<(u32, u32)>,
}

impl<'t> Plan<'t> {
    pub(super) fn new(tree: &'t Tree, root: NodeId, region: Region, want: Want) -> Self {
        let mut planner =
            Planner { tree, steps: vec![], operands: vec![], known: BTreeMap::new(), frames: vec![(0, 0)] };
        let found = planner.visit(root, 0, &region, want);
        let (root, bounds) = found.map_or((None, Bounds::NOTHING), |(id, bounds)| (Some(id), bounds));
        if let Some(id) = root {
            planner.steps[id as usize].uses += 1;
        }
        let Planner { steps, operands, .. } = planner;
        Self { steps, operands, root, detail: tree.detail, area: region.area, bounds }
    }

    /// Bounds over the region.
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// The region's box.
    pub fn area(&self) -> &Area {
        &self.area
    }

    /// Number of nodes that are left.
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// The nodes that are left: all others contribute exactly nothing to the region. One may come more than once.
    pub fn nodes(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.steps.iter().map(|step| step.node)
    }

    /// Whether the terrain is nowhere defined in the region.
    pub fn is_empty(&self) -> bool {
        self.root.is_none()
    }

    /// Elevation and weight at a point of the region, with gradients, equal to [`Tree::at`] to the bit if the plan was
    /// made for [`Want::ALL`].
    pub fn at(&self, at: [f64; 2]) -> Point {
        let place = Place { at, kappa: self.detail.at(at) };
        self.root.map_or(Point::NOTHING, |id| self.step_at(id, &place))
    }

    fn step_at(&self, id: StepId, place: &Place) -> Point {
        let step = &self.steps[id as usize];
        if !step.support.holds(place.at) {
            return Point::NOTHING;
        }
        let maybe = |id: &Option<StepId>| id.map_or(Point::NOTHING, |id| self.step_at(id, place));
        match &step.task {
            Task::Leaf(primitive) => primitive.at(place),
            Task::Blend(range) => blend::blend(self.operands[range.clone()].iter().map(|&id| self.step_at(id, place))),
            Task::Replace(rule, a, b) => replace::replace::<true>(*rule, maybe(a), self.step_at(*b, place)),
            Task::Add(rule, a, b) => add::add::<true>(*rule, maybe(a), self.step_at(*b, place)),
            Task::Warp(warp, child) => {
                let (inside, jacobian) = warp.enter(place);
                warp.leave(&jacobian, self.step_at(*child, &inside))
            }
            Task::Level(thresholds, a, b) => level::mix::<true>(thresholds, place.kappa, maybe(a), maybe(b)),
            Task::Weigh(rules, child, guide, around) => {
                let at = |i: usize, id: Option<StepId>| {
                    id.map_or(Point::NOTHING, |id| self.step_at(id, &shifted(place, STEPS[i])))
                };
                let around = around.map(|[a, b, c, d]| [at(0, a), at(1, b), at(2, c), at(3, d)]);
                weigh::weigh::<true>(rules, self.step_at(*child, place), self.step_at(*guide, place), around)
            }
        }
    }
}

impl<'t> Planner<'t> {
    /// The step for a node in a frame, and its bounds over the region; `None` where it is nothing.
    fn visit(&mut self, id: NodeId, frame: u32, region: &Region, want: Want) -> Option<(StepId, Bounds)> {
        let tree = self.tree;
        let support = tree.supports[id.0 as usize];
        if !support.meets(&region.area) {
            return None;
        }
        let key = (id, frame, want);
        let shared = tree.shared[id.0 as usize];
        if let (true, Some(found)) = (shared, self.known.get(&key)) {
            return *found;
        }
        let found = self.make(id, frame, region, want).filter(|(_, bounds)| !bounds.is_nothing());
        if shared {
            self.known.insert(key, found);
        }
        found
    }

    /// The frame that leads out of `frame` by a node's warp (`way` 0) or one of its steps.
    fn frame(&mut self, frame: u32, id: NodeId, way: u32) -> u32 {
        let key = (frame, id.0 * 8 + way + 1);
        let at = self.frames.iter().position(|known| *known == key);
        at.unwrap_or_else(|| {
            self.frames.push(key);
            self.frames.len() - 1
        }) as u32
    }

    fn push(&mut self, task: Task<'t>, id: NodeId, want: Want) -> StepId {
        let asked: Vec<StepId> = match &task {
            Task::Leaf(_) => vec![],
            Task::Blend(range) => self.operands[range.clone()].to_vec(),
            Task::Replace(_, a, b) | Task::Add(_, a, b) => a.iter().chain([b]).copied().collect(),
            Task::Warp(_, child) => vec![*child],
            Task::Level(_, a, b) => a.iter().chain(b).copied().collect(),
            Task::Weigh(_, child, guide, around) => {
                [*child, *guide].into_iter().chain(around.iter().flatten().flatten().copied()).collect()
            }
        };
        for asked in asked {
            self.steps[asked as usize].uses += 1;
        }
        let support = self.tree.supports[id.0 as usize];
        self.steps.push(Step { node: id, task, support, want, uses: 0 });
        (self.steps.len() - 1) as StepId
    }

    fn make(&mut self, id: NodeId, frame: u32, region: &Region, want: Want) -> Option<(StepId, Bounds)> {
        let tree = self.tree;
        match &tree.nodes[id.0 as usize] {
            Node::Leaf(primitive) => {
                let seen = region.area.meet(&tree.supports[id.0 as usize]);
                let mut bounds = primitive.bounds(&region.over(seen));
                if seen != region.area {
                    bounds.weight.min = 0.0;
                }
                Some((self.push(Task::Leaf(primitive.as_ref()), id, want), bounds))
            }
            Node::Blend { children, boxes } => {
                let mut near = vec![];
                match boxes {
                    Some(boxes) => boxes.meeting(&region.area, &mut near),
                    None => near.extend(0..children.len() as u32),
                }
                let found: Vec<(StepId, Bounds)> =
                    near.iter().filter_map(|&i| self.visit(children[i as usize], frame, region, want)).collect();
                if found.is_empty() {
                    return None;
                }
                let from = self.operands.len();
                self.operands.extend(found.iter().map(|(id, _)| *id));
                let bounds: Vec<Bounds> = found.into_iter().map(|(_, bounds)| bounds).collect();
                let step = self.push(Task::Blend(from..self.operands.len()), id, want);
                Some((step, blend::bounds(&bounds)))
            }
            Node::Replace { rule, a, b } => self.replaced(id, *rule, (*a, *b), frame, region, want),
            Node::Add { rule, a, b } => {
                if *rule == WeightRule::Keep && !want.elevation {
                    return self.visit(*a, frame, region, want);
                }
                let (left, right) = (self.visit(*a, frame, region, want), self.visit(*b, frame, region, want));
                let Some((right, right_bounds)) = right else { return left };
                if left.is_none() && *rule == WeightRule::Keep {
                    return None;
                }
                let left_bounds = left.map_or(Bounds::NOTHING, |(_, bounds)| bounds);
                let step = self.push(Task::Add(*rule, left.map(|(id, _)| id), right), id, want);
                Some((step, add::bounds(*rule, &left_bounds, &right_bounds)))
            }
            Node::Warp { warp, child } => {
                let inside = warp.inside(region);
                let frame = self.frame(frame, id, 0);
                let (child, bounds) = self.visit(*child, frame, &inside, want)?;
                Some((self.push(Task::Warp(warp, child), id, want), warp.bounds(&region.area, &bounds)))
            }
            Node::Level { thresholds, a, b } => {
                let t = thresholds.shares(region.kappa);
                if t.max <= 0.0 {
                    return self.visit(*a, frame, region, want);
                }
                if t.min >= 1.0 {
                    return self.visit(*b, frame, region, want);
                }
                let (left, right) = (self.visit(*a, frame, region, want), self.visit(*b, frame, region, want));
                if left.is_none() && right.is_none() {
                    return None;
                }
                let bounds = |side: &Option<(StepId, Bounds)>| side.map_or(Bounds::NOTHING, |(_, bounds)| bounds);
                let bounds = level::bounds(thresholds, t, region.kappa_slope, &bounds(&left), &bounds(&right));
                let task = Task::Level(thresholds, left.map(|(id, _)| id), right.map(|(id, _)| id));
                Some((self.push(task, id, want), bounds))
            }
            Node::Weigh { rules, child, guide } => self.weighed(id, rules, (*child, *guide), frame, region, want),
        }
    }

    fn replaced(
        &mut self,
        id: NodeId,
        rule: WeightRule,
        (a, b): (NodeId, NodeId),
        frame: u32,
        region: &Region,
        want: Want,
    ) -> Option<(StepId, Bounds)> {
        if rule == WeightRule::Keep && !want.elevation {
            return self.visit(a, frame, region, want);
        }
        let Some((right, right_bounds)) = self.visit(b, frame, region, want) else {
            return self.visit(a, frame, region, want);
        };
        let covers = right_bounds.weight.min >= 1.0;
        let left = match rule {
            WeightRule::Join if covers => None,
            WeightRule::Keep if covers => self.visit(a, frame, region, Want { elevation: false, ..want }),
            _ => self.visit(a, frame, region, want),
        };
        if left.is_none() && rule == WeightRule::Keep {
            return None;
        }
        let left_bounds = left.map_or(Bounds::NOTHING, |(_, bounds)| bounds);
        let step = self.push(Task::Replace(rule, left.map(|(id, _)| id), right), id, want);
        Some((step, replace::bounds(rule, &left_bounds, &right_bounds)))
    }

    fn weighed(
        &mut self,
        id: NodeId,
        rules: &'t Rules,
        (child, guide): (NodeId, NodeId),
        frame: u32,
        region: &Region,
        want: Want,
    ) -> Option<(StepId, Bounds)> {
        let (child, child_bounds) = self.visit(child, frame, region, want)?;
        let seen = Want { elevation: true, gradient: want.gradient || rules.slope.is_some() };
        let guide_id = guide;
        let (guide, guide_bounds) = self.visit(guide_id, frame, region, seen)?;
        let share = weigh::share(rules, &guide_bounds);
        if share.0.max <= 0.0 {
            return None;
        }
        if share.0.min >= 1.0 && share.1 == 0.0 {
            return Some((child, child_bounds));
        }
        let around = (rules.slope.is_some() && want.gradient).then(|| {
            let mut steps = [None; 4];
            for (i, step) in STEPS.iter().enumerate() {
                let frame = self.frame(frame, id, 1 + i as u32);
                let area = region.area.grown(step[0].abs().max(step[1].abs())).widened();
                steps[i] = self.visit(guide_id, frame, &region.over(area), seen).map(|(id, _)| id);
            }
            steps
        });
        let step = self.push(Task::Weigh(rules, child, guide, around), id, want);
        Some((step, weigh::bounds(share, &child_bounds)))
    }
}
