//! The cells that a scene is evaluated at: their size, and where they lie.

use super::files::{north_up, places_of};
use super::read::SceneFile;
use super::resample::same_in_effect;
use crate::construction::{Area, Lattice, Tree};
use crate::error::{Error, Result};
use crate::grid::GeoTransform;
use crate::io::raster::{RasterOptions, RasterSource};
use crate::pipeline::archive::open_dem;
use crate::watch::Watch;
use std::path::PathBuf;

/// Most cells in a row or column.
const LONGEST: f64 = 1e9;

/// Which cells are wanted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellOptions {
    /// Side of a cell in metres; that of the finest raster of the scene unless given, on its cells.
    pub resolution_m: Option<f64>,
    /// Least x, least y, greatest x, greatest y in the scene's CRS; where the scene is unless given.
    pub bbox: Option<[f64; 4]>,
    /// A raster whose cells are wanted, in place of both.
    pub like: Option<PathBuf>,
}

/// Cells of an output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneCells {
    /// Their centres, in coordinates of the scene.
    pub lattice: Lattice,
    /// Where they lie in the scene's CRS.
    pub transform: GeoTransform,
}

impl SceneCells {
    /// The cells that are wanted of a tree of a scene.
    ///
    /// # Errors
    /// Where a size is missing or none, the scene is endless and no box is given, or no part of it lies in the box.
    pub fn of(file: &SceneFile, tree: &Tree, options: &CellOptions, watch: &Watch) -> Result<Self> {
        let origin = file.scene.origin;
        let support = tree.support();
        if let Some(like) = &options.like {
            return Self::like(file, tree, &open_dem(like, &RasterOptions::default(), None, watch)?);
        }
        let Some(cell_m) = options.resolution_m.or(file.finest.map(|cell| cell.side_m)) else {
            let message =
                "how large are the cells to be? The scene has no raster to take it from: give --resolution (10m)";
            return Err(Error::usage(message).at_path(&file.path));
        };
        if !(cell_m > 0.0 && cell_m.is_finite()) {
            return Err(Error::usage(format!("--resolution {cell_m} m: expected a positive length")));
        }
        let [x0, y0, x1, y1] = match options.bbox {
            Some([x0, y0, x1, y1]) => {
                if x0 >= x1 || y0 >= y1 || ![x0, y0, x1, y1].iter().all(|v| v.is_finite()) {
                    return Err(Error::usage(format!(
                        "--bbox {x0},{y0},{x1},{y1}: expected xmin,ymin,xmax,ymax in the scene's CRS"
                    )));
                }
                let sides = |from: f64, to: f64| ((to - from) / cell_m).round().max(1.0) * cell_m;
                [x0, y1 - sides(y0, y1), x0 + sides(x0, x1), y1]
            }
            None => {
                if support.is_empty() {
                    return Err(nothing(file));
                }
                let ends = [support.x.min, support.y.min, support.x.max, support.y.max];
                if !ends.iter().all(|v| v.is_finite()) {
                    let message = "the scene is endless: say with --bbox what part of it is wanted";
                    return Err(Error::usage(message).at_path(&file.path));
                }
                // On the raster's own cells where these are wanted: what is not edited stays as it was.
                let own = file.finest.filter(|_| options.resolution_m.is_none());
                let corner = own.map_or([0.0; 2], |cell| cell.corner);
                // A cell more by rounding would be one without terrain.
                let slack = |v: f64| v.abs() * 4e-12 / cell_m + 1e-9;
                let low = |v: f64, k: usize| {
                    let v = v + origin[k];
                    ((v - corner[k]) / cell_m + slack(v)).floor() * cell_m + corner[k]
                };
                let high = |v: f64, k: usize| {
                    let v = v + origin[k];
                    ((v - corner[k]) / cell_m - slack(v)).ceil() * cell_m + corner[k]
                };
                [low(ends[0], 0), low(ends[1], 1), high(ends[2], 0), high(ends[3], 1)]
            }
        };
        let (cols, rows) = (((x1 - x0) / cell_m).round().max(1.0), ((y1 - y0) / cell_m).round().max(1.0));
        if cols > LONGEST || rows > LONGEST {
            return Err(Error::usage(format!("{cols} x {rows} cells of {cell_m} m are too many; take larger ones")));
        }
        let transform = north_up([x0, y1], cell_m);
        let cells = Self::at(transform, (rows as usize, cols as usize), origin);
        cells.meet(file, tree, options.bbox)
    }

    /// The cells of a raster.
    fn like(file: &SceneFile, tree: &Tree, raster: &RasterSource) -> Result<Self> {
        let places = places_of(raster);
        let wrong = |message: String| Error::usage(format!("--like: {message}")).at_path(&raster.path);
        if !places.transform.is_axis_parallel() || !raster.is_georeferenced {
            return Err(wrong("expected a raster whose rows and columns run along the axes of its CRS".into()));
        }
        if let (Some(own), Some(scene)) = (&raster.crs, &file.crs)
            && !same_in_effect(&places, own, scene)?
        {
            let message = format!("its CRS is {}, and the scene's is {}", own.label(), scene.label());
            return Err(wrong(message));
        }
        Self::at(places.transform, (places.rows, places.cols), file.scene.origin).meet(file, tree, None)
    }

    fn at(transform: GeoTransform, (rows, cols): (usize, usize), origin: [f64; 2]) -> Self {
        let (x, y) = transform.centre(0.0, 0.0);
        let lattice =
            Lattice { x0: x - origin[0], y0: y - origin[1], dx: transform.0[1], dy: transform.0[5], cols, rows };
        Self { lattice, transform }
    }

    /// The cells, if the terrain may be defined in them.
    fn meet(self, file: &SceneFile, tree: &Tree, bbox: Option<[f64; 4]>) -> Result<Self> {
        let Lattice { rows, cols, .. } = self.lattice;
        let area = Area::of(&[self.lattice.at(0, 0), self.lattice.at(rows - 1, cols - 1)]);
        let support = tree.support();
        if support.meets(&area) {
            return Ok(self);
        }
        if support.is_empty() || bbox.is_none() {
            return Err(nothing(file));
        }
        let [x, y] = file.scene.origin;
        Err(Error::usage(format!(
            "--bbox: nothing of the scene lies in it; the scene's is {},{},{},{}",
            support.x.min + x,
            support.y.min + y,
            support.x.max + x,
            support.y.max + y
        ))
        .at_path(&file.path))
    }
}

/// The error of a scene that has no terrain where it is asked for.
pub(super) fn nothing(file: &SceneFile) -> Error {
    let message = "no terrain is defined here: no node has a weight of at least 1/2; scene check says more";
    Error::new(crate::error::ErrorKind::Input, message).at_path(&file.path)
}
