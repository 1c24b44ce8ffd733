//! A quarter of a level's cells, with a frame of copies around them so that nobody asks for borders.
//!
//! The cells of level `l` fall apart into four planes: **A** (even row, even column: the next coarser level), **C**
//! (odd, odd: the centres), **H** (even row, odd column: between two A's of a row) and **V** (odd row, even column).

/// Cells of the frame on each side.
pub(super) const FRAME: usize = 4;

/// A small raster with its frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Plane<T> {
    pub(super) width: usize,
    pub(super) height: usize,
    stride: usize,
    cells: Vec<T>,
}

impl<T: Copy + Default> Plane<T> {
    /// A plane of zeros.
    pub(super) fn new(width: usize, height: usize) -> Self {
        let stride = width + 2 * FRAME;
        Self { width, height, stride, cells: vec![T::default(); stride * (height + 2 * FRAME)] }
    }

    /// Whether there are no cells.
    pub(super) fn is_empty(&self) -> bool {
        self.width == 0 || self.height == 0
    }

    fn start(&self, row: isize) -> usize {
        (row + FRAME as isize) as usize * self.stride
    }

    /// `count` cells of a row from a column on; both may lie in the frame.
    #[inline(always)]
    pub(super) fn run(&self, row: isize, col: isize, count: usize) -> &[T] {
        let start = self.start(row) + (col + FRAME as isize) as usize;
        &self.cells[start..start + count]
    }

    /// The cells of a row.
    pub(super) fn row(&self, row: usize) -> &[T] {
        self.run(row as isize, 0, self.width)
    }

    /// A row with its frame; the row may lie in the frame.
    pub(super) fn framed_row(&self, row: isize) -> &[T] {
        let start = self.start(row);
        &self.cells[start..start + self.stride]
    }

    /// A row with its frame, to write to.
    pub(super) fn framed_row_mut(&mut self, row: isize) -> &mut [T] {
        let start = self.start(row);
        &mut self.cells[start..start + self.stride]
    }

    /// The cells of a row, to write to.
    pub(super) fn row_mut(&mut self, row: usize) -> &mut [T] {
        let start = self.start(row as isize) + FRAME;
        &mut self.cells[start..start + self.width]
    }

    /// Fills the frame with copies of the nearest cells.
    pub(super) fn close(&mut self) {
        if self.is_empty() {
            return;
        }
        for row in 0..self.height {
            let (width, cells) = (self.width, self.framed_row_mut(row as isize));
            let (first, last) = (cells[FRAME], cells[FRAME + width - 1]);
            cells[..FRAME].fill(first);
            cells[FRAME + width..].fill(last);
        }
        let (first, last) = (self.start(0), self.start(self.height as isize - 1));
        for row in 0..FRAME {
            self.cells.copy_within(first..first + self.stride, row * self.stride);
            self.cells.copy_within(last..last + self.stride, (self.height + FRAME + row) * self.stride);
        }
    }

    /// Every second cell of every second row of `cells` (rows of `width`), beginning with `(row, col)`.
    pub(super) fn quarter(cells: &[T], width: usize, row: usize, col: usize) -> Self {
        let height = cells.len() / width.max(1);
        let mut plane = Self::new((width + 1 - col) / 2, (height + 1 - row) / 2);
        for (index, source) in cells.chunks_exact(width).skip(row).step_by(2).enumerate() {
            let target = plane.row_mut(index);
            for (target, &value) in target.iter_mut().zip(source[col..].iter().step_by(2)) {
                *target = value;
            }
        }
        plane
    }

    /// The level that the four planes make up, framed.
    pub(super) fn woven(planes: [&Self; 4]) -> Self {
        let [a, _, h, v] = planes;
        let mut plane = Self::new(a.width + h.width, a.height + v.height);
        let width = plane.width;
        for row in 0..plane.height {
            let start = plane.start(row as isize) + FRAME;
            Self::weave(planes, row, &mut plane.cells[start..start + width]);
        }
        plane.close();
        plane
    }

    /// The rows of the level that the four planes make up, one after the other.
    pub(super) fn woven_rows(planes: [&Self; 4], mut take: impl FnMut(&[T])) {
        let [a, _, h, v] = planes;
        let mut cells = vec![T::default(); a.width + h.width];
        for row in 0..a.height + v.height {
            Self::weave(planes, row, &mut cells);
            take(&cells);
        }
    }

    /// One row of the level that the four planes make up.
    #[inline]
    fn weave([a, c, h, v]: [&Self; 4], row: usize, cells: &mut [T]) {
        let (even, odd) = if row.is_multiple_of(2) { (a, h) } else { (v, c) };
        let (even, odd) = (even.row(row / 2), if odd.is_empty() { &[] } else { odd.row(row / 2) });
        let (pairs, last) = cells.as_chunks_mut::<2>();
        for ((pair, &even), &odd) in pairs.iter_mut().zip(even).zip(odd) {
            *pair = [even, odd];
        }
        if let (Some(cell), Some(&even)) = (last.first_mut(), even.last()) {
            *cell = even;
        }
    }

    /// A plane of the given cells, framed.
    pub(super) fn framed(cells: &[T], width: usize) -> Self {
        let mut plane = Self::new(width, cells.len() / width.max(1));
        for (row, source) in cells.chunks_exact(width.max(1)).enumerate() {
            plane.row_mut(row).copy_from_slice(source);
        }
        plane.close();
        plane
    }
}
