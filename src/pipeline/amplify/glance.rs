//! What a page shows of a run: the middle of the raster before and after, and how far means are off everywhere.

use super::cell_size::CellSize;
use super::likeness::slopes;
use super::terrain::Terrain;
use crate::amplify::Plane;
use crate::error::Result;
use crate::figures::AmplifiedPage;
use crate::grid::GeoTransform;
use crate::plot::map::{MapOptions, Overlay, Relief, draw};
use std::ops::Range;

/// Most rows and columns of fine cells in the middle that are shown.
const SHOWN: usize = 768;
/// Most blocks along a side of the map of consistency.
const BLOCKS: usize = 64;
/// Width of a picture in pixels.
const PICTURE_PX: u32 = 560;
/// Bins of a degree.
const DEGREES: usize = 90;
/// Fewest columns that a spectrum is made of, and most rows.
const FEWEST: usize = 16;
const LINES: usize = 128;

/// What is kept while the output is made.
#[derive(Clone, Debug)]
pub(super) struct Glance {
    /// Rows and columns of the input.
    size: [usize; 2],
    factor: usize,
    /// Input cells shown: first row and column, rows and columns.
    part: [usize; 4],
    /// The output's cells there; NaN for voids.
    fine: Vec<f32>,
    /// Rows and columns of input cells of a block, and the greatest deviation in each, NaN without data.
    block: [usize; 2],
    worst: Vec<f64>,
}

/// Numbers of a page. All have four digits, as more would say no more.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    /// Input cells in the middle that slopes and spectra are of: first row and column, rows and columns.
    pub part: [usize; 4],
    /// The median slope of input and output, each at its own cells, in degrees; nothing where there is none.
    pub median_slope_deg: [Option<f64>; 2],
    /// The slope that a tenth of the cells exceeds.
    pub steep_slope_deg: [Option<f64>; 2],
    /// Relief by wavelength along rows, of input and output: wavelengths in metres, and power per octave in m².
    pub spectra: [Vec<[f64; 2]>; 2],
}

impl Glance {
    pub(super) fn new(size: [usize; 2], factor: usize) -> Self {
        let shown = size.map(|side| side.min((SHOWN / factor).max(1)));
        let part = [(size[0] - shown[0]) / 2, (size[1] - shown[1]) / 2, shown[0], shown[1]];
        let block = size.map(|side| side.div_ceil(BLOCKS));
        let blocks = size[0].div_ceil(block[0]) * size[1].div_ceil(block[1]);
        let fine = vec![f32::NAN; shown[0] * shown[1] * factor * factor];
        Self { size, factor, part, fine, block, worst: vec![f64::NAN; blocks] }
    }

    /// Takes what it needs of a strip: some rows of the input, their fine cells, and how far the mean of each input cell is
    /// off, NaN for voids.
    pub(super) fn take(&mut self, rows: &Range<usize>, cells: &[f32], deviations: &[f64]) {
        let (cols, factor) = (self.size[1], self.factor);
        let across = cols.div_ceil(self.block[1]);
        for (i, &deviation) in deviations.iter().enumerate() {
            let (row, col) = (rows.start + i / cols, i % cols);
            let worst = &mut self.worst[row / self.block[0] * across + col / self.block[1]];
            // Whatever is larger than what may be no number.
            if deviation >= 0.0 && (worst.is_nan() || deviation > *worst) {
                *worst = deviation;
            }
        }
        let [top, left, high, wide] = self.part;
        for row in rows.start.max(top)..rows.end.min(top + high) {
            for col in left..left + wide {
                if deviations[(row - rows.start) * cols + col].is_nan() {
                    continue;
                }
                for line in 0..factor {
                    let from = ((row - rows.start) * factor + line) * cols * factor + col * factor;
                    let to = ((row - top) * factor + line) * wide * factor + (col - left) * factor;
                    self.fine[to..to + factor].copy_from_slice(&cells[from..from + factor]);
                }
            }
        }
    }

