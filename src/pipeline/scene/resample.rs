//! Rasters on other grids: reprojected to a scene's CRS, or at the cells of another raster.

use crate::crs::{Crs, CrsKind};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::GeoTransform;
use crate::io::transform::Reprojection;
use crate::watch::Watch;
use rayon::prelude::*;

/// Rows that one thread resamples at a time.
const ROWS: usize = 32;
/// Points along a side at which a raster's outline is looked at in another CRS.
const OUTLINE: usize = 32;
/// How many times as many cells as it had a reprojected raster may have.
const GROWTH: f64 = 16.0;
/// Share of a cell by which places may differ in two CRSs that are the same in effect.
const SAME: f64 = 1e-3;

/// Values on a grid, NaN for voids.
pub(super) struct Cells<'a> {
    pub(super) rows: usize,
    pub(super) cols: usize,
    pub(super) values: &'a [f64],
    pub(super) transform: GeoTransform,
}

/// Places of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CellPlaces {
    pub(super) rows: usize,
    pub(super) cols: usize,
    pub(super) transform: GeoTransform,
}

/// What lies between samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kernel {
    /// The splines of Catmull and Rom through sixteen samples, the outermost repeated; where one of them is void, as
    /// [`Kernel::Linear`].
    Cubic,
    /// Between four samples; a void where one of them is.
    Linear,
}

impl Cells<'_> {
    fn at(&self, row: usize, col: usize) -> f64 {
        self.values[row * self.cols + col]
    }

    /// The value at a fractional row and column; whole numbers are centres of cells. NaN for voids and beside the
    /// outermost centres.
    fn between(&self, kernel: Kernel, row: f64, col: f64) -> f64 {
        let (last_row, last_col) = ((self.rows - 1) as f64, (self.cols - 1) as f64);
        if !(row >= -1e-9 && row <= last_row + 1e-9 && col >= -1e-9 && col <= last_col + 1e-9) {
            return f64::NAN;
        }
        let (row, col) = (row.clamp(0.0, last_row), col.clamp(0.0, last_col));
        let (r, c) = ((row as usize).min(self.rows.saturating_sub(2)), (col as usize).min(self.cols.saturating_sub(2)));
        let (v, u) = (row - r as f64, col - c as f64);
        if kernel == Kernel::Cubic {
            let near = |at: usize, i: usize, count: usize| (at + i).max(1).min(count) - 1;
            let line = |i: usize| {
                let row = near(r, i, self.rows);
                cubic([0, 1, 2, 3].map(|j| self.at(row, near(c, j, self.cols))), u)
            };
            let value = cubic([0, 1, 2, 3].map(line), v);
            if !value.is_nan() {
                return value;
            }
        }
        let mut sum = 0.0;
        for (i, by_row) in [1.0 - v, v].into_iter().enumerate() {
            for (j, by_col) in [1.0 - u, u].into_iter().enumerate() {
                let weight = by_row * by_col;
                // A sample without a share in the value may be void.
                if weight > 0.0 {
                    sum += weight * self.at(r + i, c + j);
                }
            }
        }
        sum
    }
}

/// The spline between the middle two of four samples.
fn cubic([a, b, c, d]: [f64; 4], t: f64) -> f64 {
    let (m, n) = ((c - a) * 0.5, (d - b) * 0.5);
    let gap = c - b;
    b + t * (m + t * ((3.0 * gap - 2.0 * m - n) + t * (m + n - 2.0 * gap)))
}

/// Whether places have the same coordinates in two CRSs, as far as a raster's cells can tell: heights, names and epochs
/// of a CRS move nothing.
///
/// # Errors
/// When PROJ knows no way from one to the other.
pub(super) fn same_in_effect(places: &CellPlaces, from: &Crs, to: &Crs) -> Result<bool> {
    if from.wkt == to.wkt {
        return Ok(true);
    }
    let way = Reprojection::new(from, to)?;
    let [r, c] = [places.rows as f64, places.cols as f64];
    let points = [(0.0, 0.0), (0.0, c), (r, 0.0), (r, c), (r / 2.0, c / 2.0)];
    let (before_x, before_y): (Vec<f64>, Vec<f64>) =
        points.iter().map(|&(row, col)| places.transform.centre(row - 0.5, col - 0.5)).unzip();
    let (mut x, mut y) = (before_x.clone(), before_y.clone());
    way.project(&mut x, &mut y);
    let t = &places.transform.0;
    let cell = (t[1].abs() + t[2].abs()).min(t[4].abs() + t[5].abs());
    let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= SAME * cell;
    Ok(x.iter().zip(&before_x).all(is_near) && y.iter().zip(&before_y).all(is_near))
}

