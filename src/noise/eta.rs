//! One octave at many points: rows of [`COLS`] points, up to [`ROWS`] of them.
//!
//! Loops run over arrays of a known length, so that compilers make vectors of them; where a row has fewer points than
//! a vector, or a cell ends within one, what is computed beyond the end is overwritten or never read.

use super::Octave;
use super::gradient::{Cell, Fade, Line, direction, split};
use crate::rng::{cell_hash, row_hash};

/// Points of a row that go through all steps together.
pub const COLS: usize = 32;
/// Rows that go through an octave together.
pub(super) const ROWS: usize = 12;
/// Points of a vector, as many as the widest processors take at once.
const LANES: usize = 8;
/// Lattice cells along a row, up to which points share their cells.
const FEW: usize = 8;
/// A row with room for the lanes beyond its end.
const PADDED: usize = COLS + LANES;

/// eta at rows of points, with its derivatives by lattice units, and memory for the way there.
pub(super) struct Eta {
    pub(super) value: [[f64; PADDED]; ROWS],
    pub(super) dx: [[f64; PADDED]; ROWS],
    pub(super) dy: [[f64; PADDED]; ROWS],
    columns: Columns,
    lines: Lines,
}

/// Where columns of points lie in the lattice.
struct Columns {
    index: [u32; COLS],
    part: [f64; PADDED],
    share: [f64; PADDED],
    slope: [f64; PADDED],
}

/// Where rows of points lie in the lattice.
struct Heights {
    index: [u32; ROWS],
    part: [f64; ROWS],
    share: [f64; ROWS],
    slope: [f64; ROWS],
}

/// Neighbouring lattice columns at each of the rows.
struct Lines {
    g: [[f64; ROWS]; FEW + 1],
    s: [[f64; ROWS]; FEW + 1],
    g_slope: [[f64; ROWS]; FEW + 1],
    s_slope: [[f64; ROWS]; FEW + 1],
}

/// The gradients at the corners of a cell: left and right below, left and right above.
#[derive(Clone, Copy)]
struct Corners([(f64, f64); 4]);

impl Eta {
    /// The octave where `xs` and the first `rows` of the heights `ys` cross.
    #[inline(always)]
    pub(super) fn cross<const GRADIENT: bool>(
        &mut self,
        octave: &Octave,
        xs: &[f64; COLS],
        ys: &[f64; ROWS],
        rows: usize,
    ) {
        self.columns.set(octave, xs);
        let columns = &self.columns;
        let heights = Heights::of(octave, ys);
        // Points go left or right.
        let (first, last) = (columns.index[0], columns.index[COLS - 1]);
        let base = if (last.wrapping_sub(first) as i32) < 0 { last } else { first };
        let furthest = columns.index.iter().fold(0, |most, index| index.wrapping_sub(base).max(most));
        if (furthest as usize) < FEW {
            self.few::<GRADIENT>(octave.seed, (base, furthest as usize + 1), &heights, rows);
        } else {
            self.many::<GRADIENT>(octave.seed, &heights, rows);
        }
    }

    /// Points that share a few cells, counted from `base`, along the rows.
    #[inline(always)]
    fn few<const GRADIENT: bool>(&mut self, seed: u32, (base, cells): (u32, usize), heights: &Heights, rows: usize) {
        let Self { value, dx, dy, columns, lines } = self;
        let mut from = 0;
        while from < rows {
            let index = heights.index[from];
            let to = from + heights.index[from..rows].iter().take_while(|&&other| other == index).count();
            let (near, far) = (row_hash(seed, index), row_hash(seed, index.wrapping_add(1)));
            for k in 0..=cells {
                let column = base.wrapping_add(k as u32);
                let (below, above) = (direction(cell_hash(near, column)), direction(cell_hash(far, column)));
                if to - from == ROWS {
                    lines.set::<GRADIENT>(k, (below, above), heights, 0, ROWS);
                } else {
                    lines.set::<GRADIENT>(k, (below, above), heights, from, to);
                }
            }
            from = to;
        }
        let mut from = 0;
        while from < COLS {
            let index = columns.index[from];
            let to = from + columns.index[from..].iter().take_while(|&&other| other == index).count();
            let left = (index.wrapping_sub(base) as usize).min(FEW - 1);
            for r in 0..rows {
                let cell = Cell::between(lines.at(left, r), lines.at(left + 1, r));
                let mut out = [&mut value[r], &mut dx[r], &mut dy[r]];
                if to - from == COLS {
                    columns.lanes::<GRADIENT, COLS>(&cell, 0, &mut out);
                    continue;
                }
                // The next cell overwrites what lies beyond the end of this one.
                let mut at = from;
                while at < to {
                    columns.lanes::<GRADIENT, LANES>(&cell, at, &mut out);
                    at += LANES;
                }
            }
            from = to;
        }
    }

