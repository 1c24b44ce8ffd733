//! Finds the mapping of a tile's values.

use super::Cells;
use super::mapping::{FIXED_STEP, Mapping, Meaning, fixed_unit, order_of_f32, order_of_f64};
use super::tile::{BandRule, Bound};
use crate::grid::SampleType;
use crate::with_cells;

/// Bits of the NaN that voids of floats are unless the band has a nodata value.
fn default_void(sample: SampleType) -> u64 {
    match sample {
        SampleType::F64 => f64::NAN.to_bits() & 0x7fff_ffff_ffff_ffff,
        _ => u64::from(f32::NAN.to_bits() & 0x7fff_ffff),
    }
}

/// The bits of the voids of a band.
pub(super) fn void_bits(rule: &BandRule) -> u64 {
    rule.nodata.unwrap_or_else(|| default_void(rule.sample))
}

/// Which cells hold nothing: 1 for voids. Empty when there are none.
pub(super) fn find_voids(cells: &Cells, rule: &BandRule) -> Vec<u8> {
    let nodata = rule.nodata;
    macro_rules! integers {
        ($values:expr, $type:ty, $raw:ty) => {
            match nodata {
                Some(bits) => $values.iter().map(|&v| u8::from(u64::from(v as $raw) == bits)).collect(),
                None => Vec::new(),
            }
        };
    }
    let voids: Vec<u8> = match cells {
        Cells::U8(v) => integers!(v, u8, u8),
        Cells::I8(v) => integers!(v, i8, u8),
        Cells::U16(v) => integers!(v, u16, u16),
        Cells::I16(v) => integers!(v, i16, u16),
        Cells::U32(v) => integers!(v, u32, u32),
        Cells::I32(v) => integers!(v, i32, u32),
        Cells::F32(v) => v.iter().map(|v| u8::from(!v.is_finite() || nodata == Some(u64::from(v.to_bits())))).collect(),
        Cells::F64(v) => v.iter().map(|v| u8::from(!v.is_finite() || nodata == Some(v.to_bits()))).collect(),
    };
    match voids.contains(&1) {
        true => voids,
        false => Vec::new(),
    }
}

/// Integers of a tile and what they mean.
pub(super) struct Mapped {
    pub(super) mapping: Mapping,
    /// One for each cell; 0 in voids.
    pub(super) xs: Vec<i64>,
}

/// The mapping of a tile; `exact` keeps floats bit by bit whatever the bound.
pub(super) fn map_cells(cells: &Cells, voids: &[u8], rule: &BandRule, exact: bool) -> Mapped {
    let bound = match rule.bound {
        Bound::MaxError(bound) if !exact => bound,
        _ => 0.0,
    };
    match cells {
        Cells::F32(values) => {
            let wide: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
            let same = |value: f64, index: usize| (value as f32).to_bits() == values[index].to_bits();
            let ulp = |most: f64| (f32::from_bits((most as f32).to_bits() + 1) - most as f32).into();
            map_floats(&wide, voids, bound, same, ulp, |index| order_of_f32(values[index]))
        }
        Cells::F64(values) => {
            let same = |value: f64, index: usize| value.to_bits() == values[index].to_bits();
            let ulp = |most: f64| f64::from_bits(most.to_bits() + 1) - most;
            map_floats(values, voids, bound, same, ulp, |index| order_of_f64(values[index]))
        }
        _ => {
            let values: Vec<i64> = with_cells!(cells, values => values.iter().map(|&v| v as i64).collect());
            map_whole(values, voids, bound.min(f64::from(u32::MAX)) as i64, Meaning::Whole)
        }
    }
}

fn is_void(voids: &[u8], index: usize) -> bool {
    voids.get(index).is_some_and(|&void| void != 0)
}

/// Integers with an allowed error of so many units.
fn map_whole(mut values: Vec<i64>, voids: &[u8], error: i64, meaning: Meaning) -> Mapped {
    let held = || values.iter().enumerate().filter(|&(index, _)| !is_void(voids, index)).map(|(_, &value)| value);
    let (least, most) = held().fold((i64::MAX, i64::MIN), |(least, most), v| (least.min(v), most.max(v)));
    if least > most {
        let mapping = Mapping { meaning, least: 0, factor: 1, range_bits: 0, step: 1 };
        return Mapped { mapping, xs: vec![0; values.len()] };
    }
    let range = most.wrapping_sub(least) as u64;
    if range <= 2 * error as u64 {
        // One value is near enough to all.
        let least = least.wrapping_add((range / 2) as i64);
        return Mapped {
            mapping: Mapping { meaning, least, factor: 1, range_bits: 0, step: 1 },
            xs: vec![0; values.len()],
        };
    }
    if error == 0
        && meaning == Meaning::Whole
        && let Some(mapped) = map_list(&values, voids, least, range)
    {
        return mapped;
    }
    let mut factor = 0u64;
    for value in held() {
        factor = greatest_common_divisor(value.wrapping_sub(least) as u64, factor);
        if factor == 1 {
            break;
        }
    }
    let factor = factor.max(1);
    match factor {
        1 => values.iter_mut().for_each(|value| *value = value.wrapping_sub(least)),
        _ => values.iter_mut().for_each(|value| *value = (value.wrapping_sub(least) as u64 / factor) as i64),
    }
    for (value, _) in values.iter_mut().zip(voids).filter(|&(_, &void)| void != 0) {
        *value = 0;
    }
    let step = 2 * (error as u64 / factor) as i64 + 1;
    let range_bits = 64 - (range / factor).leading_zeros();
    Mapped { mapping: Mapping { meaning, least, factor, range_bits, step }, xs: values }
}

