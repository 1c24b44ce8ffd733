//! What a pass needs to know: filters, weights of the expected error, choice of tables; shipped or written out.

use super::bits::{BitReader, BitWriter};
use super::pass::FRACTION;
use super::tables::{SHAPES, TableSet, VARIANTS};
use super::taps::{MAX_TAPS, Pass, SERIAL_TAPS};
use crate::error::{Error, ErrorKind, Result};

/// Number of weights of the expected error: three groups of errors of the known planes, spread and disagreement of
/// the nearest cells, errors above, errors to the left (two), the step.
pub(super) const ERROR_WEIGHTS: usize = 9;
/// Greatest magnitude of a filter's weight.
pub(super) const WEIGHT_LIMIT: i32 = (1 << 13) - 1;
/// What weights are written relative to: a quarter for each of the four nearest cells.
const USUAL: [i32; MAX_TAPS] = {
    let mut usual = [0; MAX_TAPS];
    let mut k = 0;
    while k < 4 {
        usual[k] = 1 << (FRACTION - 2);
        k += 1;
    }
    usual
};
/// The coarsest level that may have serial passes: coarser ones have too few cells to matter.
pub(super) const SERIAL_UP_TO: u8 = 2;
/// Greatest shift of the bins, either way.
pub(super) const SHIFT_LIMIT: i32 = 3;

/// Parameters of one pass in one zone.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PassParams {
    /// Whether predictions use the cells to the left in the same plane.
    pub(super) serial: bool,
    /// One filter for all cells, or one for cells among nearly equal ones and one for the others.
    pub(super) classes: u8,
    /// Weights of the taps of each class, the serial ones last; 0 where a pass has fewer taps.
    pub(super) filters: [[i32; MAX_TAPS]; 2],
    /// Codes of the weights of the expected error.
    pub(super) codes: [u8; ERROR_WEIGHTS],
    /// The weights themselves, in 1024ths.
    pub(super) weights: [u32; ERROR_WEIGHTS],
    /// Which family of tables.
    pub(super) shape: u8,
    /// Added to the bin of the expected error when a table is chosen.
    pub(super) shift: i32,
    /// Which shipped filter, unless the filters are written out.
    pub(super) filter_variant: Option<u8>,
    /// Which shipped weights, unless they are written out.
    pub(super) weight_variant: Option<u8>,
}

/// The weight that a code of 6 bits means: 0, then quarter octaves from 1.
pub(super) fn weight_of(code: u8) -> u32 {
    match code {
        0 => 0,
        _ => ((4 + u32::from(code - 1) % 4) << (u32::from(code - 1) / 4)) / 4,
    }
}

impl PassParams {
    /// Shipped filters and weights.
    pub(super) fn shipped(pass: Pass, serial: bool, variant: u8) -> Self {
        let (filter, codes) = TableSet::defaults(pass, serial, variant);
        let mut params = Self {
            serial,
            classes: 1,
            filters: [filter; 2],
            codes,
            weights: [0; ERROR_WEIGHTS],
            shape: 0,
            shift: 0,
            filter_variant: Some(variant),
            weight_variant: Some(variant),
        };
        params.set_codes(codes);
        params
    }

    /// Takes over the weights of the expected error.
    pub(super) fn set_codes(&mut self, codes: [u8; ERROR_WEIGHTS]) {
        self.codes = codes;
        self.weights = codes.map(weight_of);
    }

    /// Number of weights of the taps that a pass has.
    fn weights_of(pass: Pass, serial: bool) -> usize {
        pass.tap_count() - if serial { 0 } else { SERIAL_TAPS }
    }

    /// Writes the parameters of a pass of a level, zone by zone.
    pub(super) fn write_all(all: &[Self], bits: &mut BitWriter, pass: Pass, level: u8) {
        if level <= SERIAL_UP_TO {
            bits.put(u64::from(all[0].serial), 1);
        }
        all.iter().for_each(|params| params.write(bits, pass));
    }

