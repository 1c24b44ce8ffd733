//! Long and odd rasters, through the container.

use crate::ground::{Ground, bits};
use crate::promise::Tile;
use orograph::codec::{BandRule, Bound, TileShape};
use orograph::grid::SampleType;
use orograph::oro::{Band, Description, Reader, Window, Writer, encode_chunk};
use orograph::watch::Watch;

fn assert_holds(tile: &Tile, tile_side: usize) {
    let TileShape { width, height } = tile.shape;
    let band = Band { rule: tile.rule, ..Band::new(tile.rule.sample) };
    let description = Description { tile_side, ..Description::new(width, height, vec![band]) };
    let mut writer = Writer::new(vec![], description.clone()).expect("begins");
    for chunk in 0..description.chunks() {
        let place = description.tiling().place(chunk, 1);
        let shape = description.tiling().shape(place.col, place.row);
        let (size, left) = (tile.rule.sample.bytes(), place.col * tile_side);
        let bytes = tile.cells.to_le_bytes();
        let rows = bytes.chunks(width * size).skip(place.row * tile_side).take(shape.height);
        let part: Vec<u8> = rows.flat_map(|row| &row[left * size..(left + shape.width) * size]).copied().collect();
        let cells = orograph::codec::Cells::from_le_bytes(tile.rule.sample, &part).expect("whole cells");
        writer.push(&encode_chunk(&description, place, &cells).expect("encodes")).expect("is next");
    }
    let reader = Reader::open(writer.finish().expect("is written").0).expect("opens");
    let decoded = reader.window(0, 0, Window { col: 0, row: 0, width, height }).expect("is read");
    assert_eq!(tile.broken(&decoded), None, "{:?} {:?}", tile.shape, tile.rule);
    for level in 1..=description.last_level() {
        let (width, height) = description.level_size(level);
        let cells = reader.window(0, level, Window { col: 0, row: 0, width, height }).expect("is read");
        let expected = decoded.decimated(tile.shape.width, level);
        assert!(cells.to_le_bytes() == expected.to_le_bytes(), "level {level} of {:?}", tile.shape);
    }
    let report = reader.check(&Watch::default()).expect("is read");
    assert!(report.is_sound(), "{report:?}");
}

#[test]
fn long_rasters_come_back() {
    let sides = [(1, 100_000, 1024), (100_000, 1, 4096), (65_537, 2, 4096), (3, 65_537, 1024), (65_537, 1, 64)];
    for (number, (width, height, side)) in sides.into_iter().enumerate() {
        let shape = TileShape { width, height };
        for (sample, ground, bound) in [
            (SampleType::I16, Ground::Rough, Bound::Lossless),
            (SampleType::F32, Ground::Rough, Bound::MaxError(0.5)),
            (SampleType::U32, Ground::FullRange, Bound::MaxError(3.0)),
        ] {
            let cells = ground.cells(sample, shape, number as u64);
            let rule = BandRule { sample, nodata: Some(bits(&cells, 12_345)), bound };
            assert_holds(&Tile { cells, shape, rule }, side);
        }
    }
}

#[test]
fn tiles_of_the_greatest_side_come_back() {
    let shape = TileShape { width: 4097, height: 130 };
    let sample = SampleType::U8;
    let rule = BandRule { sample, nodata: Some(0), bound: Bound::MaxError(2.0) };
    assert_holds(&Tile { cells: Ground::Smooth.cells(sample, shape, 1), shape, rule }, 4096);
}
