//! One tile of the raster: its peaks, the passes between its basins, and where its ways up leave it.
//!
//! All of it happens on a copy of the tile with a rim of one cell, small enough for a core's cache:
//!
//! 1. a mask for each cell tells which neighbours are above it (plain comparisons of rows, done many at a time);
//! 2. an empty mask is a **peak**; a mask in two pieces or more is a **saddle**, the only place where components of
//!    higher ground can meet (cells of one piece are joined already);
//! 3. from the topmost cell of each piece the way up is followed to its peak, or to the first cell outside of the
//!    tile, a **portal**; ways that meet are followed once;
//! 4. each saddle gives the passes from the basin of its topmost piece to those of the others.

use super::above::mark_row;
use crate::grid::neighbours::{is_above, topmost_around};
use crate::grid::ring::{RING, is_in_pieces, pieces};
use crate::grid::{Cell, Grid, Key};

/// Where a cell's way up leads, as seen from one tile: the first nodes are the tile's peaks, the others its portals.
pub(super) type Node = u32;

/// No node: the cell is a void, or was not followed.
pub(super) const NO_NODE: Node = u32::MAX;

/// A rectangle of the raster that is worked on at once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tile {
    pub(super) row: usize,
    pub(super) col: usize,
    pub(super) rows: usize,
    pub(super) cols: usize,
}

impl Tile {
    /// The tiles of a raster, row by row.
    pub(super) fn all(rows: usize, cols: usize, side: usize) -> Vec<Self> {
        let mut tiles = Vec::new();
        for row in (0..rows).step_by(side) {
            for col in (0..cols).step_by(side) {
                tiles.push(Self { row, col, rows: side.min(rows - row), cols: side.min(cols - col) });
            }
        }
        tiles
    }

    /// Number of cells in the ring along the tile's inner edge.
    pub(super) fn ring_len(&self) -> usize {
        if self.rows == 1 || self.cols == 1 { self.rows * self.cols } else { 2 * (self.rows + self.cols) - 4 }
    }

    /// Position of a cell (row and column inside the tile) in the ring: top row, bottom row, then the sides.
    pub(super) fn ring_index(&self, row: usize, col: usize) -> usize {
        if row == 0 {
            col
        } else if self.cols == 1 {
            row
        } else if row == self.rows - 1 {
            self.cols + col
        } else {
            let side = if col == 0 { 0 } else { self.rows - 2 };
            2 * self.cols + side + row - 1
        }
    }

    fn ring(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (rows, cols) = (self.rows, self.cols);
        let full = move |row: usize| (0..cols).map(move |col| (row, col));
        let top = full(0);
        let (bottom, sides) = if cols == 1 { (0, 0) } else { (usize::from(rows > 1), rows.saturating_sub(2)) };
        let narrow = if cols == 1 { rows - 1 } else { 0 };
        top.chain((1..=narrow).map(|row| (row, 0)))
            .chain((0..bottom).flat_map(move |_| full(rows - 1)))
            .chain((1..=sides).map(|row| (row, 0)))
            .chain((1..=sides).map(move |row| (row, cols - 1)))
    }
}

/// A place where two basins of a tile meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    /// The saddle's cell in the raster.
    pub(super) saddle: Cell,
    /// Basin of the saddle's topmost neighbour.
    pub(super) a: Node,
    /// Basin of the topmost neighbour in another piece.
    pub(super) b: Node,
    /// Number of the pass at its saddle: pieces are taken from the topmost down.
    pub(super) nth: u8,
}

/// Label of the cells in the rim that no way up has reached yet.
const RIM: u32 = u32::MAX;

/// What a tile found.
#[derive(Debug, Default)]
pub(super) struct Scan<K> {
    /// Cells of the nodes: the peaks in the order of their indices, then the portals.
    pub(super) cells: Vec<Cell>,
    /// Keys of the nodes.
    pub(super) keys: Vec<K>,
    /// How many of the nodes are peaks.
    pub(super) peaks: usize,
    /// The passes in the order in which they are swept, with the key of their saddle.
    pub(super) passes: Vec<(K, Pass)>,
    /// For each cell of the ring the node that its way up leads to; [`NO_NODE`] for a void.
    pub(super) ring: Vec<Node>,
    /// For each node with cells beside the unknown the topmost of them.
    pub(super) frontier: Vec<(Node, Cell)>,
}

