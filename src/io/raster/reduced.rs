//! Reading a raster coarser than it is: each cell the mean of what it covers.
//!
//! Overviews are used where the file has them. GDAL's own averaging is not: it knows no nodata value but the declared
//! one, and rounds the means of some types.

use super::read::STRIP_CELLS;
use super::source::{NoData, RasterSource};
use super::strips::{each_strip, strip_bounds};
use super::suspect::{Ends, Sentinel};
use crate::error::Result;
use crate::grid::{Elevations, GeoTransform, SampleType};
use crate::watch::Watch;
use gdal::Dataset;
use gdal::errors::GdalError;
use gdal::raster::{GdalType, RasterBand};
use std::sync::{Mutex, PoisonError};

/// Elevations at a resolution that may be lower than the file's.
#[derive(Clone, Debug)]
pub struct Reduced {
    /// Number of rows, from north to south.
    pub rows: usize,
    /// Number of columns, from west to east.
    pub cols: usize,
    /// Elevations in metres, row-major; NaN where there is no data.
    pub elevation_m: Vec<f32>,
    /// Where the cells are.
    pub transform: GeoTransform,
    /// A value that looks like nodata without being declared so.
    pub sentinel: Option<Sentinel>,
}

impl RasterSource {
    /// Reads the window of the band with at most so many rows and columns: as it is where it is that small, else
    /// averaged over areas; cells without data take no part.
    ///
    /// Of a file with overviews the coarsest is read that still has half as many rows and columns, or more. Memory
    /// is that of the result and of a few rows of the file.
    ///
    /// # Errors
    /// As [`RasterSource::read`].
    pub fn read_reduced(&self, max_rows: usize, max_cols: usize, watch: &Watch) -> Result<Reduced> {
        let reduced = match self.elevations.sample_type {
            SampleType::U32 | SampleType::I32 | SampleType::F64 => self.reduce::<f64>((max_rows, max_cols), watch),
            _ => self.reduce::<f32>((max_rows, max_cols), watch),
        };
        reduced.map_err(|error| error.at_path(&self.path))
    }

    fn reduce<T: Stored>(&self, most: (usize, usize), watch: &Watch) -> Result<Reduced> {
        let level = self.level(most)?;
        let (rows, cols) = (level.down.count, level.across.count);
        let (first, end) = level.down.reads();
        let width = level.across.reads().1 - level.across.reads().0;
        // A strip holds at least what a row of the result covers, and begins where blocks do.
        let lines = (STRIP_CELLS / width).max(level.down.factor().ceil() as usize);
        let bounds = strip_bounds(first, end, (lines / level.block).max(1) * level.block);
        let strips: Vec<(usize, (usize, usize))> =
            bounds.windows(2).enumerate().map(|(i, pair)| (pair[0], (i, pair[1] - pair[0]))).collect();
        watch.begin("reading", (end - first) as u64);
        let parts: Mutex<Vec<Option<Part>>> = Mutex::new(strips.iter().map(|_| None).collect());
        each_strip(strips, Scratch::<T>::default, |scratch, from, (i, lines)| {
            let part = self.read_part(&level, scratch, from, lines)?;
            parts.lock().unwrap_or_else(PoisonError::into_inner)[i] = Some(part);
            watch.advance(lines as u64)
        })?;
        // Added up in the order of the file, so that threads make no difference to the last bit.
        let mut whole = Part::empty(0, rows * cols);
        for part in parts.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().flatten() {
            whole.add(&part, cols);
        }
        if whole.ends.is_empty() {
            return Err(self.all_void());
        }
        let mut elevation_m: Vec<f32> =
            whole.sums.iter().zip(&whole.weights).map(|(sum, w)| if *w > 0.0 { sum / w } else { f32::NAN }).collect();
        if self.flips_rows {
            for row in 0..rows / 2 {
                let (upper, lower) = elevation_m.split_at_mut((rows - 1 - row) * cols);
                upper[row * cols..(row + 1) * cols].swap_with_slice(&mut lower[..cols]);
            }
        }
        if self.flips_cols {
            elevation_m.chunks_exact_mut(cols).for_each(<[f32]>::reverse);
        }
        let (x, y) = (self.window[2] as f64 / cols as f64, self.window[3] as f64 / rows as f64);
        let transform = self.transform.scaled(y, x);
        Ok(Reduced { rows, cols, elevation_m, transform, sentinel: whole.ends.sentinel() })
    }

