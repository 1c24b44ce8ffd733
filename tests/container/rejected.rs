//! Files that every reader rejects: each breaks one requirement, and all checksums after the damage are right.

use crate::accepted::{Vector, patchwork, resampled};
use crate::case::{Case, cells, noise};
use crate::parts::{FOOTER, Parts, entry};
use crate::sparse_vectors;
use crate::tile_bits::{Bits, file, header, part};
use orograph::codec::{BandRule, Bound, Cells, TileShape, encode_tile};
use orograph::grid::SampleType;

const META: usize = 0;
const INDX: usize = 1;

/// All of them.
pub fn vectors() -> Vec<Vector> {
    [frame(), sections(), tile_headers(), tile_bodies(), endings(), maps(), sparse_vectors::rejected()].concat()
}

/// 2 x 2 cells of `u8` in one tile.
fn sound() -> Vec<u8> {
    let mut case = Case::new(2, 2, 64, &[SampleType::U8]);
    case.bands[0] = Cells::U8(vec![10, 12, 11, 15]);
    case.write().0
}

fn with(change: impl FnOnce(&mut Parts)) -> Vec<u8> {
    let mut parts = Parts::of(&sound());
    change(&mut parts);
    parts.file()
}

/// A change to some bytes of the sound file that no checksum follows.
fn patched(change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut file = sound();
    change(&mut file);
    file
}

/// Another header before the sound file's parts.
fn headed(magic: &[u8; 4], version: u16, flags: u16, flip: u8) -> Vec<u8> {
    let mut header = [magic.as_slice(), &version.to_le_bytes(), &flags.to_le_bytes()].concat();
    header.extend(crc32c::crc32c(&header).to_le_bytes());
    header[11] ^= flip;
    let parts = Parts::of(&sound());
    parts.file_with(&header, &directory(&parts))
}

fn directory(parts: &Parts) -> Vec<u8> {
    parts.sections.iter().flat_map(|(number, bytes)| entry(*number, bytes.len(), bytes)).collect()
}

/// The sound file with another directory.
fn listed(change: impl FnOnce(&Parts, &mut Vec<u8>)) -> Vec<u8> {
    let parts = Parts::of(&sound());
    let mut entries = directory(&parts);
    change(&parts, &mut entries);
    parts.file_with(&sound()[..12], &entries)
}

fn frame() -> Vec<Vector> {
    vec![
        ("r001-segment", "a bit of the first segment is not what it was", with(|parts| parts.chunks[0] ^= 4)),
        ("r002-magic", "another magic in the header", headed(b"\x89ORA", 1, 0, 0)),
        ("r002-checksum", "a wrong checksum of the header", headed(b"\x89ORO", 1, 0, 1)),
        ("r002-version", "the header's version is not the footer's", headed(b"\x89ORO", 2, 0, 0)),
        ("r002-flags", "the header's flags are not the footer's", headed(b"\x89ORO", 1, 1, 0)),
        ("r003-empty", "no bytes", vec![]),
        ("r003-short", "49 bytes with the right end", sound()[sound().len() - 49..].to_vec()),
        ("r003-end", "another end magic", patched(|file| *file.last_mut().expect("a byte") = 0x88)),
        ("r003-cut", "the last byte is missing", patched(|file| _ = file.pop())),
        (
            "r004-hash",
            "a bit of the footer is not what it was",
            patched(|file| {
                let at = file.len() - FOOTER + 8;
                file[at] ^= 1;
            }),
        ),
        (
            "r004-directory",
            "a bit of the directory is not what it was",
            patched(|file| {
                let at = file.len() - FOOTER - 1;
                file[at] ^= 1;
            }),
        ),
        ("r005-version", "version 2", with(|parts| parts.version = 2)),
        ("r005-version-0", "version 0", with(|parts| parts.version = 0)),
        ("r005-flags", "a flag that has no meaning yet", with(|parts| parts.flags = 0x8000)),
        ("r006-longer", "a byte more between header and chunks", patched(|file| file.insert(12, 0))),
        ("r006-shorter", "a byte less", patched(|file| _ = file.remove(12))),
        (
            "r007-directory",
            "a directory of 32,769 bytes",
            patched(|file| {
                let at = file.len() - FOOTER + 24;
                file[at..at + 2].copy_from_slice(&32_769_u16.to_le_bytes());
            }),
        ),
        (
            "r007-file",
            "a directory longer than the file",
            patched(|file| {
                let at = file.len() - FOOTER + 24;
                file[at..at + 2].copy_from_slice(&300_u16.to_le_bytes());
            }),
        ),
    ]
}

