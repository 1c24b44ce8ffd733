//! Order-preserving integers that stand for elevations.

use std::fmt::Debug;
use std::hash::Hash;

/// An integer that sorts as the elevations do; its smallest value stands for a void.
pub trait Key: Copy + Ord + Hash + Debug + Default + Send + Sync + 'static {
    /// The key of a void; below every elevation.
    const VOID: Self;
    /// An integer in which a falling key and a rising number stand together.
    type Rank: Copy + Ord + Send + Sync + 'static;
    /// The rank that sorts higher keys first, and equal ones by `order`.
    fn falling(self, order: u32) -> Self::Rank;
    /// The `order` of a rank.
    fn order_of(rank: Self::Rank) -> u32;
    /// An integer in which a key and a small number stand together.
    type Numbered: Copy + Ord;
    /// The key with a number from 0 to 7 that decides between equal keys.
    fn numbered(self, number: u8) -> Self::Numbered;
    /// The number of a numbered key.
    fn number_of(numbered: Self::Numbered) -> u8;
    /// The key as a 64-bit integer, order kept.
    fn to_i64(self) -> i64;
    /// The inverse of [`Key::to_i64`] for values that came from it.
    fn from_i64(value: i64) -> Self;
}

macro_rules! key {
    ($($t:ty => $rank:ty, $numbered:ty);*) => {$(
        impl Key for $t {
            const VOID: Self = <$t>::MIN;
            type Rank = $rank;
            #[inline]
            fn falling(self, order: u32) -> $rank {
                // `!` turns the order round; the shift by the type's least value makes it unsigned.
                (i128::from(!self) - i128::from(<$t>::MIN)) as $rank << 32 | <$rank>::from(order)
            }
            #[inline]
            #[allow(clippy::cast_possible_truncation, reason = "the low 32 bits are the order")]
            fn order_of(rank: $rank) -> u32 {
                rank as u32
            }
            type Numbered = $numbered;
            #[inline]
            fn numbered(self, number: u8) -> $numbered {
                <$numbered>::from(self) << 3 | <$numbered>::from(number)
            }
            #[inline]
            #[allow(clippy::cast_possible_truncation, reason = "the low 3 bits are the number")]
            fn number_of(numbered: $numbered) -> u8 {
                numbered as u8 & 7
            }
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
key!(i16 => u64, i32; i32 => u64, i64; i64 => u128, i128);

#[cfg(test)]
mod tests {
    use super::*;

    fn ranks_fall<K: Key>(keys: &[K]) {
        for pair in keys.windows(2) {
            assert!(pair[1].falling(9) < pair[0].falling(3), "{pair:?}: the higher key comes first");
            assert!(pair[0].falling(3) < pair[0].falling(4), "{pair:?}: then the order");
        }
        assert_eq!(K::order_of(keys[0].falling(u32::MAX)), u32::MAX);
    }

    #[test]
    fn ranks() {
        ranks_fall(&[i16::MIN, -1, 0, 1, i16::MAX]);
        ranks_fall(&[i32::MIN, -1, 0, 1, i32::MAX]);
        ranks_fall(&[i64::MIN, -1, 0, 1, i64::MAX]);
    }
}
