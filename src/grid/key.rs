//! Order-preserving integers that stand for elevations.

use std::fmt::Debug;
use std::hash::Hash;

/// An integer that sorts as the elevations do; its smallest value stands for a void.
pub trait Key: Copy + Ord + Hash + Debug + Default + Send + Sync + 'static {
    /// The key of a void; below every elevation.
    const VOID: Self;
    /// The key as a 64-bit integer, order kept.
    fn to_i64(self) -> i64;
    /// The inverse of [`Key::to_i64`] for values that came from it.
    fn from_i64(value: i64) -> Self;
}

macro_rules! key {
    ($($t:ty),*) => {$(
        impl Key for $t {
            const VOID: Self = <$t>::MIN;
            #[inline]
            fn to_i64(self) -> i64 {
                i64::from(self)
            }
            #[inline]
            #[allow(clippy::cast_possible_truncation, reason = "the value came from this type")]
            fn from_i64(value: i64) -> Self {
                value as $t
            }
        }
    )*};
}
key!(i16, i32, i64);
