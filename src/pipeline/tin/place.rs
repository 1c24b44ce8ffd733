//! What the coordinates of a mesh are: those of the raster's CRS, in metres, or those of a plane that touches the Earth
//! in the raster's middle.

use super::write::MeshFormat;
use crate::crs::CrsKind;
use crate::error::{Error, ErrorKind, Result};
use crate::io::raster::RasterSource;
use crate::io::transform::LocalPlane;
use crate::tin::Mesh;

/// How far from the plane's point a cell may be, in degrees; distances there are longer by less than one per cent.
const REACH: f64 = 10.0;

/// What is done with the coordinates of a raster.
pub(in crate::pipeline) enum Placed {
    /// They stay as they are: in layers, which have a CRS of their own.
    Kept,
    /// They are plane, and are multiplied to be metres.
    Metres(f64),
    /// They are longitudes and latitudes in units of so many degrees, and are projected.
    Plane(LocalPlane, f64),
}

impl Placed {
    /// What the coordinates of a raster become in a file of a format.
    ///
    /// # Errors
    /// Longitudes and latitudes over a larger part of the globe than a plane can show.
    pub(in crate::pipeline) fn of(source: &RasterSource, format: MeshFormat) -> Result<Self> {
        if format == MeshFormat::GeoPackage {
            return Ok(Self::Kept);
        }
        match source.crs.as_ref().map(|crs| &crs.kind) {
            Some(CrsKind::Geographic { ellipsoid, degrees }) => {
                let [_, _, cols, rows] = source.window.map(|v| v as f64);
                let ends = [(0.0, 0.0), (rows - 1.0, 0.0), (0.0, cols - 1.0), (rows - 1.0, cols - 1.0)];
                let ends =
                    ends.map(|(row, col)| source.transform.centre(row, col)).map(|(x, y)| (x * degrees, y * degrees));
                let middle = source.transform.centre((rows - 1.0) / 2.0, (cols - 1.0) / 2.0);
                let (lon, lat) = (middle.0 * degrees, middle.1 * degrees);
                let is_near = ends.iter().all(|&(x, y)| {
                    // The widest of its rows is the one nearest to the equator.
                    let wide = (x - lon).abs() * y.abs().min(lat.abs()).to_radians().cos();
                    y.abs() <= 90.0 + 1e-9 && (y - lat).abs().max(wide) <= REACH
                });
                if !is_near {
                    return Err(Error::new(
                        ErrorKind::Unsupported,
                        format!(
                            "the raster's longitudes and latitudes reach more than {REACH} degrees from its middle, too far for a mesh in \
                             metres on a plane: cut it with --window or --bbox, project it with gdalwarp -t_srs, or write a .gpkg, which \
                             keeps longitudes and latitudes"
                        ),
                    ));
                }
                Ok(Self::Plane(LocalPlane::new(ellipsoid, lon, lat)?, *degrees))
            }
            Some(CrsKind::Projected { metres, .. } | CrsKind::Local { metres }) => Ok(Self::Metres(*metres)),
            None => Ok(Self::Metres(1.0)),
        }
    }

    /// Gives a mesh in coordinates of the raster's CRS its final ones.
    ///
    /// # Errors
    /// Places that have no image in the plane.
    pub(in crate::pipeline) fn place(&self, mesh: &mut Mesh) -> Result<()> {
        match self {
            Self::Kept => {}
            Self::Metres(1.0) => {}
            Self::Metres(metres) => mesh.vertices.iter_mut().for_each(|v| {
                v[0] *= metres;
                v[1] *= metres;
            }),
            Self::Plane(plane, degrees) => {
                let (mut x, mut y): (Vec<f64>, Vec<f64>) =
                    mesh.vertices.iter().map(|v| (v[0] * degrees, v[1] * degrees)).unzip();
                plane.project(&mut x, &mut y)?;
                for (vertex, (x, y)) in mesh.vertices.iter_mut().zip(x.into_iter().zip(y)) {
                    (vertex[0], vertex[1]) = (x, y);
                }
            }
        }
        Ok(())
    }

    /// The plane as a PROJ string, where it is not that of the raster's CRS.
    pub(in crate::pipeline) fn plane_definition(&self) -> Option<&str> {
        if let Self::Plane(plane, _) = self { Some(plane.definition()) } else { None }
    }

    /// What a file of a format takes away from coordinates: whole metres near the mesh's middle where the format, or
    /// most programs that read it, have single precision. Elevations stay.
    pub(in crate::pipeline) fn origin(&self, format: MeshFormat, mesh: &Mesh) -> [f64; 3] {
        match (format, self, mesh.bounds()) {
            (MeshFormat::Obj | MeshFormat::Glb, Self::Metres(_), Some((low, high))) => {
                let middle = |i: usize| ((low[i] + high[i]) / 2.0).floor();
                [middle(0), middle(1), 0.0]
            }
            _ => [0.0; 3],
        }
    }
}