    /// The numbers, and the page in HTML with `facts` at its head.
    ///
    /// # Errors
    /// When the input cannot be read again, or a picture cannot be drawn.
    pub(super) fn page(
        self,
        terrain: &Terrain,
        title: &str,
        mut facts: Vec<(String, String)>,
    ) -> Result<(Figures, String)> {
        let [top, left, high, wide] = self.part;
        let unit_m = terrain.unit_m();
        let metres = |heights: Vec<f64>| heights.into_iter().map(|height| height * unit_m).collect();
        let before = Plane::new(high, wide, metres(terrain.read([top, left], [high, wide])?));
        let fine = metres(self.fine.iter().map(|&height| f64::from(height)).collect());
        let after = Plane::new(high * self.factor, wide * self.factor, fine);
        let cells = [terrain.cell, terrain.cell.divided(self.factor)];
        let both = [&before, &after];
        let mut found = [0, 1].map(|i| slopes(both[i], cells[i]));
        found.iter_mut().for_each(|slopes| slopes.sort_unstable_by(f64::total_cmp));
        let [input, output] = &found;
        let at = |slopes: &[f64], part: usize| {
            slopes.get((slopes.len() * part / 10).min(slopes.len().saturating_sub(1))).map(|&slope| degrees(slope))
        };
        let figures = Figures {
            part: self.part,
            median_slope_deg: [at(input, 5), at(output, 5)].map(|slope| slope.map(short)),
            steep_slope_deg: [at(input, 9), at(output, 9)].map(|slope| slope.map(short)),
            spectra: [0, 1].map(|i| spectrum(both[i], cells[i])),
        };
        facts.extend(figures.facts());

        // Both with the same light: relief is as large in both.
        let steep = figures.median_slope_deg[1].unwrap_or(0.0).to_radians().tan();
        let options = MapOptions {
            width_px: PICTURE_PX,
            sea_level_m: None,
            exaggeration: Some((0.3 / steep.max(1e-6)).clamp(1.0, 8.0)),
            ..MapOptions::default()
        };
        let crs = terrain.crs()?;
        let transform = terrain.transform().unwrap_or(GeoTransform::PIXELS).window(top as f64, left as f64);
        let picture = |plane: &Plane, transform: GeoTransform| {
            let heights = plane.heights_m().iter().map(|&height| height as f32).collect();
            let relief = Relief::new(plane.rows(), plane.cols(), heights, transform, crs.as_ref())?;
            draw(&relief, &Overlay::default(), &options).map(|map| map.png)
        };
        let parts = 1.0 / self.factor as f64;
        let pictures = [picture(&before, transform)?, picture(&after, transform.scaled(parts, parts))?];
        let [was, is] = cells.map(|cell| format!("cells of {cell}"));
        let words = [format!("input, {was}: the middle"), format!("output, {is}: the same place")];
        let html = AmplifiedPage {
            title,
            facts: &facts,
            pictures: [(&words[0], &pictures[0]), (&words[1], &pictures[1])],
            slopes: [shares(input), shares(output)],
            spectra: [&figures.spectra[0], &figures.spectra[1]],
            worst_m: &self.worst.iter().map(|worst| worst * unit_m).collect::<Vec<f64>>(),
            columns: self.size[1].div_ceil(self.block[1]),
        }
        .html();
        Ok((figures, html))
    }
}

impl Figures {
    /// The numbers with their names.
    fn facts(&self) -> Vec<(String, String)> {
        let [row, col, rows, cols] = self.part;
        let pair = |name: &str, [input, output]: [Option<f64>; 2], unit: &str| {
            let words = |value: Option<f64>| value.map_or("none".into(), |value| format!("{value} {unit}"));
            (name.to_string(), format!("{} in the input, {} in the output", words(input), words(output)))
        };
        let mut facts = vec![
            ("part shown".into(), format!("{cols} x {rows} cells of the input from column {col}, row {row}")),
            pair("median slope", self.median_slope_deg, "degrees"),
            pair("slope of a tenth at least", self.steep_slope_deg, "degrees"),
        ];
        let [input, output] = &self.spectra;
        for &[wavelength_m, power] in output {
            let own = input.iter().find(|point| point[0] == wavelength_m).map(|point| point[1]);
            facts.push(pair(&format!("power per octave at {wavelength_m} m"), [own, Some(power)], "m²"));
        }
        facts
    }
}

fn degrees(slope: f64) -> f64 {
    slope.atan().to_degrees()
}

/// What part of sorted slopes lies in each bin of a degree; nothing where there are no slopes.
fn shares(slopes: &[f64]) -> Option<Vec<f64>> {
    let mut shares = vec![0.0; DEGREES];
    for &slope in slopes {
        shares[(degrees(slope) as usize).min(DEGREES - 1)] += 1.0 / slopes.len() as f64;
    }
    (!slopes.is_empty()).then_some(shares)
}

