//! The cells of a tile in the type that the raster stores.

use crate::grid::SampleType;

/// Cells of one tile and band, row-major, as stored.
#[derive(Clone, Debug, PartialEq)]
pub enum Cells {
    /// 8-bit unsigned integers.
    U8(Vec<u8>),
    /// 8-bit signed integers.
    I8(Vec<i8>),
    /// 16-bit unsigned integers.
    U16(Vec<u16>),
    /// 16-bit signed integers.
    I16(Vec<i16>),
    /// 32-bit unsigned integers.
    U32(Vec<u32>),
    /// 32-bit signed integers.
    I32(Vec<i32>),
    /// Single-precision floats.
    F32(Vec<f32>),
    /// Double-precision floats.
    F64(Vec<f64>),
}

/// Runs the same code on whichever vector a [`Cells`] holds.
#[macro_export]
#[doc(hidden)]
macro_rules! with_cells {
    ($cells:expr, $values:ident => $body:expr) => {
        match $cells {
            $crate::codec::Cells::U8($values) => $body,
            $crate::codec::Cells::I8($values) => $body,
            $crate::codec::Cells::U16($values) => $body,
            $crate::codec::Cells::I16($values) => $body,
            $crate::codec::Cells::U32($values) => $body,
            $crate::codec::Cells::I32($values) => $body,
            $crate::codec::Cells::F32($values) => $body,
            $crate::codec::Cells::F64($values) => $body,
        }
    };
}

impl Cells {
    /// So many cells of a type, all 0.
    pub fn zeros(sample: SampleType, count: usize) -> Self {
        match sample {
            SampleType::U8 => Self::U8(vec![0; count]),
            SampleType::I8 => Self::I8(vec![0; count]),
            SampleType::U16 => Self::U16(vec![0; count]),
            SampleType::I16 => Self::I16(vec![0; count]),
            SampleType::U32 => Self::U32(vec![0; count]),
            SampleType::I32 => Self::I32(vec![0; count]),
            SampleType::F32 => Self::F32(vec![0.0; count]),
            SampleType::F64 => Self::F64(vec![0.0; count]),
        }
    }

    /// No cells, with room for so many.
    pub(super) fn with_capacity(sample: SampleType, count: usize) -> Self {
        let mut cells = Self::zeros(sample, 0);
        with_cells!(&mut cells, values => values.reserve_exact(count));
        cells
    }

    /// The cells' type.
    pub fn sample(&self) -> SampleType {
        match self {
            Self::U8(_) => SampleType::U8,
            Self::I8(_) => SampleType::I8,
            Self::U16(_) => SampleType::U16,
            Self::I16(_) => SampleType::I16,
            Self::U32(_) => SampleType::U32,
            Self::I32(_) => SampleType::I32,
            Self::F32(_) => SampleType::F32,
            Self::F64(_) => SampleType::F64,
        }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        with_cells!(self, values => values.len())
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Every `2^level`-th cell of every `2^level`-th row of cells that lie in rows of `width`, beginning with the first.
    #[must_use]
    pub fn decimated(&self, width: usize, level: u8) -> Self {
        let step = 1 << level;
        macro_rules! thin {
            ($variant:ident, $values:expr) => {
                Self::$variant(
                    $values.chunks(width).step_by(step).flat_map(|row| row.iter().step_by(step).copied()).collect(),
                )
            };
        }
        match self {
            Self::U8(values) => thin!(U8, values),
            Self::I8(values) => thin!(I8, values),
            Self::U16(values) => thin!(U16, values),
            Self::I16(values) => thin!(I16, values),
            Self::U32(values) => thin!(U32, values),
            Self::I32(values) => thin!(I32, values),
            Self::F32(values) => thin!(F32, values),
            Self::F64(values) => thin!(F64, values),
        }
    }

    /// The cells as little-endian bytes.
    pub fn to_le_bytes(&self) -> Vec<u8> {
        with_cells!(self, values => values.iter().flat_map(|value| value.to_le_bytes()).collect())
    }

    /// Cells of a type from little-endian bytes; `None` unless the bytes are a whole number of cells.
    pub fn from_le_bytes(sample: SampleType, bytes: &[u8]) -> Option<Self> {
        if !bytes.len().is_multiple_of(sample.bytes()) {
            return None;
        }
        macro_rules! read {
            ($variant:ident, $type:ty) => {
                Self::$variant(bytes.as_chunks().0.iter().map(|&chunk| <$type>::from_le_bytes(chunk)).collect())
            };
        }
        Some(match sample {
            SampleType::U8 => Self::U8(bytes.to_vec()),
            SampleType::I8 => read!(I8, i8),
            SampleType::U16 => read!(U16, u16),
            SampleType::I16 => read!(I16, i16),
            SampleType::U32 => read!(U32, u32),
            SampleType::I32 => read!(I32, i32),
            SampleType::F32 => read!(F32, f32),
            SampleType::F64 => read!(F64, f64),
        })
    }
}
