//! Geodesics between the cells of a projected grid: `--distance geodesic`.

use super::ellipsoid::{Ellipsoid, Geodesics};
use super::metric::{Block, Metric, Place, SLACK, Vector};
use crate::grid::GeoTransform;

/// Turns projected coordinates into longitude and latitude, in degrees, on the CRS's own ellipsoid.
pub trait ToGeographic: Sync {
    /// Longitudes and latitudes in place of the coordinates; NaN where there is none.
    fn to_geographic(&self, x: &mut [f64], y: &mut [f64]);
}

/// Side in cells of the blocks whose boxes in space are kept.
const SIDE: i64 = 16;

/// Distances on the ellipsoid between the cells of a projected grid.
///
/// A projection bends rows and columns, so nothing can be said of a block without looking at its cells: each block
/// of 16 x 16 cells keeps the box in space around its centres, and coarser blocks the box of those.
pub struct Surface<'a> {
    transform: GeoTransform,
    ellipsoid: Ellipsoid,
    solver: Geodesics,
    to_geographic: &'a dyn ToGeographic,
    /// Boxes (least and greatest of the three coordinates in metres), finest level first, each level half as wide.
    levels: Vec<Level>,
    /// The cells just outside of the raster with their places in space; those that have none are left out.
    frame: Vec<(Place, [f64; 3])>,
    rows: i64,
    cols: i64,
}

struct Level {
    cols: i64,
    boxes: Vec<[f32; 6]>,
}

/// Metres by which boxes are widened: more than rounding to single precision can take away.
const WIDEN_M: f64 = 1.0;

impl<'a> Surface<'a> {
    /// The metric of a projected grid; transforms every cell once.
    pub fn new(
        transform: &GeoTransform,
        ellipsoid: &Ellipsoid,
        to_geographic: &'a dyn ToGeographic,
        rows: usize,
        cols: usize,
    ) -> Self {
        let (rows, cols) = (rows as i64, cols as i64);
        let mut surface = Self {
            transform: *transform,
            ellipsoid: *ellipsoid,
            solver: ellipsoid.geodesics(),
            to_geographic,
            levels: vec![],
            frame: vec![],
            rows,
            cols,
        };
        let (block_rows, block_cols) = ((rows + SIDE - 1) / SIDE, (cols + SIDE - 1) / SIDE);
        let mut boxes = Vec::with_capacity((block_rows * block_cols) as usize);
        for br in 0..block_rows {
            for bc in 0..block_cols {
                let mut places = Vec::with_capacity((SIDE * SIDE) as usize);
                for row in br * SIDE..((br + 1) * SIDE).min(rows) {
                    places.extend((bc * SIDE..((bc + 1) * SIDE).min(cols)).map(|col| (row, col)));
                }
                boxes.push(surface.box_of(&places));
            }
        }
        surface.levels.push(Level { cols: block_cols, boxes });
        surface.frame = surface.frame_in_space();
        let (mut r, mut c) = (block_rows, block_cols);
        while r > 1 || c > 1 {
            let (nr, nc) = ((r + 1) / 2, (c + 1) / 2);
            let fine = surface.levels.last().expect("the first level is there");
            let mut boxes = vec![EMPTY; (nr * nc) as usize];
            for i in 0..r {
                for j in 0..c {
                    join(&mut boxes[(i / 2 * nc + j / 2) as usize], &fine.boxes[(i * c + j) as usize]);
                }
            }
            surface.levels.push(Level { cols: nc, boxes });
            (r, c) = (nr, nc);
        }
        surface
    }

    fn geographic(&self, places: &[Place]) -> (Vec<f64>, Vec<f64>) {
        let (mut x, mut y): (Vec<f64>, Vec<f64>) =
            places.iter().map(|p| self.transform.centre(p.0 as f64, p.1 as f64)).unzip();
        self.to_geographic.to_geographic(&mut x, &mut y);
        (x, y)
    }

    fn frame_in_space(&self) -> Vec<(Place, [f64; 3])> {
        let (rows, cols) = (self.rows, self.cols);
        let ends = (-1..=cols).flat_map(|col| [(-1, col), (rows, col)]);
        let places: Vec<Place> = ends.chain((0..rows).flat_map(|row| [(row, -1), (row, cols)])).collect();
        let (lon, lat) = self.geographic(&places);
        let in_space = |(place, (lon, lat)): (Place, (f64, f64))| (place, self.ellipsoid.in_space(lon, lat));
        places.into_iter().zip(lon.into_iter().zip(lat)).filter(|(_, (_, lat))| !lat.is_nan()).map(in_space).collect()
    }