    /// Points each of which has a cell of its own.
    #[inline(always)]
    fn many<const GRADIENT: bool>(&mut self, seed: u32, heights: &Heights, rows: usize) {
        let columns = &self.columns;
        let mut corners = [[0.0; COLS]; 8];
        for r in 0..rows {
            if r == 0 || heights.index[r] != heights.index[r - 1] {
                corners = gradients(seed, &columns.index, heights.index[r]);
            }
            let [ax, ay, bx, by, cx, cy, dx, dy] = &corners;
            let v = heights.at(r);
            for k in 0..COLS {
                let left = Line::between((ax[k], ay[k]), (cx[k], cy[k]), &v);
                let right = Line::between((bx[k], by[k]), (dx[k], dy[k]), &v);
                let u = Fade { part: columns.part[k], share: columns.share[k], slope: columns.slope[k] };
                let found = Cell::between(left, right).at::<GRADIENT>(&u);
                self.value[r][k] = found.value;
                if GRADIENT {
                    (self.dx[r][k], self.dy[r][k]) = (found.dx, found.dy);
                }
            }
        }
    }

    /// The octave at rows of any points.
    #[inline(always)]
    pub(super) fn scatter<const GRADIENT: bool>(&mut self, octave: &Octave, xs: &[[f64; COLS]], ys: &[[f64; COLS]]) {
        let mut known = None;
        for (r, (xs, ys)) in xs.iter().zip(ys).enumerate() {
            for at in (0..COLS).step_by(LANES) {
                let (xs, ys) = (lanes(xs, at), lanes(ys, at));
                let found = group::<GRADIENT>(octave, xs, ys, &mut known);
                *lanes_mut(&mut self.value[r], at) = found[0];
                if GRADIENT {
                    *lanes_mut(&mut self.dx[r], at) = found[1];
                    *lanes_mut(&mut self.dy[r], at) = found[2];
                }
            }
        }
    }
}

/// The noise at a few points, with its derivatives; `known` is the cell met last, with its corners.
#[inline(always)]
fn group<const GRADIENT: bool>(
    octave: &Octave,
    xs: &[f64; LANES],
    ys: &[f64; LANES],
    known: &mut Option<(u32, u32, Corners)>,
) -> [[f64; LANES]; 3] {
    let (mut columns, mut rows) = ([0; LANES], [0; LANES]);
    let (mut us, mut vs) = ([0.0; LANES], [0.0; LANES]);
    for k in 0..LANES {
        (us[k], columns[k]) = split(xs[k] * octave.frequency + octave.shift[0]);
        (vs[k], rows[k]) = split(ys[k] * octave.frequency + octave.shift[1]);
    }
    let (column, row) = (columns[0], rows[0]);
    let mut other = 0;
    for k in 0..LANES {
        other |= (columns[k] ^ column) | (rows[k] ^ row);
    }
    if other == 0 {
        let corners = match known {
            Some((a, b, corners)) if (*a, *b) == (column, row) => *corners,
            _ => Corners::of(octave.seed, column, row),
        };
        *known = Some((column, row, corners));
        return mix::<GRADIENT>(
            &us,
            &vs,
            #[inline(always)]
            |_| corners,
        );
    }
    let mut corners = [[0.0; LANES]; 8];
    let (mut near, mut far) = ([0; LANES], [0; LANES]);
    for k in 0..LANES {
        (near[k], far[k]) = (row_hash(octave.seed, rows[k]), row_hash(octave.seed, rows[k].wrapping_add(1)));
    }
    for k in 0..LANES {
        let next = columns[k].wrapping_add(1);
        (corners[0][k], corners[1][k]) = direction(cell_hash(near[k], columns[k]));
        (corners[2][k], corners[3][k]) = direction(cell_hash(near[k], next));
        (corners[4][k], corners[5][k]) = direction(cell_hash(far[k], columns[k]));
        (corners[6][k], corners[7][k]) = direction(cell_hash(far[k], next));
    }
    let [ax, ay, bx, by, cx, cy, dx, dy] = &corners;
    mix::<GRADIENT>(
        &us,
        &vs,
        #[inline(always)]
        |k| Corners([(ax[k], ay[k]), (bx[k], by[k]), (cx[k], cy[k]), (dx[k], dy[k])]),
    )
}

/// The noise at places in cells with given corners.
#[inline(always)]
fn mix<const GRADIENT: bool>(
    us: &[f64; LANES],
    vs: &[f64; LANES],
    corners: impl Fn(usize) -> Corners,
) -> [[f64; LANES]; 3] {
    let mut found = [[0.0; LANES]; 3];
    for k in 0..LANES {
        let Corners([a, b, c, d]) = corners(k);
        let v = Fade::of(vs[k]);
        let cell = Cell::between(Line::between(a, c, &v), Line::between(b, d, &v));
        let n = cell.at::<GRADIENT>(&Fade::of(us[k]));
        found[0][k] = n.value;
        if GRADIENT {
            (found[1][k], found[2][k]) = (n.dx, n.dy);
        }
    }
    found
}

