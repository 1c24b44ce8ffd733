//! The ring of eight cells around a cell, as masks of the neighbours that are above it.
//!
//! Where such a mask falls into two pieces or more, the cell may join components of higher ground; with one piece it
//! never does, as the cells of a piece are neighbours of each other already.

/// Offsets (row, column) of the ring's cells: north-west first, clockwise. Bit `i` of a mask stands for `RING[i]`.
pub const RING: [(isize, isize); 8] = [(-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1), (1, 0), (1, -1), (0, -1)];

/// Bits of the corners.
const CORNERS: u8 = 0b0101_0101;

/// The first cell of each piece of a mask, going clockwise; empty for the full ring.
#[inline]
const fn starts(mask: u8) -> u8 {
    // North and east, say, touch at the corner between them whether or not that is in the mask.
    let filled = mask | (mask.rotate_left(1) & mask.rotate_right(1) & CORNERS);
    filled & !filled.rotate_left(1)
}

/// Whether the cells of a mask form two pieces or more.
#[inline]
pub const fn is_in_pieces(mask: u8) -> bool {
    let starts = starts(mask);
    starts & starts.wrapping_sub(1) != 0
}

/// The pieces of a mask, as masks; unused places are 0.
#[inline]
pub fn pieces(mask: u8) -> [u8; 4] {
    PIECES[mask as usize]
}

static PIECES: [[u8; 4]; 256] = all_pieces();

const fn all_pieces() -> [[u8; 4]; 256] {
    let mut table = [[0; 4]; 256];
    let mut mask = 0_u8;
    loop {
        let filled = mask | (mask.rotate_left(1) & mask.rotate_right(1) & CORNERS);
        let mut starts = starts(mask);
        if starts == 0 {
            table[mask as usize][0] = mask;
        }
        let mut count = 0;
        while starts != 0 {
            let mut next = starts & starts.wrapping_neg();
            starts &= starts - 1;
            let mut piece = 0;
            while filled & next != 0 && piece & next == 0 {
                piece |= next;
                next = next.rotate_left(1);
            }
            table[mask as usize][count] = piece & mask;
            count += 1;
        }
        if mask == u8::MAX {
            return table;
        }
        mask += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pieces by the obvious way: cells of the ring with Chebyshev distance 1 are joined.
    fn pieces_slowly(mask: u8) -> Vec<u8> {
        let mut label: Vec<usize> = (0..8).collect();
        for _ in 0..8 {
            for i in 0..8 {
                for j in 0..8 {
                    let (a, b) = (RING[i], RING[j]);
                    if mask >> i & mask >> j & 1 == 1 && (a.0 - b.0).abs().max((a.1 - b.1).abs()) <= 1 {
                        let low = label[i].min(label[j]);
                        label[i] = low;
                        label[j] = low;
                    }
                }
            }
        }
        let piece = |l: usize| (0..8).filter(|&i| mask >> i & 1 == 1 && label[i] == l).fold(0, |p, i| p | 1 << i);
        (0..8).map(piece).filter(|&p| p != 0).collect()
    }

    #[test]
    fn pieces_of_every_mask() {
        for mask in 0..=u8::MAX {
            let mut fast: Vec<u8> = pieces(mask).into_iter().filter(|&p| p != 0).collect();
            let mut slow = pieces_slowly(mask);
            assert_eq!(is_in_pieces(mask), slow.len() > 1, "mask {mask:08b}");
            fast.sort_unstable();
            slow.sort_unstable();
            assert_eq!(fast, slow, "mask {mask:08b}");
        }
    }
}
