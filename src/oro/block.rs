//! Rectangles of cells, copied from raster to raster.

use crate::codec::Cells;
use crate::error::{Error, ErrorKind, Result};
use crate::grid::SampleType;
use crate::with_cells;

/// A rectangle of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Block {
    pub(super) col: usize,
    pub(super) row: usize,
    pub(super) width: usize,
    pub(super) height: usize,
}

impl Block {
    /// What both rectangles have in common; nothing where they have nothing.
    pub(super) fn common(self, other: Self) -> Option<Self> {
        let (col, row) = (self.col.max(other.col), self.row.max(other.row));
        let right = (self.col + self.width).min(other.col + other.width);
        let bottom = (self.row + self.height).min(other.row + other.height);
        (col < right && row < bottom).then(|| Self { col, row, width: right - col, height: bottom - row })
    }
}

/// Copies the cells that both rectangles have in common; both vectors hold their rectangle row by row.
pub(super) fn copy(to: &mut Cells, to_block: Block, from: &Cells, from_block: Block) {
    let Some(common) = to_block.common(from_block) else { return };
    macro_rules! rows {
        ($($variant:ident),*) => {
            match (to, from) {
                $((Cells::$variant(to), Cells::$variant(from)) => for row in common.row..common.row + common.height {
                    let at = |block: Block| (row - block.row) * block.width + common.col - block.col;
                    let (to_at, from_at) = (at(to_block), at(from_block));
                    to[to_at..to_at + common.width].copy_from_slice(&from[from_at..from_at + common.width]);
                })*
                // The caller has seen to it that the types agree.
                _ => {}
            }
        };
    }
    rows!(U8, I8, U16, I16, U32, I32, F32, F64);
}

/// So many cells of 0, or a message when the memory is not there: sizes come from files.
pub(super) fn zeros(sample: SampleType, width: usize, height: usize) -> Result<Cells> {
    let too_large =
        || Error::new(ErrorKind::Unsupported, format!("{width} x {height} cells do not fit into the memory"));
    let count = width.checked_mul(height).ok_or_else(too_large)?;
    let mut cells = Cells::zeros(sample, 0);
    with_cells!(&mut cells, values => {
        values.try_reserve_exact(count).map_err(|_| too_large())?;
        values.resize(count, Default::default());
    });
    Ok(cells)
}

/// So many cells that hold the bits of a nodata value, or 0 where there is none.
pub(super) fn voids(sample: SampleType, nodata: Option<u64>, count: usize) -> Cells {
    let mut cells = Cells::zeros(sample, count);
    let Some(bits) = nodata else { return cells };
    if let Some(void) = Cells::from_le_bytes(sample, &bits.to_le_bytes()[..sample.bytes()]) {
        macro_rules! fill {
            ($($variant:ident),*) => {
                match (&mut cells, &void) {
                    $((Cells::$variant(values), Cells::$variant(void)) => values.fill(void[0]),)*
                    _ => {}
                }
            };
        }
        fill!(U8, I8, U16, I16, U32, I32, F32, F64);
    }
    cells
}
