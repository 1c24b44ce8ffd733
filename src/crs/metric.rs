//! What it takes to measure between the cells of a raster and to find the nearest one.

/// Row and column of a cell centre; the raster's grid goes on outside of the raster.
pub type Place = (i64, i64);

/// A rectangle of cells: rows and columns from the first to the last, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    /// First and last row.
    pub rows: (i64, i64),
    /// First and last column.
    pub cols: (i64, i64),
}

/// A distance with its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector {
    /// Distance in metres.
    pub distance_m: f64,
    /// Azimuth at the first place in degrees, 0 to 360, clockwise from north; NaN where there is none (distance 0).
    pub azimuth: f64,
}

/// Distances between cell centres, with the bounds that a search for the nearest cell needs.
///
/// The bounds hold up to a relative slack that leaves room for rounding.
pub trait Metric: Sync {
    /// The distance in metres that results report.
    fn distance_m(&self, p: Place, q: Place) -> f64;

    /// Distance and azimuth at `p`.
    fn vector(&self, p: Place, q: Place) -> Vector;

    /// A cheap lower bound of the squared distance: at most the squared distance with that slack, and nearly equal when it is small.
    fn near2(&self, p: Place, q: Place) -> f64;

    /// A lower bound of [`Metric::near2`] between `p` and every cell of a block.
    fn block2(&self, p: Place, block: &Block) -> f64;

    /// An upper bound of the squared distance of a cell whose [`Metric::near2`] is known; infinite where none is.
    fn reach2(&self, near2: f64) -> f64;

    /// The nearest place outside of a raster of `rows` times `cols` cells that is nearer than `limit_m`,
    /// as its distance; the grid goes on outwards.
    fn outside_m(&self, p: Place, rows: i64, cols: i64, limit_m: f64) -> Option<f64>;

    /// Whether distances depend on the difference of the columns only, not on the columns.
    fn is_alike_along_rows(&self) -> bool {
        true
    }

    /// Whether there is no place at all outside of a raster of `rows` rows whose columns wrap.
    fn is_whole_globe(&self, _rows: i64) -> bool {
        false
    }
}

/// Relative slack that covers rounding in the bounds.
pub(super) const SLACK: f64 = 1.0 + 1e-8;