/// The buffers of one tile, kept from tile to tile.
pub(super) struct Scanner<'a, K> {
    grid: &'a Grid<K>,
    nodata_is_sea: bool,
    tile: Tile,
    /// The tile with its rim.
    keys: Vec<K>,
    /// Width of a row of `keys` and `labels`.
    stride: usize,
    masks: Vec<u8>,
    marks: Vec<u8>,
    /// Node + 1 of the cells whose way up is known, else 0; [`RIM`] for those outside of the tile.
    labels: Vec<u32>,
    way: Vec<usize>,
    saddles: Vec<u32>,
    scan: Scan<K>,
}

impl<'a, K: Key> Scanner<'a, K> {
    pub(super) fn new(grid: &'a Grid<K>, nodata_is_sea: bool) -> Self {
        Self {
            grid,
            nodata_is_sea,
            tile: Tile { row: 0, col: 0, rows: 0, cols: 0 },
            keys: Vec::new(),
            stride: 0,
            masks: Vec::new(),
            marks: Vec::new(),
            labels: Vec::new(),
            way: Vec::new(),
            saddles: Vec::new(),
            scan: Scan::default(),
        }
    }

    /// Scans one tile.
    pub(super) fn scan(&mut self, tile: Tile) -> Scan<K> {
        self.tile = tile;
        self.stride = tile.cols + 2;
        let voids = self.load();
        self.clear_labels();
        self.find_above();
        self.find_peaks();
        self.find_passes();
        self.follow_ring();
        self.find_frontier(voids);
        self.sort_passes();
        std::mem::take(&mut self.scan)
    }

    /// Copies the tile and its rim; returns whether a void of the raster is among them.
    fn load(&mut self) -> bool {
        let (tile, grid) = (self.tile, self.grid);
        self.keys.clear();
        self.keys.resize((tile.rows + 2) * self.stride, K::VOID);
        let mut voids = false;
        for (i, line) in self.keys.chunks_exact_mut(self.stride).enumerate() {
            let Some(row) = (tile.row + i).checked_sub(1).filter(|&row| row < grid.rows()) else { continue };
            let from = grid.row(row);
            line[1..=tile.cols].copy_from_slice(&from[tile.col..tile.col + tile.cols]);
            let inner = &line[1..=tile.cols];
            voids |= inner.iter().fold(false, |any, &key| any | (key == K::VOID));
            let west = if tile.col > 0 { Some(tile.col - 1) } else { grid.wraps().then(|| grid.cols() - 1) };
            let end = tile.col + tile.cols;
            let east = if end < grid.cols() { Some(end) } else { grid.wraps().then_some(0) };
            for (side, at) in [(west, 0), (east, tile.cols + 1)] {
                if let Some(col) = side {
                    line[at] = from[col];
                    voids |= from[col] == K::VOID;
                }
            }
        }
        voids
    }

    fn clear_labels(&mut self) {
        let inner = self.stride - 1;
        self.labels.clear();
        self.labels.resize(self.keys.len(), 0);
        self.labels[..self.stride].fill(RIM);
        for line in self.labels.chunks_exact_mut(self.stride).skip(1) {
            line[0] = RIM;
            line[inner] = RIM;
        }
        let last = self.labels.len() - self.stride;
        self.labels[last..].fill(RIM);
    }

    /// The mask of the neighbours above, for each cell of the tile, and the marks of those that matter.
    fn find_above(&mut self) {
        let (tile, stride) = (self.tile, self.stride);
        for buffer in [&mut self.masks, &mut self.marks] {
            buffer.clear();
            buffer.resize(tile.rows * tile.cols, 0);
        }
        let lines = self.masks.chunks_exact_mut(tile.cols).zip(self.marks.chunks_exact_mut(tile.cols));
        for (row, (masks, marks)) in lines.enumerate() {
            let line = |i: usize| &self.keys[(row + i) * stride..(row + i + 1) * stride];
            mark_row(line(0), line(1), line(2), masks, marks);
        }
        for col in self.seam_cols() {
            for row in 0..tile.rows {
                let mask = self.mask_by_index(row, col);
                self.masks[row * tile.cols + col] = mask;
                self.marks[row * tile.cols + col] = u8::from(mask == 0) | u8::from(is_in_pieces(mask));
            }
        }
    }

    /// Columns of the tile along the seam of a wrapping grid: across it the western neighbour has the greater index
    /// and the eastern one the lower.
    fn seam_cols(&self) -> impl Iterator<Item = usize> + use<K> {
        let Tile { col, cols, .. } = self.tile;
        let wraps = self.grid.wraps();
        let first = (wraps && col == 0).then_some(0);
        let last = (wraps && col + cols == self.grid.cols()).then_some(cols - 1);
        first.into_iter().chain(last)
    }

