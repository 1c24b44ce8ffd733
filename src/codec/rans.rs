//! The entropy coder: range asymmetric numeral systems with fixed tables (Duda 2013, arXiv:1311.2540), several
//! interleaved states, and alias tables (Walker 1974), so that a table of 64 symbols takes 512 bytes whatever its
//! precision.
//!
//! A state is a 32-bit number of at least [`LOW`]. Symbol `i` of a segment belongs to state `i mod lanes`.

use crate::error::{Error, ErrorKind, Result};

/// Number of symbols of every table.
pub(super) const SYMBOLS: usize = 64;
/// Frequencies of a table add up to `1 << PRECISION`.
pub(super) const PRECISION: u32 = 14;
/// Sum of a table's frequencies.
pub(super) const TOTAL: u32 = 1 << PRECISION;
/// Least value of a state.
const LOW: u32 = 1 << 16;
/// Slots of one bucket of an alias table.
const BUCKET_BITS: u32 = PRECISION - 6;
const BUCKET: u32 = 1 << BUCKET_BITS;
/// Most interleaved states.
pub(super) const MAX_LANES: usize = 8;

/// One bucket: its slots below the cutoff belong to the symbol of the bucket's own number, the others to another one.
///
/// Packed into one word, so that it takes one load and no branch to use: 9 bits of cutoff, 15 of the own symbol's
/// frequency; and what turns into the other symbol's: 15 bits that differ in the frequency, 6 that differ in the symbol,
/// and 14 to add to the place within the bucket (modulo `2^14`) for the place within the symbol.
#[derive(Clone, Copy, Debug, Default)]
struct Bucket(u64);

impl Bucket {
    fn new(symbol: usize, freq: u16, cutoff: u32, (other, other_freq, offset): (usize, u16, u32)) -> Self {
        let turn = u64::from(freq ^ other_freq)
            | ((symbol ^ other) as u64) << 15
            | u64::from(offset.wrapping_sub(cutoff) & (TOTAL - 1)) << 21;
        Self(u64::from(cutoff.min(BUCKET)) | u64::from(freq) << 9 | turn << 24)
    }

    /// Symbol, its frequency, and the place of a slot within the symbol.
    #[inline(always)]
    fn find(self, slot: u32) -> (u8, u32, u32) {
        let (index, place) = (slot >> BUCKET_BITS, slot & (BUCKET - 1));
        // Which of the two is a coin toss that no branch could foresee.
        let turn = std::hint::select_unpredictable(u64::from(place) < self.0 & 0x1ff, 0, self.0 >> 24);
        let freq = ((self.0 >> 9) ^ turn) as u32 & 0x7fff;
        let symbol = index ^ ((turn >> 15) as u32 & (SYMBOLS as u32 - 1));
        (symbol as u8, freq, (place + (turn >> 21) as u32) & (TOTAL - 1))
    }
}

/// A distribution of 64 symbols, ready to decode with.
#[derive(Clone, Debug)]
pub(super) struct Table {
    buckets: [Bucket; SYMBOLS],
}

impl Table {
    /// Builds the alias table; the frequencies must add up to [`TOTAL`].
    ///
    /// Buckets with room are filled from buckets that overflow, the last of each list first, so that every reader
    /// arrives at the same table.
    pub(super) fn new(freq: &[u16; SYMBOLS]) -> Self {
        let mut cutoff: [u32; SYMBOLS] = std::array::from_fn(|s| u32::from(freq[s]));
        let mut other: [usize; SYMBOLS] = std::array::from_fn(|s| s);
        let mut offset = [0u32; SYMBOLS];
        let (mut under, mut over) = (Vec::new(), Vec::new());
        for (symbol, &count) in cutoff.iter().enumerate() {
            if count < BUCKET {
                under.push(symbol);
            } else if count > BUCKET {
                over.push(symbol);
            }
        }
        while let (Some(&from), Some(&into)) = (over.last(), under.last()) {
            over.pop();
            under.pop();
            cutoff[from] -= BUCKET - cutoff[into];
            other[into] = from;
            offset[into] = cutoff[from];
            if cutoff[from] < BUCKET {
                under.push(from);
            } else if cutoff[from] > BUCKET {
                over.push(from);
            }
        }
        let buckets =
            std::array::from_fn(|s| Bucket::new(s, freq[s], cutoff[s], (other[s], freq[other[s]], offset[s])));
        Self { buckets }
    }

    /// Symbol, its frequency, and the place of a slot within the symbol.
    #[inline(always)]
    fn find(&self, slot: u32) -> (u8, u32, u32) {
        self.buckets[(slot >> BUCKET_BITS) as usize & (SYMBOLS - 1)].find(slot)
    }

