//! What the codec does not take.

use orograph::codec::{BandRule, Bound, Cells, MAX_TILE_SIDE, TileShape, decode_tile, encode_tile};
use orograph::error::ErrorKind;
use orograph::grid::SampleType;

const RULE: BandRule = BandRule { sample: SampleType::U8, nodata: None, bound: Bound::Lossless };

#[test]
fn cells_that_do_not_fit_are_refused() {
    let shape = |width, height| TileShape { width, height };
    let cells = |count| Cells::U8(vec![0; count]);
    for (cells, shape) in [
        (cells(4), shape(2, 3)),
        (cells(0), shape(0, 0)),
        (cells(0), shape(5, 0)),
        (cells(MAX_TILE_SIDE + 1), shape(MAX_TILE_SIDE + 1, 1)),
        (cells(1), shape(usize::MAX, usize::MAX)),
        (Cells::I8(vec![0; 4]), shape(2, 2)),
    ] {
        let error = encode_tile(&cells, shape, &RULE).expect_err("is refused");
        assert_eq!(error.kind(), ErrorKind::Usage, "{shape:?}");
    }
    for shape in [shape(0, 0), shape(0, 1), shape(MAX_TILE_SIDE + 1, 1), shape(usize::MAX, usize::MAX)] {
        assert!(decode_tile(&[&[0; 8][..]; 4], shape, &RULE, 0).is_err(), "{shape:?}");
    }
}

#[test]
fn bounds_that_promise_nothing_are_refused() {
    let shape = TileShape { width: 2, height: 1 };
    for bound in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let rule = BandRule { bound: Bound::MaxError(bound), ..RULE };
        let error = encode_tile(&Cells::U8(vec![0, 200]), shape, &rule).expect_err("is refused");
        assert_eq!(error.kind(), ErrorKind::Usage, "{bound}");
    }
}

#[test]
fn missing_segments_are_refused() {
    let shape = TileShape { width: 20, height: 20 };
    let tile = encode_tile(&Cells::U8((0..400).map(|k| (k % 251) as u8).collect()), shape, &RULE).expect("encodes");
    let segments: Vec<&[u8]> = tile.segments.iter().map(Vec::as_slice).collect();
    for (count, level) in [(3, 0), (2, 1), (1, 2), (0, 3), (0, 6)] {
        let error = decode_tile(&segments[..count], shape, &RULE, level).expect_err("is refused");
        assert_eq!(error.kind(), ErrorKind::Corrupt, "{count} segments, level {level}");
        assert!(decode_tile(&segments[..count + 1], shape, &RULE, level).is_ok());
    }
    // Levels beyond the last are the coarsest cell.
    for level in [7, 12, 31, 64, 255] {
        let coarsest = decode_tile(&segments[..1], shape, &RULE, level);
        assert!(coarsest.is_ok_and(|cells| cells == Cells::U8(vec![0])), "level {level}");
    }
}
