//! Integers back to cells, row by row.

use super::Cells;
use super::mapping::{Mapping, Meaning, f32_of_order, f64_of_order, fixed_unit};
use super::tile::{BandRule, Bound};
use super::word::Word;

/// Cells in the making.
pub(super) struct Restored<'a> {
    mapping: &'a Mapping,
    bound: f64,
    cells: Cells,
}

impl<'a> Restored<'a> {
    /// Makes room for so many cells.
    pub(super) fn new(mapping: &'a Mapping, rule: &BandRule, count: usize) -> Self {
        let bound = match rule.bound {
            Bound::MaxError(bound) => bound,
            Bound::Lossless => 0.0,
        };
        Self { mapping, bound, cells: Cells::with_capacity(rule.sample, count) }
    }

    /// Adds the cells that a row of integers stands for.
    pub(super) fn push<W: Word>(&mut self, xs: &[W]) {
        let Self { mapping, bound, cells } = self;
        super::vectors::widest(
            #[inline(always)]
            || push(mapping, *bound, cells, xs),
        );
    }

    /// Adds so many cells that are all `x`.
    pub(super) fn fill<W: Word>(&mut self, x: W, count: usize) {
        let row = vec![x; count.min(1024)];
        for start in (0..count).step_by(1024) {
            self.push(&row[..(count - start).min(1024)]);
        }
    }

    /// The cells.
    pub(super) fn finish(self) -> Cells {
        self.cells
    }
}

#[inline(always)]
fn push<W: Word>(mapping: &Mapping, bound: f64, cells: &mut Cells, xs: &[W]) {
    // With a factor of 1 and a base that is no giant, 32-bit integers neither overflow on the way nor need more bits.
    let near = mapping.factor == 1 && mapping.least.unsigned_abs() < 1 << 40 && size_of::<W>() == 4;
    macro_rules! whole {
        ($values:expr, $type:ty) => {{
            let (min, max) = (i64::from(<$type>::MIN), i64::from(<$type>::MAX));
            if near && mapping.meaning == Meaning::Whole && (min..=max).contains(&mapping.least) {
                let narrow = |bound: i64| (bound - mapping.least).clamp(i32::MIN.into(), i32::MAX.into()) as i32;
                let (least, low, high) = (mapping.least as i32, narrow(min), narrow(max));
                append($values, xs, |x| least.wrapping_add(x.low().clamp(low, high)) as $type);
            } else {
                append($values, xs, |x| mapping.whole(x.wide()).clamp(min, max) as $type);
            }
        }};
    }
    macro_rules! real {
        ($values:expr, $type:ty) => {
            match mapping.meaning {
                Meaning::Grid { numerator, denominator } if near && numerator < 1 << 10 => {
                    // Below 2^53 doubles are exact.
                    let (least, numerator) = (mapping.least as f64, f64::from(numerator));
                    let denominator = f64::from(denominator);
                    append($values, xs, |x| ((least + f64::from(x.low())) * numerator / denominator) as $type);
                }
                Meaning::Fixed { shrink } if near => {
                    let (least, unit) = (mapping.least as f64, fixed_unit(bound, shrink));
                    append($values, xs, |x| ((least + f64::from(x.low())) * unit) as $type);
                }
                _ => append($values, xs, |x| mapping.real(x.wide(), bound) as $type),
            }
        };
    }
    match (cells, &mapping.meaning) {
        (Cells::F32(values), Meaning::Ordered) => {
            append(values, xs, |x| f32_of_order(mapping.number(x.wide())));
        }
        (Cells::F64(values), Meaning::Ordered) => {
            append(values, xs, |x| f64_of_order(mapping.number(x.wide())));
        }
        (Cells::F32(values), _) => real!(values, f32),
        (Cells::F64(values), _) => real!(values, f64),
        (Cells::U8(values), _) => whole!(values, u8),
        (Cells::I8(values), _) => whole!(values, i8),
        (Cells::U16(values), _) => whole!(values, u16),
        (Cells::I16(values), _) => whole!(values, i16),
        (Cells::U32(values), _) => whole!(values, u32),
        (Cells::I32(values), _) => whole!(values, i32),
    }
}

/// The bits of a cell, zero-extended.
pub(super) fn cell_bits(cells: &Cells, index: usize) -> u64 {
    match cells {
        Cells::U8(v) => u64::from(v[index]),
        Cells::I8(v) => u64::from(v[index] as u8),
        Cells::U16(v) => u64::from(v[index]),
        Cells::I16(v) => u64::from(v[index] as u16),
        Cells::U32(v) => u64::from(v[index]),
        Cells::I32(v) => u64::from(v[index] as u32),
        Cells::F32(v) => u64::from(v[index].to_bits()),
        Cells::F64(v) => v[index].to_bits(),
    }
}

