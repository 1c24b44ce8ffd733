//! Damaged tiles: decoded or refused, with little memory. Alone in its program: the greatest memory of the process
//! counts.

#![cfg(target_os = "linux")]
#![allow(unreachable_pub, dead_code, reason = "modules of a test binary say what they offer to each other")]

#[path = "codec/ground.rs"]
mod ground;

use ground::{Ground, with_voids};
use orograph::codec::{BandRule, Bound, EncodedTile, TileShape, decode_tile, encode_tile};
use orograph::grid::SampleType;
use std::time::{Duration, Instant};

/// The greatest memory that this process has had, in bytes.
fn greatest() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").expect("linux");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("the kernel says it");
    line.trim().trim_end_matches("kB").trim().parse::<usize>().expect("a number") * 1024
}

struct Subject {
    tile: EncodedTile,
    shape: TileShape,
    rule: BandRule,
}

/// Small tiles that use every part of the format: masks, patches, copies, lists, grids, escapes, raw bits,
/// both kinds of words.
fn subjects() -> Vec<Subject> {
    let mut subjects = vec![];
    for (sample, ground, bound, (width, height), voids) in [
        (SampleType::I16, Ground::Rough, None, (21, 18), 0),
        (SampleType::I16, Ground::Rough, Some(2.0), (18, 21), 5),
        (SampleType::I16, Ground::Few, None, (20, 20), 5),
        (SampleType::U8, Ground::Constant, None, (40, 40), 3),
        (SampleType::U8, Ground::Bits, None, (9, 11), 0),
        (SampleType::I32, Ground::FullRange, Some(1e6), (12, 13), 0),
        (SampleType::U32, Ground::Bits, None, (1, 33), 7),
        (SampleType::F32, Ground::Grid, None, (19, 19), 0),
        (SampleType::F32, Ground::Rough, Some(0.2), (23, 15), 4),
        (SampleType::F32, Ground::Specials, Some(1.0), (17, 17), 0),
        (SampleType::F64, Ground::Scales, None, (11, 12), 0),
        (SampleType::F64, Ground::Specials, Some(1e-3), (13, 14), 3),
        (SampleType::F32, Ground::Resampled, None, (22, 21), 0),
        (SampleType::F32, Ground::Resampled, None, (16, 25), 4),
        (SampleType::F64, Ground::Resampled, None, (17, 14), 3),
    ] {
        let shape = TileShape { width, height };
        let bound = bound.map_or(Bound::Lossless, Bound::MaxError);
        let rule = BandRule { sample, nodata: (voids > 0).then_some(3), bound };
        let mut cells = ground.cells(sample, shape, 5);
        if voids > 0 {
            cells = with_voids(&cells, 3, |index| index % width / 2 % voids == 0 && index > 4 * width);
        }
        subjects.push(Subject { tile: encode_tile(&cells, shape, &rule).expect("encodes"), shape, rule });
    }
    subjects
}

#[test]
fn damaged_tiles_cost_little() {
    every_bit_and_every_truncation();
    a_great_tile_of_few_bytes();
}

fn every_bit_and_every_truncation() {
    let subjects = subjects();
    let before = greatest();
    let mut slowest = Duration::ZERO;
    let (mut decoded, mut refused) = (0, 0);
    for Subject { tile, shape, rule } in &subjects {
        let mut look = |segments: &[Vec<u8>]| {
            let segments: Vec<&[u8]> = segments.iter().map(Vec::as_slice).collect();
            for level in [0, 1, 3, 6] {
                let start = Instant::now();
                match decode_tile(&segments, *shape, rule, level) {
                    Ok(cells) => {
                        assert_eq!((cells.sample(), cells.len()), (rule.sample, shape.at_level(level).cells()));
                        decoded += 1;
                    }
                    Err(_) => refused += 1,
                }
                slowest = slowest.max(start.elapsed());
            }
        };
        for segment in 0..tile.segments.len() {
            let length = tile.segments[segment].len();
            for byte in 0..length {
                for bit in 0..8 {
                    let mut damaged = tile.segments.clone();
                    damaged[segment][byte] ^= 1 << bit;
                    look(&damaged);
                }
                let mut damaged = tile.segments.clone();
                damaged[segment].truncate(byte);
                look(&damaged);
                damaged[segment].resize(length, 255);
                look(&damaged);
                let mut damaged = tile.segments.clone();
                damaged[segment].remove(byte);
                look(&damaged);
                damaged[segment].splice(byte..byte, [0, 255]);
                look(&damaged);
            }
            look(&tile.segments[..segment]);
        }
    }
    assert!(decoded > 0 && refused > 0, "{decoded} decoded, {refused} refused");
    let grown = greatest() - before;
    assert!(grown < 4 << 20, "{grown} bytes of memory for tiles of at most 1600 cells");
    assert!(slowest < Duration::from_secs(2), "{slowest:?} for a tile of at most 1600 cells");
}

/// Numbers of so many bits each, lowest bits first.
fn packed(fields: &[(u64, u32)]) -> Vec<u8> {
    let bits: Vec<bool> =
        fields.iter().flat_map(|&(value, width)| (0..width).map(move |k| value >> k & 1 == 1)).collect();
    bits.chunks(8).map(|byte| byte.iter().rev().fold(0, |byte, &bit| byte << 1 | u8::from(bit))).collect()
}

/// A few bytes may claim to be the largest tile: they are found out before all of its cells are there.
fn a_great_tile_of_few_bytes() {
    let shape = TileShape { width: 4096, height: 4096 };
    let rule = BandRule { sample: SampleType::F64, nodata: None, bound: Bound::Lossless };
    let before = greatest();
    for copies in [0, 1] {
        // No voids, no patches, bits of floats in order, least 0, factor 1, 64-bit numbers, step 1, one zone; the first
        // cell is 0.
        let mapping = [(0, 2), (3, 3), (1, 1), (0, 10), (1, 1), (64, 7), (1, 1), (0, 2)];
        let head = [&mapping[..], &[(0, 1), (copies, 1), (0, 2), (1, 1), (0, 60)]].concat();
        // The parameters of 27 passes, and of the three of a finer level, which are serial: shift 0, from the set.
        let passes = |count: usize, serial: &[(u64, u32)]| {
            std::iter::repeat_n([serial, &[(0, 1), (3, 3), (0, 3), (0, 3)]].concat(), count)
                .flatten()
                .collect::<Vec<_>>()
        };
        let first = packed(&[&head[..], &passes(27, &[])].concat());
        let other = packed(&passes(3, &[(1, 1)]));
        // Then symbols that nobody wrote, which shows at their end alone; and copies likewise.
        let segment = |side: &[u8]| {
            let parts = [&[side.len() as u8], side, &[0][..usize::from(copies == 1)], &[0]].concat();
            [&parts[..], &[0; 32]].concat()
        };
        let (first, other) = (segment(&first), segment(&other));
        let segments = [&first[..], &other, &other, &other];
        for level in [6, 3, 1, 0] {
            let start = Instant::now();
            let decoded = decode_tile(&segments, shape, &rule, level);
            let message = decoded.map_or_else(|error| error.to_string(), |_| "taken for right".into());
            let found = if copies == 1 { "copies end early" } else { "end" };
            assert!(message.contains(found), "level {level}: {message}");
            assert!(start.elapsed() < Duration::from_secs(5), "level {level} took {:?}", start.elapsed());
        }
    }
    let grown = greatest() - before;
    assert!(grown < 32 << 20, "{grown} bytes of memory for some 200 bytes");
}
