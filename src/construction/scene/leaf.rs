//! Primitives of a scene.

use super::fields::{Object, Value};
use super::node::Reader;
use super::sources::Line;
use crate::construction::area::Area;
use crate::construction::detail::Detail;
use crate::construction::operator::Affine;
use crate::construction::primitive::{
    Contour, Curve, Disc, FallOff, Image, Interpolation, Mapping, Profile, Samples, Skeleton,
};
use crate::construction::tree::{Builder, NodeId};
use crate::error::Result;
use crate::noise::{Filter, NoiseKind, NoiseSum, Spectrum};

/// Members of a spectrum of noise.
pub(super) const SPECTRUM: [&str; 6] = ["octaves", "amplitude_m", "wavelength_m", "persistence", "lacunarity", "seed"];

/// A spectrum of noise.
pub(super) fn spectrum(parts: &Object<'_>) -> Result<Spectrum> {
    let positive = f64::MIN_POSITIVE;
    let wavelength = parts.need("wavelength_m")?;
    let octaves = parts.get("octaves").map_or(Ok(1), |octaves| octaves.count(1, 32))?;
    Ok(Spectrum {
        octaves: octaves as usize,
        amplitude: parts.need("amplitude_m")?.number()?,
        wavelength: wavelength.number_within(positive, f64::MAX)?,
        persistence: parts.number_or("persistence", 0.5)?,
        lacunarity: parts.get("lacunarity").map_or(Ok(2.0), |value| value.number_within(positive, f64::MAX))?,
        seed: parts.get("seed").map_or(Ok(0), |seed| seed.count(0, u64::MAX))?,
    })
}

fn noise(value: &Value<'_>) -> Result<NoiseSum> {
    let known: Vec<&str> = ["kind", "offset", "gain", "detail"].into_iter().chain(SPECTRUM).collect();
    let parts = value.object(&known)?;
    let kind = match parts.get("kind") {
        None => NoiseKind::Fractal,
        Some(kind) => match kind.text()? {
            "fractal" => NoiseKind::Fractal,
            "turbulence" => NoiseKind::Turbulence,
            "ridged" => {
                NoiseKind::Ridged { offset: parts.number_or("offset", 1.0)?, gain: parts.number_or("gain", 2.0)? }
            }
            other => {
                return Err(
                    kind.fault(format!("noise is \"fractal\", \"turbulence\" or \"ridged\", found \"{other}\""))
                );
            }
        },
    };
    let spectrum = spectrum(&parts)?;
    let sum = NoiseSum::new(kind, spectrum.terms());
    let Some(detail) = parts.get("detail") else { return Ok(sum) };
    let mut filters = vec![];
    for item in detail.items()? {
        let [from, to] = item.numbers()?;
        if !(0.0 <= from && from < to && to <= 1.0) {
            return Err(item.fault("an octave sets in over [from, to] with 0 <= from < to <= 1"));
        }
        filters.push(Filter { from, to });
    }
    if filters.len() != spectrum.octaves {
        return Err(detail.fault(format!("{} octaves need as many ranges, found {}", spectrum.octaves, filters.len())));
    }
    Ok(sum.with_filters(filters))
}

fn fall_off(parts: &Object<'_>, radius: &str, plateau: &str, body: &Value<'_>) -> Result<FallOff> {
    let radius_m = parts.need(radius)?.number()?;
    FallOff::new(parts.number_or(plateau, 0.0)?, radius_m).map_err(|e| body.blame(&e))
}

fn profile(value: &Value<'_>) -> Result<Profile> {
    let mut knots = vec![];
    for item in value.items()? {
        let [at, z] = item.numbers()?;
        knots.push((at, z));
    }
    Profile::new(&knots).map_err(|e| value.blame(&e))
}

impl<'a> Reader<'a> {
    pub(super) fn disc(&mut self, builder: &mut Builder, body: &Value<'a>) -> Result<NodeId> {
        let parts = body.object(&["centre", "base_m", "noise", "radius_m", "plateau_m"])?;
        let centre = parts.get("centre").map_or(Ok([0.0; 2]), |centre| centre.numbers())?;
        let noise = parts.get("noise").map(|value| noise(&value)).transpose()?;
        let fall_off = match parts.get("radius_m") {
            None => None,
            Some(_) => Some(fall_off(&parts, "radius_m", "plateau_m", body)?),
        };
        let disc = Disc::new(centre, parts.number_or("base_m", 0.0)?, noise, fall_off);
        disc.and_then(|disc| builder.leaf(disc)).map_err(|e| body.blame(&e))
    }

