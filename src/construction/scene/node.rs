//! Operators and references of a scene.

use super::fields::Value;
use super::sources::Sources;
use crate::construction::operator::{Affine, Deformation, Ramp, Rules, Thresholds, WeightRule};
use crate::construction::tree::{Builder, NodeId};
use crate::error::Result;
use std::collections::BTreeMap;

/// Nodes that a scene's reader may be inside of at once.
const DEEPEST: usize = 400;

/// What became of a named node so far.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Progress {
    Unused,
    Begun,
    Made(NodeId),
}

/// Makes nodes from a document.
pub(super) struct Reader<'a> {
    pub(super) sources: &'a dyn Sources,
    pub(super) origin: [f64; 2],
    names: Vec<String>,
    named: BTreeMap<String, (Value<'a>, Progress)>,
    /// Names that are being made, outermost first.
    open: Vec<String>,
    depth: usize,
    /// Nodes with their places in the document, in the order in which they were made; a node that is made of another
    /// may come twice.
    pub(super) places: Vec<(NodeId, String)>,
    /// What a user should know of how nodes were made.
    pub(super) notes: Vec<String>,
}

/// Members that a node may have; it has exactly one.
const KINDS: [&str; 13] = [
    "disc", "curve", "contour", "image", "sparse", "blend", "replace", "add", "place", "bend", "level", "weigh", "ref",
];

impl<'a> Reader<'a> {
    pub(super) fn new(sources: &'a dyn Sources, origin: [f64; 2], nodes: Option<Value<'a>>) -> Result<Self> {
        let members = nodes.map_or(Ok(vec![]), |nodes| nodes.members())?;
        let names = members.iter().map(|(name, _)| name.clone()).collect();
        let named = members.into_iter().map(|(name, value)| (name, (value, Progress::Unused))).collect();
        Ok(Self { sources, origin, names, named, open: vec![], depth: 0, places: vec![], notes: vec![] })
    }

    /// Named nodes that nothing referred to, in the file's order.
    pub(super) fn unused(&self) -> Vec<String> {
        let unused = |name: &&String| self.named.get(*name).is_some_and(|(_, progress)| *progress == Progress::Unused);
        self.names.iter().filter(unused).cloned().collect()
    }

    /// Makes a node and all below it.
    pub(super) fn node(&mut self, builder: &mut Builder, value: &Value<'a>) -> Result<NodeId> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(value.fault(format!("more than {DEEPEST} nodes inside each other")));
        }
        let made = self.make(builder, value);
        self.depth -= 1;
        made
    }

    fn make(&mut self, builder: &mut Builder, value: &Value<'a>) -> Result<NodeId> {
        let members = value.members()?;
        let [(kind, body)] = &members[..] else {
            let names: Vec<&str> = members.iter().map(|(name, _)| name.as_str()).collect();
            return Err(value
                .fault(format!("a node is an object with one member, one of {}; found {names:?}", KINDS.join(", "))));
        };
        let id = self.of_kind(builder, value, kind, body)?;
        if kind != "ref" {
            self.places.push((id, body.place()));
        }
        Ok(id)
    }

    fn of_kind(&mut self, builder: &mut Builder, value: &Value<'a>, kind: &str, body: &Value<'a>) -> Result<NodeId> {
        match kind {
            "disc" => self.disc(builder, body),
            "curve" => self.curve(builder, body),
            "contour" => self.contour(builder, body),
            "image" => self.image(builder, body),
            "sparse" => self.sparse(builder, body),
            "ref" => self.named(builder, body),
            "blend" => {
                let mut children = vec![];
                for item in body.items()? {
                    children.push(self.node(builder, &item)?);
                }
                if children.is_empty() {
                    return Err(body.fault("a blend of nothing; give at least one node"));
                }
                builder.blend(&children).map_err(|e| body.blame(&e))
            }
            "replace" | "add" => {
                let parts = body.object(&["a", "b", "weight"])?;
                let rule = match parts.get("weight") {
                    None => WeightRule::Keep,
                    Some(rule) => match rule.text()? {
                        "keep" => WeightRule::Keep,
                        "join" => WeightRule::Join,
                        other => return Err(rule.fault(format!("weight is \"keep\" or \"join\", found \"{other}\""))),
                    },
                };
                let (a, b) = (self.node(builder, &parts.need("a")?)?, self.node(builder, &parts.need("b")?)?);
                let made = if kind == "add" { builder.add(a, b, rule) } else { builder.replace(a, b, rule) };
                made.map_err(|e| body.blame(&e))
            }
            "place" => {
                let known = ["node", "scale", "rotate_degrees", "matrix", "move_m", "z_scale", "z_shift_m"];
                let parts = body.object(&known)?;
                let affine = placement(&parts, body)?;
                let child = self.node(builder, &parts.need("node")?)?;
                builder.place(child, affine).map_err(|e| body.blame(&e))
            }
            "bend" => {
                let parts = body.object(&["node", "noise", "drag", "twist"])?;
                let deformation = bending(&parts, body)?;
                let child = self.node(builder, &parts.need("node")?)?;
                builder.bend(child, deformation).map_err(|e| body.blame(&e))
            }
            "level" => {
                let parts = body.object(&["a", "b", "from", "to"])?;
                let thresholds = Thresholds::new(parts.need("from")?.number()?, parts.need("to")?.number()?);
                let thresholds = thresholds.map_err(|e| body.blame(&e))?;
                let (a, b) = (self.node(builder, &parts.need("a")?)?, self.node(builder, &parts.need("b")?)?);
                builder.level(a, b, thresholds).map_err(|e| body.blame(&e))
            }
            "weigh" => {
                let parts = body.object(&["node", "guide", "elevation_m", "slope"])?;
                let ramp = |name: &str| -> Result<Option<Ramp>> {
                    let Some(ends) = parts.get(name) else { return Ok(None) };
                    let [from, to] = ends.numbers()?;
                    Ramp::new(from, to).map(Some).map_err(|e| ends.blame(&e))
                };
                let rules = Rules { elevation: ramp("elevation_m")?, slope: ramp("slope")? };
                let child = self.node(builder, &parts.need("node")?)?;
                let guide = self.node(builder, &parts.need("guide")?)?;
                builder.weigh(child, guide, rules).map_err(|e| body.blame(&e))
            }
            other => Err(value.fault(format!("unknown node '{other}'; known are {}", KINDS.join(", ")))),
        }
    }

    /// The node of a name, made once.
    fn named(&mut self, builder: &mut Builder, value: &Value<'a>) -> Result<NodeId> {
        let name = value.text()?;
        let Some((node, progress)) = self.named.get(name).cloned() else {
            let known = if self.names.is_empty() { "there are none".into() } else { self.names.join(", ") };
            return Err(value.fault(format!("no node '{name}' under \"nodes\"; known: {known}")));
        };
        match progress {
            Progress::Made(id) => return Ok(id),
            Progress::Begun => {
                let from = self.open.iter().position(|open| open == name).unwrap_or(0);
                let way = self.open[from..].join(" -> ");
                return Err(value.fault(format!("a cycle: {way} -> {name}")));
            }
            Progress::Unused => {}
        }
        self.named.insert(name.into(), (node.clone(), Progress::Begun));
        self.open.push(name.into());
        let id = self.node(builder, &node)?;
        self.open.pop();
        self.named.insert(name.into(), (node, Progress::Made(id)));
        Ok(id)
    }
}

