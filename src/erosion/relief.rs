//! A raster of elevations whose cells have a size.

use crate::error::{Error, ErrorKind, Result};

/// Most cells: their indices have 32 bits, of which one value stands for none.
const MAX_CELLS: usize = u32::MAX as usize;

/// Elevations in metres, row-major, NaN where there is none, on cells of a size in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Relief {
    rows: usize,
    cols: usize,
    cell_m: [f32; 2],
    z_m: Vec<f32>,
}

impl Relief {
    /// A raster of `rows` times `cols` elevations, on cells so many metres wide and high.
    ///
    /// # Errors
    /// A raster of 2^32 cells or more, or cells without a size.
    ///
    /// # Panics
    /// When `z_m` does not hold exactly `rows * cols` elevations.
    pub fn new(rows: usize, cols: usize, [width_m, height_m]: [f64; 2], mut z_m: Vec<f32>) -> Result<Self> {
        assert_eq!(z_m.len(), rows * cols, "one elevation a cell");
        if z_m.len() >= MAX_CELLS {
            let message =
                format!("{cols} x {rows} cells are too many to route water over at once: at most {MAX_CELLS}");
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        let cell_m = [width_m as f32, height_m as f32];
        if !cell_m.iter().all(|side| side.is_finite() && *side > 0.0) {
            return Err(Error::usage(format!("cells of {width_m} x {height_m} metres")));
        }
        z_m.iter_mut().filter(|z| !z.is_finite()).for_each(|z| *z = f32::NAN);
        Ok(Self { rows, cols, cell_m, z_m })
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Width and height of a cell in metres.
    pub fn cell_m(&self) -> [f32; 2] {
        self.cell_m
    }

    /// Elevations in metres.
    pub fn z_m(&self) -> &[f32] {
        &self.z_m
    }

    /// Elevations in metres, to be changed; a void stays one, and nothing else becomes one.
    pub fn z_m_mut(&mut self) -> &mut [f32] {
        &mut self.z_m
    }

    /// Elevations in metres, and nothing else.
    pub fn into_z_m(self) -> Vec<f32> {
        self.z_m
    }

    /// Distance in metres to the neighbour in each direction of [`OFFSETS`](crate::grid::neighbours::OFFSETS).
    pub(super) fn distances_m(&self) -> [f32; 8] {
        let [width, height] = self.cell_m;
        let slant = (width * width + height * height).sqrt();
        [slant, height, slant, width, width, slant, height, slant]
    }

    /// How far in the array the neighbour in each direction is.
    pub(super) fn steps(&self) -> [isize; 8] {
        crate::grid::neighbours::OFFSETS.map(|(row, col)| row * self.cols as isize + col)
    }

    /// Whether a cell lies at the raster's edge.
    pub(super) fn is_at_edge(&self, cell: usize) -> bool {
        let (row, col) = (cell / self.cols, cell % self.cols);
        row == 0 || col == 0 || row + 1 == self.rows || col + 1 == self.cols
    }
}
