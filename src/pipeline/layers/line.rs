//! Lines on a raster whose columns wrap, cut where they cross the seam.

use super::measure::Frame;
use crate::grid::Cell;
use crate::io::vector::{Geometry, GeometryKind};

/// The geometry type of the lines of a raster.
pub(super) fn kind(frame: &Frame<'_>) -> GeometryKind {
    if frame.wraps() { GeometryKind::MultiLine } else { GeometryKind::Line }
}

/// The line through the centres of cells; points on a straight run are left out.
///
/// Where the shorter way from one cell to the next leads across the seam, the line ends on one side and begins again
/// on the other, half a cell beyond the outermost centres.
pub(super) fn through(frame: &Frame<'_>, cells: &[Cell]) -> Geometry {
    let cols = frame.cols() as f64;
    let mut pieces: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
    let mut places: Vec<(f64, f64)> = Vec::new();
    let flush = |places: &mut Vec<(f64, f64)>, pieces: &mut Vec<Vec<(f64, f64)>>| {
        let piece = pieces.last_mut().expect("there is always a piece");
        for (i, &(row, col)) in places.iter().enumerate() {
            let is_straight = i > 0 && i + 1 < places.len() && {
                let ((r0, c0), (r1, c1)) = (places[i - 1], places[i + 1]);
                row - r0 == r1 - row && col - c0 == c1 - col
            };
            if !is_straight {
                piece.push(frame.centre(row, col));
            }
        }
        places.clear();
    };
    let mut last: Option<(f64, f64)> = None;
    for &cell in cells {
        let (row, col) = frame.place(cell);
        let (row, col) = (row as f64, col as f64);
        if let Some((last_row, last_col)) = last.filter(|_| frame.wraps()) {
            let step = col - last_col;
            if step.abs() > cols / 2.0 {
                // Eastwards over the last column, or westwards over the first.
                let (edge, start) = if step < 0.0 { (cols - 0.5, -0.5) } else { (-0.5, cols - 0.5) };
                let way = if step < 0.0 { step + cols } else { step - cols };
                let share = (edge - last_col) / way;
                let at_seam = last_row + share * (row - last_row);
                places.push((at_seam, edge));
                flush(&mut places, &mut pieces);
                pieces.push(Vec::new());
                places.push((at_seam, start));
            }
        }
        places.push((row, col));
        last = Some((row, col));
    }
    flush(&mut places, &mut pieces);
    for piece in &mut pieces {
        // A line of one point is none: peaks and saddles may be one cell across the seam.
        if piece.len() == 1 {
            piece.push(piece[0]);
        }
    }
    Geometry::Lines(pieces)
}
