//! A raster in batches of whole tiles, as many as the memory takes.

use super::super::memory::{BatchNeeds, CODEC_BYTES_PER_CELL};
use crate::codec::Cells;

/// Bytes of cells that are worked on at once where the memory takes them: enough tiles for many threads.
const BATCH_BYTES: u64 = 128 << 20;

/// A rectangle of cells: column, row, columns, rows.
pub(super) type Area = [usize; 4];

/// How a raster is taken in batches.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// Column and row at which the raster begins in the grid of tiles.
    pub(super) corner: [usize; 2],
    /// Columns and rows of the raster.
    pub(super) size: [usize; 2],
    /// Side of the tiles.
    pub(super) side: usize,
    /// Bytes of a cell, all bands together.
    pub(super) cell_bytes: usize,
}

impl Plan {
    /// The memory that it takes to go through the raster.
    pub(super) fn needs(&self) -> BatchNeeds {
        let [width, height] = self.size.map(|side| side as u64);
        let tile = (self.side as u64).pow(2);
        BatchNeeds {
            least: width.min(self.side as u64) * height.min(self.side as u64) * self.cell_bytes as u64,
            per_thread: tile.saturating_mul(CODEC_BYTES_PER_CELL),
            // The index, and the coarsest level.
            kept: (width * height / tile).saturating_mul(64) + ((width * height) >> 12) * self.cell_bytes as u64,
        }
    }

    /// Bytes of the cells of a row of tiles.
    pub(super) fn row_bytes(&self) -> u64 {
        let [width, height] = self.size;
        width as u64 * self.side.min(height) as u64 * self.cell_bytes as u64
    }

    /// The batches in the order of the tiles, counted from the raster's own corner: whole rows of tiles, or parts of
    /// one where a row takes more than `budget` bytes.
    pub(super) fn batches(&self, budget: u64) -> Vec<Area> {
        let [width, height] = self.size;
        let row_bytes = self.row_bytes().max(1);
        let (cols, rows) = if row_bytes > budget {
            let tile = (self.side as u64).pow(2).saturating_mul(self.cell_bytes as u64).max(1);
            ((budget / tile).max(1), 1)
        } else {
            (u64::MAX, (budget.min(BATCH_BYTES) / row_bytes).max(1))
        };
        let across = self.cuts(0, width, usize::try_from(cols).unwrap_or(usize::MAX));
        let down = self.cuts(1, height, usize::try_from(rows).unwrap_or(usize::MAX));
        let mut batches = Vec::new();
        for row in down.windows(2) {
            for col in across.windows(2) {
                batches.push([col[0], row[0], col[1] - col[0], row[1] - row[0]]);
            }
        }
        batches
    }

    /// The tiles of an area, or what of them lies in it, row by row.
    pub(super) fn tiles(&self, [col, row, width, height]: Area) -> Vec<Area> {
        let cuts = |axis: usize, from: usize, length: usize| {
            let origin = self.corner[axis] + from;
            let mut cuts = vec![from];
            while let Some(&last) = cuts.last().filter(|&&last| last < from + length) {
                let next = ((last - from + origin) / self.side + 1) * self.side - origin + from;
                cuts.push(next.min(from + length));
            }
            cuts
        };
        let (across, down) = (cuts(0, col, width), cuts(1, row, height));
        let columns = |row: &[usize]| {
            let [top, bottom] = [row[0], row[1]];
            across.windows(2).map(move |col| [col[0], top, col[1] - col[0], bottom - top]).collect::<Vec<_>>()
        };
        down.windows(2).flat_map(columns).collect()
    }

    /// Where `length` cells are cut so that each piece is at most so many tiles, at the tiles' edges.
    fn cuts(&self, axis: usize, length: usize, tiles: usize) -> Vec<usize> {
        let step = self.side.saturating_mul(tiles);
        // The raster may begin inside of a tile, which is then the first.
        let inside = self.corner[axis] % self.side;
        let mut cuts = vec![0];
        while let Some(&last) = cuts.last().filter(|&&last| last < length) {
            let next = if last == 0 { step.saturating_sub(inside) } else { last.saturating_add(step) };
            cuts.push(next.clamp(last + 1, length));
        }
        cuts
    }
}

/// Copies a piece into the cells of an area that holds it.
pub(super) fn paste(into: &mut Cells, area: Area, piece: &Cells, at: Area) {
    macro_rules! rows {
        ($($variant:ident),*) => {
            match (into, piece) {
                $((Cells::$variant(into), Cells::$variant(piece)) => {
                    for (row, line) in piece.chunks_exact(at[2]).enumerate() {
                        let start = (at[1] - area[1] + row) * area[2] + at[0] - area[0];
                        into[start..start + at[2]].copy_from_slice(line);
                    }
                })*
                _ => unreachable!("pieces are of the type of the whole"),
            }
        };
    }
    rows!(U8, I8, U16, I16, U32, I32, F32, F64);
}

/// The cells of a piece of an area.
pub(super) fn cut(from: &Cells, area: Area, at: Area) -> Cells {
    macro_rules! rows {
        ($($variant:ident),*) => {
            match from {
                $(Cells::$variant(from) => {
                    let mut piece = Vec::with_capacity(at[2] * at[3]);
                    for row in 0..at[3] {
                        let start = (at[1] - area[1] + row) * area[2] + at[0] - area[0];
                        piece.extend_from_slice(&from[start..start + at[2]]);
                    }
                    Cells::$variant(piece)
                })*
            }
        };
    }
    rows!(U8, I8, U16, I16, U32, I32, F32, F64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_cover_the_raster_in_order() {
        for (corner, size, side) in [([0, 0], [1000, 700], 64), ([70, 130], [300, 200], 64), ([5, 5], [3, 2], 64)] {
            let plan = Plan { corner, size, side, cell_bytes: 2 };
            for budget in [1, 40_000, 200_000, u64::MAX] {
                let mut seen = vec![0; size[0] * size[1]];
                let mut last = None;
                for batch in plan.batches(budget) {
                    for tile in plan.tiles(batch) {
                        let [col, row, width, height] = tile;
                        let place = ((corner[1] + row) / side, (corner[0] + col) / side);
                        assert!(last < Some(place), "{budget}: {place:?} after {last:?}");
                        last = Some(place);
                        assert_eq!((corner[1] + row + height - 1) / side, place.0, "one tile");
                        assert_eq!((corner[0] + col + width - 1) / side, place.1, "one tile");
                        for row in row..row + height {
                            seen[row * size[0] + col..][..width].iter_mut().for_each(|cell| *cell += 1);
                        }
                    }
                }
                assert!(seen.iter().all(|&times| times == 1), "{corner:?} {size:?} {budget}");
            }
        }
    }

    #[test]
    fn pieces_come_back() {
        let whole = Cells::I16((0..30).collect());
        let (area, at) = ([2, 3, 6, 5], [4, 5, 3, 2]);
        let piece = cut(&whole, area, at);
        assert_eq!(piece, Cells::I16(vec![14, 15, 16, 20, 21, 22]));
        let mut again = whole.clone();
        paste(&mut again, area, &Cells::I16(vec![0; 6]), at);
        assert_ne!(again, whole);
        paste(&mut again, area, &piece, at);
        assert_eq!(again, whole);
    }
}
