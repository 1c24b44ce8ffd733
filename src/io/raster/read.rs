//! Reading the cells: strips of blocks, each thread with a dataset of its own, straight into keys.

use super::super::messages::{failure, take_failures};
use super::dem::{Dem, Extremes};
use super::source::{NoData, RasterSource, open_dataset};
use super::suspect::find_sentinel;
use crate::error::{Error, ErrorKind, Result};
use crate::grid::{AnyGrid, Elevations, Grid, Key, Sample, SampleType};
use crate::watch::Watch;
use gdal::Dataset;
use gdal::raster::GdalType;
use std::sync::Mutex;

/// Cells that are read at once, about: a strip's values stay in the cache until they are keys.
const STRIP_CELLS: usize = 1 << 20;

impl RasterSource {
    /// Reads the window of the band.
    ///
    /// # Errors
    /// A damaged or truncated file (with the rows where it fails), a raster of voids only, an interrupt.
    pub fn read(&self, watch: &Watch) -> Result<Dem> {
        let grid = match self.elevations.sample_type {
            SampleType::U8 => self.read_as::<u8, i16>(watch).map(AnyGrid::Narrow),
            // GDAL has had 8-bit signed integers since 3.7 and converts them to wider ones itself.
            SampleType::I8 => self.read_as::<i16, i16>(watch).map(AnyGrid::Narrow),
            SampleType::U16 => self.read_or_widen::<u16>(watch),
            SampleType::I16 => self.read_or_widen::<i16>(watch),
            SampleType::U32 => self.read_or_widen_more::<u32>(watch),
            SampleType::I32 => self.read_or_widen_more::<i32>(watch),
            SampleType::F32 => self.read_as::<f32, i32>(watch).map(AnyGrid::Middle),
            SampleType::F64 => self.read_as::<f64, i64>(watch).map(AnyGrid::Wide),
        };
        let grid = grid.map_err(|stop| match stop {
            Stop::Failed(error) => error.at_path(&self.path),
            Stop::NoRoomForVoid => unreachable!("the widest keys have room for every value"),
        })?;
        let extremes = crate::with_grid!(&grid, grid => extremes_of(grid));
        let Some(extremes) = extremes else {
            return Err(Error::new(
                ErrorKind::Input,
                format!("all {} cells are nodata; check --band and --nodata", self.cells()),
            )
            .at_path(&self.path));
        };
        let sentinel = find_sentinel(&grid, &self.elevations, extremes.least, extremes.greatest);
        Ok(Dem {
            grid,
            elevations: self.elevations.clone(),
            transform: self.transform,
            crs: self.crs.clone(),
            is_georeferenced: self.is_georeferenced,
            extremes: Some(extremes),
            sentinel,
            notes: self.notes.clone(),
        })
    }

    /// 16-bit values as 16-bit keys, unless one of them would be taken for a void.
    fn read_or_widen<T: GdalType + Sample + Default>(&self, watch: &Watch) -> std::result::Result<AnyGrid, Stop> {
        match self.read_as::<T, i16>(watch) {
            Err(Stop::NoRoomForVoid) => self.read_as::<T, i32>(watch).map(AnyGrid::Middle),
            other => other.map(AnyGrid::Narrow),
        }
    }

    fn read_or_widen_more<T: GdalType + Sample + Default>(&self, watch: &Watch) -> std::result::Result<AnyGrid, Stop> {
        match self.read_as::<T, i32>(watch) {
            Err(Stop::NoRoomForVoid) => self.read_as::<T, i64>(watch).map(AnyGrid::Wide),
            other => other.map(AnyGrid::Middle),
        }
    }