fn sections() -> Vec<Vector> {
    let mut many = vec![];
    many.extend([
        ("r008-cut", "the last entry of the directory is cut off", listed(|_, entries| _ = entries.pop())),
        (
            "r008-varint",
            "a length in a longer form than it needs",
            listed(|_, entries| {
                entries[1] |= 0x80;
                entries.insert(2, 0);
            }),
        ),
        (
            "r009-unknown",
            "an unknown section that must be understood",
            with(|parts| {
                parts.sections.insert(0, (0x80 | 70, b"new".to_vec()));
            }),
        ),
        ("r010-no-meta", "no section META", with(|parts| drop(parts.sections.remove(META)))),
        ("r010-no-indx", "no section INDX", with(|parts| drop(parts.sections.remove(INDX)))),
        (
            "r010-two-indx",
            "two sections INDX",
            with(|parts| {
                let twice = parts.sections[INDX].clone();
                parts.sections.push(twice);
            }),
        ),
        (
            "r010-two-over",
            "two sections OVER",
            with(|parts| {
                parts.sections.insert(0, (3, vec![1]));
                parts.sections.insert(0, (3, vec![1]));
            }),
        ),
        (
            "r011-length",
            "a section longer than the file",
            listed(|parts, entries| {
                *entries = entry(0x81, 2000, &parts.sections[META].1);
                entries.extend(entry(0x82, parts.sections[INDX].1.len(), &parts.sections[INDX].1));
            }),
        ),
        ("r012-meta", "the checksum of META is wrong", listed(|_, entries| entries[2] ^= 1)),
        ("r012-indx", "the checksum of INDX is wrong", listed(|_, entries| *entries.last_mut().expect("a byte") ^= 1)),
    ]);
    let meta = |bytes: &[u8]| with(|parts| parts.sections[META].1 = bytes.to_vec());
    let index = |bytes: &[u8]| with(|parts| parts.sections[INDX].1 = bytes.to_vec());
    // Two tiles of one value, so that INDX has widths: all 0.
    let two = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut case = Case::new(65, 1, 64, &[SampleType::U8]);
        case.bands[0] = Cells::U8(vec![3; 65]);
        let mut parts = Parts::of(&case.write().0);
        change(&mut parts.sections[INDX].1);
        parts.file()
    };
    let sound = Parts::of(&sound()).sections;
    let cut = |section: usize| sound[section].1[..sound[section].1.len() - 1].to_vec();
    many.extend([
        ("r013-no-columns", "a width of 0", meta(&[0, 2, 1, 1, 1, 0, 0])),
        ("r013-columns", "2^31 columns", meta(&[0x80, 0x80, 0x80, 0x80, 8, 2, 1, 1, 1, 0, 0])),
        ("r013-tile-side", "tiles of 4160 cells", meta(&[2, 2, 65, 1, 1, 0, 0])),
        ("r013-no-bands", "no bands", meta(&[2, 2, 1, 0, 1, 0, 0])),
        ("r013-chunks", "more chunks than a fifth of the bytes", meta(&[0xff, 0x7f, 0xff, 0x7f, 1, 1, 1, 0, 0])),
        ("r014-tables", "table set 2", meta(&[2, 2, 1, 1, 2, 0, 0])),
        ("r015-rotated", "terms of a geotransform that is not there", meta(&[2, 2, 1, 1, 1, 2, 0])),
        ("r016-form", "a float of form 10 as max error", meta(&[2, 2, 1, 1, 1, 0, 0x10, 10, 1, 1])),
        ("r016-divisor", "a float that is divided by 0", meta(&[2, 2, 1, 1, 1, 0, 0x10, 9, 2, 0])),
        ("r016-zero", "a max error of 0", meta(&[2, 2, 1, 1, 1, 0, 0x10, 0])),
        ("r016-infinite", "a max error without end", meta(&[2, 2, 1, 1, 1, 0, 0x10, 2, 0xf0, 0x7f])),
        ("r017-cut", "META without its last byte", meta(&cut(META))),
        ("r017-varint", "a width in a longer form than it needs", meta(&[0x82, 0, 2, 1, 1, 1, 0, 0])),
        ("r018-width", "lengths of 33 bits", two(&|index| index[1] = 33)),
        ("r018-length", "a length of 2^32", index(&[0x80, 0x80, 0x80, 0x80, 0x10, 0, 0, 0])),
        (
            "r018-bits",
            "bits are set after the last length",
            two(&|index| {
                // Two lengths of 1 bit leave 6 bits of their byte.
                index[1] = 1;
                index.insert(2, 0x80);
            }),
        ),
        ("r019-first", "the first segment is empty", index(&[0, 0, 0, 0])),
        ("r020-sum", "lengths that do not add up", two(&|index| index[0] += 1)),
        ("r021-cut", "INDX without its last byte", index(&cut(INDX))),
        ("r021-longer", "INDX with a byte after its table", index(&[sound[INDX].1.as_slice(), &[0]].concat())),
        // The texts c3 28 and nothing, coded.
        ("r023-utf-8", "a unit that is not UTF-8", {
            meta(&[2, 2, 1, 1, 1, 0, 0x80, 0, 0x01, 0x22, 0xaf, 0xf7, 0xd8])
        }),
        // The texts m and nothing, and bytes more; a unit that has no end.
        ("r024-longer", "texts that go on", meta(&[2, 2, 1, 1, 1, 0, 0x80, 0, 0x1b, 0xe9, 1, 1, 1, 1])),
        // The same with a byte that says nothing: zeros follow anyway.
        ("r024-zero", "texts with a zero byte after their end", { meta(&[2, 2, 1, 1, 1, 0, 0x80, 0, 0x1b, 0xe9, 0]) }),
        ("r024-cut", "texts that end early", meta(&[2, 2, 1, 1, 1, 0, 0x80, 0, 0x00])),
    ]);
    many
}

