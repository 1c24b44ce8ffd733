//! What all layers share: where cells lie, and the unit of their lengths.

use crate::crs::{Crs, CrsKind, ToGeographic};
use crate::grid::{Cell, GeoTransform};
use crate::io::raster::Dem;
use crate::io::transform::OwnGeographic;
use crate::io::vector::{Field, FieldKind};
use crate::units::FOOT_M;

/// Unit in which layers give lengths; part of the fields' names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LengthOutput {
    /// Metres.
    #[default]
    Metres,
    /// International feet.
    Feet,
}

impl LengthOutput {
    /// Suffix of the names of fields that hold lengths.
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Metres => "m",
            Self::Feet => "ft",
        }
    }

    /// A length in this unit.
    #[inline]
    pub fn of(self, length_m: f64) -> f64 {
        match self {
            Self::Metres => length_m,
            Self::Feet => length_m / FOOT_M,
        }
    }
}

/// Where the cells of a survey lie.
pub struct Frame<'a> {
    transform: GeoTransform,
    crs: Option<&'a Crs>,
    cols: u64,
    wraps: bool,
    to_geographic: Option<&'a OwnGeographic>,
    /// Unit of the lengths.
    pub unit: LengthOutput,
}

impl<'a> Frame<'a> {
    /// The frame of a DEM; `to_geographic` gives longitudes and latitudes of a projected one.
    pub fn new(dem: &'a Dem, to_geographic: Option<&'a OwnGeographic>, unit: LengthOutput) -> Self {
        let cols = dem.grid.cols() as u64;
        Self { transform: dem.transform, crs: dem.crs.as_ref(), cols, wraps: dem.grid.wraps(), to_geographic, unit }
    }

    /// The frame of a raster that is in no file, of so many columns, which do not wrap.
    pub fn of_raster(
        transform: GeoTransform,
        cols: usize,
        crs: Option<&'a Crs>,
        to_geographic: Option<&'a OwnGeographic>,
        unit: LengthOutput,
    ) -> Self {
        Self { transform, crs, cols: cols as u64, wraps: false, to_geographic, unit }
    }

    /// Row and column of a cell.
    #[inline]
    pub fn place(&self, cell: Cell) -> (u64, u64) {
        (cell / self.cols, cell % self.cols)
    }

    /// Coordinates of a cell's centre.
    #[inline]
    pub fn point(&self, cell: Cell) -> (f64, f64) {
        let (row, col) = self.place(cell);
        self.transform.centre(row as f64, col as f64)
    }

    /// Longitudes and latitudes of cells in degrees; NaN where there are none.
    pub fn lon_lat(&self, cells: impl Iterator<Item = Cell>) -> Vec<(f64, f64)> {
        let points = cells.map(|cell| self.point(cell));
        if let Some(to_geographic) = self.to_geographic {
            let (mut x, mut y): (Vec<f64>, Vec<f64>) = points.unzip();
            to_geographic.to_geographic(&mut x, &mut y);
            x.into_iter().zip(y).collect()
        } else {
            let geographic = |(x, y)| self.crs.and_then(|crs| crs.geographic_degrees(x, y));
            points.map(|point| geographic(point).unwrap_or((f64::NAN, f64::NAN))).collect()
        }
    }

    /// What the coordinates are; `None` without a CRS.
    pub fn crs_kind(&self) -> Option<&'a CrsKind> {
        self.crs.map(|crs| &crs.kind)
    }

    /// What turns projected coordinates into longitudes and latitudes, where there is something.
    pub fn to_geographic(&self) -> Option<&'a OwnGeographic> {
        self.to_geographic
    }

    /// Whether lines may cross the seam of a raster whose columns wrap.
    pub fn wraps(&self) -> bool {
        self.wraps
    }

    /// Columns of the raster.
    pub fn cols(&self) -> u64 {
        self.cols
    }

    /// Coordinates of a point on row and column, both fractional.
    pub fn centre(&self, row: f64, col: f64) -> (f64, f64) {
        self.transform.centre(row, col)
    }

    /// A field for lengths.
    pub(super) fn length(&self, name: &str) -> Field {
        let decimals = if name.ends_with("elevation") { None } else { Some(3) };
        Field { name: format!("{name}_{}", self.unit.suffix()), kind: FieldKind::Real, decimals }
    }
}

/// A field that is no length.
pub(super) fn field(name: &str, kind: FieldKind, decimals: Option<u8>) -> Field {
    Field { name: name.into(), kind, decimals }
}
