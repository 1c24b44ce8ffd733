//! Cells to learn from.

use crate::codec::plane::Plane;
use crate::codec::taps::{Known, MAX_TAPS, Pass, SERIAL_TAPS, Source};
use crate::codec::word::Word;
use crate::codec::zones::LevelZones;

/// Cells that a fit looks at, about.
const SAMPLES: usize = 6000;
/// The same of one zone of several.
const ZONE_SAMPLES: usize = 4000;
/// Taps of a sample, filled up to whole vectors.
pub(super) const ROW: usize = MAX_TAPS.next_multiple_of(8);

/// One cell to learn from: its taps less their base, and the cell itself less it.
pub(super) struct Sample {
    pub(super) taps: [f32; ROW],
    pub(super) target: f32,
    /// Expected spread of the target, squared and inverted.
    pub(super) weight: f32,
}

/// Cells of a pass, or of a zone of it, with all their taps.
pub(in crate::codec) struct Samples {
    /// Those of the flat class first.
    pub(super) samples: Vec<Sample>,
    pub(super) flat: usize,
    /// Cells that they stand for.
    pub(in crate::codec) cells: usize,
    pub(super) taps: usize,
    /// Taps without the serial ones.
    pub(super) plain_taps: usize,
    /// Variance of the quantiser's noise.
    pub(super) noise: f64,
    /// Which taps the decoder sees with that noise, and the fit without.
    pub(super) own: [bool; MAX_TAPS],
}

/// The plane that samples are taken from, and what is known around its cells.
struct Ground<'a, W> {
    pass: Pass,
    original: &'a Plane<W>,
    cells: Known<'a, W>,
    void: Option<&'a Plane<u8>>,
    step: i64,
    /// Taps of a sample, and whether the last two are serial ones.
    taps: usize,
    serial: bool,
}

impl Samples {
    /// Gathers every so-many-th cell of a pass whose taps are no voids, zone by zone; `original` is the plane to be
    /// coded.
    pub(in crate::codec) fn gather<W: Word>(
        pass: Pass,
        original: &Plane<W>,
        cells: Known<'_, W>,
        void: Option<&Plane<u8>>,
        step: i64,
        serial: bool,
        zones: Option<LevelZones<'_>>,
    ) -> Vec<Self> {
        let taps = pass.tap_count() - if serial { 0 } else { SERIAL_TAPS };
        let ground = Ground { pass, original, cells, void, step, taps, serial };
        let counts = zones.map_or_else(
            || vec![original.width * original.height],
            |zones| zones.cells(original.width, original.height),
        );
        let most = if counts.len() > 1 { ZONE_SAMPLES } else { SAMPLES };
        let mut own = [false; MAX_TAPS];
        for (own, tap) in own.iter_mut().zip(pass.taps()) {
            *own = tap.0 == Source::Own;
        }
        own[pass.taps().len()..].fill(true);
        let (plain_taps, step) = (pass.taps().len(), step as f64);
        let noise = (step * step - 1.0) / 12.0;
        let joined = |(zone, &cells): (usize, &usize)| {
            let [mut samples, mut steep] = ground.gather(zone, zones, (cells / most).max(1));
            let flat = samples.len();
            samples.append(&mut steep);
            Self { samples, flat, cells, taps, plain_taps, noise, own }
        };
        counts.iter().enumerate().map(joined).collect()
    }

    /// Number of samples.
    pub(in crate::codec) fn len(&self) -> usize {
        self.samples.len()
    }
}

impl<W: Word> Ground<'_, W> {
    /// One of so many cells of a zone, the flat class and the steep one.
    fn gather(&self, zone: usize, zones: Option<LevelZones<'_>>, stride: usize) -> [Vec<Sample>; 2] {
        let (width, height) = (self.original.width, self.original.height);
        let mut samples = [0, 1].map(|_| Vec::with_capacity(self.original.width * self.original.height / stride / 2));
        // Whole runs of cells in some rows: a stride that shares no factor with the width would be slower to read.
        let (row_stride, col_stride) = match stride {
            0..3 => (1, stride),
            _ => (stride.isqrt().max(1), stride.div_ceil(stride.isqrt().max(1))),
        };
        let mut spans = vec![(0..width, 0)];
        for (index, row) in (2..height).step_by(row_stride).enumerate() {
            let runs: Vec<&[W]> =
                self.pass.taps().iter().map(|&tap| self.cells.run(self.original, tap, row, width)).collect();
            if let Some(zones) = zones {
                zones.spans(row, width, &mut spans);
            }
            // Columns of the same stride in the whole row, wherever the zone's runs begin.
            let origin = 2 + (index + 1) % col_stride;
            for (span, _) in spans.iter().filter(|&&(_, of)| of == zone) {
                let first = origin + span.start.saturating_sub(origin).next_multiple_of(col_stride);
                for col in (first..span.end.min(width.saturating_sub(1))).step_by(col_stride) {
                    if !self.has_hole(row, col) {
                        let (sample, is_steep) = self.sample(&runs, row, col);
                        samples[usize::from(is_steep)].push(sample);
                    }
                }
            }
        }
        samples
    }

    /// Whether the cell or one of its own plane's nearest is a void.
    #[inline(always)]
    fn has_hole(&self, row: usize, col: usize) -> bool {
        let hole = |row: usize, col: usize| self.void.is_some_and(|void| void.row(row)[col] != 0);
        hole(row, col) || hole(row - 1, col) || hole(row - 2, col) || hole(row, col - 1)
    }

    /// A cell with its taps, and whether it is of the steep class.
    #[inline(always)]
    fn sample(&self, runs: &[&[W]], row: usize, col: usize) -> (Sample, bool) {
        let near: [i64; 4] = std::array::from_fn(|k| runs[k][col].wide());
        let above = |k: usize| near[k].wrapping_sub(near[0]);
        let base = near[0].wrapping_add(above(1).wrapping_add(above(2)).wrapping_add(above(3)) >> 2);
        let relative = |value: W| value.wide().wrapping_sub(base) as f32;
        let line = self.original.row(row);
        let mut sample = Sample { taps: [0.0; ROW], target: relative(line[col]), weight: 0.0 };
        for (tap, run) in sample.taps.iter_mut().zip(runs) {
            *tap = relative(run[col]);
        }
        if self.serial {
            sample.taps[self.taps - 2] = relative(line[col - 1]);
            sample.taps[self.taps - 1] = relative(line[col - 2]);
        }
        let t = &sample.taps;
        let spread = (t[0].abs() + t[1].abs() + (t[2].abs() + t[3].abs())) * 0.25;
        let (one, other) = match self.pass {
            Pass::C => (t[0] - t[3], t[1] - t[2]),
            _ => (t[0] - t[1], t[2] - t[3]),
        };
        let is_steep = one.abs() + other.abs() > 2.0 * self.step as f32;
        let expected = 0.2 * spread + 0.3 * self.step as f32;
        sample.weight = 1.0 / (expected * expected);
        (sample, is_steep)
    }
}

/// By how much a filter misses a sample's target. Taps that a pass has not are 0.
#[inline(always)]
pub(super) fn miss(sample: &Sample, filter: &[f32; ROW]) -> f32 {
    let mut sums = [0.0f32; 8];
    for (taps, weights) in sample.taps.as_chunks::<8>().0.iter().zip(filter.as_chunks::<8>().0) {
        for ((sum, tap), weight) in sums.iter_mut().zip(taps).zip(weights) {
            *sum += tap * weight;
        }
    }
    let [a, b, c, d, e, f, g, h] = sums;
    sample.target - ((a + e) + (b + f) + ((c + g) + (d + h)))
}
