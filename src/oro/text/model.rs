//! How likely the next bit of a text is 1, given the bytes before it.
//!
//! Four **contexts**, the last 1 to 4 bytes, each have a probability for every bit of the byte that may
//! follow; a **match** bets on the byte that followed when the last bytes stood here before. A **mixer** adds the five
//! in the logistic domain, with weights that learn. Integers only, so every machine comes to the same bits.

/// Bytes in the contexts.
const ORDERS: [usize; 4] = [1, 2, 3, 4];
/// Each context has `2^SLOT_BITS` slots.
const SLOT_BITS: u32 = 17;
/// A slot is the mean of about so many bits at most.
const SLOT_LIMIT: u32 = 127;
/// Bytes that must be the same before a match is looked for.
const MATCH_LEAST: usize = 5;
/// Longer matches are not told apart.
const MATCH_MOST: usize = 32;
/// The match table has `2^MATCH_BITS` places.
const MATCH_BITS: u32 = 16;
/// Inputs of the mixer: the contexts and the match.
const INPUTS: usize = ORDERS.len() + 1;
/// Sets of weights, one for each class of match lengths.
const SETS: usize = 4;
/// Weight of every input at first, in 65,536ths.
const WEIGHT: i32 = 20_000;
/// Weights stay within this on both sides of 0.
const WEIGHT_MOST: i32 = 1 << 20;
/// How fast weights learn.
const RATE: i32 = 14;
/// Odd numbers whose products stir bits: of the bytes of a context, of the bits of the byte under way, of the sum.
const FOLD: u32 = 0x2f0b_4c47;
const SPREAD: u32 = 0x85eb_ca6b;
const STIR: u32 = 0x9e37_79b1;

/// `round(4096 / (1 + exp(-(i - 16) / 2)))`, kept within 1 to 4095.
const LOGISTIC: [i32; 33] = [
    1, 2, 4, 6, 10, 17, 27, 45, 74, 120, 194, 311, 488, 747, 1102, 1546, 2048, 2550, 2994, 3349, 3608, 3785, 3902,
    3976, 4022, 4051, 4069, 4079, 4086, 4090, 4092, 4094, 4095,
];

/// The probability, in 4096ths, whose logit is `x / 256`.
fn squash(x: i32) -> i32 {
    let x = x.clamp(-2047, 2047) + 2048;
    let (place, part) = ((x >> 7) as usize, x & 127);
    (LOGISTIC[place] * (128 - part) + LOGISTIC[place + 1] * part + 64) >> 7
}

/// The reverse of [`squash`]: the least `x` whose probability is at least `p`.
fn stretches() -> Vec<i32> {
    let mut table = vec![];
    for x in -2047..=2047 {
        while (table.len() as i32) <= squash(x) {
            table.push(x);
        }
    }
    table.resize(4096, 2047);
    table
}

/// A probability in 65,536ths in the upper half, and how many bits it has seen in the lower.
type Slot = u32;
const NEW_SLOT: Slot = 32_768 << 16;

/// Bets learn as the mean of about so many bits at most.
const BET_LIMIT: u32 = 1023;

/// Moves a slot towards a bit: two thirds of the way first, then less and less.
fn learn(slot: &mut Slot, bit: u32, limit: u32) {
    let (mut p, n) = (*slot >> 16, *slot & 0xffff);
    if bit == 1 {
        p += (65_535 - p) * 2 / (2 * n + 3);
    } else {
        p -= p * 2 / (2 * n + 3);
    }
    *slot = p << 16 | (n + 1).min(limit);
}

/// The state of the model.
#[derive(Clone)]
pub(super) struct Model {
    stretch: Vec<i32>,
    /// The slots of all contexts, one context after the other.
    slots: Vec<Slot>,
    /// All bytes so far.
    history: Vec<u8>,
    /// Where in the history the last [`MATCH_LEAST`] bytes stood before.
    places: Vec<u32>,
    /// Slots of the match: is the bet right?
    bets: Vec<Slot>,
    weights: [[i32; INPUTS]; SETS],
    /// The bits of the byte under way, after a leading 1.
    partial: u32,
    /// Hashes of the contexts.
    hashes: [u32; ORDERS.len()],
    /// Where the match goes on, and how long it is; 0 when there is none.
    matched: usize,
    length: usize,
    // What the last probability was made of.
    at: [usize; ORDERS.len()],
    inputs: [i32; INPUTS],
    probability: i32,
}

