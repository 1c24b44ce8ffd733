//! The integers that a tile's cells become: 32 bits where they fit, 64 where they do not.
//!
//! All arithmetic wraps, in encoder and decoder alike: a prediction that overflows is a bad prediction and no more.

/// Greatest error that is told apart, in quarters of a unit coarsened.
pub(super) const ERROR_LIMIT: u32 = u16::MAX as u32;

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
    /// Wrapping product.
    fn product(self, other: Self) -> Self;
    /// The number itself, or its negative where `sign` is less than 0.
    fn turned(self, sign: Self) -> Self;
    /// The bits that `mask` has too.
    fn kept(self, mask: Self) -> Self;
    /// The low 32 bits.
    fn low(self) -> i32;
    /// The magnitude over `2^shift`, rounded down; four of them add up without overflow.
    fn part(self, shift: u32) -> Self;
    /// The magnitude as an error: in quarters, divided by `2^coarseness`, at most [`ERROR_LIMIT`].
    fn error(self, coarseness: u32) -> u32;
    /// The error, in quarters, of a cell that this jump from its prediction gives, where the prediction was rounded
    /// by `rest` 1024ths; at most [`ERROR_LIMIT`].
    fn fine_error(self, rest: Self) -> u32;
    /// So many whole steps as are nearest; `inverse` is that of the step, which is odd.
    fn in_steps(self, step: i64, inverse: f64) -> Self;
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
    fn product(self, other: Self) -> Self {
        self.wrapping_mul(other)
    }
    #[inline(always)]
    fn turned(self, sign: Self) -> Self {
        let mask = sign >> 31;
        (self ^ mask).wrapping_sub(mask)
    }
    #[inline(always)]
    fn kept(self, mask: Self) -> Self {
        self & mask
    }
    #[inline(always)]
    fn low(self) -> i32 {
        self
    }
    #[inline(always)]
    fn part(self, shift: u32) -> Self {
        (self.unsigned_abs() >> shift).min(1 << 28) as Self
    }
    #[inline(always)]
    fn error(self, coarseness: u32) -> u32 {
        ((self.unsigned_abs().min(1 << 29) << 2) >> coarseness).min(ERROR_LIMIT)
    }
    #[inline(always)]
    fn fine_error(self, rest: Self) -> u32 {
        // Far beyond the limit the rest is nothing; up to there nothing overflows.
        let jump = self.clamp(-(1 << 19), 1 << 19) << 10;
        (jump.wrapping_sub(rest).unsigned_abs() >> 8).min(ERROR_LIMIT)
    }
    #[inline(always)]
    fn in_steps(self, _: i64, inverse: f64) -> Self {
        // The quotient is half a step's inverse or more from where rounding changes, far more than doubles lose; and
        // what is added leaves no room for a fraction, and the whole number in the lowest bits.
        (f64::from(self) * inverse + 1.5 * (1u64 << 52) as f64).to_bits() as i32
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
    fn product(self, other: Self) -> Self {
        self.wrapping_mul(other)
    }
    #[inline(always)]
    fn turned(self, sign: Self) -> Self {
        let mask = sign >> 63;
        (self ^ mask).wrapping_sub(mask)
    }
    #[inline(always)]
    fn kept(self, mask: Self) -> Self {
        self & mask
    }
    #[inline(always)]
    fn low(self) -> i32 {
        self as i32
    }
    #[inline(always)]
    fn part(self, shift: u32) -> Self {
        (self.unsigned_abs() >> shift).min(1 << 60) as Self
    }
    #[inline(always)]
    fn error(self, coarseness: u32) -> u32 {
        ((self.unsigned_abs().min(1 << 61) << 2) >> coarseness).min(u64::from(ERROR_LIMIT)) as u32
    }
    #[inline(always)]
    fn fine_error(self, rest: Self) -> u32 {
        let jump = self.clamp(-(1 << 19), 1 << 19) << 10;
        (jump.wrapping_sub(rest).unsigned_abs() >> 8).min(u64::from(ERROR_LIMIT)) as u32
    }
    #[inline(always)]
    fn in_steps(self, step: i64, _: f64) -> Self {
        let steps = ((u128::from(self.unsigned_abs()) + (step as u128 / 2)) / step as u128) as i64;
        steps.turned(self)
    }
}