/// The tile of the sound file.
fn plain() -> orograph::codec::EncodedTile {
    let rule = BandRule { sample: SampleType::U8, nodata: None, bound: Bound::Lossless };
    encode_tile(&Cells::U8(vec![10, 12, 11, 15]), TileShape { width: 2, height: 2 }, &rule).expect("encodes")
}

/// A tile of one value whose header begins with the meaning: no voids, no patches.
fn lone(record: &[u8], side: &Bits) -> Vec<u8> {
    file(2, 2, record, [part(&side.bytes()), vec![], vec![], vec![]])
}

fn tile_headers() -> Vec<Vector> {
    let start = |meaning: u64| Bits::default().bits(0, 2).bits(meaning, 3).signed(10, 7);
    let plain = |meaning: u64| start(meaning).number(0, 0).bits(0, 7).number(2, 0);
    let (u8s, f32s) = ([0].as_slice(), [6].as_slice());
    let seeded = header(4, 1).bits(0, 2).signed(4, 0);
    let [first, .., last] = self::plain().segments;
    let of = |segments: [Vec<u8>; 4]| file(2, 2, u8s, segments);
    vec![
        ("r025-part", "a part longer than its segment", of([vec![9, 0, 0], vec![], vec![], last.clone()])),
        ("r025-varint", "a length of 6 bytes", {
            let long = [&[0x80 | first[0], 0x80, 0x80, 0x80, 0x80, 0], &first[1..]].concat();
            of([long, vec![], vec![], last.clone()])
        }),
        ("r025-after", "a byte after the last part", {
            file(2, 2, u8s, [[part(&plain(0).bytes()), vec![0]].concat(), vec![], vec![], vec![]])
        }),
        ("r025-empty", "the last segment is empty although the tile has a range", {
            of([first.clone(), vec![], vec![], vec![]])
        }),
        ("r025-long", "a length in a longer form than it needs", {
            of([[&[0x80 | first[0], 0], &first[1..]].concat(), vec![], vec![], last.clone()])
        }),
        ("r025-no-level", "a segment although there is no level for it", {
            of([first.clone(), vec![0, 0], vec![], last.clone()])
        }),
        ("r025-nothing", "a segment of lengths of empty parts", {
            file(2, 2, u8s, [part(&plain(0).bytes()), vec![], vec![], vec![0]])
        }),
        ("r025-raw", "no length of the raw bits", of([part(&seeded.bytes()), vec![], vec![], last.clone()])),
        ("r026-header", "side bits that end within the tile header", lone(u8s, &Bits::default().bits(0, 8))),
        ("r026-none", "no side bits", lone(u8s, &Bits::default())),
        ("r026-filter", "side bits that end within a filter", {
            let [first, ..] = self::plain().segments;
            let side = Bits::default().bits(0, 2).bits(3, 3).bits(1, 1).bits(0, 1).signed(5, 1);
            of([first, vec![], vec![], [part(&side.bytes()), part(&[]), vec![0; 4]].concat()])
        }),
        ("r027-range-bits", "65 range bits", lone(u8s, &start(0).number(0, 0).bits(65, 7).number(2, 0))),
        ("r027-step", "a step of 2^33 + 1", lone(u8s, &start(0).number(0, 0).bits(0, 7).number(2, 1 << 32))),
        ("r027-factor", "a factor of 2^64", lone(u8s, &start(0).number(0, u64::MAX).bits(0, 7).number(2, 0))),
        ("r027-grid", "a denominator of 2^32", lone(f32s, &plain(1).number(0, 0).number(6, 0xffff_ffff))),
        ("r027-no-list", "a list of no values", lone(u8s, &plain(4).number(4, 0))),
        ("r027-list", "a list of 16,385 values", lone(u8s, &plain(4).number(4, 16_385).bits(0, 32))),
        ("r027-usual-coarseness", "the usual coarseness written out", {
            let side = Bits::default().bits(0, 5).signed(10, 10).number(0, 0).bits(3, 7).number(2, 0);
            let side = side.bits(1, 1).bits(0, 6).bits(0, 1).signed(3, 0);
            of([[part(&side.bytes()), part(&[])].concat(), vec![], vec![], last.clone()])
        }),
        ("r027-coarseness", "errors coarsened by 16 bits, words of 32", {
            lone(u8s, &header(4, 1).bits(1, 1).bits(16, 6).bits(0, 1).signed(4, 0))
        }),
        ("r027-coarseness-wide", "errors coarsened by 48 bits, words of 64", {
            lone(u8s, &header(40, 1).bits(1, 1).bits(48, 6).bits(0, 1).signed(40, 0))
        }),
        ("r028-reserved", "meaning 5", lone(u8s, &plain(5))),
        ("r028-grid", "a grid of integers", lone(u8s, &plain(1).number(0, 0).number(6, 0))),
        ("r028-list", "a list of floats", lone(f32s, &plain(4).number(4, 1).signed(10, 0))),
        ("r029-list", "a list that goes beyond 2^63 - 1", {
            lone(u8s, &plain(4).number(4, 2).signed(10, i64::MAX).number(1, 0))
        }),
        ("r036-voids", "voids of integers without a nodata value", {
            lone(
                u8s,
                &Bits::default().bits(3, 2).bits(0, 1).bits(0, 3).signed(10, 7).number(0, 0).bits(0, 7).number(2, 0),
            )
        }),
        ("r037-step", "a step of 3 in a lossless band", { lone(u8s, &start(0).number(0, 0).bits(0, 7).number(2, 1)) }),
        ("r037-fixed", "meaning fixed in a lossless band", lone(f32s, &plain(2).bits(0, 16))),
        ("r032-shift", "tables shifted by 4", last_pass(Bits::default().bits(0, 2).bits(7, 3))),
        ("r032-weight", "a weight of 8192", {
            last_pass(Bits::default().bits(0, 2).bits(3, 3).bits(1, 1).bits(0, 1).signed(5, 9000))
        }),
        ("r032-code", "code 42 of an error weight", {
            let side = Bits::default().bits(0, 2).bits(3, 3).bits(0, 3).bits(1, 1).bits(42, 6);
            last_pass(side)
        }),
    ]
}

