//! Tiles of any shape, type, ground, voids and bound.

use crate::ground::{GROUNDS, Ground, SAMPLES, bits, noise, with_voids};
use crate::promise::Tile;
use orograph::codec::{BandRule, Bound, TileShape};
use orograph::grid::SampleType;
use proptest::prelude::*;
use proptest::sample::select;

/// What the nodata value is.
#[derive(Clone, Copy, Debug)]
enum Nodata {
    None,
    /// The least number of the type, or all bits of a negative NaN.
    Usual,
    /// All bits 0.
    Zero,
    /// What a cell in the middle has.
    Cell,
    /// Just above and just below what that cell has: a value that rounding could hit.
    Above,
    Below,
}

const NODATA: [Nodata; 6] = [Nodata::None, Nodata::Usual, Nodata::Zero, Nodata::Cell, Nodata::Above, Nodata::Below];

/// How many of 16 cells are voids.
const VOIDS: [u64; 5] = [0, 1, 8, 15, 16];

/// In units of integers, and of most floats; 0 for lossless.
const BOUNDS: [f64; 12] = [0.0, 1e-300, 1e-9, 0.013, 0.5, 1.0, 2.0, 7.5, 100.0, 1e5, 1e10, 1e300];

fn nodata_bits(nodata: Nodata, sample: SampleType, middle: u64) -> Option<u64> {
    let width = sample.bytes() as u32 * 8;
    let mask = u64::MAX >> (64 - width);
    match nodata {
        Nodata::None => None,
        Nodata::Usual if matches!(sample, SampleType::F32 | SampleType::F64) => Some(mask),
        Nodata::Usual => Some(1 << (width - 1)),
        Nodata::Zero => Some(0),
        Nodata::Cell => Some(middle),
        // The next integer, and the next float too.
        Nodata::Above => Some(middle.wrapping_add(1) & mask),
        Nodata::Below => Some(middle.wrapping_sub(1) & mask),
    }
}

/// Holes that hang together, as many of 16 cells as asked for.
fn is_hole(index: usize, width: usize, voids: u64, seed: u64) -> bool {
    let (col, row) = (index % width / 5, index / width / 3);
    let block = noise(seed ^ (row * 1000 + col) as u64).nth(1).unwrap_or(0);
    let cell = noise(seed ^ (index as u64) << 20).nth(1).unwrap_or(0);
    (if cell >> 60 == 0 { cell } else { block }) >> 7 & 15 < voids
}

fn tile(
    (sample, ground): (SampleType, Ground),
    shape: TileShape,
    (nodata, voids): (Nodata, u64),
    bound: f64,
    seed: u64,
) -> Tile {
    let mut cells = ground.cells(sample, shape, seed);
    let nodata = nodata_bits(nodata, sample, bits(&cells, cells.len() / 2));
    let void = match (nodata, sample) {
        (Some(bits), _) => Some(bits),
        (None, SampleType::F32) => Some(0x7fc0_0000 | seed & 1),
        (None, SampleType::F64) => Some(0x7ff8_0000_0000_0000 | seed & 1),
        _ => None,
    };
    if let Some(void) = void {
        cells = with_voids(&cells, void, |index| is_hole(index, shape.width, voids, seed));
    }
    let bound = if bound == 0.0 { Bound::Lossless } else { Bound::MaxError(bound) };
    Tile { cells, shape, rule: BandRule { sample, nodata, bound } }
}

fn any_tile(sides: impl Strategy<Value = (usize, usize)>) -> impl Strategy<Value = Tile> {
    let what = (select(&SAMPLES[..]), select(&GROUNDS[..]));
    let voids = (select(&NODATA[..]), select(&VOIDS[..]));
    (what, sides, voids, select(&BOUNDS[..]), 0..u64::MAX / 2).prop_map(
        |(what, (width, height), voids, bound, seed)| tile(what, TileShape { width, height }, voids, bound, seed),
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn small_tiles_come_back(tile in any_tile((1..18_usize, 1..18_usize))) {
        tile.assert_holds();
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 250, ..ProptestConfig::default() })]

    #[test]
    fn tiles_come_back(tile in any_tile((1..71_usize, 1..71_usize))) {
        tile.assert_holds();
    }

    #[test]
    fn thin_tiles_come_back(tile in any_tile((1..3_usize, 1..600_usize, any::<bool>()).prop_map(
        |(thin, long, lies)| if lies { (long, thin) } else { (thin, long) },
    ))) {
        tile.assert_holds();
    }
}

