//! Tiles that are made to go wrong.

use crate::ground::{GROUNDS, Ground, SAMPLES, bits};
use crate::promise::Tile;
use orograph::codec::{BandRule, Bound, Cells, TileShape};
use orograph::grid::SampleType;

const SQUARE: TileShape = TileShape { width: 23, height: 19 };

fn tile(cells: Cells, shape: TileShape, nodata: Option<u64>, bound: Option<f64>) -> Tile {
    let bound = bound.map_or(Bound::Lossless, Bound::MaxError);
    Tile { rule: BandRule { sample: cells.sample(), nodata, bound }, cells, shape }
}

#[test]
fn all_of_the_range_of_integers() {
    for sample in &SAMPLES[..6] {
        for ground in [Ground::Extremes, Ground::FullRange, Ground::Ramp, Ground::Bits] {
            let cells = ground.cells(*sample, SQUARE, 3);
            for bound in [None, Some(0.4), Some(1.0), Some(100.0), Some(3e4), Some(1e9), Some(1.5e9), Some(2e9)] {
                for nodata in [None, Some(0), Some(1), Some(bits(&cells, 0))] {
                    tile(cells.clone(), SQUARE, nodata, bound).assert_holds();
                }
            }
        }
    }
}

#[test]
fn bounds_beyond_the_range_are_one_value() {
    for sample in &SAMPLES[..6] {
        for bound in [128.0, 255.0, 256.0, 4e9, 4_294_967_295.0, 1e19, 1e300, f64::MAX] {
            let cells = Ground::Extremes.cells(*sample, SQUARE, 0);
            let encoded = tile(cells.clone(), SQUARE, None, Some(bound)).assert_holds();
            if sample.bytes() == 1 {
                assert!(encoded.bytes() < 10, "{sample:?} {bound}: {} bytes", encoded.bytes());
            }
            tile(cells, SQUARE, Some(127), Some(bound)).assert_holds();
        }
    }
}

#[test]
fn bounds_of_any_size() {
    let bounds = [1e-300, 1e-45, 1e-20, 1e-6, 1.0, 1e6, 1e20, 1e38, 1e39, 1e290, 1e300, 1e308, f64::MAX];
    for ground in GROUNDS {
        for sample in &SAMPLES[6..] {
            let cells = ground.cells(*sample, SQUARE, 9);
            for bound in bounds.into_iter().chain([5e-324, f64::MIN_POSITIVE]) {
                tile(cells.clone(), SQUARE, None, Some(bound)).assert_holds();
            }
        }
    }
}

#[test]
fn huge_and_tiny_floats() {
    for scale in [1e-320, 1e-300, 1e-100, 1.0, 1e100, 1e300, 1.7e306] {
        let Cells::F64(hills) = Ground::Smooth.cells(SampleType::F64, SQUARE, 1) else { panic!("another type") };
        let cells = Cells::F64(hills.iter().map(|hill| hill * scale).collect());
        for part in [1e-20, 1e-16, 1e-12, 1e-3, 1.0, 1e3] {
            let bound = part * scale;
            if bound > 0.0 && bound.is_finite() {
                tile(cells.clone(), SQUARE, None, Some(bound)).assert_holds();
            }
        }
        tile(cells, SQUARE, None, None).assert_holds();
    }
    let ends = Cells::F64(vec![f64::MAX, f64::MIN, 5e-324, -5e-324, 0.0, -0.0, f64::INFINITY, f64::NAN]);
    let shape = TileShape { width: 4, height: 2 };
    for bound in [None, Some(5e-324), Some(1.0), Some(1e300), Some(f64::MAX)] {
        tile(ends.clone(), shape, None, bound).assert_holds();
        tile(ends.clone(), shape, Some((-0.0f64).to_bits()), bound).assert_holds();
    }
    let ends = Cells::F32(vec![f32::MAX, f32::MIN, 1e-45, -1e-45, 0.0, -0.0, f32::INFINITY, f32::NAN]);
    for bound in [None, Some(5e-324), Some(1e-45), Some(1.0), Some(3e38), Some(7e38), Some(f64::MAX)] {
        tile(ends.clone(), shape, None, bound).assert_holds();
    }
}

#[test]
fn one_cell() {
    let shape = TileShape { width: 1, height: 1 };
    for sample in SAMPLES {
        for ground in GROUNDS {
            for seed in 0..3 {
                let cells = ground.cells(sample, shape, seed);
                let bits = bits(&cells, 0);
                for bound in [None, Some(1e-300), Some(0.5), Some(2.0), Some(1e300)] {
                    for nodata in [None, Some(bits), Some(bits ^ 1)] {
                        tile(cells.clone(), shape, nodata, bound).assert_holds();
                    }
                }
            }
        }
    }
}

#[test]
fn nothing_but_voids() {
    for sample in SAMPLES {
        let void = u64::MAX >> (64 - sample.bytes() * 8);
        let bytes = vec![255; SQUARE.cells() * sample.bytes()];
        let cells = Cells::from_le_bytes(sample, &bytes).expect("a whole number of cells");
        for bound in [None, Some(1.0), Some(1e300)] {
            let encoded = tile(cells.clone(), SQUARE, Some(void), bound).assert_holds();
            assert!(encoded.bytes() < 30, "{sample:?}: {} bytes for nothing", encoded.bytes());
        }
    }
    // NaN of two payloads are voids too, and only one of them can be the common one.
    let values = (0..SQUARE.cells()).map(|k| f32::from_bits(if k % 3 == 0 { 0x7fc0_0007 } else { 0xffc0_0000 }));
    tile(Cells::F32(values.collect()), SQUARE, None, Some(1.0)).assert_holds();
}

/// Values one unit from nodata must not be rounded onto it.
#[test]
fn nothing_becomes_nodata() {
    for sample in &SAMPLES[..6] {
        let Cells::I32(values) = Ground::Noise.cells(SampleType::I32, SQUARE, 4) else { panic!("another type") };
        let bytes: Vec<u8> = values
            .iter()
            .flat_map(|&value| (100 + value / 4 * 2 + 1).to_le_bytes()[..sample.bytes()].to_vec())
            .collect();
        let cells = Cells::from_le_bytes(*sample, &bytes).expect("a whole number of cells");
        for nodata in 90..110 {
            for bound in [1.0, 2.0, 3.0, 10.0, 60.0] {
                tile(cells.clone(), SQUARE, Some(nodata), Some(bound)).assert_holds();
            }
        }
    }
}

/// A void in the corner stands where all predictions begin.
#[test]
fn voids_in_the_corner() {
    for sample in SAMPLES {
        let shape = TileShape { width: 65, height: 66 };
        let cells = Ground::Rough.cells(sample, shape, 2);
        let void = bits(&cells, 0);
        tile(cells.clone(), shape, Some(void), None).assert_holds();
        tile(cells, shape, Some(void), Some(1.5)).assert_holds();
    }
}
