//! The tree of nodes, and its evaluation point by point.

use super::area::{Area, Region};
use super::bounds::Bounds;
use super::detail::Detail;
use super::operator::boxes::Boxes;
use super::operator::warp::Warp;
use super::operator::weigh::STEP_M;
use super::operator::{Affine, Deformation, Rules, Thresholds, WeightRule, add, blend, level, replace, weigh};
use super::plan::Plan;
use super::point::{Place, Point, Want};
use super::primitive::Primitive;
use crate::error::{Error, ErrorKind, Result};
use std::sync::Arc;

/// Children from which on a blend keeps a tree of boxes over them.
const MANY: usize = 8;

/// Nodes on the longest way down; evaluation calls itself as deep.
const DEEPEST: usize = 500;

/// Index of a node; children come before their parents, so there are no cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct NodeId(pub(super) u32);

/// A node.
#[derive(Clone, Debug)]
pub(super) enum Node {
    Leaf(Arc<dyn Primitive>),
    Blend { children: Vec<NodeId>, boxes: Option<Boxes> },
    Replace { rule: WeightRule, a: NodeId, b: NodeId },
    Add { rule: WeightRule, a: NodeId, b: NodeId },
    Warp { warp: Warp, child: NodeId },
    Level { thresholds: Thresholds, a: NodeId, b: NodeId },
    Weigh { rules: Rules, child: NodeId, guide: NodeId },
}

/// Puts nodes together; the same node may be the child of many (an instance: nothing is copied).
#[derive(Clone, Debug, Default)]
pub struct Builder {
    nodes: Vec<Node>,
    supports: Vec<Area>,
    parents: Vec<u32>,
    depths: Vec<usize>,
}

/// A construction tree: a terrain as a function of position (Génevaux et al. 2015).
#[derive(Clone, Debug)]
pub struct Tree {
    pub(super) nodes: Vec<Node>,
    pub(super) supports: Vec<Area>,
    /// Whether a node has more than one parent.
    pub(super) shared: Vec<bool>,
    pub(super) root: NodeId,
    pub(super) detail: Detail,
}

impl Node {
    /// The children.
    pub(super) fn children(&self) -> Vec<NodeId> {
        match self {
            Self::Leaf(_) => vec![],
            Self::Blend { children, .. } => children.clone(),
            Self::Replace { a, b, .. } | Self::Add { a, b, .. } | Self::Level { a, b, .. } => vec![*a, *b],
            Self::Warp { child, .. } => vec![*child],
            Self::Weigh { child, guide, .. } => vec![*child, *guide],
        }
    }
}

impl Builder {
    /// A builder without nodes.
    pub fn new() -> Self {
        Self::default()
    }

