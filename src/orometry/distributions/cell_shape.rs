//! How large the cells of a grid are on the ground.

use crate::crs::{CrsKind, Ellipsoid};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::GeoTransform;

/// Size and area of the cells of each row.
#[derive(Clone, Debug)]
pub struct CellShape {
    rows: Rows,
}

#[derive(Clone, Debug)]
enum Rows {
    /// All cells are the same parallelogram.
    Alike(Cell),
    /// One shape a row: longitudes shrink towards the poles.
    Each(Vec<Cell>),
}

/// A cell on the ground.
#[derive(Clone, Copy, Debug)]
struct Cell {
    /// Metres eastwards and northwards of one column to the right.
    col_m: (f64, f64),
    /// Metres eastwards and northwards of one row down.
    row_m: (f64, f64),
    area_m2: f64,
}

impl CellShape {
    /// The cells of a grid of `rows` rows; without a CRS the coordinates are taken for metres.
    ///
    /// In a geographic CRS a column is as wide as its parallel has it at the row's latitude, a row as high as the
    /// meridian's arc between the middles of its neighbours is halved, and the area is that on the ellipsoid between
    /// the cell's own parallels (a row that reaches beyond a pole ends there). In every other CRS the geometry is
    /// plane.
    ///
    /// # Errors
    /// When a grid of longitudes and latitudes is rotated.
    pub fn new(kind: Option<&CrsKind>, transform: &GeoTransform, rows: usize) -> Result<Self> {
        let t = &transform.0;
        let rows = match kind {
            Some(CrsKind::Geographic { ellipsoid, degrees }) => {
                if !transform.is_axis_parallel() {
                    return Err(Error::new(
                        ErrorKind::Unsupported,
                        "the grid of longitudes and latitudes is rotated; resample it to a north-up one first, for example with gdalwarp",
                    ));
                }
                Rows::Each((0..rows).map(|row| geographic(ellipsoid, transform, *degrees, row as f64)).collect())
            }
            Some(CrsKind::Projected { metres, .. } | CrsKind::Local { metres }) => Rows::Alike(planar(t, *metres)),
            None => Rows::Alike(planar(t, 1.0)),
        };
        Ok(Self { rows })
    }

    fn cell(&self, row: usize) -> &Cell {
        match &self.rows {
            Rows::Alike(cell) => cell,
            Rows::Each(cells) => &cells[row],
        }
    }

    /// Area of a cell of a row in square metres.
    pub fn area_m2(&self, row: usize) -> f64 {
        self.cell(row).area_m2
    }

    /// The factors that turn height differences into slopes in a row; `None` where a cell has no width.
    pub(super) fn slant(&self, row: usize) -> Option<Slant> {
        let Cell { col_m: (ux, uy), row_m: (vx, vy), .. } = *self.cell(row);
        let det = ux * vy - uy * vx;
        // A parallel near a pole may be a few nanometres long; no gradient can be trusted there.
        let sound = det.is_finite() && det.abs() > 1e-9 * (ux * ux + uy * uy + vx * vx + vy * vy);
        sound.then(|| Slant { east: (vy / det, -uy / det), north: (-vx / det, ux / det) })
    }
}

/// The gradient `(east, north)` in metres a metre of heights that change by `(a, b)` from column to column and row
/// to row is `(east.0 a + east.1 b, north.0 a + north.1 b)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slant {
    east: (f64, f64),
    north: (f64, f64),
}

impl Slant {
    /// The squared tangent of the slope of heights that change by `per_col` and `per_row` metres a cell.
    #[inline]
    pub(super) fn tangent2(&self, per_col: f64, per_row: f64) -> f64 {
        let east = self.east.0 * per_col + self.east.1 * per_row;
        let north = self.north.0 * per_col + self.north.1 * per_row;
        east * east + north * north
    }
}

fn planar(t: &[f64; 6], metres: f64) -> Cell {
    let (col_m, row_m) = ((t[1] * metres, t[4] * metres), (t[2] * metres, t[5] * metres));
    Cell { col_m, row_m, area_m2: (col_m.0 * row_m.1 - col_m.1 * row_m.0).abs() }
}

fn geographic(ellipsoid: &Ellipsoid, transform: &GeoTransform, degrees: f64, row: f64) -> Cell {
    let lat = |row: f64| (transform.centre(row, 0.0).1 * degrees).clamp(-90.0, 90.0);
    let step = transform.0[1] * degrees;
    let (above, here, below) = (lat(row - 1.0), lat(row), lat(row + 1.0));
    let height_m = ellipsoid.geodesics().distance_m(above, below, 0.0) / 2.0;
    let (top, bottom) = (lat(row - 0.5), lat(row + 0.5));
    let degree_m2 = (ellipsoid.area_per_degree_to(top) - ellipsoid.area_per_degree_to(bottom)).abs();
    Cell {
        col_m: (ellipsoid.meridian(here).0 * step.to_radians(), 0.0),
        row_m: (0.0, height_m.copysign(below - above)),
        area_m2: degree_m2 * step.abs(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_minute_of_arc_is_a_nautical_mile() {
        let minute = 1.0 / 60.0;
        let t = GeoTransform([7.0, minute, 0.0, 46.0, 0.0, -minute]);
        let kind = CrsKind::Geographic { ellipsoid: Ellipsoid::WGS84, degrees: 1.0 };
        let shape = CellShape::new(Some(&kind), &t, 3).unwrap();
        let cell = shape.cell(1);
        assert!((cell.row_m.1 + 1852.2).abs() < 0.5, "{cell:?}");
        assert!((cell.col_m.0 - 1855.3 * 46.0_f64.to_radians().cos()).abs() < 3.0, "{cell:?}");
        assert!((cell.area_m2 / (cell.col_m.0 * cell.row_m.1).abs() - 1.0).abs() < 1e-6, "{cell:?}");
        let turned = GeoTransform([7.0, minute, 0.001, 46.0, 0.0, -minute]);
        assert!(CellShape::new(Some(&kind), &turned, 3).is_err());
    }

    #[test]
    fn feet_and_shears() {
        let t = GeoTransform([0.0, 3.0, 1.0, 0.0, 0.5, -2.0]);
        let shape = CellShape::new(Some(&CrsKind::Local { metres: 0.3048 }), &t, 9).unwrap();
        assert!((shape.area_m2(8) - 6.5 * 0.3048 * 0.3048).abs() < 1e-12);
        let slant = shape.slant(0).unwrap();
        // Heights that rise by one metre a metre eastwards and two northwards.
        let (per_col, per_row) = (0.3048 * (3.0 + 2.0 * 0.5), 0.3048 * (1.0 - 2.0 * 2.0));
        assert!((slant.tangent2(per_col, per_row) - 5.0).abs() < 1e-12);
    }

    #[test]
    fn no_slope_where_a_parallel_is_a_point() {
        let t = GeoTransform([0.0, 1.0, 0.0, 90.5, 0.0, -1.0]);
        let kind = CrsKind::Geographic { ellipsoid: Ellipsoid::WGS84, degrees: 1.0 };
        let shape = CellShape::new(Some(&kind), &t, 181).unwrap();
        assert!(shape.slant(0).is_none() && shape.slant(180).is_none() && shape.slant(1).is_some());
        let whole: f64 = (0..181).map(|row| 360.0 * shape.area_m2(row)).sum();
        assert!((whole / 510_065_621_724_088.0 - 1.0).abs() < 1e-12, "{whole}");
    }
}