/// Square cells in another CRS that cover a raster's: as wide as the narrower side of one in its middle, with edges at
/// whole multiples of that.
///
/// # Errors
/// Where the raster, or nearly all of it, has no place in that CRS.
pub(super) fn cover(places: &CellPlaces, from: &Crs, to: &Crs) -> Result<CellPlaces> {
    let way = Reprojection::new(from, to)?;
    let nowhere = || {
        let message =
            format!("it has no place in the scene's CRS, {}; is that of another part of the world?", to.label());
        Error::new(ErrorKind::Input, message)
    };
    let [last_row, last_col] = [(places.rows - 1) as f64, (places.cols - 1) as f64];
    let share = |i: usize| i as f64 / OUTLINE as f64;
    let mut points = vec![];
    for i in 0..=OUTLINE {
        for j in 0..=OUTLINE {
            points.push(places.transform.centre(share(i) * last_row, share(j) * last_col));
        }
    }
    let (mut x, mut y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    way.project(&mut x, &mut y);
    let range = |values: &[f64]| {
        let finite = values.iter().filter(|v| v.is_finite());
        finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), &v| (min.min(v), max.max(v)))
    };
    let ((x0, x1), (y0, y1)) = (range(&x), range(&y));
    let middle = [last_row / 2.0, last_col / 2.0];
    let beside = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let (mut x, mut y): (Vec<f64>, Vec<f64>) =
        beside.iter().map(|d| places.transform.centre(middle[0] + d[0], middle[1] + d[1])).unzip();
    way.project(&mut x, &mut y);
    let side = |i: usize| ((x[i] - x[0]) * (x[i] - x[0]) + (y[i] - y[0]) * (y[i] - y[0])).sqrt();
    let cell = side(1).min(side(2));
    if !(x0 <= x1 && y0 <= y1 && cell > 0.0 && cell.is_finite()) {
        return Err(nowhere());
    }
    let edges = |from: f64, to: f64| ((from / cell).floor(), (to / cell).ceil().max((from / cell).floor() + 2.0));
    let ((left, right), (bottom, top)) = (edges(x0, x1), edges(y0, y1));
    let (cols, rows) = (right - left, top - bottom);
    if cols * rows > GROWTH * (places.rows as f64 * places.cols as f64) + 1e6 {
        return Err(Error::new(
            ErrorKind::Unsupported,
            format!("in the scene's CRS, {}, it would have {cols} x {rows} cells; cut it with crop", to.label()),
        ));
    }
    Ok(CellPlaces {
        rows: rows as usize,
        cols: cols as usize,
        transform: GeoTransform([left * cell, cell, 0.0, top * cell, 0.0, -cell]),
    })
}

