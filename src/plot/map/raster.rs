//! The relief that is drawn, and its way to the size of the picture.

use crate::crs::{Crs, CrsKind, Ellipsoid};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::GeoTransform;
use rayon::prelude::*;

/// Elevations in metres with their place and the size of their cells.
#[derive(Clone, Debug)]
pub struct Relief {
    /// Number of rows; row 0 is drawn at the top.
    pub rows: usize,
    /// Number of columns; column 0 is drawn at the left.
    pub cols: usize,
    /// Elevations in metres, row-major; NaN where nothing is known.
    pub elevation_m: Vec<f32>,
    /// From rows and columns to the coordinates of the layers drawn on top.
    pub transform: GeoTransform,
    /// Width of a cell in metres, for each row.
    pub cell_x_m: Vec<f64>,
    /// Height of a cell in metres.
    pub cell_y_m: f64,
    /// Degrees in a unit of the coordinates, where these are longitudes and latitudes.
    pub degrees: Option<f64>,
    /// After how many units of x the coordinates come back to the same place (360 for degrees), if they do.
    pub period_x: Option<f64>,
}

impl Relief {
    /// A relief whose cells are measured as its CRS demands; without a CRS a unit is a metre.
    ///
    /// # Errors
    /// When there is not one elevation a cell, a side is 0, or the geotransform cannot be inverted.
    pub fn new(
        rows: usize,
        cols: usize,
        elevation_m: Vec<f32>,
        transform: GeoTransform,
        crs: Option<&Crs>,
    ) -> Result<Self> {
        let t = &transform.0;
        let mut in_degrees = None;
        let (cell_x_m, cell_y_m, period_x) = match crs.map(|crs| (&crs.kind, crs)) {
            Some((CrsKind::Geographic { ellipsoid, degrees }, _)) => {
                in_degrees = Some(*degrees);
                let (x, y) = geographic_cells_m(ellipsoid, &transform, *degrees, rows);
                (x, y, Some(360.0 / degrees))
            }
            Some((CrsKind::Projected { metres, .. } | CrsKind::Local { metres }, crs)) => {
                (vec![t[1].hypot(t[4]) * metres; rows], t[2].hypot(t[5]) * metres, mercator_period(crs))
            }
            None => (vec![t[1].hypot(t[4]); rows], t[2].hypot(t[5]), None),
        };
        let relief = Self { rows, cols, elevation_m, transform, cell_x_m, cell_y_m, degrees: in_degrees, period_x };
        relief.check()?;
        Ok(relief)
    }

    /// Whether the fields fit together; drawing starts with this.
    ///
    /// # Errors
    /// See [`Relief::new`].
    pub fn check(&self) -> Result<()> {
        let wrong = |message: String| Err(Error::new(ErrorKind::Input, message));
        if self.rows == 0 || self.cols == 0 {
            return wrong(format!("a relief of {} times {} cells cannot be drawn", self.rows, self.cols));
        }
        if self.rows.checked_mul(self.cols) != Some(self.elevation_m.len()) || self.cell_x_m.len() != self.rows {
            return wrong(format!(
                "{} times {} cells need as many elevations and {} widths, but there are {} and {}",
                self.rows,
                self.cols,
                self.rows,
                self.elevation_m.len(),
                self.cell_x_m.len()
            ));
        }
        let is_sized = self.cell_y_m > 0.0 && self.cell_y_m.is_finite();
        if !self.transform.is_invertible() || !is_sized {
            return wrong("the geotransform has no inverse; check the georeference of the raster".into());
        }
        Ok(())
    }

    /// Width in metres of the cells of the middle row, as the picture shows it.
    ///
    /// Cells near a pole are drawn wider than they are: a degree of longitude must not vanish.
    pub(super) fn drawn_cell_x_m(&self) -> f64 {
        let widest = self.cell_x_m.iter().copied().fold(0.0, f64::max);
        let middle = self.cell_x_m[self.rows / 2].max(LEAST_OF_WIDEST * widest);
        if middle > 0.0 { middle } else { self.cell_y_m }
    }