/// x and y of the gradients left and right below, left and right above, for each of the columns.
#[inline(always)]
fn gradients(seed: u32, columns: &[u32; COLS], row: u32) -> [[f64; COLS]; 8] {
    let mut found = [[0.0; COLS]; 8];
    for (above, pairs) in found.chunks_exact_mut(4).enumerate() {
        let row = row_hash(seed, row.wrapping_add(above as u32));
        for (right, pair) in pairs.chunks_exact_mut(2).enumerate() {
            for k in 0..COLS {
                let (x, y) = direction(cell_hash(row, columns[k].wrapping_add(right as u32)));
                (pair[0][k], pair[1][k]) = (x, y);
            }
        }
    }
    found
}

impl Corners {
    #[inline(always)]
    fn of(seed: u32, column: u32, row: u32) -> Self {
        let (near, far) = (row_hash(seed, row), row_hash(seed, row.wrapping_add(1)));
        let next = column.wrapping_add(1);
        Self([
            direction(cell_hash(near, column)),
            direction(cell_hash(near, next)),
            direction(cell_hash(far, column)),
            direction(cell_hash(far, next)),
        ])
    }
}

impl Default for Eta {
    fn default() -> Self {
        let zeros = [[0.0; PADDED]; ROWS];
        let row = [0.0; PADDED];
        let lines = [[0.0; ROWS]; FEW + 1];
        Self {
            value: zeros,
            dx: zeros,
            dy: zeros,
            columns: Columns { index: [0; COLS], part: row, share: row, slope: row },
            lines: Lines { g: lines, s: lines, g_slope: lines, s_slope: lines },
        }
    }
}

impl Columns {
    #[inline(always)]
    fn set(&mut self, octave: &Octave, xs: &[f64; COLS]) {
        for (k, x) in xs.iter().enumerate() {
            let (part, index) = split(x * octave.frequency + octave.shift[0]);
            let fade = Fade::of(part);
            self.index[k] = index;
            (self.part[k], self.share[k], self.slope[k]) = (part, fade.share, fade.slope);
        }
    }

    /// Points of one cell, and what comes after them: values, and derivatives by x and by y.
    #[inline(always)]
    fn lanes<const GRADIENT: bool, const N: usize>(&self, cell: &Cell, at: usize, out: &mut [&mut [f64; PADDED]; 3]) {
        let [value, dx, dy] = out;
        let (part, share): (&[f64; N], &[f64; N]) = (lanes(&self.part, at), lanes(&self.share, at));
        let value: &mut [f64; N] = lanes_mut(value, at);
        for k in 0..N {
            value[k] = cell.at::<false>(&Fade { part: part[k], share: share[k], slope: 0.0 }).value;
        }
        if GRADIENT {
            let slope: &[f64; N] = lanes(&self.slope, at);
            let (dx, dy): (&mut [f64; N], &mut [f64; N]) = (lanes_mut(dx, at), lanes_mut(dy, at));
            for k in 0..N {
                let found = cell.at::<true>(&Fade { part: part[k], share: share[k], slope: slope[k] });
                (dx[k], dy[k]) = (found.dx, found.dy);
            }
        }
    }
}

impl Heights {
    #[inline(always)]
    fn of(octave: &Octave, ys: &[f64; ROWS]) -> Self {
        let zeros = [0.0; ROWS];
        let mut found = Self { index: [0; ROWS], part: zeros, share: zeros, slope: zeros };
        for (k, y) in ys.iter().enumerate() {
            let (part, index) = split(y * octave.frequency + octave.shift[1]);
            let fade = Fade::of(part);
            found.index[k] = index;
            (found.part[k], found.share[k], found.slope[k]) = (part, fade.share, fade.slope);
        }
        found
    }

    #[inline(always)]
    fn at(&self, row: usize) -> Fade {
        Fade { part: self.part[row], share: self.share[row], slope: self.slope[row] }
    }
}

impl Lines {
    /// Sets a column at rows from one to another, which lie between two rows of the lattice.
    #[inline(always)]
    fn set<const GRADIENT: bool>(
        &mut self,
        column: usize,
        (below, above): ((f64, f64), (f64, f64)),
        heights: &Heights,
        from: usize,
        to: usize,
    ) {
        let (g, s) = (&mut self.g[column], &mut self.s[column]);
        let (g_slope, s_slope) = (&mut self.g_slope[column], &mut self.s_slope[column]);
        for r in from..to.min(ROWS) {
            let line = Line::between(below, above, &heights.at(r));
            (g[r], s[r]) = (line.g, line.s);
            if GRADIENT {
                (g_slope[r], s_slope[r]) = (line.g_slope, line.s_slope);
            }
        }
    }

    #[inline(always)]
    fn at(&self, k: usize, row: usize) -> Line {
        Line { g: self.g[k][row], s: self.s[k][row], g_slope: self.g_slope[k][row], s_slope: self.s_slope[k][row] }
    }
}

/// The lanes of a row from an index on.
#[inline(always)]
fn lanes<const WHOLE: usize, const N: usize>(row: &[f64; WHOLE], at: usize) -> &[f64; N] {
    row[at..].first_chunk().expect("rows have room for whole vectors")
}

#[inline(always)]
fn lanes_mut<const WHOLE: usize, const N: usize>(row: &mut [f64; WHOLE], at: usize) -> &mut [f64; N] {
    row[at..].first_chunk_mut().expect("rows have room for whole vectors")
}
