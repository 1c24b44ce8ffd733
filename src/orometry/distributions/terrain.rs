//! Statistics of the terrain itself: slopes and hypsometry.

use super::bins::{DEEPEST_M, HIGHEST_M, bin_of_elevation, elevation_edges, slope_edges};
use super::cell_set::CellSet;
use super::cell_shape::CellShape;
use super::histogram::AreaHistogram;
use crate::error::Result;
use crate::grid::{AnyGrid, Elevations, Grid, Key};
use crate::watch::Watch;
use crate::with_grid;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Slopes and hypsometry of a set of cells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Terrain {
    /// Cells with an elevation.
    pub cells: u64,
    /// Cells of the set without one.
    pub void_cells: u64,
    /// Lowest elevation in metres; `None` where all cells are void.
    pub lowest_m: Option<f64>,
    /// Highest elevation in metres.
    pub highest_m: Option<f64>,
    /// Area by elevation in metres (bins as for the elevations of peaks); its sum is the area of the domain.
    pub hypsometry: AreaHistogram,
    /// Area by slope in degrees (bins of one degree); cells without a slope are not in it.
    pub slope: AreaHistogram,
    /// Cells that have an elevation but no slope: on the border of the raster, or beside a void.
    pub slope_missing_cells: u64,
}

impl Terrain {
    /// Area of the cells with an elevation in square kilometres.
    pub fn area_km2(&self) -> f64 {
        self.hypsometry.total_km2()
    }
}

/// Rows that one task takes; part of the result's definition, as sums are made in this order.
const CHUNK_ROWS: usize = 64;

/// Measures the terrain of several sets of cells in one pass over the grid.
///
/// Slopes are Horn's (1981, doi:10.1109/PROC.1981.11918): differences over the 3 x 3 cells around with weights
/// 1, 2, 1, with the size that cells have in the middle row. All nine cells must have an elevation; those outside of
/// the set may be used. Areas are exact on the ellipsoid in a geographic CRS. Rows are streamed and summed in a fixed
/// order: the result does not depend on the number of threads.
///
/// # Errors
/// [`crate::error::ErrorKind::Interrupted`] when the watch was cancelled.
///
/// # Panics
/// When a set is of another size than the grid.
pub fn measure_terrain(
    grid: &AnyGrid,
    elevations: &Elevations,
    shape: &CellShape,
    sets: &[CellSet],
    watch: &Watch,
) -> Result<Vec<Terrain>> {
    for set in sets {
        assert_eq!((set.rows(), set.cols()), (grid.rows(), grid.cols()), "a set of cells of this grid");
    }
    with_grid!(grid, grid => measure(grid, elevations, shape, sets, watch))
}

fn measure<K: Key>(
    grid: &Grid<K>,
    elevations: &Elevations,
    shape: &CellShape,
    sets: &[CellSet],
    watch: &Watch,
) -> Result<Vec<Terrain>> {
    watch.begin("measuring terrain", grid.rows() as u64);
    // A few chunks for each thread at a time: the partial sums stay few however large the raster is.
    let batch = CHUNK_ROWS * 4 * rayon::current_num_threads();
    let mut sums = vec![Sums::default(); sets.len()];
    for first in (0..grid.rows()).step_by(batch) {
        let starts: Vec<usize> = (first..(first + batch).min(grid.rows())).step_by(CHUNK_ROWS).collect();
        let parts: Vec<Vec<Sums>> = starts
            .into_par_iter()
            .map(|start| {
                let end = (start + CHUNK_ROWS).min(grid.rows());
                watch.advance((end - start) as u64)?;
                Ok(chunk(grid, elevations, shape, sets, start, end))
            })
            .collect::<Result<_>>()?;
        for part in parts {
            sums.iter_mut().zip(part).for_each(|(sum, part)| sum.merge(&part));
        }
    }
    Ok(sums.iter().zip(sets).map(|(sum, set)| sum.finish(set)).collect())
}

/// Sums over the cells of one set, by bin; areas in square metres.
#[derive(Clone, Default)]
struct Sums {
    slope: Bins,
    hypsometry: Bins,
    lowest_m: Option<f64>,
    highest_m: Option<f64>,
    missing: u64,
}

/// Cells and areas by bin; empty until the first cell comes.
#[derive(Clone, Default)]
struct Bins {
    cells: Vec<u64>,
    area_m2: Vec<f64>,
}

