//! How much a sparse terrain stores, and how far it is from the original.

use super::layout::PatchLayout;

/// What paper 001, section 5.1, counts as stored, in values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Storage {
    /// Cells of the raster, the paper's t₀.
    pub cells: usize,
    /// Patches, n.
    pub patches: usize,
    /// Values of a patch, K.
    pub values: usize,
    /// Atoms, N.
    pub atoms: usize,
    /// Coefficients of a patch, s.
    pub sparsity: usize,
}

impl Storage {
    /// What a layout with so many atoms and coefficients a patch stores.
    pub fn new(layout: &PatchLayout, atoms: usize, sparsity: usize) -> Self {
        let (cells, values) = (layout.rows() * layout.cols(), layout.shape().values());
        Self { cells, patches: layout.places(), values, atoms, sparsity }
    }

    /// The ratio ρ as the paper's formula has it: KN + n(2s + 2) + 1 values, which are atoms, coefficients with their
    /// atoms' numbers, the beginning of each patch's coefficients, means, and one end.
    pub fn ratio_as_printed(&self) -> f64 {
        let values = self.values * self.atoms + self.patches * (2 * self.sparsity + 2) + 1;
        values as f64 / self.cells as f64
    }

    /// The ratio ρ as the paper's table 1 counts it: KN + 2sn values, without means.
    pub fn ratio_as_counted(&self) -> f64 {
        let values = self.values * self.atoms + 2 * self.sparsity * self.patches;
        values as f64 / self.cells as f64
    }
}

/// How far one raster is from another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Root of the mean square difference, in metres.
    pub rms_m: f64,
    /// Largest difference, in metres.
    pub max_m: f64,
    /// Peak signal-to-noise ratio in decibels; the peak is the original's highest elevation less its lowest.
    pub psnr_db: f64,
}

/// Compares a raster with the original where both are known; `None` where nothing is.
///
/// The logarithm is the system's, so the last digits of decibels may differ between systems.
///
/// # Panics
/// When the lengths differ.
pub fn difference(original_m: &[f32], other_m: &[f32]) -> Option<Difference> {
    assert_eq!(original_m.len(), other_m.len(), "rasters of one size");
    let (mut sum, mut max_m, mut count) = (0.0, 0.0f64, 0u64);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (&a, &b) in original_m.iter().zip(other_m).filter(|(a, b)| !a.is_nan() && !b.is_nan()) {
        let (a, off) = (f64::from(a), (f64::from(a) - f64::from(b)).abs());
        sum += off * off;
        max_m = max_m.max(off);
        count += 1;
        (low, high) = (low.min(a), high.max(a));
    }
    let rms_m = (sum / count as f64).sqrt();
    (count > 0).then(|| Difference { rms_m, max_m, psnr_db: 20.0 * ((high - low) / rms_m).log10() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_are_those_of_the_formulas() {
        let storage = Storage { cells: 1000, patches: 10, values: 16, atoms: 5, sparsity: 2 };
        assert_eq!(storage.ratio_as_printed(), (80 + 60 + 1) as f64 / 1000.0);
        assert_eq!(storage.ratio_as_counted(), (80 + 40) as f64 / 1000.0);
    }

    #[test]
    fn decibels_are_of_the_range() {
        let original = [0.0, 100.0, 50.0, f32::NAN];
        let other = [1.0, 99.0, 51.0, 7.0];
        let found = difference(&original, &other).unwrap();
        assert_eq!((found.rms_m, found.max_m, found.psnr_db), (1.0, 1.0, 40.0));
        assert_eq!(difference(&original, &original).unwrap().psnr_db, f64::INFINITY);
        assert!(difference(&[f32::NAN], &[1.0]).is_none());
    }
}