    fn read_as<T: GdalType + Sample + Default, K: Key>(&self, watch: &Watch) -> std::result::Result<Grid<K>, Stop> {
        let [col, row, cols, rows] = self.window;
        let mut cells = vec![K::default(); rows * cols];
        // Strips begin where blocks do, so that no block is unpacked twice.
        let block = self.block.1.max(1);
        let strip = (STRIP_CELLS / cols.max(1) / block).max(1) * block;
        let mut bounds = vec![row];
        while let Some(&from) = bounds.last().filter(|&&from| from < row + rows) {
            bounds.push(((from / strip + 1) * strip).min(row + rows));
        }
        watch.begin(rows as u64);
        let mut rest = cells.as_mut_slice();
        let mut strips = Vec::new();
        for pair in bounds.windows(2) {
            // In a file whose rows run northwards the first strip of the file is the last of the grid.
            let (lines, tail) = rest.split_at_mut((pair[1] - pair[0]) * cols);
            strips.push((pair[0], lines));
            rest = tail;
        }
        strips.reverse();
        let queue = Mutex::new(strips);
        let failed: Mutex<Option<(usize, Stop)>> = Mutex::new(None);
        let work = || {
            let mut dataset = None;
            loop {
                let next = queue.lock().unwrap_or_else(std::sync::PoisonError::into_inner).pop();
                let Some((from, lines)) = next else { break };
                let strip = Strip { source: self, from, col };
                let done = strip
                    .read::<T, K>(&mut dataset, lines)
                    .and_then(|()| Ok(watch.advance((lines.len() / cols) as u64)?));
                if let Err(stop) = done {
                    let mut failed = failed.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                    // Whichever thread fails first, the message is about the first place in the file.
                    if failed.as_ref().is_none_or(|&(row, _)| from < row) {
                        *failed = Some((from, stop));
                    }
                    break;
                }
            }
        };
        let threads = rayon::current_num_threads().min(bounds.len() - 1);
        if threads <= 1 {
            work();
        } else {
            std::thread::scope(|scope| {
                for _ in 0..threads {
                    scope.spawn(work);
                }
            });
        }
        if let Some((_, stop)) = failed.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner) {
            return Err(stop);
        }
        if self.flips_rows {
            for i in 0..rows / 2 {
                let (upper, lower) = cells.split_at_mut((rows - 1 - i) * cols);
                upper[i * cols..(i + 1) * cols].swap_with_slice(&mut lower[..cols]);
            }
        }
        if self.flips_cols {
            cells.chunks_exact_mut(cols).for_each(<[K]>::reverse);
        }
        Ok(Grid::new(rows, cols, self.wraps, cells))
    }
}

/// Why reading into keys of one width ended early.
enum Stop {
    Failed(Error),
    /// A value has the key that stands for a void: wider keys are needed.
    NoRoomForVoid,
}

impl From<Error> for Stop {
    fn from(error: Error) -> Self {
        Self::Failed(error)
    }
}

/// Some rows of the window.
struct Strip<'a> {
    source: &'a RasterSource,
    /// First row in the file.
    from: usize,
    col: usize,
}

impl Strip<'_> {
    fn read<T: GdalType + Sample + Default, K: Key>(
        &self,
        dataset: &mut Option<(Dataset, Vec<T>, Vec<u8>)>,
        lines: &mut [K],
    ) -> std::result::Result<(), Stop> {
        if dataset.is_none() {
            *dataset = Some((open_dataset(&self.source.path)?, Vec::new(), Vec::new()));
        }
        let (dataset, values, mask) = dataset.as_mut().expect("just opened");
        let cols = self.source.window[2];
        let size = (cols, lines.len() / cols);
        let window = (self.col as isize, self.from as isize);
        let wrong = |error: &gdal::errors::GdalError| {
            failure(
                ErrorKind::Corrupt,
                "the cells cannot be read (is the file damaged or cut short?)",
                &self.source.path,
                error,
            )
            .at_place(format!(
                "band {}, rows {} to {}",
                self.source.band,
                self.from,
                self.from + size.1 - 1
            ))
        };
        let band = dataset.rasterband(self.source.band).map_err(|error| wrong(&error))?;
        values.resize(lines.len(), T::default());
        band.read_into_slice::<T>(window, size, size, values, None).map_err(|error| wrong(&error))?;
        let has_room = self.source.nodata.to_keys(&self.source.elevations, values, lines);
        if self.source.nodata.mask {
            mask.resize(lines.len(), 0);
            let band = band.open_mask_band().map_err(|error| wrong(&error))?;
            band.read_into_slice::<u8>(window, size, size, mask, None).map_err(|error| wrong(&error))?;
            for (key, _) in lines.iter_mut().zip(mask.iter()).filter(|(_, valid)| **valid == 0) {
                *key = K::VOID;
            }
        }
        // Some drivers report a block that cannot be read and carry on with zeros.
        let said = take_failures();
        if !said.is_empty() {
            return Err(Stop::Failed(
                Error::new(ErrorKind::Corrupt, format!("the cells cannot be read: {}", said.join("; ")))
                    .at_place(format!("band {}, rows {} to {}", self.source.band, self.from, self.from + size.1 - 1)),
            ));
        }
        if has_room { Ok(()) } else { Err(Stop::NoRoomForVoid) }
    }
}