    #[inline]
    fn is_at_seam(&self, at: usize) -> bool {
        if !self.grid.wraps() {
            return false;
        }
        let col = self.tile.col + at % self.stride - 1;
        col == 0 || col + 1 == self.grid.cols()
    }

    #[cold]
    fn mask_by_index(&self, row: usize, col: usize) -> u8 {
        let cell = self.cell(row, col);
        let here = (self.grid.key(cell), cell);
        if here.0 == K::VOID {
            return u8::MAX;
        }
        let (row, col) = self.grid.place(cell);
        let is_set = |offset| {
            self.grid
                .step(row, col, offset)
                .is_some_and(|n| !self.grid.is_void(n) && is_above((self.grid.key(n), n), here))
        };
        RING.iter().zip(0..).filter(|(offset, _)| is_set(**offset)).fold(0, |mask, (_, i)| mask | 1 << i)
    }

    #[inline]
    fn cell(&self, row: usize, col: usize) -> Cell {
        self.grid.cell(self.tile.row + row, self.tile.col + col)
    }

    fn find_peaks(&mut self) {
        let tile = self.tile;
        self.saddles.clear();
        for row in 0..tile.rows {
            let from = row * tile.cols;
            let marks = &self.marks[from..from + tile.cols];
            for (i, eight) in marks.chunks(8).enumerate() {
                // Most cells are neither peak nor saddle: eight at a time are passed over.
                let mut word = [0; 8];
                word[..eight.len()].copy_from_slice(eight);
                let mut word = u64::from_le_bytes(word);
                while word != 0 {
                    let col = i * 8 + word.trailing_zeros() as usize / 8;
                    word &= word - 1;
                    let at = (row + 1) * self.stride + col + 1;
                    if self.masks[from + col] == 0 {
                        self.scan.cells.push(self.grid.cell(tile.row + row, tile.col + col));
                        self.scan.keys.push(self.keys[at]);
                        self.labels[at] = self.scan.cells.len() as u32;
                    } else {
                        self.saddles.push(at as u32);
                    }
                }
            }
        }
        self.scan.peaks = self.scan.cells.len();
    }

    /// Position in the rimmed copy of the topmost neighbour of a cell that is no peak.
    #[inline]
    fn uphill(&self, at: usize) -> usize {
        if self.is_at_seam(at) {
            return self.uphill_by_index(at);
        }
        topmost_around(&self.keys, at, self.stride)
    }

    #[cold]
    fn uphill_by_index(&self, at: usize) -> usize {
        let (row, col) = self.grid.place(self.index(at));
        let top = self.grid.uphill(self.index(at)).expect("only cells below another are asked");
        let (dr, dc) = RING
            .into_iter()
            .find(|&offset| self.grid.step(row, col, offset) == Some(top))
            .expect("the topmost neighbour is a neighbour");
        at.wrapping_add_signed(dr * self.stride as isize + dc)
    }

    /// The node that the way up from a cell of the rimmed copy leads to.
    fn follow(&mut self, start: usize) -> Node {
        let mut at = start;
        self.way.clear();
        let label = loop {
            match self.labels[at] {
                0 => {
                    self.way.push(at);
                    at = self.uphill(at);
                }
                RIM => break self.portal(at),
                label => break label,
            }
        };
        for &at in &self.way {
            self.labels[at] = label;
        }
        label - 1
    }

    #[cold]
    fn portal(&mut self, at: usize) -> u32 {
        self.scan.cells.push(self.index(at));
        self.scan.keys.push(self.keys[at]);
        let label = self.scan.cells.len() as u32;
        self.labels[at] = label;
        label
    }

    fn find_passes(&mut self) {
        for i in 0..self.saddles.len() {
            let at = self.saddles[i] as usize;
            let (row, col) = (at / self.stride - 1, at % self.stride - 1);
            let mask = self.masks[row * self.tile.cols + col];
            let (mut tops, count) = self.tops_of_pieces(mask, at);
            let tops = &mut tops[..count];
            // From above to below; at most four, so the simplest sort.
            tops.sort_unstable_by(|p, q| (q.0, p.1).cmp(&(p.0, q.1)));
            let mut nodes = [NO_NODE; 4];
            let mut nth = 0;
            for k in 0..count {
                nodes[k] = self.follow(tops[k].2);
                if k > 0 && !nodes[..k].contains(&nodes[k]) {
                    let pass = Pass { saddle: self.cell(row, col), a: nodes[0], b: nodes[k], nth };
                    self.scan.passes.push((self.keys[at], pass));
                    nth += 1;
                }
            }
        }
    }

