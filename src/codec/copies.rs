//! Cells that repeat one of their nearest four to the last bit, as resampled DEMs have them: of true floats they are
//! worth a plane of their own, since nothing else that is known of a float's last bits helps.
//!
//! Before a pass, its copies are told cell by cell with adaptive bits; they take no residual.

use super::binary::{Adaptive, BinaryEncoder};
use super::mask::Bits;
use super::plane::Plane;
use super::taps::{Known, Pass};
use super::word::Word;

/// The mark of a void in a plane of marks.
pub(super) const VOID: u8 = 1;
/// The mark of a copy.
pub(super) const COPY: u8 = 2;

/// Cells of a pass that take no residual.
#[derive(Clone, Copy, Debug)]
pub(super) struct Still<'a, W> {
    /// Which: [`VOID`], [`COPY`], or 0 for a cell with a residual.
    pub(super) marks: &'a Plane<u8>,
    /// What copies hold, where there are any.
    pub(super) copies: Option<&'a Plane<W>>,
}

/// Copies of a pass.
pub(super) struct Copies<W> {
    marks: Plane<u8>,
    cells: Plane<W>,
}

impl<W> Copies<W> {
    /// As cells without residual.
    pub(super) fn still(&self) -> Still<'_, W> {
        Still { marks: &self.marks, copies: Some(&self.cells) }
    }
}

/// Contexts of one segment.
#[derive(Clone, Debug)]
pub(super) struct Contexts {
    /// Whether a cell is a copy: by pass, by how the nearest four are alike, and by the cells above and to the left.
    copy: [[Adaptive; 20]; 3],
    /// Whether it is a copy of the first, the second, the third of the values.
    which: [[Adaptive; 3]; 5],
}

impl Contexts {
    /// At the beginning of a segment.
    pub(super) fn new() -> Self {
        Self { copy: [[Adaptive::new(); 20]; 3], which: [[Adaptive::new(); 3]; 5] }
    }
}

/// The values of four cells without repetition, the most frequent first and otherwise in their order; how many there
/// are; and a number from 0 to 4 for how they are alike: all differ, two alike, two and two, three, all four.
#[inline]
fn values_of<W: Word>(near: [W; 4]) -> ([W; 4], usize, usize) {
    let [a, b, c, d] = near;
    if !((a == b) | (a == c) | (a == d) | (b == c) | (b == d) | (c == d)) {
        // By far the most frequent.
        return (near, 4, 0);
    }
    let (mut values, mut counts, mut count) = ([near[0]; 4], [0u8; 4], 0);
    for cell in near {
        let place = (0..count).find(|&k| values[k] == cell).unwrap_or(count);
        values[place] = cell;
        counts[place] += 1;
        count = count.max(place + 1);
    }
    let most = (0..count).fold(0, |most, k| if counts[k] > counts[most] { k } else { most });
    values[..=most].rotate_right(1);
    let alike = match (count, counts[most]) {
        (1, _) => 4,
        (2, 3) => 3,
        (2, _) => 2,
        (3, _) => 1,
        _ => 0,
    };
    (values, count, alike)
}

/// Codes the copies of a pass; `truth` is what to write, or nothing when reading.
pub(super) fn code_copies<B: Bits, W: Word>(
    bits: &mut B,
    contexts: &mut Contexts,
    pass: Pass,
    known: Known<'_, W>,
    (width, height): (usize, usize),
    void: Option<&Plane<u8>>,
    truth: Option<&Plane<W>>,
) -> Copies<W> {
    let mut marks = Plane::<u8>::new(width, height);
    let mut cells = Plane::<W>::new(width, height);
    let taps = pass.taps();
    let copied = &mut contexts.copy[pass as usize];
    let mut above = vec![0u8; width];
    for row in 0..height {
        // The nearest four are never in the pass's own plane.
        let near: [&[W]; 4] = std::array::from_fn(|k| known.run(known.a, taps[k], row, width));
        let void = void.map(|void| void.row(row));
        let truth = truth.map(|truth| truth.row(row));
        let (line, made) = (marks.row_mut(row), cells.row_mut(row));
        let mut left = 0;
        for col in 0..width {
            if void.is_some_and(|void| void[col] != 0) {
                (line[col], left) = (VOID, 0);
                continue;
            }
            let (values, count, alike) = values_of(near.map(|run| run[col]));
            let place = truth.and_then(|truth| values[..count].iter().position(|&value| value == truth[col]));
            let context = alike * 4 + usize::from(above[col] == COPY) * 2 + usize::from(left == COPY);
            left = 0;
            if bits.bit(place.is_some(), &mut copied[context]) {
                let place = place.unwrap_or(0);
                let which = &mut contexts.which[alike];
                // The last one needs no bit.
                let found = (0..count - 1).find(|&k| bits.bit(place == k, &mut which[k])).unwrap_or(count - 1);
                (line[col], made[col], left) = (COPY, values[found], COPY);
            }
        }
        above.copy_from_slice(line);
    }
    Copies { marks, cells }
}

/// Copies of a segment while they are written.
pub(super) struct Writing {
    pub(super) bits: BinaryEncoder,
    pub(super) contexts: Contexts,
}

impl Writing {
    /// Nothing yet.
    pub(super) fn new() -> Self {
        Self { bits: BinaryEncoder::new(), contexts: Contexts::new() }
    }
}

/// Whether so many cells of rows of a width repeat one of their neighbours that telling so is worth it.
pub(super) fn are_frequent(xs: &[i64], width: usize) -> bool {
    let height = xs.len() / width;
    let (mut copies, mut seen) = (0usize, 0usize);
    for row in (1..height.saturating_sub(1)).step_by((height / 128).max(1)) {
        for col in 1..width.saturating_sub(1) {
            let at = row * width + col;
            seen += 1;
            copies += usize::from([at - width, at + width, at - 1, at + 1].iter().any(|&near| xs[near] == xs[at]));
        }
    }
    copies * 40 > seen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_in_the_order_of_their_number() {
        assert_eq!(values_of([5, 6, 7, 8]), ([5, 6, 7, 8], 4, 0));
        assert_eq!(values_of([5, 6, 7, 6]).0[..3], [6, 5, 7]);
        assert_eq!(values_of([5, 6, 7, 7]).0[..3], [7, 5, 6]);
        assert_eq!(values_of([5, 6, 6, 5]).0[..2], [5, 6]);
        assert_eq!(values_of([5, 6, 6, 6]), ([6, 5, 5, 5], 2, 3));
        assert_eq!(values_of([5, 5, 5, 5]), ([5, 5, 5, 5], 1, 4));
    }
}
