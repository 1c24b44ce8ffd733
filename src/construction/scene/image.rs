//! Images of a scene: rasters, where their georeference says or where they are put.

use super::fields::{Object, Value};
use super::node::Reader;
use super::sources::RasterQuery;
use crate::construction::area::Area;
use crate::construction::operator::Affine;
use crate::construction::primitive::{Image, Interpolation, Mapping, Samples, Skeleton, Sparse};
use crate::construction::tree::{Builder, NodeId};
use crate::error::Result;
use crate::grid::Heights;

/// Members of an image.
const KNOWN: [&str; 11] = [
    "heights",
    "band",
    "crop",
    "weights",
    "box",
    "quadrangle",
    "along",
    "interpolation",
    "fade_cells",
    "z_scale",
    "z_shift_m",
];

impl<'a> Reader<'a> {
    pub(super) fn image(&mut self, builder: &mut Builder, body: &Value<'a>) -> Result<NodeId> {
        let parts = body.object(&KNOWN)?;
        let path = parts.need("heights")?;
        let band = parts.get("band").map_or(Ok(1), |band| band.count(1, 65_535))? as usize;
        let is_placed = ["box", "quadrangle", "along"].iter().all(|name| parts.get(name).is_none());
        let crop = parts.get("crop").map(|value| self.crop(&value, is_placed)).transpose()?;
        let query = RasterQuery { path: path.text()?, band, is_placed, crop };
        let heights = self.sources.heights(&query).map_err(|e| path.blame(&e))?;
        let weights = match parts.get("weights") {
            None => None,
            Some(path) => {
                let query = RasterQuery { path: path.text()?, band: 1, ..query };
                Some(self.sources.weights(&query, heights.as_ref()).map_err(|e| path.blame(&e))?)
            }
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
        self.places.push((id, body.place()));
        match placed {
            None => Ok(id),
            Some(affine) => builder.place(id, affine).map_err(|e| body.blame(&e)),
        }
    }

    /// A part of a raster, in the scene's CRS.
    fn crop(&self, value: &Value<'a>, is_placed: bool) -> Result<[f64; 4]> {
        if !is_placed {
            return Err(value.fault("only a raster that lies where its georeference says can be cropped"));
        }
        let [x, y] = self.origin;
        bounding_box(value).map(|[x0, y0, x1, y1]| [x0 + x, y0 + y, x1 + x, y1 + y])
    }

    /// A terrain of sparse primitives, where the cells of its file lie.
    pub(super) fn sparse(&mut self, builder: &mut Builder, body: &Value<'a>) -> Result<NodeId> {
        let parts = body.object(&["terrain", "z_scale", "z_shift_m"])?;
        let path = parts.need("terrain")?;
        let found = self.sources.sparse(path.text()?).map_err(|e| path.blame(&e))?;
        let t = found.places.0;
        let corner = [t[0] - self.origin[0], t[3] - self.origin[1]];
        let (z_scale, z_shift_m) = (parts.number_or("z_scale", 1.0)?, parts.number_or("z_shift_m", 0.0)?);
        let lift = (found.scale_m * z_scale, found.offset_m * z_scale + z_shift_m);
        let affine = Affine::new([[t[1], t[2]], [t[4], t[5]]], corner, lift.0, lift.1).map_err(|e| body.blame(&e))?;
        let id = Sparse::new(found.terrain).and_then(|sparse| builder.leaf(sparse)).map_err(|e| body.blame(&e))?;
        self.places.push((id, body.place()));
        builder.place(id, affine).map_err(|e| body.blame(&e))
    }

    /// Where an image lies, and how a unit box is placed for rasters that do not lie along the axes.
    fn mapping(
        &mut self,
        parts: &Object<'a>,
        body: &Value<'a>,
        heights: &dyn Heights,
    ) -> Result<(Mapping, Option<Affine>)> {
        if let Some(value) = parts.get("box") {
            let [x0, y0, x1, y1] = bounding_box(&value)?;
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

/// Least x and y, greatest x and y.
fn bounding_box(value: &Value<'_>) -> Result<[f64; 4]> {
    let found @ [x0, y0, x1, y1] = value.numbers()?;
    if x0 >= x1 || y0 >= y1 {
        return Err(value.fault("a box is [xmin, ymin, xmax, ymax]"));
    }
    Ok(found)
}