    /// Chooses what to read: the file itself, or one of its overviews.
    fn level(&self, most: (usize, usize)) -> Result<Level> {
        let dataset = self.dataset()?;
        let wrong = |error: GdalError| self.unreadable(self.window[1], self.window[3], &error);
        let band = dataset.rasterband(self.band).map_err(wrong)?;
        let [col, row, cols, rows] = self.window.map(|v| v as f64);
        let whole = Level {
            overview: None,
            down: Axis::fit(row, rows, most.0, self.file_size.1),
            across: Axis::fit(col, cols, most.1, self.file_size.0),
            block: self.block.1.max(1),
        };
        let mut best = whole;
        if best.down.factor() <= 1.0 && best.across.factor() <= 1.0 {
            return Ok(best);
        }
        for index in 0..band.overview_count().map_err(wrong)?.max(0) as usize {
            let overview = band.overview(index).map_err(wrong)?;
            let (width, height) = overview.size();
            let (x, y) = (width as f64 / self.file_size.0 as f64, height as f64 / self.file_size.1 as f64);
            // Where the file itself is coarser than half of what may be read, nothing less will do.
            let is_fine = |length: f64, share: f64, most: usize| length * share >= length.min(most as f64 / 2.0);
            // An overview without a mask of its own would show what the mask hides.
            let has_mask = !self.nodata.mask || overview.mask_flags().is_ok_and(|flags| !flags.is_all_valid());
            if is_fine(cols, x, most.1) && is_fine(rows, y, most.0) && has_mask && width < best.across.size {
                best = Level {
                    overview: Some(index),
                    down: Axis::fit(row * y, rows * y, most.0, height),
                    across: Axis::fit(col * x, cols * x, most.1, width),
                    block: overview.block_size().1.max(1),
                };
            }
        }
        Ok(best)
    }

    /// Reads rows of a level and averages them.
    fn read_part<T: Stored>(&self, level: &Level, scratch: &mut Scratch<T>, from: usize, lines: usize) -> Result<Part> {
        if scratch.dataset.is_none() {
            scratch.dataset = Some(self.dataset()?);
        }
        let dataset = scratch.dataset.as_ref().expect("just opened");
        let wrong = |error: GdalError| self.unreadable(from, lines, &error);
        let mut band: RasterBand<'_> = dataset.rasterband(self.band).map_err(wrong)?;
        if let Some(index) = level.overview {
            band = band.overview(index).map_err(wrong)?;
        }
        let (first_col, end_col) = level.across.reads();
        let size = (end_col - first_col, lines);
        let window = (first_col as isize, from as isize);
        let values = &mut scratch.values;
        values.resize(size.0 * size.1, T::default());
        band.read_into_slice::<T>(window, size, size, values, None).map_err(wrong)?;
        self.nodata.blank(self.elevations.sample_type, values);
        if self.nodata.mask {
            scratch.mask.resize(values.len(), 0);
            let mask = band.open_mask_band().map_err(wrong)?;
            mask.read_into_slice::<u8>(window, size, size, &mut scratch.mask, None).map_err(wrong)?;
            for (value, _) in values.iter_mut().zip(&scratch.mask).filter(|(_, valid)| **valid == 0) {
                *value = T::NAN;
            }
        }
        self.said_nothing(from, lines)?;
        let ends = Ends::of(values.iter().map(|value| value.wide()));
        let elevation_m = elevations_m(&self.elevations, values);
        Ok(level.averaged(from, lines, &elevation_m, ends))
    }
}

/// A type in which values are read: one that keeps them exactly.
trait Stored: GdalType + Copy + Default + PartialEq + Send {
    const NAN: Self;
    fn wide(self) -> f64;
    fn narrow(value: f64) -> Self;
}

impl Stored for f32 {
    const NAN: Self = f32::NAN;
    fn wide(self) -> f64 {
        f64::from(self)
    }
    fn narrow(value: f64) -> Self {
        value as f32
    }
}

impl Stored for f64 {
    const NAN: Self = f64::NAN;
    fn wide(self) -> f64 {
        self
    }
    fn narrow(value: f64) -> Self {
        value
    }
}

impl NoData {
    /// Makes values that mean nodata not a number.
    fn blank<T: Stored>(&self, sample_type: SampleType, values: &mut [T]) {
        let is_float = matches!(sample_type, SampleType::F32 | SampleType::F64);
        if let Some(void) = self.value.filter(|value| is_float || value.fract() == 0.0).map(T::narrow) {
            values.iter_mut().filter(|value| **value == void).for_each(|value| *value = T::NAN);
        }
    }
}