/// The affine warp of a `place`.
fn placement(parts: &super::fields::Object<'_>, body: &Value<'_>) -> Result<Affine> {
    let (z_scale, z_shift_m) = (parts.number_or("z_scale", 1.0)?, parts.number_or("z_shift_m", 0.0)?);
    let shift = parts.get("move_m").map_or(Ok([0.0; 2]), |shift| shift.numbers())?;
    let affine = if let Some(matrix) = parts.get("matrix") {
        if parts.get("scale").is_some() || parts.get("rotate_degrees").is_some() {
            return Err(body.fault("give a matrix, or scale and rotate_degrees, not both"));
        }
        let [a, b, c, d] = matrix.numbers()?;
        Affine::new([[a, b], [c, d]], shift, z_scale, z_shift_m)
    } else {
        let scale = match parts.get("scale") {
            None => [1.0; 2],
            Some(scale) if scale.is_array() => scale.numbers()?,
            Some(scale) => [scale.number()?; 2],
        };
        Affine::placed(scale, parts.number_or("rotate_degrees", 0.0)?, shift, z_scale, z_shift_m)
    };
    affine.map_err(|e| body.blame(&e))
}

/// The deformation of a `bend`.
fn bending(parts: &super::fields::Object<'_>, body: &Value<'_>) -> Result<Deformation> {
    if ["noise", "drag", "twist"].iter().filter(|name| parts.get(name).is_some()).count() > 1 {
        return Err(body.fault("a bend has one of noise, drag and twist; put one into another"));
    }
    if let Some(noise) = parts.get("noise") {
        let spectrum = super::leaf::spectrum(&noise.object(&super::leaf::SPECTRUM)?)?;
        return Deformation::noise(spectrum).map_err(|e| noise.blame(&e));
    }
    if let Some(drag) = parts.get("drag") {
        let own = drag.object(&["centre", "by_m", "radius_m"])?;
        let (centre, by) = (own.need("centre")?.numbers()?, own.need("by_m")?.numbers()?);
        return Deformation::drag(centre, by, own.need("radius_m")?.number()?).map_err(|e| drag.blame(&e));
    }
    if let Some(twist) = parts.get("twist") {
        let own = twist.object(&["centre", "degrees", "radius_m"])?;
        let (centre, degrees) = (own.need("centre")?.numbers()?, own.need("degrees")?.number()?);
        return Deformation::twist(centre, degrees, own.need("radius_m")?.number()?).map_err(|e| twist.blame(&e));
    }
    Err(body.fault("a bend needs noise, drag or twist"))
}