    /// The relief averaged over the cells of a grid with at most as many rows and columns.
    ///
    /// Elevations at or below `sea_level_m` count as sea.
    pub(super) fn averaged(&self, rows: usize, cols: usize, sea_level_m: Option<f64>) -> Averaged {
        let (rows, cols) = (rows.clamp(1, self.rows), cols.clamp(1, self.cols));
        let across = shares(self.cols, cols);
        let down = shares(self.rows, rows);
        let sea_m = sea_level_m.map_or(f32::NEG_INFINITY, |m| m as f32);
        let mut cells = vec![Cover::default(); rows * cols];
        cells.par_chunks_mut(cols).zip(&down).for_each(|(line, rows)| {
            for (row, row_share) in rows.cells() {
                let source = &self.elevation_m[row * self.cols..(row + 1) * self.cols];
                for (cell, cols) in line.iter_mut().zip(&across) {
                    for (col, col_share) in cols.cells() {
                        cell.add(source[col], row_share * col_share, sea_m);
                    }
                }
            }
        });
        // Whole rows of the source share a width, so the middle one stands for the average.
        let widest = self.cell_x_m.iter().copied().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        let cell_x_m = (0..rows)
            .map(|row| {
                let middle = ((row as f64 + 0.5) * self.rows as f64 / rows as f64) as usize;
                let width = self.cell_x_m[middle.min(self.rows - 1)].max(LEAST_OF_WIDEST * widest);
                width * self.cols as f64 / cols as f64
            })
            .collect();
        Averaged {
            rows,
            cols,
            elevation_m: cells.iter().map(|c| if c.valid > 0.0 { c.sum_m / c.valid } else { f32::NAN }).collect(),
            valid: cells.iter().map(|c| c.valid).collect(),
            sea: cells.iter().map(|c| if c.valid > 0.0 { c.sea / c.valid } else { 0.0 }).collect(),
            cell_x_m,
            cell_y_m: self.cell_y_m * self.rows as f64 / rows as f64,
        }
    }
}

/// Least width of a cell as drawn, over the widest one's.
const LEAST_OF_WIDEST: f64 = 0.2;

fn geographic_cells_m(ellipsoid: &Ellipsoid, t: &GeoTransform, degrees: f64, rows: usize) -> (Vec<f64>, f64) {
    let lat = |row: f64| (t.centre(row, 0.0).1 * degrees).clamp(-90.0, 90.0);
    let step = (t.0[1] * degrees).abs().to_radians();
    let widths = (0..rows).map(|row| ellipsoid.meridian(lat(row as f64)).0 * step).collect();
    // The meridian's arc over the whole raster, by chords of a row each.
    let arc: f64 = (0..rows)
        .map(|row| {
            let (a, b) = (ellipsoid.meridian(lat(row as f64 - 0.5)), ellipsoid.meridian(lat(row as f64 + 0.5)));
            (a.0 - b.0).hypot(a.1 - b.1)
        })
        .sum();
    (widths, arc / rows as f64)
}

fn mercator_period(crs: &Crs) -> Option<f64> {
    let is_mercator = matches!(crs.projection.as_deref(), Some("Mercator_1SP" | "Mercator_Auxiliary_Sphere"));
    match &crs.kind {
        CrsKind::Projected { ellipsoid, metres } if is_mercator => Some(std::f64::consts::TAU * ellipsoid.a_m / metres),
        _ => None,
    }
}

/// What a cell of the coarse grid covers.
#[derive(Clone, Copy, Debug, Default)]
struct Cover {
    sum_m: f32,
    valid: f32,
    sea: f32,
}

impl Cover {
    #[inline]
    fn add(&mut self, elevation_m: f32, share: f32, sea_m: f32) {
        if elevation_m.is_finite() {
            self.sum_m += elevation_m * share;
            self.valid += share;
            if elevation_m <= sea_m {
                self.sea += share;
            }
        }
    }
}

/// The cells of a finer axis that one cell of a coarser axis covers, with the share of each in it.
struct Shares {
    first: usize,
    weights: Vec<f32>,
}

impl Shares {
    #[inline]
    fn cells(&self) -> impl Iterator<Item = (usize, f32)> + '_ {
        self.weights.iter().enumerate().map(|(i, &w)| (self.first + i, w))
    }
}

