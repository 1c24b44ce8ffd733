//! Cells that are written out because what is predicted of them would break their band's promise.

use super::Cells;
use super::bits::{BitReader, BitWriter};
use super::header::{put_cell, take_cell};
use super::restore::cell_bits;
use super::tile::{SEGMENTS, TileShape};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::SampleType;

/// Which segment holds a cell: that of the coarsest level that has it.
fn segment_of(index: usize, width: usize) -> usize {
    let (row, col) = (index / width, index % width);
    let level = (row | col).trailing_zeros().min(SEGMENTS as u32 - 1) as usize;
    SEGMENTS - 1 - level
}

/// Cells of a segment that are written out: number, distances, bits.
pub(super) fn write_patches(bits: &mut BitWriter, cells: &Cells, shape: TileShape, broken: &[usize], segment: usize) {
    let mine: Vec<usize> = broken.iter().copied().filter(|&index| segment_of(index, shape.width) == segment).collect();
    bits.put_number(mine.len() as u64, 2);
    let mut next = 0;
    for index in mine {
        bits.put_number((index - next) as u64, 8);
        put_cell(bits, cell_bits(cells, index), cells.sample());
        next = index + 1;
    }
}

/// Reads the patches of a segment: cell of the tile and bits.
pub(super) fn read_patches(
    bits: &mut BitReader<'_>,
    sample: SampleType,
    shape: TileShape,
    segment: usize,
    patches: &mut Vec<(usize, u64)>,
) -> Result<()> {
    let count = bits.take_number(2);
    if count > shape.cells() as u64 {
        return Err(Error::new(ErrorKind::Corrupt, "a segment has more patches than cells"));
    }
    let mut next = 0u64;
    for _ in 0..count {
        let index = next.saturating_add(bits.take_number(8));
        if index >= shape.cells() as u64 {
            return Err(Error::new(ErrorKind::Corrupt, "a patch lies outside of its tile"));
        }
        // Coarse levels would be other cells than those of the finest one.
        if segment_of(index as usize, shape.width) != segment {
            return Err(Error::new(ErrorKind::Corrupt, "a patch stands in another segment than its cell"));
        }
        patches.push((index as usize, take_cell(bits, sample)));
        bits.check()?;
        next = index + 1;
    }
    Ok(())
}
