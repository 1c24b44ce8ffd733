//! Eight numbers at once, said so: for sums that must be fast however the crate is compiled.

/// What can be done with eight numbers at once. All of it gives the same bits on every machine: products and sums are
/// rounded one after the other.
pub(crate) trait Octets: Copy {
    /// Eight numbers.
    type Eight: Copy;

    /// One number eight times.
    fn splat(self, value: f32) -> Self::Eight;
    /// Eight numbers from memory.
    fn load(self, values: &[f32; 8]) -> Self::Eight;
    /// Eight numbers to memory.
    fn store(self, eight: Self::Eight, values: &mut [f32; 8]);
    /// `a * b + sum`, rounded twice.
    fn times_plus(self, a: Self::Eight, b: Self::Eight, sum: Self::Eight) -> Self::Eight;
    /// Zeros in place of what is not above zero.
    fn rectified(self, a: Self::Eight) -> Self::Eight;
}

/// Work for some kind of [`Octets`].
pub(crate) trait OctetWork {
    /// What comes out.
    type Output;

    /// Does the work; always to be inlined.
    fn run<S: Octets>(self, octets: S) -> Self::Output;
}

/// Does work with the widest registers of the processor at hand.
#[inline(always)]
pub(crate) fn in_octets<W: OctetWork>(work: W) -> W::Output {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if let Some(registers) = pulp::x86::V3::try_new() {
        return pulp::Simd::vectorize(registers, wide::Wide { work, registers });
    }
    super::vectorised(|| work.run(Plain))
}

/// Any processor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plain;

impl Octets for Plain {
    type Eight = [f32; 8];

    #[inline(always)]
    fn splat(self, value: f32) -> [f32; 8] {
        [value; 8]
    }

    #[inline(always)]
    fn load(self, values: &[f32; 8]) -> [f32; 8] {
        *values
    }

    #[inline(always)]
    fn store(self, eight: [f32; 8], values: &mut [f32; 8]) {
        *values = eight;
    }

    #[inline(always)]
    fn times_plus(self, a: [f32; 8], b: [f32; 8], mut sum: [f32; 8]) -> [f32; 8] {
        for i in 0..8 {
            sum[i] += a[i] * b[i];
        }
        sum
    }

    #[inline(always)]
    fn rectified(self, a: [f32; 8]) -> [f32; 8] {
        a.map(|value| if value > 0.0 { value } else { 0.0 })
    }
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
mod wide {
    use super::{OctetWork, Octets};
    use pulp::x86::V3;
    use pulp::{Simd, WithSimd, cast, f32x8};

    /// Work with the registers of AVX2.
    pub(super) struct Wide<W> {
        pub(super) work: W,
        pub(super) registers: V3,
    }

    impl<W: OctetWork> WithSimd for Wide<W> {
        type Output = W::Output;

        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) -> W::Output {
            self.work.run(self.registers)
        }
    }

    impl Octets for V3 {
        type Eight = f32x8;

        #[inline(always)]
        fn splat(self, value: f32) -> f32x8 {
            self.splat_f32x8(value)
        }

        #[inline(always)]
        fn load(self, values: &[f32; 8]) -> f32x8 {
            cast(*values)
        }

        #[inline(always)]
        fn store(self, eight: f32x8, values: &mut [f32; 8]) {
            *values = cast(eight);
        }

        #[inline(always)]
        fn times_plus(self, a: f32x8, b: f32x8, sum: f32x8) -> f32x8 {
            self.add_f32x8(sum, self.mul_f32x8(a, b))
        }

        #[inline(always)]
        fn rectified(self, a: f32x8) -> f32x8 {
            // Where both are zero, or one is no number, it is the second.
            self.max_f32x8(a, self.splat_f32x8(0.0))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Sums<'a>(&'a [[f32; 8]]);

    impl OctetWork for Sums<'_> {
        type Output = [f32; 8];

        #[inline(always)]
        fn run<S: Octets>(self, octets: S) -> [f32; 8] {
            let mut sum = octets.splat(0.1);
            for values in self.0 {
                let eight = octets.load(values);
                sum = octets.times_plus(eight, octets.rectified(eight), sum);
            }
            let mut out = [0.0; 8];
            octets.store(sum, &mut out);
            out
        }
    }

    #[test]
    fn registers_make_no_difference() {
        let mut rng = crate::rng::Rng::new(3);
        let values: Vec<[f32; 8]> = (0..100).map(|_| std::array::from_fn(|_| rng.between(-1.0, 1.0) as f32)).collect();
        let bits = |eight: [f32; 8]| eight.map(f32::to_bits);
        assert_eq!(bits(in_octets(Sums(&values))), bits(Sums(&values).run(Plain)));
        let edges = [[-0.0, 0.0, 3.0, -1.0, 1.0, f32::MIN_POSITIVE, -f32::MIN_POSITIVE, 2.0]];
        assert_eq!(bits(in_octets(Sums(&edges))), bits(Sums(&edges).run(Plain)));
        assert_eq!(Plain.rectified([-2.0; 8]), [0.0; 8]);
    }
}