/// Large enough for fitted filters, fitted weights and eight states of the entropy coder.
#[test]
fn large_tiles_come_back() {
    for (number, ground) in GROUNDS.into_iter().enumerate() {
        let sample = [SampleType::I16, SampleType::F32, SampleType::I32, SampleType::F64][number % 4];
        let shape = TileShape { width: 333 - number, height: 129 + number };
        for (bound, voids) in [(0.0, 0), (2.0, 1)] {
            tile((sample, ground), shape, (Nodata::Usual, voids), bound, number as u64).assert_holds();
        }
    }
    let shape = TileShape { width: 400, height: 401 };
    for bound in [0.0, 1.0, 5.0] {
        tile((SampleType::I16, Ground::Rough), shape, (Nodata::Usual, 8), bound, 5).assert_holds();
    }
}

/// Cells that repeat others, among voids and without, in words of 32 and of 64 bits, in serial passes and others.
#[test]
fn copies_come_back() {
    let mut bytes = [0; 2];
    for (number, sample) in [SampleType::F32, SampleType::F64, SampleType::I32, SampleType::U32].into_iter().enumerate()
    {
        for shape in [(150, 97), (97, 150), (40, 33), (1, 300), (300, 2)] {
            let shape = TileShape { width: shape.0, height: shape.1 };
            for (voids, bound) in [(0, 0.0), (1, 0.0), (8, 0.0), (15, 0.0), (1, 0.4), (1, 1e-9)] {
                let seed = (number * 100 + shape.width) as u64;
                let nodata = if voids % 2 == 0 { Nodata::None } else { Nodata::Usual };
                tile((sample, Ground::Resampled), shape, (nodata, voids), bound, seed).assert_holds();
            }
        }
        let shape = TileShape { width: 200, height: 200 };
        for (bytes, ground) in bytes.iter_mut().zip([Ground::Resampled, Ground::Rough]) {
            *bytes =
                tile((SampleType::F32, ground), shape, (Nodata::None, 0), 0.0, number as u64).assert_holds().bytes();
        }
        let [copied, other] = bytes;
        assert!(copied * 3 < other * 2, "{copied} bytes with copies, {other} without");
    }
}

/// Blocks of different ground, with voids and without: zones.
fn patchwork(sample: SampleType, shape: TileShape, voids: u64, bound: f64, seed: u64) -> Tile {
    let grounds = [Ground::Rough, Ground::Smooth, Ground::Noise, Ground::Terraces];
    let bytes = grounds.map(|ground| ground.cells(sample, shape, seed).to_le_bytes());
    let size = sample.bytes();
    let pick = |index: usize| {
        let (row, col) = (index / shape.width, index % shape.width);
        &bytes[(row / 48 + col / 64) % 4][index * size..(index + 1) * size]
    };
    let mixed: Vec<u8> = (0..shape.cells()).flat_map(pick).copied().collect();
    let mut cells = orograph::codec::Cells::from_le_bytes(sample, &mixed).expect("whole cells");
    let nodata = nodata_bits(Nodata::Usual, sample, bits(&cells, 0));
    if let Some(void) = nodata.filter(|_| voids > 0) {
        cells = with_voids(&cells, void, |index| is_hole(index, shape.width, voids, seed));
    }
    let bound = if bound == 0.0 { Bound::Lossless } else { Bound::MaxError(bound) };
    Tile { cells, shape, rule: BandRule { sample, nodata, bound } }
}

#[test]
fn patchworks_come_back() {
    for (number, sample) in SAMPLES.into_iter().enumerate() {
        let shape = TileShape { width: 256 + 13 * number, height: 340 - 17 * number };
        for (voids, bound) in [(0, 0.0), (8, 0.0), (1, 2.0), (0, 5.0)] {
            patchwork(sample, shape, voids, bound, number as u64).assert_holds();
        }
    }
}

/// Whatever becomes of a tile with zones, it is decoded or refused.
#[test]
fn damaged_patchworks_do_not_panic() {
    let shape = TileShape { width: 257, height: 260 };
    let tile = patchwork(SampleType::I16, shape, 8, 2.0, 1);
    let sound = orograph::codec::encode_tile(&tile.cells, shape, &tile.rule).expect("encodes");
    let (mut decoded, mut refused) = (0, 0);
    for segment in 0..sound.segments.len() {
        for place in (0..sound.segments[segment].len().min(120)).flat_map(|byte| [(byte, 1), (byte, 0x20)]) {
            let mut damaged = sound.clone();
            damaged.segments[segment][place.0] ^= place.1;
            match orograph::codec::decode_tile(&crate::promise::segments(&damaged), shape, &tile.rule, 0) {
                Ok(cells) => {
                    assert_eq!(cells.len(), shape.cells());
                    decoded += 1;
                }
                Err(error) => {
                    assert_eq!(error.kind(), orograph::error::ErrorKind::Corrupt, "{error}");
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > decoded, "{refused} refused, {decoded} decoded");
}