    /// Writes the parameters of a zone.
    fn write(&self, bits: &mut BitWriter, pass: Pass) {
        bits.put(u64::from(self.shape), 1);
        bits.put((self.shift + SHIFT_LIMIT) as u64, 3);
        bits.put(u64::from(self.filter_variant.is_none()), 1);
        match self.filter_variant {
            Some(variant) => bits.put(u64::from(variant), 2),
            None => {
                bits.put(u64::from(self.classes - 1), 1);
                for filter in &self.filters[..usize::from(self.classes)] {
                    for (&weight, usual) in filter[..Self::weights_of(pass, self.serial)].iter().zip(USUAL) {
                        bits.put_signed(i64::from(weight - usual), 5);
                    }
                }
            }
        }
        bits.put(u64::from(self.weight_variant.is_none()), 1);
        match self.weight_variant {
            Some(variant) => bits.put(u64::from(variant), 2),
            None => self.codes.iter().for_each(|&code| bits.put(u64::from(code), 6)),
        }
    }

    /// Reads what [`PassParams::write_all`] wrote for so many zones.
    pub(super) fn read_all(bits: &mut BitReader<'_>, pass: Pass, level: u8, zones: usize) -> Result<Vec<Self>> {
        let serial = level <= SERIAL_UP_TO && bits.take(1) == 1;
        (0..zones).map(|_| Self::read(bits, pass, serial)).collect()
    }

    /// Reads the parameters of a zone.
    fn read(bits: &mut BitReader<'_>, pass: Pass, serial: bool) -> Result<Self> {
        let corrupt = |what: String| Error::new(ErrorKind::Corrupt, what);
        let shape = bits.take(1) as u8;
        let shift = bits.take(3) as i32 - SHIFT_LIMIT;
        if shift > SHIFT_LIMIT {
            return Err(corrupt(format!(
                "the tables of a pass are shifted by {shift}; at most {SHIFT_LIMIT} is allowed"
            )));
        }
        let mut params;
        if bits.take(1) == 0 {
            params = Self::shipped(pass, serial, bits.take(2) as u8);
        } else {
            params = Self::shipped(pass, serial, 0);
            params.filter_variant = None;
            params.classes = bits.take(1) as u8 + 1;
            for class in 0..usize::from(params.classes) {
                params.filters[class] = [0; MAX_TAPS];
                for (weight, usual) in params.filters[class][..Self::weights_of(pass, serial)].iter_mut().zip(USUAL) {
                    *weight = i32::try_from(bits.take_signed(5).saturating_add(i64::from(usual))).unwrap_or(i32::MAX);
                    if weight.unsigned_abs() > WEIGHT_LIMIT as u32 {
                        return Err(corrupt(format!(
                            "a filter weighs a cell by {weight}; the limit is {WEIGHT_LIMIT}"
                        )));
                    }
                }
            }
            bits.check()?;
        }
        params.shape = shape;
        params.shift = shift;
        if bits.take(1) == 0 {
            let variant = bits.take(2) as u8;
            params.weight_variant = Some(variant);
            params.set_codes(TableSet::defaults(pass, serial, variant).1);
        } else {
            params.weight_variant = None;
            let mut codes = [0; ERROR_WEIGHTS];
            for code in &mut codes {
                *code = bits.take(6) as u8;
                if *code > MAX_CODE {
                    return Err(corrupt(format!("a weight of errors has code {code}; the greatest is {MAX_CODE}")));
                }
            }
            params.set_codes(codes);
        }
        Ok(params)
    }
}

/// Greatest code of a weight of errors: 1.0 (4 errors in a group, 2^20 each, stay below 2^32).
pub(super) const MAX_CODE: u8 = 41;

const _: () = assert!(SHAPES == 2 && VARIANTS == 4, "as many bits as the choices take");
