//! What tests and fuzzers have found, one test each, with the bytes or cells that did it.

use crate::ground::Ground;
use crate::promise::Tile;
use orograph::codec::{BandRule, Bound, Cells, TileShape, decode_tile, encode_tile};
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

/// Errors were shifted by more bits than they have where cells differ by all 64.
#[test]
fn doubles_from_end_to_end() {
    let cells = Cells::F64(vec![7.88e132, 1.36e-133, -3.32e-110, -1.39e-24, 6.46e-295, -2.47e299]);
    Tile { cells, shape: TileShape { width: 2, height: 3 }, rule: rule(SampleType::F64) }.assert_holds();
}

/// A patch in the finest segment for a cell of a coarse level made that level another than the cells decimated.
#[test]
fn a_patch_in_a_segment_of_another_level() {
    // One value for all cells, no patches in the coarser segments, one patch in the finest.
    let decode = |cell: u8| {
        let segments = [&[4, 0x22, 0, 1, 9][..], &[1, 1], &[1, 1], &[3, cell, 0x70, 0]];
        decode_tile(&segments, TileShape { width: 8, height: 1 }, &rule(SampleType::U8), 0)
    };
    let (fourth, fifth) = (0x4b, 0x5b);
    assert_eq!(decode(fifth).expect("is sound"), Cells::U8(vec![0, 0, 0, 0, 0, 7, 0, 0]));
    assert_eq!(decode(fourth).expect_err("is refused").kind(), ErrorKind::Corrupt);
}

/// The sum of four cells overflowed: one low cell among high ones made all others five times as long.
#[test]
fn one_low_cell_among_high_ones() {
    let shape = TileShape { width: 64, height: 64 };
    let Cells::I32(mut cells) = Ground::Smooth.cells(SampleType::I32, shape, 1) else { panic!("another type") };
    cells.iter_mut().for_each(|cell| *cell += 1 << 30);
    let bytes = |cells: &[i32]| {
        Tile { cells: Cells::I32(cells.to_vec()), shape, rule: rule(SampleType::I32) }.assert_holds().bytes()
    };
    let before = bytes(&cells);
    cells[2000] = 0;
    let after = bytes(&cells);
    assert!(after < before * 3 / 2, "{before} bytes became {after}");
}

/// A tile of one value was taken whatever followed its side bits, and a segment for which there is no level.
#[test]
fn bytes_that_say_nothing() {
    let rule = rule(SampleType::U8);
    let shape = TileShape { width: 2, height: 2 };
    let tile = encode_tile(&Cells::U8(vec![7; 4]), shape, &rule).expect("encodes");
    let sound = &tile.segments[0][..];
    let decode = |first: &[u8], second: &[u8]| decode_tile(&[first, second, &[], &[]], shape, &rule, 0);
    assert_eq!(decode(sound, &[]).expect("is sound"), Cells::U8(vec![7; 4]));
    let (length, side) = sound.split_first().expect("a part");
    let longer = [&[length + 1], side, &[0]].concat();
    let mut filled = sound.to_vec();
    filled[sound.len() - 1] |= 0x80;
    for (first, second) in [(&longer[..], &[][..]), (&filled, &[]), (sound, &[0])] {
        assert_eq!(decode(first, second).expect_err("is refused").kind(), ErrorKind::Corrupt, "{first:?} {second:?}");
    }
}

/// A coarse level was taken for right although bytes for it were missing, when its segment held finer levels too.
#[test]
fn a_coarse_level_whose_bytes_are_missing() {
    let shape = TileShape { width: 64, height: 64 };
    let rule = rule(SampleType::U32);
    let cells = Ground::Bits.cells(SampleType::U32, shape, 3);
    let tile = encode_tile(&cells, shape, &rule).expect("encodes");
    // No raw bits, no side bits for passes: only what stands before them, and one state.
    let (&length, rest) = tile.segments[0].split_first().expect("a part");
    let side = &rest[..usize::from(length)];
    let head = [&[length], side, &[0], &[0, 0, 1, 0]].concat();
    assert_eq!(decode_tile(&[&head], shape, &rule, 4).expect_err("is refused").kind(), ErrorKind::Corrupt);
    assert!(decode_tile(&[&tile.segments[0]], shape, &rule, 4).is_ok());
}
