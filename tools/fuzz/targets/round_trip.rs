//! Any cells: they come back as promised, at every level.
#![no_main]

use libfuzzer_sys::fuzz_target;
use orograph::codec::Bound;
use orograph_fuzz::input::{Bytes, read_cells, read_rule};
use orograph_fuzz::promise::Tile;

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Bytes(bytes);
    let (mut rule, mut shape, mode) = read_rule(&mut bytes);
    if matches!(rule.bound, Bound::MaxError(bound) if !(bound > 0.0 && bound.is_finite())) {
        rule.bound = Bound::Lossless;
    }
    // Encoding tries much: small tiles only.
    shape.width = shape.width.min(90);
    shape.height = shape.height.min(1200 / shape.width).max(1);
    let cells = read_cells(&mut bytes, &rule, shape, mode);
    Tile { cells, shape, rule }.assert_holds();
});