    /// Key, place in the order of indices, and position of the topmost cell of each piece of a mask, and how many
    /// pieces there are.
    #[inline]
    fn tops_of_pieces(&self, mask: u8, at: usize) -> ([(K, Cell, usize); 4], usize) {
        let at_seam = self.is_at_seam(at);
        let mut tops = [(K::VOID, Cell::MAX, 0); 4];
        let mut count = 0;
        for piece in pieces(mask) {
            if piece == 0 {
                break;
            }
            let top = &mut tops[count];
            count += 1;
            let mut rest = piece;
            while rest != 0 {
                let (dr, dc) = RING[rest.trailing_zeros() as usize];
                rest &= rest - 1;
                let next = at.wrapping_add_signed(dr * self.stride as isize + dc);
                // Positions sort as indices do, but for the seam.
                let index = if at_seam { self.index(next) } else { next as Cell };
                let key = self.keys[next];
                if key > top.0 || (key == top.0 && index < top.1) {
                    *top = (key, index, next);
                }
            }
        }
        (tops, count)
    }

    /// Index in the raster of a cell of the rimmed copy that is in the raster.
    #[inline]
    fn index(&self, at: usize) -> Cell {
        let (row, col) = (self.tile.row + at / self.stride - 1, self.tile.col + at % self.stride);
        let cols = self.grid.cols();
        // One to the left of the first column, or one to the right of the last, is across the seam.
        let col = if col == 0 { cols - 1 } else { col - 1 };
        self.grid.cell(row, if col == cols { 0 } else { col })
    }

    fn follow_ring(&mut self) {
        let mut ring = Vec::with_capacity(self.tile.ring_len());
        for (row, col) in self.tile.ring() {
            let at = (row + 1) * self.stride + col + 1;
            ring.push(if self.keys[at] == K::VOID { NO_NODE } else { self.follow(at) });
        }
        self.scan.ring = ring;
    }

    /// Finds the topmost cell beside the unknown of each basin: beside a void, or on the raster's border.
    fn find_frontier(&mut self, voids: bool) {
        let (tile, grid) = (self.tile, self.grid);
        let on_border = |row: usize, col: usize| {
            let (row, col) = (tile.row + row, tile.col + col);
            row == 0 || row + 1 == grid.rows() || (!grid.wraps() && (col == 0 || col + 1 == grid.cols()))
        };
        let mut found: Vec<(Node, K, Cell)> = Vec::new();
        if voids && !self.nodata_is_sea {
            for row in 0..tile.rows {
                for col in 0..tile.cols {
                    let at = (row + 1) * self.stride + col + 1;
                    if self.keys[at] == K::VOID {
                        continue;
                    }
                    let beside = (0..3).any(|i| {
                        let line = at + i * self.stride - self.stride;
                        self.keys[line - 1..=line + 1].contains(&K::VOID)
                    });
                    if beside {
                        found.push((self.follow(at), self.keys[at], self.cell(row, col)));
                    }
                }
            }
        } else {
            for (i, (row, col)) in tile.ring().enumerate() {
                let node = self.scan.ring[i];
                if node != NO_NODE && on_border(row, col) {
                    let at = (row + 1) * self.stride + col + 1;
                    found.push((node, self.keys[at], self.cell(row, col)));
                }
            }
        }
        found.sort_unstable_by(|p, q| (p.0, q.1, p.2).cmp(&(q.0, p.1, q.2)));
        found.dedup_by_key(|f| f.0);
        self.scan.frontier = found.into_iter().map(|(node, _, cell)| (node, cell)).collect();
    }

    /// Puts the passes into the order of the sweep: they were found in the order of their indices.
    fn sort_passes(&mut self) {
        let passes = &self.scan.passes;
        let mut ranks: Vec<K::Rank> = passes.iter().zip(0..).map(|(&(key, _), i)| key.falling(i)).collect();
        ranks.sort_unstable();
        self.scan.passes = ranks.iter().map(|&rank| passes[K::order_of(rank) as usize]).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_of_all_shapes() {
        for rows in 1..6 {
            for cols in 1..6 {
                let tile = Tile { row: 0, col: 0, rows, cols };
                let ring: Vec<_> = tile.ring().collect();
                assert_eq!(ring.len(), tile.ring_len(), "{rows} x {cols}");
                for (i, &(row, col)) in ring.iter().enumerate() {
                    assert_eq!(tile.ring_index(row, col), i, "{rows} x {cols} at {row}, {col}");
                }
            }
        }
    }
}
