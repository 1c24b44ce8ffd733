//! Cells that a mask or an alpha band marks: they are given a nodata value, for an archive has no other mark.

use super::cell::StoredCell;
use crate::grid::SampleType;

/// How the cells that a mask marks are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Mask {
    /// Their value, as bits.
    pub(super) nodata: u64,
    /// Whether nobody named that value, so that no other cell may have it.
    pub(super) is_chosen: bool,
}

impl Mask {
    /// With a nodata value that the file or the user names, or else one that elevations hardly have.
    pub(super) fn new(sample: SampleType, named: Option<u64>) -> Self {
        let (least, greatest) = sample.range();
        let usual = match sample {
            SampleType::F32 | SampleType::F64 => f64::NAN,
            SampleType::U8 | SampleType::U16 | SampleType::U32 => greatest,
            SampleType::I8 | SampleType::I16 | SampleType::I32 => least,
        };
        let chosen = sample.bits_of(usual).unwrap_or_default();
        Self { nodata: named.unwrap_or(chosen), is_chosen: named.is_none() && !sample.is_float() }
    }

    /// Gives the cells where the mask is 0 the nodata value; returns whether no other has it.
    pub(super) fn apply<T: StoredCell>(self, cells: &mut [T], mask: &[u8]) -> bool {
        let nodata = T::from_bits(self.nodata);
        let mut is_unique = true;
        for (cell, &valid) in cells.iter_mut().zip(mask) {
            if valid == 0 {
                *cell = nodata;
            } else {
                is_unique &= *cell != nodata;
            }
        }
        is_unique || !self.is_chosen
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masked_cells_become_nodata() {
        let mask = Mask::new(SampleType::I16, None);
        let mut cells = [5_i16, 6, 7];
        assert!(mask.apply(&mut cells, &[255, 0, 1]));
        assert_eq!(cells, [5, i16::MIN, 7]);
        // A valid cell with the chosen value would be lost.
        assert!(!mask.apply(&mut [i16::MIN, 3], &[255, 0]));
        let named = Mask::new(SampleType::I16, SampleType::I16.bits_of(-9999.0));
        let mut cells = [-9999_i16, 6];
        assert!(named.apply(&mut cells, &[255, 0]), "the user has said what it means");
        assert_eq!(cells, [-9999, -9999]);
        let mut cells = [1.0_f32, 2.0];
        assert!(Mask::new(SampleType::F32, None).apply(&mut cells, &[0, 9]));
        assert!(cells[0].is_nan() && cells[1] == 2.0);
    }
}
