//! What tests and fuzzers have found, one test each, with the bytes or cells that did it.

use crate::promise::Tile;
use orograph::codec::{BandRule, Bound, Cells, TileShape, decode_tile};
use orograph::error::ErrorKind;
use orograph::grid::SampleType;

const fn rule(sample: SampleType) -> BandRule {
    BandRule { sample, nodata: None, bound: Bound::Lossless }
}

/// The decoder refused the segments of a mask that took no bytes.
#[test]
fn a_mask_of_no_bytes() {
    let rule = BandRule { nodata: Some(255), ..rule(SampleType::U8) };
    for (width, height) in [(2, 1), (3, 3), (23, 19)] {
        let shape = TileShape { width, height };
        Tile { cells: Cells::U8(vec![255; shape.cells()]), shape, rule }.assert_holds();
    }
}

/// The square of the step overflowed in the encoder.
#[test]
fn a_step_of_two_thirds_of_the_range() {
    let cells = Cells::U32((0..64).map(|k| if k % 2 == 0 { 0 } else { u32::MAX }).collect());
    let rule = BandRule { bound: Bound::MaxError(1.6e9), ..rule(SampleType::U32) };
    Tile { cells, shape: TileShape { width: 8, height: 8 }, rule }.assert_holds();
}

/// Errors were shifted by more bits than they have when a tile claimed a step above 2^38.
#[test]
fn a_step_that_no_type_needs() {
    let segment = [
        18, 0x20, 0, 0x11, 0, 0, 0, 0, 0x40, 2, 0, 0, 0, 0, 0x91, 0x0d, 0x30, 0xc0,
        0, // What stands before the passes.
        0, 0, 0, 1, 0,
    ];
    let shape = TileShape { width: 16, height: 1 };
    let error = decode_tile(&[&segment], shape, &rule(SampleType::U8), 3).expect_err("is refused");
    assert_eq!(error.kind(), ErrorKind::Corrupt);
}
