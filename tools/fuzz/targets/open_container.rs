//! Any bytes as a file, with its checksums made right: opened and read, or refused.
#![no_main]

use libfuzzer_sys::fuzz_target;
use orograph::oro::{Place, Reader, Window};
use orograph::watch::Watch;
use orograph_fuzz::seal::seal;

/// Cells that one input may make a reader produce; a file of a few bytes may hold a great plain.
const CELLS: usize = 1 << 20;

fuzz_target!(|bytes: &[u8]| {
    let mut file = bytes.to_vec();
    seal(&mut file);
    let Ok(reader) = Reader::open(file.as_slice()) else { return };
    let description = reader.description();
    description.check().expect("what was read can be written");
    reader.segment_bytes();
    let bands = description.bands.len();
    let last = description.last_level();
    for level in [0, 1, 3, 6, 7, last] {
        let level = level.min(last);
        let (width, height) = description.level_size(level);
        let (columns, rows) = (width.min(200), height.min(200));
        let window = Window { col: width - columns, row: height - rows, width: columns, height: rows };
        let side = description.tile_side >> level.min(6);
        let tiles = (columns / side + 2) * (rows / side + 2) * (1 << (2 * level.saturating_sub(6)));
        if tiles * side * side <= CELLS {
            let mut kept = |_| Ok(());
            let cells = reader.window_or(bands - 1, level, window, &mut kept).expect("memory is no source of errors");
            assert_eq!(cells.len(), columns * rows);
        }
    }
    if description.tile_side <= 256 && reader.chunk_bytes() < 10_000 {
        let place = Place { col: 0, row: 0, band: bands / 2 };
        let (_, _) = (reader.tile(place, 0), reader.tile(place, 5));
        if description.chunks() < 32 {
            reader.check(&Watch::default()).expect("damage is no error");
        }
    }
});
