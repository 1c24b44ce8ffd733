//! Vectors of the sparse profile.

use crate::accepted::Vector;
use crate::parts::{Parts, varint};
use crate::sparse::Patched;
use crate::tile_bits::part;
use orograph::codec::sparse::{PatchTile, Term, encode_patches};
use orograph::codec::{SEGMENTS, TileShape};

const DICT: usize = 0;
const META: usize = 1;
const INDX: usize = 2;

/// Files that every reader reads.
pub fn accepted() -> Vec<Vector> {
    vec![
        ("sparse", "patches of 8 cells every 4, up to 3 of 5 atoms", {
            Patched::new((100, 70), (8, 4), (5, 3), None).write()
        }),
        ("sparse-voids", "patches with voids, and places without patches", {
            Patched::new((100, 40), (8, 4), (9, 6), Some(-9999.0)).write()
        }),
        ("sparse-nan", "voids that are NaN; one atom", Patched::new((70, 3), (5, 3), (1, 1), Some(f32::NAN)).write()),
        ("sparse-means", "one cell; patches without terms", Patched::new((1, 1), (8, 4), (3, 0), None).write()),
        ("sparse-large", "patches larger than tiles, tiles without places", {
            Patched::new((150, 140), (130, 90), (1, 1), None).write()
        }),
    ]
}

/// A small sound file.
fn sound() -> Parts {
    Parts::of(&Patched::new((20, 9), (5, 3), (3, 2), None).write())
}

fn with(change: impl FnOnce(&mut Parts)) -> Vec<u8> {
    let mut parts = sound();
    change(&mut parts);
    parts.file()
}

/// The sound file with another DICT: `at` is one of its first bytes, all of which are varints of one byte.
fn field(at: usize, bytes: &[u8]) -> Vec<u8> {
    with(|parts| drop(parts.sections[DICT].1.splice(at..=at, bytes.iter().copied())))
}

/// The sound file with other segments.
fn with_segments(change: impl FnOnce(&mut [Vec<u8>; SEGMENTS])) -> Vec<u8> {
    with(|parts| {
        let mut segments = [const { vec![] }; SEGMENTS];
        let (mut index, mut chunks) = (&parts.sections[INDX].1[..], &parts.chunks[..]);
        for segment in &mut segments {
            let end = index.iter().position(|byte| byte & 0x80 == 0).expect("a varint ends");
            let length = index[..=end].iter().rev().fold(0, |length, byte| length << 7 | usize::from(byte & 0x7f));
            index = &index[end + 1..];
            *segment = chunks[..length].to_vec();
            chunks = &chunks[if length > 0 { length + 4 } else { 0 }..];
        }
        change(&mut segments);
        (parts.chunks, parts.sections[INDX].1) = (vec![], vec![]);
        for segment in &segments {
            parts.sections[INDX].1.extend(varint(segment.len()));
            if !segment.is_empty() {
                parts.chunks.extend(segment);
                parts.chunks.extend(crc32c::crc32c(segment).to_le_bytes());
            }
        }
    })
}

/// The terms of a tile of the sound file's shape, written for another dictionary.
fn terms(atoms: u32, sparsity: usize, each: &[Term]) -> Vec<u8> {
    let mut tile = PatchTile::new(7, 3);
    (0..21).for_each(|place| tile.push(Some((place, each))));
    let encoded = encode_patches(&tile, TileShape { width: 20, height: 9 }, atoms, sparsity).expect("fits");
    encoded.segments[1].clone()
}

/// The voids of a tile of the sound file's shape.
fn voids(void: impl Fn(usize) -> bool) -> Vec<u8> {
    let mut tile = PatchTile::new(7, 3);
    (0..21).for_each(|place| tile.push(Some((place, &[]))));
    tile.voids = (0..180).map(void).collect();
    let encoded = encode_patches(&tile, TileShape { width: 20, height: 9 }, 3, 2).expect("fits");
    encoded.segments[2].clone()
}

