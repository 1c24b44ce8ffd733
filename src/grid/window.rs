//! Parts of a raster, as users name them.

use super::georeference::GeoTransform;
use crate::error::{Error, Result};

/// First column, first row, columns and rows of what a window or a box leaves of a raster of so many columns and rows.
///
/// # Errors
/// A usage error for both at once, and for what does not lie in the raster.
pub fn window_of(
    whole: &GeoTransform,
    (cols, rows): (usize, usize),
    window: Option<[usize; 4]>,
    bbox: Option<[f64; 4]>,
) -> Result<[usize; 4]> {
    match (window, bbox) {
        (Some(_), Some(_)) => Err(Error::usage("--window and --bbox cannot be given together")),
        (None, None) => Ok([0, 0, cols, rows]),
        (Some([col, row, w, h]), None) => {
            let fits = w > 0
                && h > 0
                && col.checked_add(w).is_some_and(|end| end <= cols)
                && row.checked_add(h).is_some_and(|end| end <= rows);
            if !fits {
                return Err(Error::usage(format!(
                    "--window {col},{row},{w},{h} does not lie in the raster of {cols} columns and {rows} rows"
                )));
            }
            Ok([col, row, w, h])
        }
        (None, Some([x0, y0, x1, y1])) => {
            if !whole.is_axis_parallel() {
                return Err(Error::usage(
                    "--bbox needs a raster whose rows and columns run along the axes; use --window",
                ));
            }
            let (a, b) = (whole.pixel(x0, y0), whole.pixel(x1, y1));
            // Cells whose centres lie in the box.
            let range = |p: f64, q: f64, n: usize| {
                let (low, high) = (p.min(q), p.max(q));
                let first = (low - 0.5).ceil().max(0.0);
                let end = ((high - 0.5).floor() + 1.0).min(n as f64);
                (first, end - first)
            };
            let ((row, h), (col, w)) = (range(a.0, b.0, rows), range(a.1, b.1, cols));
            if !(w >= 1.0 && h >= 1.0) || x0 > x1 || y0 > y1 {
                return Err(Error::usage(format!(
                    "--bbox {x0},{y0},{x1},{y1} holds no cell of the raster; expected xmin,ymin,xmax,ymax in the raster's CRS"
                )));
            }
            Ok([col as usize, row as usize, w as usize, h as usize])
        }
    }
}