impl Bins {
    /// Adds the counts of one row, whose cells have this area, and clears them.
    fn take_row(&mut self, row: &mut [u32], area_m2: f64) {
        self.cells.resize(row.len(), 0);
        self.area_m2.resize(row.len(), 0.0);
        for (bin, count) in row.iter_mut().enumerate().filter(|(_, count)| **count > 0) {
            self.cells[bin] += u64::from(*count);
            self.area_m2[bin] += f64::from(*count) * area_m2;
            *count = 0;
        }
    }

    fn merge(&mut self, other: &Self) {
        self.cells.resize(self.cells.len().max(other.cells.len()), 0);
        self.area_m2.resize(self.cells.len(), 0.0);
        self.cells.iter_mut().zip(&other.cells).for_each(|(a, b)| *a += b);
        self.area_m2.iter_mut().zip(&other.area_m2).for_each(|(a, b)| *a += b);
    }

    /// The histogram over `edges`, the first of which is edge number `skip` of the full row of bins.
    fn histogram(&self, edges: Vec<f64>, skip: usize) -> AreaHistogram {
        let mut histogram = AreaHistogram::new(edges);
        let last = histogram.cells.len() - 1;
        for (i, (cells, area_m2)) in self.cells.iter().zip(&self.area_m2).enumerate().skip(skip) {
            // What is exactly as high as the last edge still counts in the last bin.
            let bin = (i - skip).min(last);
            histogram.cells[bin] += cells;
            histogram.area_km2[bin] += area_m2 / 1e6;
        }
        histogram
    }
}

impl Sums {
    fn see(&mut self, elevation_m: f64) {
        self.lowest_m = Some(self.lowest_m.map_or(elevation_m, |v| v.min(elevation_m)));
        self.highest_m = Some(self.highest_m.map_or(elevation_m, |v| v.max(elevation_m)));
    }

    fn merge(&mut self, other: &Self) {
        self.slope.merge(&other.slope);
        self.hypsometry.merge(&other.hypsometry);
        self.missing += other.missing;
        [other.lowest_m, other.highest_m].into_iter().flatten().for_each(|v| self.see(v));
    }

    fn finish(&self, set: &CellSet) -> Terrain {
        let edges = elevation_edges(self.lowest_m.unwrap_or(0.0), self.highest_m.unwrap_or(0.0));
        let skip = bin_of_elevation(edges[0]);
        let hypsometry = self.hypsometry.histogram(edges, skip);
        let cells = hypsometry.total();
        Terrain {
            cells,
            void_cells: set.count() - cells,
            lowest_m: self.lowest_m,
            highest_m: self.highest_m,
            hypsometry,
            slope: self.slope.histogram(slope_edges(), 0),
            slope_missing_cells: self.missing,
        }
    }
}

/// Squared tangents of the edges of the slope bins but the last, which none reaches.
fn tangents2() -> [f64; 90] {
    std::array::from_fn(|degree| (degree as f64).to_radians().tan().powi(2))
}

fn chunk<K: Key>(
    grid: &Grid<K>,
    elevations: &Elevations,
    shape: &CellShape,
    sets: &[CellSet],
    start: usize,
    end: usize,
) -> Vec<Sums> {
    let mut sums = vec![Sums::default(); sets.len()];
    let tangents2 = tangents2();
    let mut slope_row = [0_u32; 90];
    let mut height_row = vec![0_u32; elevation_edges(DEEPEST_M, HIGHEST_M).len() - 1];
    // Elevations of the row above, of this one and of the row below, NaN where there is none; a column more at
    // either end.
    let mut rows: [Vec<f64>; 3] = std::array::from_fn(|_| vec![f64::NAN; grid.cols() + 2]);
    let fill = |row: Option<usize>, into: &mut [f64]| match row.filter(|&r| r < grid.rows()) {
        Some(row) => read_row(grid, elevations, row, into),
        None => into.fill(f64::NAN),
    };
    fill(start.checked_sub(1), &mut rows[0]);
    fill(Some(start), &mut rows[1]);
    for row in start..end {
        fill(Some(row + 1), &mut rows[2]);
        let [above, here, below] = &rows;
        let (slant, area_m2) = (shape.slant(row), shape.area_m2(row));
        for (set, sum) in sets.iter().zip(&mut sums) {
            for col in set.runs(row).iter().cloned().flatten() {
                let elevation_m = here[col + 1];
                if elevation_m.is_nan() {
                    continue;
                }
                sum.see(elevation_m);
                height_row[bin_of_elevation(elevation_m)] += 1;
                let slope2 = slant.map_or(f64::NAN, |slant| {
                    let (a, b, c) = (&above[col..col + 3], &here[col..col + 3], &below[col..col + 3]);
                    let per_col = ((a[2] - a[0]) + 2.0 * (b[2] - b[0]) + (c[2] - c[0])) / 8.0;
                    let per_row = ((c[0] - a[0]) + 2.0 * (c[1] - a[1]) + (c[2] - a[2])) / 8.0;
                    slant.tangent2(per_col, per_row)
                });
                if slope2.is_nan() {
                    sum.missing += 1;
                } else {
                    slope_row[tangents2.partition_point(|&edge| edge <= slope2) - 1] += 1;
                }
            }
            if !set.runs(row).is_empty() {
                sum.slope.take_row(&mut slope_row, area_m2);
                sum.hypsometry.take_row(&mut height_row, area_m2);
            }
        }
        rows.rotate_left(1);
    }
    sums
}

