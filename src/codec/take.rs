//! Takes the residuals of a pass, and finds out what they cost.

use super::context::{Asks, TileRule, zone_of};
use super::cost::{cost_of, symbol_costs};
use super::params::{PassParams, SHIFT_LIMIT};
use super::pass::{Planned, Residuals};
use super::plane::Plane;
use super::rans::SYMBOLS;
use super::tables::{CENTRE, ESCAPE, SHAPES, TABLES, TableRef, reshaped, table_set};
use super::word::Word;

/// Residuals of the cells as they should be, in their order.
pub(super) struct Taken<'a, W> {
    original: &'a Plane<W>,
    step: i64,
    inverse: f64,
    /// In steps, turned.
    pub(super) residuals: Vec<W>,
    pub(super) contexts: Vec<u16>,
}

impl<'a, W: Word> Taken<'a, W> {
    /// Takes from these cells.
    pub(super) fn new(original: &'a Plane<W>, step: i64) -> Self {
        let count = original.width * original.height;
        Self {
            original,
            step,
            inverse: 1.0 / step as f64,
            residuals: Vec::with_capacity(count),
            contexts: Vec::with_capacity(count),
        }
    }

    /// How the residuals of each zone spread over the symbols of the plain tables.
    pub(super) fn histograms(&self, params: &[PassParams], rule: TileRule) -> Vec<Histogram> {
        let plain: Vec<_> = params.iter().map(|params| PassParams { shape: 0, shift: 0, ..params.clone() }).collect();
        let asks = Asks::new(&plain, rule);
        let new = || Histogram { counts: vec![[0; SYMBOLS]; TABLES / SHAPES], escaped: 0, raw: 0 };
        let mut histograms: Vec<Histogram> = params.iter().map(|_| new()).collect();
        for (&k, &context) in self.residuals.iter().zip(&self.contexts) {
            let ask = asks.of(context);
            let histogram = &mut histograms[zone_of(context)];
            histogram.raw += u64::from(ask.raw);
            let k = k.wide() >> ask.raw;
            let symbol = symbol_of(k);
            histogram.counts[usize::from(ask.table.0)][usize::from(symbol) & (SYMBOLS - 1)] += 1;
            if symbol == ESCAPE {
                histogram.escaped += u64::from(number_bits(k)) << 8;
            }
        }
        histograms
    }
}

impl<W: Word> Residuals<W> for Taken<'_, W> {
    const KEEPS: bool = true;

    #[inline(always)]
    fn next(&mut self, _: &Asks, row: usize, col: usize, prediction: W, _: u16, _: W) -> W {
        let miss = self.original.row(row)[col].minus(prediction);
        if self.step == 1 { miss } else { miss.in_steps(self.step, self.inverse) }
    }

    #[inline(always)]
    fn next_row(&mut self, _: &Asks, row: usize, planned: &Planned<'_, W>, residuals: &mut [W]) {
        let cells = self.original.row(row);
        for ((residual, cell), &prediction) in residuals.iter_mut().zip(cells).zip(planned.predictions) {
            *residual = cell.minus(prediction);
        }
        if self.step > 1 {
            for residual in residuals.iter_mut() {
                *residual = residual.in_steps(self.step, self.inverse);
            }
        }
        if let Some(holes) = planned.holes {
            for (residual, &hole) in residuals.iter_mut().zip(holes) {
                *residual = if hole == 0 { *residual } else { W::default() };
            }
        }
    }

    #[inline(always)]
    fn keep(&mut self, planned: &Planned<'_, W>, residuals: &[W]) {
        let turned = residuals.iter().zip(planned.turns).map(|(residual, &turn)| residual.turned(turn));
        match planned.holes {
            None => {
                self.residuals.extend(turned);
                self.contexts.extend_from_slice(planned.contexts);
            }
            Some(holes) => {
                let held = turned.zip(planned.contexts).zip(holes).filter(|&(_, &hole)| hole == 0);
                for ((residual, &context), _) in held {
                    self.residuals.push(residual);
                    self.contexts.push(context);
                }
            }
        }
    }
}

/// How residuals spread over the symbols of each table.
pub(super) struct Histogram {
    counts: Vec<[u32; SYMBOLS]>,
    escaped: u64,
    raw: u64,
}

impl Histogram {
    /// Cost of the symbols of tables, in 256ths of a bit.
    fn cost(used: &[(TableRef, &[u32; SYMBOLS])], shape: u8, shift: i32) -> u64 {
        let costs = symbol_costs();
        let mut cost = 0;
        for &(table, counts) in used {
            let freq = table_set().freq(reshaped(table, shape, shift));
            let escape = costs[usize::from(freq[usize::from(ESCAPE)])];
            for (&freq, &count) in freq.iter().zip(counts).filter(|&(_, &count)| count > 0) {
                let each = if freq == 0 { escape + (7 << 8) } else { costs[usize::from(freq)] };
                cost += u64::from(count) * u64::from(each);
            }
        }
        cost
    }

    /// The cheapest family and shift, and their cost with raw bits.
    pub(super) fn best(&self) -> (u8, i32, u64) {
        let used: Vec<_> = (self.counts.iter().enumerate())
            .filter(|(_, counts)| counts.iter().any(|&count| count > 0))
            .map(|(table, counts)| (TableRef(table as u16), counts))
            .collect();
        let mut best = (0, 0, u64::MAX);
        for shape in 0..SHAPES as u8 {
            // Downhill from the middle; there is one valley.
            let middle = Self::cost(&used, shape, 0);
            if middle < best.2 {
                best = (shape, 0, middle);
            }
            for direction in [1i32, -1] {
                let (mut shift, mut before) = (direction, middle);
                while shift.abs() <= SHIFT_LIMIT {
                    let cost = Self::cost(&used, shape, shift);
                    if cost >= before {
                        break;
                    }
                    if cost < best.2 {
                        best = (shape, shift, cost);
                    }
                    (shift, before) = (shift + direction, cost);
                }
            }
        }
        (best.0, best.1, best.2 + self.escaped + (self.raw << 8))
    }
}

/// The symbol of a residual without its raw bits.
#[inline(always)]
pub(super) fn symbol_of(k: i64) -> u8 {
    (k.wrapping_add(CENTRE) as u64).min(u64::from(ESCAPE)) as u8
}

/// Bits that an escaped residual takes.
fn number_bits(k: i64) -> u32 {
    cost_of(super::bits::zigzag(k), 6)
}
