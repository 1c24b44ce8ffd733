//! Sets of cells of a grid: the whole, disks, polygons.

use super::disk::{Centre, Disk};
use crate::crs::{CrsKind, ToGeographic};
use crate::error::{Error, Result};
use crate::grid::GeoTransform;
use std::ops::Range;

/// A set of cells, kept as runs of columns in every row.
///
/// A cell belongs to a disk or polygon when its centre does, as a peak in that cell would.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellSet {
    cols: usize,
    runs: Vec<Vec<Range<usize>>>,
}

impl CellSet {
    /// All cells of a grid.
    pub fn whole(rows: usize, cols: usize) -> Self {
        let row = vec![Range { start: 0, end: cols }];
        Self { cols, runs: vec![row; rows] }
    }

    /// The cells for which `holds` writes `true` into its slice, row by row.
    pub fn from_rows(rows: usize, cols: usize, mut holds: impl FnMut(usize, &mut [bool])) -> Self {
        let mut inside = vec![false; cols];
        let runs = (0..rows)
            .map(|row| {
                inside.fill(false);
                holds(row, &mut inside);
                runs_of(&inside)
            })
            .collect();
        Self { cols, runs }
    }

    /// The cells in a disk.
    ///
    /// `to_geographic` turns coordinates of a projected CRS into longitudes and latitudes; it is needed for a geodesic
    /// disk there and nowhere else.
    ///
    /// # Errors
    /// A usage error when the disk's kind of centre does not fit the CRS.
    pub fn disk(
        disk: &Disk,
        kind: Option<&CrsKind>,
        transform: &GeoTransform,
        (rows, cols): (usize, usize),
        to_geographic: Option<&dyn ToGeographic>,
    ) -> Result<Self> {
        let centre = |row: usize, col: usize| transform.centre(row as f64, col as f64);
        match (&disk.centre, kind) {
            (Centre::Planar { .. }, Some(CrsKind::Geographic { .. })) => {
                Err(Error::usage("in a geographic CRS a disk is given as longitude,latitude,radius"))
            }
            (Centre::Planar { .. }, _) => Ok(Self::from_rows(rows, cols, |row, inside| {
                for (col, cell) in inside.iter_mut().enumerate() {
                    let (x, y) = centre(row, col);
                    *cell = disk.holds_xy(x, y);
                }
            })),
            (Centre::Geographic { .. }, Some(CrsKind::Geographic { degrees, .. })) => {
                let reach = disk.reach();
                Ok(Self::from_rows(rows, cols, |row, inside| {
                    if transform.is_axis_parallel() && !reach.holds_latitude(centre(row, 0).1 * degrees) {
                        return;
                    }
                    for (col, cell) in inside.iter_mut().enumerate() {
                        let (x, y) = centre(row, col);
                        *cell = reach.holds(x * degrees, y * degrees);
                    }
                }))
            }
            (Centre::Geographic { .. }, _) => {
                let to_geographic = to_geographic.ok_or_else(|| {
                    Error::usage("without a CRS a disk is given as x,y,radius in the coordinates of the raster")
                })?;
                let reach = disk.reach();
                let (mut x, mut y) = (vec![0.0; cols], vec![0.0; cols]);
                Ok(Self::from_rows(rows, cols, |row, inside| {
                    for col in 0..cols {
                        (x[col], y[col]) = centre(row, col);
                    }
                    to_geographic.to_geographic(&mut x, &mut y);
                    for (col, cell) in inside.iter_mut().enumerate() {
                        *cell = reach.holds(x[col], y[col]);
                    }
                }))
            }
        }
    }