fn greatest_common_divisor(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// A list, where few of the numbers between the least and the greatest occur.
fn map_list(values: &[i64], voids: &[u8], least: i64, range: u64) -> Option<Mapped> {
    if range >= 1 << 16 {
        return None;
    }
    let mut number = vec![0u16; range as usize + 1];
    for (index, value) in values.iter().enumerate() {
        if !is_void(voids, index) {
            number[(value - least) as usize] = 1;
        }
    }
    let mut list = Vec::new();
    for (place, number) in number.iter_mut().enumerate() {
        if *number != 0 {
            *number = list.len() as u16;
            list.push(least + place as i64);
        }
    }
    let regular = list.windows(2).all(|pair| pair[1] - pair[0] == list[1] - list[0]);
    if regular || list.len() as u64 * 3 > range || list.len() * 16 > values.len() {
        return None;
    }
    let xs = values
        .iter()
        .enumerate()
        .map(|(index, value)| if is_void(voids, index) { 0 } else { i64::from(number[(value - least) as usize]) })
        .collect();
    let range_bits = usize::BITS - (list.len() - 1).leading_zeros();
    Some(Mapped { mapping: Mapping { meaning: Meaning::List(list), least: 0, factor: 1, range_bits, step: 1 }, xs })
}

/// Steps of grids that float data come from, coarse to fine: decimals, binary fractions, feet and US survey feet.
const GRIDS: [(u32, u32); 34] = [
    (1, 1),
    (1, 2),
    (381, 1250),
    (1200, 3937),
    (1, 4),
    (1, 5),
    (1, 8),
    (1, 10),
    (1, 16),
    (1, 20),
    (1, 25),
    (1, 32),
    (381, 12_500),
    (120, 3937),
    (1, 40),
    (1, 50),
    (1, 64),
    (1, 100),
    (1, 128),
    (1, 200),
    (1, 250),
    (1, 256),
    (381, 125_000),
    (12, 3937),
    (1, 500),
    (1, 512),
    (1, 1000),
    (1, 1024),
    (1, 2048),
    (1, 4096),
    (1, 8192),
    (1, 10_000),
    (1, 16_384),
    (1, 65_536),
];

fn map_floats(
    values: &[f64],
    voids: &[u8],
    bound: f64,
    same: impl Fn(f64, usize) -> bool,
    ulp: impl Fn(f64) -> f64,
    order: impl Fn(usize) -> i64,
) -> Mapped {
    let held: Vec<usize> = (0..values.len()).filter(|&index| !is_void(voids, index)).collect();
    let most = held.iter().fold(0.0f64, |most, &index| most.max(values[index].abs()));
    for (numerator, denominator) in GRIDS {
        let step = f64::from(numerator) / f64::from(denominator);
        if bound > 0.0 && step > bound * 2.0 {
            continue;
        }
        if most / step > 9e15 / f64::from(numerator) {
            break;
        }
        let number = |index: usize| (values[index] * f64::from(denominator) / f64::from(numerator)).round() as i64;
        let fits = |&index: &usize| {
            same(number(index).wrapping_mul(i64::from(numerator)) as f64 / f64::from(denominator), index)
        };
        let probes = held.iter().step_by((held.len() / 256).max(1));
        if probes.clone().filter(|index| !fits(index)).count() > probes.count() / 64 {
            continue;
        }
        let misses = held.iter().filter(|index| !fits(index)).count();
        if misses > held.len() / 200 {
            continue;
        }
        // Two neighbours on the grid may be a rounding of the type farther apart than they should.
        let error = ((bound - ulp(most)).max(0.0) / step).floor().min(f64::from(u32::MAX)) as i64;
        if bound > 0.0 && ((2 * error + 1) as f64) * step < 1.94 * bound {
            break;
        }
        let numbers = (0..values.len()).map(|index| if is_void(voids, index) { 0 } else { number(index) }).collect();
        return map_whole(numbers, voids, error, Meaning::Grid { numerator, denominator });
    }
    if bound > 0.0 {
        let share = ulp(most) / (2.0 * bound);
        if share < 0.25 {
            let shrink = (share * 65_536.0).ceil() as u16 + 1;
            let unit = fixed_unit(bound, shrink);
            if most / unit < 4e15 {
                let numbers = (0..values.len())
                    .map(|index| if is_void(voids, index) { 0 } else { (values[index] / unit).round() as i64 })
                    .collect();
                let mut mapped = map_whole(numbers, voids, FIXED_STEP / 2, Meaning::Fixed { shrink });
                if mapped.mapping.factor > 1 {
                    // A grid of its own; take its units as they are.
                    mapped.mapping.step = FIXED_STEP;
                    let factor = mapped.mapping.factor as i64;
                    mapped.xs.iter_mut().for_each(|x| *x *= factor);
                    mapped.mapping.range_bits += 64 - mapped.mapping.factor.leading_zeros();
                    mapped.mapping.factor = 1;
                }
                return mapped;
            }
        }
    }
    let orders = (0..values.len()).map(|index| if is_void(voids, index) { 0 } else { order(index) }).collect();
    map_whole(orders, voids, 0, Meaning::Ordered)
}