/// Files that every reader rejects.
pub fn rejected() -> Vec<Vector> {
    let zero = [0_u8];
    let steps = |parts: &mut Parts, value: &[u8]| {
        // After four varints of one byte comes the mean step, 0.25: two bytes and their count.
        assert_eq!(parts.sections[DICT].1[4..7], [2, 0xd0, 0x3f]);
        parts.sections[DICT].1.splice(4..7, value.iter().copied());
    };
    let grow = |at: usize, bytes: &'static [u8]| with_segments(move |segments| segments[at].extend(bytes));
    let one = |atom: u32| [Term { atom, part: 1 }];
    vec![
        ("r010-two-dict", "two sections DICT", {
            with(|parts| {
                let twice = parts.sections[DICT].clone();
                parts.sections.insert(0, twice);
            })
        }),
        ("r039-side", "patches of 2 cells", field(0, &[2])),
        ("r039-step", "a step of 0", field(1, &zero)),
        ("r039-gaps", "patches of 5 cells every 4: gaps", field(1, &[4])),
        ("r039-atoms", "no atoms", field(2, &zero)),
        ("r039-many", "2^35 atoms", field(2, &[0x80, 0x80, 0x80, 0x80, 0x80, 1])),
        ("r039-sparsity", "256 terms", field(3, &[0x80, 2])),
        ("r039-zero", "a mean step of 0", with(|parts| steps(parts, &[0]))),
        ("r039-infinite", "a mean step without end", with(|parts| steps(parts, &[2, 0xf0, 0x7f]))),
        ("r039-cut", "DICT ends before its atoms", with(|parts| parts.sections[DICT].1.truncate(9))),
        ("r039-type", "a dictionary for integers of 32 bits", {
            with(|parts| {
                let flags = parts.sections[META].1.len() - 1;
                parts.sections[META].1[flags] = 5;
            })
        }),
        ("r039-over", "a section OVER beside DICT", with(|parts| parts.sections.insert(1, (3, vec![1])))),
        ("r040-cut", "atoms that end early", with(|parts| parts.sections[DICT].1.truncate(30))),
        ("r040-longer", "atoms that go on", with(|parts| parts.sections[DICT].1.extend([1; 8]))),
        ("r040-zero", "atoms with a zero byte after their end", with(|parts| parts.sections[DICT].1.push(0))),
        ("r041-longer", "means with a byte after the last part", grow(0, &[0])),
        ("r041-cut", "means that end early", with_segments(|segments| _ = segments[0].pop())),
        ("r041-form", "a length of means in a longer form than it needs", {
            with_segments(|segments| {
                segments[0][0] |= 0x80;
                segments[0].insert(1, 0);
            })
        }),
        ("r041-segment", "a segment 3", with_segments(|segments| segments[3].extend(part(&[1])))),
        ("r042-sparsity", "three terms of a patch", {
            let each = [Term { atom: 0, part: 3 }, Term { atom: 1, part: -2 }, Term { atom: 2, part: 1 }];
            with_segments(|segments| segments[1] = terms(3, 3, &each))
        }),
        ("r042-atom", "an atom that there is not", with_segments(|segments| segments[1] = terms(4, 2, &one(3)))),
        ("r042-longer", "terms that go on", grow(1, &[1; 8])),
        ("r042-zero", "terms with a zero byte after their end", grow(1, &[0])),
        ("r042-cut", "no terms", with_segments(|segments| segments[1].clear())),
        ("r043-none", "a mask without a void", {
            // A mask of which the only void has become an ordinary 0: that of a tile of zeros.
            let mask = crate::tile_bits::header(0, 1).bytes();
            with_segments(|segments| segments[2] = [part(&part(&mask)), vec![0; 3]].concat())
        }),
        ("r043-value", "a mask with a cell of 2", {
            let mask = orograph::codec::encode_tile(
                &orograph::codec::Cells::U8((0..180).map(|cell| [0, 1, 2][usize::min(cell, 2)]).collect()),
                TileShape { width: 20, height: 9 },
                &orograph::codec::BandRule {
                    sample: orograph::grid::SampleType::U8,
                    nodata: Some(1),
                    bound: orograph::codec::Bound::Lossless,
                },
            );
            let parts = mask.expect("encodes").segments.map(|segment| part(&segment)).concat();
            assert_ne!(parts, voids(|cell| cell == 1));
            with_segments(|segments| segments[2] = parts)
        }),
    ]
}
