//! Which neighbours are above a cell, for whole rows at once.

use crate::grid::Key;
use crate::grid::ring::is_in_pieces;

/// Writes, for each cell of the row in the middle, the mask (see [`crate::grid::ring`]) of the neighbours above it,
/// and 1 into `marks` where the cell is a peak or may be a saddle, else 0.
///
/// The three rows have a cell more than `masks` on either side. Voids get a full mask: neither peak nor saddle.
/// Plain loops over slices of one length, which compilers turn into vector instructions.
#[inline(never)]
pub(super) fn mark_row<K: Key>(north: &[K], here: &[K], south: &[K], masks: &mut [u8], marks: &mut [u8]) {
    let n = masks.len();
    // Neighbours with a lower index are above when as high, the others only when higher.
    or_above(
        &here[1..=n],
        [&north[..n], &north[1..=n], &north[2..n + 2], &here[..n]],
        |q, p| q >= p,
        [0, 1, 2, 7],
        masks,
    );
    or_above(
        &here[1..=n],
        [&here[2..n + 2], &south[2..n + 2], &south[1..=n], &south[..n]],
        |q, p| q > p,
        [3, 4, 5, 6],
        masks,
    );
    for (mask, &p) in masks.iter_mut().zip(&here[1..=n]) {
        *mask |= if p == K::VOID { u8::MAX } else { 0 };
    }
    for (mark, &mask) in marks.iter_mut().zip(masks.iter()) {
        *mark = u8::from(mask == 0) | u8::from(is_in_pieces(mask));
    }
}

/// Sets the bits of four neighbours; the first such call of a row finds the masks empty.
#[inline(always)]
fn or_above<K: Key>(here: &[K], others: [&[K]; 4], is_above: impl Fn(K, K) -> bool, bits: [u32; 4], masks: &mut [u8]) {
    let n = masks.len();
    let here = &here[..n];
    let [a, b, c, d] = others.map(|other| &other[..n]);
    for i in 0..n {
        let p = here[i];
        masks[i] |= u8::from(is_above(a[i], p)) << bits[0]
            | u8::from(is_above(b[i], p)) << bits[1]
            | u8::from(is_above(c[i], p)) << bits[2]
            | u8::from(is_above(d[i], p)) << bits[3];
    }
}
