//! What a key means: the stored value, and metres.

use crate::units::LengthUnit;

/// The number type that a raster band stores.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleType {
    /// 8-bit unsigned integers.
    U8,
    /// 8-bit signed integers.
    I8,
    /// 16-bit unsigned integers.
    U16,
    /// 16-bit signed integers.
    I16,
    /// 32-bit unsigned integers.
    U32,
    /// 32-bit signed integers.
    I32,
    /// Single-precision floats.
    F32,
    /// Double-precision floats.
    F64,
}

impl SampleType {
    /// GDAL's name of the type.
    pub fn name(self) -> &'static str {
        match self {
            Self::U8 => "Byte",
            Self::I8 => "Int8",
            Self::U16 => "UInt16",
            Self::I16 => "Int16",
            Self::U32 => "UInt32",
            Self::I32 => "Int32",
            Self::F32 => "Float32",
            Self::F64 => "Float64",
        }
    }

    /// Bytes a cell takes in this type.
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// How keys, stored values and metres belong together.
///
/// `elevation_m = (value * scale + offset) * unit.metres`. Where the scale is negative (depths counted downwards)
/// the keys are mirrored, so that a greater key is always a higher place.
#[derive(Clone, Debug)]
pub struct Elevations {
    /// Type of the stored values.
    pub sample_type: SampleType,
    /// Factor of the stored values; not 0, finite.
    pub scale: f64,
    /// Offset of the scaled values.
    pub offset: f64,
    /// Unit of the scaled values.
    pub unit: LengthUnit,
}

/// Order-preserving integer of a float's bits; `-0.0` and `0.0` share one.
macro_rules! float_order {
    ($name:ident, $back:ident, $float:ty, $int:ty, $uint:ty, $shift:expr) => {
        #[inline]
        fn $name(value: $float) -> $int {
            // Adding +0.0 turns -0.0 into +0.0: they are the same elevation.
            let bits = (value + 0.0).to_bits() as $int;
            bits ^ ((bits >> $shift) as $uint >> 1) as $int
        }

        #[inline]
        fn $back(order: $int) -> $float {
            <$float>::from_bits((order ^ ((order >> $shift) as $uint >> 1) as $int) as $uint)
        }
    };
}
float_order!(f32_order, f32_from_order, f32, i32, u32, 31);
float_order!(f64_order, f64_from_order, f64, i64, u64, 63);

/// A stored value that has a key.
pub trait Sample: Copy + Send + Sync + 'static {
    /// Order-preserving integer of the value, before any mirroring.
    fn order(self) -> i64;
    /// Whether the value is not a number.
    fn is_nan(self) -> bool {
        false
    }
}

macro_rules! integer_sample {
    ($($t:ty => $base:expr),*) => {$(
        impl Sample for $t {
            #[inline]
            fn order(self) -> i64 {
                i64::from(self) - $base
            }
        }
    )*};
}
// Unsigned 16 and 32-bit values are shifted so that they fit signed keys of their own width.
integer_sample!(u8 => 0, i8 => 0, u16 => 1 << 15, i16 => 0, u32 => 1 << 31, i32 => 0);

impl Sample for f32 {
    #[inline]
    fn order(self) -> i64 {
        i64::from(f32_order(self))
    }
    #[inline]
    fn is_nan(self) -> bool {
        self.is_nan()
    }
}

impl Sample for f64 {
    #[inline]
    fn order(self) -> i64 {
        f64_order(self)
    }
    #[inline]
    fn is_nan(self) -> bool {
        self.is_nan()
    }
}

impl Elevations {
    /// Plain metres of a type.
    pub fn metres(sample_type: SampleType) -> Self {
        Self { sample_type, scale: 1.0, offset: 0.0, unit: LengthUnit::metre() }
    }

    /// Whether greater stored values are lower places.
    pub fn mirrored(&self) -> bool {
        self.scale < 0.0
    }

    /// The key of a stored value (as 64 bits; `!` mirrors the order without overflow).
    #[inline]
    pub fn key_of<T: Sample>(&self, value: T) -> i64 {
        if self.mirrored() { !value.order() } else { value.order() }
    }

    /// The stored value of a key.
    #[inline]
    pub fn value(&self, key: i64) -> f64 {
        let order = if self.mirrored() { !key } else { key };
        match self.sample_type {
            SampleType::U8 | SampleType::I8 | SampleType::I16 | SampleType::I32 => order as f64,
            SampleType::U16 => (order + (1 << 15)) as f64,
            SampleType::U32 => (order + (1 << 31)) as f64,
            #[allow(clippy::cast_possible_truncation, reason = "keys of Float32 cells are 32-bit")]
            SampleType::F32 => f64::from(f32_from_order(order as i32)),
            SampleType::F64 => f64_from_order(order),
        }
    }

    /// Elevation of a key in metres.
    #[inline]
    pub fn elevation_m(&self, key: i64) -> f64 {
        (self.value(key) * self.scale + self.offset) * self.unit.metres
    }

    /// Height of one key above another in metres, from the exact difference of the stored values.
    #[inline]
    pub fn height_m(&self, above: i64, below: i64) -> f64 {
        // A negative scale makes -0.0 of no difference; adding 0.0 makes that 0.0, which sorts among the others.
        (self.value(above) - self.value(below)) * self.scale * self.unit.metres + 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn float_keys_sort_as_floats_and_come_back() {
        let values =
            [f32::NEG_INFINITY, f32::MIN, -1.5, -f32::MIN_POSITIVE, -1e-45, 0.0, 1e-45, 1.0, 8848.86, f32::INFINITY];
        for pair in values.windows(2) {
            assert!(pair[0].order() < pair[1].order(), "{pair:?}");
        }
        assert_eq!((-0.0_f32).order(), 0.0_f32.order(), "one zero");
        let plain = Elevations::metres(SampleType::F32);
        let depths = Elevations { scale: -1.0, ..plain.clone() };
        for value in values {
            assert_eq!(plain.value(plain.key_of(value)), f64::from(value));
            assert_eq!(depths.value(depths.key_of(value)), f64::from(value));
            assert!(plain.key_of(value) > i64::from(i32::MIN), "the void's key is free");
        }
        assert!(depths.key_of(2.0_f32) < depths.key_of(1.0_f32), "deeper is lower");
        let wide = Elevations::metres(SampleType::F64);
        for value in [f64::NEG_INFINITY, -1e300, -0.1, 0.0, 5e-324, 1e300] {
            assert_eq!(wide.value(wide.key_of(value)), value);
        }
    }

    #[test]
    fn unsigned_values_fit_signed_keys_of_their_width() {
        let e = Elevations::metres(SampleType::U16);
        assert_eq!((e.key_of(0_u16), e.key_of(u16::MAX)), (-32768, 32767));
        assert_eq!(e.value(e.key_of(40_000_u16)), 40_000.0);
        let e = Elevations::metres(SampleType::U32);
        assert_eq!(e.value(e.key_of(u32::MAX)), f64::from(u32::MAX));
    }
}
