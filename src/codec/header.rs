//! What stands before the passes of a tile.

use super::bits::{BitReader, BitWriter};
use super::context::{greatest_coarseness, usual_coarseness};
use super::mapping::{Mapping, Meaning};
use super::tile::{BandRule, Bound};
use super::zones::{MAX_ZONES, ZONED_FROM};
use crate::error::{Error, ErrorKind, Result};
use crate::grid::SampleType;

/// What stands before the passes of a tile.
#[derive(Clone, Debug)]
pub(super) struct Header {
    pub(super) mapping: Mapping,
    /// Whether some cells are voids, and whether the coarsest is.
    pub(super) voids: Option<bool>,
    /// Bits of the voids, where they are not those of the band.
    pub(super) void_bits: Option<u64>,
    /// How errors are coarsened.
    pub(super) coarseness: u32,
    /// Whether copies are told.
    pub(super) copies: bool,
    /// Number of zones.
    pub(super) zones: usize,
    /// Whether cells are written out.
    pub(super) patched: bool,
    /// The coarsest cell.
    pub(super) seed: i64,
}

impl Header {
    /// Writes the header of a tile of so many levels.
    pub(super) fn write(&self, bits: &mut BitWriter, sample: SampleType, levels: u8) {
        bits.put(u64::from(self.voids.is_some()), 1);
        if let Some(top) = self.voids {
            bits.put(u64::from(top), 1);
            if matches!(sample, SampleType::F32 | SampleType::F64) {
                bits.put(u64::from(self.void_bits.is_some()), 1);
            }
            if let Some(void) = self.void_bits {
                put_cell(bits, void, sample);
            }
        }
        bits.put(u64::from(self.patched), 1);
        self.mapping.write(bits);
        if self.mapping.range_bits > 0 {
            let usual = self.coarseness == usual_coarseness(self.mapping.step);
            bits.put(u64::from(!usual), 1);
            if !usual {
                bits.put(u64::from(self.coarseness), 6);
            }
            if self.mapping.step == 1 {
                bits.put(u64::from(self.copies), 1);
            }
            if levels >= ZONED_FROM {
                bits.put(self.zones as u64 - 1, 2);
            }
            bits.put_signed(self.seed, self.mapping.range_bits.min(60));
        }
    }

    /// Reads the header of a tile of a band and of so many levels.
    pub(super) fn read(bits: &mut BitReader<'_>, rule: &BandRule, levels: u8) -> Result<Self> {
        let sample = rule.sample;
        let is_float = matches!(sample, SampleType::F32 | SampleType::F64);
        let (mut voids, mut void_bits) = (None, None);
        if bits.take(1) == 1 {
            if !is_float && rule.nodata.is_none() {
                return Err(Error::new(
                    ErrorKind::Corrupt,
                    "a tile of integers has voids, and its band no nodata value",
                ));
            }
            voids = Some(bits.take(1) == 1);
            if is_float && bits.take(1) == 1 {
                void_bits = Some(take_cell(bits, sample));
            }
        }
        let patched = bits.take(1) == 1;
        let mapping = Mapping::read(bits, sample)?;
        if rule.bound == Bound::Lossless && (mapping.step > 1 || matches!(mapping.meaning, Meaning::Fixed { .. })) {
            return Err(Error::new(ErrorKind::Corrupt, "a tile of a lossless band has lost something"));
        }
        let (mut copies, mut zones, mut seed) = (false, 1, 0);
        let mut coarseness = usual_coarseness(mapping.step);
        if mapping.range_bits > 0 {
            if bits.take(1) == 1 {
                coarseness = bits.take(6) as u32;
                let greatest = greatest_coarseness(mapping.range_bits);
                if coarseness > greatest {
                    return Err(Error::new(
                        ErrorKind::Corrupt,
                        format!("a tile's errors are coarsened by {coarseness} bits; at most {greatest} are allowed"),
                    ));
                }
                if coarseness == usual_coarseness(mapping.step) {
                    return Err(Error::new(ErrorKind::Corrupt, "a tile tells a coarseness that is the usual one"));
                }
            }
            copies = mapping.step == 1 && bits.take(1) == 1;
            if levels >= ZONED_FROM {
                zones = bits.take(2) as usize + 1;
            }
            seed = bits.take_signed(mapping.range_bits.min(60));
        }
        bits.check()?;
        Ok(Self { mapping, voids, void_bits, coarseness, copies, zones, patched, seed })
    }
}

/// Writes a cell as it is.
pub(super) fn put_cell(bits: &mut BitWriter, value: u64, sample: SampleType) {
    let width = sample.bytes() as u32 * 8;
    bits.put(value & 0xffff_ffff, width.min(32));
    if width > 32 {
        bits.put(value >> 32, width - 32);
    }
}

/// Reads a cell as it is.
pub(super) fn take_cell(bits: &mut BitReader<'_>, sample: SampleType) -> u64 {
    let width = sample.bytes() as u32 * 8;
    let low = bits.take(width.min(32));
    if width > 32 { low | bits.take(width - 32) << 32 } else { low }
}

const _: () = assert!(MAX_ZONES == 4, "as many bits as zones take");