/// The sound tile with other parameters of its first pass.
fn last_pass(side: Bits) -> Vec<u8> {
    let [first, .., last] = plain().segments;
    let rest = &last[1 + usize::from(last[0])..];
    file(
        2,
        2,
        &[0],
        [
            first,
            vec![],
            vec![],
            [part(&side.bits(u64::MAX, 64).bits(u64::MAX, 64).bits(u64::MAX, 64).bytes()), rest.to_vec()].concat(),
        ],
    )
}

fn tile_bodies() -> Vec<Vector> {
    let [first, .., last] = plain().segments;
    let changed = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut last = last.clone();
        change(&mut last);
        file(2, 2, &[0], [first.clone(), vec![], vec![], last])
    };
    let patches = |side: Bits| {
        // One value, and patches; none in the last segment.
        let first = Bits::default().bits(2, 2).bits(0, 3).signed(10, 7).number(0, 0).bits(0, 7).number(2, 0);
        let last = part(&Bits::default().number(2, 0).bytes());
        file(2, 2, &[0], [part(&first.then(side).bytes()), vec![], vec![], last])
    };
    let coin: Vec<u8> = noise(21).map(|bits| (bits >> 63) as u8).take(64 * 64).collect();
    let rule = BandRule { sample: SampleType::U8, nodata: Some(1), bound: Bound::Lossless };
    let masked = encode_tile(&Cells::U8(coin), TileShape { width: 64, height: 64 }, &rule).expect("encodes");
    // The last segment has no side bits.
    let mask = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut segments = masked.segments.clone();
        let mut bytes = parts_of(&segments[3], 2).swap_remove(1);
        change(&mut bytes);
        segments[3] = [vec![0], part(&bytes)].concat();
        file(64, 64, &[8, 1], segments)
    };
    // A void of one cell: no symbols.
    let no_symbols = |symbols: &[u8]| {
        let side = Bits::default().bits(3, 2).bits(0, 1).bits(0, 3).signed(10, 0).number(0, 0);
        let side = side.bits(4, 7).number(2, 0).bits(0, 2).signed(4, 0);
        file(
            1,
            1,
            &[8, 1],
            [[part(&side.bytes()), part(&[]), part(&[]), symbols.to_vec()].concat(), vec![], vec![], vec![]],
        )
    };
    vec![
        ("r030-longer", "a mask that goes on", mask(&|bytes| bytes.extend([1; 8]))),
        ("r030-zero", "a mask with a zero byte after its end", mask(&|bytes| bytes.push(0))),
        ("r030-ending", "a mask whose end could be shorter", {
            mask(&|bytes| {
                *bytes.last_mut().expect("a byte") -= 1;
                bytes.push(0xff);
            })
        }),
        ("r030-cut", "a mask that ends early", mask(&|bytes| bytes.truncate(20))),
        ("r031-count", "5 patches of 4 cells", patches(Bits::default().number(2, 5).bits(0, 32))),
        ("r031-outside", "a patch beyond the tile", patches(Bits::default().number(2, 1).number(8, 4).bits(1, 8))),
        (
            "r031-segment",
            "a patch in the first segment of a cell of the last one",
            patches(Bits::default().number(2, 1).number(8, 3).bits(1, 8)),
        ),
        ("r033-short", "symbols of 3 bytes", changed(&|last| last.truncate(last.len() - 1))),
        ("r033-half", "half a refill", changed(&|last| last.push(0))),
        ("r033-left", "a refill that nobody takes", changed(&|last| last.extend([0, 0]))),
        (
            "r033-state",
            "a state that does not come back",
            changed(&|last| {
                let at = last.len() - 1;
                last[at] ^= 0x40;
            }),
        ),
        ("r033-none", "symbols where there are none", no_symbols(&[0, 0, 1, 0])),
    ]
}

