//! From a mesh to a raster.

use super::mesh::Mesh;
use super::plane::Plane;
use super::spans::each_span;
use rayon::prelude::*;

/// Parts of a cell's side that scan conversion tells apart.
pub const SUBCELLS: f64 = (1 << BITS) as f64;

const BITS: u32 = 10;

/// Rows that are drawn by one thread at a time.
const BAND: usize = 64;

/// The coordinate nearest to one that scan conversion knows exactly: a whole number of [`SUBCELLS`]th parts of a cell.
///
/// A triangulation of such points is drawn exactly as it is.
pub fn snapped(coordinate: f64) -> f64 {
    (coordinate * SUBCELLS).round() / SUBCELLS
}

/// Draws a mesh whose x and y are columns and rows: the elevation at each cell's centre, NaN where no triangle is.
///
/// A centre on an edge or a vertex belongs to the first of its triangles, so there are no gaps between triangles and
/// nothing is drawn twice. Vertices are taken to the nearest [`SUBCELLS`]th part of a cell first; triangles that have no
/// area then, or are upside down, draw nothing. Vertices may lie outside of the raster.
///
/// # Panics
/// When a vertex lies left of column or above row -100,000, or beyond 1,100,000.
///
/// # Complexity
/// O(cells covered + rows touched by each triangle).
pub fn scan(mesh: &Mesh, rows: usize, cols: usize) -> Vec<f64> {
    // The products of differences stay within 64 bits.
    let is_near = |v: f64| (-100_000.0..=1_100_000.0).contains(&v);
    assert!(mesh.vertices.iter().all(|v| is_near(v[0]) && is_near(v[1])), "vertices near the raster");
    if rows == 0 || cols == 0 {
        return Vec::new();
    }
    let corner = |v: u32| {
        let [x, y, _] = mesh.vertices[v as usize];
        [(x * SUBCELLS).round() as i64, (y * SUBCELLS).round() as i64]
    };
    // Each band of rows has its own list of triangles in their order, so that threads make no difference.
    let mut bands: Vec<Vec<u32>> = vec![Vec::new(); rows.div_ceil(BAND)];
    for (i, triangle) in (0..).zip(&mesh.triangles) {
        let y = triangle.map(|v| mesh.vertices[v as usize][1]);
        let (low, high) = (y[0].min(y[1]).min(y[2]) - 1.0, y[0].max(y[1]).max(y[2]) + 1.0);
        if high < 0.0 || low > rows as f64 {
            continue;
        }
        let band = |y: f64| (y.max(0.0) as usize / BAND).min(bands.len() - 1);
        let touched = band(low)..=band(high);
        bands[touched].iter_mut().for_each(|list| list.push(i));
    }
    let mut z = vec![f64::NAN; rows * cols];
    z.par_chunks_mut(BAND * cols).zip(&bands).enumerate().for_each(|(number, (cells, list))| {
        let first_row = (number * BAND) as i64;
        let shift = first_row << BITS;
        let band_rows = (cells.len() / cols) as i64;
        for &i in list {
            let triangle = mesh.triangles[i as usize];
            let [a, b, c] = triangle.map(corner).map(|[x, y]| [x, y - shift]);
            if (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]) <= 0 {
                continue;
            }
            let plane = Plane::through(triangle.map(|v| {
                let ([x, y], z) = (corner(v), mesh.vertices[v as usize][2]);
                [x as f64 / SUBCELLS, y as f64 / SUBCELLS, z]
            }));
            each_span::<BITS>([a, b, c], (cols as i64, band_rows), |row, first, last| {
                let y = (first_row + row) as f64;
                let span = &mut cells[row as usize * cols..][first as usize..=last as usize];
                for (x, cell) in (first..).zip(span).filter(|(_, cell)| cell.is_nan()) {
                    *cell = plane.at(x as f64, y);
                }
            });
        }
    });
    z
}
