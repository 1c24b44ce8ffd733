//! Where the random grids lie.

use orograph::crs::{Ellipsoid, Geodesic, Metric, Planar};
use orograph::grid::GeoTransform;
use proptest::prelude::*;

/// A place for a grid of any size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ground {
    /// A plane with these six numbers of the geotransform; no tie of distances is exact unless they are whole.
    Plane([f64; 6]),
    /// Longitudes and latitudes: west edge, north edge, degrees of a column, degrees of a row.
    Degrees(f64, f64, f64, f64),
    /// As many rows as fit below the north pole, the first exactly at 90 degrees; degrees of a column and a row.
    AtNorthPole(f64, f64),
    /// The last row exactly at the south pole.
    AtSouthPole(f64, f64),
    /// The first row one step short of the north pole, so that the row outside is the pole; columns and rows.
    ShortOfNorthPole(f64, f64),
    /// All longitudes, some latitudes: the north edge and the degrees of a row.
    Band(f64, f64),
    /// All longitudes and latitudes; `true` where the first and last rows are the poles themselves.
    Globe(bool),
}

/// Rows and columns around a grid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Margins {
    /// Rows above, columns to the left.
    pub before: (i64, i64),
    /// Rows below, columns to the right.
    pub after: (i64, i64),
}

impl Margins {
    /// At most `rows` rows and `cols` columns on each side.
    pub fn at_most(self, rows: i64, cols: i64) -> Self {
        let least = |side: (i64, i64)| (side.0.min(rows), side.1.min(cols));
        Self { before: least(self.before), after: least(self.after) }
    }

    /// Rows and columns of a grid with its margins.
    pub fn size(self, rows: usize, cols: usize) -> (usize, usize) {
        (rows + (self.before.0 + self.after.0) as usize, cols + (self.before.1 + self.after.1) as usize)
    }
}

impl Ground {
    /// Whether the columns of a grid here span 360 degrees.
    pub fn wraps(&self) -> bool {
        matches!(self, Self::Band(..) | Self::Globe(_))
    }

    /// Whether distances that are equal on paper are equal to the bit.
    pub fn is_exact(&self) -> bool {
        matches!(self, Self::Plane(t) if t.iter().all(|v| v.fract() == 0.0))
    }

    fn transform(&self, rows: usize, cols: usize) -> GeoTransform {
        let n = rows as f64;
        // Under three columns nothing wraps: then they span a small part of the circle.
        let around = if cols >= 3 { 360.0 / cols as f64 } else { 1.0 };
        GeoTransform(match *self {
            Self::Plane(t) => t,
            Self::Degrees(west, north, dx, dy) => [west, dx, 0.0, north, 0.0, -dy],
            Self::AtNorthPole(dx, dy) => [10.0, dx, 0.0, 90.0 + dy / 2.0, 0.0, -dy],
            Self::AtSouthPole(dx, dy) => [10.0, dx, 0.0, -90.0 + dy * (n - 0.5), 0.0, -dy],
            Self::ShortOfNorthPole(dx, dy) => [10.0, dx, 0.0, 90.0 - dy / 2.0, 0.0, -dy],
            Self::Band(north, dy) => [-180.0, around, 0.0, north, 0.0, -dy],
            Self::Globe(true) if rows > 1 => {
                let dy = 180.0 / (n - 1.0);
                [0.0, around, 0.0, 90.0 + dy / 2.0, 0.0, -dy]
            }
            Self::Globe(_) => [-180.0, around, 0.0, 90.0, 0.0, -180.0 / n],
        })
    }

    /// The metric of a grid that has more rows and columns than one of `rows` times `cols` cells here.
    pub fn metric(&self, rows: usize, cols: usize, more: Margins) -> Box<dyn Metric> {
        let transform = self.transform(rows, cols).window(-more.before.0 as f64, -more.before.1 as f64);
        let (all_rows, all_cols) = more.size(rows, cols);
        match self {
            Self::Plane(_) => Box::new(Planar::new(&transform, 1.0)),
            _ => {
                let wraps = self.wraps() && cols >= 3;
                let made = Geodesic::new(&Ellipsoid::WGS84, &transform, 1.0, all_rows, all_cols, wraps);
                Box::new(made.unwrap_or_else(|e| panic!("{self:?} cannot hold {all_rows} x {all_cols} cells: {e}")))
            }
        }
    }

    /// Rows and columns that there are before and after the grid, up to as many as can matter.
    pub fn margins(&self, rows: usize, cols: usize) -> Margins {
        if matches!(self, Self::Plane(_)) {
            return Margins { before: (30, 30), after: (30, 30) };
        }
        let transform = self.transform(rows, cols);
        let exists = |row: i64| transform.centre(row as f64, 0.0).1.abs() <= 90.0 + 1e-9;
        let before = (1_i64..=30).take_while(|&k| exists(-k)).count() as i64;
        let after = (0_i64..30).take_while(|&k| exists(rows as i64 + k)).count() as i64;
        // More columns could only be further away, or come round to the grid from behind.
        let aside = i64::from(!self.wraps() || cols < 3);
        Margins { before: (before, aside), after: (after, aside) }
    }
}

/// Grounds of every kind, for grids up to 72 rows and columns.
pub fn ground() -> impl Strategy<Value = Ground> {
    prop_oneof![
        4 => Just(Ground::Plane([0.0, 30.0, 0.0, 0.0, 0.0, -30.0])),
        1 => Just(Ground::Plane([500.0, 30.0, 0.0, 0.0, 0.0, 30.0])),
        2 => Just(Ground::Plane([0.0, 30.0, 0.0, 0.0, 0.0, -47.5])),
        1 => Just(Ground::Plane([0.0, 100.0, 0.0, 0.0, 0.0, -7.3])),
        2 => Just(Ground::Plane([0.0, 30.0, 11.0, 0.0, 5.0, -20.0])),
        1 => Just(Ground::Plane([0.0, 1.0, 3.7, 0.0, 0.05, -0.9])),
        2 => Just(Ground::Degrees(8.0, 47.0, 1.0 / 1200.0, 1.0 / 1200.0)),
        2 => Just(Ground::Degrees(179.97, 10.0, 1.0 / 600.0, 1.0 / 1200.0)),
        1 => Just(Ground::Degrees(359.99, -44.0, 1.0 / 120.0, 1.0 / 120.0)),
        1 => Just(Ground::Degrees(-170.0, 60.0, 4.9, 1.5)),
        1 => Just(Ground::Degrees(0.0, 89.99, 4.3, 0.02)),
        1 => Just(Ground::AtNorthPole(4.0, 0.5)),
        1 => Just(Ground::AtSouthPole(0.1, 0.001)),
        1 => Just(Ground::ShortOfNorthPole(1.0, 0.25)),
        2 => Just(Ground::Band(30.0, 0.7)),
        1 => Just(Ground::Band(89.9, 0.05)),
        2 => any::<bool>().prop_map(Ground::Globe),
    ]
}
