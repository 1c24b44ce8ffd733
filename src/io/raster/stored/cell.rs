//! Cells between GDAL and memory without a conversion: the buffer's type is the band's own.
#![allow(
    unsafe_code,
    reason = "the safe bindings know no signed bytes before GDAL 3.7, and convert where types differ"
)]

use gdal::errors::GdalError;
use gdal::raster::RasterBand;
use gdal_sys::{CPLErr, GDALDataType, GDALRWFlag};

mod sealed {
    pub trait Sealed {}
}

/// A number type that bands store. Every pattern of bits is a value of it.
pub trait StoredCell: Copy + Default + PartialEq + Send + Sync + sealed::Sealed + 'static {
    /// The value of bits that are zero-extended.
    fn from_bits(bits: u64) -> Self;
    /// The value's bits, zero-extended.
    fn to_bits(self) -> u64;
}

macro_rules! stored_integer {
    ($($t:ty => $unsigned:ty),*) => {$(
        impl sealed::Sealed for $t {}
        impl StoredCell for $t {
            #[allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "the low bits are the value's")]
            fn from_bits(bits: u64) -> Self {
                bits as $unsigned as $t
            }
            #[allow(clippy::cast_sign_loss, reason = "bits have no sign")]
            fn to_bits(self) -> u64 {
                u64::from(self as $unsigned)
            }
        }
    )*};
}
stored_integer!(u8 => u8, i8 => u8, u16 => u16, i16 => u16, u32 => u32, i32 => u32);

macro_rules! stored_float {
    ($($t:ty => $unsigned:ty),*) => {$(
        impl sealed::Sealed for $t {}
        impl StoredCell for $t {
            #[allow(clippy::cast_possible_truncation, reason = "the low bits are the value's")]
            fn from_bits(bits: u64) -> Self {
                <$t>::from_bits(bits as $unsigned)
            }
            fn to_bits(self) -> u64 {
                u64::from(<$t>::to_bits(self))
            }
        }
    )*};
}
stored_float!(f32 => u32, f64 => u64);

/// Reads a window (column, row, columns, rows) of a band.
pub(super) fn read<T: StoredCell>(band: &RasterBand<'_>, window: [usize; 4], cells: &mut [T]) -> Result<(), GdalError> {
    transfer(band, GDALRWFlag::GF_Read, window, cells)
}

/// Writes a window of a band. Drivers may swap the bytes of the cells for a while, but leave them as they were.
pub(super) fn write<T: StoredCell>(
    band: &RasterBand<'_>,
    window: [usize; 4],
    cells: &mut [T],
) -> Result<(), GdalError> {
    transfer(band, GDALRWFlag::GF_Write, window, cells)
}

fn transfer<T: StoredCell>(
    band: &RasterBand<'_>,
    direction: GDALRWFlag::Type,
    window: [usize; 4],
    cells: &mut [T],
) -> Result<(), GdalError> {
    // SAFETY: the band lives as long as the borrow.
    let (handle, kind) = unsafe {
        let handle = band.c_rasterband();
        (handle, gdal_sys::GDALGetRasterDataType(handle))
    };
    // Byte is the type of signed bytes too; which of both it is the band's metadata says.
    // SAFETY: the function looks a number up in a table.
    let bytes = unsafe { gdal_sys::GDALGetDataTypeSizeBytes(kind) };
    let [col, row, width, height] = window;
    let fits = kind != GDALDataType::GDT_Unknown
        && usize::try_from(bytes) == Ok(size_of::<T>())
        && width.checked_mul(height) == Some(cells.len());
    if !fits {
        return Err(GdalError::BadArgument(format!("{} cells do not fit the window {window:?}", cells.len())));
    }
    // SAFETY: as many cells of as many bytes as GDAL will touch, rows without gaps; any bits are a value.
    let result = unsafe {
        gdal_sys::GDALRasterIO(
            handle,
            direction,
            i32::try_from(col)?,
            i32::try_from(row)?,
            i32::try_from(width)?,
            i32::try_from(height)?,
            cells.as_mut_ptr().cast(),
            i32::try_from(width)?,
            i32::try_from(height)?,
            kind,
            0,
            0,
        )
    };
    if result == CPLErr::CE_None {
        return Ok(());
    }
    Err(GdalError::CplError { class: result, number: 0, msg: String::new() })
}