    fn push(&mut self, node: Node, support: Area) -> Result<NodeId> {
        let children = node.children();
        let mut depth = 1;
        for child in children {
            let at = child.0 as usize;
            let Some(below) = self.depths.get(at) else {
                return Err(Error::usage("a child of another tree"));
            };
            depth = depth.max(below + 1);
            self.parents[at] += 1;
        }
        if depth > DEEPEST {
            let message = format!(
                "the tree is more than {DEEPEST} nodes deep; a blend takes any number of children, and operands may be joined first"
            );
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        let id = u32::try_from(self.nodes.len())
            .map_err(|_| Error::new(ErrorKind::Unsupported, "a tree has less than 2^32 nodes"))?;
        self.nodes.push(node);
        self.supports.push(support);
        self.parents.push(0);
        self.depths.push(depth);
        Ok(NodeId(id))
    }

    /// The box of a node that is there; nothing for one of another tree, which `push` refuses.
    fn support(&self, id: NodeId) -> Area {
        self.supports.get(id.0 as usize).copied().unwrap_or(Area::EMPTY)
    }

    /// A primitive.
    ///
    /// # Errors
    /// Of too many nodes, here and below; operators also refuse nodes of another tree, and trees too deep.
    pub fn leaf(&mut self, primitive: impl Primitive + 'static) -> Result<NodeId> {
        let support = primitive.support();
        self.push(Node::Leaf(Arc::new(primitive)), support)
    }

    /// Blends any number of nodes.
    ///
    /// # Errors
    /// As [`Builder::leaf`].
    pub fn blend(&mut self, children: &[NodeId]) -> Result<NodeId> {
        let areas: Vec<Area> = children.iter().map(|&id| self.support(id)).collect();
        let support = areas.iter().fold(Area::EMPTY, |all, area| all.hull(area));
        let boxes = (areas.len() >= MANY).then(|| Boxes::new(areas));
        self.push(Node::Blend { children: children.to_vec(), boxes }, support)
    }

    /// Replaces `a` by `b` where `b` is defined.
    ///
    /// # Errors
    /// As [`Builder::leaf`].
    pub fn replace(&mut self, a: NodeId, b: NodeId, rule: WeightRule) -> Result<NodeId> {
        let support = self.joined(a, b, rule);
        self.push(Node::Replace { rule, a, b }, support)
    }

    /// Adds `b` to `a`.
    ///
    /// # Errors
    /// As [`Builder::leaf`].
    pub fn add(&mut self, a: NodeId, b: NodeId, rule: WeightRule) -> Result<NodeId> {
        let support = self.joined(a, b, rule);
        self.push(Node::Add { rule, a, b }, support)
    }

    fn joined(&self, a: NodeId, b: NodeId, rule: WeightRule) -> Area {
        match rule {
            WeightRule::Keep => self.support(a),
            WeightRule::Join => self.support(a).hull(&self.support(b)),
        }
    }

    /// Moves, turns, scales or lifts a node; of consecutive warps one is made, so the node returned may stand on the
    /// child's own child.
    ///
    /// # Errors
    /// As [`Builder::leaf`]; and where the product of consecutive warps is singular.
    pub fn place(&mut self, child: NodeId, affine: Affine) -> Result<NodeId> {
        let (affine, child) = match self.nodes.get(child.0 as usize) {
            Some(Node::Warp { warp: Warp::Affine(inner), child }) => (affine.after(inner)?, *child),
            _ => (affine, child),
        };
        self.warp(child, Warp::Affine(affine))
    }

    /// Bends a node.
    ///
    /// # Errors
    /// As [`Builder::leaf`].
    pub fn bend(&mut self, child: NodeId, deformation: Deformation) -> Result<NodeId> {
        self.warp(child, Warp::Deformation(Box::new(deformation)))
    }

    fn warp(&mut self, child: NodeId, warp: Warp) -> Result<NodeId> {
        let support = warp.support(&self.support(child));
        self.push(Node::Warp { warp, child }, support)
    }

    /// `a` where little detail is asked for, `b` where much is.
    ///
    /// # Errors
    /// As [`Builder::leaf`].
    pub fn level(&mut self, a: NodeId, b: NodeId, thresholds: Thresholds) -> Result<NodeId> {
        let support = self.support(a).hull(&self.support(b));
        self.push(Node::Level { thresholds, a, b }, support)
    }

    /// Makes the weight of `child` depend on the elevation or slope of `guide`.
    ///
    /// # Errors
    /// As [`Builder::leaf`].
    pub fn weigh(&mut self, child: NodeId, guide: NodeId, rules: Rules) -> Result<NodeId> {
        let support = self.support(child).meet(&self.support(guide));
        self.push(Node::Weigh { rules, child, guide }, support)
    }

    /// The tree below `root`.
    ///
    /// # Errors
    /// A usage error for a root of another tree.
    pub fn finish(self, root: NodeId, detail: Detail) -> Result<Tree> {
        if root.0 as usize >= self.nodes.len() {
            return Err(Error::usage("the root is a node of another tree"));
        }
        let shared = self.parents.iter().map(|&count| count > 1).collect();
        Ok(Tree { nodes: self.nodes, supports: self.supports, shared, root, detail })
    }
}

impl Tree {
    /// A box outside of which nothing is defined; endless for terrain that is.
    pub fn support(&self) -> Area {
        self.supports[self.root.0 as usize]
    }

    /// The source of the level of detail.
    pub fn detail(&self) -> Detail {
        self.detail
    }

    /// The same tree at another level of detail.
    #[must_use]
    pub fn with_detail(&self, detail: Detail) -> Self {
        Self { detail, ..self.clone() }
    }

    /// The same nodes seen from another root, for layers of water or sand.
    ///
    /// # Panics
    /// When the node is not of this tree.
    #[must_use]
    pub fn with_root(&self, root: NodeId) -> Self {
        assert!((root.0 as usize) < self.nodes.len(), "a node of this tree");
        Self { root, ..self.clone() }
    }

    /// The root, and all nodes below it, in ascending order.
    pub fn reachable(&self) -> Vec<NodeId> {
        let mut is_reached = vec![false; self.nodes.len()];
        is_reached[self.root.0 as usize] = true;
        // Children come before their parents.
        for at in (0..self.nodes.len()).rev().filter(|&at| at <= self.root.0 as usize) {
            if is_reached[at] {
                self.nodes[at].children().iter().for_each(|child| is_reached[child.0 as usize] = true);
            }
        }
        (0..self.nodes.len() as u32).filter(|&at| is_reached[at as usize]).map(NodeId).collect()
    }

    /// The children of a node, in their order.
    ///
    /// # Panics
    /// When the node is not of this tree.
    pub fn children(&self, node: NodeId) -> Vec<NodeId> {
        self.nodes[node.0 as usize].children()
    }