    /// The slots of each symbol in the order of their places: what an encoder needs.
    pub(super) fn slots(&self, freq: &[u16; SYMBOLS]) -> Slots {
        let mut sum = 0;
        let symbols = freq.map(u32::from).map(|freq| {
            let start = sum;
            sum += freq;
            Encoding { inverse: (1u64 << 46).div_ceil(u64::from(freq.max(1))), freq, start }
        });
        let mut slots = Box::new([0; TOTAL as usize]);
        for slot in 0..TOTAL {
            let (symbol, _, place) = self.find(slot);
            slots[(symbols[usize::from(symbol)].start + place) as usize] = slot as u16;
        }
        Slots { symbols, slots }
    }
}

/// A distribution of 64 symbols, ready to encode with.
#[derive(Clone, Debug)]
pub(super) struct Slots {
    symbols: [Encoding; SYMBOLS],
    /// The slots of each symbol, one symbol after the other.
    slots: Box<[u16; TOTAL as usize]>,
}

/// What encoding a symbol takes.
#[derive(Clone, Copy, Debug)]
struct Encoding {
    /// `2^46` over the frequency, rounded up: exact quotients of 32-bit numbers without a division.
    inverse: u64,
    freq: u32,
    /// Where its slots begin.
    start: u32,
}

/// How many states suit so many symbols: more are faster, each costs four bytes.
pub(super) fn lanes_for(symbols: usize) -> usize {
    match symbols {
        0 => 0,
        1..4096 => 1,
        4096..65_536 => 4,
        _ => MAX_LANES,
    }
}

/// Encodes symbols, each with its table, for [`Decoder`]; without lanes there must be none.
pub(super) fn encode<'a>(symbols: &[(u16, u8)], lanes: usize, slots: impl Fn(u16) -> &'a Slots) -> Vec<u8> {
    let mut state = [LOW; MAX_LANES];
    // From the end on, as the decoder goes the other way; no symbol takes more than one word.
    let mut words = vec![0u16; symbols.len() + 1];
    let mut first = symbols.len();
    for (index, &(table, symbol)) in symbols.iter().enumerate().rev() {
        let slots = slots(table);
        let symbol = slots.symbols[usize::from(symbol) & (SYMBOLS - 1)];
        let x = &mut state[index & (lanes - 1) & (MAX_LANES - 1)];
        // The greatest state that the symbol maps below 2^32; which ones are beyond is a coin toss.
        words[first] = *x as u16;
        let full = u64::from(*x) >= u64::from(symbol.freq) << (32 - PRECISION);
        let y = std::hint::select_unpredictable(full, *x >> 16, *x);
        first -= usize::from(full);
        let quotient = ((u128::from(y) * u128::from(symbol.inverse)) >> 46) as u32;
        let place = symbol.start + (y - quotient * symbol.freq);
        *x = (quotient << PRECISION) + u32::from(slots.slots[(place & (TOTAL - 1)) as usize]);
    }
    let words = &words[first + 1..];
    let mut bytes = Vec::with_capacity(words.len() * 2 + lanes * 4);
    for x in &state[..lanes] {
        bytes.extend(x.to_le_bytes());
    }
    words.iter().for_each(|word| bytes.extend(word.to_le_bytes()));
    bytes
}

/// Decodes symbols in the order in which they were given to [`encode`].
#[derive(Clone, Debug)]
pub(super) struct Decoder<'a> {
    state: [u32; MAX_LANES],
    lane: usize,
    mask: usize,
    words: &'a [[u8; 2]],
    position: usize,
}

impl<'a> Decoder<'a> {
    /// Starts on the bytes of so many symbols.
    pub(super) fn new(bytes: &'a [u8], symbols: usize) -> Result<Self> {
        let corrupt = || Error::new(ErrorKind::Corrupt, "the tile's symbols end early");
        let mut state = [LOW; MAX_LANES];
        if symbols == 0 {
            return match bytes.is_empty() {
                true => Ok(Self { state, lane: 0, mask: 0, words: &[], position: 0 }),
                false => Err(Error::new(ErrorKind::Corrupt, "the tile has symbols where there should be none")),
            };
        }
        let lanes = lanes_for(symbols);
        let (head, rest) = bytes.split_at_checked(lanes * 4).ok_or_else(corrupt)?;
        for (x, chunk) in state.iter_mut().zip(head.as_chunks::<4>().0) {
            *x = u32::from_le_bytes(*chunk);
        }
        let (words, odd) = rest.as_chunks::<2>();
        if !odd.is_empty() {
            return Err(corrupt());
        }
        Ok(Self { state, lane: 0, mask: lanes - 1, words, position: 0 })
    }

