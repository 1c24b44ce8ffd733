//! The integers that a tile's cells become: 32 bits where they fit, 64 where they do not.
//!
//! All arithmetic wraps, in encoder and decoder alike: a prediction that overflows is a bad prediction and no more.

/// A wrapping integer.
pub(super) trait Word: Copy + Default + Send + Sync + PartialEq + std::fmt::Debug + 'static {
    /// The low bits of a 64-bit number.
    fn from_wide(value: i64) -> Self;
    /// The same number in 64 bits.
    fn wide(self) -> i64;
    /// Wrapping sum.
    fn plus(self, other: Self) -> Self;
    /// Wrapping difference.
    fn minus(self, other: Self) -> Self;
    /// Wrapping product with a small factor.
    fn times(self, factor: i32) -> Self;
    /// Arithmetic shift to the right.
    fn halved(self, times: u32) -> Self;
    /// Wrapping shift to the left.
    fn doubled(self, times: u32) -> Self;
    /// Magnitude, saturated to 32 bits.
    fn magnitude(self) -> u32;
    /// Whether it is less than 0.
    fn is_negative(self) -> bool;
    /// The error, in quarters, of a cell that this jump from its prediction gives, where the prediction was rounded
    /// by `rest` 1024ths; at most `2^20`.
    fn fine_error(self, rest: Self) -> u32;
}

impl Word for i32 {
    #[inline(always)]
    fn from_wide(value: i64) -> Self {
        value as i32
    }
    #[inline(always)]
    fn wide(self) -> i64 {
        i64::from(self)
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.wrapping_sub(other)
    }
    #[inline(always)]
    fn times(self, factor: i32) -> Self {
        self.wrapping_mul(factor)
    }
    #[inline(always)]
    fn halved(self, times: u32) -> Self {
        self >> times
    }
    #[inline(always)]
    fn doubled(self, times: u32) -> Self {
        self << times
    }
    #[inline(always)]
    fn magnitude(self) -> u32 {
        self.unsigned_abs()
    }
    #[inline(always)]
    fn is_negative(self) -> bool {
        self < 0
    }
    #[inline(always)]
    fn fine_error(self, rest: Self) -> u32 {
        // Beyond 2^19 the error is at its limit whatever the rest; up to there nothing overflows.
        let jump = self.clamp(-(1 << 19), 1 << 19) << 10;
        ((jump.wrapping_sub(rest).unsigned_abs()) >> 8).min(1 << 20)
    }
}

impl Word for i64 {
    #[inline(always)]
    fn from_wide(value: i64) -> Self {
        value
    }
    #[inline(always)]
    fn wide(self) -> i64 {
        self
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.wrapping_sub(other)
    }
    #[inline(always)]
    fn times(self, factor: i32) -> Self {
        self.wrapping_mul(i64::from(factor))
    }
    #[inline(always)]
    fn halved(self, times: u32) -> Self {
        self >> times
    }
    #[inline(always)]
    fn doubled(self, times: u32) -> Self {
        self << times
    }
    #[inline(always)]
    fn magnitude(self) -> u32 {
        u32::try_from(self.unsigned_abs()).unwrap_or(u32::MAX)
    }
    #[inline(always)]
    fn is_negative(self) -> bool {
        self < 0
    }
    #[inline(always)]
    fn fine_error(self, rest: Self) -> u32 {
        let jump = self.clamp(-(1 << 19), 1 << 19) << 10;
        ((jump.wrapping_sub(rest).unsigned_abs()) >> 8).min(1 << 20) as u32
    }
}