/// Writes the elevations of a row in metres, voids as NaN; the ends of a wrapping grid get their neighbours.
fn read_row<K: Key>(grid: &Grid<K>, elevations: &Elevations, row: usize, into: &mut [f64]) {
    let cols = grid.cols();
    for (to, &key) in into[1..=cols].iter_mut().zip(grid.row(row)) {
        let metres = if key == K::VOID { f64::NAN } else { elevations.elevation_m(key.to_i64()) };
        // An infinite cell has neither a bin nor a slope.
        *to = if metres.is_finite() { metres } else { f64::NAN };
    }
    let wraps = grid.wraps();
    into[0] = if wraps { into[cols] } else { f64::NAN };
    into[cols + 1] = if wraps { into[1] } else { f64::NAN };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::{CrsKind, Ellipsoid};
    use crate::error::ErrorKind;
    use crate::grid::{GeoTransform, SampleType};

    const GEOGRAPHIC: CrsKind = CrsKind::Geographic { ellipsoid: Ellipsoid::WGS84, degrees: 1.0 };

    /// A grid of floats; NaN is void.
    fn grid(rows: usize, cols: usize, wraps: bool, height: impl Fn(usize, usize) -> f64) -> (AnyGrid, Elevations) {
        let elevations = Elevations::metres(SampleType::F64);
        let key = |v: f64| if v.is_nan() { i64::VOID } else { elevations.key_of(v) };
        let cells = (0..rows * cols).map(|i| key(height(i / cols, i % cols))).collect();
        (AnyGrid::Wide(Grid::new(rows, cols, wraps, cells)), elevations)
    }

    fn whole(grid: &(AnyGrid, Elevations), kind: Option<&CrsKind>, t: &GeoTransform) -> Terrain {
        let (rows, cols) = (grid.0.rows(), grid.0.cols());
        let shape = CellShape::new(kind, t, rows).unwrap();
        let set = CellSet::whole(rows, cols);
        measure_terrain(&grid.0, &grid.1, &shape, &[set], &Watch::default()).unwrap().remove(0)
    }

    fn filled(h: &AreaHistogram) -> Vec<(f64, u64)> {
        h.edges.iter().copied().zip(h.cells.iter().copied()).filter(|(_, n)| *n > 0).collect()
    }

    #[test]
    fn slope_of_planes() {
        // Metres eastwards and southwards a cell, on cells of 10 x 20 m, and the slope they make.
        for (east, south, degrees) in [
            (0.0, 0.0, 0.0),
            (10.0, 0.0, 45.0),
            (0.0, 20.0, 45.0),
            (6.0, 16.0, 45.0),
            (30.0, 40.0, 74.0),
            (1e9, 0.0, 89.0),
        ] {
            let g = grid(70, 5, false, |r, c| 100.0 + east * c as f64 + south * r as f64);
            let terrain = whole(&g, None, &GeoTransform([0.0, 10.0, 0.0, 0.0, 0.0, -20.0]));
            assert_eq!(filled(&terrain.slope), [(degrees, 68 * 3)], "{east} {south}");
            assert_eq!(terrain.slope_missing_cells, 350 - 68 * 3);
            assert!((terrain.slope.total_km2() - 204.0 * 200.0 / 1e6).abs() < 1e-12);
            assert_eq!(terrain.cells, 350);
        }
    }

    #[test]
    fn slope_on_longitudes_and_latitudes() {
        // A metre a metre eastwards at 60 degrees north: a column is there about half as wide as at the equator.
        let step = 1.0 / 3600.0;
        let t = GeoTransform([7.0, step, 0.0, 60.0 + 1.5 * step, 0.0, -step]);
        let metres = 6_378_137.0 / (1.0 - 0.00669438 * 0.75_f64).sqrt() * 0.5 * step.to_radians();
        for (slant, degrees) in [(1.0001, 45.0), (0.9999, 44.0)] {
            let g = grid(3, 4, false, |_, c| slant * metres * c as f64);
            assert_eq!(filled(&whole(&g, Some(&GEOGRAPHIC), &t).slope), [(degrees, 2)]);
        }
        // And southwards along the meridian, whose second of arc is 30.9 m there.
        for (slant, degrees) in [(30.97, 45.0), (30.94, 44.0)] {
            let g = grid(3, 4, false, |r, _| slant * r as f64);
            assert_eq!(filled(&whole(&g, Some(&GEOGRAPHIC), &t).slope), [(degrees, 2)]);
        }
    }

    #[test]
    fn voids_have_no_slope_and_no_area() {
        let g = grid(7, 7, false, |r, c| if (r, c) == (3, 3) { f64::NAN } else { 50.0 });
        let terrain = whole(&g, None, &GeoTransform::PIXELS);
        assert_eq!((terrain.cells, terrain.void_cells), (48, 1));
        assert_eq!((filled(&terrain.slope), terrain.slope_missing_cells), (vec![(0.0, 16)], 32));
        assert!((terrain.area_km2() - 48e-6).abs() < 1e-18);
        let none = whole(&grid(3, 3, false, |_, _| f64::NAN), None, &GeoTransform::PIXELS);
        assert_eq!((none.cells, none.void_cells, none.lowest_m, none.area_km2()), (0, 9, None, 0.0));
        assert_eq!(none.hypsometry.edges.len(), 85);
    }

    #[test]
    fn hypsometry_by_hand() {
        let heights = [-10_376.0, -0.5, 0.0, 99.0, 100.0, 7999.0, 8000.0, 8752.0, 9000.0];
        let terrain = whole(&grid(3, 3, false, |r, c| heights[r * 3 + c]), None, &GeoTransform::PIXELS);
        assert_eq!(
            filled(&terrain.hypsometry),
            [(-10_400.0, 1), (-100.0, 1), (0.0, 2), (100.0, 1), (7900.0, 1), (8000.0, 1), (8600.0, 1), (8800.0, 1)],
            "9000 is the last edge and in the closed last bin"
        );
        assert_eq!((terrain.lowest_m, terrain.highest_m), (Some(-10_376.0), Some(9000.0)));
    }

    #[test]
    fn a_whole_globe_has_the_area_of_its_ellipsoid() {
        for (rows, top) in [(180, 90.0), (181, 90.5)] {
            let t = GeoTransform([-180.0, 1.0, 0.0, top, 0.0, -1.0]);
            let terrain = whole(&grid(rows, 360, true, |r, c| (r * c % 97) as f64), Some(&GEOGRAPHIC), &t);
            assert!((terrain.area_km2() / 510_065_621.724_088 - 1.0).abs() < 1e-12, "{}", terrain.area_km2());
            assert_eq!(terrain.slope_missing_cells, 720, "the rows at the poles; no seam");
        }
    }

    #[test]
    fn sets_add_up_and_threads_do_not_matter() {
        let t = GeoTransform([7.0, 0.01, 0.0, 47.0, 0.0, -0.01]);
        let g = grid(300, 40, false, |r, c| ((r * 7919 + c * 104_729) % 3001) as f64 - 200.0);
        let shape = CellShape::new(Some(&GEOGRAPHIC), &t, 300).unwrap();
        let west = CellSet::from_rows(300, 40, |row, inside| inside[..row % 40].fill(true));
        let east = CellSet::from_rows(300, 40, |row, inside| inside[row % 40..].fill(true));
        let sets = [CellSet::whole(300, 40), west, east];
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| measure_terrain(&g.0, &g.1, &shape, &sets, &Watch::default()).unwrap())
        };
        let (one, three) = (run(1), run(3));
        assert_eq!(one, three);
        assert_eq!(one[0].cells, one[1].cells + one[2].cells);
        for bin in 0..90 {
            assert_eq!(one[0].slope.cells[bin], one[1].slope.cells[bin] + one[2].slope.cells[bin]);
        }
        assert!((one[0].area_km2() / (one[1].area_km2() + one[2].area_km2()) - 1.0).abs() < 1e-12);
        let watch = Watch::default();
        watch.cancel();
        let stopped = measure_terrain(&g.0, &g.1, &shape, &sets, &watch).unwrap_err();
        assert_eq!(stopped.kind(), ErrorKind::Interrupted);
    }
}
