//! Whether a file holds the cells that went into it: many formats lose some, and most do not say so.

use super::batch::Area;
use crate::codec::Cells;
use crate::error::Result;
use crate::io::raster::stored::{Record, StoredOptions, StoredSource};
use crate::with_cells;
use std::path::Path;

/// How the cells of a file differ from those that went into it.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Difference {
    /// Cells looked at.
    cells: u64,
    /// Cells of another value.
    changed: u64,
    /// The greatest difference of two numbers.
    greatest: f64,
}

/// A written file, opened again.
pub(super) struct Written {
    source: StoredSource,
    found: Difference,
}

impl Written {
    /// Opens a file for a comparison with what its record says.
    ///
    /// # Errors
    /// When GDAL does not read what it wrote.
    pub(super) fn open(path: &Path, record: &Record) -> Result<Self> {
        // Without a choice of bands one that looks like alpha would be left out.
        let bands = (1..=record.bands.len()).collect();
        let source = StoredSource::open(path, &StoredOptions { bands, ..StoredOptions::default() })?;
        Ok(Self { source, found: Difference::default() })
    }

    /// Columns and rows.
    pub(super) fn size(&self) -> (usize, usize) {
        (self.source.record.width, self.source.record.height)
    }

    /// Compares an area of a band.
    ///
    /// # Errors
    /// When it cannot be read.
    pub(super) fn compare(&mut self, band: usize, area: Area, cells: &Cells) -> Result<()> {
        let mut back = Cells::zeros(self.source.record.bands[band].sample, area[2] * area[3]);
        with_cells!(&mut back, values => self.source.read(band, area, values))?;
        self.found.add(cells, &back);
        Ok(())
    }

    /// What to tell of the comparison; nothing where all cells are the same.
    pub(super) fn said(&self, format: &str) -> Option<String> {
        let Difference { cells, changed, greatest } = self.found;
        // Enough digits to judge by.
        let greatest =
            if greatest < 1e-3 { format!("{greatest:.2e}") } else { format!("{}", (greatest * 1e6).round() / 1e6) };
        let message = format!(
            "the format {format} does not keep these cells: {changed} of {cells} differ, by up to {greatest}; GTiff keeps all"
        );
        (changed > 0).then_some(message)
    }
}

impl Difference {
    /// Numbers are compared, not bits: a wider type of the file changes nothing.
    #[allow(clippy::useless_conversion, reason = "one of the types is f64 already")]
    fn add(&mut self, before: &Cells, after: &Cells) {
        let numbers = |cells: &Cells| -> Vec<f64> {
            with_cells!(cells, values => values.iter().map(|&value| f64::from(value)).collect())
        };
        self.cells += before.len() as u64;
        for (x, y) in numbers(before).into_iter().zip(numbers(after)) {
            if x == y || x.is_nan() && y.is_nan() {
                continue;
            }
            self.changed += 1;
            self.greatest = self.greatest.max((x - y).abs());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_count() {
        let mut found = Difference::default();
        found.add(&Cells::I16(vec![1, -2, 300]), &Cells::I32(vec![1, -2, 300]));
        found.add(&Cells::F32(vec![f32::NAN, 0.0, 0.5]), &Cells::F64(vec![f64::NAN, -0.0, 0.5]));
        assert_eq!(found, Difference { cells: 6, changed: 0, greatest: 0.0 });
        found.add(&Cells::U16(vec![300, 7]), &Cells::U8(vec![255, 7]));
        found.add(&Cells::F32(vec![f32::NAN]), &Cells::F32(vec![1.0]));
        assert_eq!(found, Difference { cells: 9, changed: 2, greatest: 45.0 });
    }
}