/// The values at other places; `way` leads from the CRS of those to that of the cells, where they are not the same.
///
/// # Errors
/// When PROJ knows no way, or the job is cancelled.
pub(super) fn resample(
    cells: &Cells<'_>,
    places: &CellPlaces,
    way: Option<(&Crs, &Crs)>,
    kernel: Kernel,
    watch: &Watch,
) -> Result<Vec<f64>> {
    // Longitudes may be counted from anywhere.
    let turn = match way.map(|(_, to)| &to.kind) {
        Some(CrsKind::Geographic { degrees, .. }) => Some(360.0 / degrees),
        _ => None,
    };
    let middle = cells.transform.centre(cells.rows as f64 / 2.0 - 0.5, cells.cols as f64 / 2.0 - 0.5).0;
    let mut out = vec![f64::NAN; places.rows * places.cols];
    watch.begin("resampling", places.rows as u64);
    let chunks = out.par_chunks_mut(ROWS * places.cols).enumerate();
    chunks.try_for_each(|(chunk, values)| -> Result<()> {
        // GDAL's transformers belong to the thread that made them.
        let way = way.map(|(from, to)| Reprojection::new(from, to)).transpose()?;
        for (row, line) in values.chunks_mut(places.cols).enumerate() {
            let centre = |col: usize| places.transform.centre((chunk * ROWS + row) as f64, col as f64);
            let (mut x, mut y): (Vec<f64>, Vec<f64>) = (0..places.cols).map(centre).unzip();
            if let Some(way) = &way {
                way.project(&mut x, &mut y);
            }
            for (value, (x, y)) in line.iter_mut().zip(x.into_iter().zip(y)) {
                let shift = turn.map_or(0.0, |turn| ((middle - x) / turn).round() * turn);
                let (row, col) = cells.transform.pixel(x + shift, y);
                *value = cells.between(kernel, row - 0.5, col - 0.5);
            }
            watch.advance(1)?;
        }
        Ok(())
    })?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::raster::parse_crs;

    fn plane(rows: usize, cols: usize, transform: GeoTransform, slope: [f64; 2]) -> Vec<f64> {
        let mut values = vec![];
        for row in 0..rows {
            for col in 0..cols {
                let (x, y) = transform.centre(row as f64, col as f64);
                values.push(slope[0] * x + slope[1] * y);
            }
        }
        values
    }

    #[test]
    fn planes_stay_planes_and_samples_stay_themselves() {
        let transform = GeoTransform([100.0, 10.0, 0.0, 200.0, 0.0, -10.0]);
        let values = plane(6, 9, transform, [0.5, -2.0]);
        let cells = Cells { rows: 6, cols: 9, values: &values, transform };
        for kernel in [Kernel::Cubic, Kernel::Linear] {
            let finer = CellPlaces { rows: 10, cols: 17, transform: GeoTransform([107.5, 5.0, 0.0, 192.5, 0.0, -5.0]) };
            let found = resample(&cells, &finer, None, kernel, &Watch::default()).unwrap();
            let expected = plane(10, 17, finer.transform, [0.5, -2.0]);
            // Beyond, splines lean on samples that repeat.
            let inner = |i: usize| (2..8).contains(&(i / 17)) && (2..14).contains(&(i % 17));
            for i in (0..found.len()).filter(|&i| inner(i)) {
                assert!((found[i] - expected[i]).abs() < 1e-9, "{kernel:?} {i}: {} {}", found[i], expected[i]);
            }
            let same = CellPlaces { rows: 6, cols: 9, transform };
            assert_eq!(resample(&cells, &same, None, kernel, &Watch::default()).unwrap(), values);
        }
    }

    #[test]
    fn voids_stay_voids_and_take_no_other_cell_away() {
        let transform = GeoTransform::PIXELS;
        let mut values = plane(5, 5, transform, [1.0, 1.0]);
        values[12] = f64::NAN;
        let cells = Cells { rows: 5, cols: 5, values: &values, transform };
        let same = CellPlaces { rows: 5, cols: 5, transform };
        let found = resample(&cells, &same, None, Kernel::Cubic, &Watch::default()).unwrap();
        assert!(found.iter().zip(&values).all(|(a, b)| a == b || (a.is_nan() && b.is_nan())), "{found:?}");
        let between = CellPlaces { rows: 4, cols: 4, transform: GeoTransform([0.5, 1.0, 0.0, -0.5, 0.0, -1.0]) };
        let found = resample(&cells, &between, None, Kernel::Cubic, &Watch::default()).unwrap();
        let voids: Vec<usize> = (0..16).filter(|&i| found[i].is_nan()).collect();
        assert_eq!(voids, [5, 6, 9, 10], "the four around the void");
    }

    #[test]
    fn degrees_become_metres_where_they_are() {
        let (degrees, metres) = (parse_crs("EPSG:4326").unwrap(), parse_crs("EPSG:32632").unwrap());
        // Latitudes as values.
        for first in [8.9, 368.9] {
            let transform = GeoTransform([first, 0.01, 0.0, 46.1, 0.0, -0.01]);
            let values = plane(20, 20, transform, [0.0, 1.0]);
            let places = CellPlaces { rows: 20, cols: 20, transform };
            assert!(!same_in_effect(&places, &degrees, &metres).unwrap());
            let covered = cover(&places, &degrees, &metres).unwrap();
            let cell = covered.transform.0[1];
            assert!((770.0..780.0).contains(&cell), "the narrower side of a cell: {cell} m");
            let cells = Cells { rows: 20, cols: 20, values: &values, transform };
            let way = Some((&metres, &degrees));
            let found = resample(&cells, &covered, way, Kernel::Cubic, &Watch::default()).unwrap();
            let (row, col) = covered.transform.pixel(500_000.0, 5_093_784.0);
            let value = found[row as usize * covered.cols + col as usize];
            // 46 degrees north, but for half a cell.
            assert!((value - 46.0).abs() < 0.01, "{value}");
        }
    }

    #[test]
    fn a_crs_by_another_name_is_the_same_in_effect() {
        let (a, b) = (parse_crs("EPSG:32632").unwrap(), parse_crs("EPSG:32632+5773").unwrap());
        let transform = GeoTransform([500_000.0, 30.0, 0.0, 5_200_000.0, 0.0, -30.0]);
        assert!(same_in_effect(&CellPlaces { rows: 9, cols: 9, transform }, &b, &a).unwrap());
    }
}
