//! The shipped tables: distributions of residuals, filters and weights of errors, trained on real DEMs once and
//! numbered, so that small tiles need not describe what all terrain has in common.

use super::params::ERROR_WEIGHTS;
use super::rans::{SYMBOLS, Slots, Table};
use super::taps::{MAX_TAPS, Pass};
use std::sync::OnceLock;

/// Number of the table set that this build writes and reads.
pub const TABLE_SET: u16 = 1;

/// The set as it is written down in `format-spec/`.
const BYTES: &[u8] = include_bytes!("../../format-spec/tables/codec-1.bin");

/// Families of tables: a pass takes the one that fits it better.
pub(super) const SHAPES: usize = 2;
/// Shipped filters and weights for each pass.
pub(super) const VARIANTS: usize = 4;
/// Bins with tables of their own; wider distributions use the last four and raw bits.
const TABLE_BINS: usize = 36;
/// From this bin on, every four more bins are one more raw bit.
const RAW_FROM: usize = 32;
/// Table kinds: four classes of the prediction's fraction for step 1, three for step 3, one for all other steps.
const KINDS: usize = 8;
/// Number of all tables.
pub(super) const TABLES: usize = SHAPES * KINDS * TABLE_BINS;

/// A symbol of `ESCAPE` says that the residual's symbol is written out.
pub(super) const ESCAPE: u8 = SYMBOLS as u8 - 1;
/// Symbol `k + CENTRE` is the residual `k`.
pub(super) const CENTRE: i64 = 31;

const DEFAULT_BYTES: usize = MAX_TAPS * 2 + ERROR_WEIGHTS;
const DEFAULTS_AT: usize = TABLES * SYMBOLS * 2;

/// Names one distribution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct TableRef(pub(super) u16);

/// All shipped tables, unpacked at first use.
pub(super) struct TableSet {
    freqs: Vec<[u16; SYMBOLS]>,
    tables: Vec<Table>,
    slots: Vec<OnceLock<Slots>>,
}

/// The set.
pub(super) fn table_set() -> &'static TableSet {
    static SET: OnceLock<TableSet> = OnceLock::new();
    SET.get_or_init(|| {
        let freqs: Vec<[u16; SYMBOLS]> = BYTES[..DEFAULTS_AT]
            .chunks_exact(SYMBOLS * 2)
            .map(|chunk| std::array::from_fn(|s| u16::from_le_bytes([chunk[2 * s], chunk[2 * s + 1]])))
            .collect();
        TableSet {
            tables: freqs.iter().map(Table::new).collect(),
            slots: freqs.iter().map(|_| OnceLock::new()).collect(),
            freqs,
        }
    })
}

/// The table that a family and a shift put in the place of one of the first family without shift.
pub(super) fn reshaped(table: TableRef, shape: u8, shift: i32) -> TableRef {
    let (kind, bin) = (usize::from(table.0) / TABLE_BINS, usize::from(table.0) % TABLE_BINS);
    let bin = (bin as i32 + shift).clamp(0, TABLE_BINS as i32 - 1) as usize;
    TableRef(((usize::from(shape) * KINDS + kind % KINDS) * TABLE_BINS + bin) as u16)
}

impl TableSet {
    /// The table to decode with.
    #[inline(always)]
    pub(super) fn decoding(&self, table: TableRef) -> &Table {
        &self.tables[usize::from(table.0)]
    }

    /// The table to encode with.
    pub(super) fn encoding(&self, table: u16) -> &Slots {
        let table = usize::from(table);
        self.slots[table].get_or_init(|| self.tables[table].slots(&self.freqs[table]))
    }

    /// Frequencies of the symbols.
    pub(super) fn freq(&self, table: TableRef) -> &[u16; SYMBOLS] {
        &self.freqs[usize::from(table.0)]
    }

    /// How many low bits of a residual are stored as they are, for a bin of the expected error.
    pub(super) fn raw_bits(bin: usize) -> usize {
        bin.saturating_sub(RAW_FROM) / 4
    }

    /// The table of a step, a family, a shift, a bin and a class of the prediction's fraction.
    pub(super) fn table(step: i64, shape: u8, shift: i32, bin: usize, class: usize) -> TableRef {
        let bin = if bin < TABLE_BINS { bin } else { RAW_FROM + bin % 4 };
        let bin = (bin as i32 + shift).clamp(0, TABLE_BINS as i32 - 1) as usize;
        let kind = match step {
            1 => class,
            3 => 4 + class.min(2),
            _ => 7,
        };
        TableRef(((usize::from(shape) * KINDS + kind) * TABLE_BINS + bin) as u16)
    }

    /// Shipped filter and codes of the weights of errors.
    pub(super) fn defaults(pass: Pass, serial: bool, variant: u8) -> ([i32; MAX_TAPS], [u8; ERROR_WEIGHTS]) {
        let index = (usize::from(serial) * 3 + pass as usize) * VARIANTS + usize::from(variant);
        let at = DEFAULTS_AT + index * DEFAULT_BYTES;
        let bytes = &BYTES[at..at + DEFAULT_BYTES];
        let filter = std::array::from_fn(|k| i32::from(i16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]])));
        (filter, std::array::from_fn(|k| bytes[2 * MAX_TAPS + k]))
    }
}

const _: () = assert!(BYTES.len() == DEFAULTS_AT + 2 * 3 * VARIANTS * DEFAULT_BYTES, "the set is whole");

#[cfg(test)]
mod tests {
    use super::super::rans::TOTAL;
    use super::*;

    #[test]
    fn tables_add_up_and_can_escape() {
        for freq in &table_set().freqs {
            assert_eq!(freq.iter().map(|&f| u32::from(f)).sum::<u32>(), TOTAL);
            assert!(freq[usize::from(ESCAPE)] > 0);
        }
    }
}