/// Maps of zones.
fn maps() -> Vec<Vector> {
    let (cells, shape) = (Cells::I16(patchwork(256)), TileShape { width: 256, height: 256 });
    let rule = BandRule { sample: SampleType::I16, nodata: None, bound: Bound::Lossless };
    let sound = encode_tile(&cells, shape, &rule).expect("encodes").segments;
    // Side bits, the map, raw bits, symbols.
    let map = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut segments = sound.clone();
        let mut parts = parts_of(&segments[2], 3);
        assert!(parts[1].len() > 4, "there is a map");
        change(&mut parts[1]);
        let last = parts.pop().expect("the rest");
        segments[2] = parts.iter().flat_map(|bytes| part(bytes)).chain(last).collect();
        file(256, 256, &[3], segments)
    };
    vec![
        ("r038-longer", "a map of zones that goes on", map(&|bytes| bytes.extend([1; 8]))),
        ("r038-zero", "a map of zones with a zero byte after its end", map(&|bytes| bytes.push(0))),
        ("r038-ending", "a map of zones whose end could be shorter", {
            map(&|bytes| {
                *bytes.last_mut().expect("a byte") -= 1;
                bytes.push(0xff);
            })
        }),
        ("r038-cut", "a map of zones that ends early", map(&|bytes| bytes.truncate(3))),
        ("r038-none", "no map of zones", map(&Vec::clear)),
    ]
}