fn shares(fine: usize, coarse: usize) -> Vec<Shares> {
    let factor = fine as f64 / coarse as f64;
    (0..coarse)
        .map(|i| {
            let (from, to) = (i as f64 * factor, ((i + 1) as f64 * factor).min(fine as f64));
            let first = (from as usize).min(fine - 1);
            let last = (to.ceil() as usize).clamp(first + 1, fine);
            let weights = (first..last)
                .map(|j| (((j + 1) as f64).min(to) - (j as f64).max(from)).max(0.0) / factor)
                .map(|w| w as f32)
                .collect();
            Shares { first, weights }
        })
        .collect()
}

/// A relief at the resolution of the picture, or at its own where that is coarser.
#[derive(Clone, Debug)]
pub(super) struct Averaged {
    pub(super) rows: usize,
    pub(super) cols: usize,
    /// Mean elevation of what is known; NaN where nothing is.
    pub(super) elevation_m: Vec<f32>,
    /// Share of each cell that is known, 0 to 1.
    pub(super) valid: Vec<f32>,
    /// Share of what is known that is sea, 0 to 1.
    pub(super) sea: Vec<f32>,
    /// Width of a cell in metres, for each row.
    pub(super) cell_x_m: Vec<f64>,
    pub(super) cell_y_m: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn relief(rows: usize, cols: usize, elevation_m: Vec<f32>) -> Relief {
        Relief::new(rows, cols, elevation_m, GeoTransform([0.0, 10.0, 0.0, 0.0, 0.0, -20.0]), None).unwrap()
    }

    #[test]
    fn averages_by_area_even_when_the_factor_is_not_whole() {
        let fine = relief(1, 3, vec![0.0, 30.0, 90.0]);
        let coarse = fine.averaged(1, 2, None);
        assert!((coarse.elevation_m[0] - 10.0).abs() < 1e-4, "{coarse:?}");
        assert!((coarse.elevation_m[1] - 70.0).abs() < 1e-4, "{coarse:?}");
        assert_eq!((coarse.cell_x_m[0], coarse.cell_y_m), (15.0, 20.0));
    }

    #[test]
    fn voids_take_no_part_in_averages() {
        let fine = relief(2, 2, vec![f32::NAN, 10.0, -4.0, f32::NAN]);
        let coarse = fine.averaged(1, 1, Some(0.0));
        assert_eq!((coarse.elevation_m[0], coarse.valid[0], coarse.sea[0]), (3.0, 0.5, 0.5));
        let void = relief(2, 2, vec![f32::NAN; 4]).averaged(1, 1, None);
        assert!(void.elevation_m[0].is_nan() && void.valid[0] == 0.0);
    }

    #[test]
    fn cells_of_longitudes_and_latitudes() {
        let kind = CrsKind::Geographic { ellipsoid: Ellipsoid::WGS84, degrees: 1.0 };
        let crs = Crs {
            wkt: String::new(),
            name: "WGS 84".into(),
            authority: None,
            kind,
            projection: None,
            vertical_unit: None,
        };
        let t = GeoTransform([0.0, 1.0, 0.0, 60.5, 0.0, -1.0]);
        let relief = Relief::new(1, 1, vec![0.0], t, Some(&crs)).unwrap();
        // A degree at latitude 60: 55.800 km along the parallel, 111.412 km along the meridian.
        assert!((relief.cell_x_m[0] - 55_800.0).abs() < 1.0, "{}", relief.cell_x_m[0]);
        assert!((relief.cell_y_m - 111_412.0).abs() < 3.0, "{}", relief.cell_y_m);
        assert_eq!(relief.period_x, Some(360.0));
    }

    #[test]
    fn what_does_not_fit_together_is_refused() {
        let flat = GeoTransform([0.0, 0.0, 0.0, 0.0, 0.0, -1.0]);
        assert!(Relief::new(1, 1, vec![0.0], flat, None).is_err());
        assert!(Relief::new(2, 2, vec![0.0], GeoTransform::PIXELS, None).is_err());
        assert!(Relief::new(0, 0, vec![], GeoTransform::PIXELS, None).is_err());
    }
}
