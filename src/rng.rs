//! Seeded random numbers and hashes, the same on every machine and for ever: files and tests rest on their values.
//!
//! [`Rng`] is SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014,
//! doi:10.1145/2660193.2660195): 64 bits of state, period 2^64, nothing to seed wrongly. It is not for secrets.
//! [`row_hash`] and [`cell_hash`] turn the place of a lattice point into 32 bits without any state, in 32-bit integer
//! steps alone, which compilers turn into vectors.

/// A generator of random numbers; its state is the seed plus a constant for every number drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rng {
    state: u64,
}

impl Rng {
    /// The generator with a seed; equal seeds give equal numbers.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// A generator for one of many parts of a work (a node, a tile), whatever is drawn for the others.
    pub fn for_part(seed: u64, part: u64) -> Self {
        let mut own = Self::new(part);
        Self::new(seed ^ own.next_u64())
    }

    /// 64 random bits.
    pub fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// 32 random bits: the upper half of the next 64.
    pub fn next_u32(&mut self) -> u32 {
        (self.next_u64() >> 32) as u32
    }

    /// A number of `[0, 1)`, a multiple of 2^-53.
    pub fn unit(&mut self) -> f64 {
        // 2^53 is exact in a float, so is the quotient.
        (self.next_u64() >> 11) as f64 / 9_007_199_254_740_992.0
    }

    /// A number of `[low, high)`; rounding may return `high` itself where the two are close.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A whole number of `0..count`, each as likely as the others (Lemire's method, doi:10.1145/3230636); 0 for 0.
    pub fn below(&mut self, count: u64) -> u64 {
        if count == 0 {
            return 0;
        }
        loop {
            let wide = u128::from(self.next_u64()) * u128::from(count);
            // The first 2^64 mod count products of each residue would make some numbers likelier.
            if wide as u64 >= count.wrapping_neg() % count {
                return (wide >> 64) as u64;
            }
        }
    }

    /// Puts the items in a random order (Fisher and Yates, from the end).
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i as u64 + 1) as usize);
        }
    }
}

/// A bijection of 32-bit words in which every bit of the input sways every bit of the output ("lowbias32", Wellons
/// 2018, "Prospecting for hash functions").
#[inline(always)]
pub fn mix32(x: u32) -> u32 {
    let mut h = x;
    h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
    h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
    h ^ (h >> 16)
}

/// What all cells of lattice row `y` share: the first half of their hashes.
#[inline(always)]
pub fn row_hash(seed: u32, y: u32) -> u32 {
    mix32(y.wrapping_mul(0x9e37_79b1) ^ seed)
}

/// The hash of the cell in column `x` of a row with the given [`row_hash`].
#[inline(always)]
pub fn cell_hash(row: u32, x: u32) -> u32 {
    let mut h = x.wrapping_mul(0x85eb_ca6b).wrapping_add(row);
    h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
    // The row once more: otherwise rows would be one sequence, shifted.
    h = (h ^ (h >> 15) ^ row).wrapping_mul(0x846c_a68b);
    h ^ (h >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stay_as_they_are() {
        let mut rng = Rng::new(1_234_567);
        let drawn: Vec<u64> = (0..5).map(|_| rng.next_u64()).collect();
        // The published vector of SplitMix64.
        assert_eq!(
            drawn,
            [
                6_457_827_717_110_365_317,
                3_203_168_211_198_807_973,
                9_817_491_932_198_370_423,
                4_593_380_528_125_082_431,
                16_408_922_859_458_223_821
            ]
        );
        assert_eq!(Rng::new(0).unit(), 0.883_310_808_213_642_6);
        assert_eq!(Rng::new(0).next_u32(), 3_793_791_033);
    }

    #[test]
    fn hashes_stay_as_they_are() {
        let found = [mix32(1), row_hash(7, 3), cell_hash(row_hash(7, 3), 5), cell_hash(row_hash(7, 3), u32::MAX)];
        assert_eq!(found, [1_753_845_952, 119_468_856, 807_707_873, 1_004_293_046]);
    }

    #[test]
    fn below_gives_every_number_about_as_often() {
        let mut rng = Rng::new(3);
        let mut counts = [0_u32; 7];
        for _ in 0..70_000 {
            counts[rng.below(7) as usize] += 1;
        }
        // Six standard deviations of a binomial are 560.
        assert!(counts.iter().all(|&n| n.abs_diff(10_000) < 560), "{counts:?}");
        assert_eq!(rng.below(0), 0);
        assert_eq!(rng.below(1), 0);
    }

    #[test]
    fn shuffled_items_are_all_there() {
        let mut items: Vec<usize> = (0..100).collect();
        Rng::new(9).shuffle(&mut items);
        assert_ne!(items, (0..100).collect::<Vec<_>>());
        items.sort_unstable();
        assert_eq!(items, (0..100).collect::<Vec<_>>());
    }

    #[test]
    fn each_bit_of_a_place_sways_half_of_the_hash() {
        // Neighbours in x and y, and places that differ in one bit.
        let mut flips = [0_u32; 64];
        for n in 0..2000_u32 {
            let (x, y) = (mix32(n), mix32(n ^ 0xabcd));
            let base = cell_hash(row_hash(5, y), x);
            for bit in 0..32 {
                flips[bit] += (base ^ cell_hash(row_hash(5, y), x ^ (1 << bit))).count_ones();
                flips[32 + bit] += (base ^ cell_hash(row_hash(5, y ^ (1 << bit)), x)).count_ones();
            }
        }
        for (bit, &count) in flips.iter().enumerate() {
            let mean = f64::from(count) / 2000.0;
            assert!((mean - 16.0).abs() < 0.6, "bit {bit}: {mean} of 32 flip");
        }
    }
}
