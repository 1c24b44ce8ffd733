//! Curves of a scene: rivers and roads, along points or the lines of a layer.

use super::drape::{even, lay};
use super::fields::{Object, Value};
use super::leaf::{fall_off, profile};
use super::node::Reader;
use super::sources::{Line, LineQuery};
use crate::construction::detail::Detail;
use crate::construction::primitive::{Curve, Profile, Skeleton};
use crate::construction::tree::{Builder, NodeId};
use crate::error::Result;

/// Members of a curve.
const KNOWN: [&str; 13] = [
    "points",
    "lines",
    "smooth",
    "z_m",
    "drape",
    "z_shift_m",
    "even_m",
    "descend",
    "profile",
    "sections",
    "channel",
    "radius_m",
    "plateau_m",
];

impl<'a> Reader<'a> {
    pub(super) fn curve(&mut self, builder: &mut Builder, body: &Value<'a>) -> Result<NodeId> {
        let parts = body.object(&KNOWN)?;
        let smooth = parts.get("smooth").map_or(Ok(true), |smooth| smooth.flag())?;
        let lines = self.plan_lines(&parts)?;
        let lines = self.with_elevations(lines, builder, &parts, body)?;
        let several = lines.len() > 1;
        let mut curves = vec![];
        for (n, line) in lines.iter().enumerate() {
            let sections = sections(&parts, line)?;
            let fall_off = fall_off(&parts, "radius_m", "plateau_m", body)?;
            let curve = Skeleton::through(&line.points, smooth)
                .and_then(|skeleton| Curve::new(skeleton, sections, fall_off))
                .and_then(|curve| builder.leaf(curve));
            let of_line = |place: String| if several { format!("{place}, line {n}") } else { place };
            let id = curve.map_err(|e| body.blame(&if several { e.at_place(format!("line {n}")) } else { e }))?;
            self.places.push((id, of_line(body.place())));
            curves.push(id);
        }
        match curves[..] {
            [one] => Ok(one),
            _ => builder.blend(&curves).map_err(|e| body.blame(&e)),
        }
    }

    /// Lines in plan: points of the scene, or the lines of a layer, which make as many curves.
    fn plan_lines(&mut self, parts: &Object<'a>) -> Result<Vec<Line>> {
        if let Some(points) = parts.get("points") {
            let mut line = Line::default();
            for item in points.items()? {
                line.points.push(match item.items()?.len() {
                    2 => {
                        let [x, y] = item.numbers()?;
                        [x, y, f64::NAN]
                    }
                    _ => item.numbers()?,
                });
            }
            return Ok(vec![line]);
        }
        let source = parts.need("lines")?;
        let own = source.object(&["path", "layer", "where"])?;
        let path = own.need("path")?;
        let layer = own.get("layer").map(|layer| layer.text()).transpose()?;
        let filter = own.get("where").map(|filter| filter.text()).transpose()?;
        let query = LineQuery { path: path.text()?, layer, filter };
        let mut lines = self.sources.lines(&query).map_err(|e| path.blame(&e))?;
        for point in lines.iter_mut().flat_map(|line| &mut line.points) {
            point[0] -= self.origin[0];
            point[1] -= self.origin[1];
        }
        if lines.is_empty() {
            return Err(source.fault("the layer has no such lines"));
        }
        Ok(lines)
    }

    /// Gives lines their elevations.
    fn with_elevations(
        &mut self,
        mut lines: Vec<Line>,
        builder: &mut Builder,
        parts: &Object<'a>,
        body: &Value<'a>,
    ) -> Result<Vec<Line>> {
        let z_m = parts.get("z_m").map(|z| z.number()).transpose()?;
        let z_shift_m = parts.number_or("z_shift_m", 0.0)?;
        let even_m = parts.get("even_m").map(|even| even.number_within(f64::MIN_POSITIVE, f64::MAX)).transpose()?;
        let descend = parts.get("descend").map_or(Ok(false), |descend| descend.flag())?;
        if let (Some(node), None) = (parts.get("drape"), z_m) {
            let id = self.node(builder, &node)?;
            let ground = builder.clone().finish(id, Detail::default())?;
            let laid: Vec<_> = lines.iter().map(|line| lay(line, &ground)).collect();
            let beside: usize = laid.iter().map(|laid| laid.beside).sum();
            if laid.iter().all(|laid| laid.parts.is_empty()) {
                let at = lines.iter().flat_map(|line| &line.points).next().copied().unwrap_or([0.0; 3]);
                let message = format!(
                    "not defined at ({}, {}), nor elsewhere under the curve that is laid upon it",
                    at[0], at[1]
                );
                return Err(node.fault(message));
            }
            if beside > 0 {
                let place = body.place();
                self.notes
                    .push(format!("{place}: {beside} of its points lie beside what it is laid upon, and are cut away"));
            }
            lines = laid.into_iter().flat_map(|laid| laid.parts).collect();
        }
        for line in &mut lines {
            let mut lowest = f64::INFINITY;
            if z_m.is_none() && line.points.iter().any(|point| point[2].is_nan()) {
                return Err(body.fault("points without elevation; give them as [x, y, z], or z_m, or drape"));
            }
            for point in &mut line.points {
                point[2] = z_m.unwrap_or(point[2]) + z_shift_m;
            }
            if let Some(within_m) = even_m {
                even(&mut line.points, within_m);
            }
            for point in line.points.iter_mut().filter(|_| descend) {
                lowest = lowest.min(point[2]);
                point[2] = lowest;
            }
        }
        Ok(lines)
    }
}

/// Cross-sections of a curve: one profile, several, or a channel of a width and a depth.
fn sections(parts: &Object<'_>, line: &Line) -> Result<Vec<(f64, Profile)>> {
    if let Some(list) = parts.get("sections") {
        let mut sections = vec![];
        for item in list.items()? {
            let own = item.object(&["at", "profile"])?;
            sections.push((own.need("at")?.number_within(0.0, 1.0)?, profile(&own.need("profile")?)?));
        }
        return Ok(sections);
    }
    let Some(channel) = parts.get("channel") else {
        return Ok(vec![(0.0, profile(&parts.need("profile")?)?)]);
    };
    let own = channel.object(&["width_m", "depth_m", "bank_m"])?;
    // A number, or the name of the field that has it.
    let amount = |name: &str| -> Result<f64> {
        let value = own.need(name)?;
        let found = if value.is_text() {
            let field = value.text()?;
            let missing = || value.fault(format!("the layer has no numeric field '{field}'"));
            line.fields.get(field).copied().ok_or_else(missing)?
        } else {
            value.number()?
        };
        if !(found > 0.0 && found.is_finite()) {
            return Err(value.fault(format!("expected a positive number, found {found}")));
        }
        Ok(found)
    };
    let (half, depth) = (amount("width_m")? / 2.0, amount("depth_m")?);
    let bank = amount("bank_m")?;
    // A flat bed, and banks that rise to the ground.
    let knots = [(-half - bank, 0.0), (-half, -depth), (half, -depth), (half + bank, 0.0)];
    Ok(vec![(0.0, Profile::new(&knots).map_err(|e| channel.blame(&e))?)])
}