fn elevations_m<T: Stored>(elevations: &Elevations, values: &[T]) -> Vec<f32> {
    let (scale, offset, metres) = (elevations.scale, elevations.offset, elevations.unit.metres);
    if (scale, offset, metres) == (1.0, 0.0, 1.0) {
        return values.iter().map(|value| value.wide() as f32).collect();
    }
    values.iter().map(|value| ((value.wide() * scale + offset) * metres) as f32).collect()
}

/// What a thread keeps between strips.
struct Scratch<T> {
    dataset: Option<Dataset>,
    values: Vec<T>,
    mask: Vec<u8>,
}

impl<T> Default for Scratch<T> {
    fn default() -> Self {
        Self { dataset: None, values: Vec::new(), mask: Vec::new() }
    }
}

/// The file or one of its overviews, and how it is averaged.
#[derive(Clone, Copy, Debug)]
struct Level {
    overview: Option<usize>,
    down: Axis,
    across: Axis,
    /// Rows of a block.
    block: usize,
}

/// Rows or columns of a level, and of the result.
#[derive(Clone, Copy, Debug)]
struct Axis {
    /// Where the window begins in the level, and how much of it the window takes; an overview's cells may be cut.
    start: f64,
    length: f64,
    /// Cells of the whole level.
    size: usize,
    /// Cells of the result.
    count: usize,
}

impl Axis {
    fn fit(start: f64, length: f64, most: usize, size: usize) -> Self {
        // As few whole cells as will do, so that means are taken over nearly whole numbers of them.
        let factor = (length / most.max(1) as f64).ceil().max(1.0);
        Self { start, length, size, count: ((length / factor).round() as usize).clamp(1, most.max(1)) }
    }

    /// Cells of the level that a cell of the result covers.
    fn factor(&self) -> f64 {
        self.length / self.count as f64
    }

    /// First cell of the level that is read, and the one after the last.
    fn reads(&self) -> (usize, usize) {
        let first = (self.start.floor() as usize).min(self.size - 1);
        (first, ((self.start + self.length - 1e-6).ceil() as usize).clamp(first + 1, self.size))
    }

    /// Cells of the result that the level's cells from `first` to before `end` touch.
    fn touched(&self, first: usize, end: usize) -> (usize, usize) {
        let at = |cell: usize| (cell as f64 - self.start) / self.factor();
        let from = (at(first) + 1e-9).floor().clamp(0.0, self.count as f64 - 1.0) as usize;
        (from, (at(end) - 1e-9).ceil().clamp(from as f64 + 1.0, self.count as f64) as usize)
    }

    /// The cells of the level from `first` to before `end` that cell `i` of the result covers, and the share of each.
    fn shares(&self, i: usize, first: usize, end: usize) -> impl Iterator<Item = (usize, f32)> + Clone + use<> {
        let (from, to) = (self.start + i as f64 * self.factor(), self.start + (i as f64 + 1.0) * self.factor());
        let low = (from.max(0.0) as usize).max(first);
        let high = ((to - 1e-9).ceil().max(0.0) as usize).min(end);
        (low..high).map(move |cell| {
            let (left, right) = (cell as f64, cell as f64 + 1.0);
            (cell, (right.min(to) - left.max(from)).clamp(0.0, 1.0) as f32)
        })
    }
}

/// Sums over some rows of a level, for the cells of the result that they touch.
#[derive(Debug)]
struct Part {
    /// First row of the result.
    row: usize,
    sums: Vec<f32>,
    weights: Vec<f32>,
    ends: Ends,
}

impl Part {
    fn empty(row: usize, cells: usize) -> Self {
        Self { row, sums: vec![0.0; cells], weights: vec![0.0; cells], ends: Ends::default() }
    }

    fn add(&mut self, part: &Self, cols: usize) {
        let from = (part.row - self.row) * cols;
        let add = |to: &mut [f32], more: &[f32]| to.iter_mut().zip(more).for_each(|(to, more)| *to += more);
        add(&mut self.sums[from..], &part.sums);
        add(&mut self.weights[from..], &part.weights);
        self.ends = self.ends.with(part.ends);
    }
}