    /// The cells whose centres lie in a polygon: rings in the coordinates of the raster, holes and further parts
    /// included, by the even-odd rule.
    ///
    /// Rings may be open or closed. A centre on the outline belongs to one of the two polygons that share it.
    pub fn polygon(rings: &[Vec<(f64, f64)>], transform: &GeoTransform, rows: usize, cols: usize) -> Self {
        let mut edges = vec![];
        for ring in rings {
            let pixels: Vec<(f64, f64)> = ring.iter().map(|&(x, y)| transform.pixel(x, y)).collect();
            for (i, &a) in pixels.iter().enumerate() {
                // Upwards and downwards the same numbers, so that neighbours agree about their common outline.
                let b = pixels[(i + 1) % pixels.len()];
                if a.0 != b.0 {
                    edges.push(if a.0 < b.0 { (a, b) } else { (b, a) });
                }
            }
        }
        edges.sort_by(|p, q| p.0.0.total_cmp(&q.0.0));
        let (mut next, mut active, mut crossings) = (0, Vec::new(), Vec::new());
        let runs = (0..rows)
            .map(|row| {
                let middle = row as f64 + 0.5;
                while next < edges.len() && edges[next].0.0 <= middle {
                    active.push(edges[next]);
                    next += 1;
                }
                active.retain(|edge| edge.1.0 > middle);
                crossings.clear();
                crossings.extend(active.iter().map(|(a, b)| a.1 + (middle - a.0) / (b.0 - a.0) * (b.1 - a.1)));
                crossings.sort_by(f64::total_cmp);
                // The first column whose centre is not left of the crossing.
                let column = |x: f64| (x - 0.5).ceil().clamp(0.0, cols as f64) as usize;
                let mut runs: Vec<Range<usize>> = vec![];
                for pair in crossings.chunks_exact(2) {
                    let (start, end) = (column(pair[0]), column(pair[1]));
                    match runs.last_mut() {
                        _ if start >= end => {}
                        Some(last) if last.end == start => last.end = end,
                        _ => runs.push(start..end),
                    }
                }
                runs
            })
            .collect();
        Self { cols, runs }
    }

    /// Adds the cells of another set of the same grid.
    ///
    /// # Panics
    /// When the grids differ in size.
    pub fn join(&mut self, other: &Self) {
        assert_eq!((self.rows(), self.cols), (other.rows(), other.cols), "sets of cells of one grid");
        for (mine, theirs) in self.runs.iter_mut().zip(&other.runs).filter(|(_, theirs)| !theirs.is_empty()) {
            mine.extend_from_slice(theirs);
            mine.sort_unstable_by_key(|run| run.start);
            mine.dedup_by(|next, last| {
                let touches = next.start <= last.end;
                if touches {
                    last.end = last.end.max(next.end);
                }
                touches
            });
        }
    }

    /// Takes away the cells of another set of the same grid.
    ///
    /// # Panics
    /// When the grids differ in size.
    pub fn take_away(&mut self, other: &Self) {
        assert_eq!((self.rows(), self.cols), (other.rows(), other.cols), "sets of cells of one grid");
        for (mine, theirs) in self.runs.iter_mut().zip(&other.runs).filter(|(_, theirs)| !theirs.is_empty()) {
            let mut left = Vec::with_capacity(mine.len());
            for run in mine.iter() {
                let mut start = run.start;
                for hole in theirs.iter().filter(|hole| hole.end > run.start && hole.start < run.end) {
                    if hole.start > start {
                        left.push(start..hole.start);
                    }
                    start = hole.end;
                }
                if start < run.end {
                    left.push(start..run.end);
                }
            }
            *mine = left;
        }
    }

    /// Number of rows of the grid.
    pub fn rows(&self) -> usize {
        self.runs.len()
    }

    /// Number of columns of the grid.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// The runs of columns of a row, from west to east.
    pub fn runs(&self, row: usize) -> &[Range<usize>] {
        &self.runs[row]
    }

    /// Whether a cell of the grid is one of them.
    pub fn holds(&self, row: usize, col: usize) -> bool {
        let runs = &self.runs[row];
        runs.partition_point(|run| run.end <= col) < runs.partition_point(|run| run.start <= col)
    }

    /// Number of cells.
    pub fn count(&self) -> u64 {
        self.runs.iter().flatten().map(|run| run.len() as u64).sum()
    }
}