impl NoData {
    /// Writes the keys of values; returns whether all of them can be told from voids.
    fn to_keys<T: Sample, K: Key>(&self, elevations: &Elevations, values: &[T], keys: &mut [K]) -> bool {
        let void = self.value.and_then(|value| order_of_value(elevations.sample_type, value));
        let mirrored = elevations.mirrored();
        let key_of = |order: i64| K::from_i64(if mirrored { !order } else { order });
        let mut collides = false;
        match void {
            Some(void) => {
                for (key, &value) in keys.iter_mut().zip(values) {
                    let order = value.order();
                    let is_void = order == void || value.is_nan();
                    let own = key_of(order);
                    collides |= !is_void & (own == K::VOID);
                    *key = if is_void { K::VOID } else { own };
                }
            }
            None => {
                for (key, &value) in keys.iter_mut().zip(values) {
                    let own = key_of(value.order());
                    collides |= !value.is_nan() & (own == K::VOID);
                    *key = if value.is_nan() { K::VOID } else { own };
                }
            }
        }
        !collides
    }
}

/// Order of a nodata value in the band's type, if the type has that value.
fn order_of_value(sample_type: SampleType, value: f64) -> Option<i64> {
    let whole = |low: f64, high: f64| (value.fract() == 0.0 && (low..=high).contains(&value)).then_some(value as i64);
    match sample_type {
        SampleType::U8 => whole(0.0, 255.0),
        SampleType::I8 => whole(-128.0, 127.0),
        SampleType::U16 => whole(0.0, 65535.0).map(|v| v - (1 << 15)),
        SampleType::I16 => whole(-32768.0, 32767.0),
        SampleType::U32 => whole(0.0, f64::from(u32::MAX)).map(|v| v - (1 << 31)),
        SampleType::I32 => whole(f64::from(i32::MIN), f64::from(i32::MAX)),
        // NaN is a void whatever is declared. A value written with fewer digits means the nearest float.
        SampleType::F32 => (!value.is_nan()).then(|| (value as f32).order()),
        SampleType::F64 => (!value.is_nan()).then(|| value.order()),
    }
}

fn extremes_of<K: Key>(grid: &Grid<K>) -> Option<Extremes> {
    use rayon::prelude::*;
    let (least, greatest, cells) = grid
        .cells()
        .par_chunks(1 << 18)
        .map(|chunk| {
            let mut found = (K::from_i64(i64::from(i16::MAX)), K::VOID, 0_u64);
            // The greatest key there is: the least one of the complement.
            found.0 = largest::<K>();
            for &key in chunk {
                let is_void = key == K::VOID;
                found.0 = if is_void { found.0 } else { found.0.min(key) };
                found.1 = found.1.max(key);
                found.2 += u64::from(!is_void);
            }
            found
        })
        .reduce(|| (largest::<K>(), K::VOID, 0), |a, b| (a.0.min(b.0), a.1.max(b.1), a.2 + b.2));
    (cells > 0).then(|| Extremes { least: least.to_i64(), greatest: greatest.to_i64(), cells })
}

fn largest<K: Key>() -> K {
    K::from_i64(!K::VOID.to_i64())
}
