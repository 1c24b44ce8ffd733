//! Which atoms make up the patches of a tile, and how much of each.

use super::super::binary::{BinaryDecoder, BinaryEncoder};
use super::super::mask::Bits;
use super::numbers::{Even, Magnitude, Tree, bit_length};
use crate::error::{Error, ErrorKind, Result};

/// Most terms of a patch.
pub const MAX_TERMS: usize = 255;
/// Terms that differ in what is expected of them: the first, the second, the third, all others.
const TURNS: usize = 4;

/// A part of a patch: an atom times a coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Term {
    /// Number of the atom.
    pub atom: u32,
    /// The coefficient in steps; not 0.
    pub part: i32,
}

/// Chances of everything.
struct Chances {
    count: Tree,
    atom: [Tree; 2],
    /// Magnitude of the first coefficient, by those of the patches around.
    first: Vec<Magnitude>,
    /// By how much a coefficient is less than the one before, by that one and its turn.
    fall: Vec<Magnitude>,
}

impl Chances {
    fn new(atoms: u32, sparsity: usize) -> Self {
        let width = bit_length(atoms - 1);
        Self {
            count: Tree::new(bit_length(sparsity as u32)),
            atom: [Tree::new(width), Tree::new(width)],
            first: vec![Magnitude::new(); 33],
            fall: vec![Magnitude::new(); 33 * TURNS],
        }
    }
}

/// The terms of the patches of a tile: how many each patch has, and all of them one behind the other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Terms {
    pub(super) counts: Vec<u32>,
    pub(super) terms: Vec<Term>,
}

/// Brings terms into the order in which they are written: greater coefficients first, lower atoms first among equals.
pub(super) fn sort(terms: &mut [Term]) {
    terms.sort_unstable_by_key(|term| (u32::MAX - term.part.unsigned_abs(), term.atom));
}

/// Codes the terms of patches row by row; `next` gives the terms to write, or nothing when reading. False when the
/// bits are not in order.
fn code<B: Bits>(
    bits: &mut B,
    (across, present): (usize, &[bool]),
    (atoms, sparsity): (u32, usize),
    truth: Option<&Terms>,
    found: &mut Terms,
    mut more: impl FnMut(&B) -> bool,
) -> bool {
    let mut chances = Chances::new(atoms, sparsity);
    // The first coefficient of each patch of the row above and of this one so far.
    let mut firsts = vec![0_u32; across];
    let mut at = 0;
    for (place, _) in present.iter().enumerate().filter(|&(_, &present)| present) {
        if !more(bits) {
            return false;
        }
        let patch = found.counts.len();
        let wanted = truth.map_or(0, |truth| truth.counts[patch]);
        let count = chances.count.code(bits, wanted);
        if count as usize > sparsity {
            return false;
        }
        let col = place % across;
        let west = if col > 0 { firsts[col - 1] } else { firsts[col] };
        let around = bit_length(west.midpoint(firsts[col]));
        let begin = found.terms.len();
        let mut last = Term { atom: 0, part: 0 };
        for turn in 0..count as usize {
            let term = truth.map_or(last, |truth| truth.terms[at + turn]);
            let atom = chances.atom[usize::from(turn > 0)].code(bits, term.atom);
            let before = last.part.unsigned_abs();
            let size = term.part.unsigned_abs();
            let size = match turn {
                0 => chances.first[around as usize].code(bits, size.wrapping_sub(1)).wrapping_add(1),
                _ => {
                    let class = bit_length(before) as usize * TURNS + turn.min(TURNS) - 1;
                    before.wrapping_sub(chances.fall[class].code(bits, before.wrapping_sub(size)))
                }
            };
            let negative = bits.even(term.part < 0);
            let is_sorted = turn == 0 || size < before || (size == before && atom > last.atom);
            if atom >= atoms || size == 0 || size > i32::MAX as u32 || !is_sorted {
                return false;
            }
            // Atoms that come twice need not be told apart by a set: there are few.
            if found.terms[begin..].iter().any(|term| term.atom == atom) {
                return false;
            }
            last = Term { atom, part: if negative { -(size as i32) } else { size as i32 } };
            found.terms.push(last);
        }
        at += count as usize;
        firsts[col] = if count > 0 { found.terms[begin].part.unsigned_abs() } else { 0 };
        found.counts.push(count);
    }
    true
}

/// The terms of those patches of a tile that are there, as bytes.
///
/// # Errors
/// `Usage` when terms are out of order, out of range, or too many.
pub(super) fn encode_terms(
    terms: &Terms,
    (across, present): (usize, &[bool]),
    (atoms, sparsity): (u32, usize),
) -> Result<Vec<u8>> {
    let patches = present.iter().filter(|&&present| present).count();
    let all: usize = terms.counts.iter().map(|&count| count as usize).sum();
    let fits = terms.counts.iter().all(|&count| count as usize <= sparsity)
        && terms.terms.iter().all(|term| term.atom < atoms && term.part != 0 && term.part != i32::MIN);
    let mut bits = BinaryEncoder::new();
    let (shape, limits) = ((across, present), (atoms, sparsity));
    let whole = patches == terms.counts.len() && all == terms.terms.len() && fits;
    if !whole || !code(&mut bits, shape, limits, Some(terms), &mut Terms::default(), |_| true) {
        return Err(Error::usage("the terms of a patch are out of order, out of range or too many"));
    }
    Ok(bits.finish())
}

/// The terms of those patches of a tile that are there.
///
/// # Errors
/// [`ErrorKind::Corrupt`] when the bytes are no such terms.
pub(super) fn decode_terms(
    bytes: &[u8],
    (across, present): (usize, &[bool]),
    (atoms, sparsity): (u32, usize),
) -> Result<Terms> {
    let mut found = Terms::default();
    let mut bits = BinaryDecoder::new(bytes);
    let whole = code(&mut bits, (across, present), (atoms, sparsity), None, &mut found, |bits| !bits.is_beyond());
    if !whole || !bits.is_done() {
        return Err(Error::new(ErrorKind::Corrupt, "the coefficients' bytes are not what an encoder writes"));
    }
    Ok(found)
}
