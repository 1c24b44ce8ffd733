//! What the specification says of the codec's tables and of its worked tiles.

use orograph::codec::{BandRule, Bound, Cells, TileShape, decode_tile, encode_tile};
use orograph::grid::SampleType;

const SPECIFICATION: &str = include_str!("../../format-spec/oro.md");
const TABLES: &[u8] = include_bytes!("../../format-spec/tables/codec-1.bin");

/// A line that the specification must have: where it has another, this one takes its place.
#[track_caller]
fn assert_says(line: &str) {
    assert!(SPECIFICATION.contains(line), "format-spec/oro.md should say:\n{line}");
}

#[test]
fn the_table_set_is_the_one_that_is_named() {
    let (bytes, crc) = (TABLES.len(), crc32c::crc32c(TABLES));
    assert_eq!(bytes, 75_192);
    assert_says(&format!("75,192 bytes with the CRC-32C `{crc:08x}`."));
}

#[test]
fn the_table_set_keeps_its_rules() {
    let number = |bytes: &[u8]| u16::from_le_bytes([bytes[0], bytes[1]]);
    for table in TABLES[..576 * 128].chunks(128) {
        let freq: Vec<u16> = table.chunks(2).map(number).collect();
        assert_eq!(freq.iter().map(|&freq| u32::from(freq)).sum::<u32>(), 1 << 14, "frequencies add up");
        assert!(freq[63] > 0, "every table can escape");
    }
    for (index, filter) in TABLES[576 * 128..].chunks(61).enumerate() {
        let (serial, pass) = (index / 12, index / 4 % 3);
        let taps = [20, 20, 24][pass] + 2 * serial;
        assert!(filter[2 * taps..52].iter().all(|&byte| byte == 0), "filter {index}: weights beyond its taps");
        assert!(filter[52..].iter().all(|&code| code <= 41), "filter {index}: codes of error weights");
    }
}

fn segments_of(cells: &Cells, width: usize, rule: BandRule) -> Vec<String> {
    let shape = TileShape { width, height: cells.len() / width };
    let tile = encode_tile(cells, shape, &rule).expect("encodes");
    let segments: Vec<&[u8]> = tile.segments.iter().map(Vec::as_slice).collect();
    assert_eq!(&decode_tile(&segments, shape, &rule, 0).expect("decodes"), cells);
    let hex = |bytes: &&[u8]| bytes.iter().map(|byte| format!(" {byte:02x}")).collect::<String>();
    let line = |(number, bytes): (usize, &&[u8])| format!("segment {number}:{}", hex(bytes));
    segments.iter().enumerate().filter(|(_, bytes)| !bytes.is_empty()).map(line).collect()
}

#[test]
fn the_worked_tiles_have_those_bytes() {
    let rule = BandRule { sample: SampleType::I16, nodata: Some(0x8000), bound: Bound::Lossless };
    let voids = segments_of(&Cells::I16(vec![7, 7, -32768, 7, 7, 7]), 3, rule);
    assert_says(&voids.join("\n"));
    let rule = BandRule { sample: SampleType::U8, nodata: None, bound: Bound::Lossless };
    let residuals = segments_of(&Cells::U8(vec![10, 12, 11, 15]), 2, rule);
    assert_says(&residuals.join("\n"));
}
