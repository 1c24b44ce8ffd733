//! Reading the cells: strips of blocks, each thread with a dataset of its own, straight into keys.

use super::super::messages::{failure, take_failures};
use super::dem::{Dem, Extremes};
use super::source::{NoData, RasterSource};
use super::strips::{each_strip, strip_bounds};
use super::suspect::find_sentinel;
use crate::error::{Error, ErrorKind, Result};
use crate::grid::{AnyGrid, Elevations, Grid, Key, Sample, SampleType};
use crate::watch::Watch;
use gdal::Dataset;
use gdal::errors::GdalError;
use gdal::raster::GdalType;

/// Cells that are read at once, about: a strip's values stay in the cache until they are keys.
pub(super) const STRIP_CELLS: usize = 1 << 20;

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
            return Err(self.all_void());
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

    /// The error of a raster in which nothing but voids was found.
    pub(super) fn all_void(&self) -> Error {
        let message = format!("all {} cells are nodata; check --band and --nodata", self.cells());
        Error::new(ErrorKind::Input, message).at_path(&self.path)
    }

    fn rows_place(&self, from: usize, rows: usize) -> String {
        format!("band {}, rows {from} to {}", self.band, from + rows - 1)
    }

    /// The error of rows that GDAL cannot read.
    pub(super) fn unreadable(&self, from: usize, rows: usize, error: &GdalError) -> Error {
        let what = "the cells cannot be read (is the file damaged or cut short?)";
        failure(ErrorKind::Corrupt, what, &self.path, error).at_place(self.rows_place(from, rows))
    }

    /// Fails if GDAL complained of rows it has read: some drivers report a block that cannot be read and carry on
    /// with zeros.
    pub(super) fn said_nothing(&self, from: usize, rows: usize) -> Result<()> {
        let said = take_failures();
        if said.is_empty() {
            return Ok(());
        }
        let message = format!("the cells cannot be read: {}", said.join("; "));
        Err(Error::new(ErrorKind::Corrupt, message).at_place(self.rows_place(from, rows)))
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
        let bounds = strip_bounds(row, row + rows, strip);
        watch.begin("reading", rows as u64);
        let mut rest = cells.as_mut_slice();
        let mut strips = Vec::new();
        for pair in bounds.windows(2) {
            let (lines, tail) = rest.split_at_mut((pair[1] - pair[0]) * cols);
            strips.push((pair[0], lines));
            rest = tail;
        }
        each_strip(
            strips,
            || None,
            |dataset, from, lines| -> std::result::Result<(), Stop> {
                let steps = (lines.len() / cols) as u64;
                Strip { source: self, from, col }.read::<T, K>(dataset, lines)?;
                Ok(watch.advance(steps)?)
            },
        )?;
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
            *dataset = Some((self.source.dataset()?, Vec::new(), Vec::new()));
        }
        let (dataset, values, mask) = dataset.as_mut().expect("just opened");
        let cols = self.source.window[2];
        let size = (cols, lines.len() / cols);
        let window = (self.col as isize, self.from as isize);
        let wrong = |error: &GdalError| self.source.unreadable(self.from, size.1, error);
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
        self.source.said_nothing(self.from, size.1)?;
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