fn runs_of(inside: &[bool]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = vec![];
    for (col, _) in inside.iter().enumerate().filter(|(_, inside)| **inside) {
        match runs.last_mut() {
            Some(last) if last.end == col => last.end = col + 1,
            _ => runs.push(col..col + 1),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::Ellipsoid;
    use proptest::prelude::*;

    const KIND: CrsKind = CrsKind::Geographic { ellipsoid: Ellipsoid::WGS84, degrees: 1.0 };

    fn runs(set: &CellSet, row: usize) -> Vec<(usize, usize)> {
        set.runs(row).iter().map(|run| (run.start, run.end)).collect()
    }

    #[test]
    fn a_disk_across_the_antimeridian_and_a_pole() {
        let t = GeoTransform([-180.0, 1.0, 0.0, 90.0, 0.0, -1.0]);
        let disk = |lon, lat, radius| {
            let disk = Disk::geographic(lon, lat, radius, Ellipsoid::WGS84).unwrap();
            CellSet::disk(&disk, Some(&KIND), &t, (180, 360), None).unwrap()
        };
        let seam = disk(180.0, 0.0, 250_000.0);
        assert_eq!(runs(&seam, 89), [(0, 2), (358, 360)]);
        assert_eq!(runs(&seam, 86), []);
        let pole = disk(12.0, 90.0, 250_000.0);
        assert_eq!(pole.count(), 720, "two rows of cells all round");
        assert_eq!(disk(77.0, 13.0, 2.1e7).count(), 64_800, "the whole globe");
    }

    #[test]
    fn a_plane_disk_and_its_crs() {
        let t = GeoTransform([0.0, 10.0, 0.0, 50.0, 0.0, -10.0]);
        let disk = Disk::planar(25.0, 25.0, 10.0, 1.0);
        let set = CellSet::disk(&disk, None, &t, (5, 5), None).unwrap();
        assert_eq!((runs(&set, 1), runs(&set, 2), set.count()), (vec![(2, 3)], vec![(1, 4)], 5));
        assert!(CellSet::disk(&disk, Some(&KIND), &t, (5, 5), None).is_err());
        let geodesic = Disk::geographic(0.0, 0.0, 10.0, Ellipsoid::WGS84).unwrap();
        assert!(CellSet::disk(&geodesic, None, &t, (5, 5), None).is_err());
    }

    #[test]
    fn polygons_that_share_an_outline_share_no_cell() {
        let t = GeoTransform([0.0, 1.0, 0.0, 6.0, 0.0, -1.0]);
        let square = |x0: f64, x1: f64| vec![(x0, 0.5), (x1, 0.5), (x1, 5.5), (x0, 5.5)];
        let (a, b) = (CellSet::polygon(&[square(0.0, 3.5)], &t, 6, 8), CellSet::polygon(&[square(3.5, 8.0)], &t, 6, 8));
        assert_eq!((a.count(), b.count()), (15, 25), "centres on the outline belong to one side only");
        assert_eq!(a.runs(0).len() + a.runs(5).len(), 1, "one of the two rows on the outline");
        let ring = CellSet::polygon(
            &[
                vec![(0.0, 0.0), (6.0, 0.0), (6.0, 6.0), (0.0, 6.0)],
                vec![(2.0, 2.0), (4.0, 2.0), (4.0, 4.0), (2.0, 4.0)],
            ],
            &t,
            6,
            8,
        );
        assert_eq!((ring.count(), runs(&ring, 2)), (32, vec![(0, 2), (4, 6)]));
    }

    proptest! {
        #[test]
        fn sets_join_and_part_as_cells_do(
            a in prop::collection::vec(any::<bool>(), 24), b in prop::collection::vec(any::<bool>(), 24),
        ) {
            let set = |cells: &[bool]| CellSet::from_rows(2, 12, |row, inside| inside.copy_from_slice(&cells[row * 12..][..12]));
            let by_cell = |of: fn(bool, bool) -> bool| a.iter().zip(&b).map(|(a, b)| of(*a, *b)).collect::<Vec<_>>();
            let (mut joined, mut parted) = (set(&a), set(&a));
            joined.join(&set(&b));
            parted.take_away(&set(&b));
            prop_assert_eq!(joined, set(&by_cell(|a, b| a || b)));
            prop_assert_eq!(parted, set(&by_cell(|a, b| a && !b)));
        }

        #[test]
        fn scan_lines_agree_with_asking_every_cell(
            points in prop::collection::vec((-3.0..15.0_f64, -3.0..12.0_f64), 3..9), shear in -0.5..0.5_f64,
        ) {
            let t = GeoTransform([0.0, 1.0, shear, 9.0, 0.0, -1.0]);
            let set = CellSet::polygon(std::slice::from_ref(&points), &t, 9, 12);
            for row in 0..9 {
                for col in 0..12 {
                    let (x, y) = t.centre(row as f64, col as f64);
                    let mut inside = false;
                    for (i, &a) in points.iter().enumerate() {
                        let b = points[(i + 1) % points.len()];
                        if (a.1 > y) != (b.1 > y) && x < a.0 + (y - a.1) / (b.1 - a.1) * (b.0 - a.0) {
                            inside = !inside;
                        }
                    }
                    prop_assert_eq!(set.runs(row).iter().any(|run| run.contains(&col)), inside);
                }
            }
        }
    }
}
