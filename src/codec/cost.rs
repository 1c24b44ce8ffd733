//! What symbols and numbers cost, in whole numbers, so that encoders choose alike on every machine.

use super::rans::{PRECISION, TOTAL};
use std::sync::OnceLock;

/// Cost of a symbol by its frequency, in 256ths of a bit; that of frequency 0 is out of reach.
pub(super) fn symbol_costs() -> &'static [u32] {
    static COSTS: OnceLock<Vec<u32>> = OnceLock::new();
    COSTS.get_or_init(|| {
        (0..=TOTAL).map(|freq| if freq == 0 { 1 << 20 } else { (PRECISION << 8) - log2(freq) }).collect()
    })
}

/// Logarithm to base 2 in 256ths, rounded down: digit by digit, squaring.
fn log2(value: u32) -> u32 {
    let whole = 31 - value.leading_zeros();
    let mut x = (u64::from(value) << 31) >> whole;
    let mut log = whole;
    for _ in 0..8 {
        x = (x * x) >> 31;
        log <<= 1;
        if x >= 1 << 32 {
            x >>= 1;
            log |= 1;
        }
    }
    log
}

/// Bits of a number in Exp-Golomb code.
pub(super) fn cost_of(value: u64, order: u32) -> u32 {
    let length = 127 - (u128::from(value) + (1u128 << order)).leading_zeros();
    2 * length - order + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_are_logarithms() {
        for freq in 1..=TOTAL {
            let exact = (f64::from(TOTAL) / f64::from(freq)).log2() * 256.0;
            assert!((f64::from(symbol_costs()[freq as usize]) - exact).abs() <= 1.0, "{freq}");
        }
    }
}