    /// The next symbol, which has the given table.
    #[inline(always)]
    pub(super) fn next(&mut self, table: &Table) -> u8 {
        let lane = self.lane & (MAX_LANES - 1);
        let x = self.state[lane];
        let (symbol, freq, place) = table.find(x & (TOTAL - 1));
        // Damaged states may overflow; the check at the end finds them.
        let next = freq.wrapping_mul(x >> PRECISION).wrapping_add(place);
        let refill = next < LOW;
        let word = self.words.get(self.position).map_or(0, |&word| u32::from(u16::from_le_bytes(word)));
        self.state[lane] = std::hint::select_unpredictable(refill, (next << 16) | word, next);
        self.position += usize::from(refill);
        self.lane = (self.lane + 1) & self.mask;
        symbol
    }

    /// The next symbols, one after the other, each with its table.
    #[inline(always)]
    pub(super) fn next_all<'t>(&mut self, symbols: &mut [u8], table: impl Fn(usize) -> &'t Table) {
        // A copy stays in registers.
        let mut decoder = self.clone();
        for (index, symbol) in symbols.iter_mut().enumerate() {
            *symbol = decoder.next(table(index));
        }
        *self = decoder;
    }

    /// Fails when more was read than there is.
    pub(super) fn check(&self) -> Result<()> {
        match self.position <= self.words.len() {
            true => Ok(()),
            false => Err(Error::new(ErrorKind::Corrupt, "the tile's symbols end early")),
        }
    }

    /// Fails unless exactly the given bytes were used and every state came back to where the encoder began.
    pub(super) fn finish(self) -> Result<()> {
        match self.position == self.words.len() && self.state.iter().all(|&x| x == LOW) {
            true => Ok(()),
            false => Err(Error::new(ErrorKind::Corrupt, "the tile's symbols do not end where they should")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frequencies that add up, from arbitrary weights.
    fn frequencies(weights: &[u32]) -> [u16; SYMBOLS] {
        let sum: u32 = weights.iter().sum();
        let mut freq = [0u16; SYMBOLS];
        let mut left = TOTAL;
        for (symbol, &weight) in weights.iter().enumerate() {
            freq[symbol] = (u64::from(weight) * u64::from(TOTAL) / u64::from(sum)) as u16;
            left -= u32::from(freq[symbol]);
        }
        freq[0] += left as u16;
        freq
    }

    #[test]
    fn alias_tables_hold_each_symbol_as_often_as_they_should() {
        for seed in 1..60u32 {
            let weights: Vec<u32> = (0..SYMBOLS as u32).map(|s| (s * s * seed) % 97 / (1 + s % seed)).collect();
            let freq = frequencies(&weights.iter().map(|w| w + u32::from(seed == 1)).collect::<Vec<_>>());
            let table = Table::new(&freq);
            let mut seen: Vec<Vec<u32>> = vec![Vec::new(); SYMBOLS];
            for slot in 0..TOTAL {
                let (symbol, count, place) = table.find(slot);
                assert_eq!(count, u32::from(freq[usize::from(symbol)]));
                seen[usize::from(symbol)].push(place);
            }
            for (symbol, places) in seen.iter_mut().enumerate() {
                places.sort_unstable();
                assert!(places.iter().copied().eq(0..u32::from(freq[symbol])), "symbol {symbol}");
            }
        }
    }

    #[test]
    fn symbols_come_back() {
        let freqs: Vec<_> = (1..5u32)
            .map(|t| frequencies(&(0..SYMBOLS as u32).map(|s| 10_000 / (1 + s * s * t)).collect::<Vec<_>>()))
            .chain([frequencies(&[1])])
            .collect();
        let tables: Vec<_> = freqs.iter().map(Table::new).collect();
        let slots: Vec<_> = tables.iter().zip(&freqs).map(|(table, freq)| table.slots(freq)).collect();
        for count in [0, 1, 2, 5, 4095, 4096, 70_001] {
            let mut x = 12_345u32;
            let symbols: Vec<(u16, u8)> = (0..count)
                .map(|_| {
                    x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    let table = (x >> 20) as usize % tables.len();
                    let symbol = loop {
                        x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                        let symbol = (x >> 24) as usize % SYMBOLS;
                        if freqs[table][symbol] > 0 {
                            break symbol;
                        }
                    };
                    (table as u16, symbol as u8)
                })
                .collect();
            let bytes = encode(&symbols, lanes_for(symbols.len()), |table| &slots[usize::from(table)]);
            let mut decoder = Decoder::new(&bytes, symbols.len()).unwrap();
            for &(table, symbol) in &symbols {
                assert_eq!(decoder.next(&tables[usize::from(table)]), symbol);
            }
            decoder.finish().unwrap();
        }
    }
}