    pub(super) fn contour(&mut self, builder: &mut Builder, body: &Value<'a>) -> Result<NodeId> {
        let parts = body.object(&["centre", "z_m", "points", "profile", "profiles", "radius", "plateau"])?;
        let mut points = vec![];
        for item in parts.need("points")?.items()? {
            points.push(item.numbers()?);
        }
        let profiles = match parts.get("profiles") {
            None => vec![profile(&parts.need("profile")?)?],
            Some(list) => list.items()?.iter().map(profile).collect::<Result<Vec<Profile>>>()?,
        };
        let fall_off = fall_off(&parts, "radius", "plateau", body)?;
        let z_m = parts.need("z_m")?.number()?;
        let contour = Contour::new(parts.need("centre")?.numbers()?, z_m, &points, profiles, fall_off);
        contour.and_then(|contour| builder.leaf(contour)).map_err(|e| body.blame(&e))
    }

    /// Points of a curve: in the scene, or the lines of a layer, which make as many curves.
    fn lines(&mut self, parts: &Object<'a>) -> Result<Vec<Line>> {
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
        let own = source.object(&["path", "layer"])?;
        let path = own.need("path")?;
        let layer = own.get("layer").map(|layer| layer.text()).transpose()?;
        let mut lines = self.sources.lines(path.text()?, layer).map_err(|e| path.blame(&e))?;
        for point in lines.iter_mut().flat_map(|line| &mut line.points) {
            point[0] -= self.origin[0];
            point[1] -= self.origin[1];
        }
        if lines.is_empty() {
            return Err(source.fault("the layer has no lines"));
        }
        Ok(lines)
    }

    pub(super) fn curve(&mut self, builder: &mut Builder, body: &Value<'a>) -> Result<NodeId> {
        let known = [
            "points",
            "lines",
            "smooth",
            "z_m",
            "drape",
            "z_shift_m",
            "descend",
            "profile",
            "sections",
            "channel",
            "radius_m",
            "plateau_m",
        ];
        let parts = body.object(&known)?;
        let smooth = parts.get("smooth").map_or(Ok(true), |smooth| smooth.flag())?;
        let descend = parts.get("descend").map_or(Ok(false), |descend| descend.flag())?;
        let (z_m, z_shift_m) = (parts.get("z_m").map(|z| z.number()).transpose()?, parts.number_or("z_shift_m", 0.0)?);
        let fall_off = fall_off(&parts, "radius_m", "plateau_m", body)?;
        // The ground under the curve, where it is to be laid upon another node.
        let ground = match parts.get("drape") {
            None => None,
            Some(node) => {
                let id = self.node(builder, &node)?;
                Some((node, builder.clone().finish(id, Detail::default())?))
            }
        };
        let mut curves = vec![];
        for (n, mut line) in self.lines(&parts)?.into_iter().enumerate() {
            let mut lowest = f64::INFINITY;
            for point in &mut line.points {
                if let Some(z_m) = z_m {
                    point[2] = z_m;
                } else if let Some((node, tree)) = &ground {
                    let under = tree.elevation_m([point[0], point[1]]);
                    point[2] = under.ok_or_else(|| {
                        node.fault(format!(
                            "not defined at ({}, {}), where line {n} of the curve is laid upon it",
                            point[0], point[1]
                        ))
                    })?;
                } else if point[2].is_nan() {
                    return Err(body.fault("points without elevation; give them as [x, y, z], or z_m, or drape"));
                }
                point[2] += z_shift_m;
                lowest = lowest.min(point[2]);
                if descend {
                    point[2] = lowest;
                }
            }
            let sections = sections(&parts, &line)?;
            let curve = Skeleton::through(&line.points, smooth)
                .and_then(|skeleton| Curve::new(skeleton, sections, fall_off))
                .and_then(|curve| builder.leaf(curve));
            curves.push(curve.map_err(|e| body.blame(&e).at_place(format!("line {n}")))?);
        }
        match curves[..] {
            [one] => Ok(one),
            _ => builder.blend(&curves).map_err(|e| body.blame(&e)),
        }
    }