/// What a segment's parts are, `counted` of them with their lengths, and the rest.
fn parts_of(segment: &[u8], counted: usize) -> Vec<Vec<u8>> {
    let (mut parts, mut rest) = (vec![], segment);
    for _ in 0..counted {
        let end = rest.iter().position(|byte| byte & 0x80 == 0).expect("a varint ends");
        let length = rest[..=end].iter().rev().fold(0, |length, byte| length << 7 | usize::from(byte & 0x7f));
        let (part, after) = rest[end + 1..].split_at(length);
        parts.push(part.to_vec());
        rest = after;
    }
    parts.push(rest.to_vec());
    parts
}

/// Parts that do not end as they should.
fn endings() -> Vec<Vector> {
    // The last segment with another part; the last of the parts has no length of its own.
    let with = |cells: &Cells,
                shape: TileShape,
                record: &[u8],
                counted: usize,
                place: usize,
                change: &dyn Fn(&mut Vec<u8>)| {
        let rule = BandRule { sample: cells.sample(), nodata: None, bound: Bound::Lossless };
        let mut segments = encode_tile(cells, shape, &rule).expect("encodes").segments;
        let mut parts = parts_of(&segments[3], counted);
        assert!(place == 0 || !parts[place].is_empty(), "the part is there");
        change(&mut parts[place]);
        let last = parts.pop().expect("the rest");
        segments[3] = parts.iter().flat_map(|bytes| part(bytes)).chain(last).collect();
        file(shape.width, shape.height, record, segments)
    };
    let resampled = resampled(64, 64, 13, 0.7).iter().map(|&z| z as f32).collect();
    let (resampled, square) = (Cells::F32(resampled), TileShape { width: 64, height: 64 });
    // Side bits, copies, raw bits, symbols.
    let copies = |change: &dyn Fn(&mut Vec<u8>)| with(&resampled, square, &[6], 3, 1, change);
    let (wild, small) = (cells(SampleType::U32, 180, 9), TileShape { width: 20, height: 9 });
    let raw = |change: &dyn Fn(&mut Vec<u8>)| with(&wild, small, &[4], 2, 1, change);
    let side = |change: &dyn Fn(&mut Vec<u8>)| with(&wild, small, &[4], 2, 0, change);
    let last_bit = |bytes: &mut Vec<u8>| *bytes.last_mut().expect("a byte") |= 0x80;
    let one_value = |filling: u64| {
        let side = Bits::default().bits(0, 2).bits(0, 3).signed(10, 7).number(0, 0).bits(0, 7).number(2, 0);
        lone(&[0], &side.bits(filling, 8))
    };
    vec![
        ("r034-longer", "copies that go on", copies(&|bytes| bytes.extend([1; 8]))),
        ("r034-zero", "copies with a zero byte after their end", copies(&|bytes| bytes.push(0))),
        (
            "r034-ending",
            "copies whose end could be shorter",
            copies(&|bytes| {
                *bytes.last_mut().expect("a byte") -= 1;
                bytes.push(0xff);
            }),
        ),
        ("r034-cut", "copies that end early", copies(&|bytes| bytes.truncate(20))),
        ("r035-side", "a byte after the side bits", side(&|bytes| bytes.push(0))),
        ("r035-side-filling", "side bits whose last byte is not filled up with zeros", side(&last_bit)),
        ("r035-raw", "a byte after the raw bits", raw(&|bytes| bytes.push(0))),
        ("r035-raw-filling", "raw bits whose last byte is not filled up with zeros", raw(&last_bit)),
        ("r035-one-value", "a byte after the side bits of a tile of one value", one_value(0)),
        ("r035-one-value-filling", "a tile of one value whose side bits are filled up with ones", one_value(0xe0)),
    ]
}
