//! How many requests it takes, and how large they are.

use crate::case::{Case, Counted};
use orograph::codec::Cells;
use orograph::grid::SampleType;
use orograph::oro::{Band, Chunk, Description, Place, Reader, Window, Writer};

const OPENING: usize = 64 << 10;

/// A file of 100 x 100 tiles whose chunks are no real tiles; some are as long as the greatest of real ones, so that
/// the index is as large as it would be in an archive of 10 GB.
fn archive(widest: [u32; 4], crs: Option<String>) -> Vec<u8> {
    let mut description = Description::new(6400, 6400, vec![Band::new(SampleType::I16)]);
    description.tile_side = 64;
    description.georeference.crs = crs;
    let tiling = description.tiling();
    let mut writer = Writer::new(vec![], description.clone()).expect("begins");
    for number in 0..description.chunks() {
        let lengths = if number == 5000 { widest } else { [1 + (number % 7) as u32, 2, 0, (number % 100) as u32] };
        let mut bytes = vec![];
        for length in lengths.into_iter().filter(|&length| length > 0) {
            let segment = vec![number as u8; length as usize];
            bytes.extend(&segment);
            bytes.extend(crc32c::crc32c(&segment).to_le_bytes());
        }
        let top = Cells::I16(vec![number as i16]);
        writer
            .push(&Chunk { place: tiling.place(number, 1), bytes, lengths, top, largest_error: 0.0 })
            .expect("is next");
    }
    writer.finish().expect("is written").0
}

#[test]
fn ten_thousand_tiles_open_with_two_requests() {
    // Tiles of 1024 cells a side and 4 bytes a cell, hardly compressed.
    for widest in [[100, 1000, 10_000, 100_000], [65_000, 200_000, 800_000, 3_000_000]] {
        let source = Counted::new(archive(widest, None));
        let reader = Reader::open(&source).expect("opens");
        let requests = source.take();
        assert!(requests.len() <= 2, "{requests:?}");
        assert!(requests.iter().all(|&(_, length)| length <= OPENING), "{requests:?}");

        // A look at the whole: the overview is in four tiles of 64 cells.
        let cells = reader.window(0, 6, Window { col: 0, row: 0, width: 100, height: 100 }).expect("is read");
        assert_eq!(cells, Cells::I16((0..10_000).map(|number| number as i16).collect()));
        assert_eq!(source.take().len(), 1, "the overview's tiles adjoin");
        reader.window(0, 7, Window { col: 0, row: 0, width: 50, height: 50 }).expect("is read");
        assert_eq!(source.take().len(), 1, "the overview's tiles adjoin");

        reader.chunk(Place { col: 7, row: 9, band: 0 }, 0).expect("is read");
        assert_eq!(source.take().len(), 1, "a tile");
        let row: Vec<Place> = (10..60).map(|col| Place { col, row: 9, band: 0 }).collect();
        let chunks = reader.chunks(&row, 0).expect("are read");
        assert_eq!(source.take().len(), 1, "neighbours");
        assert!(chunks.iter().map(|chunk| chunk.place).eq(row), "in order");
    }
}

#[test]
fn a_small_file_opens_with_one_request() {
    let source = Counted::new(Case::talkative().write().0);
    Reader::open(&source).expect("opens");
    assert_eq!(source.take(), [(0, source.bytes.len())]);
}

#[test]
fn long_metadata_is_read_in_one_more_request() {
    let noise: String = crate::case::noise(1).map(|number| format!("{number:x}")).take(20_000).collect();
    let source = Counted::new(archive([1, 1, 1, 1], Some(noise.clone())));
    let reader = Reader::open(&source).expect("opens");
    assert_eq!(reader.description().georeference.crs.as_ref(), Some(&noise));
    assert_eq!(source.take().len(), 2);
}

#[test]
fn tiles_side_by_side_are_one_request() {
    let case = Case::new(64 * 12, 64 * 4, 64, &[SampleType::I16]);
    let source = Counted::new(case.write().0);
    let reader = Reader::open(&source).expect("opens");
    source.take();
    reader.window(0, 0, Window { col: 70, row: 10, width: 300, height: 20 }).expect("is read");
    assert_eq!(source.take().len(), 1, "a row of tiles");
    reader.window(0, 0, Window { col: 0, row: 0, width: 64 * 12, height: 256 }).expect("is read");
    assert_eq!(source.take().len(), 1, "all tiles");
}