/// Sets a cell to the given bits.
pub(super) fn set_cell_bits(cells: &mut Cells, index: usize, bits: u64) {
    match cells {
        Cells::U8(v) => v[index] = bits as u8,
        Cells::I8(v) => v[index] = bits as i8,
        Cells::U16(v) => v[index] = bits as u16,
        Cells::I16(v) => v[index] = bits as i16,
        Cells::U32(v) => v[index] = bits as u32,
        Cells::I32(v) => v[index] = bits as i32,
        Cells::F32(v) => v[index] = f32::from_bits(bits as u32),
        Cells::F64(v) => v[index] = f64::from_bits(bits),
    }
}

/// Adds what each integer stands for.
#[inline(always)]
fn append<W: Word, T: Copy + Default>(values: &mut Vec<T>, xs: &[W], value: impl Fn(W) -> T) {
    // Vec::extend is no part of what is compiled for wide vectors.
    let start = values.len();
    values.resize(start + xs.len(), T::default());
    for (cell, &x) in values[start..].iter_mut().zip(xs) {
        *cell = value(x);
    }
}

/// Puts the bits of voids where voids are.
pub(super) fn fill_voids(cells: &mut Cells, voids: &[u8], bits: u64) {
    for (index, _) in voids.iter().enumerate().filter(|&(_, &void)| void != 0) {
        set_cell_bits(cells, index, bits);
    }
}

/// Cells whose decoded value breaks the band's promise, in order.
pub(super) fn broken_cells(cells: &Cells, decoded: &Cells, rule: &BandRule) -> Vec<usize> {
    super::vectors::widest(
        #[inline(always)]
        || broken(cells, decoded, rule),
    )
}

#[inline(always)]
fn broken(cells: &Cells, decoded: &Cells, rule: &BandRule) -> Vec<usize> {
    let bound = match rule.bound {
        Bound::MaxError(bound) => bound,
        Bound::Lossless => 0.0,
    };
    // The bits of a NaN, from which no number is near.
    let nodata = rule.nodata.unwrap_or(u64::MAX);
    let mut broken = Vec::new();
    macro_rules! compare {
        ($($variant:ident $bits:expr, $far:expr;)*) => {
            match (cells, decoded) {
                $((Cells::$variant(before), Cells::$variant(after)) => {
                    let kept = |before, after| {
                        // A void on either side has to be exact; a difference of NaNs and infinities is no number.
                        let (old, new) = ($bits(before), $bits(after));
                        old == new || ($far(before, after) && old != nodata && new != nodata)
                    };
                    for (chunk, (before, after)) in before.chunks(CHUNK).zip(after.chunks(CHUNK)).enumerate() {
                        let all = before.iter().zip(after).fold(true, |all, (&old, &new)| all & kept(old, new));
                        if !all {
                            let found = (0..before.len()).filter(|&k| !kept(before[k], after[k]));
                            broken.extend(found.map(|k| chunk * CHUNK + k));
                        }
                    }
                })*
                _ => broken.extend(0..cells.len()),
            }
        };
    }
    let lossy = bound > 0.0;
    // Whole numbers, so that a bound's fraction does not count.
    let (narrow, wide) = (bound.min(f64::from(u16::MAX)) as i32, bound.min(f64::from(u32::MAX)) as i64);
    compare! {
        U8 u64::from, |a, b| (i32::from(a) - i32::from(b)).abs() <= narrow;
        I8 |v: i8| u64::from(v as u8), |a, b| (i32::from(a) - i32::from(b)).abs() <= narrow;
        U16 u64::from, |a, b| (i32::from(a) - i32::from(b)).abs() <= narrow;
        I16 |v: i16| u64::from(v as u16), |a, b| (i32::from(a) - i32::from(b)).abs() <= narrow;
        U32 u64::from, |a, b| (i64::from(a) - i64::from(b)).abs() <= wide;
        I32 |v: i32| u64::from(v as u32), |a, b| (i64::from(a) - i64::from(b)).abs() <= wide;
        F32 |v: f32| u64::from(v.to_bits()), |a, b| lossy && (f64::from(a) - f64::from(b)).abs() <= bound;
        F64 f64::to_bits, |a: f64, b: f64| lossy && (a - b).abs() <= bound;
    }
    broken
}

/// Cells that are compared at once: most have none that is broken.
const CHUNK: usize = 1024;