    /// The box outside of which a node is nothing, in its own frame.
    ///
    /// # Panics
    /// When the node is not of this tree.
    pub fn support_of(&self, node: NodeId) -> Area {
        self.supports[node.0 as usize]
    }

    /// Whether a node is a primitive.
    ///
    /// # Panics
    /// When the node is not of this tree.
    pub fn is_primitive(&self, node: NodeId) -> bool {
        matches!(self.nodes[node.0 as usize], Node::Leaf(_))
    }

    /// Numbers of primitives and of operators.
    pub fn counts(&self) -> (usize, usize) {
        let leaves = self.nodes.iter().filter(|node| matches!(node, Node::Leaf(_))).count();
        (leaves, self.nodes.len() - leaves)
    }

    /// Bytes of memory of all nodes.
    pub fn bytes(&self) -> usize {
        let own = |node: &Node| match node {
            Node::Leaf(primitive) => primitive.bytes(),
            Node::Blend { children, boxes } => size_of_val(&children[..]) + boxes.as_ref().map_or(0, Boxes::bytes),
            Node::Warp { warp, .. } => warp.bytes(),
            _ => 0,
        };
        let each = size_of::<Node>() + size_of::<Area>() + size_of::<bool>();
        self.nodes.iter().map(own).sum::<usize>() + self.nodes.len() * each
    }

    /// What the tile needs of the tree, and its bounds there.
    pub fn plan(&self, area: &Area, want: Want) -> Plan<'_> {
        Plan::new(self, self.root, self.detail.over(*area), want)
    }

    /// Bounds of a node over a box of its own frame.
    ///
    /// # Panics
    /// When the node is not of this tree.
    pub fn bounds_of(&self, node: NodeId, area: &Area) -> Bounds {
        *Plan::new(self, node, self.detail.over(*area), Want::ALL).bounds()
    }

    /// Bounds over a box, which may be endless.
    pub fn bounds(&self, area: &Area) -> Bounds {
        *self.plan(area, Want::ALL).bounds()
    }

    /// What is known of a box before evaluation.
    pub fn region(&self, area: &Area) -> Region {
        self.detail.over(*area)
    }

    /// Elevation and weight at a point, with gradients: the reference that [`Plan`] and tiles equal to the bit.
    ///
    /// Terrain is defined where the weight is at least [`super::THRESHOLD`].
    pub fn at(&self, at: [f64; 2]) -> Point {
        self.node_at(self.root, &Place { at, kappa: self.detail.at(at) })
    }

    /// Elevation in metres, or `None` where the terrain is not defined.
    pub fn elevation_m(&self, at: [f64; 2]) -> Option<f64> {
        let point = self.at(at);
        (point.weight.value >= super::THRESHOLD).then_some(point.elevation.value + 0.0)
    }

    fn node_at(&self, id: NodeId, place: &Place) -> Point {
        if !self.supports[id.0 as usize].holds(place.at) {
            return Point::NOTHING;
        }
        match &self.nodes[id.0 as usize] {
            Node::Leaf(primitive) => primitive.at(place),
            Node::Blend { children, boxes: None } => blend::blend(children.iter().map(|&id| self.node_at(id, place))),
            Node::Blend { children, boxes: Some(boxes) } => {
                let mut near = vec![];
                boxes.meeting(&Area::of(&[place.at]), &mut near);
                blend::blend(near.iter().map(|&i| self.node_at(children[i as usize], place)))
            }
            Node::Replace { rule, a, b } => {
                replace::replace::<true>(*rule, self.node_at(*a, place), self.node_at(*b, place))
            }
            Node::Add { rule, a, b } => add::add::<true>(*rule, self.node_at(*a, place), self.node_at(*b, place)),
            Node::Warp { warp, child } => {
                let (inside, jacobian) = warp.enter(place);
                warp.leave(&jacobian, self.node_at(*child, &inside))
            }
            Node::Level { thresholds, a, b } => {
                level::mix::<true>(thresholds, place.kappa, self.node_at(*a, place), self.node_at(*b, place))
            }
            Node::Weigh { rules, child, guide } => {
                let around =
                    rules.slope.is_some().then(|| STEPS.map(|step| self.node_at(*guide, &shifted(place, step))));
                weigh::weigh::<true>(rules, self.node_at(*child, place), self.node_at(*guide, place), around)
            }
        }
    }
}

/// Steps to the left, right, down and up.
pub(super) const STEPS: [[f64; 2]; 4] = [[-STEP_M, 0.0], [STEP_M, 0.0], [0.0, -STEP_M], [0.0, STEP_M]];

/// A place a step away; the level of detail hardly changes, and stays as it is.
#[inline(always)]
pub(super) fn shifted(place: &Place, [dx, dy]: [f64; 2]) -> Place {
    Place { at: [place.at[0] + dx, place.at[1] + dy], kappa: place.kappa }
}