    fn in_space(&self, p: Place) -> [f64; 3] {
        let (lon, lat) = self.lon_lat(p);
        self.ellipsoid.in_space(lon, lat)
    }

    fn lon_lat(&self, p: Place) -> (f64, f64) {
        let (lon, lat) = self.geographic(&[p]);
        (lon[0], lat[0])
    }

    #[allow(clippy::cast_possible_truncation, reason = "boxes are widened by more than the rounding")]
    fn box_of(&self, places: &[Place]) -> [f32; 6] {
        let (lon, lat) = self.geographic(places);
        let mut b = EMPTY;
        for (lon, lat) in lon.into_iter().zip(lat) {
            let s = self.ellipsoid.in_space(lon, lat);
            join(
                &mut b,
                &std::array::from_fn(|i| if i < 3 { (s[i] - WIDEN_M) as f32 } else { (s[i - 3] + WIDEN_M) as f32 }),
            );
        }
        b
    }
}

const EMPTY: [f32; 6] =
    [f32::INFINITY, f32::INFINITY, f32::INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY];

fn join(a: &mut [f32; 6], b: &[f32; 6]) {
    for i in 0..3 {
        a[i] = a[i].min(b[i]);
        a[i + 3] = a[i + 3].max(b[i + 3]);
    }
}

impl Metric for Surface<'_> {
    fn distance_m(&self, p: Place, q: Place) -> f64 {
        self.vector(p, q).distance_m
    }

    fn vector(&self, p: Place, q: Place) -> Vector {
        let ((lon1, lat1), (lon2, lat2)) = (self.lon_lat(p), self.lon_lat(q));
        let dlon = (lon2 - lon1).rem_euclid(360.0);
        let east = dlon <= 180.0;
        let (distance_m, azimuth) = self.solver.inverse(lat1, lat2, if east { dlon } else { 360.0 - dlon });
        let azimuth = if distance_m == 0.0 {
            f64::NAN
        } else if east || azimuth == 0.0 {
            azimuth
        } else {
            360.0 - azimuth
        };
        Vector { distance_m, azimuth }
    }

    fn near2(&self, p: Place, q: Place) -> f64 {
        let (a, b) = (self.in_space(p), self.in_space(q));
        (0..3).map(|i| (a[i] - b[i]).powi(2)).sum()
    }

    fn block2(&self, p: Place, block: &Block) -> f64 {
        // The coarsest kept blocks that are not wider than the asked one.
        let side = (block.rows.1 - block.rows.0 + 1).max(block.cols.1 - block.cols.0 + 1);
        let mut level = 0;
        while level + 1 < self.levels.len() && (SIDE << (level + 1)) <= side {
            level += 1;
        }
        let width = SIDE << level;
        let kept = &self.levels[level];
        let (r1, c1) = (block.rows.1.min(self.rows - 1), block.cols.1.min(self.cols - 1));
        let mut b = EMPTY;
        for i in block.rows.0 / width..=r1 / width {
            for j in block.cols.0 / width..=c1 / width {
                join(&mut b, &kept.boxes[(i * kept.cols + j) as usize]);
            }
        }
        let here = self.in_space(p);
        let mut sum = 0.0;
        for i in 0..3 {
            let away = (f64::from(b[i]) - here[i]).max(here[i] - f64::from(b[i + 3])).max(0.0);
            sum += away * away;
        }
        sum
    }

    fn reach2(&self, near2: f64) -> f64 {
        self.ellipsoid.reach2(near2)
    }

    fn is_alike_along_rows(&self) -> bool {
        false
    }

    fn outside_m(&self, p: Place, rows: i64, cols: i64, limit_m: f64) -> Option<f64> {
        // A projection that is not broken has its nearest outer place in the frame.
        debug_assert_eq!((rows, cols), (self.rows, self.cols), "the frame is that of the raster");
        let here = self.in_space(p);
        let mut best = limit_m;
        for (place, there) in &self.frame {
            let near2: f64 = (0..3).map(|k| (here[k] - there[k]).powi(2)).sum();
            if near2 <= best * best * SLACK {
                best = best.min(self.distance_m(p, *place));
            }
        }
        (best < limit_m).then_some(best)
    }
}