/// Power per octave along rows, by wavelength from the longest, an octave a point: each of a number of rows without
/// voids, less its line from end to end, through Hann's window. Octaves are the same for cells that are a whole number of
/// times finer only where that number is a power of two.
fn spectrum(plane: &Plane, cell: CellSize) -> Vec<[f64; 2]> {
    let count = plane.cols();
    if count < FEWEST {
        return vec![];
    }
    let turn = |i: usize| (2.0 * std::f64::consts::PI * i as f64 / count as f64).sin_cos();
    let turns: Vec<(f64, f64)> = (0..count).map(turn).collect();
    let window: Vec<f64> = (0..count).map(|i| 0.5 - 0.5 * turns[i].1).collect();
    let squares: f64 = window.iter().map(|w| w * w).sum();
    let mut powers = vec![0.0; count / 2 + 1];
    let lines = (0..plane.rows()).step_by(plane.rows().div_ceil(LINES).max(1));
    let whole: Vec<&[f64]> = lines.map(|row| plane.row(row)).filter(|row| !row.iter().any(|v| v.is_nan())).collect();
    for row in &whole {
        let (first, last) = (row[0], row[count - 1]);
        let line = |i: usize| first + (last - first) * i as f64 / (count - 1) as f64;
        let values: Vec<f64> = (0..count).map(|i| (row[i] - line(i)) * window[i]).collect();
        for (wave, power) in powers.iter_mut().enumerate().skip(1) {
            let (mut re, mut im) = (0.0, 0.0);
            let mut at = 0;
            for value in &values {
                re += value * turns[at].1;
                im += value * turns[at].0;
                at += wave;
                at -= if at >= count { count } else { 0 };
            }
            *power += 2.0 * (re * re + im * im) / (squares * count as f64 * whole.len() as f64);
        }
    }
    let mut points = vec![];
    // Waves 2 and 3, 4 to 7 and so on: what the window leaves of the line lies below.
    let mut wave = 2;
    while wave < powers.len() && !whole.is_empty() {
        let end = (2 * wave).min(powers.len());
        // An octave that is not whole counts as if it were.
        let part = (2.0 * wave as f64 - wave as f64) / (end - wave) as f64;
        let power: f64 = powers[wave..end].iter().sum();
        points.push([short(count as f64 * cell.across_m / wave as f64), short(power * part)]);
        wave *= 2;
    }
    points
}

/// A number with four digits.
fn short(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELL: CellSize = CellSize { across_m: 10.0, down_m: 10.0 };

    #[test]
    fn a_wave_has_its_power_in_its_octave() {
        // 5 m high, 128 waves of 80 m each: its mean square is 12.5 m².
        let wave = |i: usize| 5.0 * (2.0 * std::f64::consts::PI * (i % 1024) as f64 / 8.0).sin();
        let found = spectrum(&Plane::new(3, 1024, (0..3 * 1024).map(wave).collect()), CELL);
        let longest: Vec<f64> = found.iter().map(|point| point[0]).collect();
        assert_eq!(longest[..3], [5120.0, 2560.0, 1280.0]);
        for [wavelength, power] in found {
            // The window spreads it by a wave to both sides.
            match wavelength {
                80.0 | 160.0 => continue,
                _ => assert!(power < 0.05, "{wavelength}: {power}"),
            }
        }
        let two: f64 = spectrum(&Plane::new(1, 1024, (0..1024).map(wave).collect()), CELL)
            .iter()
            .filter(|point| point[0] == 80.0 || point[0] == 160.0)
            .map(|point| point[1])
            .sum();
        assert!((two - 12.5).abs() < 0.1, "{two}");
        assert_eq!(spectrum(&Plane::new(1, 15, vec![1.0; 15]), CELL), Vec::<[f64; 2]>::new());
        assert_eq!(spectrum(&Plane::new(1, 16, vec![f64::NAN; 16]), CELL), Vec::<[f64; 2]>::new());
    }

    #[test]
    fn strips_make_up_the_whole() {
        let size = [150, 70];
        let factor = 12;
        let mut glance = Glance::new(size, factor);
        assert_eq!(glance.part, [43, 3, 64, 64]);
        let wide = 70 * factor;
        let fine: Vec<f32> = (0..150 * factor * wide).map(|i| i as f32).collect();
        let mut deviations: Vec<f64> = (0..150 * 70).map(|i| f64::from(i % 100)).collect();
        (0..6).for_each(|i| deviations[i / 2 * 70 + i % 2] = f64::NAN);
        deviations[50 * 70 + 10] = f64::NAN;
        for rows in [0..1, 1..48, 48..150] {
            let cells = &fine[rows.start * factor * wide..rows.end * factor * wide];
            glance.take(&rows, cells, &deviations[rows.start * 70..rows.end * 70]);
        }
        for (i, &found) in glance.fine.iter().enumerate() {
            let (row, col) = (43 * factor + i / (64 * factor), 3 * factor + i % (64 * factor));
            let known = (row / factor, col / factor) != (50, 10);
            assert!(if known { found == (row * wide + col) as f32 } else { found.is_nan() });
        }
        // Blocks of 3 x 2 cells.
        assert_eq!(glance.block, [3, 2]);
        assert!(glance.worst[0].is_nan());
        assert_eq!(
            glance.worst[1],
            [2, 3, 72, 73, 142, 143].map(|i| f64::from(i % 100)).into_iter().fold(0.0, f64::max)
        );
        assert_eq!(glance.worst.len(), 50 * 35);
    }

    #[test]
    fn few_digits() {
        assert_eq!([short(1234.56), short(0.000_123_46), short(0.0), short(99_999.0)], [1235.0, 0.000_123_5, 0.0, 1e5]);
    }
}
