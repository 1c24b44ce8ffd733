//! A stored value as the bits of its type: exact, NaN and -0.0 included.

use super::elevations::SampleType;

impl SampleType {
    /// Whether the type is one of floats.
    pub fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// The bits of a value (little-endian, zero-extended), if the type has that value.
    ///
    /// Of Float32 it is the nearest: whoever writes -9999.9 means that. Every NaN is the usual quiet one.
    pub fn bits_of(self, value: f64) -> Option<u64> {
        let whole = |low: f64, high: f64, mask: u64| {
            let fits = value.fract() == 0.0 && (low..=high).contains(&value);
            // Negative numbers wrap round to the type's own bits.
            fits.then_some(value as i64 as u64 & mask)
        };
        match self {
            Self::U8 => whole(0.0, f64::from(u8::MAX), 0xff),
            Self::I8 => whole(f64::from(i8::MIN), f64::from(i8::MAX), 0xff),
            Self::U16 => whole(0.0, f64::from(u16::MAX), 0xffff),
            Self::I16 => whole(f64::from(i16::MIN), f64::from(i16::MAX), 0xffff),
            Self::U32 => whole(0.0, f64::from(u32::MAX), 0xffff_ffff),
            Self::I32 => whole(f64::from(i32::MIN), f64::from(i32::MAX), 0xffff_ffff),
            Self::F32 if value.is_nan() => Some(u64::from(f32::NAN.to_bits())),
            Self::F32 => {
                let near = value as f32;
                (near.is_finite() || value.is_infinite()).then_some(u64::from(near.to_bits()))
            }
            Self::F64 if value.is_nan() => Some(f64::NAN.to_bits()),
            Self::F64 => Some(value.to_bits()),
        }
    }

    /// The value of bits as [`SampleType::bits_of`] gives them.
    #[allow(clippy::cast_possible_truncation, reason = "the low bits are those of the type")]
    pub fn value_of_bits(self, bits: u64) -> f64 {
        match self {
            Self::U8 => f64::from(bits as u8),
            Self::I8 => f64::from(bits as u8 as i8),
            Self::U16 => f64::from(bits as u16),
            Self::I16 => f64::from(bits as u16 as i16),
            Self::U32 => f64::from(bits as u32),
            Self::I32 => f64::from(bits as u32 as i32),
            Self::F32 => f64::from(f32::from_bits(bits as u32)),
            Self::F64 => f64::from_bits(bits),
        }
    }

    /// The least and the greatest finite value.
    pub fn range(self) -> (f64, f64) {
        match self {
            Self::U8 => (0.0, f64::from(u8::MAX)),
            Self::I8 => (f64::from(i8::MIN), f64::from(i8::MAX)),
            Self::U16 => (0.0, f64::from(u16::MAX)),
            Self::I16 => (f64::from(i16::MIN), f64::from(i16::MAX)),
            Self::U32 => (0.0, f64::from(u32::MAX)),
            Self::I32 => (f64::from(i32::MIN), f64::from(i32::MAX)),
            Self::F32 => (f64::from(f32::MIN), f64::from(f32::MAX)),
            Self::F64 => (f64::MIN, f64::MAX),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_back() {
        for (sample, value, bits) in [
            (SampleType::U8, 255.0, 0xff),
            (SampleType::I8, -128.0, 0x80),
            (SampleType::U16, 65535.0, 0xffff),
            (SampleType::I16, -32768.0, 0x8000),
            (SampleType::I16, -9999.0, 0xd8f1),
            (SampleType::U32, 4_294_967_295.0, 0xffff_ffff),
            (SampleType::I32, -2_147_483_648.0, 0x8000_0000),
            (SampleType::F32, -9999.0, 0xc61c_3c00),
            (SampleType::F32, f64::NEG_INFINITY, 0xff80_0000),
            (SampleType::F64, -0.0, 1 << 63),
        ] {
            assert_eq!(sample.bits_of(value), Some(bits), "{value} as {sample:?}");
            assert_eq!(sample.value_of_bits(bits).to_bits(), value.to_bits(), "{bits:#x} of {sample:?}");
        }
        for sample in [SampleType::F32, SampleType::F64] {
            let bits = sample.bits_of(f64::NAN).expect("floats have NaN");
            assert!(sample.value_of_bits(bits).is_nan());
        }
    }

    #[test]
    fn values_that_the_type_lacks() {
        for (sample, value) in [
            (SampleType::U8, -9999.0),
            (SampleType::U8, 0.5),
            (SampleType::I8, 128.0),
            (SampleType::I16, f64::NAN),
            (SampleType::I32, f64::INFINITY),
            (SampleType::F32, -1.797_693_134_862_315_7e308),
        ] {
            assert_eq!(sample.bits_of(value), None, "{value} as {sample:?}");
        }
    }
}