impl Model {
    pub(super) fn new() -> Self {
        let mut model = Self {
            stretch: stretches(),
            slots: vec![NEW_SLOT; ORDERS.len() << SLOT_BITS],
            history: vec![],
            places: vec![0; 1 << MATCH_BITS],
            bets: vec![NEW_SLOT; MATCH_MOST + 1],
            weights: [[WEIGHT; INPUTS]; SETS],
            partial: 1,
            hashes: [0; ORDERS.len()],
            matched: 0,
            length: 0,
            at: [0; ORDERS.len()],
            inputs: [0; INPUTS],
            probability: 2048,
        };
        model.begin_byte();
        model.predict();
        model
    }

    /// The probability, in 4096ths, that the next bit is 1.
    pub(super) fn probability(&self) -> u32 {
        self.probability as u32
    }

    /// Takes the next bit. Says the byte when it was its last.
    pub(super) fn push(&mut self, bit: u32) -> Option<u8> {
        let error = ((bit as i32) << 12) - self.probability;
        let set = self.set();
        for (weight, input) in self.weights[set].iter_mut().zip(self.inputs) {
            *weight = (*weight + ((input * error * RATE + 0x8000) >> 16)).clamp(-WEIGHT_MOST, WEIGHT_MOST);
        }
        for &at in &self.at {
            learn(&mut self.slots[at], bit, SLOT_LIMIT);
        }
        if let Some(expected) = self.bet() {
            learn(&mut self.bets[self.length], u32::from(expected == bit), BET_LIMIT);
            if expected != bit {
                self.length = 0;
            }
        }
        self.partial = self.partial << 1 | bit;
        let byte = (self.partial >= 256).then_some(self.partial as u8);
        if let Some(byte) = byte {
            self.history.push(byte);
            self.partial = 1;
            self.begin_byte();
        }
        self.predict();
        byte
    }

    /// Hashes of the new contexts, and the new match.
    fn begin_byte(&mut self) {
        let end = self.history.len();
        let fold = |count: usize| {
            let last = &self.history[end.saturating_sub(count)..];
            last.iter()
                .fold(count as u32, |hash, &byte| hash.wrapping_add(u32::from(byte)).wrapping_add(1).wrapping_mul(FOLD))
        };
        self.hashes = ORDERS.map(fold);
        if end < MATCH_LEAST {
            return;
        }
        let place = (fold(MATCH_LEAST).wrapping_mul(STIR) >> (32 - MATCH_BITS)) as usize;
        if self.length > 0 {
            self.matched += 1;
            self.length = (self.length + 1).min(MATCH_MOST);
        } else {
            self.matched = self.places[place] as usize;
            if self.matched > 0 {
                let before = self.history[..self.matched].iter().rev();
                self.length =
                    before.zip(self.history.iter().rev()).take(MATCH_MOST).take_while(|(a, b)| a == b).count();
            }
        }
        self.places[place] = end as u32;
    }

    /// The bit that the match expects next.
    fn bet(&self) -> Option<u32> {
        if self.length == 0 {
            return None;
        }
        let byte = u32::from(self.history[self.matched]) | 256;
        let seen = 31 - self.partial.leading_zeros();
        (byte >> (8 - seen) == self.partial).then(|| byte >> (7 - seen) & 1)
    }

    fn set(&self) -> usize {
        match self.length {
            0 => 0,
            1..16 => 1,
            16..32 => 2,
            _ => 3,
        }
    }

    fn predict(&mut self) {
        for (order, &hash) in self.hashes.iter().enumerate() {
            let place = (hash ^ self.partial.wrapping_mul(SPREAD)).wrapping_mul(STIR) >> (32 - SLOT_BITS);
            self.at[order] = order << SLOT_BITS | place as usize;
            self.inputs[order] = self.stretch[(self.slots[self.at[order]] >> 20) as usize];
        }
        self.inputs[ORDERS.len()] = match self.bet() {
            None => 0,
            Some(expected) => {
                let sure = self.stretch[(self.bets[self.length] >> 20) as usize];
                if expected == 1 { sure } else { -sure }
            }
        };
        let weights = &self.weights[self.set()];
        let sum: i64 = weights.iter().zip(self.inputs).map(|(&w, input)| i64::from(w) * i64::from(input)).sum();
        self.probability = squash((sum >> 16).clamp(-2047, 2047) as i32);
    }
}
