//! Which cells a prediction looks at.
//!
//! A level is decoded in three passes, C, H and V. Positions are rows and columns of the planes, relative to the cell
//! that is predicted; the four nearest cells come first.

use super::plane::{FRAME, Plane};

/// One of the three passes of a level, named after the plane that it fills.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pass {
    /// The centres, from A alone.
    C,
    /// Between two A's of a row; C is known.
    H,
    /// Between two A's of a column; C and H are known.
    V,
}

/// The passes in their order.
pub(super) const PASSES: [Pass; 3] = [Pass::C, Pass::H, Pass::V];

/// A plane that a tap reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// Plane A.
    A,
    /// Plane C.
    C,
    /// Plane H.
    H,
    /// The plane of the pass itself: rows above.
    Own,
}

/// Plane, row and column.
pub(super) type Tap = (Source, i8, i8);

/// Most taps of a pass, the serial ones included.
pub(super) const MAX_TAPS: usize = 26;
/// The last taps of each list: the two cells to the left in the pass's own plane; 0 unless the pass is serial.
pub(super) const SERIAL_TAPS: usize = 2;

use Source::{A, C, H, Own};

const C_TAPS: [Tap; 20] = [
    (A, 0, 0),
    (A, 0, 1),
    (A, 1, 0),
    (A, 1, 1),
    (A, -1, -1),
    (A, -1, 0),
    (A, -1, 1),
    (A, -1, 2),
    (A, 0, -1),
    (A, 0, 2),
    (A, 1, -1),
    (A, 1, 2),
    (A, 2, -1),
    (A, 2, 0),
    (A, 2, 1),
    (A, 2, 2),
    (Own, -1, -1),
    (Own, -1, 0),
    (Own, -1, 1),
    (Own, -2, 0),
];

const H_TAPS: [Tap; 20] = [
    (A, 0, 0),
    (A, 0, 1),
    (C, -1, 0),
    (C, 0, 0),
    (A, 0, -1),
    (A, 0, 2),
    (C, -2, 0),
    (C, 1, 0),
    (A, -1, 0),
    (A, -1, 1),
    (A, 1, 0),
    (A, 1, 1),
    (C, -1, -1),
    (C, -1, 1),
    (C, 0, -1),
    (C, 0, 1),
    (Own, -1, -1),
    (Own, -1, 0),
    (Own, -1, 1),
    (Own, -2, 0),
];

const V_TAPS: [Tap; 24] = [
    (A, 0, 0),
    (A, 1, 0),
    (C, 0, -1),
    (C, 0, 0),
    (A, -1, 0),
    (A, 2, 0),
    (C, 0, -2),
    (C, 0, 1),
    (A, 0, -1),
    (A, 0, 1),
    (A, 1, -1),
    (A, 1, 1),
    (C, -1, -1),
    (C, -1, 0),
    (C, 1, -1),
    (C, 1, 0),
    (H, 0, -1),
    (H, 0, 0),
    (H, 1, -1),
    (H, 1, 0),
    (Own, -1, -1),
    (Own, -1, 0),
    (Own, -1, 1),
    (Own, -2, 0),
];

impl Pass {
    /// The taps, without the serial ones.
    pub(super) fn taps(self) -> &'static [Tap] {
        match self {
            Self::C => &C_TAPS,
            Self::H => &H_TAPS,
            Self::V => &V_TAPS,
        }
    }

    /// Number of taps with the serial ones.
    pub(super) fn tap_count(self) -> usize {
        self.taps().len() + SERIAL_TAPS
    }

    /// Row and column of the plane's first cell within the level.
    pub(super) fn origin(self) -> (usize, usize) {
        match self {
            Self::C => (1, 1),
            Self::H => (0, 1),
            Self::V => (1, 0),
        }
    }

    /// Groups of errors that the expected error is made of, apart from those of the pass's own plane.
    pub(super) fn error_groups(self) -> &'static [&'static [Tap]] {
        match self {
            Self::C => &[&[(A, 0, 0), (A, 0, 1), (A, 1, 0), (A, 1, 1)]],
            Self::H => {
                &[&[(A, 0, 0), (A, 0, 1)], &[(C, -1, 0), (C, 0, 0)], &[(A, -1, 0), (A, -1, 1), (A, 1, 0), (A, 1, 1)]]
            }
            Self::V => {
                &[&[(A, 0, 0), (A, 1, 0)], &[(C, 0, -1), (C, 0, 0)], &[(H, 0, -1), (H, 0, 0), (H, 1, -1), (H, 1, 0)]]
            }
        }
    }
}

/// The planes that are known when a pass begins; an empty C or H is replaced by A.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known<'a, T> {
    /// Plane A.
    pub(super) a: &'a Plane<T>,
    /// Plane C; any plane in the pass that makes it.
    pub(super) c: &'a Plane<T>,
    /// Plane H; any plane before it is made.
    pub(super) h: &'a Plane<T>,
}

impl<'a, T: Copy + Default> Known<'a, T> {
    /// The cells of a row that a tap reads, one for each column of the pass.
    #[inline(always)]
    pub(super) fn run<'b>(&self, own: &'b Plane<T>, tap: Tap, row: usize, count: usize) -> &'b [T]
    where
        'a: 'b,
    {
        let plane: &'b Plane<T> = match tap.0 {
            A => self.a,
            C if self.c.is_empty() => self.a,
            C => self.c,
            H if self.h.is_empty() => self.a,
            H => self.h,
            Own => own,
        };
        plane.run(row as isize + isize::from(tap.1), isize::from(tap.2), count)
    }
}

const _: () = assert!(FRAME >= 3, "taps reach two cells beyond a plane, and planes differ by one cell");