impl Level {
    /// Averages rows from `from` on.
    fn averaged(&self, from: usize, lines: usize, elevation_m: &[f32], ends: Ends) -> Part {
        let (first_col, end_col) = self.across.reads();
        let width = end_col - first_col;
        let cols = self.across.count;
        let (row, end_row) = self.down.touched(from, from + lines);
        let mut part = Part::empty(row, (end_row - row) * cols);
        part.ends = ends;
        if self.across.factor() == 1.0 && self.down.factor() == 1.0 && self.across.start.fract() == 0.0 {
            for (i, &value) in elevation_m.iter().enumerate().filter(|(_, value)| value.is_finite()) {
                (part.sums[i], part.weights[i]) = (value, 1.0);
            }
            return part;
        }
        let across: Vec<Vec<(usize, f32)>> = (0..cols)
            .map(|col| self.across.shares(col, first_col, end_col).map(|(c, share)| (c - first_col, share)).collect())
            .collect();
        for to in row..end_row {
            let place = (to - row) * cols;
            let (sums, weights) = (&mut part.sums[place..place + cols], &mut part.weights[place..place + cols]);
            for (line, down) in self.down.shares(to, from, from + lines) {
                let values = &elevation_m[(line - from) * width..(line - from + 1) * width];
                for ((sum, weight), shares) in sums.iter_mut().zip(weights.iter_mut()).zip(&across) {
                    let (mut line_sum, mut line_weight) = (0.0, 0.0);
                    for &(col, share) in shares {
                        if values[col].is_finite() {
                            line_sum += share * values[col];
                            line_weight += share;
                        }
                    }
                    *sum += down * line_sum;
                    *weight += down * line_weight;
                }
            }
        }
        part
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::raster::RasterOptions;
    use gdal::DriverManager;
    use gdal::raster::Buffer;
    use std::path::{Path, PathBuf};

    /// A GeoTIFF of 16-bit integers on a grid of 10 metres.
    fn written(
        dir: &Path,
        (rows, cols): (usize, usize),
        north_up: bool,
        value: impl Fn(usize, usize) -> i16,
    ) -> PathBuf {
        let path = dir.join(format!("{rows}x{cols}-{north_up}.tif"));
        let driver = DriverManager::get_driver_by_name("GTiff").unwrap();
        let mut dataset = driver.create_with_band_type::<i16, _>(&path, cols, rows, 1).unwrap();
        let step = if north_up { -10.0 } else { 10.0 };
        let top = if north_up { 0.0 } else { -10.0 * rows as f64 };
        dataset.set_geo_transform(&[500.0, 10.0, 0.0, top, 0.0, step]).unwrap();
        let at = |i: usize| value(if north_up { i / cols } else { rows - 1 - i / cols }, i % cols);
        let mut buffer = Buffer::new((cols, rows), (0..rows * cols).map(at).collect());
        dataset.rasterband(1).unwrap().write((0, 0), (cols, rows), &mut buffer).unwrap();
        path
    }

    fn reduced(path: &Path, options: &RasterOptions, rows: usize, cols: usize) -> Reduced {
        RasterSource::open(path, options).unwrap().read_reduced(rows, cols, &Watch::default()).unwrap()
    }

    fn void(nodata: f64) -> RasterOptions {
        RasterOptions { nodata: Some(nodata), ..RasterOptions::default() }
    }

    fn rough(row: usize, col: usize) -> i16 {
        (row * 7919 + col * 104_729 + row * col * 13).wrapping_mul(2_654_435_761).to_le_bytes()[2].into()
    }

    #[test]
    fn small_rasters_are_read_as_they_are() {
        let dir = tempfile::tempdir().unwrap();
        let path = written(dir.path(), (3, 4), true, |r, c| if (r, c) == (1, 2) { -9999 } else { (10 * r + c) as i16 });
        let read = reduced(&path, &void(-9999.0), 3, 100);
        assert_eq!((read.rows, read.cols, read.sentinel), (3, 4, None));
        let expected = [0.0, 1.0, 2.0, 3.0, 10.0, 11.0, f32::NAN, 13.0, 20.0, 21.0, 22.0, 23.0];
        assert!(read.elevation_m.iter().zip(expected).all(|(a, b)| *a == b || a.is_nan() && b.is_nan()), "{read:?}");
        assert_eq!(read.transform, GeoTransform([500.0, 10.0, 0.0, 0.0, 0.0, -10.0]));
        let undeclared = reduced(&path, &RasterOptions::default(), 3, 4);
        assert_eq!(undeclared.sentinel, Some(Sentinel { value: -9999.0, cells: 1 }));
    }

    #[test]
    fn cells_are_means_over_areas_without_voids() {
        let dir = tempfile::tempdir().unwrap();
        let (rows, cols) = (23, 31);
        let path = written(dir.path(), (rows, cols), true, rough);
        let window = [2, 3, 29, 19];
        let options = RasterOptions { window: Some(window), ..void(7.0) };
        let read = reduced(&path, &options, 5, 8);
        assert_eq!((read.rows, read.cols), (5, 7));
        let (down, across) = (19.0 / 5.0, 29.0 / 7.0);
        let overlap = |i: usize, factor: f64, cell: usize| {
            ((cell as f64 + 1.0).min((i as f64 + 1.0) * factor) - (cell as f64).max(i as f64 * factor)).max(0.0)
        };
        for i in 0..5 {
            for j in 0..7 {
                let (mut sum, mut weight) = (0.0, 0.0);
                for (r, c) in (0..19).flat_map(|r| (0..29).map(move |c| (r, c))) {
                    let value = f64::from(rough(r + 3, c + 2));
                    let share = overlap(i, down, r) * overlap(j, across, c);
                    if value != 7.0 {
                        (sum, weight) = (sum + share * value, weight + share);
                    }
                }
                let cell = f64::from(read.elevation_m[i * 7 + j]);
                assert!((cell - sum / weight).abs() < 1e-3, "{i} {j}: {cell} {}", sum / weight);
            }
        }
        let t = read.transform.0;
        assert!((t[0] - 520.0).abs() < 1e-9 && (t[3] + 30.0).abs() < 1e-9, "{t:?}");
        assert!((t[1] * 7.0 - 290.0).abs() < 1e-9 && (t[5] * 5.0 + 190.0).abs() < 1e-9, "{t:?}");
    }

    #[test]
    fn files_that_run_northwards_are_turned_round() {
        let dir = tempfile::tempdir().unwrap();
        let options = RasterOptions::default();
        let up = reduced(&written(dir.path(), (40, 24), true, rough), &options, 11, 7);
        let down = reduced(&written(dir.path(), (40, 24), false, rough), &options, 11, 7);
        assert_eq!((up.transform, up.rows, up.cols), (down.transform, down.rows, down.cols));
        assert!(up.elevation_m.iter().zip(&down.elevation_m).all(|(a, b)| (a - b).abs() < 1e-3));
    }

    #[test]
    fn threads_make_no_difference() {
        let dir = tempfile::tempdir().unwrap();
        let path = written(dir.path(), (2311, 1300), true, rough);
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| reduced(&path, &RasterOptions::default(), 300, 170))
        };
        let (one, three) = (with(1), with(3));
        assert_eq!((one.rows, one.cols), (289, 163));
        assert!(one.elevation_m.iter().zip(&three.elevation_m).all(|(a, b)| a.to_bits() == b.to_bits()));
    }

    #[test]
    fn overviews_are_used_where_they_are_fine_enough() {
        let dir = tempfile::tempdir().unwrap();
        let path = written(dir.path(), (400, 600), true, |r, c| (r + c) as i16);
        let mut dataset = Dataset::open_ex(
            &path,
            gdal::DatasetOptions { open_flags: gdal::GdalOpenFlags::GDAL_OF_UPDATE, ..Default::default() },
        )
        .unwrap();
        dataset.build_overviews("AVERAGE", &[2, 4], &[]).unwrap();
        // Told apart from the file itself.
        for index in 0..2 {
            let mut overview = dataset.rasterband(1).unwrap().overview(index).unwrap();
            let size = overview.size();
            let values = vec![1000 * (index as i16 + 1); size.0 * size.1];
            overview.write((0, 0), size, &mut Buffer::new(size, values)).unwrap();
        }
        dataset.close().unwrap();
        let first = |rows: usize, cols: usize| {
            let read = reduced(&path, &RasterOptions::default(), rows, cols);
            (read.rows, read.cols, read.elevation_m[0])
        };
        assert_eq!(first(100, 150), (100, 150, 2000.0));
        assert_eq!(first(199, 299), (100, 150, 2000.0), "half of what may be read is enough");
        assert_eq!(first(201, 301), (200, 300, 1000.0), "but no less");
        assert_eq!(first(400, 600), (400, 600, 0.0));
        let window = RasterOptions { window: Some([100, 0, 200, 200]), ..RasterOptions::default() };
        assert_eq!(reduced(&path, &window, 110, 110).elevation_m[0], 1000.0);
    }

    #[test]
    fn voids_only_are_refused() {
        let dir = tempfile::tempdir().unwrap();
        let path = written(dir.path(), (4, 4), true, |_, _| 5);
        let source = RasterSource::open(&path, &void(5.0)).unwrap();
        let error = source.read_reduced(2, 2, &Watch::default()).unwrap_err().to_string();
        assert!(error.contains("nodata") && error.contains("4x4"), "{error}");
    }
}