    pub(super) fn image(&mut self, builder: &mut Builder, body: &Value<'a>) -> Result<NodeId> {
        let known = [
            "heights",
            "band",
            "weights",
            "box",
            "quadrangle",
            "along",
            "interpolation",
            "fade_cells",
            "z_scale",
            "z_shift_m",
        ];
        let parts = body.object(&known)?;
        let path = parts.need("heights")?;
        let band = parts.get("band").map_or(Ok(1), |band| band.count(1, 65_535))? as usize;
        let heights = self.sources.heights(path.text()?, band).map_err(|e| path.blame(&e))?;
        let weights = match parts.get("weights") {
            None => None,
            Some(path) => Some(self.sources.heights(path.text()?, 1).map_err(|e| path.blame(&e))?),
        };
        let samples = Samples::read(heights.as_ref(), weights.as_deref()).map_err(|e| path.blame(&e))?;
        let interpolation = match parts.get("interpolation") {
            None => Interpolation::Bilinear,
            Some(value) => match value.text()? {
                "bilinear" => Interpolation::Bilinear,
                "bicubic" => Interpolation::Bicubic,
                other => {
                    let message = format!("interpolation is \"bilinear\" or \"bicubic\", found \"{other}\"");
                    return Err(value.fault(message));
                }
            },
        };
        let (mapping, placed) = self.mapping(&parts, body, heights.as_ref())?;
        let lift = (parts.number_or("z_scale", 1.0)?, parts.number_or("z_shift_m", 0.0)?);
        let image = Image::new(samples, mapping, interpolation, parts.number_or("fade_cells", 0.0)?, lift);
        let id = image.and_then(|image| builder.leaf(image)).map_err(|e| body.blame(&e))?;
        match placed {
            None => Ok(id),
            Some(affine) => builder.place(id, affine).map_err(|e| body.blame(&e)),
        }
    }

    /// Where an image lies, and how a unit box is placed for rasters that do not lie along the axes.
    fn mapping(
        &mut self,
        parts: &Object<'a>,
        body: &Value<'a>,
        heights: &dyn crate::grid::Heights,
    ) -> Result<(Mapping, Option<Affine>)> {
        if let Some(value) = parts.get("box") {
            let [x0, y0, x1, y1] = value.numbers()?;
            if x0 >= x1 || y0 >= y1 {
                return Err(value.fault("a box is [xmin, ymin, xmax, ymax]"));
            }
            return Ok((Mapping::on_box(Area::of(&[[x0, y0], [x1, y1]])).map_err(|e| value.blame(&e))?, None));
        }
        if let Some(value) = parts.get("quadrangle") {
            let items = value.items()?;
            if items.len() != 4 {
                return Err(value.fault("a quadrangle has four corners"));
            }
            let mut corners = [[0.0; 2]; 4];
            for (corner, item) in corners.iter_mut().zip(&items) {
                *corner = item.numbers()?;
            }
            return Ok((Mapping::on_quadrangle(corners).map_err(|e| value.blame(&e))?, None));
        }
        if let Some(value) = parts.get("along") {
            let own = value.object(&["points", "half_width_m", "smooth"])?;
            let mut points = vec![];
            for item in own.need("points")?.items()? {
                let [x, y] = item.numbers()?;
                points.push([x, y, 0.0]);
            }
            let smooth = own.get("smooth").map_or(Ok(true), |smooth| smooth.flag())?;
            let half_width_m = own.need("half_width_m")?.number()?;
            let mapping =
                Skeleton::through(&points, smooth).and_then(|skeleton| Mapping::along(skeleton, half_width_m));
            return Ok((mapping.map_err(|e| value.blame(&e))?, None));
        }
        let Some(own) = heights.georeference() else {
            return Err(body.fault("the raster has no georeference; give box, quadrangle or along"));
        };
        let (rows, cols) = (heights.rows(), heights.cols());
        let centre = |row: usize, col: usize| {
            let (x, y) = own.centre(row as f64, col as f64);
            [x - self.origin[0], y - self.origin[1]]
        };
        if own.is_axis_parallel() && own.0[1] > 0.0 && own.0[5] < 0.0 {
            let area = Area::of(&[centre(rows - 1, 0), centre(0, cols - 1)]);
            return Ok((Mapping::on_box(area).map_err(|e| body.blame(&e))?, None));
        }
        // A unit box, its rows and columns along those of the raster.
        let (corner, east, north) = (centre(rows - 1, 0), centre(rows - 1, cols - 1), centre(0, 0));
        let along = |p: [f64; 2], k: usize| p[k] - corner[k];
        let matrix = [[along(east, 0), along(north, 0)], [along(east, 1), along(north, 1)]];
        let affine = Affine::new(matrix, corner, 1.0, 0.0).map_err(|e| body.blame(&e))?;
        let unit = Mapping::on_box(Area::of(&[[0.0, 0.0], [1.0, 1.0]])).map_err(|e| body.blame(&e))?;
        Ok((unit, Some(affine)))
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
